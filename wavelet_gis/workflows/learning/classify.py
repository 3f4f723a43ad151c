"""Clusters of vertices by their scale signature, and classes learned from labelled ones.

Classes need scikit-learn, which is imported when it is used. Arrays in, arrays out.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from wavelet_core._table import Table
from wavelet_core.errors import MissingDependencyError, OptionError
from wavelet_core.features.signature import Signature
from wavelet_core.lifting.spacings import level_spacings
from wavelet_core.progress import Progress, part_of, report
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.vertex_tables import energy_columns
from wavelet_gis.workflows.learning.means import fit_means, fit_mixture

__all__ = [
    "CLUSTERINGS",
    "NOT_KNOWN",
    "Classes",
    "Clustering",
    "Clusters",
    "Validation",
    "cluster_summary",
    "cluster_vertices",
    "learn_classes",
    "merge_labels",
    "spatial_folds",
    "validate_classes",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Label of vertices whose class is not known.
NOT_KNOWN = -1

#: Vertices that clusters are found in; all others are then assigned to the nearest.
MAX_FITTED = 50_000

#: Numbers of clusters that are tried when none is given.
TRIED_COUNTS = tuple(range(1, 11))

#: Labelled vertices that a class is learned from, at most.
MAX_PER_CLASS = 8_000

#: Bins of a feature.
N_BINS = 255

#: Trees that are grown, and those between two looks at whether to stop.
N_TREES, N_TREES_AT_ONCE = 80, 8

#: Vertices that are predicted between two looks at whether to stop.
PREDICTED_AT_ONCE = 50_000

#: Blocks in each direction by which validation is split; see `spatial_folds`.
BLOCKS_PER_SIDE = 5


@dataclass(frozen=True, slots=True)
class Clusters:
    """Vertices grouped by scale signature.

    Attributes
    ----------
    labels : (n_vertices,) int64
        0 is the cluster with the least energy, the last that with the most.
    confidence : (n_vertices,) float64
        How clearly a vertex belongs to its cluster: the posterior of a mixture; of k-means one
        less the ratio of the distances to the nearest and the second nearest centre.
    explained : dict of int to float
        Share of the variance that each tried number of clusters explains; empty when the number
        was given.
    """

    labels: IntArray
    confidence: FloatArray
    explained: dict[int, float]

    @property
    def n_clusters(self) -> int:
        """Number of clusters."""
        return int(self.labels.max(initial=-1)) + 1


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


def cluster_vertices(
    signature: Signature,
    count: int | None = None,
    method: str | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Clusters:
    """Return clusters of vertices with alike signatures.

    Parameters
    ----------
    signature : Signature
        From `wavelet_core.features.signature.energy_signature`.
    count : int, optional
        Number of clusters; by default the knee of the variance that 1 to 10 clusters explain.
    method : str, optional
        A row of `CLUSTERINGS`, by default its first. Columns have unit variance.
    seed : int
        Of the sample that is fitted and of the starts; the same seed gives the same clusters.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        A number of clusters below 1 or above the number of vertices, or another method.

    Notes
    -----
    The knee is where the curve of the explained variance over the number of clusters is farthest
    above its chord: what a further cluster explains falls off from there. *Our choice:* terrain
    is a continuum, and measures of separation (the mean silhouette) chose two clusters, rough and
    smooth, on all of three DEMs that were tried.
    """
    row = CLUSTERINGS.chosen(method)
    n_vertices = len(signature.values)
    if count is not None and not 1 <= count <= min(n_vertices, 254):
        raise OptionError(
            f"count is {count}; give 1 to {min(n_vertices, 254)} clusters for {n_vertices} "
            "vertices."
        )
    columns = _standardised(signature.values)
    generator = np.random.default_rng(seed)
    sample = _sample(n_vertices, MAX_FITTED, generator)
    fitted = columns[sample]
    explained: dict[int, float] = {}
    if count is None:
        explained = _explained(fitted, seed, part_of(progress, 0.0, 0.7))
        count = _knee(explained)
    model = row.fit(fitted, count, seed, part_of(progress, 0.7, 0.8))
    parts = [
        model.assign(columns[rows]) for rows in _blocks(n_vertices, part_of(progress, 0.8, 1.0))
    ]
    labels, confidence = (np.concatenate(part) for part in zip(*parts, strict=True))
    report(progress, 1.0)
    # Models number their clusters at will; energy gives an order that people can read.
    energy = [signature.values[labels == k].mean() if (labels == k).any() else -np.inf
              for k in range(count)]  # fmt: skip
    rank = np.empty(count, dtype=np.int64)
    rank[np.argsort(energy, kind="stable")] = np.arange(count)
    return Clusters(rank[labels], confidence, explained)


def cluster_summary(
    geo: GeoPyramid, labels: IntArray, channel: str | None = None
) -> dict[str, Any]:
    """Return size and spectrum of every cluster, or of every class.

    Parameters
    ----------
    geo : GeoPyramid
        Whose vertices are labelled.
    labels : (n_vertices,) int64
        Those below 0 are left out.
    channel : str, optional
        Of the spectrum; by default the geometry.

    Returns
    -------
    dict
        ``spacings``: of the levels' details, the coarsest first; ``clusters``: for each label
        ``n_vertices``, ``share`` and ``rms``, the root mean square detail of each level in the
        unit of the input, and ``relative``, that over the one of all vertices.
    """
    squared = energy_columns(geo, channel) ** 2
    overall = np.sqrt(squared.mean(axis=0))
    rows = []
    for label in np.unique(labels[labels >= 0]):
        inside = labels == label
        rms = np.sqrt(squared[inside].mean(axis=0))
        relative = np.divide(rms, overall, out=np.ones_like(rms), where=overall > 0)
        rows.append(
            {
                "label": int(label),
                "n_vertices": int(inside.sum()),
                "share": float(inside.mean()),
                "rms": rms.tolist(),
                "relative": relative.tolist(),
            }
        )
    return {"spacings": level_spacings(geo.pyramid)[1:].tolist(), "clusters": rows}


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
    _require_sklearn()
    known = np.flatnonzero(labels >= 0)
    if len(np.unique(labels[known])) < 2:
        raise OptionError(
            f"the labels name {len(np.unique(labels[known]))} class; learning needs vertices of "
            "at least two."
        )
    with _few_threads(_half_of_the_cores()):
        model = _fitted_trees(features.values, labels, known, seed, part_of(progress, 0.0, 0.6))
        probabilities = np.concatenate(
            [
                model.predict_proba(features.values[rows])
                for rows in _blocks(len(labels), part_of(progress, 0.6, 1.0))
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
    _require_sklearn()
    known = labels >= 0
    classes = np.unique(labels[known])
    confusion = np.zeros((len(classes), len(classes)), dtype=np.int64)
    with _few_threads(_half_of_the_cores()):
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
                    for rows in _blocks(len(test), part_of(part, 0.7, 1.0))
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


def _standardised(values: NDArray[np.float32]) -> FloatArray:
    columns = values.astype(np.float64)
    deviation = columns.std(axis=0)
    return (columns - columns.mean(axis=0)) / np.where(deviation > 0, deviation, 1.0)


def _sample(n_items: int, n_wanted: int, generator: np.random.Generator) -> IntArray:
    if n_items <= n_wanted:
        return np.arange(n_items)
    return np.sort(generator.choice(n_items, n_wanted, replace=False))


def _blocks(n_items: int, progress: Progress | None) -> Iterator[slice]:
    """Yield the rows of each block that is predicted at once; ``progress`` may stop it."""
    for first in range(0, max(n_items, 1), PREDICTED_AT_ONCE):
        report(progress, first / max(n_items, 1))
        yield slice(first, min(first + PREDICTED_AT_ONCE, n_items))


def _explained(
    columns: FloatArray, seed: int, progress: Progress | None = None
) -> dict[int, float]:
    total = float(((columns - columns.mean(axis=0)) ** 2).sum())
    if total <= 0:
        return {1: 1.0}
    counts = [count for count in TRIED_COUNTS if count <= len(columns)]
    shares = {}
    for k, count in enumerate(counts):
        part = part_of(progress, k / len(counts), (k + 1) / len(counts))
        shares[count] = 1 - fit_means(columns, count, seed, part).inertia / total
    return shares


def _knee(explained: dict[int, float]) -> int:
    """Return the number whose point is farthest above the chord of the curve."""
    counts = np.array(list(explained))
    shares = np.array(list(explained.values()))
    if len(counts) < 3:
        return int(counts[-1])
    chord = np.interp(counts, counts[[0, -1]], shares[[0, -1]])
    return int(counts[np.argmax(shares - chord)])


class Assigns(Protocol):
    """What a clustering comes to."""

    def assign(self, columns: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the cluster of each row, and how clearly it belongs there."""


