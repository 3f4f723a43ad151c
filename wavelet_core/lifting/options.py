"""The options of an analysis: names, bounds, defaults, and what contradicts what."""

from __future__ import annotations

import math
import operator
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple, NoReturn

from ..errors import OptionError, UnstableDesignWarning
from ..partition.orderings import COSTS, QUADRICS
from ..partition.registry import NORMS, PARTITIONS, Norm, PartitionRow
from .prediction import PREDICTIONS, Prediction
from .signal import SIGNALS, Signal
from .update import UPDATES, Update

__all__ = [
    "PAPER_LEVELS",
    "AnalysisOptions",
    "parse_design",
    "refused_pair",
    "resolve_options",
]

#: Levels where neither a number nor a stop rule is given and the analysis is not error-guided: the
#: paper's experiments use 12.
PAPER_LEVELS = 12
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
    quadrics: str
    cost: str
    seed: int
    norm: str
    removal_fraction: float
    outline_tolerance: float

    def as_dict(self) -> dict[str, Any]:
        """Return the options as plain numbers, strings and lists."""
        return asdict(self) | {"attribute_weights": list(self.attribute_weights)}

    @property
    def is_error_guided(self) -> bool:
        """Whether partition and filters are those that `analyse_surface` carries out as one."""
        return _is_error_guided(self.partition, self.prediction, self.update, self.signal)

    def of_partition(self) -> dict[str, Any]:
        """Return the options that the partition looks at."""
        return {name: getattr(self, name) for name in PARTITIONS[self.partition].options}


def _is_error_guided(partition: str, prediction: str, update: str, signal: str) -> bool:
    return (partition, prediction, signal) == ("surface", "barycentric", "z") and update in (
        "minimum_norm",
        "none",
    )


class Design(NamedTuple):
    """The filters that were named; None for what was not."""

    prediction: Prediction | None
    update: Update | None


def parse_design(prediction: str | None, update: str | None = None) -> Design:
    """Return the filters that are named; ``prediction`` may carry both, as in ``"GLMN"``.

    Raises
    ------
    OptionError
        A name that no table holds, or an update beside another one in ``prediction``.

    Examples
    --------
    >>> design = parse_design("GLMN")
    >>> design.prediction.name, design.update.name
    ('geometric', 'minimum_norm')
    >>> [row.name for row in parse_design("nnls", "MO")]
    ['nnls', 'martinez_ortega']
    """
    of_update = None if update is None else UPDATES.find(update)
    if prediction is None:
        return Design(None, of_update)
    joined = _joined(prediction) if PREDICTIONS.look_up(prediction) is None else None
    if joined is None:
        return Design(PREDICTIONS.find(prediction), of_update)
    if of_update is not None and of_update.name != joined[1].name:
        raise OptionError(
            "{0} {design} names the update {joined}, and {1} is {given}; leave one out.",
            "prediction",
            "update",
            design=repr(prediction),
            joined=joined[1].name,
            given=of_update.name,
        )
    return Design(*joined)


def _joined(name: object) -> tuple[Prediction, Update] | None:
    """Return the two filters of a design such as ``"GLMN"``; None for anything else."""
    if not isinstance(name, str):
        return None
    wanted = name.strip().upper()
    return next(
        (
            (prediction, update)
            for prediction in PREDICTIONS.values()
            for update in UPDATES.values()
            if wanted == (prediction.short + update.short).upper()
        ),
        None,
    )


def refused_pair(prediction: str, update: str) -> bool:
    """Whether the two filters are not to be used together: see docs/science/theory.md, Update."""
    of_prediction = PREDICTIONS.find(prediction)
    return _may_blow_up(of_prediction, UPDATES.find(update)) and not of_prediction.equation


def _may_blow_up(prediction: Prediction, update: Update) -> bool:
    """Whether the update divides by sums of weights that may cancel."""
    return prediction.is_signed and update.divides_by_sums


