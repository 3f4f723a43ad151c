"""Stars and one-rings on whole arrays; see :mod:`wavelet_core._kernels.connectivity`."""

from __future__ import annotations

import numpy as np

from .._kernels import connectivity as kernels
from .._kernels.connectivity import BOUNDARY, INTERIOR, ISOLATED, PINCH
from ..progress import report_share

#: Vertices that are looked at together: a bound on the memory.
AT_ONCE = 50_000


def fill_stars(faces, indptr, star):
    corners = faces.ravel()
    indptr[1:] = np.cumsum(np.bincount(corners, minlength=len(indptr) - 1))
    star[:] = np.argsort(corners, kind="stable") // 3


def order_rings(start, stop, faces, indptr, star, kind, ring, ring_size, bad_neighbour):
    bad_neighbour[start:stop] = -1
    for first in range(start, stop, AT_ONCE):
        report_share((first - start) / (stop - start))
        last = min(first + AT_ONCE, stop)
        v = _order_some(first, last, faces, indptr, star, kind, ring, ring_size)
        if v >= 0:  # no surface: the loop says which edge
            arrays = (faces, indptr, star, kind, ring, ring_size, bad_neighbour)
            kernels.order_rings.loops(v, v + 1, *arrays)
            return


def _order_some(start, stop, faces, indptr, star, kind, ring, ring_size):
    """Order the rings of some vertices; return the first whose faces are no surface, or -1."""
    n, n_here = len(kind), stop - start
    degree = np.diff(indptr[start : stop + 1])
    first = indptr[start:stop].astype(np.int64) - int(indptr[start])
    faces_here = faces[star[int(indptr[start]) : int(indptr[stop])]]
    # one entry for each face of each vertex: the corner after the vertex, and the one before it
    vertex = np.repeat(np.arange(n_here), degree)
    entries = np.arange(len(vertex))
    corner = np.argmax(faces_here == (vertex + start)[:, None], axis=1)
    later = faces_here[entries, (corner + 1) % 3].astype(np.int64)
    earlier = faces_here[entries, (corner + 2) % 3].astype(np.int64)
    key_after, key_before = vertex * np.int64(n) + later, vertex * np.int64(n) + earlier
    by_after, by_before = (np.argsort(key, kind="stable") for key in (key_after, key_before))
    doubled = [
        vertex[order[:-1][np.diff(key[order]) == 0]]
        for key, order in ((key_after, by_after), (key_before, by_before))
    ]
    if any(map(len, doubled)):
        return start + int(np.concatenate(doubled).min())

    following = _match(key_before, key_after, by_after)
    opens = np.flatnonzero(_match(key_after, key_before, by_before) < 0)
    n_openings = np.bincount(vertex[opens], minlength=n_here)
    opening = first.copy()
    opening[vertex[opens[::-1]]] = opens[::-1]  # the first of each vertex is written last

    base = indptr[start:stop].astype(np.int64) + np.arange(start, stop)
    active = np.flatnonzero(degree > 0)
    current = opening[active]
    last = np.zeros(n_here, dtype=np.int64)
    n_walked = np.zeros(n_here, dtype=np.int64)
    while len(active):
        ring[base[active] + n_walked[active]] = later[current]
        n_walked[active] += 1
        last[active] = current
        step = following[current]
        goes_on = (step >= 0) & (step != opening[active]) & (n_walked[active] < degree[active])
        active, current = active[goes_on], step[goes_on]
    found = np.full(n_here, INTERIOR, dtype=kind.dtype)
    found[n_openings == 1] = BOUNDARY
    found[(n_walked < degree) | (n_openings > 1)] = PINCH
    found[degree == 0] = ISOLATED
    is_outline = found == BOUNDARY
    ring[base[is_outline] + degree[is_outline]] = earlier[last[is_outline]]
    kind[start:stop] = found
    ring_size[start:stop] = np.where(found == INTERIOR, degree, np.where(is_outline, degree + 1, 0))
    return -1


def _match(keys, others, order):
    """Place of each key among the others; -1 where it is not."""
    if len(others) == 0:
        return np.full(len(keys), -1)
    place = np.minimum(np.searchsorted(others[order], keys), len(others) - 1)
    found = order[place]
    return np.where(others[found] == keys, found, -1)
