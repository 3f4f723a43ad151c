"""Assertions that the tests share; ``tests/core/test_helpers.py`` shows that each can fail."""

from __future__ import annotations

import numpy as np
import pytest

import wavelet_core
from wavelet_core.lifting.options import refused_pair
from wavelet_core.partition.questions import N_LEAD_CLASSES, Writer

#: Every filter of the tables, so that a new row is tested as the others are.
PREDICTIONS = tuple(row.name for row in wavelet_core.PREDICTIONS.values() if not row.in_plan)
#: On a TIN only, as they look at the ring in plan.
PLAN_PREDICTIONS = tuple(row.name for row in wavelet_core.PREDICTIONS.values() if row.in_plan)
ALL_PREDICTIONS = (*PREDICTIONS, *PLAN_PREDICTIONS)
UPDATES = tuple(wavelet_core.UPDATES)
PARTITIONS = tuple(wavelet_core.PARTITIONS)
#: Pairs that `analyse` takes; the others are refused, which tests/core/lifting/test_options.py
#: shows.
PAIRS = tuple(
    (prediction, update)
    for prediction in ALL_PREDICTIONS
    for update in UPDATES
    if not refused_pair(prediction, update)
)
#: Lets the paper's unstable baseline, least squares with Martinez-Ortega, pass like the others.
UNSTABLE_TOO = pytest.mark.filterwarnings("ignore::wavelet_core.errors.UnstableDesignWarning")


def columns_of(mesh, channels):
    """Return the values of ``channels`` at the vertices of a mesh, ``(n_vertices, n_channels)``."""
    names = ("x", "y", "z", *mesh.attribute_names)
    table = np.column_stack([mesh.vertices, mesh.attributes])
    return table[:, [names.index(name) for name in channels]]


def canonical_faces(faces):
    """Return the faces as a sorted array, each turned so that its lowest id comes first."""
    faces = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    turn = np.argmin(faces, axis=1)
    turned = faces[np.arange(len(faces))[:, None], (turn[:, None] + np.arange(3)) % 3]
    return turned[np.lexsort(turned.T[::-1])]


def edges_of(faces):
    """Return directed edges ``(3 n_faces, 2)``."""
    faces = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def euler_number(n_vertices, faces):
    """Return vertices - edges + faces."""
    n_edges = len(np.unique(np.sort(edges_of(faces), axis=1), axis=0))
    return n_vertices - n_edges + len(faces)


def n_fans(faces, n_vertices):
    """Return the number of edge-connected fans of faces at each vertex."""
    fans = np.zeros(n_vertices, dtype=np.int64)
    spokes = [[] for _ in range(n_vertices)]
    for a, b, c in np.asarray(faces).tolist():
        spokes[a].append((b, c))
        spokes[b].append((c, a))
        spokes[c].append((a, b))
    for v, pairs in enumerate(spokes):
        following = dict(pairs)
        unseen = set(following)
        starts = unseen - set(following.values())
        while unseen:
            a = starts.pop() if starts else min(unseen)
            fans[v] += 1
            while a in unseen:
                unseen.remove(a)
                a = following[a]
    return fans


def assert_same_mesh(actual, expected, relative=1e-9, largest=None):
    """Assert equal faces, names and values, within ``relative`` of each column's range.

    ``largest``: measure against this value instead, for filters without bound.
    """
    assert actual.attribute_names == expected.attribute_names
    np.testing.assert_array_equal(actual.faces, expected.faces)
    names = ("x", "y", "z", *expected.attribute_names)
    ours, theirs = columns_of(actual, names), columns_of(expected, names)
    assert ours.shape == theirs.shape, f"{ours.shape} against {theirs.shape}"
    span = np.ptp(theirs, axis=0)
    # A column's rounding is that of its values, however small its range.
    allowed = relative * span + 8 * np.finfo(float).eps * np.abs(theirs).max(axis=0)
    if largest is not None:
        allowed = np.full(len(span), relative * largest)
    error = np.abs(ours - theirs).max(axis=0)
    for name, e, limit in zip(names, error, allowed, strict=True):
        assert e <= limit, f"column {name} differs by {e:.3g}, more than {limit:.3g}"


def assert_manifold(mesh, n_parent_fans=None):
    """Assert that no edge has more than two faces and no vertex more fans than its parent had."""
    directed = edges_of(mesh.faces)
    unique, counts = np.unique(directed, axis=0, return_counts=True)
    doubled = unique[counts > 1]
    assert not len(doubled), (
        f"edge {doubled[:1].tolist()} has more than two faces, or one is turned"
    )
    corners = np.sort(mesh.faces, axis=1)
    assert len(np.unique(corners, axis=0)) == len(corners), "two faces lie back to back"
    fans = n_fans(mesh.faces, mesh.n_vertices)
    allowed = np.ones(mesh.n_vertices, dtype=int) if n_parent_fans is None else n_parent_fans
    worse = np.flatnonzero(fans > np.maximum(allowed, 1))
    assert not len(worse), f"vertex {worse[:1]} has {fans[worse[:1]]} separate fans of faces"


