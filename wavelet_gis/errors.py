"""What can go wrong between a file and the core, as one family of exceptions and warnings.

Every error is a `WaveletError` and also the built-in it specialises, so that callers may catch
either. Messages say what is wrong, where, and how to mend it.
"""

from __future__ import annotations

from wavelet_core.errors import WaveletError

__all__ = [
    "CrsError",
    "CrsWarning",
    "InputFileError",
    "OutputFileError",
    "PointCloudWarning",
    "RasterWarning",
    "TerrainWarning",
    "UnitWarning",
]


class InputFileError(WaveletError, OSError):
    """A file that is missing, cannot be read, or does not hold what was asked of it."""


class OutputFileError(WaveletError, OSError):
    """A file that exists already or cannot be written where it was asked for."""


class CrsError(WaveletError, ValueError):
    """A coordinate reference system or a unit that cannot serve."""


class TerrainWarning(UserWarning):
    """Root of the warnings about data that are odd but usable."""


class CrsWarning(TerrainWarning):
    """The CRS is missing, broken or unlikely; coordinates are used as they stand."""


class UnitWarning(TerrainWarning):
    """A vertical unit had to be assumed or converted."""


class RasterWarning(TerrainWarning):
    """Something in a raster cannot be carried or is unusual."""


class PointCloudWarning(TerrainWarning):
    """Something in a LAS file cannot be carried or is unusual."""