class Clustering(NamedTuple):
    """One way to find clusters: a row of :data:`CLUSTERINGS`.

    name : str, what `cluster_vertices` takes
    help : str, one line for lists
    fit : callable, from columns, a number of clusters, a seed and progress to a model
    """

    name: str
    help: str
    fit: Callable[[FloatArray, int, int, Progress | None], Assigns]


#: The methods of clustering, the default first.
CLUSTERINGS = Table(
    "method",
    (
        Clustering("kmeans", "the nearest of k means", fit_means),
        Clustering(
            "mixture", "a mixture of Gaussians, which may differ in size and shape", fit_mixture
        ),
    ),
)


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
        chosen.append(of_class[_sample(len(of_class), MAX_PER_CLASS, generator)])
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


@contextmanager
def _few_threads(at_most: int) -> Iterator[None]:
    """Keep scikit-learn's threads from waiting for each other.

    With as many OpenMP threads as cores, boosting took over fifty times as long on a machine
    with other work to do, since its threads spin while they wait. Only libraries that are loaded
    already can be told.
    """
    import sklearn.ensemble  # noqa: F401
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=at_most):
        yield


def _half_of_the_cores() -> int:
    return max((os.cpu_count() or 2) // 2, 1)


def _require_sklearn() -> None:
    try:
        import sklearn  # noqa: F401
    except ImportError as error:
        raise MissingDependencyError(
            "learning classes needs scikit-learn; install it with 'pip install scikit-learn'."
        ) from error


def merge_labels(labels: IntArray, merges: Sequence[tuple[int, int]]) -> IntArray:
    """Return labels with some classes counted as another.

    Parameters
    ----------
    labels : (n_vertices,) int64
        Classes.
    merges : sequence of (from, to)
        Each is applied to the labels as they came; to below 0 is not known.

    Examples
    --------
    >>> merge_labels(np.array([2, 3, 4, 5]), [(3, 5), (4, 5)]).tolist()
    [2, 5, 5, 5]
    """
    merged = labels.copy()
    for source, target in merges:
        merged[labels == source] = target
    return merged
