"""What can go wrong between a file and the core, as one family of exceptions and warnings.

Every error is a `WaveletError` and also the built-in it specialises, so that callers may catch
either. Messages say what is wrong, where, and how to put it right, and they name the parameters of
the Python functions; ``in_words`` gives them in the words of a command line or a dialog.
"""

from __future__ import annotations

from wavelet_core.errors import WaveletError, Worded

__all__ = [
    "CrsError",
    "CrsWarning",
    "InputFileError",
    "LayerWarning",
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
    """A coordinate reference system, or a unit, that cannot be used."""


class TerrainWarning(Worded, UserWarning):
    """Root of the warnings about data that are odd but usable.

    Parameters
    ----------
    message, *options, **values
        See `wavelet_core.errors.Worded`.
    """


class CrsWarning(TerrainWarning):
    """The CRS is missing, broken or unlikely; coordinates are used as they stand."""


class UnitWarning(TerrainWarning):
    """A vertical unit had to be assumed or converted."""


class RasterWarning(TerrainWarning):
    """Something in a raster cannot be carried or is unusual."""


class LayerWarning(TerrainWarning):
    """Something in a vector layer is unusual."""


class PointCloudWarning(TerrainWarning):
    """Something in a LAS file cannot be carried or is unusual."""
