"""Borders of tiles of points: two tiles and a handful of points by hand, and what always holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_gis.tiles.cloud.borders import (
    FAR,
    Ring,
    arm_of,
    corner_of,
    faces_within,
    keys_of,
)
from wavelet_gis.tiles.cloud.tile import ring_of, tile_faces
from wavelet_gis.tiles.plan import Piece, PointLattice, TilePlan


def ints(*values):
    return np.array(values, dtype=np.int64)


def plan_of(rows, columns, spacing=2, reach=8):
    """A plan of nothing but its lines."""
    return TilePlan(
        files=(),
        shape=(rows[-1] + 1, columns[-1] + 1),
        transform=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
        rows=rows,
        columns=columns,
        levels=4,
        reading={},
        wavelets={},
        system={},
        frame={},
        vertical_unit="metre",
        points=PointLattice((1.0,) * 3, (0.0,) * 3, (0, 0), (1, 1), spacing, reach, 1),
    )


#   10 .   a   .   b   .          Two tiles, 0 to 10 and 10 to 20, of one row.
#    8 . . . . . d . . . .        Of each four steps of the line, the point nearest to it:
#    5 . c . . e . . f . .          steps 8 to 11: d at 11 (b and a are farther off)
#    2 . . . . . g . . h .          steps 4 to 7:  e at 9
#    0 i   .   |   .   j            steps 0 to 3:  g at 10
HAND = {
    "a": (6, 10), "b": (15, 10), "c": (2, 5), "d": (11, 8), "e": (9, 5), "f": (14, 5),
    "g": (10, 2), "h": (18, 2), "i": (0, 0), "j": (20, 0),
}  # fmt: skip


def test_two_tiles_of_ten_points_by_hand():
    plan = plan_of((0, 10), (0, 10, 20))
    places = np.array(list(HAND.values()), dtype=np.int64)
    names = np.array(list(HAND))
    found = {}
    for column in (0, 1):
        u, v = places[:, 0] - 10 * column, places[:, 1]
        ring = ring_of(plan, Piece(0, 0, column), u, v)
        u_of_ring, v_of_ring = ring.vertices()
        vertices = np.column_stack([u_of_ring + 10 * column, v_of_ring])
        # The left tile has the chain upwards on its east, the right one downwards on its west.
        chain = [HAND[name] for name in ("ged" if column == 0 else "deg")]
        assert vertices.tolist() == [list(place) for place in chain]
        assert len(ring.gates()) == 2  # straight on beyond g and d
        inside = ring.holds(u, v) | np.isin(keys_of(u, v), keys_of(*ring.vertices()))
        faces, locked = tile_faces(ring, u[inside], v[inside])
        assert set(names[inside][locked]) == set("deg")
        found[column] = set(names[inside]), {"".join(sorted(names[inside][face])) for face in faces}
    assert found[0][0] == set("acidge")
    assert found[1][0] == set("bfhjdge")
    assert found[0][1] == {"ade", "ace", "ceg", "cgi"}
    # All are those of the whole but a-d-b and i-g-j, at the ends of the line, which neither has.
    assert found[1][1] == {"bdf", "def", "efg", "fgh", "bfh", "bhj", "ghj"}


def test_a_corner_is_the_nearest_point_and_ties_go_to_the_lowest():
    u, v = ints(3, -2, 2, 2, 9), ints(0, 2, -2, 2, 9)
    corner = corner_of(u, v, (0, 0), spacing=1, reach=8)
    assert corner[:3] == (2, -2, True)
    assert corner.margin == 4
    assert corner_of(u, v, (40, 0), spacing=1, reach=8)[:3] == (40, 0, False)


def test_points_on_an_edge_of_the_border_become_vertices_of_it():
    along = ints(0, 1, 2, 3, 4, 5, 6, 7, 7)
    arm = arm_of(along, ints(0, 0, 0, 0, 0, 0, 0, 0, 0), 0, (0, 8), (None, None), spacing=1)
    assert arm.along.tolist() == [-FAR, *range(8), FAR]  # a grid: none is left between


def test_without_points_near_a_line_it_is_the_border_itself():
    arm = arm_of(ints(3), ints(50), 0, (0, 8), (None, None), spacing=1)
    assert arm.along.tolist() == [-FAR, FAR]
    assert not arm.is_real.any()
    assert arm.sides(ints(3, 3), ints(50, -1)).tolist() == [1, -1]


def test_faces_over_an_edge_without_a_point_at_its_end_are_left_out():
    arm = arm_of(ints(0), ints(0), 0, (0, 8), (None, None), spacing=1)
    ring = Ring(south=None, east=arm, north=None, west=None, corners=(None,) * 4)
    u, v = ints(-5, -5, 0, 3), ints(0, 9, 0, 6)
    faces = np.array([[0, 2, 1], [1, 2, 3]])
    kept = faces_within(ring, u, v, faces, ints(-1, -1, 0, -1))
    assert kept.tolist() == [[0, 2, 1]]


def areas_of(u, v, faces):
    a, b, c = faces.T
    return (u[b] - u[a]) * (v[c] - v[a]) - (v[b] - v[a]) * (u[c] - u[a])


@st.composite
def clouds(draw):
    """Points of whole numbers in 3 x 3 tiles: scattered, on a grid, with gaps, with duplicates."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    side = 3 * 64
    kind = draw(st.sampled_from(["scattered", "grid", "few"]))
    if kind == "grid":
        step = draw(st.integers(1, 5))
        axis = np.arange(0, side, step)
        u, v = (grid.ravel() for grid in np.meshgrid(axis, axis))
        keep = rng.random(len(u)) < draw(st.sampled_from([1.0, 0.7]))
        u, v = u[keep], v[keep]
    else:
        n_points = draw(st.integers(5, 60) if kind == "few" else st.integers(500, 4000))
        u, v = rng.integers(0, side, (2, n_points))
    for _ in range(draw(st.integers(0, 3))):  # lakes, some of them over crossings of lines
        at = rng.choice([40, 64, 100, 128], 2)
        dry = np.hypot(u - at[0], v - at[1]) > draw(st.sampled_from([6, 15, 40]))
        u, v = u[dry], v[dry]
    return u.astype(np.int64), v.astype(np.int64)


