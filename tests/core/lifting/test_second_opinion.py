"""The core agrees with a slow, plain reference that was written from the equations alone."""

import helpers
import numpy as np
import pytest
import reference
from helpers_meshes import fan, grid_with_holes, random_delaunay

from wavelet_core import COSTS, QUADRICS, SIGNALS, analyse

MESHES = {
    "delaunay": lambda: random_delaunay(60, n_attributes=2, seed=3),
    "delaunay, z alone": lambda: random_delaunay(45, seed=11),
    "far from the origin": lambda: random_delaunay(45, n_attributes=1, seed=4, offset=1e6),
    "grid with holes": lambda: grid_with_holes(8, 9, n_attributes=1, seed=5),
    "open fan": lambda: fan(7, closed=False, n_attributes=1, seed=6),
    "closed fan": lambda: fan(7, closed=True, seed=7),
}
LEVELS = 4


def partitions_of(pyramid):
    """Return (odd, target) of each step, the first one carried out first."""
    return [(step.odd, step.target) for step in reversed(pyramid.steps)]


def assert_agree(pyramid, analysis, weight_tolerance, value_tolerance):
    """Assert equal filters, details, coefficients, integrals and faces on all levels."""
    assert len(analysis.steps) == pyramid.n_levels
    for ours, theirs in enumerate(reversed(analysis.steps)):
        step, pair = pyramid.steps[ours], pyramid.filters(ours)
        coarse = pyramid.mesh(ours)
        names = [f"{what} at level {ours}" for what in "PwUζs"]
        update = np.zeros(pair.update.shape) if theirs.u is None else theirs.u
        for name, actual, expected, tolerance in zip(
            names,
            (
                pair.prediction.toarray(),
                step.details,
                pair.update.toarray(),
                pyramid.integrals(ours),
                helpers.columns_of(coarse, pyramid.channels),
            ),
            (theirs.p, theirs.w, update, theirs.zeta, theirs.s),
            (weight_tolerance, value_tolerance) + (weight_tolerance,) * 2 + (value_tolerance,),
            strict=True,
        ):
            size = max(1.0, np.abs(expected).max(initial=0))
            np.testing.assert_allclose(
                actual, expected, rtol=0, atol=tolerance * size, err_msg=name
            )
        np.testing.assert_array_equal(pair.even, theirs.even)
        np.testing.assert_array_equal(
            helpers.canonical_faces(coarse.faces), helpers.canonical_faces(theirs.faces)
        )


def filters_of(pyramid):
    """Return (P, U) of each step as dense matrices, the first one carried out first.

    They stand in for a filter of the tables that the reference has no formula for, so that the
    rest of the lifting is held against it all the same.
    """
    pairs = (pyramid.filters(level) for level in reversed(range(pyramid.n_levels)))
    return [(pair.prediction.toarray(), pair.update.toarray()) for pair in pairs]


@helpers.UNSTABLE_TOO
@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize(
    ("prediction", "update"), [pair for pair in helpers.PAIRS if pair[0] in helpers.PREDICTIONS]
)
@pytest.mark.parametrize("mesh_name", MESHES)
def test_filters_and_coefficients(mesh_name, prediction, update, signal):
    """Given the same partition, P, U, w, s, ζ and the coarse faces are the same."""
    mesh = MESHES[mesh_name]()
    options = {"prediction": prediction, "update": update, "signal": signal}
    pyramid = analyse(mesh, levels=LEVELS, partition="quadric", **options)
    analysis = reference.analyse(
        mesh.vertices,
        mesh.faces,
        mesh.attributes,
        levels=LEVELS,
        partitions=partitions_of(pyramid),
        filters=filters_of(pyramid),
        **options,
    )
    if prediction == "least_squares":
        # Weights that hardly change the detail are determined by the damping of 1e-8 alone.
        assert_agree(pyramid, analysis, weight_tolerance=1e-4, value_tolerance=1e-6)
    else:
        assert_agree(pyramid, analysis, weight_tolerance=1e-8, value_tolerance=1e-9)


@pytest.mark.parametrize(
    ("prediction", "update"),
    [pair for pair in helpers.PAIRS if pair[0] in helpers.PLAN_PREDICTIONS],
)
@pytest.mark.parametrize("mesh_name", ["delaunay", "delaunay, z alone", "open fan"])
def test_filters_beyond_the_paper(mesh_name, prediction, update):
    """On a grid an odd vertex may lie on an edge of two covering faces; so these are no grids."""
    mesh = MESHES[mesh_name]()
    options = {"prediction": prediction, "update": update, "signal": "z"}
    pyramid = analyse(mesh, levels=LEVELS, partition="quadric", **options)
    analysis = reference.analyse(
        mesh.vertices,
        mesh.faces,
        mesh.attributes,
        levels=LEVELS,
        partitions=partitions_of(pyramid),
        filters=filters_of(pyramid),
        **options,
    )
    assert_agree(pyramid, analysis, weight_tolerance=1e-8, value_tolerance=1e-9)


