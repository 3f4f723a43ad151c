"""Half-edges of faces: twins and fans, and what is no surface is refused."""

import numpy as np
import pytest
from helpers_meshes import grid_with_holes
from hypothesis import given
from hypothesis import strategies as st

from wavelet_core import MeshError
from wavelet_core._kernels._jit import engine
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.half_edges import half_edges_of

SQUARE = [[0, 1, 2], [0, 2, 3]]


def test_twins_and_fans_of_a_square():
    mesh, n_fans = half_edges_of(np.array(SQUARE, dtype=np.int32), 5)
    assert mesh.twin.tolist() == [-1, -1, 3, 2, -1, -1]
    assert n_fans.tolist() == [1, 1, 1, 1, 0]


@pytest.mark.parametrize(
    "more",
    [
        [[0, 1, 4]],  # the edge 0-1 twice, and none runs back
        [[0, 2, 4]],  # 0-2 twice, and one runs back
        [[2, 0, 4]],
        [[0, 1, 2]],
    ],
)
@pytest.mark.parametrize("name", ["loops", "arrays"])
def test_faces_that_are_no_surface(more, name):
    faces = np.array(SQUARE + more, dtype=np.int32)
    with engine(name), pytest.raises(MeshError, match="share the edge"):
        half_edges_of(faces, 5)


def test_a_hundred_thousand_faces_at_one_edge_are_refused_at_once():
    third = np.arange(2, 100_002)
    faces = np.column_stack([np.zeros_like(third), np.ones_like(third), third]).astype(np.int32)
    with pytest.raises(MeshError, match="and 99,994 more share the edge 0-1"):
        half_edges_of(faces, 100_002)


def test_fans_that_touch_at_a_vertex_are_a_surface():
    faces = np.array([[0, 1, 2], [0, 3, 4]], dtype=np.int32)
    assert half_edges_of(faces, 5)[1].tolist() == [2, 1, 1, 1, 1]
    holes = grid_with_holes(14, 16, seed=5, hole_share=0.12).faces.astype(np.int32)
    assert half_edges_of(holes, int(holes.max()) + 1)[1].max() == 2


@given(st.data())
def test_refused_is_what_has_no_ordered_rings(data):
    """Soups of few vertices, of which most are no surface, and parts of a surface."""
    n = data.draw(st.integers(3, 7))
    corners = st.lists(st.integers(0, n - 1), min_size=3, max_size=3, unique=True)
    faces = np.array(data.draw(st.lists(corners, min_size=1, max_size=8)), dtype=np.int32)
    try:
        build_connectivity(faces, n)
        expected = None
    except MeshError as error:
        expected = str(error)
    for name in ("loops", "arrays"):
        with engine(name):
            try:
                half_edges_of(faces, n)
                found = None
            except MeshError as error:
                found = str(error)
        assert found == expected
