"""A TIN made fit for a solver: after simplification, with as few nodes more as it takes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from wavelet_core import Progress, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.mesh.connectivity import edges_of
from wavelet_core.mesh.location import cover_of, surface_errors
from wavelet_core.progress import part_of, report
from wavelet_gis.workflows.solver.delaunay import LARGEST_MIN_ANGLE, DelaunayRefiner
from wavelet_gis.workflows.solver.size_field import SizeField, graded, pieces_within

__all__ = ["SolverMesh", "SolverRules", "edge_of_area", "solver_mesh"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Rounds in which points are added where the mesh is farther off than it may be, at most.
MOST_ROUNDS = 12

#: Of an equilateral triangle, edge squared over area.
_EDGE_SQUARED_PER_AREA = 4 / np.sqrt(3)

#: With a grading, edges at a vertex of the TIN may be so many times as long as to its neighbour.
_GRADED_FROM = 2.0


def edge_of_area(area: ArrayLike) -> FloatArray:
    """Return the edge of an even triangle: one with no longer edge has no larger area."""
    return np.sqrt(np.asarray(area, dtype=np.float64) * _EDGE_SQUARED_PER_AREA)


class SolverRules(NamedTuple):
    """What a solver asks for, lengths in the working frame.

    min_angle : float, degrees; 0 for any
    longest_edge, shortest_edge, max_area : float or None
    grading : float or None, by how much edges may grow for each unit of distance
    """

    min_angle: float = 25.0
    longest_edge: float | None = None
    shortest_edge: float | None = None
    max_area: float | None = None
    grading: float | None = None

    def require_sense(self) -> None:
        """Raise unless the rules can be met.

        Raises
        ------
        OptionError
            An angle that no mesh can have, or lengths that contradict each other.
        """
        if not 0 <= self.min_angle <= LARGEST_MIN_ANGLE:
            raise OptionError(
                "{0} is {given}; give 0 to {most:g} degrees.",
                "min_angle",
                given=self.min_angle,
                most=LARGEST_MIN_ANGLE,
            )
        for name in ("longest_edge", "shortest_edge", "max_area", "grading"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise OptionError("{0} is {given}; give a size above 0.", name, given=value)
        self.require_room(self.size_bound or np.inf)

    def require_room(self, longest: float) -> None:
        """Raise unless a longest edge leaves room for the shortest.

        Raises
        ------
        OptionError
            It is less than twice as long.
        """
        if 2 * (self.shortest_edge or 0.0) > longest:
            raise OptionError(
                "{0} is more than half of {1}, or of the edge of {2}; no mesh can be that uniform.",
                "shortest_edge",
                "longest_edge",
                "max_area",
            )

    @property
    def size_bound(self) -> float:
        """The edge that no triangle may exceed, 0 for any; of an area, that of an even triangle."""
        bounds = [self.longest_edge or np.inf]
        if self.max_area is not None:
            bounds.append(float(edge_of_area(self.max_area)))
        return 0.0 if min(bounds) == np.inf else min(bounds)


class SolverMesh(NamedTuple):
    """A mesh for a solver.

    mesh : TriangleMesh
    vertex_ids : (n_vertices,) int64, the input vertex that each node is; -1 of new ones
    n_removed, n_added : int, vertices of the TIN that went, and nodes that came
    n_above : int, input vertices that are farther off than they may be
    are_too_near : bool, whether those are so because nodes there would be too near to others
    """

    mesh: TriangleMesh
    vertex_ids: IntArray
    n_removed: int
    n_added: int
    n_above: int
    are_too_near: bool


def solver_mesh(
    tin: TriangleMesh,
    vertex_ids: IntArray,
    original: TriangleMesh,
    rules: SolverRules,
    *,
    locked: NDArray[np.bool_] | None = None,
    segments: FloatArray | None = None,
    limits: FloatArray | None = None,
    sizes: FloatArray | None = None,
    progress: Progress | None = None,
) -> SolverMesh:
    """Return a mesh of the terrain that has a TIN's vertices, and angles and edges within bounds.

    Parameters
    ----------
    tin : TriangleMesh
        What was simplified. Its outline, holes and the edges along ``segments`` stay edges, whole
        or split.
    vertex_ids : (n_vertices,) int64
        The vertices of ``original`` that its vertices lie on.
    original : TriangleMesh
        The terrain; new nodes lie on it.
    rules : SolverRules
        What the solver asks for.
    locked : (n_original,) bool, optional
        Vertices of ``original`` that stay, such as those of breaklines.
    segments : (n, 2, 2) float64, optional
        The pieces of breaklines and clip polygon in plan, from and to.
    limits : (n_original,) float64, optional
        How far each of its vertices may be off, vertically; where one is farther, it becomes a
        node, as far as ``shortest_edge`` allows.
    sizes : (n_original,) float64, optional
        The longest edge at each of its vertices, above 0, infinite for any: no triangle has a
        longer one than any vertex in it, or nearest to a corner of it, has for its size. With a
        grading of the rules, sizes are made to grow no faster, also from each vertex of the TIN,
        where edges may be twice as long as the way to the nearest other one.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        Rules that no mesh can meet, or that take too many nodes.
    MissingDependencyError
        Without CGAL's bindings.
    Cancelled
        ``progress`` returned False.
    """
    rules.require_sense()
    origin = original.vertices[:, :2].min(axis=0)
    is_locked = np.zeros(tin.n_vertices, bool) if locked is None else locked[vertex_ids]
    outline = _outline(tin.faces)
    along = _edges_along(tin, is_locked, segments)
    edges = np.unique(np.concatenate([outline, along]), axis=0)
    holds = is_locked.copy()
    holds[edges] = True
    kept = _apart(tin.vertices[:, :2], holds, rules.shortest_edge or 0.0)
    position = np.full(tin.n_vertices, -1)
    position[kept] = np.arange(len(kept))
    plan = original.vertices[:, :2] - origin
    places, pieces = tin.vertices[kept, :2] - origin, position[edges]
    longest, n_squares = rules.size_bound, 0.0
    field = None
    if sizes is not None or rules.grading is not None:
        sizes = _sizes_by_place(rules, original, sizes, vertex_ids[kept])
        field = SizeField(plan, sizes)
        places, pieces = pieces_within(places, pieces, field)
        longest = float(sizes.max()) if np.isfinite(sizes).all() else 0.0
        n_squares = float((original.plan_areas / sizes[original.faces].min(axis=1) ** 2).sum())
    elif longest > 0:
        n_squares = float(tin.plan_areas.sum()) / longest**2
    work = DelaunayRefiner(
        places, pieces, _places_in_holes(tin, outline) - origin, rules.min_angle, longest, n_squares
    )
    given = {tuple(place): int(vertex_ids[row]) for row, place in
             zip(kept, (tin.vertices[kept, :2] - origin).tolist(), strict=True)}  # fmt: skip
    worst = np.empty(0, dtype=np.int64)
    for number in range(MOST_ROUNDS + 1):
        part = part_of(progress, number / (MOST_ROUNDS + 1), (number + 1) / (MOST_ROUNDS + 1))
        points, faces = _refined(work, field, places[pieces], part)
        mesh, ids = _on_terrain(points, faces, given, original, origin)
        missed = _missed(mesh, original, limits)
        if number == MOST_ROUNDS or len(missed) == 0:
            break
        worst = _worst_apart(mesh, original, missed, rules.shortest_edge or 0.0)
        if len(worst) == 0:
            break
        given.update(zip(map(tuple, plan[worst].tolist()), worst.tolist(), strict=True))
        work.add(plan[worst])
    report(progress, 1.0)
    n_known = int(np.count_nonzero(np.isin(ids, vertex_ids)))
    return SolverMesh(
        mesh, ids, tin.n_vertices - n_known, mesh.n_vertices - n_known, len(missed), len(worst) == 0
    )


def _sizes_by_place(
    rules: SolverRules, original: TriangleMesh, sizes: FloatArray | None, vertex_ids: IntArray
) -> FloatArray:
    """Return the longest edge at each vertex of the terrain, by all rules."""
    bound = rules.size_bound or np.inf
    found = np.full(original.n_vertices, bound) if sizes is None else np.minimum(sizes, bound)
    rules.require_room(float(found.min()))
    if rules.grading is None:
        return found
    plan = original.vertices[vertex_ids, :2]
    nearest = cKDTree(plan).query(plan, k=2)[0][:, 1]
    found[vertex_ids] = np.minimum(found[vertex_ids], _GRADED_FROM * nearest)
    return graded(original, found, rules.grading)


def _refined(
    work: DelaunayRefiner,
    field: SizeField | None,
    boundaries: FloatArray,
    progress: Progress | None,
) -> tuple[FloatArray, IntArray]:
    """Return points and triangles once their angles and sizes are as they should be."""
    while True:
        work.refine(progress)
        points, faces = work.result()
        more = None if field is None else field.places_to_add(points, faces, boundaries)
        if more is None or len(more) == 0:
            return points, faces
        work.add(more)


# -- what is given to the refinement -------------------------------------------------------------


def _outline(faces: NDArray[np.integer]) -> IntArray:
    """Return the edges of one face only."""
    edges, n_faces = edges_of(faces)
    return edges[n_faces == 1]


def _edges_along(
    tin: TriangleMesh, is_locked: NDArray[np.bool_], segments: FloatArray | None
) -> IntArray:
    """Return the edges between locked vertices that lie on a segment."""
    import shapely

    sides = edges_of(tin.faces)[0]
    sides = sides[is_locked[sides].all(axis=1)]
    if segments is None or len(segments) == 0 or len(sides) == 0:
        return sides[:0]
    middle = shapely.points(tin.vertices[sides, :2].mean(axis=1))
    near = 1e-9 * float(np.ptp(tin.vertices[:, :2], axis=0).max())
    tree = shapely.STRtree(shapely.linestrings(segments))
    found = tree.query(middle, predicate="dwithin", distance=near)[0]
    return sides[np.unique(found)]


def _places_in_holes(tin: TriangleMesh, outline: IntArray) -> FloatArray:
    """Return a place inside each area that the outline encloses and no face covers."""
    import shapely

    lines = shapely.linestrings(tin.vertices[outline, :2])
    places = [
        (place.x, place.y)
        for place in map(shapely.point_on_surface, shapely.get_parts(shapely.polygonize(lines)))
    ]
    found = np.array(places).reshape(-1, 2)
    is_covered = np.zeros(len(found), dtype=bool)
    is_covered[cover_of(tin, found).point] = True
    return found[~is_covered]


def _apart(plan: FloatArray, holds: NDArray[np.bool_], distance: float) -> IntArray:
    """Return which vertices stay so that free ones are no nearer than that to another."""
    stays = np.ones(len(plan), dtype=bool)
    if distance > 0:
        tree = cKDTree(plan)
        for row in np.flatnonzero(~holds):
            near = np.array(tree.query_ball_point(plan[row], distance))
            near = near[near != row]
            # those that hold come first, then the lower numbers
            if (stays[near] & (holds[near] | (near < row))).any():
                stays[row] = False
    return np.flatnonzero(stays)


# -- the mesh on the terrain ---------------------------------------------------------------------


def _on_terrain(
    points: FloatArray,
    faces: IntArray,
    given: dict[tuple[float, ...], int],
    original: TriangleMesh,
    origin: FloatArray,
) -> tuple[TriangleMesh, IntArray]:
    """Return the mesh with the terrain's heights and attributes, and which vertices those are."""
    ids = np.array([given.get(place, -1) for place in map(tuple, points.tolist())], dtype=np.int64)
    is_new = ids < 0
    plan = points + origin
    plan[~is_new] = original.vertices[ids[~is_new], :2]
    columns = np.hstack([original.vertices[:, 2:], original.attributes])
    values = np.empty((len(points), columns.shape[1]))
    values[~is_new] = columns[ids[~is_new]]
    values[is_new] = _interpolated(original, columns, plan[is_new])
    mesh = TriangleMesh(
        np.column_stack([plan, values[:, 0]]), faces, values[:, 1:], original.attribute_names
    )
    return mesh, ids


