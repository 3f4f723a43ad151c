"""Stars and one-rings on whole arrays; see :mod:`wavelet_core._kernels.connectivity`."""

from __future__ import annotations

import numpy as np

from .._kernels import connectivity as kernels
from .._kernels.connectivity import BOUNDARY, INTERIOR, ISOLATED, PINCH


def fill_stars(faces, indptr, star):
    corners = faces.ravel()
    indptr[1:] = np.cumsum(np.bincount(corners, minlength=len(indptr) - 1))
    star[:] = np.argsort(corners, kind="stable") // 3


def order_rings(start, stop, faces, indptr, star, kind, ring, ring_size, bad_neighbour):
    n = len(kind)
    degree = np.diff(indptr)
    # one entry for each face of each vertex: the corner after the vertex, and the one before it
    vertex = np.repeat(np.arange(n), degree)
    corner = np.argmax(faces[star] == vertex[:, None], axis=1)
    later = faces[star, (corner + 1) % 3].astype(np.int64)
    earlier = faces[star, (corner + 2) % 3].astype(np.int64)
    key_after, key_before = vertex * np.int64(n) + later, vertex * np.int64(n) + earlier
    by_after, by_before = (np.argsort(key, kind="stable") for key in (key_after, key_before))

    bad_neighbour[:] = -1
    doubled = np.zeros(n, dtype=bool)
    for key, order in ((key_after, by_after), (key_before, by_before)):
        same = np.flatnonzero(np.diff(key[order]) == 0)
        doubled[vertex[order[same]]] = True
    if doubled.any():  # no surface: the loop says which edge, of the first such vertex
        v = int(np.argmax(doubled))
        arrays = (faces, indptr, star, kind, ring, ring_size, bad_neighbour)
        kernels.order_rings.loops(v, v + 1, *arrays)
        return

    following = _match(key_before, key_after, by_after)
    opens = np.flatnonzero(_match(key_after, key_before, by_before) < 0)
    n_openings = np.bincount(vertex[opens], minlength=n)
    opening = indptr[:-1].copy()
    opening[vertex[opens[::-1]]] = opens[::-1]  # the first of each vertex is written last

    ring_size[:] = 0
    base = indptr[:-1] + np.arange(n)
    active = np.flatnonzero(degree > 0)
    current = opening[active]
    last = np.zeros(n, dtype=np.int64)
    n_walked = np.zeros(n, dtype=np.int64)
    while len(active):
        ring[base[active] + n_walked[active]] = later[current]
        n_walked[active] += 1
        last[active] = current
        step = following[current]
        goes_on = (step >= 0) & (step != opening[active]) & (n_walked[active] < degree[active])
        active, current = active[goes_on], step[goes_on]
    kind[:] = INTERIOR
    is_outline = n_openings == 1
    kind[is_outline] = BOUNDARY
    kind[(n_walked < degree) | (n_openings > 1)] = PINCH
    kind[degree == 0] = ISOLATED
    is_outline = kind == BOUNDARY
    ring[base[is_outline] + degree[is_outline]] = earlier[last[is_outline]]
    ring_size[:] = np.where(kind == INTERIOR, degree, np.where(is_outline, degree + 1, 0))


def _match(keys, others, order):
    """Place of each key among the others; -1 where it is not."""
    if len(others) == 0:
        return np.full(len(keys), -1)
    place = np.minimum(np.searchsorted(others[order], keys), len(others) - 1)
    found = order[place]
    return np.where(others[found] == keys, found, -1)
