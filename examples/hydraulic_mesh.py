"""Make a mesh for a hydraulic model of a real DEM: a dike, a building, zones, sizes; draw it.

usage: python examples/hydraulic_mesh.py DEM.tif MESH.nc PICTURE.png

Dike, building and zones are drawn where the DEM has a valley in matplotlib's sample of Jacksboro;
on another DEM they lie at the same shares of its width and height.
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
from matplotlib.collections import LineCollection

MIN_ANGLE = 25.0
#: Metres: edges at the building, and anywhere; and how fast they may grow in between.
AT_BUILDING, ANYWHERE, GRADING = 40.0, 1000.0, 0.5


def write(path: Path, shapes: list, crs: str, **fields: list[float]) -> Path:
    """Write shapes as a layer, with fields."""
    pyogrio.raw.write(
        path, shapely.to_wkb(np.array(shapes)), [np.array(v) for v in fields.values()],
        list(fields), geometry_type=shapes[0].geom_type, crs=crs, layer=path.stem,
    )  # fmt: skip
    return path


def main(dem: str, mesh: str, picture: str) -> None:
    """Make mesh and picture; print what a modeller asks for."""
    with rasterio.open(dem) as dataset:
        bounds, crs = dataset.bounds, dataset.crs.to_wkt()
    width, height = bounds.right - bounds.left, bounds.top - bounds.bottom

    def at(*places: tuple[float, float]) -> list[tuple[float, float]]:
        return [(bounds.left + u * width, bounds.bottom + v * height) for u, v in places]

    dike = shapely.LineString(at((0.32, 0.2), (0.42, 0.36), (0.55, 0.45), (0.68, 0.47)))
    building = shapely.Polygon(at((0.5, 0.3), (0.53, 0.3), (0.53, 0.335), (0.5, 0.335)))
    domain = shapely.Polygon(at((0.3, 0.15), (0.7, 0.15), (0.72, 0.55), (0.28, 0.55)))
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        terrain = wg.open(
            dem,
            breaklines=write(here / "dike.gpkg", [dike], crs),
            clip=write(here / "domain.gpkg", [domain.difference(building)], crs),
        )
        zone = dike.buffer(0.03 * width)
        zones = write(here / "zones.gpkg", [zone], crs, max_error=[5.0])
        around = [building.buffer(0.003 * width)]
        sizes = write(here / "sizes.gpkg", around, crs, longest_edge=[AT_BUILDING])
        tin = wg.simplify(terrain, max_error=40.0, zones=zones)
        made = tin.for_solver(
            min_angle=MIN_ANGLE, longest_edge=ANYWHERE, size_zones=sizes, grading=GRADING
        )
    wg.save(made, mesh, overwrite=True)
    for name, one in (("TIN", tin), ("mesh", made)):
        print(f"{name}: {one.mesh.n_vertices:,} nodes, {one.mesh.n_faces:,} triangles")
        for part in one.zones:
            print(f"  within {part.most:g} m: {part.n_vertices:,} vertices of the DEM, "
                  f"RMSE {part.rmse:.2f}, largest error {part.max_error:.2f}")  # fmt: skip
    quality = made.quality
    print(f"angles {quality.smallest_angle:.1f} to {quality.largest_angle:.1f} degrees, edges "
          f"{quality.shortest_edge:.0f} to {quality.longest_edge:.0f} m")  # fmt: skip
    print(f"along dike and outline: largest error {made.along_lines.max_error:.2f} m")

    figure, axes = pyplot.subplots(1, 2, figsize=(12.5, 5.6), layout="constrained")
    for one, ax, title in zip((tin, made), axes, ("TIN", "mesh for the solver"), strict=True):
        in_file = one.file_mesh
        x, y, z = in_file.vertices.T
        image = ax.tripcolor(x, y, in_file.faces, z, shading="gouraud", cmap="terrain")
        ax.triplot(x, y, in_file.faces, color="black", linewidth=0.25, alpha=0.6)
        ax.add_collection(LineCollection([np.array(dike.coords)], colors="#b91c1c", linewidths=1.6))
        ax.set(xticks=[], yticks=[], aspect=1 / np.cos(np.radians(bounds.bottom)))
        ax.set_title(f"{title}: {one.mesh.n_vertices:,} nodes", loc="left", fontsize=12)
    figure.colorbar(image, ax=axes, label="elevation (m)", shrink=0.8)
    figure.savefig(picture, dpi=85)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
