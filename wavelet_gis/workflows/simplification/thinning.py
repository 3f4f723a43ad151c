"""The points of a cloud that carry its surface."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.mesh.location import Cover, cover_of, surface_errors
from wavelet_core.progress import report
from wavelet_gis.io.formats import CLOUD_SUFFIXES, any_of, suffix_of
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.points.origin import CloudOrigin
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.workflows.extract import SurfaceErrors, measured

__all__ = ["Thinned", "cloud_to_thin", "thinned"]


class Thinned(NamedTuple):
    """The points of a cloud that carry its surface.

    cloud : PointCloud, each point as it came
    errors : SurfaceErrors, of their Delaunay triangles at all points of the surface
    """

    cloud: PointCloud
    errors: SurfaceErrors

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write LAS or LAZ; see `wavelet_gis.workflows.save.save`.

        Raises
        ------
        OptionError
            Another suffix.
        """
        from wavelet_gis.io.las import write_cloud

        if suffix_of(path) not in CLOUD_SUFFIXES:
            raise OptionError(
                f"{os.fspath(path)}: points of a cloud are a cloud; give an output ending in "
                f"{any_of(CLOUD_SUFFIXES)}."
            )
        write_cloud(path, self.cloud)

    def figures(self) -> dict[str, Any]:
        """Return how many points there are and how far off, as JSON-able values."""
        return {
            "n_points": self.cloud.n_points,
            "rmse": self.errors.rmse,
            "max_error": self.errors.max_error,
            "n_uncovered": self.errors.n_uncovered,
        }


def thinned(
    terrain: Terrain,
    vertex_ids: NDArray[np.int64],
    max_error: float | NDArray[np.float64] | None = None,
    progress: Progress | None = None,
) -> Thinned:
    """Return the points of a cloud that are vertices of a TIN, and more where a tolerance asks.

    Parameters
    ----------
    terrain : Terrain
        Of a point cloud.
    vertex_ids : (n_vertices,) int64
        The vertices of the TIN in it; -1 for none.
    max_error, progress
        See `wavelet_gis.workflows.simplification.simplified.Simplified.thinned`.

    Raises
    ------
    OptionError
        The terrain is no point cloud, or its vertices are no points of one.
    Cancelled
        ``progress`` returned False.
    """
    cloud, origin = cloud_to_thin(terrain)
    points, scale = terrain.mesh.vertices, terrain.frame.z_scale
    ids = vertex_ids[vertex_ids >= 0]
    limits = None if max_error is None else np.asarray(max_error) * scale
    while True:
        mesh = TriangleMesh.from_points(points[ids])
        cover = cover_of(mesh, points[:, :2])
        report(progress, 1.0 - len(vertex_ids) / len(ids))
        worst = _worst_of_faces(mesh, points, cover, limits)
        if len(worst) == 0:
            break
        ids = np.union1d(ids, worst)
    is_all = origin.n_points == len(points)
    every = points if is_all else terrain.points_for_errors()
    errors = measured(mesh, every, scale, cover if is_all else None)
    return Thinned(cloud.subset(origin.vertex_rows()[ids]), errors)


def cloud_to_thin(terrain: Terrain) -> tuple[PointCloud, CloudOrigin]:
    """Return the cloud of a terrain whose vertices are points of it.

    Raises
    ------
    OptionError
        The terrain is no point cloud, or its vertices are no points of one.
    """
    cloud, origin = terrain.original, terrain.origin
    if terrain.segments is not None and isinstance(cloud, PointCloud):
        raise OptionError(
            "{name}: with lines its vertices are no longer those of the cloud; leave {0} and "
            "{1} out.",
            "breaklines",
            "clip",
            name=terrain.name,
        )
    if not (isinstance(cloud, PointCloud) and isinstance(origin, CloudOrigin)):
        raise OptionError(
            "{name}: this is no point cloud, so there are no points to thin.",
            name=terrain.name,
        )
    if len(origin.shifts):
        raise OptionError(
            "{name}: {0} {rule!r} gives heights that no point has, so no points carry the "
            "surface; choose lowest, highest or first.",
            "duplicates",
            name=terrain.name,
            rule=origin.duplicates,
        )
    return cloud, origin


def _worst_of_faces(
    mesh: TriangleMesh,
    points: NDArray[np.float64],
    cover: Cover,
    limits: NDArray[np.float64] | None,
) -> NDArray[np.int64]:
    """Return the point of each face that is farthest off, where that is more than a tolerance."""
    if limits is None:
        return np.empty(0, dtype=np.int64)
    off = np.abs(surface_errors(mesh, points, cover)[cover.point])
    # Rounding of a vertex's own height must not add it again.
    of_each = np.broadcast_to(limits, (len(points),))[cover.point]
    is_off = off > np.maximum(of_each, 1e-9 * float(np.ptp(points[:, 2])))
    face, point, off = cover.face[is_off], cover.point[is_off], off[is_off]
    order = np.lexsort((point, -off, face))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = face[order[1:]] != face[order[:-1]]
    worst: NDArray[np.int64] = point[order[is_first]]
    return worst
