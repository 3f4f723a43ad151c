"""What becomes of the coarsest level: refined, fitted, or left as it is."""

import numpy as np
import pytest

from wavelet_core import OptionError, PyramidError, analyse, finished, synthetic
from wavelet_core.mesh.connectivity import BOUNDARY, build_connectivity
from wavelet_core.metrics import surface_errors


@pytest.fixture(scope="module")
def rough():
    return synthetic.hills(30, 33)


def rmse(mesh, original):
    return float(np.sqrt(np.mean(surface_errors(mesh, original.vertices) ** 2)))


def test_by_default_it_is_refined_and_fitted(rough):
    pyramid = analyse(rough, target_vertices=70)
    errors = [
        rmse(finished(pyramid, rough, **how).mesh, rough)
        for how in ({"fit": False}, {"rounds": 0}, {"rounds": 1}, {})
    ]
    assert sorted(errors, reverse=True) == errors
    assert errors[-1] < 0.95 * errors[1]
    assert finished(pyramid, rough, fit=False).mesh == pyramid.mesh(0)


def test_a_design_of_the_paper_is_refined_on_request_only(rough):
    pyramid = analyse(rough, partition="quadric", prediction="GLMN", target_vertices=70)
    assert finished(pyramid, rough).rounds == ()
    assert len(finished(pyramid, rough, rounds=2).rounds) == 4


@pytest.mark.parametrize("how", [{"norm": "rms"}, {"norm": "max", "update": "minimum_norm"}])
def test_a_tolerance_that_lifted_heights_keep_is_not_fitted_away(rough, how):
    """The fit of the heights used to break the tolerance that the analysis had kept."""
    pyramid = analyse(rough, max_error=1.0, **how)
    tin = finished(pyramid, rough)
    assert np.abs(surface_errors(tin.mesh, rough.vertices)).max() <= 1.0
    assert not tin.is_fitted
    with pytest.raises(OptionError, match="fixed heights"):
        finished(pyramid, rough, rounds=2)


@pytest.mark.parametrize("rounds", [0, None])
def test_locked_heights_are_not_fitted(rough, rounds):
    """The fit used to move them."""
    locked = np.zeros(rough.n_vertices, dtype=bool)
    locked[::50] = True
    tin = finished(analyse(rough, target_vertices=90, locked=locked), rough, rounds=rounds)
    kept = locked[tin.vertex_ids]
    assert kept.sum() == locked.sum()
    points = rough.vertices[tin.vertex_ids]
    np.testing.assert_array_equal(tin.mesh.vertices[kept], points[kept])
    assert (tin.mesh.vertices[~kept, 2] != points[~kept, 2]).any()


@pytest.mark.parametrize("rounds", [0, 2])
def test_kept_points_are_points_of_the_input(rough, rounds):
    pyramid = analyse(rough, target_vertices=70)
    tin = finished(pyramid, rough, rounds=rounds, keep_points=True)
    np.testing.assert_array_equal(tin.mesh.vertices, rough.vertices[tin.vertex_ids])
    assert not tin.is_fitted


def test_an_outline_that_moved_within_a_tolerance_stays_where_points_outside_need_it():
    """The errors of the points outside hang on its edges, which the refinement does not see."""
    mesh = synthetic.hills(30, 33)
    pyramid = analyse(mesh, max_error=1.0, outline_tolerance=0.5)
    tin = finished(pyramid, mesh)
    assert tin.mesh.n_vertices < pyramid.n_vertices(0)
    assert outline_ids(tin.mesh, tin.vertex_ids) == outline_ids(
        pyramid.mesh(0), pyramid.vertex_ids(0)
    )


def outline_ids(mesh, ids):
    connectivity = build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    return set(ids[connectivity.kind == BOUNDARY].tolist())


def test_a_pyramid_without_parameters_is_refused_in_words(rough):
    """It ended in a KeyError: 'norm'."""
    whole = analyse(rough, target_vertices=70)
    bare = whole.with_parts(parameters={"update": "none", "signal": "z"})
    with pytest.raises(PyramidError, match="lack norm, max_error, max_rms, partition, so"):
        finished(bare, rough)
