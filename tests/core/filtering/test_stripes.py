"""Offsets of lines: found where they are, nowhere else, and no terrain taken for them."""

import numpy as np
import pytest
from scipy import ndimage

from wavelet_core import Cancelled, OptionError, TriangleMesh, denoise
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.filtering.noise.model import noise_of
from wavelet_core.filtering.noise.stripes import LEAST_OF_LINE

N = 100
X, Y = np.meshgrid(np.arange(float(N)), np.arange(float(N)))
PLANE = 0.3 * X - 0.2 * Y
HILLS = 6 * np.sin(X / 14) * np.cos(Y / 17) + 2.0 * (X + 0.3 * Y > 70)
ROWS, COLUMNS = Y.ravel().astype(int), X.ravel().astype(int)
SIGMA, STRIPES = 0.1, 0.3


def mesh_of(elevation):
    rows, columns = elevation.shape
    return TriangleMesh.from_grid(elevation, x=np.arange(float(columns)), y=np.arange(float(rows)))


def rmse(mesh, truth):
    return float(np.sqrt(np.mean((mesh.vertices[:, 2] - truth.ravel()) ** 2)))


def white(seed=0):
    return np.random.default_rng(seed).normal(0, SIGMA, (N, N))


def offsets(seed=1, n=N):
    return np.random.default_rng(seed).normal(0, STRIPES, n)


def found_in(mesh, lines):
    return noise_of(mesh, mesh.vertices[:, 2], lines=lines)[0].stripes


@pytest.mark.parametrize("terrain", [PLANE, HILLS])
@pytest.mark.parametrize("lines", [ROWS, COLUMNS])
def test_known_offsets_are_found_back_within_their_errors(terrain, lines):
    truth = offsets()
    mesh = mesh_of(terrain + white() + truth[lines].reshape(N, N))
    stripes = found_in(mesh, lines)
    assert stripes.deviation == pytest.approx(truth.std(), rel=0.3)
    error = stripes.offsets - (truth - truth.mean())
    # What changes slowly from line to line is the terrain's. The rest has errors of SIGMA / 10.
    fine = np.diff(error, 2)
    assert np.abs(fine).max() < 5 * np.sqrt(6 / N) * SIGMA
    assert error.std() < 0.35 * truth.std()


def test_denoising_is_then_as_if_there_had_been_hardly_any_stripes():
    mesh = mesh_of(HILLS + white() + offsets()[:, None])
    found = {}
    clean = denoise(mesh, n_pyramids=2, lines=ROWS, found=found)
    assert rmse(clean, HILLS) < 0.4 * rmse(denoise(mesh, n_pyramids=2), HILLS)
    assert found["z"].sigma == pytest.approx(SIGMA, rel=0.15)
    assert "taken out of 100 lines" in found["z"].describe()
    blurred = (
        ndimage.gaussian_filter(mesh.vertices[:, 2].reshape(N, N), w) for w in (1, 1.5, 2, 3)
    )
    assert rmse(clean, HILLS) < 0.7 * min(np.sqrt(np.mean((b - HILLS) ** 2)) for b in blurred)


