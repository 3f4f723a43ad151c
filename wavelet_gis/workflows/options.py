"""The options of a wavelet analysis, as all workflows take them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypedDict

from numpy.typing import ArrayLike

from wavelet_core.errors import OptionError

__all__ = ["WaveletOptions", "core_options"]


class WaveletOptions(TypedDict, total=False):
    """Keywords of `wavelet_core.analyse`, and ``design``; None leaves the choice to the core.

    design : a design of the paper, prediction and update in one, such as ``GLMN``; with the paper's
        partition unless another is named
    partition, prediction, update, signal, norm, removal_fraction, bending_weight,
    attribute_weights, locked : see `wavelet_core.analyse`
    """

    design: str | None
    partition: str | None
    prediction: str | None
    update: str | None
    signal: str | None
    norm: str | None
    removal_fraction: float | None
    bending_weight: float | None
    attribute_weights: Sequence[float] | None
    locked: ArrayLike | None


def core_options(options: WaveletOptions) -> dict[str, Any]:
    """Return the options that are given as keywords of `wavelet_core.analyse`.

    Parameters
    ----------
    options : WaveletOptions
        As a workflow was given them.

    Raises
    ------
    OptionError
        A design beside a prediction or an update.

    Examples
    --------
    >>> core_options({"design": "GLMN", "norm": None})
    {'prediction': 'GLMN', 'partition': 'quadric'}
    """
    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    design = given.pop("design", None)
    if design is None:
        return given
    if "prediction" in given or "update" in given:
        raise OptionError(
            "{0} names prediction and update; leave out {1} and {2}.",
            "design",
            "prediction",
            "update",
        )
    return {"prediction": design, "partition": "quadric", **given}
