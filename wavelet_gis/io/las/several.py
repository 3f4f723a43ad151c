"""Several LAS files as one point cloud."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wavelet_gis.crs.agreement import agreed
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.formats import CLOUD_SUFFIXES, any_of, suffix_of
from wavelet_gis.io.las.cloud_reader import NothingInBoxError, read_cloud
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
        See `wavelet_gis.io.las.read_cloud`. Classes are chosen in each file, of which some may
        have none; heights above the ground are those above the ground of the same file. Files
        without a point in the box are passed over.

    Raises
    ------
    InputFileError
        A file that cannot be read or is of another kind than the first.
    """
    for path in paths:
        if suffix_of(path) not in CLOUD_SUFFIXES:
            raise InputFileError(
                f"{path}: {paths[0]} is a point cloud, this does not end in "
                f"{any_of(CLOUD_SUFFIXES)}; name files of one kind."
            )
    read, named = [], []
    for path in paths:
        try:
            read.append(read_cloud(path, **options))
            named.append(path)
        except NothingInBoxError:
            if path == paths[-1] and not read:
                raise
    if len(read) == 1:
        return read[0]
    cloud = merged_cloud(named, [cloud for cloud, _ in read])
    if any(attribute.dimension == HEIGHT_ABOVE_GROUND for attribute in cloud.attributes):
        note(
            "hag_by_file",
            "heights above the ground are taken from the ground points of the same file; near the "
            "borders of files they are less reliable",
        )
    places = [place for _, place in read]
    return cloud, agreed(named, places, any_crs=any_crs, any_unit=any_unit)
