"""Delaunay refinement of points, edges and holes in the plane, by CGAL."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.errors import MissingDependencyError, OptionError
from wavelet_core.progress import report

__all__ = ["LARGEST_MIN_ANGLE", "DelaunayRefiner", "require_cgal"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Degrees. Up to 20.7 the refinement is proved to end; up to some 33 it does in practice.
LARGEST_MIN_ANGLE = 30.0

#: The refinement is given up, with a warning, with so many times the points that it was given, and
#: so many more for each square of the longest edge. On Jacksboro and TM1 it took 2 to 6 times, and
#: 2 to 3 for a square: only what does not end comes near.
MOST_POINTS = 40
POINTS_PER_SQUARE = 12
#: Squares of the longest edge in all, beyond which nobody waits for the mesh.
MOST_SQUARES = 3_000_000

#: Steps between two looks at whether to stop.
STEPS_AT_ONCE = 2000


def require_cgal() -> tuple[Any, Any]:
    """Return CGAL's modules of points and of meshes.

    Raises
    ------
    MissingDependencyError
        They are not installed.
    """
    try:
        from CGAL import CGAL_Kernel, CGAL_Mesh_2
    except ImportError as error:
        raise MissingDependencyError(
            "a mesh for solvers is made by CGAL; install it with 'pip install cgal' (built for "
            "Python 3.12 and earlier), or leave {0}, {1}, {2} and {3} out.",
            "min_angle",
            "longest_edge",
            "shortest_edge",
            "max_area",
        ) from error
    return CGAL_Kernel, CGAL_Mesh_2


class DelaunayRefiner:
    """A constrained Delaunay triangulation that takes points until it has no bad triangle.

    Parameters
    ----------
    points : (n, 2) float64
        No two alike.
    edges : (m, 2) int64
        Stay, whole or split.
    holes : (k, 2) float64
        A place inside each hole; holes are bounded by edges.
    min_angle : float
        Degrees.
    longest_edge : float
        0 for any.
    n_squares : float
        How many squares of the longest edge cover all that is meshed, 0 for any edge.

    Raises
    ------
    MissingDependencyError
        Without CGAL's bindings.
    OptionError
        A longest edge that takes too many nodes.

    Notes
    -----
    Ruppert's algorithm as CGAL has it (Shewchuk, "Delaunay refinement algorithms for triangular
    mesh generation", 2002): the circumcentre of a bad triangle becomes a vertex, unless it
    encroaches upon an edge, which is split instead. Angles between edges that were smaller stay.
    """

    def __init__(
        self,
        points: FloatArray,
        edges: IntArray,
        holes: FloatArray,
        min_angle: float,
        longest_edge: float,
        n_squares: float,
    ) -> None:
        kernel, CGAL_Mesh_2 = require_cgal()
        self._point = kernel.Point_2
        self._most = MOST_POINTS * max(len(points), 1000)
        if n_squares > MOST_SQUARES:
            raise OptionError(
                "with {0} or {1} so small the mesh would have some {n:,.0f} nodes; give larger "
                "ones.",
                "longest_edge",
                "max_area",
                n=2 * n_squares,
            )
        self._most += int(POINTS_PER_SQUARE * n_squares)
        self._mesh = CGAL_Mesh_2.Mesh_2_Constrained_Delaunay_triangulation_2()
        places = [self._point(x, y) for x, y in points.tolist()]
        for a, b in edges.tolist():
            self._mesh.insert_constraint(places[a], places[b])
        for place in places:
            self._mesh.insert(place)
        self._criteria = CGAL_Mesh_2.Delaunay_mesh_size_criteria_2(
            float(np.sin(np.radians(min_angle)) ** 2), float(longest_edge)
        )
        self._holes = [self._point(x, y) for x, y in holes.tolist()]
        self._new_mesher = CGAL_Mesh_2.Default_Delaunay_mesher_2

    def add(self, points: FloatArray) -> None:
        """Take further points."""
        for x, y in points.tolist():
            self._mesh.insert(self._point(x, y))

    def refine(self, progress: Progress | None = None) -> None:
        """Add points until every triangle is as it should be.

        Raises
        ------
        OptionError
            It takes too many points.
        Cancelled
            ``progress`` returned False.
        """
        mesher = self._new_mesher(self._mesh)
        mesher.set_criteria(self._criteria)
        if self._holes:
            mesher.set_seeds(self._holes)
        mesher.init()
        while not mesher.is_refinement_done():
            for _ in range(STEPS_AT_ONCE):
                if mesher.is_refinement_done():
                    break
                mesher.step_by_step_refine_mesh()
            n_points = self._mesh.number_of_vertices()
            if n_points > self._most:
                raise OptionError(
                    "the mesh has {n:,} nodes already and is not done; ask for a smaller {0}, or a "
                    "larger {1} or {2}.",
                    "min_angle",
                    "longest_edge",
                    "max_area",
                    n=n_points,
                )
            report(progress, min(n_points / self._most, 1.0))

    def result(self) -> tuple[FloatArray, IntArray]:
        """Return the points, ``(n, 2)``, and the triangles inside, ``(m, 3)``."""
        number: dict[tuple[float, float], int] = {}
        corners = [
            [number.setdefault(place, len(number)) for place in face] for face in self._faces()
        ]
        points = np.array(list(number), dtype=np.float64).reshape(-1, 2)
        return points, np.array(corners, dtype=np.int64).reshape(-1, 3)

    def _faces(self) -> Iterator[list[tuple[float, float]]]:
        for face in self._mesh.finite_faces():
            if face.is_in_domain():
                yield [_place(face.vertex(k).point()) for k in range(3)]


def _place(point: Any) -> tuple[float, float]:
    return point.x(), point.y()
