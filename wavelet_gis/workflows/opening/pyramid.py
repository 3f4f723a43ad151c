"""The pyramid in a pyramid file."""

from __future__ import annotations

import os

from wavelet_core import Progress
from wavelet_core.errors import PyramidError
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.origin import ORIGINS
from wavelet_gis.workflows.analyse import Analysis

__all__ = ["holds_pyramid", "load", "origin_kind"]


def load(
    path: str | os.PathLike[str], *, level: int | None = None, progress: Progress | None = None
) -> Analysis:
    """Return the pyramid in a pyramid file, everything in it checked.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.
    level : int, optional
        The finest that is wanted: where the file of a large raster holds it without the levels
        above, no more is read, and the pyramid ends there (`Pyramid.part`).
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    PyramidError
        When its parts are damaged or do not fit together.
    Cancelled
        ``progress`` returned False.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_levels, read_pyramid

    if level is None:
        return Analysis(read_pyramid(path, progress))
    return Analysis(read_levels(path, level, progress))


def origin_kind(path: str | os.PathLike[str]) -> str:
    """Return what a pyramid file was made from, without its arrays: ``raster`` and so on.

    Parameters
    ----------
    path : path
        A pyramid file.

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    PyramidError
        When it claims a kind that is none of ours.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_summary

    source = read_summary(path).get("source")
    kind = source.get("kind") if isinstance(source, dict) else None
    if not isinstance(kind, str) or kind not in ORIGINS:
        raise PyramidError(
            f"{path}: the file claims a source of kind {kind!r}; analyse the input anew."
        )
    return kind


def holds_pyramid(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is a GeoPackage with a pyramid in it.

    Parameters
    ----------
    path : path
        Of any file.

    Raises
    ------
    InputFileError
        When the system does not let it be read.
    """
    from wavelet_gis.io.geopackage import is_system_fault
    from wavelet_gis.io.pyramid.pyramid_file import read_summary

    try:
        read_summary(path)
    except InputFileError as error:
        if is_system_fault(error):
            raise
        return False  # no GeoPackage, or one without our tables
    return True
