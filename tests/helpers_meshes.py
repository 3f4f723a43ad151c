"""Meshes to test on: random, gridded with holes, fans, the smallest there are; and TINs on them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, Delaunay

from wavelet_core import TriangleMesh
from wavelet_core.metrics import surface_errors

ATTRIBUTE_NAMES = ("class", "intensity", "hag", "red")


def bumpy(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return a smooth surface with hills of several sizes, for x and y in [0, 1]."""
    return (
        np.sin(5.1 * x + 0.3) * np.cos(3.7 * y)
        + 0.4 * np.sin(17 * x * y + 1)
        + 0.2 * np.exp(-80 * ((x - 0.4) ** 2 + (y - 0.6) ** 2))
    )


def attributes_at(x: np.ndarray, y: np.ndarray, n: int, rng: np.random.Generator) -> np.ndarray:
    """Return ``n`` attributes of mixed kinds: classes, a smooth one, noise, a constant."""
    columns = [
        np.floor(4 * np.clip(x, 0, 0.999)),
        10 + np.cos(4 * y),
        rng.standard_normal(len(x)),
        np.full(len(x), 7.0),
    ]
    return np.column_stack(columns[:n]) if n else np.empty((len(x), 0))


def random_delaunay(
    n: int, n_attributes: int = 0, seed: int = 0, offset: float = 0.0, scale: float = 1.0
) -> TriangleMesh:
    """Return the Delaunay mesh of ``n`` random points of a bumpy surface."""
    rng = np.random.default_rng(seed)
    plan = rng.random((n, 2))
    faces = Delaunay(plan).simplices
    z = bumpy(*plan.T) + 0.02 * rng.standard_normal(n)
    vertices = scale * (np.column_stack([plan, z]) + offset)
    attributes = attributes_at(*plan.T, n_attributes, rng)
    return TriangleMesh.from_triangles(vertices, faces, attributes, ATTRIBUTE_NAMES[:n_attributes])


def grid_with_holes(
    n_rows: int,
    n_columns: int,
    n_attributes: int = 0,
    seed: int = 0,
    hole_share: float = 0.05,
    offset: float = 0.0,
    scale: float = 1.0,
) -> TriangleMesh:
    """Return a raster's mesh in which a share of the cells carries no data."""
    rng = np.random.default_rng(seed)
    x, y = np.linspace(0, 1, n_columns), np.linspace(1, 0, n_rows)
    x_of_cell, y_of_cell = (a.ravel() for a in np.meshgrid(x, y))
    z = bumpy(x_of_cell, y_of_cell) + 0.01 * rng.standard_normal(n_rows * n_columns)
    valid = rng.random((n_rows, n_columns)) >= hole_share
    valid[0, 0] = True
    attributes = attributes_at(x_of_cell, y_of_cell, n_attributes, rng)
    return TriangleMesh.from_grid(
        scale * (z.reshape(n_rows, n_columns) + offset),
        x=scale * (x + offset),
        y=scale * (y + offset),
        valid=valid,
        attributes=attributes.reshape(n_rows, n_columns, -1) if n_attributes else None,
        attribute_names=ATTRIBUTE_NAMES[:n_attributes],
    )


def fan(
    n_spokes: int,
    closed: bool,
    n_attributes: int = 0,
    seed: int = 0,
    offset: float = 0.0,
    scale: float = 1.0,
) -> TriangleMesh:
    """Return faces around vertex 0: all the way round, or three quarters of it."""
    rng = np.random.default_rng(seed)
    turn = 2 * np.pi if closed else 1.5 * np.pi
    angles = np.linspace(0, turn, n_spokes, endpoint=not closed)
    radius = rng.uniform(0.7, 1.3, n_spokes)
    plan = np.vstack([[0, 0], np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])])
    z = rng.standard_normal(n_spokes + 1)
    first = np.arange(1, n_spokes + 1)
    second = np.roll(first, -1)
    if not closed:
        first, second = first[:-1], second[:-1]
    faces = np.column_stack([np.zeros_like(first), first, second])
    attributes = attributes_at(*np.abs(plan.T), n_attributes, rng)
    return TriangleMesh(
        scale * (np.column_stack([plan, z]) + offset),
        faces,
        attributes,
        ATTRIBUTE_NAMES[:n_attributes],
    )


def single_triangle(
    n_attributes: int = 0, seed: int = 0, offset: float = 0.0, scale: float = 1.0
) -> TriangleMesh:
    """Return the mesh of one face."""
    rng = np.random.default_rng(seed)
    plan = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 1.0]])
    vertices = scale * (np.column_stack([plan, rng.standard_normal(3)]) + offset)
    attributes = attributes_at(*plan.T, n_attributes, rng)
    return TriangleMesh(vertices, [[0, 1, 2]], attributes, ATTRIBUTE_NAMES[:n_attributes])


