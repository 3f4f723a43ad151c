"""The array engine against the loops, step by step and as a whole: the same bytes."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from time import process_time

import numpy as np
import pytest
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import OptionError, TriangleMesh, analyse, denoise, synthetic
from wavelet_core._kernels import _jit
from wavelet_core._kernels._jit import HAS_NUMBA, Kernel, engine
from wavelet_core.features.shape import surface_shape
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.curvature import bending_energy
from wavelet_core.mesh.quadric import build_quadrics, vertex_costs
from wavelet_core.metrics import surface_errors

#: What the array engine is held against: the loops, compiled where numba is there.
ORACLE = "compiled" if HAS_NUMBA else "loops"
ROOT = Path(__file__).resolve().parents[3]

MESHES = {
    "delaunay": lambda: random_delaunay(220, 1, seed=2, scale=100.0),
    "holes": lambda: grid_with_holes(14, 16, seed=5, hole_share=0.12, scale=100.0),
    "hills": lambda: synthetic.hills(14, 17),
    "plane": lambda: synthetic.plane(9, 11),
}

DESIGNS = {
    "rms": {},
    "size": {"target_vertices": 30},
    "largest error": {"target_vertices": 30, "norm": "max"},
    "largest error, updated": {"target_vertices": 30, "norm": "max", "update": "minimum_norm"},
    "tolerance": {"max_error": 0.5},
    "mean tolerance": {"max_rms": 0.3},
    "moved outline": {"target_vertices": 20, "outline_tolerance": 30.0},
    "GLMN": {"prediction": "GLMN", "levels": 6},
    "GLMN by the collapse": {"prediction": "GLMN", "quadrics": "rebuilt", "cost": "collapse"},
    "CLORMP": {"prediction": "CLORMP", "levels": 6},
    "UGMO xyz": {"prediction": "UGMO", "levels": 5, "signal": "xyz"},
    "random PL": {"partition": "random", "prediction": "PL", "levels": 6},
    "colouring BL": {"partition": "colouring", "prediction": "BL", "levels": 5},
    "surface GL": {"partition": "surface", "prediction": "GL", "levels": 5},
}


def bytes_of(pyramid):
    """Return a digest of everything that an analysis works out."""
    digest = hashlib.sha256()
    for step in pyramid.steps:
        for array in (step.odd, step.target, step.indptr, step.indices, step.weights):
            digest.update(array.tobytes())
        digest.update(step.details.tobytes())
    digest.update(pyramid.coarse.tobytes())
    return digest.hexdigest()


def both(work):
    """Return what a piece of work gives on either engine."""
    outcomes = []
    for name in (ORACLE, "arrays"):
        with engine(name):
            outcomes.append(work())
    return outcomes


@pytest.mark.parametrize("mesh_name", MESHES)
@pytest.mark.parametrize("design", DESIGNS)
def test_pyramids_are_the_same_bytes(mesh_name, design):
    mesh = MESHES[mesh_name]()
    ours, theirs = both(lambda: analyse(mesh, **DESIGNS[design]))
    assert bytes_of(ours) == bytes_of(theirs)


def test_where_two_fans_meet_at_a_target_both_engines_look_at_the_same_one():
    """The loops went on to the other fan once a face of it had gone, and kept a vertex back."""
    mesh = grid_with_holes(20, 24)
    ours, theirs = both(lambda: analyse(mesh, levels=6))
    assert bytes_of(ours) == bytes_of(theirs)


@pytest.mark.parametrize("size", [{}, {"target_vertices": 20}])
@pytest.mark.parametrize("seed", [2, 8, 10, 16, 20, 22, 35, 38])
def test_holes_that_an_outline_tolerance_fills_are_the_same_bytes(seed, size):
    """Two vertices beside a hole made the same edge, which the engines judged differently."""
    mesh = grid_with_holes(14 + seed % 5, 16, seed=seed, hole_share=0.3, scale=100.0)
    ours, theirs = both(lambda: analyse(mesh, outline_tolerance=60.0, **size))
    assert bytes_of(ours) == bytes_of(theirs)


@pytest.mark.parametrize("design", DESIGNS)
def test_heights_of_minus_zero_are_the_same_bytes(design):
    """Whole arrays made 0 of them where the loops left them as they were."""
    x, y = np.arange(16.0), np.arange(14.0)
    heights = np.random.default_rng(3).choice([-1.0, -0.0, -0.0, 0.0, 1.0], (14, 16))
    mesh = TriangleMesh.from_grid(heights, x, y)
    assert (np.signbit(mesh.vertices[:, 2]) & (mesh.vertices[:, 2] == 0)).any()
    ours, theirs = both(lambda: analyse(mesh, **DESIGNS[design]))
    assert bytes_of(ours) == bytes_of(theirs)
    assert ours[-1].vertices.tobytes() == theirs[-1].vertices.tobytes()


@pytest.mark.parametrize(
    "size", [{"max_error": 1e200}, {"max_rms": 1e200}, {"outline_tolerance": 1e200}]
)
def test_a_tolerance_beyond_all_bounds_is_one_that_nothing_breaks(size):
    """Its square is no double, which ended in an OverflowError."""
    mesh = MESHES["hills"]()
    ours, theirs = both(lambda: analyse(mesh, target_vertices=8, **size))
    assert ours.mesh(0).n_vertices <= 8
    assert bytes_of(ours) == bytes_of(theirs)


@pytest.mark.parametrize("design", [{}, {"norm": "max"}, {"prediction": "GLORMP"}])
def test_plain_loops_run_where_numba_is_there_too(design):
    """They ended in a TypingError: what they call is compiled, for a tuple of one type."""
    mesh = synthetic.hills(7, 8)
    with engine("loops"):
        looped = analyse(mesh, levels=4, **design)
    with engine("arrays"):
        assert bytes_of(analyse(mesh, levels=4, **design)) == bytes_of(looped)


@pytest.mark.parametrize("mesh_name", MESHES)
def test_locked_vertices_are_the_same_bytes(mesh_name):
    mesh = MESHES[mesh_name]()
    locked = np.random.default_rng(4).random(mesh.n_vertices) < 0.2
    ours, theirs = both(lambda: analyse(mesh, locked=locked, levels=6))
    assert bytes_of(ours) == bytes_of(theirs)


@pytest.mark.parametrize("mesh_name", MESHES)
def test_steps_are_the_same_bytes(mesh_name):
    mesh = MESHES[mesh_name]()
    faces = mesh.faces.astype(np.int32)
    points = np.column_stack([mesh.vertices - mesh.vertices.mean(axis=0)]) / 100.0

    def steps():
        connectivity = build_connectivity(faces, mesh.n_vertices)
        quadrics = build_quadrics(points, faces, connectivity)
        rings = [connectivity.one_ring(v) for v in range(mesh.n_vertices)]
        shape = surface_shape(mesh)
        return [
            connectivity.star, connectivity.kind, connectivity.ring_size, np.concatenate(rings),
            bending_energy(points, faces, connectivity), quadrics,
            vertex_costs(points, quadrics, connectivity), shape.slope, shape.profile,
        ]  # fmt: skip

    for ours, theirs in zip(*both(steps), strict=True):
        assert ours.dtype == theirs.dtype
        assert ours.tobytes() == theirs.tobytes()


def test_points_are_found_in_the_same_faces():
    mesh = random_delaunay(300, 0, seed=8, scale=100.0)
    coarse = analyse(mesh, target_vertices=40).mesh(0)
    low, high = mesh.vertices[:, :2].min(axis=0), mesh.vertices[:, :2].max(axis=0)
    plan = np.random.default_rng(1).uniform(low - 5, high + 5, (2000, 2))
    points = np.column_stack([np.vstack([plan, mesh.vertices[:, :2]]), np.zeros(2300)])
    ours, theirs = both(lambda: surface_errors(coarse, points))
    assert ours.tobytes() == theirs.tobytes()
    assert np.isnan(ours).any()


def test_denoising_is_the_same_bytes():
    mesh = synthetic.hills(16, 18)
    noise = np.random.default_rng(0).normal(0, 1, mesh.n_vertices)
    noisy = TriangleMesh(mesh.vertices + np.outer(noise, [0, 0, 1]), mesh.faces)
    ours, theirs = both(lambda: denoise(noisy, 1.0))
    assert ours.vertices.tobytes() == theirs.vertices.tobytes()


def test_a_broken_surface_is_told_in_the_same_words():
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], dtype=np.int32)

    def told():
        with pytest.raises(ValueError, match="in a way no surface does") as error:
            build_connectivity(faces, 5)
        return str(error.value)

    ours, theirs = both(told)
    assert ours == theirs


@pytest.mark.parametrize("is_closed", [True, False])
def test_a_vertex_of_many_faces_has_its_ring_at_once(is_closed):
    n = 100_000
    around = np.random.default_rng(0).permutation(n).astype(np.int32) + 1
    faces = np.column_stack([np.zeros(n, np.int32), around, np.roll(around, -1)])
    faces = np.random.default_rng(1).permutation(faces if is_closed else faces[:-1])

    def ring():
        began = process_time()
        connectivity = build_connectivity(faces, n + 1)
        assert process_time() - began < 20  # comparing each with each took minutes
        return connectivity.one_ring(0), connectivity.kind, connectivity.ring_size

    loops, arrays = both(ring)
    for ours, theirs in zip(loops, arrays, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    start = int(np.flatnonzero(around == loops[0][0])[0])
    np.testing.assert_array_equal(loops[0], np.roll(around, -start))


def test_many_faces_at_one_place_are_told_at_once_and_briefly():
    faces = np.zeros((100_000, 3), dtype=np.int32) + np.array([0, 1, 2], dtype=np.int32)

    def told():
        began = process_time()
        with pytest.raises(ValueError, match="and 99,994 more share the edge") as error:
            build_connectivity(faces, 3)
        assert process_time() - began < 20  # a minute, and a line of half a megabyte
        return str(error.value)

    ours, theirs = both(told)
    assert ours == theirs
    assert len(ours) < 300


def test_every_step_but_the_rare_ones_has_a_twin():
    import importlib
    import pkgutil

    from wavelet_core import _kernels

    without = set()
    for module in pkgutil.iter_modules(_kernels.__path__):
        found = vars(importlib.import_module(f"wavelet_core._kernels.{module.name}"))
        without |= {
            name for name, value in found.items() if isinstance(value, Kernel) and not value.arrays
        }
    assert without == {"nnls_weights", "least_squares_weights"}


def test_a_step_without_a_twin_is_refused_above_its_limit(monkeypatch):
    monkeypatch.setattr(_jit, "MAX_LOOPS", 10)
    with (
        engine("arrays"),
        pytest.raises(OptionError, match=r"^the prediction nnls \(NNLS\) over .* without numba"),
    ):
        analyse(synthetic.hills(12, 12), prediction="NNLSMN", levels=1)


def test_an_unknown_engine_is_refused():
    with pytest.raises(OptionError, match="'steam'; give one of"), engine("steam"):
        pass


def test_the_environment_chooses_the_engine():
    code = "from wavelet_core._kernels._jit import current_engine; print(current_engine())"
    for name in ("arrays", "loops"):
        environment = {**os.environ, "TERRAIN_WAVELETS_ENGINE": name, "PYTHONPATH": str(ROOT)}
        said = subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True
        )
        assert said.stdout.strip() == name, said.stderr
