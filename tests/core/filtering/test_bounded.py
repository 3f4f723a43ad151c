"""Least quadratic forms within bounds, and the same bytes for any number of threads of BLAS."""

import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from wavelet_core.filtering._bounded import ROWS_AT_ONCE, least_within, moments_of, solved

#: Prints the hash of a small DEM without its noise.
DENOISED = """
import hashlib
import numpy as np
from wavelet_core import TriangleMesh, denoise
x = np.arange(80.0)
z = 5 * np.sin(x / 12) * np.cos(x[:, None] / 15)
z = z + np.random.default_rng(0).normal(0, 0.3, z.shape)
mesh = denoise(TriangleMesh.from_grid(z, x=x, y=x), n_pyramids=1)
print(hashlib.sha256(mesh.vertices.tobytes()).hexdigest())
"""


def test_denoising_gives_the_same_bytes_for_any_number_of_blas_threads():
    # Products of matrices and least squares by BLAS differed in the 14th digit.
    printed = [
        subprocess.run(
            [sys.executable, "-c", DENOISED],
            env={**os.environ, "OPENBLAS_NUM_THREADS": n, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            check=True,
            text=True,
        ).stdout
        for n in ("1", "2")
    ]
    assert len(printed[0].strip()) == 64
    assert printed[0] == printed[1]


@pytest.mark.parametrize("n_rows", [0, 1, 5, ROWS_AT_ONCE + 3])
def test_moments_are_the_sums_of_products(n_rows):
    columns = np.random.default_rng(0).normal(size=(n_rows, 4))
    np.testing.assert_allclose(moments_of(columns), columns.T @ columns, atol=1e-10)


def test_a_system_is_solved():
    rows = np.random.default_rng(1).normal(size=(20, 9))
    matrix, right = rows.T @ rows, np.arange(9.0)
    np.testing.assert_allclose(matrix @ solved(matrix, right), right, atol=1e-10)


def test_two_unknowns_by_hand():
    # Without bounds (1, 2); with the second held at 1/2 the first is where the form is least.
    matrix, pull = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([4.0, 5.0])
    found, least = least_within(matrix, pull, np.array([-9.0, -9.0]), np.array([9.0, 9.0]))
    np.testing.assert_allclose(found, [1.0, 2.0])
    assert least == pytest.approx(-7.0)
    found, _ = least_within(matrix, pull, np.array([-9.0, -9.0]), np.array([9.0, 0.5]))
    np.testing.assert_allclose(found, [1.75, 0.5])


@pytest.mark.parametrize("seed", range(12))
def test_the_least_within_bounds_is_the_one_of_scipy(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 60))
    rows = rng.normal(size=(3 * n, n)) @ (rng.normal(size=(n, n)) if seed % 2 else np.eye(n))
    rows /= np.linalg.norm(rows, axis=0)
    target = rng.normal(size=3 * n)
    high = rng.uniform(0.01, 0.5, n)
    low = -2 * high
    found, _ = least_within(rows.T @ rows, rows.T @ target, low, high)
    expected = lsq_linear(rows, target, (low, high), method="bvls", max_iter=5000).x
    np.testing.assert_allclose(found, expected, atol=1e-9)
    assert (found >= low).all()
    assert (found <= high).all()
    assert ((found == low) | (found == high)).any() or n < 5