def resolve_options(
    *,
    n_attributes: int,
    levels: int | None = None,
    partition: str | None = None,
    prediction: str | None = None,
    update: str | None = None,
    signal: str = "z",
    target_vertices: int | None = None,
    max_error: float | None = None,
    max_rms: float | None = None,
    attribute_weights: Sequence[float] | None = None,
    bending_weight: float | None = None,
    quadrics: str | None = None,
    cost: str | None = None,
    seed: int | None = None,
    norm: str | None = None,
    removal_fraction: float | None = None,
    outline_tolerance: float = 0.0,
) -> AnalysisOptions:
    """Return the options with defaults filled in and short names spelled out.

    Raises
    ------
    OptionError
        A value out of bounds, a name that no table holds, or options that contradict each other.
    """
    of_signal = SIGNALS.find(signal)
    design = parse_design(prediction, update)
    of_partition = _partition(partition, design, of_signal)
    of_norm = NORMS.find(norm) if norm is not None else NORMS["rms" if max_error is None else "max"]
    of_quadrics, of_cost = QUADRICS.chosen(quadrics), COSTS.chosen(cost)
    of_prediction = design.prediction or PREDICTIONS[of_partition.prediction]
    of_update = design.update or UPDATES[_default_update(of_partition, of_norm)]
    given = {
        "norm": norm,
        "removal_fraction": removal_fraction,
        "bending_weight": bending_weight,
        "quadrics": quadrics,
        "cost": cost,
        "seed": seed,
    }
    _require_use(of_partition, (name for name, value in given.items() if value is not None))
    _require_stable(of_prediction, of_update)
    targets = _whole("target_vertices", target_vertices, 3)
    largest, mean = _number("max_error", max_error), _number("max_rms", max_rms)
    is_error_guided = _is_error_guided(
        of_partition.name, of_prediction.name, of_update.name, of_signal.name
    )
    most_levels = _whole("levels", levels, 0, MAX_LEVELS)
    if most_levels is None and any(rule is not None for rule in (targets, largest, mean)):
        most_levels = MAX_LEVELS
    elif most_levels is None and not is_error_guided:
        most_levels = PAPER_LEVELS
    tolerance = _number("outline_tolerance", outline_tolerance)
    if tolerance and not is_error_guided:
        _refuse_outline_tolerance(of_partition, of_prediction, of_update, of_signal)
    return AnalysisOptions(
        levels=most_levels,
        partition=of_partition.name,
        prediction=of_prediction.name,
        update=of_update.name,
        signal=of_signal.name,
        target_vertices=targets,
        max_error=largest,
        max_rms=mean,
        attribute_weights=checked_weights(attribute_weights, n_attributes),
        bending_weight=_or(1.0, _number("bending_weight", bending_weight)),
        quadrics=of_quadrics.name,
        cost=of_cost.name,
        seed=_or(0, _whole("seed", seed, 0, 2**63 - 1)),
        norm=of_norm.name,
        removal_fraction=_fraction(removal_fraction, of_norm, targets, largest),
        outline_tolerance=_or(0.0, tolerance),
    )


def _refuse_outline_tolerance(
    partition: PartitionRow, prediction: Prediction, update: Update, signal: Signal
) -> NoReturn:
    raise OptionError(
        "{0} needs {1} 'surface', {2} 'barycentric', {3} 'minimum_norm' or 'none' and {4} 'z'; "
        "they are {partition!r}, {prediction!r}, {update!r} and {signal!r}.",
        "outline_tolerance",
        "partition",
        "prediction",
        "update",
        "signal",
        partition=partition.name,
        prediction=prediction.name,
        update=update.name,
        signal=signal.name,
    )


def _partition(name: str | None, design: Design, signal: Signal) -> PartitionRow:
    """Return the partition that is named, or the one that suits the filters and the signal."""
    if name is not None:
        return PARTITIONS.find(name)
    surface = PARTITIONS["surface"]
    fits = design.prediction is None or design.prediction.name == surface.prediction
    return surface if fits and signal.keeps_plan else PARTITIONS["quadric"]


def _default_update(partition: PartitionRow, norm: Norm) -> str:
    return norm.update if "norm" in partition.options else "minimum_norm"


