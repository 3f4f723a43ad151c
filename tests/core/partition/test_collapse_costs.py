"""Costs of the surface-guided partition against a slow second opinion."""

from __future__ import annotations

import numpy as np
import pytest
from helpers_meshes import grid_with_holes

from wavelet_core import TriangleMesh, analyse, synthetic
from wavelet_core._kernels.collapse import are_joined
from wavelet_core._kernels.connectivity import BOUNDARY
from wavelet_core._kernels.half_edges import MAX_RING, meets_link_condition, walk_ring
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.location import surface_errors
from wavelet_core.partition._mutable_level import SurfaceLevel


def level_of(mesh, with_update=False):
    heights = np.ascontiguousarray(mesh.vertices[:, 2:])
    locked = np.zeros(mesh.n_vertices, dtype=bool)
    faces = mesh.faces.astype(np.int32)
    return SurfaceLevel(mesh.vertices[:, :2], heights, faces, locked, with_update)


def squared_errors_of(level, mesh):
    """Measure the level by the independent search of ``surface_errors``."""
    position = np.full(mesh.n_vertices, -1)
    position[level.ids] = np.arange(level.n_vertices)
    slots = level._mesh.origin.reshape(-1, 3)[level._faces.lives]
    vertices = np.column_stack([mesh.vertices[level.ids, :2], level.heights])
    coarse = TriangleMesh(vertices, position[level._vertices.ids[slots]])
    errors = surface_errors(coarse, mesh.vertices)
    assert np.isfinite(errors).all()
    return float((errors**2).sum())


def take_level(level, cutoff=np.inf):
    level.rank("rms", np.inf, cutoff)
    odd = level.independent(level.candidates(0.25, cutoff), level.n_vertices, np.inf)
    cost = level.costs(odd)
    level.remove(odd)
    return cost


@pytest.mark.parametrize("mesh", [synthetic.hills(25, 30), synthetic.scattered(400)])
def test_costs_are_the_change_of_the_squared_errors(mesh):
    level = level_of(mesh)
    before = 0.0
    for _ in range(6):
        cost = take_level(level)
        after = squared_errors_of(level, mesh)
        assert after == pytest.approx(before + cost.sum(), rel=1e-9, abs=1e-9)
        assert after == pytest.approx(level.squared_errors(), rel=1e-9, abs=1e-9)
        before = after


@pytest.mark.parametrize("seed", [0, 1])
def test_the_sums_stay_true_under_updates(seed):
    mesh = synthetic.scattered(400, seed=seed)
    level = level_of(mesh, with_update=True)
    for _ in range(8):
        take_level(level)
        assert squared_errors_of(level, mesh) == pytest.approx(level.squared_errors(), rel=1e-9)


def test_a_finite_cutoff_leaves_the_costs_below_it_as_they_are():
    mesh = synthetic.scattered(400)
    whole, part = level_of(mesh), level_of(mesh)
    take_level(whole)
    take_level(part)
    whole.rank("rms", np.inf, np.inf)
    cutoff = float(
        np.median(whole._vertices.cost[whole._vertices.lives & np.isfinite(whole._vertices.cost)])
    )
    part._vertices.cost[
        part._vertices.is_stale
    ] = -np.inf  # so that all are looked at, whatever they cost before
    part.rank("rms", np.inf, cutoff)
    known = part._vertices.lives & ~part._vertices.is_stale & (part._vertices.cost < cutoff)
    assert known.sum() > 50
    np.testing.assert_array_equal(part._vertices.cost[known], whole._vertices.cost[known])
    np.testing.assert_array_equal(part._vertices.target[known], whole._vertices.target[known])
    unknown = part._vertices.lives & part._vertices.is_stale
    assert (whole._vertices.cost[unknown] >= cutoff).all()


def test_a_straight_outline_is_thinned_though_rotation_bends_it_by_rounding():
    grid = synthetic.plane(30, 30)
    angle = np.radians(20.0)
    x, y = grid.vertices[:, 0], grid.vertices[:, 1]
    turned = np.column_stack(
        [
            5e5 + x * np.cos(angle) - y * np.sin(angle),
            5e6 + x * np.sin(angle) + y * np.cos(angle),
            grid.vertices[:, 2],
        ]
    )
    coarse = analyse(TriangleMesh(turned, grid.faces), target_vertices=8).mesh(0)
    assert coarse.n_vertices == 8
    assert (coarse.plan_areas > 0).all()
    assert coarse.plan_areas.sum() == pytest.approx(grid.plan_areas.sum(), rel=1e-9)


def link_tests_of(mesh):
    """Yield what the two link tests say of each edge of a vertex that may go."""
    faces = mesh.faces.astype(np.int32)
    indexed = build_connectivity(faces, mesh.n_vertices)
    origin, twin, outgoing = level_of(mesh)._mesh
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    none_made = np.full(mesh.n_vertices, -1, dtype=np.int32)
    nothing = np.empty(1, np.int32)
    for v in np.flatnonzero(indexed.kind <= BOUNDARY):
        size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
        for j in range(size) if n_sides == size else (0, size - 1):
            a = ring[j]
            if indexed.kind[a] > BOUNDARY:
                continue  # pinched: its half-edges are not one walk
            apart = [
                k
                for k in range(size)
                if 1 < (gap := abs(k - j)) and (gap < size - 1 or n_sides < size)
            ]
            joined = [
                are_joined(
                    a,
                    ring[k],
                    faces,
                    indexed.star_indptr,
                    indexed.star,
                    none_made,
                    nothing,
                    nothing,
                )
                for k in apart
            ]
            met = meets_link_condition(a, ring, 0, size, n_sides, origin, twin, outgoing)
            yield met, not any(joined)


def test_link_conditions():
    """The two link tests, on half-edges and on an indexed mesh, agree about every edge."""
    n_refused = 0
    for seed in range(12):
        mesh = grid_with_holes(9, 10, seed=seed, hole_share=0.2)
        pyramid = analyse(mesh, levels=30)
        for level in pyramid:
            for by_half_edges, by_faces in link_tests_of(level):
                assert by_half_edges == by_faces
                n_refused += not by_faces
    assert n_refused > 0
