"""The step to which values were rounded, and the deviation that takes it out."""

from __future__ import annotations

import numpy as np

from ..._validate import FloatArray

#: Least share of the values that rounding to a step must make alike for the step to be believed.
LEAST_ALIKE = 0.5
#: Rounding to a step leaves a deviation of step / sqrt(12), but what it leaves is alike along a
#: terrace, and a filter for white noise must take twice its square to take it out. Measured on four
#: DEMs rounded in 18 ways: never worse than step / sqrt(12), and up to a third of its error.
ROUNDED = 6.0


def rounding_step(values: FloatArray) -> float:
    """Return the step to which values were rounded; 0 where they were not, or finely.

    Examples
    --------
    >>> x = np.linspace(0, 50, 2000)
    >>> rounding_step(np.round(x * 2) / 2 + 0.1), rounding_step(x)
    (0.5, 0.0)
    """
    levels = np.unique(np.round(values, 9))
    if len(levels) < 3 or len(levels) > LEAST_ALIKE * len(values):
        return 0.0
    steps = np.diff(levels)
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    whole = np.diff(levels) / step
    # Steps of a unit that was converted are whole to the digits of the conversion only.
    return step if np.abs(whole - np.rint(whole)).max() < 1e-3 * max(whole.max(), 1.0) else 0.0


def floored(sigma: float, quantum: float) -> float:
    """Return a deviation, no less than what rounding to a step takes."""
    return max(sigma, quantum / np.sqrt(ROUNDED))
