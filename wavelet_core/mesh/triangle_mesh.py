"""The triangle mesh that everything starts from and returns to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.grid import count_grid_faces, fill_grid_faces
from .._threads import run_in_blocks
from .._validate import (
    FloatArray,
    IntArray,
    are_equal,
    as_attributes,
    as_faces,
    as_vertices,
    counted,
    frozen,
)
from ..errors import MeshError

#: Faces whose areas are worked out together.
FACES_AT_ONCE = 1 << 14


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class TriangleMesh:
    """A triangulated surface with attributes at its vertices.

    Parameters
    ----------
    vertices : array_like, shape (n_vertices, 3)
        x, y (horizontal) and z, all in one length unit.
    faces : array_like, shape (n_faces, 3)
        Vertex indices, counter-clockwise seen from above. A mesh that is clockwise as a
        whole (its summed plan area is negative) is turned round.
    attributes : array_like, shape (n_vertices, n_attributes), optional
        Further values at the vertices: class, intensity, height above ground, ...
    attribute_names : sequence of str, optional
        One different name for each attribute; not ``x``, ``y`` or ``z``.

    Attributes
    ----------
    vertices, faces, attributes, attribute_names
        As given, as read-only arrays of dtype float64, int64, float64 and a tuple.

    Raises
    ------
    MeshError
        Wrong shapes, indices out of range, a face that uses a vertex twice, values not finite.

    Notes
    -----
    Vertices that no face uses are allowed; they stay at every level of a pyramid.

    Examples
    --------
    >>> from wavelet_core import TriangleMesh
    >>> mesh = TriangleMesh([[0, 0, 1], [1, 0, 2], [0, 1, 3]], [[0, 1, 2]])
    >>> mesh
    <TriangleMesh 3 vertices, 1 face>
    """

    vertices: FloatArray
    faces: IntArray
    attributes: FloatArray
    attribute_names: tuple[str, ...]

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        attributes: ArrayLike | None = None,
        attribute_names: Sequence[str] = (),
    ) -> None:
        vertex_array = as_vertices(vertices)
        face_array = as_faces(faces, len(vertex_array))
        attribute_array, names = as_attributes(attributes, attribute_names, len(vertex_array))
        if _doubled_plan_areas(vertex_array, face_array).sum() < 0:
            face_array = face_array[:, ::-1]
        self._fill(vertex_array, face_array, attribute_array, names)

    def _fill(
        self, vertices: FloatArray, faces: IntArray, attributes: FloatArray, names: tuple[str, ...]
    ) -> None:
        object.__setattr__(self, "vertices", frozen(vertices))
        object.__setattr__(self, "faces", frozen(faces))
        object.__setattr__(self, "attributes", frozen(attributes))
        object.__setattr__(self, "attribute_names", names)

    @classmethod
    def _trusted(
        cls, vertices: FloatArray, faces: NDArray, attributes: FloatArray, names: tuple[str, ...]
    ) -> TriangleMesh:
        """Build from arrays that this package made itself, without the checks."""
        mesh = cls.__new__(cls)
        mesh._fill(vertices, faces.astype(np.int64, copy=False), attributes, names)
        return mesh

    @classmethod
    def from_grid(
        cls,
        elevation: ArrayLike,
        x: ArrayLike,
        y: ArrayLike,
        valid: ArrayLike | None = None,
        attributes: ArrayLike | None = None,
        attribute_names: Sequence[str] = (),
    ) -> TriangleMesh:
        """Return the mesh of a raster: a vertex at each valid cell centre, two faces a cell square.

        Parameters
        ----------
        elevation : array_like, shape (n_rows, n_columns)
            Elevations in the unit of x and y.
        x : array_like, shape (n_columns,)
            Coordinates of the column centres, ascending or descending.
        y : array_like, shape (n_rows,)
            Coordinates of the row centres, ascending or descending.
        valid : array_like of bool, shape (n_rows, n_columns), optional
            Cells that carry data; by default those with a finite elevation.
        attributes : array_like, shape (n_rows, n_columns, n_attributes), optional
            Further bands; one band may come as ``(n_rows, n_columns)``.
        attribute_names : sequence of str, optional
            One name a band.

        Returns
        -------
        TriangleMesh
            Vertices are the valid cells in row-major order. A square with three valid corners
            gives one face; one with fewer, a hole.

        Raises
        ------
        MeshError
            Shapes that do not fit, x or y not strictly monotonic, no valid cell.
        """
        elevation_array = np.asarray(elevation, dtype=np.float64)
        if elevation_array.ndim != 2:
            raise MeshError(f"elevation has shape {elevation_array.shape}; give (rows, columns).")
        n_rows, n_columns = elevation_array.shape
        x_array = _monotonic(x, n_columns, "x")
        y_array = _monotonic(y, n_rows, "y")
        mask = np.isfinite(elevation_array) if valid is None else np.asarray(valid, dtype=bool)
        if mask.shape != elevation_array.shape:
            raise MeshError(
                f"valid has shape {mask.shape}, elevation {elevation_array.shape}; give the same."
            )
        if not mask.any():
            raise MeshError("no cell of the grid is valid; there is nothing to triangulate.")
        vertices = np.empty((np.count_nonzero(mask), 3))
        vertices[:, 0] = np.broadcast_to(x_array, mask.shape)[mask]
        vertices[:, 1] = np.broadcast_to(y_array[:, None], mask.shape)[mask]
        vertices[:, 2] = elevation_array[mask]
        clockwise = _is_descending(x_array) != _is_descending(y_array)
        faces = grid_faces(mask, clockwise)
        if attributes is not None:
            attributes = np.asarray(attributes, dtype=np.float64)
            if attributes.shape[:2] != mask.shape:
                raise MeshError(
                    f"attributes have shape {attributes.shape}; give {mask.shape} and the bands."
                )
            attributes = attributes[mask]
        attribute_array, names = as_attributes(attributes, attribute_names, len(vertices))
        return cls._trusted(as_vertices(vertices), faces, attribute_array, names)

    @classmethod
    def from_points(
        cls,
        points: ArrayLike,
        attributes: ArrayLike | None = None,
        attribute_names: Sequence[str] = (),
    ) -> TriangleMesh:
        """Return the Delaunay triangulation in plan of scattered points.

        Parameters
        ----------
        points : array_like, shape (n_points, 3)
            x, y (horizontal) and z, in one length unit, in any order.
        attributes, attribute_names
            As for the mesh itself, one row for each point.

        Returns
        -------
        TriangleMesh
            Its vertices are the points in their order. Of points that share x and y exactly,
            only the lowest is a vertex (ties: the first); see
            :func:`wavelet_core.mesh.triangulation.merge_duplicates` for which those are.

        Raises
        ------
        MeshError
            Fewer than three different points, or all on one line.
        MissingDependencyError
            Neither pythoncdt nor a usable SciPy triangulation is at hand.
        """
        from .triangulation import delaunay_faces, merge_duplicates

        point_array = as_vertices(points)
        attribute_array, names = as_attributes(attributes, attribute_names, len(point_array))
        kept = merge_duplicates(point_array).kept
        vertices = point_array[kept]
        return cls._trusted(vertices, delaunay_faces(vertices[:, :2]), attribute_array[kept], names)

    @classmethod
    def from_triangles(
        cls,
        vertices: ArrayLike,
        faces: ArrayLike,
        attributes: ArrayLike | None = None,
        attribute_names: Sequence[str] = (),
    ) -> TriangleMesh:
        """Return the mesh of a triangle soup, each face turned counter-clockwise in plan.

        Parameters are those of the class. Use it for polygon layers, whose rings may run
        either way.
        """
        vertex_array = as_vertices(vertices)
        face_array = as_faces(faces, len(vertex_array))
        clockwise = _doubled_plan_areas(vertex_array, face_array) < 0
        face_array[clockwise] = face_array[clockwise, ::-1]
        attribute_array, names = as_attributes(attributes, attribute_names, len(vertex_array))
        return cls._trusted(vertex_array, face_array, attribute_array, names)

    def __eq__(self, other: object) -> bool:
        return are_equal(self, other) if isinstance(other, TriangleMesh) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # arrays of millions are no keys

    def __repr__(self) -> str:
        sizes = [counted(self.n_vertices, "vertex", "vertices"), counted(self.n_faces, "face")]
        return f"<TriangleMesh {', '.join([*sizes, *_listed(self.attribute_names)])}>"

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.faces)

    @property
    def plan_areas(self) -> FloatArray:
        """Signed areas of the faces in plan, ``(n_faces,)``; positive is counter-clockwise."""
        return 0.5 * _doubled_plan_areas(self.vertices, self.faces)


def _listed(names: Sequence[str]) -> list[str]:
    return [" + ".join(names)] if names else []


def _doubled_plan_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    x, y = np.ascontiguousarray(vertices[:, 0]), np.ascontiguousarray(vertices[:, 1])
    areas = np.empty(len(faces))

    def measure(start: int, stop: int) -> None:
        a, b, c = faces[start:stop].T
        areas[start:stop] = (x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a])

    run_in_blocks(measure, len(faces), FACES_AT_ONCE)
    return areas


def _monotonic(values: ArrayLike, n: int, name: str) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (n,) or not np.isfinite(array).all():
        raise MeshError(f"{name} has shape {array.shape}; give {n} finite coordinates.")
    steps = np.diff(array)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise MeshError(f"{name} neither ascends nor descends throughout; sort the grid.")
    return array


def _is_descending(values: FloatArray) -> bool:
    return len(values) > 1 and bool(values[1] < values[0])


def grid_faces(valid: NDArray[np.bool_], clockwise: bool) -> IntArray:
    """Return the faces of the valid cells, in row-major order of the squares.

    With x to the right and y up::

        d --- e        both triangles (a, b, e) and (a, e, d);
        |   / |        without a: (b, e, d); without e: (a, b, d);
        | /   |        without b: (a, e, d); without d: (a, b, e)
        a --- b
    """
    ids = np.cumsum(valid, dtype=np.int32).reshape(valid.shape) - np.int32(1)
    ids[~valid] = -1
    n_rows = max(valid.shape[0] - 1, 0)
    first = np.zeros(n_rows + 1, dtype=np.int64)
    run_in_ranges(count_grid_faces, n_rows, ids, first[1:])
    np.cumsum(first, out=first)
    faces = np.empty((first[-1], 3), dtype=np.int64)
    run_in_ranges(fill_grid_faces, n_rows, ids, first, clockwise, faces)
    return faces
