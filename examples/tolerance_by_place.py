"""Draw a TIN whose accuracy differs from place to place: a valley road, a field, and the hills.

usage: python examples/tolerance_by_place.py DEM.tif PICTURE.png STRICT FIELD ELSEWHERE

The zones are a corridor across the DEM and a half of it, written as a GeoPackage, from where
`simplify` reads them. The same is then taken out of a stored pyramid.
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

import wavelet_gis as wg

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.collections import PolyCollection
from matplotlib.colors import LightSource

COLOURS = ("#c2410c", "#1d4ed8", "#57534e")


def zones_of(dem: str, strict: float, field: float, path: Path) -> list[shapely.Geometry]:
    """Write the two zones, and return them."""
    with rasterio.open(dem) as dataset:
        bounds, crs = dataset.bounds, dataset.crs
    width, height = bounds.right - bounds.left, bounds.top - bounds.bottom
    corners = [(0.02, 0.15), (0.3, 0.35), (0.55, 0.62), (0.98, 0.8)]
    places = [(bounds.left + u * width, bounds.bottom + v * height) for u, v in corners]
    corridor = shapely.LineString(places).buffer(0.025 * width)
    half = shapely.Polygon([(bounds.left, bounds.bottom), *places, (bounds.right, bounds.bottom)])
    shapes = [corridor, half]
    pyogrio.raw.write(
        path, shapely.to_wkb(np.array(shapes)), [np.array([strict, field])], ["max_error"],
        geometry_type="Polygon", crs=crs.to_wkt(), layer="zones",
    )  # fmt: skip
    return shapes


def draw(dem: str, picture: str, strict: float, field: float, elsewhere: float) -> None:
    """Write the picture, and print what came out in each zone."""
    terrain = wg.open(dem)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "zones.gpkg"
        shapes = zones_of(dem, strict, field, path)
        tin = wg.simplify(terrain, max_error=elsewhere, zones=path)
        wg.save(wg.analyse(terrain), Path(folder) / "pyramid.gpkg")
        stored = wg.load(Path(folder) / "pyramid.gpkg")
        taken = wg.extract(stored, max_error=elsewhere, zones=path, refine=None)
    for name, surface in (("simplified", tin), ("out of a stored pyramid", taken)):
        print(f"{name}: {surface.mesh.n_vertices:,} vertices")
        for zone in surface.zones:
            print(
                f"  within {zone.most:g}: {zone.n_points:,} cells, {zone.n_vertices:,} vertices, "
                f"RMSE {zone.rmse:.3g}, largest error {zone.max_error:.4g}"
            )
    mesh = tin.file_mesh
    triangles = mesh.vertices[mesh.faces][:, :, :2]
    centres = shapely.points(triangles.mean(axis=1))
    of_zone = np.full(len(triangles), 2)
    for number in (1, 0):
        of_zone[shapely.contains(shapes[number], centres)] = number
    with rasterio.open(dem) as dataset:
        z, bounds = dataset.read(1).astype(float), dataset.bounds
    extent = (bounds.left, bounds.right, bounds.bottom, bounds.top)
    shade = LightSource(azdeg=315, altdeg=45).hillshade(z, vert_exag=0.02)
    figure, axes = pyplot.subplots(figsize=(8.6, 7.4), layout="constrained")
    axes.imshow(shade, cmap="gray", extent=extent, vmin=-0.4, vmax=1.1, aspect="auto")
    names = ("corridor", "field", "elsewhere")
    for number, zone in enumerate(tin.zones):
        label = (
            f"{names[number]}: within {zone.most:g} m; {zone.n_vertices:,} of {zone.n_points:,} "
            f"cells, largest error {zone.max_error:.1f} m"
        )
        edges = PolyCollection(
            triangles[of_zone == number],
            facecolor="none",
            edgecolor=COLOURS[number],
            linewidth=0.35,
            label=label,
        )
        axes.add_collection(edges)
    axes.set(xlim=extent[:2], ylim=extent[2:], xticks=[], yticks=[])
    axes.set_title("One TIN, three tolerances", loc="left", fontsize=13, weight="bold")
    legend = axes.legend(loc="lower left", fontsize=9, framealpha=0.95)
    for line in legend.get_patches():
        line.set_linewidth(2)
    figure.savefig(picture, dpi=80)


if __name__ == "__main__":
    if len(sys.argv) != 6:
        raise SystemExit(__doc__)
    draw(sys.argv[1], sys.argv[2], *map(float, sys.argv[3:]))
