"""Analytic surfaces and tiny named meshes, for tests, docs and demonstrations."""

from __future__ import annotations

import numpy as np

from ._validate import FloatArray
from .mesh.triangle_mesh import TriangleMesh


def hills(n_rows: int = 60, n_columns: int = 80, cell: float = 10.0) -> TriangleMesh:
    """Return smooth hills on a grid, ``n_rows`` by ``n_columns`` vertices, ``cell`` apart."""
    x, y = cell * np.arange(n_columns), cell * np.arange(n_rows)
    u, v = np.meshgrid(x / (cell * n_columns), y / (cell * n_rows))
    elevation = (
        300 + 80 * np.sin(6 * u) * np.cos(5 * v) + 40 * np.exp(-30 * ((u - 0.6) ** 2 + v**2))
    )
    return TriangleMesh.from_grid(elevation, x=x, y=y)


def plane(
    n_rows: int = 12, n_columns: int = 15, slope: tuple[float, float] = (0.3, -0.2)
) -> TriangleMesh:
    """Return a tilted plane on a grid with cells of 1."""
    x, y = np.arange(float(n_columns)), np.arange(float(n_rows))
    elevation = 5 + slope[0] * x[None, :] + slope[1] * y[:, None]
    return TriangleMesh.from_grid(elevation, x=x, y=y)


def ridge(n_rows: int = 21, n_columns: int = 31, height: float = 10.0) -> TriangleMesh:
    """Return a roof: two planes that meet in a straight ridge along the middle row."""
    x, y = np.arange(float(n_columns)), np.arange(float(n_rows))
    elevation = height * (1 - np.abs(y - y.mean()) / y.mean())
    return TriangleMesh.from_grid(np.repeat(elevation[:, None], n_columns, axis=1), x=x, y=y)


def fan(n_sides: int = 6, apex: float = 1.0, radius: float = 1.0) -> TriangleMesh:
    """Return one interior vertex (id 0, at ``apex``) with a regular ring of ``n_sides`` at 0."""
    angles = 2 * np.pi * np.arange(n_sides) / n_sides
    ring = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.zeros(n_sides)])
    vertices = np.vstack([[0.0, 0.0, apex], ring])
    k = np.arange(n_sides)
    return TriangleMesh(vertices, np.column_stack([0 * k, 1 + k, 1 + (k + 1) % n_sides]))


def scattered(
    n_points: int = 500, seed: int = 0, n_attributes: int = 0, extent: float = 100.0
) -> TriangleMesh:
    """Return the Delaunay TIN of random points on a wavy surface, with random-ish attributes."""
    generator = np.random.default_rng(seed)
    plan: FloatArray = generator.uniform(0, extent, (n_points, 2))
    u, v = plan.T / extent
    z = 0.1 * extent * np.sin(5 * u) * np.cos(4 * v) + 0.01 * extent * generator.normal(
        size=n_points
    )
    attributes = (
        np.column_stack(
            [
                np.cos((k + 2) * u + v) + 0.1 * generator.normal(size=n_points)
                for k in range(n_attributes)
            ]
        )
        if n_attributes
        else None
    )
    return TriangleMesh.from_points(
        np.column_stack([plan, z]), attributes, [f"a{k}" for k in range(n_attributes)]
    )