def _require_use(partition: PartitionRow, given: Iterable[str]) -> None:
    """Refuse an option that the partition does not look at."""
    for name in given:
        if name not in partition.options:
            users = [row.name for row in PARTITIONS.values() if name in row.options]
            raise OptionError(
                "{0} is an option of {1} {users} only, and {1} is {partition}; leave one out.",
                name,
                "partition",
                users=" and ".join(users),
                partition=partition.name,
            )


def _require_stable(prediction: Prediction, update: Update) -> None:
    """Refuse a pair that blows up, or warn where it is the paper's own baseline."""
    if not _may_blow_up(prediction, update):
        return
    if refused_pair(prediction.name, update.name):
        raise OptionError(
            "{0} {prediction} has weights of either sign, and {1} {update} divides by their sums, "
            "which may vanish: details would grow without bound; take {1} {others}, or another "
            "{0}.",
            "prediction",
            "update",
            prediction=prediction.name,
            update=update.name,
            others=" or ".join(row.name for row in UPDATES.values() if not row.divides_by_sums),
        )
    warnings.warn(
        f"prediction {prediction.name} has weights of either sign, and update {update.name} "
        "divides by their sums, which may vanish: coarse levels may be far off; the paper's "
        "other pairs are stable.",
        UnstableDesignWarning,
        stacklevel=4,
    )


def _fraction(
    value: float | None, norm: Norm, target_vertices: int | None, max_error: float | None
) -> float:
    if value is None:
        to_size = target_vertices is not None and max_error is None
        return norm.removal_fraction_to_size if to_size else norm.removal_fraction
    fraction = _as_float(value)
    if not 0 < fraction <= 1:
        raise OptionError(
            "{0} is {given}; give more than 0, at most 1.", "removal_fraction", given=value
        )
    return fraction


def checked_weights(weights: Sequence[float] | None, n_attributes: int) -> tuple[float, ...]:
    """Return the weight of each attribute, 1 where none is given.

    Raises
    ------
    OptionError
        Not one finite number of 0 or more for each.
    """
    if weights is None:
        return (1.0,) * n_attributes
    given: Any = weights
    try:
        given = tuple(weights)
        numbers = tuple(map(_as_float, given))
    except TypeError:  # a single number, which is no sequence
        numbers = (math.nan,)
    if len(numbers) != n_attributes or not all(0 <= number < math.inf for number in numbers):
        raise OptionError(
            "{0} are {given}; give {n_attributes} numbers of 0 or more.",
            "attribute_weights",
            given=given,
            n_attributes=n_attributes,
        )
    return numbers


def _number(option: str, value: float | None) -> float | None:
    """Return a finite number of 0 or more, or None where none is given."""
    if value is None:
        return None
    number = _as_float(value)
    if not 0 <= number < math.inf:
        raise OptionError("{0} is {given}; give a number of 0 or more.", option, given=value)
    return number


def _whole(option: str, value: float | None, low: int, high: int | None = None) -> int | None:
    """Return a whole number within bounds, or None where none is given."""
    if value is None:
        return None
    number = as_whole(value)
    if number is None or number < low or (high is not None and number > high):
        bounds = f"of {low} or more" if high is None else f"from {low} to {high}"
        raise OptionError(
            "{0} is {given}; give a whole number {bounds}.", option, given=value, bounds=bounds
        )
    return number


def as_whole(value: Any) -> int | None:
    """Return an integer of any type, or a float without a fraction, as int; None for others.

    Examples
    --------
    >>> import numpy as np
    >>> as_whole(np.int64(3)), as_whole(3.0), as_whole(2.7), as_whole("3")
    (3, 3, None, None)
    """
    try:
        return operator.index(value)
    except TypeError:
        number = _as_float(value)
    return int(number) if number.is_integer() else None


def _as_float(value: Any) -> float:
    """Return a number as float; NaN, which no bound admits, for what is none."""
    try:
        return math.nan if isinstance(value, str) else float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan


def _or(default: Any, value: Any) -> Any:
    return default if value is None else value