def tube(n_sides: int, n_rings: int, radius: float = 1.0) -> TriangleMesh:
    """Return an upright tube, open at both ends: a surface that folds over itself in plan.

    Vertex ``ring * n_sides + side``; the first ring is the lower mouth. The tube widens a little
    downwards, so that its plan area counts as positive.
    """
    vertices, faces = [], []
    for ring in range(n_rings):
        wide = radius * (1 + 0.1 * (n_rings - 1 - ring))
        for side in range(n_sides):
            angle = 2 * np.pi * side / n_sides
            vertices.append([wide * np.cos(angle), wide * np.sin(angle), ring])
    for ring in range(n_rings - 1):
        for side in range(n_sides):
            a = ring * n_sides + side
            b = ring * n_sides + (side + 1) % n_sides
            faces += [[a, b, b + n_sides], [a, b + n_sides, a + n_sides]]
    return TriangleMesh(vertices, faces)


def ball(n: int, seed: int = 0) -> TriangleMesh:
    """Return a closed surface: the hull of random points on a sphere, faces outwards."""
    points = np.random.default_rng(seed).standard_normal((n, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    faces = ConvexHull(points).simplices
    a, b, c = (points[faces[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    return TriangleMesh._trusted(points, faces, np.empty((n, 0)), ())


@st.composite
def meshes(
    draw: st.DrawFn,
    max_vertices: int = 80,
    scales: tuple[float, ...] = (1e-6, 1.0, 1e6),
    offsets: tuple[float, ...] = (0.0, 1e6),
) -> TriangleMesh:
    """Return a mesh of any kind, with up to four attributes, far from the origin or not."""
    options = {
        "n_attributes": draw(st.integers(0, 4)),
        "seed": draw(st.integers(0, 2**32 - 1)),
        "offset": draw(st.sampled_from(offsets)),
        "scale": draw(st.sampled_from(scales)),
    }
    what = draw(st.sampled_from(["delaunay", "grid", "closed fan", "open fan", "triangle"]))
    if what == "delaunay":
        return random_delaunay(draw(st.integers(4, max_vertices)), **options)
    if what == "grid":
        side = max(3, int(max_vertices**0.5))
        share = draw(st.sampled_from([0.0, 0.05, 0.3]))
        n_rows, n_columns = draw(st.integers(2, side)), draw(st.integers(2, side))
        return grid_with_holes(n_rows, n_columns, hole_share=share, **options)
    if what == "triangle":
        return single_triangle(**options)
    return fan(draw(st.integers(4, 12)), closed=what == "closed fan", **options)


def edges_of(faces):
    return np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def assert_refined(refined, ids, coarse, original):
    """A TIN on input points that has no flip, no doubled edge and no gap that was not there."""
    mesh = refined.mesh
    assert len(np.unique(refined.vertex_ids)) == mesh.n_vertices
    np.testing.assert_array_equal(mesh.vertices[:, :2], original.vertices[refined.vertex_ids, :2])
    assert (mesh.plan_areas > 0).all()
    pairs = edges_of(mesh.faces)
    assert len(np.unique(pairs, axis=0)) == len(pairs)
    np.testing.assert_allclose(mesh.plan_areas.sum(), coarse.plan_areas.sum(), rtol=1e-9)
    before, after = (surface_errors(m, original.vertices) for m in (coarse, mesh))
    np.testing.assert_array_equal(np.isnan(before), np.isnan(after))
    # Euler: as many vertices with faces, and outlines, give as many faces
    assert euler(mesh) == euler(coarse)


def euler(mesh):
    undirected = np.unique(np.sort(edges_of(mesh.faces), axis=1), axis=0)
    return len(np.unique(mesh.faces)) - len(undirected) + mesh.n_faces


def slow_errors(mesh, points):
    """Return vertical errors by a search through all faces: an oracle of its own."""
    errors = np.full(len(points), np.nan)
    for face in mesh.faces[::-1]:
        a, b, c = mesh.vertices[face]
        matrix = np.array([[a[0], b[0], c[0]], [a[1], b[1], c[1]], [1.0, 1.0, 1.0]])
        weights = np.linalg.solve(matrix, np.vstack([points[:, :2].T, np.ones(len(points))]))
        inside = (weights >= -1e-9).all(axis=0)
        height = weights.T @ np.array([a[2], b[2], c[2]])
        errors[inside] = (points[:, 2] - height)[inside]
    return errors
