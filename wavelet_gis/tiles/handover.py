"""Which level of each piece the group above begins with: a common price of a vertex for all.

Tiles of the same number of levels are as coarse as one another, whether they are flat or rough,
and what rough ones have lost by then no later stage gives back. Going one level down saves so many
vertices and adds so much to the squared error; what of all pieces of a stage adds the least for a
vertex goes first, until a given part of all vertices is left. As in bit allocation, this is where
the error of the whole is least for its size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.tiles.plan import Piece

__all__ = ["SHARE_HANDED_ON", "handover_levels"]

#: Part of the vertices that pieces begin with that is handed on to the next stage: a group of four
#: then begins with fewer than a tile does, whatever the stage.
SHARE_HANDED_ON = 0.2


def handover_levels(
    groups: Sequence[Sequence[Piece]], records: Mapping[Piece, Mapping[str, Any]]
) -> dict[Piece, int]:
    """Return the level of each piece that its group is to begin with.

    Parameters
    ----------
    groups : sequence of sequence of Piece
        The pieces of a stage that are there, those of one group together.
    records : mapping of Piece to mapping
        With ``sizes``, vertices by level, ``rmse_by_level`` and ``n_points``, the points of the
        input that a piece stands for. Level 0, the first, is the coarsest.

    Notes
    -----
    No group begins with more vertices than the largest of its pieces had, or that many and the
    coarsest level of each: its memory is bounded whatever the terrain.
    """
    pieces = [piece for group in groups for piece in group]
    group_of = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    steps = [_steps(records[piece]) for piece in pieces]
    owner = np.repeat(np.arange(len(pieces)), [len(prices) for prices, _ in steps])
    prices = np.concatenate([np.empty(0), *(prices for prices, _ in steps)])
    saved = np.concatenate([np.empty(0, np.int64), *(saved for _, saved in steps)])
    finest = np.array([records[piece]["sizes"][-1] for piece in pieces], dtype=np.int64)
    order = np.argsort(prices, kind="stable")  # within a piece prices never fall
    due = (1.0 - SHARE_HANDED_ON) * finest.sum()
    is_taken = np.zeros(len(prices), dtype=bool)
    is_taken[order[np.cumsum(saved[order]) - saved[order] < due]] = True
    taken = np.bincount(owner[is_taken], minlength=len(pieces))
    left = finest - np.bincount(owner[is_taken], saved[is_taken], len(pieces)).astype(np.int64)
    _bound(taken, left, finest, group_of, (order[~is_taken[order]], owner, saved))
    return {
        piece: len(records[piece]["sizes"]) - 1 - int(n_steps)
        for piece, n_steps in zip(pieces, taken, strict=True)
    }


def _steps(record: Mapping[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return what each step down from the finest level costs a vertex, and how many it saves."""
    sizes = np.array(record["sizes"][::-1], dtype=np.int64)
    saved = sizes[:-1] - sizes[1:]
    if "rmse_by_level" not in record:  # of a tile set of before, which went down to the last level
        return np.zeros(len(saved)), saved
    squared = float(record["n_points"]) * np.array(record["rmse_by_level"][::-1]) ** 2
    prices = np.diff(squared) / np.maximum(saved, 1)
    return np.maximum.accumulate(np.maximum(prices, 0.0)), saved


def _bound(
    taken: NDArray[np.int64],
    left: NDArray[np.int64],
    finest: NDArray[np.int64],
    group_of: NDArray[np.int64],
    rest: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
) -> None:
    """Take further steps of groups that would begin with too many vertices, the cheapest first."""
    order, owner, saved = rest
    n_groups = int(group_of.max(initial=-1)) + 1
    most = np.zeros(n_groups, dtype=np.int64)
    np.maximum.at(most, group_of, finest)
    begins_with = np.bincount(group_of, left, n_groups).astype(np.int64)
    for step in order.tolist():
        piece = int(owner[step])
        group = int(group_of[piece])
        if begins_with[group] > most[group]:
            taken[piece] += 1
            left[piece] -= saved[step]
            begins_with[group] -= saved[step]
