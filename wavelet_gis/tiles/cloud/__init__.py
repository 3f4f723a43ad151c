"""Tiles of point clouds: the cut, the borders that neighbours share, the mesh, the way back."""
