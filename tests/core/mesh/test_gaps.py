"""Gaps of scattered points are left out, all of them or those open to the outside."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from wavelet_core import MeshError, OptionError, TriangleMesh, analyse
from wavelet_core._kernels._jit import engine
from wavelet_core.accuracy.level_errors import level_errors
from wavelet_core.mesh.gaps import GAP_FACTOR, faces_within, gaps_of
from wavelet_core.mesh.triangulation import delaunay_faces


def grid_points(keep):
    """Return the points of a 20 x 20 grid of spacing 1 for which ``keep(x, y)`` holds."""
    y, x = np.mgrid[0:20, 0:20].astype(float)
    x, y = x.ravel(), y.ravel()
    # a little disorder, so that the triangulation is the only one
    rng = np.random.default_rng(1)
    kept = keep(x, y)
    return (np.column_stack([x, y]) + rng.uniform(-0.1, 0.1, (400, 2)))[kept]


def lake(x, y):
    return ~((abs(x - 9.5) < 5) & (abs(y - 9.5) < 5))


def bay(x, y):
    return ~((x > 8) & (abs(y - 9.5) < 5))


def area(plan, faces):
    a, b, c = (plan[faces[:, k]] for k in range(3))
    ab, ac = b - a, c - a
    return float(np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]).sum() / 2)


@pytest.mark.parametrize("shape", [lake, bay])
def test_a_face_with_a_long_edge_is_left_out(shape):
    plan = grid_points(shape)
    faces = delaunay_faces(plan)
    within = faces_within(plan, faces, 2.5)
    assert area(plan, faces) == pytest.approx(361, abs=8)
    assert area(plan, within) < 361 - 80
    sides = plan[np.roll(within, -1, axis=1)] - plan[within]
    assert np.hypot(*np.moveaxis(sides, -1, 0)).max() <= 2.5
    assert len(np.unique(within)) == len(plan)


def test_from_the_outline_a_bay_opens_and_a_lake_stays_closed():
    for shape, is_closed in ((lake, True), (bay, False)):
        plan = grid_points(shape)
        faces = delaunay_faces(plan)
        within = faces_within(plan, faces, 2.5, from_outline=True)
        assert (area(plan, within) > 0.95 * area(plan, faces)) == is_closed


def test_the_length_of_a_gap_comes_from_the_spacing():
    plan = grid_points(bay)
    faces = delaunay_faces(plan)
    gaps = gaps_of(plan, faces)
    assert 4.0 < gaps.length < 5.5
    assert 0.1 < gaps.share < 0.4
    assert gaps.spacing == pytest.approx(1.0, abs=0.1)
    assert gaps_of(7 * plan, faces) == pytest.approx(
        (7 * gaps.length, 7 * gaps.spacing, gaps.share)
    )


def test_the_spacing_is_that_of_the_nearest_neighbours():
    """Against a tree of all points, and for each engine."""
    plan = np.random.default_rng(6).normal(size=(3000, 2))
    faces = delaunay_faces(plan)
    nearest = cKDTree(plan).query(plan, k=2)[0][:, 1]
    a, b, c = plan[faces].swapaxes(0, 1)
    longest = np.max([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    areas = np.abs(np.linalg.det(np.stack([b - a, c - a], axis=1))) / 2
    length = GAP_FACTOR * np.percentile(nearest, 95)
    is_dense = longest <= length
    n_used = len(np.unique(faces[is_dense]))
    expected = (
        length,
        np.sqrt(areas[is_dense].sum() / n_used),
        areas[longest > 2 * length].sum() / areas.sum(),
    )
    found = []
    for name in ("loops", "arrays"):
        with engine(name):
            found.append(gaps_of(plan, faces))
    assert found[0] == pytest.approx(expected)
    assert found[0] == found[1] == gaps_of(plan, faces)


@pytest.mark.parametrize("max_edge", [0, -1, float("nan")])
def test_a_length_that_is_none(max_edge):
    plan = grid_points(lake)
    with pytest.raises(OptionError, match=r"max_edge is .*; give a length above 0") as caught:
        faces_within(plan, delaunay_faces(plan), max_edge)
    assert caught.value.in_words(lambda option: "--max-edge").startswith("--max-edge is ")


def test_no_face_is_left():
    plan = grid_points(lake)
    with pytest.raises(MeshError, match=r"longer than max_edge = 0\.01.*larger") as caught:
        faces_within(plan, delaunay_faces(plan), 0.01)
    assert "than --max-edge = 0.01" in caught.value.in_words(lambda option: "--max-edge")


@given(seed=st.integers(0, 10_000), factor=st.floats(0.6, 3.0), from_outline=st.booleans())
def test_whatever_is_left_can_be_analysed(seed, factor, from_outline):
    """Isolated vertices and pinches are what the mesh knows; the pyramid comes back."""
    rng = np.random.default_rng(seed)
    plan = np.concatenate([rng.normal(c, 3, (40, 2)) for c in rng.uniform(0, 60, (4, 2))])
    faces = delaunay_faces(plan)
    within = faces_within(
        plan, faces, factor * gaps_of(plan, faces).spacing * 2,
        from_outline=from_outline,
    )  # fmt: skip
    mesh = TriangleMesh(np.column_stack([plan, rng.normal(size=len(plan))]), within)
    pyramid = analyse(mesh, levels=3)
    np.testing.assert_allclose(pyramid.synthesise().vertices, mesh.vertices, atol=1e-9)
    assert len(list(level_errors(pyramid))) == pyramid.n_levels + 1
