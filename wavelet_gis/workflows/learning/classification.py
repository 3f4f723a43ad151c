"""Classes learned from labelled vertices, and how well they are predicted. Arrays in, arrays out.

Needs scikit-learn, which is imported when it is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError
from wavelet_core.features.signature import Signature
from wavelet_core.progress import Progress, part_of, report
from wavelet_gis.workflows.learning._blocks import FloatArray, IntArray, blocks_of, sample_of
from wavelet_gis.workflows.learning._scikit_learn import (
    few_threads,
    half_of_the_cores,
    require_sklearn,
)

__all__ = ["Classes", "Validation", "learn_classes", "spatial_folds", "validate_classes"]

#: Labelled vertices that a class is learned from, at most.
MAX_PER_CLASS = 8_000

#: Bins of a feature.
N_BINS = 255

#: Trees that are grown, and those between two looks at whether to stop.
N_TREES, N_TREES_AT_ONCE = 80, 8
#: Vertices whose prediction takes as long as growing them.
GROWN_AS = 250_000

#: Blocks in each direction by which validation is split; see `spatial_folds`.
BLOCKS_PER_SIDE = 5


@dataclass(frozen=True, slots=True)
class Classes:
    """Classes predicted for every vertex.

    Attributes
    ----------
    predicted : (n_vertices,) int64
        By the model, for labelled vertices too.
    confidence : (n_vertices,) float64
        Probability that the model gives to the predicted class.
    """

    predicted: IntArray
    confidence: FloatArray


@dataclass(frozen=True, slots=True)
class Validation:
    """How well classes are predicted where the model has seen nothing.

    Attributes
    ----------
    classes : tuple of int
        In the order of rows and columns of the confusion matrix.
    confusion : (n_classes, n_classes) int64
        True class by row, predicted one by column.
    """

    classes: tuple[int, ...]
    confusion: IntArray

    @property
    def accuracy(self) -> float:
        """Share of the vertices that are predicted right."""
        return float(np.trace(self.confusion) / max(self.confusion.sum(), 1))

    @property
    def recall(self) -> dict[int, float]:
        """Share of each class that is found; 0 of a class that nothing has."""
        right, there = np.diag(self.confusion), self.confusion.sum(axis=1)
        return {
            name: float(n / max(total, 1))
            for name, n, total in zip(self.classes, right, there, strict=True)
        }

    @property
    def f1(self) -> dict[int, float]:
        """Harmonic mean of precision and recall, by class; 0 where nothing is right."""
        right = np.diag(self.confusion)
        both = self.confusion.sum(axis=0) + self.confusion.sum(axis=1)
        return {
            name: float(2 * n / max(total, 1))
            for name, n, total in zip(self.classes, right, both, strict=True)
        }

    def as_dict(self) -> dict[str, Any]:
        """Return the figures as JSON-able values."""
        return {
            "accuracy": self.accuracy,
            "f1": {str(name): value for name, value in self.f1.items()},
            "recall": {str(name): value for name, value in self.recall.items()},
            "classes": list(self.classes),
            "confusion": self.confusion.tolist(),
        }


def learn_classes(
    features: Signature, labels: IntArray, seed: int = 0, progress: Progress | None = None
) -> Classes:
    """Return the class of every vertex, learned from those that have a label.

    Parameters
    ----------
    features : Signature
        From `wavelet_core.features.signature.scale_features`, alone or joined to others.
    labels : (n_vertices,) int64
        Below 0: not known.
    seed : int
        Of the sample that is learned from.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        Fewer than two classes among the labels.
    MissingDependencyError
        Without scikit-learn.

    Notes
    -----
    Gradient-boosted trees over binned features, each class having the same weight however rare
    it is.
    """
    require_sklearn()
    known = np.flatnonzero(labels >= 0)
    if len(np.unique(labels[known])) < 2:
        raise OptionError(
            f"the labels name {len(np.unique(labels[known]))} class; learning needs vertices of "
            "at least two."
        )
    grown = GROWN_AS / (GROWN_AS + len(labels))
    with few_threads(half_of_the_cores()):
        model = _fitted_trees(features.values, labels, known, seed, part_of(progress, 0.0, grown))
        probabilities = np.concatenate(
            [
                model.predict_proba(features.values[rows])
                for rows in blocks_of(len(labels), part_of(progress, grown, 1.0))
            ]
        )
    report(progress, 1.0)
    best = probabilities.argmax(axis=1)
    return Classes(model.classes[best], probabilities.max(axis=1))


def validate_classes(
    features: Signature,
    labels: IntArray,
    folds: IntArray,
    seed: int = 0,
    progress: Progress | None = None,
) -> Validation:
    """Return how well each fold's classes are predicted from all the others.

    Parameters
    ----------
    features, labels, seed, progress
        As for `learn_classes`.
    folds : (n_vertices,) int64
        From `spatial_folds`, so that what is predicted is not beside what was learned.

    Raises
    ------
    OptionError
        No fold can be predicted, since the others do not hold two classes.
    """
    require_sklearn()
    known = labels >= 0
    classes = np.unique(labels[known])
    confusion = np.zeros((len(classes), len(classes)), dtype=np.int64)
    with few_threads(half_of_the_cores()):
        present = np.unique(folds[known])
        for k, fold in enumerate(present):
            part = part_of(progress, k / len(present), (k + 1) / len(present))
            report(part, 0.0)
            train = np.flatnonzero(known & (folds != fold))
            test = np.flatnonzero(known & (folds == fold))
            if len(np.unique(labels[train])) < 2:
                continue
            model = _fitted_trees(features.values, labels, train, seed, part_of(part, 0.0, 0.7))
            predicted = np.concatenate(
                [
                    model.predict(features.values[test[rows]])
                    for rows in blocks_of(len(test), part_of(part, 0.7, 1.0))
                ]
            )
            rows = np.searchsorted(classes, labels[test])
            np.add.at(confusion, (rows, np.searchsorted(classes, predicted)), 1)
    if confusion.sum() == 0:
        raise OptionError(
            "the labels cannot be validated: without any one block of the map there are fewer "
            "than two classes; label more places."
        )
    return Validation(tuple(int(c) for c in classes), confusion)


def spatial_folds(plan: FloatArray, n_folds: int = 5) -> IntArray:
    """Return the fold of every vertex: blocks of the map, so that folds are apart in space.

    Parameters
    ----------
    plan : (n_vertices, 2) float64
        x and y.
    n_folds : int
        Number of folds.

    Returns
    -------
    (n_vertices,) int64
        The map is cut into 5 × 5 blocks; a fold holds one block of each row and column when
        there are five::

            0 1 2 3 4
            2 3 4 0 1
            4 0 1 2 3
            1 2 3 4 0
            3 4 0 1 2
    """
    low = plan.min(axis=0)
    extent = np.maximum(np.ptp(plan, axis=0), 1e-12)
    cell = np.minimum(
        (BLOCKS_PER_SIDE * (plan - low) / extent).astype(np.int64), BLOCKS_PER_SIDE - 1
    )
    return (cell[:, 0] + 2 * cell[:, 1]) % n_folds


def _fitted_trees(
    values: NDArray[np.float32],
    labels: IntArray,
    known: IntArray,
    seed: int,
    progress: Progress | None = None,
) -> _Trees:
    """Return boosted trees; grown a few at a time, so that ``progress`` may stop them."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    generator = np.random.default_rng(seed)
    chosen = []
    for name in np.unique(labels[known]):
        of_class = known[labels[known] == name]
        chosen.append(of_class[sample_of(len(of_class), MAX_PER_CLASS, generator)])
    rows = np.sort(np.concatenate(chosen))
    levels = np.linspace(0, 1, N_BINS + 1)[1:-1]
    thresholds = [np.unique(column) for column in np.quantile(values[rows], levels, axis=0).T]
    binned = _binned(values[rows], thresholds)
    # What "balanced" stands for: trees that are grown on do not take the word.
    classes, numbers = np.unique(labels[rows], return_inverse=True)
    weights = dict(enumerate((len(rows) / (len(classes) * np.bincount(numbers))).tolist()))
    model = HistGradientBoostingClassifier(
        max_iter=N_TREES_AT_ONCE,
        class_weight=weights,
        early_stopping=False,
        random_state=seed,
        warm_start=True,
    )
    for n_trees in range(N_TREES_AT_ONCE, N_TREES + 1, N_TREES_AT_ONCE):
        report(progress, (n_trees - N_TREES_AT_ONCE) / N_TREES)
        model.set_params(max_iter=n_trees)
        model.fit(binned, numbers)
    return _Trees(classes, thresholds, model)


class _Trees(NamedTuple):
    """Boosted trees over features that are binned first.

    scikit-learn takes weighted quantiles, one after the other and anew at each call: 12 s for
    forty features. It leaves numbers of few values as they are.
    """

    classes: IntArray
    thresholds: list[NDArray[np.float32]]
    model: Any

    def predict(self, values: NDArray[np.float32]) -> IntArray:
        predicted = self.model.predict(_binned(values, self.thresholds)).astype(np.int64)
        return self.classes[predicted]

    def predict_proba(self, values: NDArray[np.float32]) -> FloatArray:
        probabilities: FloatArray = self.model.predict_proba(_binned(values, self.thresholds))
        return probabilities


def _binned(
    values: NDArray[np.float32], thresholds: list[NDArray[np.float32]]
) -> NDArray[np.float32]:
    bins = [np.searchsorted(t, column) for t, column in zip(thresholds, values.T, strict=True)]
    return np.column_stack(bins).astype(np.float32)
