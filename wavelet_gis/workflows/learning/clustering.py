"""Clusters of vertices by their scale signature. Arrays in, arrays out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from wavelet_core._table import Table
from wavelet_core.errors import OptionError
from wavelet_core.features.signature import Signature
from wavelet_core.lifting.spacings import level_spacings
from wavelet_core.progress import Progress, part_of, report
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.vertex_tables import energy_columns
from wavelet_gis.workflows.learning._blocks import FloatArray, IntArray, blocks_of, sample_of
from wavelet_gis.workflows.learning.means import fit_means, fit_mixture

__all__ = ["CLUSTERINGS", "Clustering", "Clusters", "cluster_summary", "cluster_vertices"]

#: Vertices that clusters are found in; all others are then assigned to the nearest.
MAX_FITTED = 50_000

#: Numbers of clusters that are tried when none is given.
TRIED_COUNTS = tuple(range(1, 11))


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
    sample = sample_of(n_vertices, MAX_FITTED, generator)
    fitted = columns[sample]
    explained: dict[int, float] = {}
    if count is None:
        explained = _explained(fitted, seed, part_of(progress, 0.0, 0.7))
        count = _knee(explained)
    model = row.fit(fitted, count, seed, part_of(progress, 0.7, 0.8))
    parts = [
        model.assign(columns[rows]) for rows in blocks_of(n_vertices, part_of(progress, 0.8, 1.0))
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
    geo: GeoPyramid,
    labels: IntArray,
    channel: str | None = None,
    progress: Progress | None = None,
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
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    dict
        ``spacings``: of the levels' details, the coarsest first; ``clusters``: for each label
        ``n_vertices``, ``share`` and ``rms``, the root mean square detail of each level in the
        unit of the input, and ``relative``, that over the one of all vertices.
    """
    squared = energy_columns(geo, channel, part_of(progress, 0.0, 0.5)) ** 2
    overall = np.sqrt(squared.mean(axis=0))
    rows = []
    present = np.unique(labels[labels >= 0])
    for k, label in enumerate(present):
        report(progress, 0.5 + 0.1 * k / len(present))
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
    spacings = level_spacings(geo.pyramid, part_of(progress, 0.6, 1.0))
    return {"spacings": spacings[1:].tolist(), "clusters": rows}


def _standardised(values: NDArray[np.float32]) -> FloatArray:
    columns = values.astype(np.float64)
    deviation = columns.std(axis=0)
    return (columns - columns.mean(axis=0)) / np.where(deviation > 0, deviation, 1.0)


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
