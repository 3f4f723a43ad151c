"""The clouds of Figs. 5-7: geometry, class (or intensity and colour) and height above ground."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import laspy
import numpy as np
from scipy import ndimage
from scipy.interpolate import RegularGridInterpolator

from wavelet_core import TriangleMesh
from wavelet_gis.workflows.open import open_terrain


@dataclass(frozen=True)
class Sample:
    """One cloud, the figure that it stands in for, and what was done to it."""

    name: str
    figure: str
    mesh: TriangleMesh
    note: str


def classed(path: Path, figure: str) -> Sample:
    """Return a cloud with class and height above ground."""
    mesh = open_terrain(path, attributes=("classification", "hag"), carry=False).mesh
    return Sample(path.stem, figure, mesh, "class, hag")


def autzen(name: str, path: Path, figure: str, n_points: int, share: float) -> Sample:
    """Return Autzen with intensity, colour and a height above a ground found here.

    Parameters
    ----------
    name : str
        Of the sample.
    path : Path
    figure : str
    n_points : int
        Most points to keep, taken at random with a fixed seed.
    share : float
        Share of the points to keep before, cut along y, so that 1 is all of it.
    """
    las = laspy.read(path)
    points = np.column_stack([las.x, las.y, las.z])
    colour = [np.asarray(getattr(las, name), float) for name in ("red", "green", "blue")]
    height = height_above_lows(points)
    attributes = np.column_stack([np.asarray(las.intensity, float), *colour, height])
    cut = np.flatnonzero(points[:, 1] <= np.quantile(points[:, 1], share))
    rows = cut
    note = f"intensity, RGB, hag; {len(cut):,} points"
    if len(cut) > n_points:
        rows = np.sort(np.random.default_rng(0).choice(cut, n_points, replace=False))
        note += f", thinned at random to {n_points:,}"
    mesh = TriangleMesh.from_points(
        points[rows], attributes[rows], ("intensity", "red", "green", "blue", "hag")
    )
    return Sample(name, figure, mesh, note)


def height_above_lows(points: np.ndarray, cell: float = 10.0, widest: float = 200.0) -> np.ndarray:
    """Return heights above the lowest points of a grid after a grey opening (unit of x and y).

    A plain ground filter for a cloud without classes: the window is wider than the widest
    building. On slopes it counts some ground as raised.
    """
    index = ((points[:, :2] - points[:, :2].min(axis=0)) // cell).astype(int)
    shape = tuple(index.max(axis=0) + 1)
    low = np.full(shape, np.inf)
    np.minimum.at(low, tuple(index.T), points[:, 2])
    empty = ~np.isfinite(low)
    nearest = ndimage.distance_transform_edt(empty, return_distances=False, return_indices=True)
    low = low[tuple(nearest)]
    opened = ndimage.grey_opening(low, size=int(widest / cell), mode="nearest")
    opened = ndimage.gaussian_filter(opened, 2, mode="nearest")
    centres = [(np.arange(n) + 0.5) * cell for n in shape]
    surface = RegularGridInterpolator(centres, opened, bounds_error=False, fill_value=None)
    return points[:, 2] - surface(points[:, :2] - points[:, :2].min(axis=0))
