"""A mesh that is itself a level of a pyramid: integrals of its own, and points of a finer input."""

import numpy as np
import pytest

from wavelet_core import (
    OptionError,
    TriangleMesh,
    analyse,
    band_components,
    band_energies,
    synthetic,
)
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.lifting.linear_map import Transform
from wavelet_core.metrics import level_errors, surface_errors

MESH = synthetic.hills(20, 30)
WEIGHTS = np.random.default_rng(4).uniform(0.5, 3.0, MESH.n_vertices)


@pytest.mark.parametrize("partition", ["surface", "quadric"])
def test_their_sum_with_the_heights_stays_what_it_was(partition):
    pyramid = analyse(MESH, levels=4, partition=partition, integrals=WEIGHTS)
    for level, mesh in enumerate(pyramid):
        integrals = pyramid.integrals(level)
        assert integrals @ mesh.vertices[:, 2] == pytest.approx(WEIGHTS @ MESH.vertices[:, 2])
        assert integrals.sum() == pytest.approx(WEIGHTS.sum())
    assert np.allclose(pyramid[-1].vertices, MESH.vertices, atol=1e-12)


def test_two_analyses_one_after_the_other_are_one_as_to_their_integrals():
    fine = analyse(MESH, levels=3)
    coarse = analyse(fine[0], levels=3, integrals=fine.integrals(0))
    sums = [p.integrals(k) @ p[k].vertices[:, 2] for p in (fine, coarse) for k in range(len(p))]
    assert np.allclose(sums, MESH.vertices[:, 2].sum())


def test_the_linear_map_is_that_of_these_integrals():
    """It began with ones: what was denoised or damped came back with other coefficients."""
    pyramid = analyse(MESH, levels=4, integrals=WEIGHTS)
    coarse, details = Transform.from_pyramid(pyramid).analyse(MESH.vertices[:, 2:])
    assert np.allclose(coarse, pyramid.coarse, rtol=0, atol=1e-9)
    for step, detail in zip(pyramid.steps, details, strict=True):
        assert np.allclose(detail, step.details, rtol=0, atol=1e-9)


def test_base_and_bands_sum_to_the_mesh():
    """They were synthesised with integrals of one, and the sum was metres off."""
    components = band_components(analyse(MESH, levels=4, integrals=WEIGHTS))
    total = components.base + components.bands.sum(axis=1)
    assert np.allclose(total, MESH.vertices[:, 2], rtol=0, atol=1e-9)


def test_ones_are_the_default():
    plain = analyse(MESH, levels=3)
    assert analyse(MESH, levels=3, integrals=np.ones(MESH.n_vertices)) == plain


@pytest.mark.parametrize("integrals", [np.ones(3), np.full(MESH.n_vertices, np.nan)])
def test_others_are_refused(integrals):
    with pytest.raises(OptionError, match="integrals has shape"):
        analyse(MESH, integrals=integrals)


# -- the points of a finer input --------------------------------------------------------------


def rmse(mesh, points):
    return float(np.sqrt(np.mean(surface_errors(mesh, points) ** 2)))


def test_with_the_points_of_the_input_two_analyses_are_as_good_as_one():
    fine = synthetic.hills(60, 80)
    rng = np.random.default_rng(3)
    vertices = fine.vertices + rng.normal(0, 0.3, (fine.n_vertices, 1)) * [0, 0, 1]
    fine = TriangleMesh(vertices, fine.faces)
    middle = analyse(fine, target_vertices=900)
    start, integrals = middle[0], middle.integrals(0)
    once = rmse(analyse(fine, target_vertices=150)[0], fine.vertices)
    blind = analyse(start, target_vertices=150, integrals=integrals)[0]
    seeing = analyse(start, target_vertices=150, integrals=integrals, points=fine.vertices)
    assert rmse(blind, fine.vertices) > 1.1 * once
    assert rmse(seeing[0], fine.vertices) < 1.03 * once
    assert np.allclose(seeing[-1].vertices, start.vertices, atol=1e-12)


def test_points_that_are_the_vertices_change_nothing():
    plain = analyse(MESH, levels=4)
    assert analyse(MESH, levels=4, points=MESH.vertices[::-1]) == plain


def test_what_is_around_a_point_that_is_off_stays():
    """A flat square of 9 by 9 and a point 0.4 above one of its faces: the rest of it goes."""
    flat = TriangleMesh.from_grid(np.zeros((9, 9)), x=np.arange(9.0), y=np.arange(9.0))
    point = np.array([[3.7, 4.2, 0.4]])
    assert analyse(flat, max_error=0.3)[0].n_vertices == 4
    coarse = analyse(flat, max_error=0.3, points=point)[0]
    kept = {tuple(place) for place in coarse.vertices[:, :2].tolist()}
    assert {(3.0, 4.0), (4.0, 4.0), (4.0, 5.0)} <= kept
    assert len(kept) < 20
    assert surface_errors(coarse, point)[0] == pytest.approx(0.4)


def test_points_beside_the_mesh_are_left_out():
    beside = np.array([[-50.0, -50.0, 1e6]])
    assert analyse(MESH, levels=4, points=beside) == analyse(MESH, levels=4)


@pytest.mark.skipif(not HAS_NUMBA, reason="numba is off")
def test_both_engines_see_the_points_alike():
    start = analyse(MESH, levels=3)[0]
    with engine("arrays"):
        due = analyse(start, levels=3, points=MESH.vertices)
    with engine("compiled"):
        assert analyse(start, levels=3, points=MESH.vertices) == due


def test_attributes_of_the_points_count_too():
    mesh = synthetic.scattered(300, seed=5, n_attributes=2)
    start = analyse(mesh, levels=3)[0]
    points = np.hstack([mesh.vertices, mesh.attributes])
    pyramid = analyse(start, levels=3, points=points)
    assert pyramid[-1].attributes == pytest.approx(start.attributes)
    with pytest.raises(OptionError, match="points has shape"):
        analyse(start, points=mesh.vertices)


def test_points_are_for_the_partition_that_measures_errors():
    with pytest.raises(OptionError, match=r"points are for partition 'surface'"):
        analyse(MESH, partition="quadric", points=MESH.vertices)


def test_errors_of_the_levels_are_those_at_the_points():
    fine = synthetic.hills(40, 50)
    start = analyse(fine, target_vertices=500)[0]
    pyramid = analyse(start, levels=5, points=fine.vertices)
    for level, row in enumerate(level_errors(pyramid)):
        errors = surface_errors(pyramid[level], fine.vertices)
        assert row.rmse_surface == pytest.approx(np.sqrt(np.mean(errors**2)))
        assert row.max_error_surface == pytest.approx(np.abs(errors).max())


def test_energies_are_weighted_by_these_integrals():
    """Those of the finest level counted as ones."""
    pyramid = analyse(MESH, levels=4, integrals=WEIGHTS)
    energies = band_energies(pyramid)
    for level, step in enumerate(pyramid.steps):
        here = pyramid.integrals(level + 1)[step.odd]
        assert WEIGHTS @ energies[:, level] == pytest.approx(here @ step.details[:, 0] ** 2)


def test_pyramids_with_other_integrals_are_not_equal():
    """They were, though their finer levels have other vertices in the input."""
    one, same = (analyse(MESH, levels=3, update="none", integrals=WEIGHTS) for _ in range(2))
    assert one == same
    assert one != analyse(MESH, levels=3, update="none", integrals=2 * WEIGHTS)
    assert one != analyse(MESH, levels=3, update="none")
