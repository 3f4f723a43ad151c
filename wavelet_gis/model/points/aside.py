"""Points of a cloud that no vertex stands for alone: those set aside, and those of one place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core._table import Table
from wavelet_core.errors import PyramidError
from wavelet_core.mesh.triangulation import Merged, merge_duplicates
from wavelet_gis.model.points.cloud import PointAttribute, PointCloud

__all__ = ["DUPLICATE_RULES", "Aside", "DuplicateRule", "MergedHeights", "merged_points"]


class DuplicateRule(NamedTuple):
    """Which height the points of one place have in common: a row of :data:`DUPLICATE_RULES`.

    name : str, what `wavelet_gis.open` takes
    help : str, one line for lists
    kept : str, the rule of `wavelet_core.mesh.triangulation.merge_duplicates` for which of them
        becomes the vertex, and has its attributes
    height : callable, from the stored Z of all points and the vertex of each to the heights of all
        vertices; None where that is the height of the point kept
    """

    name: str
    help: str
    kept: str
    height: Callable[[NDArray[np.int32], NDArray[np.int64]], NDArray[np.int64]] | None = None


def _mean(z: NDArray[np.int32], vertex: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the means of the stored numbers, rounded to stored numbers."""
    sums = np.bincount(vertex, weights=z.astype(np.float64))
    return np.rint(sums / np.bincount(vertex)).astype(np.int64)


#: The rules for points that share x and y, the default first.
DUPLICATE_RULES = Table(
    "duplicates",
    (
        DuplicateRule("lowest", "that of the lowest point", "lowest"),
        DuplicateRule("highest", "that of the highest point", "highest"),
        DuplicateRule("mean", "their mean", "first", _mean),
        DuplicateRule("first", "that of the first point in the file", "first"),
    ),
)


class Aside(NamedTuple):
    """Points that are carried without being part of the surface: withheld ones and noise.

    rows : (n,) int64
        Of the cloud, ascending.
    columns : tuple of (n,) arrays
        Their X, Y, Z and attributes as stored.
    """

    rows: NDArray[np.int64]
    columns: tuple[NDArray[Any], ...]

    @classmethod
    def of_cloud(cls, cloud: PointCloud) -> Aside:
        """Return the points of a cloud that are set aside."""
        mask = np.zeros(cloud.n_points, bool) if cloud.aside is None else cloud.aside
        rows = np.flatnonzero(mask).astype(np.int64)
        return cls(rows, tuple(column[rows] for column in cloud.columns()))

    def to_arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays of a pyramid file, none where no point is set aside."""
        if len(self.rows) == 0:
            return {}
        columns = {f"source/aside_{k}": column for k, column in enumerate(self.columns)}
        return {"source/aside": self.rows, **columns}

    @classmethod
    def from_arrays(
        cls,
        arrays: dict[str, NDArray[Any]],
        attributes: tuple[PointAttribute, ...],
        n_points: int,
    ) -> Aside:
        """Return what `to_arrays` described; a file without these arrays has no such points.

        Raises
        ------
        PyramidError
            When an array is missing or does not fit the rest.
        """
        dtypes = [np.dtype(np.int32)] * 3 + [a.values.dtype for a in attributes]
        rows = arrays.get("source/aside", np.empty(0, np.int64))
        columns = tuple(
            arrays.get(f"source/aside_{k}", np.empty(0, dtype)) for k, dtype in enumerate(dtypes)
        )
        is_sound = (
            rows.ndim == 1
            and rows.dtype == np.int64
            and bool((np.diff(rows) > 0).all())
            and (len(rows) == 0 or bool(rows[0] >= 0 and rows[-1] < n_points))
            and all(
                column.shape == rows.shape and column.dtype == dtype
                for column, dtype in zip(columns, dtypes, strict=True)
            )
        )
        if not is_sound:
            raise PyramidError(
                "the description of the points is damaged (points set aside); analyse the input "
                "anew."
            )
        return cls(rows, columns)


class MergedHeights(NamedTuple):
    """How far the points that share x and y with others are from the vertex that stands for them.

    rule : str
        The name of a row of `DUPLICATE_RULES`.
    n_points : int
        Points that have no vertex of their own.
    largest, rms : float
        Vertical distance of the points of shared places from their vertex, in the file's unit of
        z; the vertices themselves count where their height is a mean.
    """

    rule: str
    n_points: int
    largest: float
    rms: float


def merged_points(
    vertices: NDArray[np.float64], z: NDArray[np.int32], rule: DuplicateRule
) -> tuple[Merged, NDArray[np.int64]]:
    """Return which points stand for those of their place, and the stored Z of each vertex.

    Parameters
    ----------
    vertices : (n_points, 3) float64
        In the working frame.
    z : (n_points,) int32
        As stored.
    rule : DuplicateRule
        Which point stands for its place, and at which height.
    """
    merged = merge_duplicates(vertices, rule.kept)
    if rule.height is not None:
        return merged, rule.height(z, merged.representative)
    return merged, z[merged.kept].astype(np.int64)
