"""Perfect reconstruction and the rules of every step, for all filter pairs on any mesh."""

import helpers
import numpy as np
import pytest
from helpers_meshes import ball, grid_with_holes, meshes, random_delaunay
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_core import analyse

pytestmark = helpers.UNSTABLE_TOO
ALL_PAIRS = pytest.mark.parametrize(("prediction", "update"), helpers.PAIRS)
BOTH_SIGNALS = pytest.mark.parametrize("signal", ["z", "xyz"])


@ALL_PAIRS
@settings(max_examples=25)
@given(
    mesh=meshes(),
    levels=st.integers(1, 24),
    signal=st.sampled_from(["z", "xyz"]),
    partition=st.sampled_from(["quadric", "colouring", "random"]),
)
def test_any_mesh_comes_back_and_every_step_obeys(
    prediction, update, mesh, levels, signal, partition
):
    pyramid = analyse(
        mesh,
        levels=levels,
        partition=partition,
        prediction=prediction,
        update=update,
        signal=signal,
    )
    assert pyramid.n_levels <= levels
    helpers.assert_pyramid_is_consistent(pyramid, mesh)


@ALL_PAIRS
@settings(max_examples=10)
@given(
    mesh=meshes(scales=(1.0,), offsets=(0.0,)),
    share=st.sampled_from([0.05, 0.3, 0.9]),
    signal=st.sampled_from(["z", "xyz"]),
    seed=st.integers(0, 2**32 - 1),
)
def test_locked_vertices_stay_and_keep_their_values(prediction, update, mesh, share, signal, seed):
    locked = np.random.default_rng(seed).random(mesh.n_vertices) < share
    pyramid = analyse(
        mesh,
        levels=6,
        partition="quadric",
        prediction=prediction,
        update=update,
        signal=signal,
        locked=locked,
    )
    helpers.assert_pyramid_is_consistent(pyramid, mesh)
    wanted = np.column_stack([mesh.vertices, mesh.attributes])
    for level, coarse in enumerate(pyramid):
        ids = pyramid.vertex_ids(level)
        assert np.isin(np.flatnonzero(locked), ids).all()
        values = np.column_stack([coarse.vertices, coarse.attributes])
        np.testing.assert_array_equal(values[locked[ids]], wanted[ids][locked[ids]])


@pytest.mark.large
@ALL_PAIRS
@BOTH_SIGNALS
@pytest.mark.parametrize("n_attributes", [0, 4])
def test_24_levels_of_a_larger_mesh(prediction, update, signal, n_attributes):
    mesh = random_delaunay(1500, n_attributes, seed=1, offset=1e6)
    pyramid = analyse(
        mesh,
        levels=24,
        partition="quadric",
        prediction=prediction,
        update=update,
        signal=signal,
    )
    assert pyramid.n_levels == 24 or pyramid.n_vertices(0) < 40
    helpers.assert_pyramid_is_consistent(pyramid, mesh)


@pytest.mark.large
@BOTH_SIGNALS
@pytest.mark.parametrize("hole_share", [0.0, 0.02, 0.3])
def test_a_larger_grid(signal, hole_share):
    mesh = grid_with_holes(60, 45, n_attributes=1, seed=2, hole_share=hole_share, scale=1e3)
    pyramid = analyse(mesh, levels=24, partition="quadric", prediction="GLMN", signal=signal)
    helpers.assert_pyramid_is_consistent(pyramid, mesh)


@ALL_PAIRS
@settings(max_examples=15)
@given(
    mesh=meshes(),
    levels=st.integers(1, 24),
    norm=st.sampled_from(["rms", "max"]),
    removal_fraction=st.sampled_from([0.1, 0.25, 1.0]),
    locked_share=st.sampled_from([0.0, 0.0, 0.3]),
    seed=st.integers(0, 2**32 - 1),
)
def test_the_surface_guided_partition(
    prediction, update, mesh, levels, norm, removal_fraction, locked_share, seed
):
    locked = np.random.default_rng(seed).random(mesh.n_vertices) < locked_share
    pyramid = analyse(
        mesh,
        levels=levels,
        partition="surface",
        prediction=prediction,
        update=update,
        norm=norm,
        removal_fraction=removal_fraction,
        locked=locked,
    )
    helpers.assert_pyramid_is_consistent(pyramid, mesh)
    np.testing.assert_array_equal(
        pyramid.mesh(0).vertices[locked[pyramid.vertex_ids(0)]], mesh.vertices[locked]
    )


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("prediction", ["uniform", "geometric", "nnls", "cotangent"])
def test_a_closed_surface(prediction, seed):
    mesh = ball(60, seed)
    pyramid = analyse(mesh, levels=30, partition="quadric", prediction=prediction, signal="xyz")
    assert pyramid.n_vertices(0) >= 4
    helpers.assert_pyramid_is_consistent(pyramid, mesh)


@BOTH_SIGNALS
@pytest.mark.parametrize("dtype", [np.float32, np.int16, np.float64])
def test_input_of_any_number_type(dtype, signal):
    mesh = random_delaunay(50, seed=5, scale=1000.0)
    rounded = type(mesh)(np.round(mesh.vertices).astype(dtype), mesh.faces)
    areas = rounded.plan_areas
    sound = type(mesh)(rounded.vertices, rounded.faces[areas > 0])
    pyramid = analyse(sound, levels=4, partition="quadric", prediction="NNLSMN", signal=signal)
    helpers.assert_pyramid_is_consistent(pyramid, sound)


def test_one_ring_mean_beside_locked_vertices_with_weights_that_nearly_cancel():
    """Rescaling such weights to sum 1 once blew the coefficients up to 1e11 times their size."""
    mesh = grid_with_holes(3, 5, seed=0, hole_share=0.0)
    locked = np.random.default_rng(0).random(15) < 0.05
    pyramid = analyse(
        mesh, levels=6, partition="quadric", prediction="LS", update="ORMP", locked=locked
    )
    helpers.assert_pyramid_is_consistent(pyramid, mesh)
    assert np.abs(pyramid.coarse).max() < 100
