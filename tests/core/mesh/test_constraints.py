"""Edges in a triangulation without PythonCDT: by flips, the same faces as the library's."""

import sys

import numpy as np
import pytest

from wavelet_core import TriangleMesh
from wavelet_core.errors import MeshError, MissingDependencyError
from wavelet_core.mesh import triangulation
from wavelet_core.mesh.constraints import with_edges
from wavelet_core.mesh.triangulation import delaunay_faces


@pytest.fixture
def no_library(monkeypatch):
    """Take PythonCDT away."""
    monkeypatch.setitem(sys.modules, "pythoncdt", None)


def as_set(faces):
    """Return faces as rotated triples, whatever vertex they begin with."""
    first = faces.argmin(axis=1)
    rows = np.arange(len(faces))
    return set(zip(*(faces[rows, (first + k) % 3].tolist() for k in range(3)), strict=True))


def edges_in(faces):
    return {tuple(sorted(e)) for f in faces.tolist() for e in zip(f, [*f[1:], f[0]], strict=True)}


def star(n_rays, n_points, seed):
    """Return points, and edges from a hub to places on a circle, which cannot cross."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, n_rays))
    tips = 40 * np.column_stack([np.cos(angle), np.sin(angle)])
    plan = np.vstack([[[0.3, 0.2]], tips, rng.uniform(-50, 50, (n_points, 2))])
    ring = [[k, k % n_rays + 1] for k in range(1, n_rays + 1)]
    return plan, np.array([[0, k] for k in range(1, n_rays + 1)] + ring)


@pytest.mark.parametrize("seed", range(6))
def test_the_faces_are_those_of_the_library(seed, monkeypatch):
    pytest.importorskip("pythoncdt")
    plan, edges = star(7 + seed, 400, seed)
    plan += [500_000.0, 5_400_000.0]
    expected = delaunay_faces(plan, edges)
    monkeypatch.setitem(sys.modules, "pythoncdt", None)
    faces = delaunay_faces(plan, edges)
    assert {tuple(sorted(e)) for e in edges.tolist()} <= edges_in(faces)
    assert as_set(faces) == as_set(expected)


def test_an_edge_through_vertices_is_cut_there(no_library):
    """Nine points on a lattice; the long diagonal runs through the one in the middle."""
    y, x = np.mgrid[:3, :3].astype(float)
    plan = np.column_stack([x.ravel(), y.ravel()])
    faces = delaunay_faces(plan, np.array([[0, 8], [3, 5]]))
    assert {(0, 4), (4, 8), (3, 4), (4, 5)} <= edges_in(faces)
    assert len(faces) == 8


def test_edges_that_cross_are_refused(no_library):
    plan = np.array([[0, 0], [4, 0.5], [4, 4], [0.2, 4], [2, -1], [1.5, 5.0]])
    with pytest.raises(MeshError, match="split them where they cross"):
        delaunay_faces(plan, np.array([[0, 2], [1, 3]]))


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_long_edge_through_many_faces(no_library, scale):
    plan = np.random.default_rng(5).uniform(0, 1, (3000, 2)) * scale
    plan[:4] = np.array([[0.01, 0.02], [0.97, 0.99], [0.02, 0.95], [0.03, 0.9]]) * scale
    faces = delaunay_faces(plan, np.array([[0, 1], [2, 3]]))
    assert {(0, 1), (2, 3)} <= edges_in(faces)
    points = np.column_stack([plan, np.zeros(len(plan))])
    mesh = TriangleMesh(points, faces)  # refuses what is no surface
    assert mesh.n_vertices == 3000


def test_an_outline_of_many_points_on_straight_sides(no_library):
    """Qhull gives flat faces along such sides; they are peeled off."""
    rng = np.random.default_rng(0)
    corners = np.array([[-10, -3], [1010, 2.0], [1005, 1007], [-3, 1003]])
    t = np.linspace(0, 1, 700)[:-1, None]
    sides = [a + (b - a) * t for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    far = np.array([500_000.0, 5_400_000.0])
    ring = np.vstack(sides) + far
    plan = np.vstack([ring, rng.uniform(5, 995, (5000, 2)) + far])
    index = np.arange(len(ring))
    edges = np.column_stack([index, np.roll(index, -1)])
    faces = delaunay_faces(plan, edges)
    assert {tuple(sorted(e)) for e in edges.tolist()} <= edges_in(faces)
    a, b, c = (plan[faces[:, k]] - plan[0] for k in range(3))
    ab, ac = b - a, c - a
    assert (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0] > 0).all()


def test_geos_helps_where_qhull_loses_points(no_library, monkeypatch):
    pytest.importorskip("shapely")
    plan = np.random.default_rng(1).uniform(0, 100, (500, 2))
    expected = delaunay_faces(plan)
    monkeypatch.setattr(triangulation, "_qhull_faces", lambda centred: np.array([[0, 1, 2]]))
    assert as_set(delaunay_faces(plan)) == as_set(expected)
    monkeypatch.setitem(sys.modules, "shapely", None)
    with pytest.raises(MissingDependencyError, match="pip install pythoncdt"):
        delaunay_faces(plan)


def test_an_edge_out_of_the_triangulation_is_refused():
    """A dent: the edge between its two tips leaves the faces.

    3-------2
    | \\   / |
    |   4   |
    | /   \\ |
    0       1
    """
    plan = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 2.0]])
    faces = np.array([[0, 4, 3], [3, 4, 2], [1, 2, 4]])
    with pytest.raises(MeshError, match="leaves the triangulation"):
        with_edges(plan, faces, np.array([[0, 1]]))
