"""The shared assertions can fail: each is shown the fault that it is there to find."""

import dataclasses

import helpers
import numpy as np
import pytest
from helpers_meshes import fan, grid_with_holes, random_delaunay, single_triangle, tube

from wavelet_core import TriangleMesh, analyse


@pytest.fixture
def mesh():
    return random_delaunay(40, n_attributes=2, seed=1)


@pytest.fixture
def pyramid(mesh):
    return analyse(mesh, levels=2, partition="quadric", prediction="geometric")


def changed(pyramid, level, **parts):
    """Return the pyramid with other parts in the step at ``level``."""
    steps = list(pyramid.steps)
    steps[level] = dataclasses.replace(steps[level], **parts)
    return pyramid.with_parts(steps=tuple(steps))


class Altered:
    """A pyramid whose answers are those of another one, but for what is given."""

    def __init__(self, pyramid, **answers):
        self._pyramid = pyramid
        self._answers = answers

    def __getattr__(self, name):
        return self._answers.get(name, getattr(self._pyramid, name))

    def __iter__(self):
        return iter(self._pyramid)


def test_the_sound_pyramid_passes(pyramid, mesh):
    helpers.assert_pyramid_is_consistent(pyramid, mesh)


def test_a_changed_detail_is_seen(pyramid, mesh):
    details = pyramid.steps[0].details.copy()
    details[0, 1] += 1e-6
    with pytest.raises(AssertionError, match="differs by"):
        helpers.assert_pyramid_is_consistent(changed(pyramid, 0, details=details), mesh)


def test_another_column_scale_hides_nothing(mesh):
    vertices = mesh.vertices.copy()
    vertices[3, 0] += 1e-8
    other = TriangleMesh(vertices, mesh.faces, 1e6 * mesh.attributes, mesh.attribute_names)
    wanted = TriangleMesh(mesh.vertices, mesh.faces, 1e6 * mesh.attributes, mesh.attribute_names)
    with pytest.raises(AssertionError, match="column x"):
        helpers.assert_same_mesh(other, wanted)


def test_another_face_is_seen(mesh):
    other = TriangleMesh(mesh.vertices, mesh.faces[1:], mesh.attributes, mesh.attribute_names)
    with pytest.raises(AssertionError):
        helpers.assert_same_mesh(other, mesh)


def test_a_wrong_update_filter_is_seen(pyramid):
    pair = pyramid.filters(1)
    wrong = pair._replace(update=pair.update * 1.001)
    with pytest.raises(AssertionError, match="s = s_even"):
        helpers.assert_step_is_consistent(Altered(pyramid, filters=lambda level: wrong), 1)


def test_weights_that_do_not_sum_to_one_are_seen(pyramid):
    pair = pyramid.filters(1)
    wrong = pair._replace(prediction=pair.prediction * (1 + 1e-11))
    with pytest.raises(AssertionError, match="sum to 1"):
        helpers.assert_step_is_consistent(Altered(pyramid, filters=lambda level: wrong), 1)


def test_a_negative_weight_is_seen(pyramid):
    pair = pyramid.filters(1)
    prediction = pair.prediction.copy()
    first, second = prediction.data[:2].copy()
    prediction.data[:2] = -1e-10, first + second + 1e-10
    wrong = pair._replace(prediction=prediction)
    details = pyramid.detail(1)
    s_even = helpers.columns_of(pyramid.mesh(2), pyramid.channels)[pair.even]
    vectors = details.vectors + (pair.prediction - prediction) @ s_even
    altered = Altered(
        pyramid,
        filters=lambda level: wrong,
        detail=lambda level: dataclasses.replace(details, vectors=vectors),
        update="one_ring_mean",
    )
    with pytest.raises(AssertionError, match="a weight of P"):
        helpers.assert_step_is_consistent(altered, 1)


def test_a_moving_integral_is_seen(pyramid):
    def integrals(level):
        return pyramid.integrals(level) * (1 + 1e-10 * (level == 0))

    with pytest.raises(AssertionError, match="integral moves"):
        helpers.assert_integral_is_constant(Altered(pyramid, integrals=integrals))


def test_two_fans_at_a_vertex_are_seen():
    bow_tie = TriangleMesh(
        [[0, 0, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]], [[0, 1, 2], [0, 3, 4]]
    )
    np.testing.assert_array_equal(helpers.n_fans(bow_tie.faces, 5), [2, 1, 1, 1, 1])
    with pytest.raises(AssertionError, match="separate fans"):
        helpers.assert_manifold(bow_tie)
    helpers.assert_manifold(bow_tie, np.array([2, 1, 1, 1, 1]))


def test_an_edge_of_three_faces_is_seen():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
    book = TriangleMesh(vertices, [[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    with pytest.raises(AssertionError, match="more than two faces"):
        helpers.assert_manifold(book)


def test_faces_back_to_back_are_seen():
    weld = TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]])
    with pytest.raises(AssertionError, match="back to back"):
        helpers.assert_manifold(weld)


def test_flat_and_flipped_faces_are_seen():
    flat = TriangleMesh([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2]])
    with pytest.raises(AssertionError, match="no area"):
        helpers.assert_faces_have_area(flat, in_plan=False)
    upright_wall = TriangleMesh([[0, 0, 0], [1, 1, 0], [0, 0, 2]], [[0, 1, 2]])
    helpers.assert_faces_have_area(upright_wall, in_plan=False)
    with pytest.raises(AssertionError, match="flipped or flat"):
        helpers.assert_faces_have_area(upright_wall, in_plan=True)


@pytest.mark.parametrize(
    ("mesh", "expected"),
    [
        (single_triangle(), 1),
        (fan(6, closed=True), 1),
        (fan(6, closed=False), 1),
        (grid_with_holes(5, 7, hole_share=0.0), 1),
        (tube(5, 3), 0),
    ],
    ids=["triangle", "closed fan", "open fan", "grid", "tube"],
)
def test_euler_numbers_that_are_known(mesh, expected):
    assert helpers.euler_number(mesh.n_vertices, mesh.faces) == expected


def test_a_filled_hole_changes_the_euler_number():
    mesh = tube(4, 2)
    with_lid = np.vstack([mesh.faces, [[4, 5, 6], [4, 6, 7]]])
    assert helpers.euler_number(8, with_lid) == helpers.euler_number(8, mesh.faces) + 1
