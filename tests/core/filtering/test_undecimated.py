"""The details of every vertex at once: nothing is lost, planes have none, directions are told."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from wavelet_core import TriangleMesh
from wavelet_core.filtering.undecimated import LEAST_FOR_DIRECTIONS, UndecimatedBank, n_ticks


def scattered(n=LEAST_FOR_DIRECTIONS, seed=0):
    """Return a TIN of uneven random points: east twice as dense as west."""
    points = np.random.default_rng(seed).uniform(0, 100, (n, 2))
    points[:, 0] = 100 * (points[:, 0] / 100) ** 0.7
    return TriangleMesh.from_points(np.column_stack([points, np.zeros(n)]))


def bank_of(mesh, n_scales=4, locked=None):
    noise = np.random.default_rng(1).standard_normal((mesh.n_vertices, 16))
    return UndecimatedBank.from_mesh(mesh, n_scales, noise, locked)


def details_of(bank, columns):
    """Yield the details of each scale, ``(n_vertices, k, n_parts)``."""
    for parts in bank.details(columns):
        yield np.stack(parts, axis=2)


@pytest.fixture(scope="module")
def mesh():
    return scattered()


@pytest.fixture(scope="module")
def bank(mesh):
    return bank_of(mesh)


def test_details_and_the_smooth_rest_add_up_to_the_input(mesh, bank):
    columns = np.random.default_rng(2).normal(size=(mesh.n_vertices, 2))
    smooth = columns
    for _ in range(1 + 1 + 2 + 4):
        smooth = bank.smoother @ smooth
    total = sum(details.sum(axis=2) for details in details_of(bank, columns))
    np.testing.assert_allclose(total + smooth, columns, atol=1e-12)


def test_a_slope_has_no_details_however_steep(mesh, bank):
    plane = (50.0 * mesh.vertices[:, :1] - 20.0 * mesh.vertices[:, 1:2]) + 7.0
    inside = (np.abs(mesh.vertices[:, :2] - 50) < 40).all(axis=1)
    for details in details_of(bank, plane):
        assert np.abs(details[inside]).max() < 1e-4  # of a relief of 7000


def test_a_furrow_is_found_across_and_not_along(mesh, bank):
    furrows = np.sin(mesh.vertices[:, :1] / 1.5)  # east is the first direction
    first = next(details_of(bank, furrows))
    size = np.sqrt(np.mean(first**2, axis=(0, 1)))
    assert size[0] > 1.5 * size[1:3].max()


def test_noise_is_as_large_as_the_bank_says(mesh, bank):
    noise = np.random.default_rng(3).standard_normal((mesh.n_vertices, 40))
    for details, expected in zip(details_of(bank, noise), bank.noise, strict=True):
        ratio = np.sqrt(np.mean(details**2, axis=(0, 1)) / np.mean(expected**2, axis=0))
        assert np.abs(ratio - 1).max() < 0.05


def test_locked_vertices_have_no_details(mesh):
    locked = np.arange(mesh.n_vertices) % 3 == 0
    bank = bank_of(mesh, 2, locked)
    columns = np.random.default_rng(2).normal(size=(mesh.n_vertices, 1))
    for details in details_of(bank, columns):
        assert not details[locked].any()
        assert details[~locked].any()


def test_small_meshes_tell_no_directions():
    small = bank_of(scattered(60))
    assert small.n_parts == 1
    assert np.isfinite(np.concatenate(small.noise)).all()


def test_points_on_a_line_and_alone_are_finite():
    line = np.column_stack([np.arange(5.0), np.zeros(5), np.zeros(5)])
    points = np.vstack([line, [[2.0, 1.0, 0.0], [9.0, 9.0, 0.0]]])
    faces = [[k, k + 1, 5] for k in range(4)]  # the last point is in no face
    bank = bank_of(TriangleMesh(points, np.array(faces)))
    columns = np.random.default_rng(0).normal(size=(7, 1))
    for details in details_of(bank, columns):
        assert np.isfinite(details).all()
        assert abs(details[6]).max() < 1e-12


@pytest.mark.parametrize("n", [500, 5_000, 45_000])
@pytest.mark.parametrize("n_scales", [1, 4, 8, 12])
def test_the_ticks_of_a_bank_are_known_before(n, n_scales):
    """The bar of QGIS stood still where more had been expected."""
    plan = np.random.default_rng(0).random((n, 2))
    mesh = TriangleMesh(np.column_stack([plan, plan[:, 0]]), Delaunay(plan).simplices)
    ticks = []
    noise = np.random.default_rng(1).standard_normal((n, 2))
    UndecimatedBank.from_mesh(mesh, n_scales, noise, tick=lambda: ticks.append(1))
    assert len(ticks) == n_ticks(n, n_scales)
