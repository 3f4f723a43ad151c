"""The pyramid of one tile of points, and the points of a tile that have no surface."""

from __future__ import annotations

import os
import struct
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import MeshError, Progress, TriangleMesh
from wavelet_core.mesh.triangulation import canonical_faces, delaunay_faces
from wavelet_gis.io.las.cloud_reader import laspy_header, masks_aside, require_laspy
from wavelet_gis.io.las.dimensions import carried_fields, lifted_attributes
from wavelet_gis.io.las.layout import SCALING, parse_layout
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.points.mesh import cloud_vertices
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.tiles.cloud.borders import (
    Arm,
    Corner,
    Ring,
    arm_of,
    corner_of,
    faces_within,
    keys_of,
)
from wavelet_gis.tiles.cloud.cut import SOURCES, CutPoints, points_of
from wavelet_gis.tiles.plan import Piece, TilePlan
from wavelet_gis.workflows.analyse import analyse

__all__ = ["FILE", "ROW", "CloudTile", "cloud_tile", "ring_of", "tile_pyramid"]

#: Fields that the points of a tile carry besides their own: file and row, for the way back.
FILE, ROW = "tile/file", "tile/row"


class CloudTile(NamedTuple):
    """The points of a tile, those on its borders among them.

    cloud : PointCloud, with what is carried
    points : CutPoints, the same as records
    u, v : (n,) int64, places in the plan's own length, from the tile's first corner
    ring : Ring
    """

    cloud: PointCloud
    points: CutPoints
    u: NDArray[np.int64]
    v: NDArray[np.int64]
    ring: Ring


def cloud_tile(folder: str | os.PathLike[str], plan: TilePlan, piece: Piece) -> CloudTile | None:
    """Return the points of a tile; None where it has none.

    Parameters
    ----------
    folder : path
        Of the tile set, with the cut.
    plan : TilePlan
    piece : Piece
        A tile.
    """
    around = points_of(folder, plan, piece, plan.inputs_of(piece))
    if around is None:
        return None
    lattice, reading = plan.points, plan.reading
    assert lattice is not None
    head = Path(folder) / SOURCES / f"{int(around.file[0]):05d}.head"
    layout = parse_layout(str(head), head.read_bytes())
    header = laspy_header(str(head), layout)
    point_format = header.point_format
    laspy = require_laspy()
    everyone = laspy.PackedPointRecord(around.records, point_format)
    withheld, noise = masks_aside(
        everyone, reading["classes"], reading["keep_noise"], reading["keep_withheld"]
    )
    aside = withheld | noise
    (p, q), (first_row, first_column) = lattice.ratio, lattice.first
    top, left, _, _ = plan.cells(piece)
    u = (around.records["X"].astype(np.int64) - (first_column + left)) * p
    v = (around.records["Y"].astype(np.int64) - (first_row + top)) * q
    ring = ring_of(plan, piece, u[~aside], v[~aside])
    inside = ring.holds(u, v)
    inside |= np.isin(keys_of(u, v), keys_of(*ring.vertices()))
    if not inside.any():
        return None
    points = CutPoints(around.records[inside], around.file[inside], around.row[inside])
    records = laspy.PackedPointRecord(points.records, point_format)
    lifted = lifted_attributes(piece.name, reading["attributes"], records, header)
    is_aside = aside[inside]
    cloud = PointCloud(
        integers=np.column_stack([points.records[axis] for axis in "XYZ"]),
        scales=np.array(lattice.scales),
        offsets=np.array(lattice.offsets),
        attributes=tuple(lifted),
        carried={**carried_fields(records, lifted), FILE: points.file, ROW: points.row},
        header=_header(layout.block, lattice.offsets),
        n_in_file=len(points.row),
        classes=None if reading["classes"] is None else tuple(reading["classes"]),
        aside=is_aside if is_aside.any() else None,
        is_altered=True,
    )
    return CloudTile(cloud, points, u[inside], v[inside], ring)


def _header(block: bytes, offsets: tuple[float, float, float]) -> NDArray[np.uint8]:
    """Return the header of a file, with the offsets that hold for all."""
    changed = bytearray(block)
    struct.pack_into("<3d", changed, SCALING + 24, *offsets)
    return np.frombuffer(bytes(changed), np.uint8)


