"""Forecasts of collapses on whole arrays; see :mod:`wavelet_core._kernels.forecast`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .._kernels.forecast import NO_FORECAST
from .._kernels.outline import STAYS
from .._kernels.surface_cost import NONE
from ._csr import blocks
from .half_edges import rings_of
from .outline import outline_rules
from .surface_cost import Block, Targets, legal_targets

#: The upper half of infinity; that of no number is above it.
_INFINITE = 0x7F80

#: Entries of rings that are looked at together: a bound on the memory.
ENTRIES_AT_ONCE = 1 << 19


class _Limits(NamedTuple):
    """What `legal_targets` is limited by: here by nothing but rounding."""

    height_step: float
    tolerance: float = np.inf


def forecast_collapses(
    start, stop, todo, mesh, surface, stays, locked, outline, height_step, negligible, best, second,
    n_around,
):  # fmt: skip
    best[todo], second[todo] = NO_FORECAST, NO_FORECAST
    for rows, ring, targets in _ranked(todo, mesh, surface, stays, locked, outline, height_step):
        each, v = np.arange(len(rows)), todo[rows]
        n_around[v] = min(ring.shape[1], 255)
        for place, errors in ((0, best), (1, second)):
            known = targets.n_legal > place
            squared = targets.own[each, targets.order[:, place]][known]
            errors[v[known]] = coded(squared, negligible)


def coded(squared, negligible):
    """Return the upper half of each number in single precision, which keeps the order."""
    code = upper_halves(np.where(squared <= negligible, 0.0, squared))
    code[code >= _INFINITE] = NO_FORECAST
    return code


def upper_halves(numbers):
    """Return the upper half of each number in single precision, whatever it is."""
    with np.errstate(over="ignore"):
        single = numbers.astype(np.float32)
    return (single.view(np.uint32) >> np.uint32(16)).astype(np.uint16)


def match_targets(
    start, stop, odd, mesh, surface, stays, locked, outline, height_step, rank, target
):
    given = rank >= 0
    asked = target.copy()
    target[given] = -1
    for rows, ring, targets in _ranked(odd, mesh, surface, stays, locked, outline, height_step):
        each = np.arange(len(rows))
        wanted = rank[rows].copy()
        for k in range(int(targets.n_legal.max(initial=0))):
            there = k < targets.n_legal
            at = ring[each, targets.order[:, k]]
            named = there & given[rows] & (wanted == k)
            target[rows[named]] = at[named]
            found = there & ~given[rows] & (at == asked[rows])
            rank[rows[found]] = k


def _ranked(vertices, mesh, surface, stays, locked, outline, height_step) -> Iterator:
    """Yield rows of ``vertices`` that have targets, their rings, and the targets in order."""
    free = np.flatnonzero(~stays[vertices])
    rings = rings_of(vertices[free], mesh)
    is_enclosed = (locked[rings.ring] | (rings.ring < 0)).all(axis=1)
    may_go = (rings.size >= 3) & ~is_enclosed
    kind = 2 * rings.size + (rings.n_sides < rings.size)
    for which in np.unique(kind[may_go]):
        of_kind = np.flatnonzero(may_go & (kind == which))
        size, n_sides = int(which) // 2, int(which) // 2 - int(which) % 2
        for part in blocks(np.full(len(of_kind), size), ENTRIES_AT_ONCE):
            chosen = of_kind[part]
            v, ring = vertices[free[chosen]], rings.ring[chosen, :size]
            block, kept = _block(v, ring, rings.spoke[chosen, :n_sides], surface, outline)
            if len(block.v):
                nobody = np.zeros(block.ring.shape, dtype=bool)
                anyone = np.full(len(block.v), NONE)
                targets: Targets = legal_targets(
                    block, anyone, nobody, surface.z, _Limits(height_step)
                )
                yield free[chosen[kept]], block.ring, targets


def _block(v, ring, spoke, surface, outline):
    """Return the block, without points, and which of the vertices the outline lets go at all."""
    rx, ry = surface.x[ring] - surface.x[v][:, None], surface.y[ring] - surface.y[v][:, None]
    rule, along = np.full(len(v), NONE), np.zeros(len(v))
    kept = np.ones(len(v), dtype=bool)
    if spoke.shape[1] < ring.shape[1]:
        rule, along = outline_rules(v, ring, rx, ry, outline)
        kept = rule != STAYS
    none = np.empty(0, dtype=np.int64)
    return Block(
        v[kept], ring[kept], spoke[kept], rule[kept], along[kept], rx[kept], ry[kept],
        surface.z[ring[kept]], none, none, none, none, none,
    ), kept  # fmt: skip
