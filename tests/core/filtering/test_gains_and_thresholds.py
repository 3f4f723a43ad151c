"""Gains, bands, thresholds, and how noise reaches the coefficients."""

import numpy as np
import pytest
from helpers import columns_of
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import OptionError, TriangleMesh, analyse, synthetic
from wavelet_core.filtering.gains import band_gains, relifted
from wavelet_core.filtering.noise.white import estimate_noise, noise_gains
from wavelet_core.lifting.linear_map import Transform
from wavelet_core.lifting.spacings import level_spacings

PARTITIONS = ("quadric", "colouring", "random")


@pytest.fixture(scope="module")
def pyramid():
    return analyse(random_delaunay(400, 2, seed=3), levels=6, prediction="geometric")


@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize("update", ["minimum_norm", "martinez_ortega", "one_ring_mean", "none"])
def test_unit_gains_are_the_identity_to_the_bit(signal, update):
    pyramid = analyse(random_delaunay(200, 1, seed=1), levels=4, signal=signal, update=update)
    same = pyramid.with_gains(dict.fromkeys(range(pyramid.n_levels), 1.0))
    assert same.coarse.tobytes() == pyramid.coarse.tobytes()
    for ours, theirs in zip(same.steps, pyramid.steps, strict=True):
        assert ours.details.tobytes() == theirs.details.tobytes()
    assert same.synthesise().vertices.tobytes() == pyramid.synthesise().vertices.tobytes()


def test_gains_compose(pyramid):
    first = {0: 2.0, 2: [0.5, 1.0, 3.0], 5: 0.0}
    second = {2: 0.25, 4: 1.5}
    both = {0: 2.0, 2: [0.125, 0.25, 0.75], 4: 1.5, 5: 0.0}
    twice = pyramid.with_gains(first).with_gains(second)
    for ours, theirs in zip(twice.steps, pyramid.with_gains(both).steps, strict=True):
        np.testing.assert_array_equal(ours.details, theirs.details)


@pytest.mark.parametrize("update", ["minimum_norm", "martinez_ortega", "none"])
@pytest.mark.parametrize("level", [0, 2, 4])
def test_zero_gains_above_a_level_interpolate_its_tin_up(update, level):
    pyramid = analyse(random_delaunay(300, 1, seed=5), levels=5, update=update)
    gains = dict.fromkeys(range(level, pyramid.n_levels), 0.0)
    expected = columns_of(pyramid.mesh(level), pyramid.channels)
    for k in range(level, pyramid.n_levels):
        prediction, _, odd, even = pyramid.filters(k)
        fine = np.empty((len(odd) + len(even), expected.shape[1]))
        fine[even], fine[odd] = expected, prediction @ expected
        expected = fine
    smooth = columns_of(pyramid.with_gains(gains).synthesise(), pyramid.channels)
    np.testing.assert_allclose(smooth, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_a_gain_for_one_channel_leaves_the_others(pyramid):
    louder = pyramid.with_gains({k: [3.0, 1.0, 1.0] for k in range(pyramid.n_levels)})
    before, after = pyramid.synthesise(), louder.synthesise()
    np.testing.assert_array_equal(after.attributes, before.attributes)
    assert np.abs(after.vertices[:, 2] - before.vertices[:, 2]).max() > 0.01


def test_bands_add_up_to_the_whole(pyramid):
    bands = [
        pyramid.with_gains(band_gains(pyramid, levels=(k, k)), coarse=0.0)
        for k in range(pyramid.n_levels)
    ]
    coarse = pyramid.with_gains(dict.fromkeys(range(pyramid.n_levels), 0.0))
    total = sum(columns_of(p.synthesise(), pyramid.channels) for p in [*bands, coarse])
    whole = columns_of(pyramid.synthesise(), pyramid.channels)
    np.testing.assert_allclose(total, whole, rtol=0, atol=1e-11 * np.abs(whole).max())


def test_a_band_in_ground_units_keeps_the_levels_of_that_size():
    pyramid = analyse(synthetic.hills(40, 40, cell=10.0), levels=10, partition="random")
    lengths = level_spacings(pyramid)
    kept = band_gains(pyramid, lengths=(lengths[6], lengths[4]))
    assert [level for level, gain in kept.items() if gain] == [3, 4, 5]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda p: p.with_gains({6: 1.0}), "no details at level 6"),
        (lambda p: p.with_gains({-1: 1.0}), "no details at level -1"),
        (lambda p: p.with_gains({0: [1.0, 2.0]}), "3 channels"),
        (lambda p: p.with_gains({0: np.nan}), "gain of level 0"),
        (lambda p: band_gains(p), "give one"),
        (lambda p: band_gains(p, levels=(0, 1), lengths=(1, 2)), "give one"),
        (lambda p: band_gains(p, levels=(3, 1)), "smaller bound first"),
        (lambda p: band_gains(p, lengths=(1e6, 2e6)), "no level has a spacing of"),
        (lambda p: p.denoised(-1.0), "sigma is -1"),
        (lambda p: p.denoised(1.0, method="median"), "method is 'median'"),
        (lambda p: p.denoised(1.0, strength=-1), "strength is -1"),
        (lambda p: p.denoised(1.0, by_level=True), "exclude each other"),
        (lambda p: p.denoised(1.0, channels=["w"]), "no channel 'w'"),
    ],
)
def test_what_does_not_fit_is_refused(pyramid, call, words):
    with pytest.raises(OptionError, match=words):
        call(pyramid)