def _interpolated(original: TriangleMesh, columns: FloatArray, plan: FloatArray) -> FloatArray:
    """Return values on the terrain; beside it by rounding, those of the nearest outline edge."""
    cover = cover_of(original, plan)
    values = np.full((len(plan), columns.shape[1]), np.nan)
    a, b, c = (columns[original.faces[cover.face, k]] for k in range(3))
    at_b, at_c = cover.at_b[:, None], cover.at_c[:, None]
    values[cover.point] = a + at_b * (b - a) + at_c * (c - a)
    beside = np.flatnonzero(np.isnan(values[:, 0]))
    if len(beside):
        import shapely

        edges = _outline(original.faces)
        ends = original.vertices[edges, :2]
        lines = shapely.linestrings(ends)
        nearest = shapely.STRtree(lines).nearest(shapely.points(plan[beside]))
        start, stop = ends[nearest, 0], ends[nearest, 1]
        along = ((plan[beside] - start) * (stop - start)).sum(axis=1)
        along = np.clip(along / ((stop - start) ** 2).sum(axis=1), 0, 1)[:, None]
        first, last = columns[edges[nearest, 0]], columns[edges[nearest, 1]]
        values[beside] = first + along * (last - first)
    return values


def _missed(mesh: TriangleMesh, original: TriangleMesh, limits: FloatArray | None) -> IntArray:
    if limits is None:
        return np.empty(0, dtype=np.int64)
    errors = np.abs(surface_errors(mesh, original.vertices))
    slack = 1e-9 * float(np.ptp(original.vertices[:, 2]))
    return np.flatnonzero(errors > limits + slack)  # NaN, of what the outline leaves out, is not


def _worst_apart(
    mesh: TriangleMesh, original: TriangleMesh, missed: IntArray, distance: float
) -> IntArray:
    """Return of each face the worst of the points missed, apart from all nodes and each other."""
    points = original.vertices[missed]
    cover = cover_of(mesh, points[:, :2])
    off = np.abs(surface_errors(mesh, points, cover))[cover.point]
    order = np.lexsort((cover.point, -off, cover.face))
    face = cover.face[order]
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = face[1:] != face[:-1]
    worst = missed[cover.point[order[is_first]]]
    if distance > 0:
        nearest = cKDTree(mesh.vertices[:, :2]).query(original.vertices[worst, :2])[0]
        worst = worst[nearest >= distance]
        none = np.zeros(len(worst), dtype=bool)
        worst = worst[_apart(original.vertices[worst, :2], none, distance)]
    return worst