@settings(max_examples=20, deadline=None)
@given(clouds())
def test_tiles_share_borders_and_nothing_else(points):
    from wavelet_core import MeshError

    u, v = points
    plan = plan_of((0, 64, 128, 191), (0, 64, 128, 191))
    reach = plan.points.reach
    n_tiles_of = np.zeros(len(u), dtype=int)
    is_on_ring = np.zeros(len(u), dtype=bool)
    edges, area = [], 0
    polygons = []
    for piece in plan.pieces(0):
        top, left, bottom, right = plan.cells(piece)
        near = (u >= left - reach) & (u <= right + reach)
        near &= (v >= top - reach) & (v <= bottom + reach)
        a, b = u[near] - left, v[near] - top
        ring = ring_of(plan, piece, a, b)
        # The same from all points, whatever else is far away.
        again = ring_of(plan, piece, u - left, v - top)
        assert np.array_equal(ring.vertices(), again.vertices())
        on_ring = np.isin(keys_of(a, b), keys_of(*ring.vertices()))
        inside = ring.holds(a, b) | on_ring
        n_tiles_of[np.flatnonzero(near)[inside & ~on_ring]] += 1
        is_on_ring[np.flatnonzero(near)[on_ring]] = True
        places = np.unique(np.column_stack([a[inside], b[inside]]), axis=0)
        try:
            faces, _ = tile_faces(ring, places[:, 0], places[:, 1])
        except MeshError:  # fewer than three points, or all on one line
            continue
        doubled = areas_of(places[:, 0], places[:, 1], faces)
        assert (doubled > 0).all()
        area += doubled.sum()
        keys = keys_of(places[:, 0] + left, places[:, 1] + top)[faces]
        edges += [*zip(keys.ravel(), np.roll(keys, -1, axis=1).ravel(), strict=True)]
        corners = places[faces] + [left, top]
        polygons.append(corners)
    # Every point is in one tile, or on a border.
    assert (n_tiles_of[~is_on_ring] == 1).all()
    assert len(edges) == len(set(edges))  # no edge has two faces on one side
    if polygons:
        import shapely

        triangles = shapely.polygons(np.concatenate(polygons))
        assert shapely.union_all(triangles).area == pytest.approx(area / 2, rel=1e-9)
