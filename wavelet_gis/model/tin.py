"""TINs out of points and lines, or of triangles that come one by one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh
from wavelet_core.errors import MeshError
from wavelet_core.mesh.location import surface_errors
from wavelet_core.mesh.triangulation import Merged, delaunay_faces, merge_duplicates
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import InputFileError, PointCloudWarning
from wavelet_gis.model.dem import LARGEST_COORDINATE, LARGEST_ELEVATION
from wavelet_gis.model.terrain import Terrain, frame_of_bounds, terrain_of_mesh
from wavelet_gis.notes import collected, warn

__all__ = [
    "SAME_PLACE",
    "ConstrainedTin",
    "frame_of_coordinates",
    "mesh_of_corners",
    "points_merged",
    "terrain_of_points",
    "terrain_of_triangles",
    "tin_with_lines",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Points that are closer in plan than this, as a share of the largest coordinate, are at one place.
SAME_PLACE = 1e-10


class ConstrainedTin(NamedTuple):
    """A TIN that has given lines as edges.

    mesh : TriangleMesh
    is_on_line : (n_vertices,) bool, the vertices of the breaklines
    is_on_outline : (n_vertices,) bool, the vertices of the outline
    is_marked : (n_vertices,) bool, the points that were marked
    replaced : (n_replaced, 3) float64, points on a line, which stands for them
    """

    mesh: TriangleMesh
    is_on_line: BoolArray
    is_on_outline: BoolArray
    is_marked: BoolArray
    replaced: FloatArray


def tin_with_lines(
    points: FloatArray,
    attributes: FloatArray,
    attribute_names: Sequence[str],
    *,
    breaklines: Sequence[FloatArray] = (),
    outline: Sequence[FloatArray] = (),
    border: Sequence[FloatArray] = (),
    contains: Callable[[FloatArray], BoolArray] | None = None,
    is_marked: BoolArray | None = None,
) -> ConstrainedTin:
    """Return the Delaunay TIN of points in which breaklines and an outline are edges.

    Parameters
    ----------
    points : ndarray, shape (n_points, 3)
        x, y, z; only points inside the outline.
    attributes : ndarray, shape (n_points, n_attributes)
        Their attributes.
    attribute_names : sequence of str
        One name an attribute.
    breaklines, outline : sequence of ndarray, shape (n, 3)
        Lines, and the rings of a clip polygon (closed: the last corner repeats the first). They
        may share corners but must not cross. Where z is NaN it is that of the TIN of the points.
    border : sequence of ndarray, shape (n, 3)
        More such lines, of the terrain itself, which the result does not report on.
    contains : callable, optional
        Takes (m, 2) positions and returns which are inside outline and border.
    is_marked : ndarray of bool, shape (n_points,), optional
        Points to be marked in the result, for locking.

    Returns
    -------
    ConstrainedTin
        Vertices that lines add have the attributes of the nearest point. Points on a line that are
        not marked are no vertices: they would split its edges.

    Raises
    ------
    MeshError
        Fewer than three points, or lines that cross.
    MissingDependencyError
        pythoncdt is absent, and neither SciPy nor GEOS can triangulate the points.
    """
    rings = [ring for ring in outline if len(ring) > 1]
    borders = [ring for ring in border if len(ring) > 1]
    own = [line for line in breaklines if len(line) > 1]
    lines = [*own, *rings, *borders]
    n_own, n_rings = (sum(map(len, part)) for part in (own, rings))
    of_lines = np.concatenate(lines) if lines else np.empty((0, 3))
    of_lines = _with_heights(of_lines, points)
    is_marked = np.zeros(len(points), dtype=bool) if is_marked is None else is_marked
    splits = _on_segments(points, lines) & ~is_marked
    # Where every point is on a line, the lines have the attributes of those that they stand for.
    givers = splits if splits.all() else ~splits
    nearest = cKDTree(points[givers, :2]).query(of_lines[:, :2])[1] if len(of_lines) else []
    columns = np.concatenate([attributes[~splits], attributes[givers][nearest]])
    replaced, points = points[splits], points[~splits]
    is_marked, n_points = is_marked[~splits], len(points)
    vertices = np.concatenate([points, of_lines])
    merged = _merged_by_line(vertices, n_points)
    edges = _edges_of(lines, n_points, merged.representative)
    part = np.repeat([0, 1, 2, 3], [n_points, n_own, n_rings, len(of_lines) - n_own - n_rings])
    marked = np.concatenate([is_marked, np.zeros(len(of_lines), dtype=bool)])
    kept, count = merged.kept, len(merged.kept)
    plan = vertices[kept]
    faces = delaunay_faces(plan[:, :2], edges if len(edges) else None)
    if contains is not None and (rings or borders):
        faces = _inside(plan, faces, _any_of(part >= 2, merged.representative, count), contains)
    mesh = TriangleMesh(plan, faces, columns[kept], attribute_names)
    is_of_line = (kept >= n_points)[merged.representative[:n_points]]
    return ConstrainedTin(
        mesh,
        _any_of(part == 1, merged.representative, count),
        _any_of(part == 2, merged.representative, count),
        _any_of(marked, merged.representative, count),
        np.concatenate([replaced, points[is_of_line]]),
    )


def mesh_of_corners(corners: FloatArray) -> TriangleMesh:
    """Return the mesh of triangles given one by one; equal corners become one vertex.

    Parameters
    ----------
    corners : ndarray, shape (n_faces, 3, 3)
        Face, corner, x y z; rings may run either way.

    Raises
    ------
    MeshError
        When there is no triangle.

    Examples
    --------
    >>> import numpy as np
    >>> a, b, c, d = [0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 1, 8]
    >>> mesh = mesh_of_corners(np.array([[a, b, c], [c, b, d]], dtype=float))
    >>> mesh.n_vertices, mesh.n_faces
    (4, 2)
    """
    if len(corners) == 0:
        raise MeshError("there is no triangle; give a layer of triangles.")
    vertices, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = index.reshape(-1, 3)
    a, b, c = faces.T
    is_flat = (a == b) | (b == c) | (c == a)
    return TriangleMesh.from_triangles(vertices, faces[~is_flat])


def points_merged(name: str, points: FloatArray, local: FloatArray) -> FloatArray:
    """Return the points that a lower one at their place stands for, and warn of them.

    Parameters
    ----------
    name : str
        For the warning.
    points : ndarray, shape (n_points, 3)
        x, y, z in the CRS.
    local : ndarray, shape (n_points, 3)
        The same in the working frame.

    Returns
    -------
    ndarray, shape (n_merged, 3)
        In the working frame.

    Warns
    -----
    PointCloudWarning
        How many they are, and how far they are from what stands for them.
    """
    merged = merge_duplicates(local)
    others = np.delete(np.arange(len(points)), merged.kept)
    if len(others):
        apart = points[others, 2] - points[merged.kept[merged.representative[others]], 2]
        warn(
            PointCloudWarning,
            "merged_points",
            "{name}: {n_points} points share x and y with others; the {rule} of each place stands "
            "for them, up to {largest:.4g} off (root mean square {rms:.4g})",
            stacklevel=3,
            name=name,
            rule="lowest",
            n_points=len(others),
            largest=float(apart.max()),
            rms=float(np.sqrt(np.mean(apart**2))),
        )
    return local[others]


def frame_of_coordinates(
    name: str, coordinates: FloatArray, system: CoordinateSystem, vertical_unit: str | None = None
) -> tuple[LocalFrame, str]:
    """Return the working frame over coordinates in a CRS, and the name of their unit of z.

    Parameters
    ----------
    name : str
        Of the layer, for messages.
    coordinates : ndarray, shape (n, 3)
        In the CRS.
    system : CoordinateSystem
        The CRS.
    vertical_unit : str, optional
        Unit of z; see `wavelet_gis.crs.frame.working_frame` for what holds without it.

    Raises
    ------
    MeshError
        When there is not one point.
    CrsError
        When the CRS or its extent cannot be used.
    """
    if len(coordinates) == 0:
        raise MeshError(
            f"{name}: there are no points; check the layer, its filter and its selection."
        )
    low, high = coordinates.min(axis=0), coordinates.max(axis=0)
    return frame_of_bounds(name, system, (low[0], low[1], high[0], high[1]), vertical_unit)


def terrain_of_points(
    name: str,
    points: FloatArray,
    attributes: FloatArray,
    attribute_names: Sequence[str],
    system: CoordinateSystem,
    vertical_unit: str | None = None,
) -> Terrain:
    """Return the terrain of points that are in memory already: their Delaunay TIN.

    Parameters
    ----------
    name : str
        For messages and metadata.
    points : ndarray, shape (n_points, 3)
        x, y, z in the CRS.
    attributes : ndarray, shape (n_points, n_attributes)
        Lifted along with z.
    attribute_names : sequence of str
        One name an attribute.
    system : CoordinateSystem
        The CRS.
    vertical_unit : str, optional
        Unit of z; see `wavelet_gis.crs.frame.working_frame` for what holds without it.

    Raises
    ------
    InputFileError
        Numbers that are not finite.
    MeshError
        Fewer than three points, or all of them on one line.
    """
    if not (np.isfinite(points).all() and np.isfinite(attributes).all()):
        raise InputFileError(
            f"{name}: some coordinates or attributes are not finite; leave those points out."
        )
    _require_coordinates(name, points, "point")
    with collected() as notes:
        frame, unit = frame_of_coordinates(name, points, system, vertical_unit)
        local = frame.to_local(points)
        try:
            mesh = TriangleMesh.from_points(local, attributes, attribute_names)
        except MeshError as error:
            raise MeshError(f"{name}: {error}", error.index) from error
        merged = points_merged(name, points, local)
    terrain = terrain_of_mesh(name, mesh, system, frame, unit).with_notes(notes)
    return replace(terrain, merged=merged)


def terrain_of_triangles(
    name: str,
    corners: FloatArray,
    system: CoordinateSystem,
    vertical_unit: str | None = None,
) -> Terrain:
    """Return the terrain of triangles that are in memory already.

    Parameters
    ----------
    name : str
        For messages and metadata.
    corners : ndarray, shape (n_faces, 3, 3)
        Face, corner, x y z, in the CRS.
    system : CoordinateSystem
        The CRS.
    vertical_unit : str, optional
        Unit of z; see `wavelet_gis.crs.frame.working_frame` for what holds without it.

    Raises
    ------
    MeshError
        No triangle, or triangles that are no surface.
    """
    flat = corners.reshape(-1, 3)
    _require_coordinates(name, flat, "corner of a triangle")
    with collected() as notes:
        frame, unit = frame_of_coordinates(name, flat, system, vertical_unit)
    mesh = mesh_of_corners(frame.to_local(flat).reshape(corners.shape))
    return terrain_of_mesh(name, mesh, system, frame, unit).with_notes(notes)


def _require_coordinates(name: str, coordinates: FloatArray, what: str) -> None:
    """Refuse coordinates that are not finite, or that no CRS has, before work begins."""
    with np.errstate(invalid="ignore"):
        is_sound = np.abs(coordinates) <= [
            LARGEST_COORDINATE,
            LARGEST_COORDINATE,
            LARGEST_ELEVATION,
        ]
    if not is_sound.all():
        row = int(np.argmin(is_sound.all(axis=1)))
        x, y, z = coordinates[row]
        raise InputFileError(
            f"{name}: a {what} is at x {x:.8g}, y {y:.8g}, z {z:.8g}, which no terrain has; leave "
            "it out, or put its coordinates right."
        )


def _with_heights(of_lines: FloatArray, points: FloatArray) -> FloatArray:
    """Fill the heights that are NaN from the TIN of the points, or the nearest one outside it."""
    missing = np.isnan(of_lines[:, 2])
    if not missing.any():
        return of_lines
    of_lines = of_lines.copy()
    at_zero = np.column_stack([of_lines[missing, :2], np.zeros(np.count_nonzero(missing))])
    heights = -surface_errors(TriangleMesh.from_points(points), at_zero)
    uncovered = np.isnan(heights)
    if uncovered.any():
        nearest = cKDTree(points[:, :2]).query(at_zero[uncovered, :2])[1]
        heights[uncovered] = points[nearest, 2]
    of_lines[missing, 2] = heights
    return of_lines


def _on_segments(points: FloatArray, lines: Sequence[FloatArray]) -> BoolArray:
    """Return which points lie on a segment of the lines, between its ends, in plan."""
    on = np.zeros(len(points), dtype=bool)
    if not lines or len(points) == 0:
        return on
    start = np.concatenate([line[:-1, :2] for line in lines])
    along = np.concatenate([line[1:, :2] for line in lines]) - start
    length = np.hypot(*along.T)
    start, along, length = (part[length > 0] for part in (start, along, length))
    near = SAME_PLACE * float(np.abs(points[:, :2]).max())
    # Each segment looks around as many middles as leave it few points to look at.
    step = 4.0 * float(np.sqrt(np.prod(np.ptp(points[:, :2], axis=0)) / len(points))) or np.inf
    n_steps = np.maximum(np.ceil(length / step), 1).astype(np.int64)
    segment = np.repeat(np.arange(len(length)), n_steps)
    number = np.arange(len(segment)) - np.repeat(np.cumsum(n_steps) - n_steps, n_steps)
    middles = start[segment] + ((number + 0.5) / n_steps[segment])[:, None] * along[segment]
    reach = 0.5 * length[segment] / n_steps[segment] * (1 + 1e-9) + near
    hits = cKDTree(points[:, :2]).query_ball_point(middles, reach)
    segment = np.repeat(segment, [len(hit) for hit in hits])
    point = np.fromiter(chain.from_iterable(hits), dtype=np.int64, count=len(segment))
    offset, along, length = points[point, :2] - start[segment], along[segment], length[segment]
    at = (offset * along).sum(axis=1) / length
    aside = np.abs(offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / length
    on[point[(aside <= near) & (at > near) & (at < length - near)]] = True
    return on


def _merged_by_line(vertices: FloatArray, n_points: int) -> Merged:
    """Merge vertices at one place; those of a line stand for the points there."""
    ranked = vertices.copy()
    # merge_duplicates keeps the lowest, so lines are put below all points.
    ranked[n_points:, 2] = vertices[:, 2].min(initial=0.0) - 1.0
    return merge_duplicates(ranked)


def _edges_of(lines: Sequence[FloatArray], first: int, representative: IntArray) -> IntArray:
    edges = []
    start = first
    for line in lines:
        ids = representative[start : start + len(line)]
        edges.append(np.column_stack([ids[:-1], ids[1:]]))
        start += len(line)
    if not edges:
        return np.empty((0, 2), dtype=np.int64)
    joined = np.sort(np.concatenate(edges), axis=1)
    return np.unique(joined[joined[:, 0] != joined[:, 1]], axis=0)


def _inside(
    vertices: FloatArray,
    faces: IntArray,
    is_ring: BoolArray,
    contains: Callable[[FloatArray], BoolArray],
) -> IntArray:
    """Drop the faces outside the rings: only those between three corners of rings can be."""
    doubtful = is_ring[faces].all(axis=1)
    centres = vertices[faces[doubtful], :2].mean(axis=1)
    keep = np.ones(len(faces), dtype=bool)
    keep[doubtful] = contains(centres)
    if not keep.any():
        raise MeshError(
            "nothing of the terrain is inside the clip polygon; give one that overlaps."
        )
    return faces[keep]


def _any_of(flags: BoolArray, representative: IntArray, n_vertices: int) -> BoolArray:
    result = np.zeros(n_vertices, dtype=bool)
    result[representative[flags]] = True
    return result
