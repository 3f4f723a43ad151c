"""k means and mixtures: as good as scikit-learn's, and the same whatever the threads."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from wavelet_core.errors import Cancelled
from wavelet_gis.workflows.learning.means import fit_means, fit_mixture

ROOT = Path(__file__).resolve().parents[3]


def skewed(n=3000, d=6, seed=1):
    """Return columns of unit variance without any plain groups, as signatures are."""
    rng = np.random.default_rng(seed)
    columns = rng.standard_normal((n, d)) @ rng.standard_normal((d, d))
    columns += np.where(rng.random(n) < 0.3, 2.0, 0.0)[:, None] + np.exp(columns[:, :1] / 2)
    return (columns - columns.mean(axis=0)) / columns.std(axis=0)


@pytest.mark.parametrize("count", [1, 2, 5, 10])
def test_inertia_is_within_some_percent_of_that_of_scikit_learn(count):
    cluster = pytest.importorskip("sklearn.cluster")
    columns = skewed()
    theirs = cluster.KMeans(count, n_init=4, random_state=0).fit(columns)
    ours = fit_means(columns, count, 0)
    assert ours.inertia <= 1.03 * theirs.inertia_
    apart = ((columns - ours.centres[ours.labels]) ** 2).sum()
    assert ours.inertia == pytest.approx(apart)


def test_a_mixture_is_as_likely_as_that_of_scikit_learn():
    mixture = pytest.importorskip("sklearn.mixture")
    columns = skewed()
    theirs = mixture.GaussianMixture(4, reg_covar=1e-4, random_state=0).fit(columns)
    ours = fit_mixture(columns, 4, 0)
    posteriors, likelihood = ours.posteriors(columns)
    assert likelihood >= theirs.score(columns) - 0.05
    np.testing.assert_allclose(posteriors.sum(axis=1), 1.0)


def test_the_likelihood_of_one_gaussian_by_hand():
    columns = skewed(500, 3)
    mixture = fit_mixture(columns, 1, 0)
    covariance = np.cov(columns.T, bias=True) + 1e-4 * np.eye(3)
    apart = columns - columns.mean(axis=0)
    squares = np.einsum("nd,de,ne->n", apart, np.linalg.inv(covariance), apart)
    expected = -0.5 * (squares + np.log(np.linalg.det(2 * np.pi * covariance)))
    assert mixture.posteriors(columns)[1] == pytest.approx(expected.mean())


def test_fewer_places_than_clusters():
    columns = np.repeat(np.array([[0.0, 1.0], [5.0, 2.0]]), 10, axis=0)
    found = fit_means(columns, 4, 0)
    assert found.inertia == pytest.approx(0.0)
    assert len(set(found.labels[:10])) == len(set(found.labels[10:])) == 1
    assert np.isfinite(fit_mixture(columns, 4, 0).assign(columns)[1]).all()


def test_a_centre_without_rows_goes_where_it_is_needed():
    rng = np.random.default_rng(0)
    columns = np.concatenate([rng.normal(c, 0.1, (50, 2)) for c in (0.0, 10.0, 20.0)])
    found = fit_means(columns, 3, 0)
    assert np.bincount(found.labels).tolist() == [50, 50, 50]


@pytest.mark.parametrize("fit", [fit_means, fit_mixture])
def test_it_stops_when_told_to(fit):
    told = []

    def progress(fraction):
        told.append(fraction)
        return len(told) < 5

    with pytest.raises(Cancelled):
        fit(skewed(), 8, 0, progress)
    assert len(told) == 5


def test_the_same_bytes_for_any_number_of_threads():
    code = (
        "import hashlib, sys; sys.path[:0] = sys.argv[1:]\n"
        "from gis.workflows.test_means import skewed\n"
        "from wavelet_gis.workflows.learning.means import fit_means, fit_mixture\n"
        "columns = skewed(20000, 12)\n"
        "a, b = fit_means(columns, 6, 0), fit_mixture(columns, 3, 0)\n"
        "print(hashlib.sha256(a.centres.tobytes() + b.factors.tobytes()).hexdigest())\n"
    )
    digests = set()
    for threads in ("1", "4"):
        names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
        environment = {**os.environ, **dict.fromkeys(names, threads)}
        command = [sys.executable, "-c", code, str(ROOT), str(ROOT / "tests")]
        said = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        digests.add(said.stdout)
    assert len(digests) == 1
