"""Layers and rasters in memory, ready to be written by anyone."""
