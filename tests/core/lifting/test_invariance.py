"""Results depend on the terrain alone: not on ids, threads, numba, or what was run before."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import helpers
import numpy as np
import pytest
from helpers_meshes import grid_with_holes, random_delaunay
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from wavelet_core import TriangleMesh, analyse

ROOT = Path(__file__).resolve().parents[3]


def digest(pyramid):
    """Return a digest of every byte that a pyramid is made of."""
    parts = [pyramid.faces, pyramid.coarse]
    if pyramid.horizontal is not None:
        parts.append(pyramid.horizontal)
    for step in pyramid.steps:
        parts += [step.odd, step.target, step.indptr, step.indices, step.weights, step.details]
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()


def designs(n_points):
    """Yield the digest of a pyramid for every filter pair and partition, on both signals."""
    mesh = random_delaunay(n_points, n_attributes=2, seed=1, offset=1e3)
    for signal in ("z", "xyz"):
        for prediction, update in helpers.PAIRS:
            options = {"prediction": prediction, "update": update, "signal": signal}
            yield digest(analyse(mesh, levels=4, partition="quadric", **options))
        for partition in helpers.PARTITIONS:
            yield digest(analyse(mesh, levels=4, partition=partition, signal=signal))


def has_equal_targets(mesh):
    """Whether some vertex lies in all planes of two neighbours, so that its index decides."""
    stars = [set() for _ in range(mesh.n_vertices)]
    for k, face in enumerate(mesh.faces.tolist()):
        for v in face:
            stars[v].add(k)
    n_equal = np.zeros(mesh.n_vertices, dtype=int)
    for a, b in np.unique(np.sort(helpers.edges_of(mesh.faces), axis=1), axis=0).tolist():
        n_equal[a] += stars[b] <= stars[a]
        n_equal[b] += stars[a] <= stars[b]
    return bool((n_equal > 1).any())


@settings(max_examples=40)
@given(
    n=st.integers(30, 80),
    seed=st.integers(0, 2**32 - 1),
    signal=st.sampled_from(["z", "xyz"]),
    # One-ring means follow the order of removal; the damping alone decides some least-squares
    # weights, and the index which of two covering faces is taken.
    pair=st.sampled_from(
        [
            (prediction, update)
            for prediction, update in helpers.PAIRS
            if prediction not in ("least_squares", "barycentric") and update != "one_ring_mean"
        ]
    ),
)
def test_relabelling_vertices_and_faces_changes_nothing_else(n, seed, signal, pair):
    mesh = random_delaunay(n, n_attributes=2, seed=seed)
    rng = np.random.default_rng(seed)
    old_of_new = rng.permutation(n)
    new_of_old = np.argsort(old_of_new)
    faces = new_of_old[mesh.faces][rng.permutation(mesh.n_faces)]
    faces = np.array([np.roll(face, rng.integers(3)) for face in faces])
    other = TriangleMesh(
        mesh.vertices[old_of_new], faces, mesh.attributes[old_of_new], mesh.attribute_names
    )
    options = {"prediction": pair[0], "update": pair[1], "signal": signal}
    ours = analyse(mesh, levels=3, partition="quadric", **options)
    assume(not any(has_equal_targets(level_mesh) for level_mesh in list(ours)[1:]))
    theirs = analyse(other, levels=3, partition="quadric", **options)
    assert ours.n_levels == theirs.n_levels
    for level in range(ours.n_levels + 1):
        a, b = ours.mesh(level), theirs.mesh(level)
        a_ids, b_ids = ours.vertex_ids(level), old_of_new[theirs.vertex_ids(level)]
        order = np.argsort(b_ids)
        np.testing.assert_array_equal(a_ids, b_ids[order])
        names = ("x", "y", "z", *mesh.attribute_names)
        np.testing.assert_allclose(
            helpers.columns_of(a, names), helpers.columns_of(b, names)[order], atol=1e-9
        )
        np.testing.assert_array_equal(
            helpers.canonical_faces(a_ids[a.faces]), helpers.canonical_faces(b_ids[b.faces])
        )


@pytest.mark.large
@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize("prediction", helpers.ALL_PREDICTIONS)
def test_same_bytes_for_any_number_of_threads(prediction, signal, monkeypatch):
    """Above a few thousand vertices the kernels run in threads."""
    mesh = grid_with_holes(120, 130, n_attributes=1, seed=3)
    digests = set()
    for threads in ("1", "2", "5"):
        monkeypatch.setenv("TERRAIN_WAVELETS_THREADS", threads)
        pyramid = analyse(mesh, levels=4, partition="quadric", prediction=prediction, signal=signal)
        digests.add(digest(pyramid))
    assert len(digests) == 1


def test_same_bytes_again():
    mesh = random_delaunay(100, n_attributes=1, seed=2)
    first, second = (digest(analyse(mesh, levels=5, prediction="NNLSMN")) for _ in range(2))
    assert first == second


@pytest.mark.large
def test_same_bytes_without_numba():
    """The kernels are one text, compiled or not; the other way round is run in a new process."""
    code = (
        "import sys; sys.path[:0] = ['tests', 'tests/core', 'tests/core/lifting']\n"
        "import test_invariance; print(*test_invariance.designs(60), sep='\\n')"
    )
    outputs = []
    for wish in ("", "1"):
        environment = {**os.environ, "TERRAIN_WAVELETS_NO_NUMBA": wish}
        run = subprocess.run(
            [sys.executable, "-W", "ignore:numba is not installed", "-c", code],
            cwd=ROOT,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert run.returncode == 0, run.stderr
        outputs.append(run.stdout.split())
    assert len(outputs[0]) > 50
    differing = [k for k, pair in enumerate(zip(*outputs, strict=True)) if pair[0] != pair[1]]
    assert differing == []


@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_the_input_is_not_changed_and_the_output_is_owned(signal):
    mesh = random_delaunay(60, n_attributes=1, seed=2)
    locked = np.zeros(60, dtype=bool)
    before = [a.tobytes() for a in (mesh.vertices, mesh.faces, mesh.attributes, locked)]
    pyramid = analyse(mesh, levels=3, partition="quadric", signal=signal, locked=locked)
    pyramid.synthesise()
    after = [a.tobytes() for a in (mesh.vertices, mesh.faces, mesh.attributes, locked)]
    assert before == after
    locked[:] = True
    assert pyramid.locked is None or not pyramid.locked.any()


def test_arrays_cannot_be_written_to():
    mesh = random_delaunay(60, n_attributes=1, seed=2)
    pyramid = analyse(mesh, levels=2, partition="quadric")
    detail = pyramid.detail(1)
    for array in (
        mesh.vertices,
        mesh.faces,
        mesh.attributes,
        pyramid.mesh(0).vertices,
        pyramid.mesh(0).attributes,
        detail.vectors,
        detail.positions,
        pyramid.coarse,
        pyramid.steps[0].details,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
