"""Checks of the parts of a pyramid that comes from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray
from ..errors import PyramidError
from .signal import SIGNALS
from .step import Step
from .update import UPDATES


def check_parts(
    faces: NDArray,
    horizontal: FloatArray | None,
    coarse: FloatArray,
    steps: Sequence[Step],
    channels: Sequence[str],
    signal: str,
    update: str,
    locked: NDArray | None,
) -> None:
    """Raise :class:`PyramidError` unless the parts are those of some pyramid."""
    _require(signal in SIGNALS, f"signal {signal!r} is not known")
    _require(update in UPDATES, f"update {update!r} is not known")
    leading = SIGNALS[signal].coordinates
    names = tuple(channels)
    _require(names[: len(leading)] == leading, f"channels {names} do not begin with {leading}")
    _require(len(set(names)) == len(names), f"channels {names} repeat a name")
    _require(
        coarse.ndim == 2 and coarse.shape[1] == len(names),
        f"coarse coefficients of shape {coarse.shape} for {len(names)} channels",
    )
    _require(bool(np.isfinite(coarse).all()), "coarse coefficients that are not finite")
    n_vertices = len(coarse)
    for level, step in enumerate(steps):
        n_vertices = _check_step(level, step, n_vertices, len(names))
    _require(faces.ndim == 2 and faces.shape[1] == 3, f"faces of shape {faces.shape}")
    _require(_are_whole(faces), "faces that are no whole numbers")
    _require(_in_range(faces, n_vertices), "faces with a vertex out of range")
    a, b, c = faces.T
    _require(not ((a == b) | (b == c) | (c == a)).any(), "a face with a vertex twice")
    if SIGNALS[signal].keeps_plan:
        _require(
            horizontal is not None
            and horizontal.shape == (n_vertices, 2)
            and bool(np.isfinite(horizontal).all()),
            f"x and y that do not fit {n_vertices} vertices",
        )
    else:
        _require(horizontal is None, "x and y beside a lifted x and y")
    _require(locked is None or locked.shape == (n_vertices,), "a locked mask of another length")


def _check_step(level: int, step: Step, n_even: int, n_channels: int) -> int:
    def require(holds: bool, fault: str) -> None:
        _require(holds, f"step {level}: {fault}", level)

    n_odd = len(step.odd)
    n_fine = n_even + n_odd
    require(step.odd.shape == step.target.shape == (n_odd,) and n_odd > 0, "no odd vertices")
    ids = (step.odd, step.target, step.indptr, step.indices)
    require(_are_whole(*ids), "ids that are no whole numbers")
    require(_in_range(step.odd, n_fine), "an odd vertex out of range")
    require(_in_range(step.target, n_fine), "a target out of range")
    is_odd = np.zeros(n_fine, dtype=bool)
    is_odd[step.odd] = True
    require(int(is_odd.sum()) == n_odd, "an odd vertex twice")
    require(not is_odd[step.target].any(), "a target that is odd itself")
    require(
        step.indptr.shape == (n_odd + 1,)
        and step.indptr[0] == 0
        and bool((np.diff(step.indptr) > 0).all())
        and step.indptr[-1] == len(step.indices) == len(step.weights),
        "a prediction filter whose rows do not fit",
    )
    require(_in_range(step.indices, n_even), "a prediction from a vertex out of range")
    require(bool(np.isfinite(step.weights).all()), "a prediction weight not finite")
    require(
        step.details.shape == (n_odd, n_channels) and bool(np.isfinite(step.details).all()),
        "detail vectors that do not fit or are not finite",
    )
    return n_fine


def _in_range(ids: NDArray, n: int) -> bool:
    return ids.size == 0 or bool(ids.min() >= 0 and ids.max() < n)


def _are_whole(*arrays: NDArray) -> bool:
    return all(array.size == 0 or array.dtype.kind in "iu" for array in arrays)


def _require(holds: bool, fault: str, level: int | None = None) -> None:
    if not holds:
        raise PyramidError(f"not a valid pyramid: {fault}; analyse the input anew.", level)
