"""What can go wrong between a file and the core, as one family of exceptions and warnings.

Every error is a `WaveletError` and also the built-in it specialises, so that callers may catch
either. Messages say what is wrong, where, and how to put it right, and they name the parameters of
the Python functions; ``in_words`` gives them in the words of a command line or a dialog.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

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
    """A coordinate reference system, or a unit, that cannot be used."""


class TerrainWarning(UserWarning):
    """Root of the warnings about data that are odd but usable.

    Parameters
    ----------
    message : str
        The text; with parameters or values, a template of :meth:`str.format`, as that of a
        `WaveletError`.
    *options : str
        Names of the Python parameters that the warning is about: ``{0}``, ``{1}`` in the template.
    **values : Any
        What else the template shows, by name.
    """

    def __init__(self, message: str = "", *options: str, **values: Any) -> None:
        self.template = message
        self.options = options
        self.values = values
        super().__init__(self.in_words(str))

    def in_words(self, name_of: Callable[[str], str]) -> str:
        """Return the message with the parameters named as the reader knows them.

        Parameters
        ----------
        name_of : callable
            From the name of a Python parameter to what it is called.
        """
        if not self.options and not self.values:
            return self.template
        return self.template.format(*map(name_of, self.options), **self.values)


class CrsWarning(TerrainWarning):
    """The CRS is missing, broken or unlikely; coordinates are used as they stand."""


class UnitWarning(TerrainWarning):
    """A vertical unit had to be assumed or converted."""


class RasterWarning(TerrainWarning):
    """Something in a raster cannot be carried or is unusual."""


class PointCloudWarning(TerrainWarning):
    """Something in a LAS file cannot be carried or is unusual."""
