"""Contours of a TIN."""

import numpy as np
import pytest

from wavelet_core import Cancelled, TriangleMesh
from wavelet_gis.products.contours import contour_lines, contour_values, round_interval


def lines_of(mesh, values, **options):
    return list(contour_lines(mesh.vertices, mesh.faces, values, **options))


def test_the_contours_of_a_plane_are_straight_and_whole():
    x, y = np.arange(9.0), np.arange(7.0)
    mesh = TriangleMesh.from_grid(2 * x + 0 * y[:, None], x=x, y=y)
    found = lines_of(mesh, [3.0, 7.0, 8.0])
    assert [value for value, _ in found] == [3.0, 7.0, 8.0]
    for value, line in found:
        np.testing.assert_allclose(line[:, 0], value / 2)
        np.testing.assert_array_equal(line[:, 2], value)
        assert sorted(line[[0, -1], 1]) == [0.0, 6.0]
        # higher ground, in the east, is on the right
        assert line[-1, 1] > line[0, 1]


def test_the_contour_of_a_cone_is_closed_and_runs_round_it():
    t = np.linspace(-1, 1, 81)
    mesh = TriangleMesh.from_grid(10 * (1 - np.hypot(t, t[:, None])), x=t, y=t)
    ((_, line),) = lines_of(mesh, [5.0])
    np.testing.assert_array_equal(line[0], line[-1])
    np.testing.assert_allclose(np.hypot(line[:, 0], line[:, 1]), 0.5, atol=0.01)
    dx, dy = np.diff(line[:, :2], axis=0).T
    turn = line[:-1, 0] * dy - line[:-1, 1] * dx
    assert abs(turn.sum() / 2) == pytest.approx(np.pi / 4, rel=0.01)
    assert turn.sum() < 0  # clockwise: the top is on the right


def test_heights_of_vertices_and_tops_that_just_touch_make_no_broken_line():
    """A pyramid of one top; contours at its foot, through its middle ring and at its top."""
    t = np.arange(-2.0, 3.0)
    mesh = TriangleMesh.from_grid(2 - np.maximum(np.abs(t), np.abs(t[:, None])), x=t, y=t)
    found = lines_of(mesh, [0.0, 1.0, 2.0])
    (ring,) = [line for value, line in found if value == 1.0]
    np.testing.assert_array_equal(ring[0], ring[-1])
    assert np.abs(ring[:, :2]).max() == 1.0
    assert not [line for value, line in found if value == 2.0]
    assert len(np.unique(ring[:-1], axis=0)) == len(ring) - 1


def test_contours_do_not_cross_and_cut_every_face_once():
    rng = np.random.default_rng(3)
    points = np.column_stack([rng.uniform(0, 100, (800, 2)), np.zeros(800)])
    points[:, 2] = 5 * np.sin(points[:, 0] / 9) + 4 * np.cos(points[:, 1] / 13)
    mesh = TriangleMesh.from_points(points)
    z = mesh.vertices[:, 2][mesh.faces]
    for value in (-3.0, 0.5, 4.0):
        lines = [line for _, line in lines_of(mesh, [value])]
        n_crossed = int(((z.min(axis=1) < value) & (z.max(axis=1) >= value)).sum())
        assert sum(len(line) - 1 for line in lines) == n_crossed


def test_values_and_intervals():
    heights = np.array([-3.2, 9.9])
    np.testing.assert_allclose(contour_values(heights, 2.5), [-2.5, 0, 2.5, 5, 7.5])
    np.testing.assert_allclose(contour_values(heights, 5.0, base=1.0), [1, 6])
    assert round_interval(0.0) == 1.0


def test_the_work_stops_when_it_is_told_to():
    x, y = np.arange(4.0), np.arange(3.0)
    mesh = TriangleMesh.from_grid(x + 4 * y[:, None], x=x, y=y)
    with pytest.raises(Cancelled):
        lines_of(mesh, [2.0, 3.0], progress=lambda fraction: False)