@pytest.mark.parametrize("prediction", ["geometric", "nnls"])
@pytest.mark.parametrize("update", ["one_ring_mean", "minimum_norm", "martinez_ortega"])
def test_locked_vertices(prediction, update):
    """The support of the update leaves locked vertices out, on every level."""
    mesh = random_delaunay(60, n_attributes=2, seed=8)
    locked = np.random.default_rng(0).random(60) < 0.4
    options = {"prediction": prediction, "update": update, "signal": "xyz", "locked": locked}
    pyramid = analyse(mesh, levels=3, partition="quadric", **options)
    assert pyramid.n_levels == 3
    analysis = reference.analyse(
        mesh.vertices,
        mesh.faces,
        mesh.attributes,
        levels=3,
        partitions=partitions_of(pyramid),
        **options,
    )
    assert_agree(pyramid, analysis, weight_tolerance=1e-8, value_tolerance=1e-9)


@pytest.mark.parametrize("partition", ["quadric", "colouring"])
@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_any_partition_replays_to_the_same_faces(partition, signal):
    mesh = grid_with_holes(9, 9, seed=2, hole_share=0.1)
    pyramid = analyse(mesh, levels=6, partition=partition, signal=signal)
    faces = [tuple(face) for face in mesh.faces.tolist()]
    for level in reversed(range(pyramid.n_levels)):
        step = pyramid.steps[level]
        for v, a in zip(step.odd.tolist(), step.target.tolist(), strict=True):
            faces = reference.collapse(faces, v, a)
        position = {v: m for m, v in enumerate(pyramid.filters(level).even.tolist())}
        faces = [tuple(position[v] for v in face) for face in faces]
        np.testing.assert_array_equal(
            helpers.canonical_faces(faces), helpers.canonical_faces(pyramid.mesh(level).faces)
        )


@pytest.mark.parametrize("quadrics", QUADRICS)
@pytest.mark.parametrize("cost", COSTS)
@pytest.mark.parametrize("signal", SIGNALS)
def test_readings_of_the_quadric_partition(quadrics, cost, signal):
    """The same vertices go, in order, onto the same targets, whichever way the paper is read."""
    mesh = random_delaunay(70, n_attributes=1, seed=4)
    options = {"prediction": "geometric", "update": "minimum_norm", "signal": signal}
    options |= {"bending_weight": 0.1, "cost": cost}
    pyramid = analyse(mesh, levels=LEVELS, partition="quadric", quadrics=quadrics, **options)
    analysis = reference.analyse(
        mesh.vertices, mesh.faces, mesh.attributes, levels=LEVELS, quadrics_of=quadrics, **options
    )
    assert len(analysis.steps) == pyramid.n_levels
    for ours, theirs in zip(reversed(pyramid.steps), analysis.steps, strict=True):
        np.testing.assert_array_equal(ours.odd, theirs.odd)
        np.testing.assert_array_equal(ours.target, theirs.target)


@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize("prediction", ["geometric", "nnls", "cotangent"])
@pytest.mark.parametrize("seed", [0, 1, 3, 5])
def test_quadric_partition(seed, prediction, signal):
    """Algorithms 1 and 2 and Eqs. 52-53: the same vertices go, in order, onto the same targets."""
    meshes = [
        random_delaunay(40 + 10 * seed, n_attributes=seed % 4, seed=seed),
        grid_with_holes(7, 7 + seed, n_attributes=seed % 3, seed=seed),
    ]
    for mesh in meshes:
        options = {
            "prediction": prediction,
            "update": "minimum_norm",
            "signal": signal,
            "bending_weight": (1.0, 0.3)[seed % 2],
            "attribute_weights": (0.5, 2, 1)[: mesh.attributes.shape[1]],
        }
        pyramid = analyse(mesh, levels=LEVELS, partition="quadric", **options)
        analysis = reference.analyse(
            mesh.vertices, mesh.faces, mesh.attributes, levels=LEVELS, **options
        )
        assert len(analysis.steps) == pyramid.n_levels
        for ours, theirs in zip(reversed(pyramid.steps), analysis.steps, strict=True):
            np.testing.assert_array_equal(ours.odd, theirs.odd)
            np.testing.assert_array_equal(ours.target, theirs.target)


def test_the_reference_itself_reconstructs():
    """Eqs. 32-33 undo what the reference did, so that it is no second copy of one mistake."""
    mesh = random_delaunay(50, n_attributes=1, seed=9)
    analysis = reference.analyse(
        mesh.vertices,
        mesh.faces,
        mesh.attributes,
        levels=3,
        prediction="nnls",
        update="minimum_norm",
        signal="xyz",
    )
    coefficients = analysis.steps[-1].s
    for step in reversed(analysis.steps):
        even = coefficients - step.u @ step.w
        fine = np.empty((len(step.odd) + len(step.even), even.shape[1]))
        fine[step.even] = even
        fine[step.odd] = step.w + step.p @ even
        coefficients = fine
    np.testing.assert_allclose(
        coefficients, np.column_stack([mesh.vertices, mesh.attributes]), atol=1e-12
    )
