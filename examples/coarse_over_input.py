"""Draw a coarse TIN, read back from its GeoPackage, over the hillshade of its input.

usage: python examples/coarse_over_input.py DEM.tif PICTURE.png [VERTICES]

`terrain-wavelets simplify` writes the TIN; the picture places input and triangles by their own
georeference, so that a shift or a turn would show.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
import pyogrio
import rasterio
import shapely

from wavelet_gis.cli.main import main

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.collections import PolyCollection
from matplotlib.colors import LightSource

METRES_A_DEGREE = 111_320.0
SUN = LightSource(azdeg=315, altdeg=45)


def draw(dem: str, picture: str, n_vertices: int) -> None:
    """Write the picture."""
    with tempfile.TemporaryDirectory() as folder:
        tin = Path(folder) / "tin.gpkg"
        code = main(["simplify", dem, str(tin), "--vertices", str(n_vertices)])
        if code:
            raise SystemExit(code)
        frame = pyogrio.raw.read(tin, layer=str(pyogrio.list_layers(tin)[0, 0]))
    polygons = shapely.from_wkb(frame[2])
    triangles = np.array([shapely.get_coordinates(p, include_z=True)[:3] for p in polygons])
    with rasterio.open(dem) as dataset:
        z = dataset.read(1).astype(float)
        bounds, is_geographic = dataset.bounds, dataset.crs.is_geographic
    extent = (bounds.left, bounds.right, bounds.bottom, bounds.top)
    scale = np.ones(2)
    if is_geographic:
        latitude = np.radians((bounds.bottom + bounds.top) / 2)
        scale = METRES_A_DEGREE * np.array([np.cos(latitude), 1.0])
    cell = scale * [
        (bounds.right - bounds.left) / z.shape[1],
        (bounds.top - bounds.bottom) / z.shape[0],
    ]
    metric = triangles * [*scale, 1.0]
    normals = np.cross(metric[:, 1] - metric[:, 0], metric[:, 2] - metric[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals *= np.sign(normals[:, 2:])
    shade = np.clip(normals @ SUN.direction, 0, 1)

    figure, axes = pyplot.subplots(1, 3, figsize=(13, 4.7), layout="constrained")
    titles = ("Input", "Coarse TIN, over the input", "Coarse TIN, its own hillshade")
    for column, (axis, title) in enumerate(zip(axes, titles, strict=True)):
        axis.imshow(
            SUN.hillshade(z, dx=cell[0], dy=cell[1]), cmap="gray", extent=extent, vmin=0, vmax=1
        )
        if column == 1:
            faces = PolyCollection(triangles[:, :, :2], facecolors="none", edgecolors="#d1495b")
            faces.set_linewidth(0.45)
            axis.add_collection(faces)
        if column == 2:
            colours = pyplot.get_cmap("gray")(shade)
            axis.add_collection(
                PolyCollection(triangles[:, :, :2], facecolors=colours, edgecolors=colours, lw=0.2)
            )
        axis.set_aspect(scale[1] / scale[0])
        axis.set_title(title, loc="left", fontsize=11, fontweight="bold")
        axis.tick_params(labelsize=8)
        axis.ticklabel_format(useOffset=False)
    figure.savefig(picture, dpi=80)


if __name__ == "__main__":
    draw(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 3000)