def assert_faces_have_area(mesh, in_plan):
    """Assert that every face has area in space, and a positive one in plan with ``in_plan``."""
    if not len(mesh.faces):
        return
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    spatial = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.max([np.sum((q - p) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    assert (spatial > 0).all(), f"face {np.argmin(spatial)} has no area"
    if in_plan:
        plan = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        assert (plan > 0).all(), f"face {np.argmin(plan / longest)} is flipped or flat in plan"


def assert_step_is_consistent(pyramid, level, fine=None, coarse=None):
    """Assert all that one step must obey, from ``filters(level)`` and its two meshes alone."""
    fine = pyramid.mesh(level + 1) if fine is None else fine
    coarse = pyramid.mesh(level) if coarse is None else coarse
    prediction, update, odd, even = pyramid.filters(level)
    s_fine, s_coarse = columns_of(fine, pyramid.channels), columns_of(coarse, pyramid.channels)
    s_odd, s_even = s_fine[odd], s_fine[even]
    details = pyramid.detail(level).vectors
    size = np.maximum(np.abs(s_fine).max(axis=0), np.abs(details).max(axis=0, initial=0))

    assert sorted([*odd, *even]) == list(range(fine.n_vertices)), "odd and even do not share all"
    np.testing.assert_array_equal(even, np.sort(even))
    assert_close(details, s_odd - prediction @ s_even, size, "w = s_odd - P s_even")
    if pyramid.update in ("martinez_ortega", "minimum_norm", "none"):
        assert_close(s_coarse, s_even + update @ details, size, "s = s_even + U w")

    largest_weight = max(1.0, np.abs(prediction.data).max(initial=0))
    sums = np.asarray(prediction.sum(axis=1)).ravel()
    assert np.abs(sums - 1).max(initial=0) <= 1e-12 * largest_weight, "rows of P do not sum to 1"
    if pyramid.parameters.get("prediction") in ("nnls", "cotangent", "uniform", "geometric"):
        assert (prediction.data >= 0).all(), f"a weight of P is {prediction.data.min()}"
    is_odd = np.zeros(fine.n_vertices, dtype=bool)
    is_odd[odd] = True
    assert not is_odd[edges_of(fine.faces)].all(axis=1).any(), "two odd vertices are neighbours"

    assert_manifold(coarse, n_fans(fine.faces, fine.n_vertices)[even])
    assert_faces_have_area(coarse, in_plan=pyramid.signal == "z")
    before = euler_number(fine.n_vertices, fine.faces)
    after = euler_number(coarse.n_vertices, coarse.faces)
    assert after == before, f"the Euler number went from {before} to {after}"


def assert_close(actual, expected, size, what):
    """Assert equality to rounding, per column, relative to ``size``."""
    difference = np.abs(actual - expected).max(axis=0, initial=0)
    worst = np.max(difference / np.where(size > 0, size, 1), initial=0)
    assert worst <= 1e-9, f"{what} is off by {worst:.3g} of the largest coefficient"


def assert_integral_is_constant(pyramid, relative=1e-12):
    """Assert that the sum of integral times coefficient is the same on every level."""
    sums, sizes = [], []
    for level, mesh in enumerate(pyramid):
        zeta = pyramid.integrals(level)[:, None]
        s = columns_of(mesh, pyramid.channels)
        sums.append((zeta * s).sum(axis=0))
        sizes.append(np.abs(zeta * s).sum(axis=0))
    spread = np.ptp(sums, axis=0)
    allowed = relative * np.max(sizes, axis=0)
    assert (spread <= allowed).all(), f"the integral moves by {spread}, more than {allowed}"


def largest_coefficient(pyramid):
    """Return the largest absolute value among the coefficients and details of all levels."""
    columns = [mesh.vertices for mesh in pyramid]
    columns += [mesh.attributes for mesh in pyramid]
    columns += [step.details for step in pyramid.steps]
    return max(np.abs(values).max(initial=0) for values in columns)


def assert_pyramid_is_consistent(pyramid, mesh):
    """Assert perfect reconstruction of ``mesh`` and every step's rules, in one synthesis pass."""
    unbounded = pyramid.parameters.get("prediction") == "least_squares"
    fine_to_coarse = dict(enumerate(pyramid))
    assert sorted(fine_to_coarse) == list(range(pyramid.n_levels + 1))
    finest = fine_to_coarse[pyramid.n_levels]
    assert_same_mesh(finest, mesh, largest=largest_coefficient(pyramid) if unbounded else None)
    for level in range(pyramid.n_levels):
        assert_step_is_consistent(pyramid, level, fine_to_coarse[level + 1], fine_to_coarse[level])
    if pyramid.update == "minimum_norm" and not unbounded:
        assert_integral_is_constant(pyramid)


class ForecastWriter(Writer):
    """Writes the answers as they were asked before format 4, by forecasts alone."""

    def level(self, bounds):
        return super().level(bounds)._replace(integral=None)

    def answers(self):
        answers = super().answers()
        return answers._replace(
            levels=np.ascontiguousarray(answers.levels[:, :2]),
            targets=answers.targets[:N_LEAD_CLASSES],
        )
