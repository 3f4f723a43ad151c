"""Checks of the parts of a pyramid that comes from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray
from ..errors import PyramidError
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
    _require(signal in ("z", "xyz"), f"signal {signal!r} is neither 'z' nor 'xyz'")
    _require(update in UPDATES.values(), f"update {update!r} is not known")
    leading = ("z",) if signal == "z" else ("x", "y", "z")
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
    _require(_in_range(faces, n_vertices), "faces with a vertex out of range")
    a, b, c = faces.T
    _require(not ((a == b) | (b == c) | (c == a)).any(), "a face with a vertex twice")
    if signal == "z":
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
    where = f"step {level}"
    n_odd = len(step.odd)
    n_fine = n_even + n_odd
    _require(
        step.odd.shape == step.target.shape == (n_odd,) and n_odd > 0, f"{where}: no odd vertices"
    )
    _require(_in_range(step.odd, n_fine), f"{where}: an odd vertex out of range")
    _require(_in_range(step.target, n_fine), f"{where}: a target out of range")
    is_odd = np.zeros(n_fine, dtype=bool)
    is_odd[step.odd] = True
    _require(int(is_odd.sum()) == n_odd, f"{where}: an odd vertex twice")
    _require(not is_odd[step.target].any(), f"{where}: a target that is odd itself")
    _require(
        step.indptr.shape == (n_odd + 1,)
        and step.indptr[0] == 0
        and bool((np.diff(step.indptr) > 0).all())
        and step.indptr[-1] == len(step.indices) == len(step.weights),
        f"{where}: a prediction filter whose rows do not fit",
    )
    _require(_in_range(step.indices, n_even), f"{where}: a prediction from a vertex out of range")
    _require(bool(np.isfinite(step.weights).all()), f"{where}: a prediction weight not finite")
    _require(
        step.details.shape == (n_odd, n_channels) and bool(np.isfinite(step.details).all()),
        f"{where}: detail vectors that do not fit or are not finite",
    )
    return n_fine


def _in_range(ids: NDArray, n: int) -> bool:
    return ids.size == 0 or bool(ids.min() >= 0 and ids.max() < n)


def _require(holds: bool, fault: str) -> None:
    if not holds:
        raise PyramidError(f"not a valid pyramid: {fault}; analyse the input anew.")