# -- the transform by itself ---------------------------------------------------------------------


@pytest.mark.parametrize("update", ["minimum_norm", "martinez_ortega", "one_ring_mean", "none"])
def test_the_transform_gives_the_pyramids_own_coefficients(update):
    mesh = random_delaunay(300, 1, seed=2)
    locked = np.zeros(300, dtype=bool)
    locked[::7] = True
    pyramid = analyse(mesh, levels=5, update=update, locked=locked)
    transform = Transform.from_pyramid(pyramid)
    columns = columns_of(mesh, pyramid.channels)
    coarse, details = transform.analyse(columns)
    np.testing.assert_allclose(coarse, pyramid.coarse, rtol=1e-12, atol=1e-12)
    for ours, step in zip(details, pyramid.steps, strict=True):
        np.testing.assert_allclose(ours, step.details, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(transform.synthesise(coarse, details), columns, atol=1e-12)


def test_the_parts_that_bands_add_sum_to_the_whole():
    mesh = random_delaunay(300, seed=4)
    transform = Transform.from_pyramid(analyse(mesh, levels=5))
    z = mesh.vertices[:, 2:]
    coarse, details = transform.analyse(z)
    bands = sum(transform.synthesise_bands({k: d}) for k, d in enumerate(details))
    still = transform.synthesise(coarse, [0 * d for d in details])
    np.testing.assert_allclose(bands + still, z, atol=1e-12)
    together = transform.synthesise_bands(dict(enumerate(details)))
    np.testing.assert_allclose(together, bands, atol=1e-12)


@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_relifting_another_surface_is_linear_and_reversible(signal):
    mesh = random_delaunay(300, 1, seed=4)
    pyramid = analyse(mesh, levels=5, signal=signal, update="one_ring_mean")
    other = TriangleMesh(mesh.vertices * [1, 1, 3], mesh.faces, -mesh.attributes, ["class"])
    lifted = relifted(pyramid, other)
    np.testing.assert_allclose(lifted.synthesise().vertices, other.vertices, atol=1e-12)
    np.testing.assert_allclose(lifted.synthesise().attributes, other.attributes, atol=1e-12)
    z = pyramid.channels.index("z")
    np.testing.assert_allclose(
        lifted.steps[0].details[:, z], 3 * pyramid.steps[0].details[:, z], atol=1e-12
    )
    with pytest.raises(OptionError, match="give the same"):
        relifted(pyramid, TriangleMesh(mesh.vertices, mesh.faces))


# -- the plane prediction and the random partition -----------------------------------------------


@pytest.mark.parametrize("partition", PARTITIONS)
def test_the_plane_prediction_has_two_vanishing_moments(partition):
    plan = random_delaunay(500, seed=8).vertices[:, :2]
    mesh = TriangleMesh.from_points(np.column_stack([plan, 3 + 2 * plan[:, 0] - plan[:, 1]]))
    pyramid = analyse(mesh, levels=6, partition=partition, prediction="PL", update="none")
    assert pyramid.n_levels == 6
    assert max(np.abs(step.details).max() for step in pyramid.steps) < 1e-12


def test_plane_weights_are_the_least_of_all_that_fit_planes():
    mesh = grid_with_holes(15, 15, seed=2, hole_share=0.1)
    pyramid = analyse(mesh, levels=4, prediction="plane", partition="random")
    for level in range(pyramid.n_levels):
        prediction, _, odd, even = pyramid.filters(level)
        plan = pyramid.mesh(level + 1).vertices[:, :2]
        assert (np.diff(prediction.indptr) >= 3).all()
        rows = np.repeat(np.arange(len(odd)), np.diff(prediction.indptr))
        assert np.bincount(rows, prediction.data**2).max() <= 1 + 1e-6
        for row, v in enumerate(odd):
            ring = even[prediction.indices[prediction.indptr[row] : prediction.indptr[row + 1]]]
            moments = np.column_stack([np.ones(len(ring)), plan[ring] - plan[v]])
            least = np.linalg.pinv(moments.T.copy()) @ np.array([1.0, 0.0, 0.0])
            ours = prediction.data[prediction.indptr[row] : prediction.indptr[row + 1]]
            np.testing.assert_allclose(ours, least, atol=1e-7)


def test_plane_weights_stay_bounded_where_xyz_folds_the_ring():
    pyramid = analyse(random_delaunay(600, seed=1), levels=12, prediction="plane", signal="xyz")
    for step in pyramid.steps:
        rows = np.repeat(np.arange(step.n_odd), np.diff(step.indptr))
        assert np.bincount(rows, step.weights**2).max() <= 1 + 1e-5
        np.testing.assert_allclose(np.bincount(rows, step.weights), 1.0, atol=1e-9)


def test_a_random_partition_follows_its_seed_and_nothing_else():
    mesh = random_delaunay(300, seed=6)
    options = {"partition": "random", "prediction": "plane", "levels": 4}
    one, same, other = (analyse(mesh, seed=s, **options) for s in (1, 1, 2))
    for a, b in zip(one.steps, same.steps, strict=True):
        np.testing.assert_array_equal(a.odd, b.odd)
    assert not np.array_equal(one.steps[-1].odd, other.steps[-1].odd)
    rough = TriangleMesh(mesh.vertices * [1, 1, 50], mesh.faces)
    for a, b in zip(one.steps, analyse(rough, seed=1, **options).steps, strict=True):
        np.testing.assert_array_equal(a.odd, b.odd)
        np.testing.assert_array_equal(a.target, b.target)
        np.testing.assert_array_equal(a.weights, b.weights)


def test_a_negative_seed_is_refused():
    with pytest.raises(OptionError, match="seed is -1"):
        analyse(synthetic.hills(5, 5), partition="random", seed=-1)


# -- noise ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("sigma", [0.01, 0.5])
def test_the_noise_is_found_on_smooth_terrain(sigma):
    mesh = synthetic.hills(60, 80)
    noise = np.random.default_rng(0).normal(0, sigma, mesh.n_vertices)
    flat = TriangleMesh(mesh.vertices * [1, 1, 0], mesh.faces)
    assert estimate_noise(flat, noise) == pytest.approx(sigma, rel=0.03)
    if sigma > 0.1:  # the hills themselves count too, a little
        noisy = mesh.vertices[:, 2] + noise
        assert estimate_noise(mesh, noisy) == pytest.approx(sigma, rel=0.08)
    assert estimate_noise(flat) == 0.0


@pytest.mark.parametrize("partition", ["random", "colouring"])
def test_noise_gains_foretell_the_noise_of_every_coefficient(partition):
    mesh = random_delaunay(2000, seed=9)
    transform = Transform.from_pyramid(
        analyse(mesh, levels=5, partition=partition, prediction="plane")
    )
    noise = np.random.default_rng(5).normal(size=(2000, 400))
    measured = transform.analyse(noise)[1]
    for gain, details in zip(noise_gains(transform), measured, strict=True):
        ratio = details.std(axis=1) / gain
        assert np.mean(ratio) == pytest.approx(1.0, abs=0.05)
        assert np.std(ratio) < 0.06
        assert np.corrcoef(gain, details.std(axis=1))[0, 1] > 0.6


@pytest.mark.parametrize("method", ["bayes", "soft", "hard"])
@pytest.mark.parametrize("given", [True, False])
def test_thresholds_take_noise_out_of_one_channel(method, given):
    mesh = synthetic.hills(70, 90)
    noise = np.random.default_rng(1).normal(0, 2.0, mesh.n_vertices)
    noisy = TriangleMesh(
        mesh.vertices + np.column_stack([0 * noise, 0 * noise, noise]),
        mesh.faces,
        noise[:, None],
        ["a"],
    )
    pyramid = analyse(noisy, partition="random", prediction="plane", attribute_weights=[0.0])
    clean = pyramid.denoised(2.0 if given else None, method=method).synthesise()
    error = clean.vertices[:, 2] - mesh.vertices[:, 2]
    assert np.sqrt(np.mean(error**2)) < 1.1
    np.testing.assert_allclose(clean.attributes, noisy.attributes, atol=1e-12)


@pytest.mark.parametrize("method", ["bayes", "soft", "hard"])
def test_no_noise_or_no_strength_changes_nothing(pyramid, method):
    for same in (
        pyramid.denoised(0.0, method=method),
        pyramid.denoised(0.3, method=method, strength=0),
    ):
        for ours, theirs in zip(same.steps, pyramid.steps, strict=True):
            np.testing.assert_array_equal(ours.details, theirs.details)


def test_local_thresholds_spare_a_rough_corner():
    rng = np.random.default_rng(3)
    x = np.arange(80.0)
    rough = np.where((x[:, None] < 25) & (x < 25), rng.normal(0, 3.0, (80, 80)), 0.0)
    noisy = TriangleMesh.from_grid(rough + rng.normal(0, 0.3, (80, 80)), x=x, y=x)
    pyramid = analyse(noisy, partition="random", prediction="plane", levels=4)
    inside = (noisy.vertices[:, :2] < 25).all(axis=1)

    def errors(**options):
        error = pyramid.denoised(0.3, **options).synthesise().vertices[:, 2] - rough.ravel()
        return np.std(error[inside]), np.std(error[~inside])

    everywhere, nearby = errors(), errors(local=True)
    assert nearby[1] < everywhere[1]
    assert nearby[0] < 0.5


@pytest.mark.large
def test_noise_that_is_not_white_is_met_level_by_level():
    x = np.arange(100.0)
    rng = np.random.default_rng(0)
    correlated = rng.normal(size=(104, 104))
    correlated = sum(correlated[i : i + 100, j : j + 100] for i in range(5) for j in range(5)) / 5
    noisy = TriangleMesh.from_grid(correlated, x=x, y=x)
    pyramid = analyse(noisy, partition="random", prediction="plane", levels=10)
    white = np.std(pyramid.denoised(method="soft").synthesise().vertices[:, 2])
    by_level = np.std(pyramid.denoised(method="soft", by_level=True).synthesise().vertices[:, 2])
    assert by_level < 0.92 * white


def test_a_pyramid_without_levels_passes_through():
    pyramid = analyse(TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 1]], [[0, 1, 2]]))
    assert pyramid.denoised(1.0) is pyramid


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"partition": "quadric"},
        {"partition": "random"},
        {"partition": "random", "prediction": "plane"},
        {"signal": "xyz"},
    ],
    ids=["default", "paper", "random", "plain", "xyz"],
)
def test_thresholds_take_the_noise_out_of_any_partition(options):
    # The default partition keeps what stands out: 80 % of the noise was left.
    x = np.arange(60.0)
    truth = 4 * np.sin(x / 15) * np.cos(x[:, None] / 12)
    noisy = truth + np.random.default_rng(0).normal(0, 0.3, truth.shape)
    pyramid = analyse(TriangleMesh.from_grid(noisy, x=x, y=x), **options)
    clean = pyramid.denoised(0.3)
    left = np.std(clean.synthesise().vertices[:, 2] - truth.ravel())
    assert left < 0.4 * 0.3
    assert clean.n_levels == pyramid.n_levels
    np.testing.assert_array_equal(clean.steps[0].odd, pyramid.steps[0].odd)
