"""What a solver asks of a mesh: its angles, edges and areas."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wavelet_core import TriangleMesh

__all__ = ["MeshQuality", "quality_of", "triangle_quality"]

#: Triangles with an angle below this are called slivers, in degrees.
SLIVER_ANGLE = 10.0


class MeshQuality(NamedTuple):
    """Extremes of the triangles of a mesh, in plan.

    smallest_angle, largest_angle : float, degrees
    shortest_edge, longest_edge : float, in the unit of x and y
    smallest_area, largest_area : float, in that unit squared
    """

    smallest_angle: float
    largest_angle: float
    shortest_edge: float
    longest_edge: float
    smallest_area: float
    largest_area: float


def quality_of(mesh: TriangleMesh, unit: float = 1.0) -> MeshQuality:
    """Return the extremes of a mesh.

    Parameters
    ----------
    mesh : TriangleMesh
        With at least one face.
    unit : float
        Of the mesh, by which lengths are divided.

    Examples
    --------
    >>> from wavelet_core import synthetic
    >>> quality_of(synthetic.plane()).smallest_angle
    45.0
    """
    plan = mesh.vertices[:, :2] / unit
    corners = plan[mesh.faces]
    opposite = np.linalg.norm(corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]], axis=2)
    a, b, c = np.sort(opposite, axis=1).T  # the shortest first: the smallest angle is across it
    smallest = np.degrees(np.arccos(np.clip((b * b + c * c - a * a) / (2 * b * c), -1, 1)))
    largest = np.degrees(np.arccos(np.clip((a * a + b * b - c * c) / (2 * a * b), -1, 1)))
    areas = mesh.plan_areas / unit**2
    return MeshQuality(
        round(float(smallest.min()), 9),
        round(float(largest.max()), 9),
        float(a.min()),
        float(c.max()),
        float(areas.min()),
        float(areas.max()),
    )


def triangle_quality(mesh: TriangleMesh) -> dict[str, float]:
    """Return median and 5th percentile of the smallest angles in plan, and the share of slivers.

    Parameters
    ----------
    mesh : TriangleMesh
        At least one face, or all figures are NaN.

    Examples
    --------
    >>> from wavelet_core import synthetic
    >>> triangle_quality(synthetic.plane())["median_smallest_angle"]
    45.0
    """
    if mesh.n_faces == 0:
        return dict.fromkeys(
            ("median_smallest_angle", "low_smallest_angle", "sliver_share"), float("nan")
        )
    corners = mesh.vertices[mesh.faces, :2]
    sides = np.roll(corners, -1, axis=1) - corners
    before = -np.roll(sides, 1, axis=1)
    cross = sides[..., 0] * before[..., 1] - sides[..., 1] * before[..., 0]
    angles = np.degrees(np.arctan2(np.abs(cross), (sides * before).sum(axis=2))).min(axis=1)
    return {
        "median_smallest_angle": round(float(np.median(angles)), 6),
        "low_smallest_angle": round(float(np.quantile(angles, 0.05)), 6),
        "sliver_share": float(np.mean(angles < SLIVER_ANGLE)),
    }
