"""Terrain in memory, without files: DEMs, clouds, TINs, where they came from, pyramids."""
