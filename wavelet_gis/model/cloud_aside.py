"""Points of a cloud that no vertex stands for alone: those set aside, and those of one place."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError, PyramidError
from wavelet_core.mesh.triangulation import Merged, merge_duplicates
from wavelet_gis.model.cloud import PointAttribute, PointCloud

__all__ = ["DUPLICATE_RULES", "Aside", "MergedHeights", "merged_points"]

#: Which height the points of one place have in common.
DUPLICATE_RULES = ("lowest", "highest", "mean", "first")


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
        One of `DUPLICATE_RULES`.
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
    vertices: NDArray[np.float64], z: NDArray[np.int32], rule: str
) -> tuple[Merged, NDArray[np.int64]]:
    """Return which points stand for those of their place, and the stored Z of each vertex.

    Parameters
    ----------
    vertices : (n_points, 3) float64
        In the working frame.
    z : (n_points,) int32
        As stored.
    rule : str
        One of `DUPLICATE_RULES`. A mean is that of the stored numbers, rounded to one; the
        attributes are those of the first point.

    Raises
    ------
    OptionError
        There is no such rule.
    """
    if rule not in DUPLICATE_RULES:
        raise OptionError(
            f"duplicates must be one of {', '.join(DUPLICATE_RULES)}, and is {rule!r}."
        )
    merged = merge_duplicates(vertices, "first" if rule == "mean" else rule)
    stored = z[merged.kept].astype(np.int64)
    if rule == "mean":
        counts = np.bincount(merged.representative)
        sums = np.bincount(merged.representative, weights=z.astype(np.float64))
        is_shared = counts > 1
        stored[is_shared] = np.rint(sums[is_shared] / counts[is_shared]).astype(np.int64)
    return merged, stored
