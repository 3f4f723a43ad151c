"""The average of many pyramids against noise of known size."""

import sys

import numpy as np
import pytest
from scipy import ndimage

from wavelet_core import Cancelled, OptionError, TriangleMesh, denoise
from wavelet_core.filtering import _weighted_sum
from wavelet_core.filtering._bounded import ROWS_AT_ONCE, moments_of, ticks_of_moments
from wavelet_core.filtering.denoise import TO_FIND_NOISE
from wavelet_core.filtering.noise import outliers


def terrain(n=90):
    """Return a grid with hills, a terrace and a straight bank."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    hills = 4 * np.sin(5 * x) * np.cos(4 * y) + np.exp(-60 * ((x - 0.3) ** 2 + (y - 0.6) ** 2))
    return hills + 2.0 * (x + 0.3 * y > 0.8)


def mesh_of(elevation, **options):
    x = np.arange(float(elevation.shape[1]))
    return TriangleMesh.from_grid(elevation, x=x, y=np.arange(float(len(elevation))), **options)


def rmse(mesh, truth):
    return float(np.sqrt(np.mean((mesh.vertices[:, 2] - truth.ravel()) ** 2)))


@pytest.mark.large
def test_denoising_beats_gaussian_and_median_at_their_best():
    truth = terrain()
    noisy = truth + np.random.default_rng(0).normal(0, 0.4, truth.shape)
    ours = rmse(denoise(mesh_of(noisy), 0.4, n_pyramids=12), truth)
    gaussian = min(
        np.sqrt(np.mean((ndimage.gaussian_filter(noisy, s, mode="nearest") - truth) ** 2))
        for s in np.linspace(0.5, 4, 15)
    )
    median = min(
        np.sqrt(np.mean((ndimage.median_filter(noisy, s, mode="nearest") - truth) ** 2))
        for s in (3, 5, 7, 9)
    )
    assert ours < 0.9 * gaussian
    assert ours < median


@pytest.mark.large
def test_noise_is_estimated_when_it_is_not_given():
    truth = terrain(50)
    noisy = mesh_of(truth + np.random.default_rng(0).normal(0, 0.4, truth.shape))
    given, estimated = (rmse(denoise(noisy, s, n_pyramids=3), truth) for s in (0.4, None))
    assert estimated == pytest.approx(given, rel=0.1)
    assert given < 0.2


def test_no_noise_gives_back_the_input():
    mesh = mesh_of(terrain(20))
    np.testing.assert_array_equal(denoise(mesh, 0.0, n_pyramids=2).vertices, mesh.vertices)
    still = denoise(mesh, 1e-9, n_pyramids=2)
    np.testing.assert_allclose(still.vertices, mesh.vertices, atol=1e-6)


def test_the_same_seed_gives_the_same_bytes_and_inputs_stay():
    mesh = mesh_of(terrain(25))
    before = mesh.vertices.copy()
    one, same = (denoise(mesh, 0.3, n_pyramids=2, seed=7) for _ in range(2))
    assert one.vertices.tobytes() == same.vertices.tobytes()
    np.testing.assert_array_equal(mesh.vertices, before)
    assert not np.array_equal(denoise(mesh, 0.3, n_pyramids=2).vertices, one.vertices)


def test_only_the_chosen_channels_change_and_x_and_y_never():
    truth = terrain(30)
    rng = np.random.default_rng(1)
    noisy = truth + rng.normal(0, 0.4, truth.shape)
    mesh = mesh_of(noisy, attributes=noisy[..., None] * 10, attribute_names=["tenfold"])
    result = denoise(mesh, 4.0, n_pyramids=2, channels=["tenfold"])
    np.testing.assert_array_equal(result.vertices, mesh.vertices)
    assert np.std(result.attributes[:, 0] - 10 * truth.ravel()) < 2.6
    both = denoise(mesh, n_pyramids=2, channels=["z", "tenfold"])
    np.testing.assert_allclose(both.attributes[:, 0], 10 * both.vertices[:, 2], rtol=1e-6)


def test_scale_and_offset_only_scale_and_shift_the_result():
    truth = terrain(25) + np.random.default_rng(2).normal(0, 0.3, (25, 25))
    plain = denoise(mesh_of(truth), 0.3, n_pyramids=2).vertices[:, 2]
    far = denoise(mesh_of(1000 * truth + 5e6), 300.0, n_pyramids=2).vertices[:, 2]
    np.testing.assert_allclose((far - 5e6) / 1000, plain, atol=1e-6)


def test_locked_vertices_keep_their_values():
    truth = terrain(25) + np.random.default_rng(2).normal(0, 0.3, (25, 25))
    locked = np.zeros(625, dtype=bool)
    locked[::5] = True
    mesh = mesh_of(truth)
    result = denoise(mesh, 0.3, n_pyramids=2, locked=locked)
    np.testing.assert_array_equal(result.vertices[locked], mesh.vertices[locked])
    assert np.abs(result.vertices - mesh.vertices)[~locked].max() > 0.1


@pytest.mark.large
def test_meshes_too_large_to_keep_give_the_same_result(monkeypatch):
    truth = terrain(40) + np.random.default_rng(2).normal(0, 0.3, (40, 40))
    whole = denoise(mesh_of(truth), 0.3, n_pyramids=3).vertices[:, 2]
    monkeypatch.setattr(_weighted_sum, "MAX_FITTED", 1500)
    parts = denoise(mesh_of(truth), 0.3, n_pyramids=3).vertices[:, 2]
    assert not np.array_equal(parts, whole)
    assert np.std(parts - whole) < 0.05


@pytest.mark.parametrize("n", [2, 3, 5])
def test_tiny_meshes_pass(n):
    result = denoise(mesh_of(terrain(n)), 0.1, n_pyramids=2)
    assert np.isfinite(result.vertices).all()


def test_cancelling_stops_it():
    with pytest.raises(Cancelled):
        denoise(mesh_of(terrain(20)), 0.1, progress=lambda fraction: fraction < 0.5)
    seen = []
    denoise(mesh_of(terrain(20)), 0.1, n_pyramids=3, progress=lambda f: seen.append(f))
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_finding_the_noise_has_its_part_of_the_progress():
    """It stood still at 3 % for four of five looks, a fifth of the time on a large mesh."""
    seen = []
    denoise(mesh_of(terrain(90)), n_pyramids=1, progress=seen.append)
    before = [fraction for fraction in seen if fraction < TO_FIND_NOISE]
    standing = np.diff(before) == 0.0
    assert len(before) > 60
    assert standing.mean() < 0.2
    assert before[-1] > 0.8 * TO_FIND_NOISE


def test_finding_the_noise_fills_its_part_on_large_meshes_too(monkeypatch):
    """Five rounds of looking for outliers were counted, and one to three made."""
    module = sys.modules[denoise.__module__]
    for one in (module, outliers):
        monkeypatch.setattr(one, "ROWS_OF_RANKS", 100)
    seen = []
    denoise(mesh_of(terrain(90)), n_pyramids=1, progress=seen.append)
    assert max(share for share in seen if share < TO_FIND_NOISE) > 0.7 * TO_FIND_NOISE


def test_few_looks_are_at_sums_of_products():
    """They were three quarters of the looks in the last part, and a twentieth of its time."""
    ticks = []
    moments_of(np.ones((100 * ROWS_AT_ONCE + 1, 1)), lambda: ticks.append(1))
    assert len(ticks) == ticks_of_moments(100 * ROWS_AT_ONCE + 1) == 6


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"sigma": -1.0}, "sigma is -1"),
        ({"n_pyramids": 0}, "n_pyramids is 0"),
        ({"levels": 0}, "levels is 0"),
        ({"channels": ["w"]}, "no channel 'w'"),
    ],
)
def test_what_does_not_fit_is_refused(options, words):
    with pytest.raises(OptionError, match=words):
        denoise(mesh_of(terrain(10)), **options)


def test_a_sigma_far_too_large_smooths_and_never_turns_details_over():
    truth = terrain(40)
    noisy = mesh_of(truth + np.random.default_rng(0).normal(0, 0.1, truth.shape))
    smooth = denoise(noisy, 2.0, n_pyramids=2).vertices[:, 2]
    assert smooth.min() > truth.min() - 0.5
    assert smooth.max() < truth.max() + 0.5
    assert np.std(smooth - truth.ravel()) < 0.6 * np.std(truth)


@pytest.mark.large
def test_a_step_of_lidar_points_moves_by_no_more_than_noise():
    # Without bounds on its weights the solver once moved points beside such a wall by 59 m.
    rng = np.random.default_rng(3)
    points = rng.uniform(0, 100, (6000, 2))
    truth = 0.05 * points[:, 0] + 8.0 * (points[:, 0] > 50)
    z = truth + rng.normal(0, 0.05, len(points))
    mesh = TriangleMesh.from_points(np.column_stack([points, z]))
    clean = denoise(mesh, 0.05, n_pyramids=8).vertices[:, 2]
    assert np.abs(clean - z).max() < 6 * 0.05
    assert np.std(clean - truth) < 0.5 * 0.05
    beside = np.abs(points[:, 0] - 50) < 2
    assert np.abs(clean - truth)[beside].max() < 6 * 0.05


SURFACES = {
    "plane": lambda x, y: 3 * x + y,
    "constant": lambda x, y: np.zeros_like(x),
    "clean hills": lambda x, y: 4 * np.sin(5 * x) * np.cos(4 * y),
    "clean bank": lambda x, y: 2.0 * (x > 0.5),
    "one spike": lambda x, y: 1.0 * ((x == x[0, 11]) & (y == y[13, 0])),
    "noisy plane": lambda x, y: 3 * x + np.random.default_rng(0).normal(0, 0.1, x.shape),
    "steep, far": lambda x, y: 1e6 + 5e3 * x,
}


@pytest.mark.parametrize("n", [24, 60], ids=["without directions", "with directions"])
@pytest.mark.parametrize("surface", SURFACES)
def test_any_sigma_over_any_surface_gives_a_surface_within_it(surface, n):
    # Cholesky met matrices that were "not positive definite" wherever no detail stood out of the
    # noise: clean hills, a plane, a sigma well above the noise.
    elevation = SURFACES[surface](*np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n)))
    spread = max(np.ptp(elevation), 1.0)
    mesh = mesh_of(elevation)
    for sigma in (0.0, 1e-300, 1e-12, 1e-3, 0.1, 1.0, 100.0, 1e8):
        z = denoise(mesh, sigma, n_pyramids=1).vertices[:, 2]
        assert np.isfinite(z).all()
        assert z.min() > elevation.min() - 0.3 * spread
        assert z.max() < elevation.max() + 0.3 * spread
        if sigma < 1e-11:
            np.testing.assert_allclose(z, elevation.ravel(), atol=1e-6 * spread)
        if surface in ("plane", "constant", "steep, far"):
            np.testing.assert_allclose(z, elevation.ravel(), atol=1e-5 * spread)


def test_a_sigma_above_the_noise_smooths():
    truth = SURFACES["clean hills"](*np.meshgrid(np.linspace(0, 1, 60), np.linspace(0, 1, 60)))
    mesh = mesh_of(truth + np.random.default_rng(0).normal(0, 0.1, truth.shape))
    left = [
        np.std(np.diff(denoise(mesh, s, n_pyramids=2).vertices[:, 2].reshape(60, 60), 2, axis=0))
        for s in (0.0, 0.1, 1.0, 10.0, 1e7)
    ]
    assert left[0] > 3 * left[1] > 3 * left[2]
    assert left[4] < 0.25 * left[0]


@pytest.mark.parametrize("n_vertices", [0, 3])
def test_a_mesh_without_faces_has_no_noise(n_vertices):
    """The mean of no vertices was taken, with two warnings."""
    vertices = np.arange(3.0 * n_vertices).reshape(-1, 3)
    clean = denoise(TriangleMesh(vertices, np.empty((0, 3), int)))
    assert np.array_equal(clean.vertices, vertices)
