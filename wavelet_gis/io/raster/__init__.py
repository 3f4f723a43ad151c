"""Rasters in and out: what of a file is elevation, what it costs, and what came of writing it."""

from wavelet_gis.io.raster.raster_reader import NO_TAG, CellWindow, read_dem
from wavelet_gis.io.raster.raster_writer import write_bands, write_cog, write_dem
from wavelet_gis.io.raster.several import read_dems

__all__ = ["NO_TAG", "CellWindow", "read_dem", "read_dems", "write_bands", "write_cog", "write_dem"]
