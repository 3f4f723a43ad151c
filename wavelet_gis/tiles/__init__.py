"""Terrain cut into tiles, for more than one machine and for the web."""
