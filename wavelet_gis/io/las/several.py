"""Several LAS files as one point cloud."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wavelet_gis.crs.agreement import agreed
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.formats import CLOUD_SUFFIXES, any_of, suffix_of
from wavelet_gis.io.las.cloud_reader import NoneChosenError, read_cloud
from wavelet_gis.io.las.dimensions import HEIGHT_ABOVE_GROUND
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.points.merged import merged_cloud
from wavelet_gis.notes import note

__all__ = ["read_clouds"]


def read_clouds(
    paths: Sequence[str], *, any_crs: bool = False, any_unit: bool = False, **options: Any
) -> tuple[PointCloud, Georeference]:
    """Return the points of several files as one cloud, and their georeference.

    Parameters
    ----------
    paths : sequence of str
        Two or more; the first gives header and VLRs.
    any_crs, any_unit : bool
        Whether the CRS, or the unit of z, is given otherwise and need not agree.
    **options
        See `wavelet_gis.io.las.read_cloud`. Classes and box are chosen in each file, of which some
        may have no such point; heights above the ground are those above the ground of the same
        file.

    Raises
    ------
    InputFileError
        A file that cannot be read or is of another kind than the first, or no file with a point
        that is chosen.
    """
    for path in paths:
        if suffix_of(path) not in CLOUD_SUFFIXES:
            raise InputFileError(
                f"{path}: {paths[0]} is a point cloud, this does not end in "
                f"{any_of(CLOUD_SUFFIXES)}; name files of one kind."
            )
    names, read = _read_those_with_points(paths, options)
    clouds = [cloud for cloud, _ in read]
    cloud = merged_cloud(names, clouds) if clouds[1:] else clouds[0]
    if any(attribute.dimension == HEIGHT_ABOVE_GROUND for attribute in cloud.attributes):
        note(
            "hag_by_file",
            "heights above the ground are taken from the ground points of the same file; near the "
            "borders of files they are less reliable",
        )
    places = [place for _, place in read]
    return cloud, agreed(names, places, any_crs=any_crs, any_unit=any_unit)


def _read_those_with_points(
    paths: Sequence[str], options: dict[str, Any]
) -> tuple[list[str], list[tuple[PointCloud, Georeference]]]:
    """Return the files in which points are chosen, and what was read of each."""
    names, read, without = [], [], []
    for path in paths:
        try:
            read.append(read_cloud(path, **options))
            names.append(path)
        except NoneChosenError as error:
            without.append((path, error))
    if not read:
        raise without[0][1]
    if without:
        note(
            "files_without_points",
            "{n_without} of {n_files} files have no point of the chosen classes or in the box and "
            "are passed over, the first is {name}",
            n_without=len(without),
            n_files=len(paths),
            name=without[0][0],
        )
    return names, read
