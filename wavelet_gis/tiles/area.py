"""A part of a tile set: the pieces and the triangles that reach into a box or into polygons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.tiles.plan import Piece, TilePlan

__all__ = ["Area", "Box", "area_of"]

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Area:
    """What is asked for of a tile set.

    Attributes
    ----------
    plan : TilePlan
    bounds : tuple of float or None
        Of a box, or around polygons, in the working frame: smallest x and y, largest x and y; None
        for all.
    shape : shapely geometry or None
        In the working frame; None for a box, which needs no shapely.
    option : str
        What names it, for messages.
    """

    plan: TilePlan
    bounds: Box | None = None
    shape: Any = None
    option: str = "bbox"

    @property
    def is_all(self) -> bool:
        """Whether it is all of the tile set."""
        return self.bounds is None

    def has_piece(self, piece: Piece) -> bool:
        """Return whether the cells of a piece, or its border, reach into it."""
        x, y = footprint_of(self.plan, piece)
        local = self.plan.local_frame
        corners = np.column_stack([local.local_x(x), local.local_y(y)])
        return bool(self._meet(corners[None])[0])

    def faces_of(self, mesh: TriangleMesh) -> NDArray[np.bool_]:
        """Return which faces of a mesh reach into it."""
        return self._meet(mesh.vertices[mesh.faces][:, :, :2])

    def _meet(self, corners: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which convex polygons, ``(n, k, 2)``, reach into it."""
        if self.bounds is None:
            return np.ones(len(corners), dtype=bool)
        found = _meet_box(corners, self.bounds)
        if self.shape is not None:
            import shapely

            at_stake = np.flatnonzero(found)
            shapely.prepare(self.shape)
            found[at_stake] = shapely.intersects(shapely.polygons(corners[at_stake]), self.shape)
        return found

    def part_of(self, mesh: TriangleMesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the vertices of a mesh that are part of it, and its faces between those.

        They are those of the faces that reach into it, and in it those without faces.
        """
        faces = mesh.faces[self.faces_of(mesh)]
        is_part = np.ones(mesh.n_vertices, dtype=bool)
        is_part[mesh.faces] = False
        is_part &= self.has_points(mesh.vertices)
        is_part[faces] = True
        place = np.cumsum(is_part) - 1
        return np.flatnonzero(is_part), place[faces]

    def has_points(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which points, in the working frame, are in it or on its edge."""
        if self.bounds is None:
            return np.ones(len(points), dtype=bool)
        low, high = self.bounds[:2], self.bounds[2:]
        found = np.asarray(((points[:, :2] >= low) & (points[:, :2] <= high)).all(axis=1))
        if self.shape is not None:
            import shapely

            found &= shapely.intersects_xy(self.shape, points[:, 0], points[:, 1])
        return found


class _Place(NamedTuple):
    system: CoordinateSystem
    frame: LocalFrame


def area_of(plan: TilePlan, bbox: Box | None, polygon: Any) -> Area:
    """Return the area that a box, or polygons, are; all where neither is given.

    Parameters
    ----------
    plan : TilePlan
    bbox : tuple of float or None
        Smallest x and y, largest x and y, in the coordinates of the input.
    polygon : path, GeoDataFrame, shapely geometry or None
        A vector file of polygons, in any CRS; or a geometry in the coordinates of the input.

    Raises
    ------
    OptionError
        Both, or a box without an inside.
    InputFileError, CrsError
        Polygons that cannot be read, or not be brought to the CRS of the tiles.
    """
    if bbox is not None and polygon is not None:
        raise OptionError("give one of {0} and {1}.", "bbox", "polygon")
    if polygon is not None:
        shape = _shape_in_frame(plan, polygon)
        return Area(plan, shape.bounds, shape, option="polygon")
    if bbox is None:
        return Area(plan)
    if not (bbox[0] < bbox[2] and bbox[1] < bbox[3]):
        raise OptionError(
            "{0} is {bbox}; give the smallest x and y, then the largest.", "bbox", bbox=list(bbox)
        )
    frame = plan.local_frame
    x, y = frame.local_x(np.array(bbox[::2])), frame.local_y(np.array(bbox[1::2]))
    return Area(plan, (float(x[0]), float(y[0]), float(x[1]), float(y[1])))


def _shape_in_frame(plan: TilePlan, polygon: Any) -> Any:
    """Return polygons as one shape in the working frame."""
    import shapely

    from wavelet_gis.workflows.lines.layer_shapes import POLYGONS, shapes_in_frame

    if isinstance(polygon, shapely.Geometry):
        local = plan.local_frame
        return shapely.transform(
            polygon, lambda xy: np.column_stack([local.local_x(xy[:, 0]), local.local_y(xy[:, 1])])
        )
    place = _Place(plan.coordinate_system, plan.local_frame)
    shapes, _ = shapes_in_frame(place, polygon, "polygon", POLYGONS)
    return shapely.union_all(shapely.force_2d(shapes))


def _meet_box(corners: NDArray[np.float64], box: Box) -> NDArray[np.bool_]:
    """Return which convex polygons, ``(n, k, 2)``, have a point in a box or on its edge.

    Two convex shapes that have no point in common are on two sides of a line along an edge of one
    of them.
    """
    low, high = np.array(box[:2]), np.array(box[2:])
    found: NDArray[np.bool_] = ((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)).all(
        axis=1
    )
    at_stake = np.flatnonzero(found)
    some = corners[at_stake]
    ends = np.array([[low[0], low[1]], [high[0], low[1]], high, [low[0], high[1]]])
    meet = np.ones(len(some), dtype=bool)
    for k in range(corners.shape[1]):
        start = some[:, k, None]
        along = some[:, (k + 1) % corners.shape[1], None] - start
        own, of_box = (
            along[..., 0] * (to - start)[..., 1] - along[..., 1] * (to - start)[..., 0]
            for to in (some, ends[None])
        )
        meet &= (own.min(axis=1) <= of_box.max(axis=1)) & (own.max(axis=1) >= of_box.min(axis=1))
    found[at_stake] = meet
    return found


def footprint_of(plan: TilePlan, piece: Piece) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y of the corners of the cells of a piece, and of what a border may reach to."""
    top, left, bottom, right = plan.cells(piece)
    if plan.points is not None:
        in_rows, in_columns = plan.points.reach_in_cells
        top, left, bottom, right = (
            top - in_rows,
            left - in_columns,
            bottom + in_rows,
            right + in_columns,
        )
    return plan.geometry.centres(
        np.array([left, right, right, left], dtype=np.float64),
        np.array([top, top, bottom, bottom], dtype=np.float64),
    )
