"""Put a known change into a DEM, and find it again at its scales.

usage: python examples/change_by_scale.py DEM.tif PICTURE.png

A mound of 20 m that is 24 cells wide at half its height and, elsewhere, a square of 80 cells with a
rough surface of 3 m are added to a DEM; `wavelet_gis.change_by_scale` is given the two DEMs only.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
import numpy as np
import rasterio

import wavelet_gis as wg

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.colors import LightSource

MOUND_HEIGHT, MOUND_SIGMA = 20.0, 10.0  # m and cells
FIELD_ROUGHNESS, FIELD_SIDE = 3.0, 80  # m and cells


def changes(shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the mound and the rough field, each over all cells."""
    row, column = np.mgrid[: shape[0], : shape[1]]
    away = np.hypot(row - 0.3 * shape[0], column - 0.3 * shape[1])
    mound = MOUND_HEIGHT * np.exp(-0.5 * (away / MOUND_SIGMA) ** 2)
    first_row, first_column = (int(0.6 * n) for n in shape)
    place = np.s_[first_row : first_row + FIELD_SIDE, first_column : first_column + FIELD_SIDE]
    field = np.zeros(shape)
    rng = np.random.default_rng(0)
    field[place] = FIELD_ROUGHNESS * rng.standard_normal((FIELD_SIDE, FIELD_SIDE))
    return mound, field


def rms(values: np.ndarray) -> float:
    """Return a root mean square."""
    return float(np.sqrt((values**2).mean()))


def draw(dem: str, picture: str) -> dict[str, float]:
    """Write the picture, print how much of each change was found, and return it."""
    with rasterio.open(dem) as dataset:
        z, profile = dataset.read(1).astype(np.float32), dataset.profile
    mound, field = changes(z.shape)
    profile.update(dtype="float32", nodata=None)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "later.tif"
        with rasterio.open(path, "w", **profile) as dataset:
            dataset.write((z + mound + field).astype(np.float32), 1)
        later = wg.analyse(wg.open(path), levels=16, partition="random", prediction="plane")
        change = wg.change_by_scale(later, dem)
    bands = change.raster().values[1:]
    for band in change.bands:
        print(f"spacing {band.spacing:6.0f} m: RMS {band.rms:.3f} m, highest {band.highest:.2f} m")
    fine = sum(bands[-2:])
    coarse = sum(bands[:-2])
    is_mound, is_field = mound > 0.05 * MOUND_HEIGHT, field != 0
    found = {
        "share of the mound's volume in the coarse bands": coarse[is_mound].sum()
        / mound[is_mound].sum(),
        "RMS of the fine bands at the mound": rms(fine[is_mound]),
        "RMS of the fine bands in the field": rms(fine[is_field]),
        "RMS of the coarse bands in the field": rms(coarse[is_field]),
    }
    for what, value in found.items():
        print(f"{what}: {value:.3f}")
    rows = [("change", mound + field), ("coarse bands", coarse), ("two finest bands", fine)]
    shade = LightSource(azdeg=315, altdeg=45).hillshade(z, vert_exag=0.02)
    figure, axes = pyplot.subplots(1, 3, figsize=(11, 3.3), layout="constrained")
    for axis, (title, values) in zip(axes, rows, strict=True):
        axis.imshow(shade, cmap="gray", vmin=-0.4, vmax=1.1)
        image = axis.imshow(values, cmap="RdBu_r", vmin=-8, vmax=8, alpha=0.75)
        axis.set(xticks=[], yticks=[])
        axis.set_title(title, loc="left", fontsize=12)
    figure.colorbar(image, ax=axes, label="risen, m")
    figure.savefig(picture, dpi=80)
    return found


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    draw(*sys.argv[1:])