def ring_of(plan: TilePlan, piece: Piece, u: NDArray[np.int64], v: NDArray[np.int64]) -> Ring:
    """Return the border of a tile.

    Parameters
    ----------
    plan : TilePlan
    piece : Piece
        A tile.
    u, v : (n,) int64
        Places of the points of the surface in and around it, from its first corner.
    """
    lattice = plan.points
    assert lattice is not None
    (p, q), spacing = lattice.ratio, lattice.spacing
    top, left, bottom, right = plan.cells(piece)
    width, height = (right - left) * p, (bottom - top) * q
    is_shared = {
        "south": piece.row > 0,
        "north": piece.row < len(plan.rows) - 2,
        "west": piece.column > 0,
        "east": piece.column < len(plan.columns) - 2,
    }

    def corner(side: str, end: str) -> Corner | None:
        if not (is_shared[side] and is_shared[end]):
            return None
        at = (width if end == "east" else 0, height if side == "north" else 0)
        return corner_of(u, v, at, spacing, lattice.reach)

    corners = {
        (side, end): corner(side, end) for side in ("south", "north") for end in ("west", "east")
    }

    def arm(side: str) -> Arm | None:
        if not is_shared[side]:
            return None
        if side in ("south", "north"):
            ends = corners[side, "west"], corners[side, "east"]
            given = tuple(c and (c.u, c.v, c.is_real, c.margin) for c in ends)
            line = height if side == "north" else 0
            return arm_of(u, v, line, (0, width), given, spacing)  # type: ignore[arg-type]
        ends = corners["south", side], corners["north", side]
        given = tuple(c and (c.v, c.u, c.is_real, c.margin) for c in ends)
        line = width if side == "east" else 0
        return arm_of(v, u, line, (0, height), given, spacing)  # type: ignore[arg-type]

    return Ring(
        south=arm("south"),
        east=arm("east"),
        north=arm("north"),
        west=arm("west"),
        corners=(
            corners["south", "west"],
            corners["south", "east"],
            corners["north", "east"],
            corners["north", "west"],
        ),
    )


def tile_pyramid(
    plan: TilePlan, piece: Piece, tile: CloudTile, progress: Progress | None = None
) -> GeoPyramid | None:
    """Return the pyramid of a tile; None where its points have no surface."""
    if tile.cloud.n_used < 3:
        return None
    frame = plan.local_frame
    vertices, origin, attributes, names = cloud_vertices(
        tile.cloud, frame, plan.reading["duplicates"]
    )
    rows = origin.vertex_rows()
    u, v = tile.u[rows], tile.v[rows]
    try:
        faces, locked = tile_faces(tile.ring, u, v)
    except MeshError:  # all on one line
        return None
    if len(faces) == 0:
        return None
    terrain = Terrain(
        piece.name,
        TriangleMesh(vertices, faces, attributes, names),
        tile.cloud,
        origin,
        plan.coordinate_system,
        frame,
        plan.vertical_unit,
    )
    options = plan.options_of(piece, len(vertices))
    return analyse(terrain, locked=locked, progress=progress, **options).geo


def tile_faces(
    ring: Ring, u: NDArray[np.int64], v: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the constrained Delaunay faces of a tile, and which vertices are on its border.

    Parameters
    ----------
    ring : Ring
    u, v : (n,) int64
        Places of the vertices, all different, with those of the ring.

    Raises
    ------
    MeshError
        Fewer than three vertices, or all of them on one line.
    """
    keys = keys_of(u, v)
    order = np.argsort(keys)

    def vertex_at(places: NDArray[np.int64]) -> NDArray[np.int64]:
        wanted = keys_of(places[..., 0], places[..., 1])
        found: NDArray[np.int64] = order[np.searchsorted(keys[order], wanted)]
        return found

    on_ring = vertex_at(np.column_stack(ring.vertices()))
    ring_place = np.full(len(u), -1, dtype=np.int64)
    ring_place[on_ring] = np.arange(len(on_ring))
    # Whole numbers: three points on one line are so for the triangulation too.
    faces = delaunay_faces(np.column_stack([u, v]).astype(np.float64), vertex_at(ring.edges()))
    faces = faces_within(ring, u, v, faces, ring_place)
    return canonical_faces(faces), ring_place >= 0
