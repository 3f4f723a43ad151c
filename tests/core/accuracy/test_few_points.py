"""Errors of every level at few points: those that whole levels give."""

import numpy as np
import pytest
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import Pyramid, TriangleMesh, analyse
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.accuracy.few_points import errors_by_level
from wavelet_core.metrics import surface_errors

MESHES = {
    "delaunay": lambda: random_delaunay(400, seed=6, scale=100.0),
    "holes": lambda: grid_with_holes(20, 24, seed=3, hole_share=0.15, scale=50.0),
}


def _lone_vertex():
    mesh = random_delaunay(60, seed=2, scale=10.0)
    vertices = np.vstack([mesh.vertices, [[50.0, 50.0, 3.0]]])
    return TriangleMesh(vertices, mesh.faces)


@pytest.mark.parametrize("name", [*MESHES, "lone"])
@pytest.mark.parametrize("engine_name", ["compiled" if HAS_NUMBA else "loops", "arrays"])
def test_errors_are_those_of_whole_levels(name, engine_name):
    mesh = _lone_vertex() if name == "lone" else MESHES[name]()
    pyramid = analyse(mesh, target_vertices=25)
    rng = np.random.default_rng(7)
    rows = rng.choice(mesh.n_vertices, 12, replace=False)
    rows[-1] = mesh.n_vertices - 1
    points = mesh.vertices[rows] + np.array([0.0, 0.0, 5.0])
    beside = points[:1] + np.array([1e4, 0.0, 0.0])
    for asked in (points, points[:1], np.vstack([points, beside])):
        with engine(engine_name):
            found = list(errors_by_level(pyramid, asked))
        assert len(found) == len(pyramid)
        for errors, level in zip(found, pyramid, strict=True):
            np.testing.assert_array_equal(errors, surface_errors(level, asked))


def test_points_that_no_face_covers_cost_no_whole_levels(monkeypatch):
    """Each level was made anew for one of them: as many syntheses as levels."""
    mesh = _lone_vertex()
    pyramid = analyse(mesh, target_vertices=25)
    points = np.array([[50.0, 50.0, 9.0], [1e4, 0.0, 0.0]])
    monkeypatch.setattr(Pyramid, "mesh", lambda *_: pytest.fail("a whole level was made"))
    for errors in errors_by_level(pyramid, points):
        np.testing.assert_array_equal(errors, [6.0, np.nan])
