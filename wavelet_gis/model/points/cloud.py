"""A point cloud as arrays: the points of a LAS file as they came.

Nothing here opens a file: `wavelet_gis.io.las` does so with laspy. How the points become a mesh
and the mesh the points again is the matter of `wavelet_gis.model.points.origin`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["PointAttribute", "PointCloud", "cloud_bounds"]


@dataclass(frozen=True, slots=True)
class PointAttribute:
    """One dimension of a LAS file that is lifted along with the elevation.

    Attributes
    ----------
    name : str
        Name of the channel.
    dimension : str
        The LAS dimension it comes from.
    component : int or None
        Which of the values of an array-valued extra dimension.
    scale, offset : float
        The attribute is ``value * scale + offset``.
    values : (n_points,) of the dimension's own type
        The stored numbers.
    """

    name: str
    dimension: str
    values: NDArray[Any]
    component: int | None = None
    scale: float = 1.0
    offset: float = 0.0

    def lifted(self) -> NDArray[np.float64]:
        """Return the attribute as float64."""
        values = self.values.astype(np.float64)
        if self.scale != 1.0 or self.offset != 0.0:
            values = values * self.scale + self.offset
        return values


@dataclass(frozen=True, slots=True)
class PointCloud:
    """The chosen points of a LAS file, as they came.

    Attributes
    ----------
    integers : (n_points, 3) int32
        X, Y, Z as stored.
    scales, offsets : (3,) float64
        A coordinate is ``integer * scale + offset``.
    attributes : tuple of PointAttribute
        What is lifted.
    carried : dict of str to (n_points, ...) arrays
        The other fields of the point records, to be given back untouched.
    header, evlrs : (n_bytes,) uint8
        The file up to its first point, and what is kept of what follows the last: extended VLRs,
        waveform packets, bytes that nothing describes.
    evlrs_at : int or None
        Offset that `evlrs` had in the file; None where it begins with the first extended VLR.
    n_in_file : int
        Points in the file; more than n_points when a class filter chose some.
    classes : tuple of int or None
        The class filter.
    aside : (n_points,) bool, or None
        Points that are carried without being part of the surface: withheld ones and noise.
    is_altered : bool
        Whether this is the outcome of a filter, whose extent is no longer the file's.
    """

    integers: NDArray[np.int32]
    scales: NDArray[np.float64]
    offsets: NDArray[np.float64]
    attributes: tuple[PointAttribute, ...] = ()
    carried: dict[str, NDArray[Any]] = field(default_factory=dict)
    header: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    evlrs: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    n_in_file: int = 0
    classes: tuple[int, ...] | None = None
    aside: NDArray[np.bool_] | None = None
    evlrs_at: int | None = None
    is_altered: bool = False

    @property
    def n_points(self) -> int:
        """Number of chosen points."""
        return len(self.integers)

    @property
    def n_used(self) -> int:
        """Number of points that are part of the surface."""
        return self.n_points - (0 if self.aside is None else int(np.count_nonzero(self.aside)))

    def coordinates(self) -> NDArray[np.float64]:
        """Return x, y, z of the points in the file's units, ``(n_points, 3)``."""
        return self.integers * self.scales + self.offsets

    def subset(self, rows: NDArray[np.int64]) -> PointCloud:
        """Return the cloud of some of its points, each as it came, in the order of the file.

        Parameters
        ----------
        rows : (n,) int64
            Which points.
        """
        rows = np.sort(rows)
        return replace(
            self,
            integers=self.integers[rows],
            attributes=tuple(replace(a, values=a.values[rows]) for a in self.attributes),
            carried={name: values[rows] for name, values in self.carried.items()},
            aside=None,
            is_altered=True,
        )

    def columns(self) -> list[NDArray[Any]]:
        """Return what must come back exactly: X, Y, Z and the attributes as stored."""
        return [
            *(np.ascontiguousarray(self.integers[:, k]) for k in range(3)),
            *(attribute.values for attribute in self.attributes),
        ]


def cloud_bounds(cloud: PointCloud) -> tuple[float, float, float, float]:
    """Return x_min, y_min, x_max, y_max of the points that are part of the surface."""
    integers = cloud.integers if cloud.aside is None else cloud.integers[~cloud.aside]
    low = integers.min(axis=0) * cloud.scales + cloud.offsets
    high = integers.max(axis=0) * cloud.scales + cloud.offsets
    low, high = np.minimum(low, high), np.maximum(low, high)  # a scale may be negative
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])
