"""Point cloud to the same cloud with its ground classified, without training."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.errors import MeshError, OptionError
from wavelet_core.features.ground import (
    HEIGHT_TOLERANCE,
    LARGEST_OBJECT,
    LEAST_SLOPE,
    ground_points,
)
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.formats import CLOUD_SUFFIXES, any_of, suffix_of
from wavelet_gis.model.attributes.ground import GROUND_CLASS
from wavelet_gis.model.points.cloud import PointCloud, cloud_bounds
from wavelet_gis.model.terrain import Terrain, frame_of_bounds, require_plan
from wavelet_gis.workflows.learning.labels import NOT_KNOWN, with_classes

__all__ = ["UNCLASSIFIED", "ClassifiedGround", "classify_ground", "ground_of_cloud"]

#: ASPRS class of points that are no ground.
UNCLASSIFIED = 1

_FEWEST_POINTS = 3


@dataclass(frozen=True, slots=True)
class ClassifiedGround:
    """A point cloud, and which of its points are ground.

    Attributes
    ----------
    cloud : PointCloud
        As it was read.
    is_ground : (n_points,) bool
        The ground.
    """

    cloud: PointCloud
    is_ground: NDArray[np.bool_]

    def classified(self) -> PointCloud:
        """Return the cloud with class 2 where the ground is and 1 elsewhere.

        Noise (7 and 18) and withheld points keep their class: they were not looked at.
        """
        classes = np.where(self.is_ground, GROUND_CLASS, UNCLASSIFIED).astype(np.int64)
        if self.cloud.aside is not None:
            classes[self.cloud.aside] = NOT_KNOWN
        return with_classes(self.cloud, classes)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write LAS or LAZ, all else as it came; see `wavelet_gis.workflows.save.save`."""
        from wavelet_gis.io.las import write_cloud

        if suffix_of(path) not in CLOUD_SUFFIXES:
            raise OptionError(
                f"{os.fspath(path)}: classified points are a cloud; give an output ending in "
                f"{any_of(CLOUD_SUFFIXES)}."
            )
        write_cloud(path, self.classified())

    def figures(self) -> dict[str, Any]:
        """Return how many points are what, as JSON-able values."""
        n_ground = int(np.count_nonzero(self.is_ground))
        return {
            "n_points": self.cloud.n_points,
            "n_ground": n_ground,
            "n_other": self.cloud.n_used - n_ground,
            "n_aside": self.cloud.n_points - self.cloud.n_used,
        }


def classify_ground(
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | Terrain,
    *,
    largest_object: float = LARGEST_OBJECT,
    least_slope: float = LEAST_SLOPE,
    height_tolerance: float = HEIGHT_TOLERANCE,
    crs: str | None = None,
    vertical_unit: str | None = None,
    progress: Progress | None = None,
) -> ClassifiedGround:
    """Return which points of a cloud are ground, from their heights alone.

    Parameters
    ----------
    data : path, sequence of path, or Terrain
        LAS, LAZ or COPC files, a folder of them, or what `wavelet_gis.open` made of such.
    largest_object, least_slope, height_tolerance
        See `wavelet_core.features.ground.ground_points`; lengths in metres.
    crs, vertical_unit : str, optional
        Instead of what the files say.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    InputFileError
        No point cloud, or one of fewer than three points.
    OptionError
        An option that is not above 0, or a CRS for a terrain that is open already.
    Cancelled
        ``progress`` returned False.
    """
    options = {
        "largest_object": largest_object,
        "least_slope": least_slope,
        "height_tolerance": height_tolerance,
    }
    if isinstance(data, Terrain):
        if crs or vertical_unit:
            raise OptionError(
                "{0} and {1} are for files; give them when opening.", "crs", "vertical_unit"
            )
        if not isinstance(data.original, PointCloud):
            raise InputFileError(f"{data.name}: this is no point cloud; name LAS or LAZ files.")
        return _classified(
            data.name, data.original, data.frame, data.system.working_unit, options, progress
        )
    from wavelet_gis.workflows.opening.raster_or_cloud import open_points

    read = open_points(data, crs=crs, vertical_unit=vertical_unit)
    return ground_of_cloud(
        read.name,
        read.cloud,
        read.system,
        read.vertical_unit,
        fault=read.fault,
        progress=progress,
        **options,
    )


def ground_of_cloud(
    name: str,
    cloud: PointCloud,
    system: CoordinateSystem,
    vertical_unit: str | None = None,
    *,
    fault: str = "",
    progress: Progress | None = None,
    **options: float,
) -> ClassifiedGround:
    """Return which points of a cloud that is in memory already are ground.

    Parameters
    ----------
    name : str
        For messages.
    cloud : PointCloud
        The points.
    system : CoordinateSystem
        Their CRS.
    vertical_unit, fault
        See `wavelet_gis.model.terrain.terrain_of_cloud`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    **options
        See `classify_ground`.
    """
    if cloud.n_used < _FEWEST_POINTS:
        raise InputFileError(
            f"{name}: the cloud has {cloud.n_used} points that are neither noise nor withheld; a "
            f"ground needs at least {_FEWEST_POINTS}."
        )
    require_plan(name, cloud, system)
    frame, _ = frame_of_bounds(name, system, cloud_bounds(cloud), vertical_unit, fault)
    return _classified(name, cloud, frame, system.working_unit, options, progress)


def _classified(
    name: str,
    cloud: PointCloud,
    frame: LocalFrame,
    metres: float,
    options: dict[str, float],
    progress: Progress | None,
) -> ClassifiedGround:
    used = np.ones(cloud.n_points, dtype=bool) if cloud.aside is None else ~cloud.aside
    # Of differences to the first point: metres of millions of feet would lose digits.
    points = frame.to_local(cloud.coordinates()[used])
    points = (points - points[0]) * metres
    is_ground = np.zeros(cloud.n_points, dtype=bool)
    try:
        is_ground[used] = ground_points(points, progress=progress, **options)
    except MeshError as error:
        raise InputFileError(f"{name}: {error}") from error
    return ClassifiedGround(cloud, is_ground)
