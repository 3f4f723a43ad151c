"""The viewer of levels on a part of the DEM that comes with matplotlib."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.cbook import get_sample_data

import wavelet_gis as wg
from wavelet_core import TriangleMesh
from wavelet_gis.report.level_viewer import level_viewer

#: Metres between its cells, at 36.5 degrees north.
EAST, NORTH = 74.5, 92.5


def write_viewer(path: Path) -> None:
    """Analyse a part of the Jacksboro DEM and write its page."""
    with get_sample_data("jacksboro_fault_dem.npz") as sample:
        elevation = sample["elevation"][100:270, 150:350].astype(float)
    n_rows, n_columns = elevation.shape
    mesh = TriangleMesh.from_grid(
        elevation, x=EAST * np.arange(n_columns), y=NORTH * np.arange(n_rows)[::-1]
    )
    analysis = wg.analyse(wg.open(mesh, crs="EPSG:32616"))
    geo = replace(analysis.geo, source_name="Jacksboro, a part")
    path.parent.mkdir(exist_ok=True)
    path.write_text(level_viewer(geo)[0], encoding="utf-8")
