"""Names and bounds of the options of an analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..errors import OptionError
from ..partition.error_guided import REMOVAL_FRACTION
from .prediction import PREDICTIONS
from .update import UPDATES

PARTITIONS = ("surface", "quadric", "colouring", "random")
#: By what a surface-guided partition judges a removal.
NORMS = ("rms", "max")
#: The same for the largest error at a given size, which smaller steps keep lower: 5 % on five DEMs.
MAX_NORM_REMOVAL_FRACTION = 0.1
SIGNALS = ("z", "xyz")
#: Levels with the paper's partition when neither a number nor a stop rule is given: its
#: experiments use 12.
DEFAULT_LEVELS = 12
#: More levels than any input needs; the analysis stops by itself when nothing can be removed.
MAX_LEVELS = 1000


@dataclass(frozen=True, slots=True)
class AnalysisOptions:
    """The options of :func:`wavelet_core.analyse`, resolved and checked."""

    levels: int | None
    partition: str
    prediction: str
    update: str
    signal: str
    target_vertices: int | None
    max_error: float | None
    max_rms: float | None
    attribute_weights: tuple[float, ...]
    bending_weight: float
    seed: int
    norm: str
    removal_fraction: float
    outline_tolerance: float

    def as_dict(self) -> dict[str, Any]:
        """Return the options as plain numbers, strings and lists."""
        return asdict(self) | {"attribute_weights": list(self.attribute_weights)}


def parse_design(prediction: str, update: str) -> tuple[str, str]:
    """Return the full names of the filters; ``prediction`` may carry both, as in ``"GLMN"``.

    Examples
    --------
    >>> parse_design("GLMN", "none")
    ('geometric', 'minimum_norm')
    >>> parse_design("NNLS", "MO")
    ('nnls', 'martinez_ortega')
    """
    joined = prediction.upper()
    for short, full in PREDICTIONS.items():
        if joined.startswith(short) and joined[len(short) :] in UPDATES:
            return full, UPDATES[joined[len(short) :]]
    return (
        _full_name(prediction, PREDICTIONS, "prediction"),
        _full_name(update, UPDATES, "update"),
    )


def resolve_options(
    *,
    n_attributes: int,
    levels: int | None,
    partition: str | None,
    prediction: str | None,
    update: str | None,
    signal: str,
    target_vertices: int | None,
    max_error: float | None,
    max_rms: float | None,
    attribute_weights: Sequence[float] | None,
    bending_weight: float,
    seed: int,
    norm: str | None,
    removal_fraction: float | None,
    outline_tolerance: float,
) -> AnalysisOptions:
    """Return the options with defaults filled in and short names spelled out.

    Raises
    ------
    OptionError
        A value that is not served.
    """
    has_stop_rule = any(rule is not None for rule in (target_vertices, max_error, max_rms))
    if levels is None and has_stop_rule:
        levels = MAX_LEVELS
    if levels is not None and not 0 <= levels <= MAX_LEVELS:
        raise OptionError(f"levels is {levels}; give 0 to {MAX_LEVELS}.")
    if target_vertices is not None and target_vertices < 3:
        raise OptionError(f"target_vertices is {target_vertices}; a mesh has at least 3.")
    for name, value in (("max_error", max_error), ("max_rms", max_rms)):
        if value is not None and not (np.isfinite(value) and value >= 0):
            raise OptionError(f"{name} is {value}; give a distance of 0 or more in the unit of z.")
    weights = (1.0,) * n_attributes if attribute_weights is None else tuple(attribute_weights)
    if len(weights) != n_attributes or not all(np.isfinite(w) and w >= 0 for w in weights):
        raise OptionError(
            f"attribute_weights are {weights}; give {n_attributes} numbers of 0 or more."
        )
    if not (np.isfinite(bending_weight) and bending_weight >= 0):
        raise OptionError(f"bending_weight is {bending_weight}; give 0 or more.")
    if not 0 <= seed < 2**63:
        raise OptionError(f"seed is {seed}; give a whole number of 0 or more.")
    if norm is None:
        norm = "rms" if max_error is None else "max"
    if removal_fraction is None:
        by_size = norm == "max" and target_vertices is not None and max_error is None
        removal_fraction = MAX_NORM_REMOVAL_FRACTION if by_size else REMOVAL_FRACTION
    if not 0 < removal_fraction <= 1:
        raise OptionError(f"removal_fraction is {removal_fraction}; give more than 0, at most 1.")
    if partition is None:
        is_papers = prediction not in (None, "barycentric", "BL") or signal == "xyz"
        partition = "quadric" if is_papers else "surface"
    is_surface = partition == "surface"
    if prediction is None:
        prediction = "barycentric" if is_surface else "geometric"
    if update is None:
        update = "none" if is_surface and norm == "max" else "minimum_norm"
    prediction, update = parse_design(prediction, update)
    if not (np.isfinite(outline_tolerance) and outline_tolerance >= 0):
        raise OptionError(
            f"outline_tolerance is {outline_tolerance}; give a distance of 0 or more in the unit "
            "of x and y."
        )
    keeps_errors = (
        is_surface and prediction == "barycentric" and update in ("minimum_norm", "none")
    ) and signal == "z"
    if outline_tolerance > 0 and not keeps_errors:
        raise OptionError(
            f"outline_tolerance is {outline_tolerance} with partition {partition!r}, prediction "
            f"{prediction!r}, update {update!r} and signal {signal!r}; it needs 'surface', "
            "'barycentric', 'minimum_norm' or 'none', and 'z'."
        )
    if levels is None and not keeps_errors:
        levels = DEFAULT_LEVELS
    return AnalysisOptions(
        levels=None if levels is None else int(levels),
        partition=_one_of(partition, PARTITIONS, "partition"),
        prediction=prediction,
        update=update,
        signal=_one_of(signal, SIGNALS, "signal"),
        target_vertices=None if target_vertices is None else int(target_vertices),
        max_error=None if max_error is None else float(max_error),
        max_rms=None if max_rms is None else float(max_rms),
        attribute_weights=tuple(float(w) for w in weights),
        bending_weight=float(bending_weight),
        seed=int(seed),
        norm=_one_of(norm, NORMS, "norm"),
        removal_fraction=float(removal_fraction),
        outline_tolerance=float(outline_tolerance),
    )


def _full_name(name: str, names: dict[str, str], option: str) -> str:
    if name in names.values():
        return name
    if name.upper() in names:
        return names[name.upper()]
    choices = ", ".join(f"{full} ({short})" for short, full in names.items())
    raise OptionError(f"{option} is {name!r}; give one of {choices}.")


def _one_of(name: str, names: Sequence[str], option: str) -> str:
    if name not in names:
        raise OptionError(f"{option} is {name!r}; give one of {', '.join(names)}.")
    return name
