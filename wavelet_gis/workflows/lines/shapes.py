"""Shapes of files and objects as constraints of a terrain: brought to its frame, cut, put in order.

Everything happens in the working frame, where the corners of the terrain's own outline are vertices
to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.mesh.location import cover_of
from wavelet_gis.errors import InputFileError, LayerWarning
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import collected, note, warn
from wavelet_gis.workflows.lines.constraints import Constraints, constrained, same_place
from wavelet_gis.workflows.lines.layer_shapes import LINES, POINTS, POLYGONS, shapes_in_frame

__all__ = ["terrain_with_shapes"]

FloatArray = NDArray[np.float64]
Shapes = NDArray[Any]

#: A terrain whose outline takes this much of its convex hull has no gaps.
_WHOLE = 1 - 1e-6


def terrain_with_shapes(
    terrain: Terrain,
    *,
    breaklines: Any = None,
    clip: Any = None,
    fixed_points: Any = None,
    line_tolerance: float | None = None,
) -> Terrain:
    """Return a terrain with breaklines as edges, clipped, and with fixed points.

    Parameters
    ----------
    terrain : Terrain
        Of a raster, a point cloud or points.
    breaklines : path or GeoDataFrame, optional
        Lines. With z they keep it; without it they are laid on the terrain.
    clip : path or GeoDataFrame, optional
        Polygons; only the terrain inside is left, their rings become edges.
    fixed_points : path or GeoDataFrame, optional
        Points that become vertices; without z they are laid on the terrain.
    line_tolerance : float, optional
        How far a line that is laid on the terrain may be off for the sake of fewer vertices, in the
        unit of z; by default a thousandth of the relief.

    Raises
    ------
    InputFileError
        A file that cannot be read, shapes of another kind, or none where the terrain is.
    CrsError
        Shapes that cannot be brought to the CRS of the terrain.
    OptionError
        A tolerance without lines, or one that is no length.
    """
    if line_tolerance is not None and not 0 <= line_tolerance < np.inf:
        raise OptionError("{0} is {given}; give 0 or more.", "line_tolerance", given=line_tolerance)
    if breaklines is None and clip is None:
        if line_tolerance is not None:
            raise OptionError(
                "{0} is for lines; give {1} or {2}, or leave it out.",
                "line_tolerance",
                "breaklines",
                "clip",
            )
        if fixed_points is None:
            return terrain
    with collected() as notes:
        mesh = terrain.mesh
        snap = _snapping(mesh)
        domain, is_whole = _domain(mesh)
        area, cutter = domain, None
        if clip is not None:
            cutter = _united(_shapes(terrain, clip, "clip", POLYGONS))
            area = _polygons_in(domain.intersection(cutter))
            if area.is_empty:
                raise _beside(terrain, "clip")
        lines = fixed = None
        if breaklines is not None:
            lines = snap(_lines_in(_shapes(terrain, breaklines, "breaklines", LINES)))
        if fixed_points is not None:
            fixed = snap(_shapes(terrain, fixed_points, "fixed_points", POINTS))
        constraints = _cut(terrain, lines, cutter, domain, is_whole)
        if fixed is not None:
            constraints = constraints._replace(points=_points_within(terrain, fixed, area))
        result = constrained(terrain, constraints, line_tolerance)
    return result.with_notes([*terrain.notes, *notes])


def _shapes(terrain: Terrain, data: Any, option: str, kind: tuple[tuple[int, ...], str]) -> Shapes:
    return shapes_in_frame(terrain, data, option, kind)[0]


def _snapping(mesh: TriangleMesh) -> Callable[[Shapes], Shapes]:
    """Return what moves corners that are at the place of a vertex onto it, to the last bit."""
    import shapely

    near, tree = same_place(mesh.vertices), cKDTree(mesh.vertices[:, :2])

    def snap(coordinates: FloatArray) -> FloatArray:
        distance, nearest = tree.query(coordinates[:, :2], distance_upper_bound=near)
        is_there = np.isfinite(distance)
        snapped = np.array(coordinates)
        snapped[is_there, :2] = mesh.vertices[nearest[is_there], :2]
        return snapped

    return lambda shapes: np.asarray(shapely.transform(shapes, snap, include_z=True), dtype=object)


def _domain(mesh: TriangleMesh) -> tuple[Any, bool]:
    """Return the area that the faces cover, and whether it is its own convex hull."""
    import shapely

    starts = mesh.faces.ravel()
    ends = np.roll(mesh.faces, -1, axis=1).ravel()
    key, back = starts * mesh.n_vertices + ends, ends * mesh.n_vertices + starts
    outer = ~np.isin(key, back)
    plan = mesh.vertices[:, :2]
    edges = shapely.linestrings(np.stack([plan[starts[outer]], plan[ends[outer]]], axis=1))
    rings = shapely.get_parts(shapely.polygonize(edges))
    # What rings enclose is either terrain or a gap.
    inside = shapely.get_coordinates(shapely.point_on_surface(rings))
    covered = np.zeros(len(rings), dtype=bool)
    covered[cover_of(mesh, inside).point] = True
    area = shapely.union_all(rings[covered])
    is_whole = bool(area.area >= _WHOLE * area.convex_hull.area)
    return (area.convex_hull if is_whole else area), is_whole


def _united(polygons: Shapes) -> Any:
    import shapely

    flat = shapely.force_2d(polygons)
    return _polygons_in(shapely.union_all(shapely.make_valid(flat)))


def _polygons_in(shape: Any) -> Any:
    """Return the polygons among the parts of a shape as one."""
    import shapely

    parts = shapely.get_parts(shapely.get_parts(shape))
    return shapely.union_all(parts[shapely.get_dimensions(parts) == 2])


def _lines_in(shapes: Shapes) -> Shapes:
    import shapely

    parts = shapely.get_parts(shapes)
    return parts[shapely.length(parts) > 0]


def _cut(
    terrain: Terrain, lines: Shapes | None, clip: Any, domain: Any, is_whole: bool
) -> Constraints:
    """Return lines and rings, cut where they meet one another and sorted into the two again."""
    import shapely

    near = same_place(terrain.mesh.vertices)
    area = domain if clip is None else _polygons_in(domain.intersection(clip))
    outline = shapely.LineString() if clip is None else clip.boundary
    whole = shapely.LineString()
    if lines is not None:
        whole = shapely.union_all(shapely.force_2d(lines))
        share = whole.intersection(area).length / whole.length if whole.length else 0.0
        if share == 0:
            raise _beside(terrain, "breaklines")
        _note_cuts(terrain, lines, 1 - share)
    pieces = shapely.get_parts(shapely.union_all([whole, outline, domain.boundary]))
    middles = shapely.line_interpolate_point(pieces, 0.5, normalized=True)
    shapely.prepare(area)
    stays = shapely.dwithin(area, middles, near) & (shapely.length(pieces) > near)
    pieces = pieces[stays]
    on_outline = _lie_on(pieces, outline, near)
    on_border = ~on_outline & _lie_on(pieces, domain.boundary, near)
    arrays = _with_heights(pieces, lines, near)

    def contains(positions: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(shapely.intersects_xy(area, *positions.T))

    return Constraints(
        [arrays[k] for k in np.flatnonzero(~(on_outline | on_border))],
        [arrays[k] for k in np.flatnonzero(on_outline)],
        None if clip is None and is_whole else contains,
        # A hull without gaps is the outline of any triangulation.
        () if is_whole else [arrays[k] for k in np.flatnonzero(on_border)],
    )


def _note_cuts(terrain: Terrain, lines: Shapes, share_outside: float) -> None:
    import shapely

    flat = shapely.force_2d(lines)
    a, b = shapely.STRtree(flat).query(flat, predicate="crosses")
    n_crossings = int(np.count_nonzero(a < b)) + int(np.count_nonzero(~shapely.is_simple(flat)))
    if n_crossings:
        note(
            "breaklines_cross",
            "{name}: breaklines cross one another ({n_crossings} pairs); they are cut there",
            name=terrain.name,
            n_crossings=n_crossings,
        )
    if share_outside > 1e-6:
        note(
            "breaklines_outside",
            "{name}: {share:.1%} of the length of the breaklines is outside the terrain and left "
            "out",
            name=terrain.name,
            share=share_outside,
        )


def _lie_on(pieces: Shapes, line: Any, near: float) -> NDArray[np.bool_]:
    """Return which pieces run along a line: at three places between their ends."""
    import shapely

    if line.is_empty:
        return np.zeros(len(pieces), dtype=bool)
    shapely.prepare(line)
    along = np.ones(len(pieces), dtype=bool)
    for share in (0.21, 0.5, 0.83):
        place = shapely.line_interpolate_point(pieces, share, normalized=True)
        along &= shapely.dwithin(place, line, near)
    return along


def _with_heights(pieces: Shapes, lines: Shapes | None, near: float) -> list[FloatArray]:
    """Return the corners of pieces with the z that the lines have there, NaN where they have none.

    Where lines of different heights meet, the mean is taken, with a warning.
    """
    import shapely

    plan, owner = shapely.get_coordinates(pieces, return_index=True)
    z = np.full(len(plan), np.nan)
    segments = _segments_with_z(lines)
    if len(segments):
        tree = shapely.STRtree(shapely.linestrings(segments[:, :, :2]))
        point, segment = tree.query(shapely.points(plan), predicate="dwithin", distance=near)
        start, stop = segments[segment, 0], segments[segment, 1]
        along = stop[:, :2] - start[:, :2]
        at = ((plan[point] - start[:, :2]) * along).sum(axis=1) / (along**2).sum(axis=1)
        height = start[:, 2] + np.clip(at, 0, 1) * (stop[:, 2] - start[:, 2])
        count = np.bincount(point, minlength=len(plan))
        known = count > 0
        total = np.bincount(point, height, len(plan))
        z[known] = total[known] / count[known]
        apart = np.abs(height - z[point]).max(initial=0.0)
        if apart > 1e-6 + near:
            warn(
                LayerWarning,
                "heights_of_lines_differ",
                "breaklines that meet are up to {apart:.4g} apart in height, in the working unit; "
                "the mean is taken",
                stacklevel=5,
                apart=2 * float(apart),
            )
    corners = np.column_stack([plan, z])
    return np.split(corners, np.flatnonzero(np.diff(owner)) + 1) if len(corners) else []


def _segments_with_z(lines: Shapes | None) -> FloatArray:
    import shapely

    if lines is None:
        return np.empty((0, 2, 3))
    corners, owner = shapely.get_coordinates(lines, include_z=True, return_index=True)
    segments = np.stack([corners[:-1], corners[1:]], axis=1)
    is_one = (owner[1:] == owner[:-1]) & np.isfinite(segments[:, :, 2]).all(axis=1)
    return segments[is_one & (segments[:, 0, :2] != segments[:, 1, :2]).any(axis=1)]


def _points_within(terrain: Terrain, shapes: Shapes, area: Any) -> FloatArray:
    """Return the fixed points inside, each place once."""
    import shapely

    points = shapely.get_coordinates(shapes, include_z=True)
    _, first = np.unique(points[:, :2], axis=0, return_index=True)
    points = points[np.sort(first)]
    inside = shapely.intersects_xy(area, *points[:, :2].T)
    if not inside.any():
        raise _beside(terrain, "fixed_points")
    if not inside.all():
        note(
            "fixed_points_outside",
            "{name}: {n_points} fixed points are outside the terrain and left out",
            name=terrain.name,
            n_points=int(np.count_nonzero(~inside)),
        )
    return points[inside]


def _beside(terrain: Terrain, option: str) -> InputFileError:
    return InputFileError(
        "{name}: nothing of {0} is where the terrain is; check that the files overlap, and their "
        "CRS.",
        option,
        name=terrain.name,
    )