@pytest.mark.parametrize("sigma", [SIGMA, None])
@pytest.mark.parametrize("terrain", [PLANE, HILLS])
@pytest.mark.parametrize("lines", [ROWS, COLUMNS, ROWS // 50])
def test_no_stripes_are_made_up(terrain, lines, sigma):
    mesh = mesh_of(terrain + white())
    found = {}
    clean = denoise(mesh, sigma, n_pyramids=1, lines=lines, found=found)
    assert found["z"].stripes.deviation == 0.0
    assert "no offsets found" in found["z"].describe()
    np.testing.assert_array_equal(clean.vertices, denoise(mesh, sigma, n_pyramids=1).vertices)


@pytest.mark.parametrize("length", [N, N // 2])
def test_a_ridge_along_a_row_stays(length):
    """All along a line a dyke is as an offset of it; but the other lines have none."""
    dyke = np.where((np.abs(Y - 50) < 2) & (X < length), 2.0, 0.0)
    mesh = mesh_of(HILLS + dyke + white())
    kept = denoise(mesh, n_pyramids=1, lines=ROWS)
    np.testing.assert_array_equal(kept.vertices, denoise(mesh, n_pyramids=1).vertices)
    striped = mesh_of(HILLS + dyke + white() + offsets()[:, None])
    clean = denoise(striped, n_pyramids=1, lines=ROWS).vertices[:, 2].reshape(N, N)
    height = (clean - HILLS)[49:52, : length - 5].mean() - (clean - HILLS)[44:57:12].mean()
    assert height == pytest.approx(2.0, abs=0.5)
    assert rmse(mesh_of(clean), HILLS + dyke) < 0.5 * STRIPES


def test_lines_of_a_tin_with_holes_and_without_a_grid():
    rng = np.random.default_rng(3)
    plan = rng.uniform(0, 80, (6_000, 2))
    plan = plan[np.hypot(plan[:, 0] - 40, plan[:, 1] - 30) > 9]
    truth = 4 * np.sin(plan[:, 0] / 12) + 0.1 * plan[:, 1]
    # Two flights whose strips overlap in the middle, and one of half of the points there across.
    flight = np.where(plan[:, 1] + rng.normal(0, 12, len(plan)) > 40, 1, 0)
    flight[(np.abs(plan[:, 0] - 60) < 10) & (rng.random(len(plan)) < 0.5)] = 7
    off = np.where(flight == 0, 0.0, np.where(flight == 1, 0.5, -0.4))
    noisy = truth + off + rng.normal(0, 0.1, len(plan))
    mesh = TriangleMesh.from_points(np.column_stack([plan, noisy]))
    stripes = found_in(mesh, flight)
    assert stripes.lines.tolist() == [0, 1, 7]
    steps = np.diff(stripes.offsets)
    np.testing.assert_allclose(steps, [0.5, -0.9], atol=0.03)
    clean = denoise(mesh, n_pyramids=2, lines=flight)
    shift = (np.bincount(flight, minlength=8)[[0, 1, 7]] * [0.0, 0.5, -0.4]).sum() / len(plan)
    assert rmse(clean, truth + shift) < 0.08


def test_a_grid_with_holes():
    values = HILLS + white() + offsets()[:, None]
    values[(X - 60) ** 2 + (Y - 40) ** 2 < 300] = np.nan
    values[Y == 77] = np.nan
    mesh, has = mesh_of(values), np.isfinite(values).ravel()
    stripes = found_in(mesh, ROWS[has])
    assert 77 not in stripes.lines
    truth = offsets()[stripes.lines]
    assert np.std(stripes.offsets - truth) < 0.4 * truth.std()


def test_vertices_of_no_line_and_locked_ones_are_left():
    lines = np.where((X > 60) | (Y < 20), -1, ROWS.reshape(N, N)).ravel()
    truth = np.where(lines < 0, 0.0, offsets()[np.maximum(lines, 0)]).reshape(N, N)
    mesh = mesh_of(HILLS + truth + white())
    found = {}
    locked = (X == 30) & (Y > 40)
    clean = denoise(mesh, n_pyramids=1, lines=lines, locked=locked.ravel(), found=found).vertices[
        :, 2
    ]
    stripes = found["z"].stripes
    np.testing.assert_array_equal(stripes.lines, np.arange(20, N))
    assert not stripes.of_vertices(lines)[lines < 0].any()
    assert np.std(stripes.offsets - offsets()[20:]) < 0.4 * STRIPES
    np.testing.assert_array_equal(clean[locked.ravel()], mesh.vertices[locked.ravel(), 2])


def test_lines_of_few_vertices_have_no_offset():
    lines = np.where(ROWS < 2, 0, ROWS)
    lines[: LEAST_OF_LINE - 1] = 500
    stripes = found_in(mesh_of(HILLS + white() + offsets()[:, None]), lines)
    assert 500 not in stripes.lines
    assert stripes.of_vertices(lines)[0] == 0.0
    assert stripes.deviation > 0
    each_its_own = found_in(mesh_of(HILLS + white()), np.arange(N * N))
    assert len(each_its_own.lines) == 0
    assert each_its_own.deviation == 0.0


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (ROWS[1:], "has the shape (9999,)"),
        (ROWS.reshape(N, N), "has the shape (100, 100)"),
        (ROWS + 0.5, "whole numbers"),
        (np.where(ROWS == 3, np.nan, ROWS), "whole numbers"),
        (ROWS - 2, "whole numbers"),
        (ROWS.astype(str), "whole numbers"),
        (np.zeros_like(ROWS), "has 1 line;"),
        (np.full_like(ROWS, -1), "has 0 lines;"),
    ],
)
def test_labels_that_are_none_are_refused_in_one_line(lines, words):
    with pytest.raises(OptionError) as caught:
        denoise(mesh_of(PLANE), 0.1, n_pyramids=1, lines=lines)
    assert words in str(caught.value)
    assert str(caught.value).startswith("lines has")
    assert "\n" not in str(caught.value)


def test_the_bytes_are_those_of_the_other_engine_and_of_a_second_time():
    mesh = mesh_of(HILLS[:50, :50] + white()[:50, :50] + offsets(n=50)[:, None])
    lines = ROWS.reshape(N, N)[:50, :50].ravel()
    results = []
    for name in ("arrays", "arrays", "compiled" if HAS_NUMBA else "loops"):
        with engine(name):
            results.append(denoise(mesh, n_pyramids=1, lines=lines).vertices.tobytes())
    assert len(set(results)) == 1


def test_every_step_may_cancel():
    seen = []
    mesh = mesh_of(HILLS + white() + offsets()[:, None])
    denoise(mesh, n_pyramids=1, lines=ROWS, progress=lambda f: seen.append(f))
    assert seen == sorted(seen)
    assert np.diff(seen).max() < 0.1
    calls = []

    def answer(fraction):
        calls.append(fraction)
        return len(calls) < 60

    with pytest.raises(Cancelled):
        denoise(mesh, n_pyramids=1, lines=ROWS, progress=answer)
    assert len(calls) == 60


def test_attributes_have_offsets_of_their_own_and_a_flat_mesh_none():
    flat = TriangleMesh.from_grid(np.zeros((30, 30)), x=np.arange(30.0), y=np.arange(30.0))
    rows = np.repeat(np.arange(30), 30)
    rng = np.random.default_rng(0)
    intensity = 100 + rng.normal(0, 1, 900) + rng.normal(0, 5, 30)[rows]
    mesh = TriangleMesh(flat.vertices, flat.faces, intensity[:, None], ("intensity",))
    found = {}
    clean = denoise(mesh, n_pyramids=1, channels=("z", "intensity"), lines=rows, found=found)
    assert found["z"].stripes.deviation == 0.0
    assert found["intensity"].stripes.deviation == pytest.approx(5, rel=0.4)
    np.testing.assert_array_equal(clean.vertices, mesh.vertices)
    assert np.std(clean.attributes) < 0.5 * np.std(intensity)
