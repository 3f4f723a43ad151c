"""LAS, LAZ and COPC files: how their bytes lie, the decoder in its child, clouds in, and out."""

from wavelet_gis.io.las.cloud_reader import NOISE_CLASSES, read_cloud
from wavelet_gis.io.las.cloud_writer import write_cloud
from wavelet_gis.io.las.dimensions import ALIASES
from wavelet_gis.io.las.several import read_clouds

__all__ = ["ALIASES", "NOISE_CLASSES", "read_cloud", "read_clouds", "write_cloud"]
