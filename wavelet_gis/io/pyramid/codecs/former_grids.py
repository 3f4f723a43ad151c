"""Residuals of rasters as formats 2 and 3 have them: bytes or wider numbers, sorted by relief.

They are still written where they take fewer bytes: of rasters whose numbers are multiples of many
or repeat (metres in centimetres, cells of the nearest neighbour), no bits of a residual are noise.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_gis.io.pyramid.codecs.array_codec import unzigzag
from wavelet_gis.io.pyramid.codecs.grid_walk import require, walk

__all__ = [
    "ESCAPE",
    "RELIEF_CLASSES",
    "FormerResiduals",
    "decode_former_grid",
    "former_relief",
    "pass_by_pass",
    "with_escapes",
]

#: Where classes of relief begin.
RELIEF_CLASSES = (
    1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128, 192, 256,
    512, 1024, 4096,
)  # fmt: skip

#: Stands for a number that a byte does not hold.
ESCAPE = 255

#: With more of those than this share, numbers are stored whole.
MOST_BEYOND = 0.02

#: Differences of neighbours from here on are one.
_MOST_RELIEF = 0xFFFF


class FormerResiduals(NamedTuple):
    """What the predictions of a raster's numbers leave: 0, -1, 1, -2, ... as 0, 1, 2, 3, ...

    numbers : (n_valid,) unsigned; bytes where nearly all of them are
    beyond : (n,) uint64, those that bytes do not hold, where the byte is ESCAPE
    classes : tuple of int, how many there are of each class of relief, which they are in the order
        of; empty where they are pass by pass, by relief within each
    """

    numbers: NDArray[Any]
    beyond: NDArray[np.uint64]
    classes: tuple[int, ...]


def former_relief(
    relief: NDArray[np.float64], wrong: NDArray[np.float64]
) -> tuple[NDArray[np.uint16]]:
    """Return the relief around cells as these residuals are sorted by it; errors do not count."""
    return (np.minimum(relief, float(_MOST_RELIEF)).astype(np.uint16),)


def pass_by_pass(passes: list[tuple[NDArray[np.uint64], NDArray[np.uint16]]]) -> FormerResiduals:
    """Return residuals, given with the relief around them, in the order of it within each pass."""
    ordered = [residuals[np.argsort(relief, kind="stable")] for residuals, relief in passes]
    return with_escapes(np.concatenate(ordered), ())


def with_escapes(residuals: NDArray[np.uint64], classes: tuple[int, ...]) -> FormerResiduals:
    """Return residuals in order as bytes, or as wider numbers where too many are beyond these."""
    is_beyond = residuals >= ESCAPE
    if np.count_nonzero(is_beyond) > MOST_BEYOND * len(residuals):
        widest = np.promote_types(np.uint16, np.min_scalar_type(int(residuals.max(initial=0))))
        numbers = residuals.astype(widest)  # no bytes, in which ESCAPE would be one of them
        return FormerResiduals(numbers, np.empty(0, dtype=np.uint64), classes)
    numbers = np.minimum(residuals, ESCAPE).astype(np.uint8)
    return FormerResiduals(numbers, residuals[is_beyond], classes)


def decode_former_grid(
    residuals: FormerResiduals, valid: NDArray[np.bool_], progress: Progress | None = None
) -> NDArray[np.int64]:
    """Return the integers of the valid cells from their residuals; see `decode_grid`."""
    numbers, beyond, classes = residuals
    require(
        numbers.shape == (int(np.count_nonzero(valid)),)
        and numbers.dtype.kind == "u"
        and beyond.dtype == np.uint64
        and (
            not classes
            or (
                len(classes) == len(RELIEF_CLASSES) + 1
                and min(classes) >= 0
                and sum(classes) == len(numbers)
            )
        )
    )
    whole = numbers.astype(np.uint64)
    if numbers.dtype == np.uint8:
        is_beyond = numbers == ESCAPE
        require(beyond.shape == (int(np.count_nonzero(is_beyond)),))
        whole[is_beyond] = beyond
    else:
        require(beyond.size == 0)
    signed = unzigzag(whole).view(np.int64)
    starts = np.concatenate([[0], np.cumsum(classes, dtype=np.int64)]) if classes else np.zeros(1)
    used = starts.astype(np.int64)

    def put(
        predicted: NDArray[np.int64], cells: NDArray[np.int64], relief: NDArray[np.uint16]
    ) -> NDArray[np.int64]:
        if classes:
            of = np.searchsorted(RELIEF_CLASSES, relief, side="right")
            counts = np.bincount(of, minlength=len(classes))
            require(bool((used[:-1] + counts <= starts[1:]).all()))
            taken = [
                signed[u : u + n] for u, n in zip(used.tolist(), counts.tolist(), strict=False)
            ]
            used[:-1] += counts
            found = np.concatenate(taken)
            order = np.argsort(of, kind="stable")
        else:
            found = signed[used[0] : used[0] + len(predicted)]
            used[0] += len(predicted)
            order = np.argsort(relief, kind="stable")
        residual = np.empty(len(predicted), dtype=np.int64)
        residual[order] = found
        with np.errstate(over="ignore"):
            return predicted + residual

    grid = np.zeros(valid.shape, dtype=np.int64)
    walk(grid, valid, former_relief, put, progress, with_errors=False)
    return grid[valid]
