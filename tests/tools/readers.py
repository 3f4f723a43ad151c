"""The readers that `mutate` tries: sound files to damage, and what must come of them.

A reader returns what it read, taken through a pyramid and back; `Kind.is_wrong` tells whether that
is something else than what the file holds. A LAS file holds no checksum over its points, so only
damage before them must not change coordinates without a word; for rasters and layers a second
reading, by the library and without this package, says what the damaged file holds.
"""

from __future__ import annotations

import struct
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np


class Base(NamedTuple):
    """A sound file, and where its points (cells, shapes) begin."""

    name: str
    content: bytes
    head: int


class Kind(NamedTuple):
    """What is tried.

    bases : the sound files, written into a folder
    read : returns what a file holds, taken through the package
    is_wrong : tells from what was read, what the sound file held, the path and whether all damage
        lies in the head, whether something else came back than the file holds
    telling : what a warning must hold to make a wrong result a told one; None where none does
    """

    bases: Callable[[Path], list[Base]]
    read: Callable[[Path], Any]
    is_wrong: Callable[[Any, Any, Path, bool], bool]
    telling: str | None = None


# -- point clouds


def las_bases(folder: Path) -> list[Base]:
    """Return small LAS and LAZ files of every kind."""
    import laspy
    from pyproj import CRS

    bases = []
    for suffix in ("las", "laz"):
        for version, point_format in (("1.2", 3), ("1.3", 1), ("1.4", 6), ("1.4", 7), ("1.4", 1)):
            header = laspy.LasHeader(version=version, point_format=point_format)
            header.scales, header.offsets = [0.01] * 3, [500000.0, 5100000.0, 0.0]
            if version == "1.4":
                header.add_extra_dim(
                    laspy.ExtraBytesParams("range", "i2", scales=[0.5], offsets=[1.0])
                )
            header.add_crs(CRS.from_epsg(25832))
            las = laspy.LasData(header)
            rng = np.random.default_rng(point_format)
            las.x, las.y = 500000 + 90 * rng.random((1, 300))[0], 5100000 + 90 * rng.random(300)
            las.z = 300 + 9 * np.sin(np.asarray(las.x) / 9)
            las.classification = rng.choice([1, 2, 5], 300).astype(np.uint8)
            las.return_number = np.ones(300, np.uint8)
            if version == "1.4":
                las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("me", 5, "", bytes(40))])
            path = folder / f"base_{version}_{point_format}.{suffix}"
            las.write(path)
            content = path.read_bytes()
            head = struct.unpack_from("<I", content, 96)[0]
            bases.append(Base(path.name, content, head))
    return bases


def read_las(path: Path) -> Any:
    """Return the coordinates of a LAS file, taken through the mesh and back."""
    from wavelet_gis.io.las import write_cloud
    from wavelet_gis.workflows.open import open_terrain

    terrain = open_terrain(path)
    write_cloud(path.with_name("back.las"), terrain.original)  # type: ignore[arg-type]
    return terrain.original.coordinates()  # type: ignore[union-attr]


def cloud_is_wrong(found: Any, expected: Any, path: Path, in_head: bool) -> bool:
    """Whether damage before the points has changed coordinates."""
    if not in_head:
        return False
    if found.shape != expected.shape:
        return True
    slack = 0.002 * np.ptp(expected, axis=0) + 0.1
    return not bool((np.abs(found - expected) <= slack).all())


# -- rasters


def tif_bases(folder: Path) -> list[Base]:
    """Return small GeoTIFFs: types, compressions, tiles, masks, scales, byte orders."""
    import rasterio

    rows, columns = np.mgrid[0:20, 0:24]
    hills = 300 + 9 * np.sin(rows / 3) * np.cos(columns / 4)
    utm = rasterio.Affine(10.0, 0.0, 5e5, 0.0, -10.0, 5.1e6)
    degrees = rasterio.Affine(1 / 1200, 0.0, 11.0, 0.0, -1 / 1200, 47.0)
    made: list[tuple[str, dict[str, Any]]] = [
        ("float32", {}),
        ("float64", {"compress": "deflate", "predictor": 3}),
        ("int16", {"compress": "lzw", "predictor": 2, "nodata": -32768}),
        ("uint16", {"tiled": True, "blockxsize": 16, "blockysize": 16, "compress": "zstd"}),
        ("float32", {"nodata": -9999.0, "bigtiff": "YES", "tiled": True, "blockxsize": 16,
                     "blockysize": 16}),
        ("int32", {"endianness": "BIG", "compress": "packbits"}),
        ("float32", {"crs": "EPSG:4326", "transform": degrees, "compress": "lerc"}),
        ("uint8", {"compress": "jpeg"}),
        ("int16", {"driver": "COG", "compress": "deflate"}),
    ]  # fmt: skip
    bases = []
    for k, (dtype, options) in enumerate(made):
        values = (hills - 200 if dtype == "uint8" else hills).astype(dtype)
        if "nodata" in options:
            values[3:6, 8:12] = options["nodata"]
        path = folder / f"base_{k}.tif"
        profile = {"driver": "GTiff", "crs": "EPSG:25832", "transform": utm, "dtype": dtype}
        profile |= {"width": 24, "height": 20, "count": 1} | options
        with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True), rasterio.open(path, "w", **profile) as tif:
            tif.write(values, 1)
            if k == 1:
                mask = np.full(values.shape, 255, np.uint8)
                mask[5:8, 5:9] = 0
                tif.write_mask(mask)
            if k == 2:
                tif.scales, tif.offsets, tif.units = (0.1,), (100.0,), ("metre",)
                tif.update_tags(AREA_OR_POINT="Point", note="a note")
                tif.set_band_description(1, "elevation")
        with rasterio.open(path) as tif:
            first = tif.get_tag_item("BLOCK_OFFSET_0_0", "TIFF", bidx=1)
        bases.append(Base(path.name, path.read_bytes(), int(first or 400)))
    return bases


def read_tif(path: Path) -> Any:
    """Return values and mask of a raster, taken through a pyramid and back."""
    from wavelet_core import analyse
    from wavelet_gis.workflows.open import open_terrain

    terrain = open_terrain(path)
    back: Any = terrain.geo_pyramid(analyse(terrain.mesh, levels=1)).restore()
    return back.values, back.valid, back.geometry.transform


def raster_is_wrong(found: Any, expected: Any, path: Path, in_head: bool) -> bool:
    """Whether the bits of a cell, the mask or the place are others than GDAL reads.

    Where a strip ends early, libtiff may leave memory in the cells as it was, other at each time
    of reading: such a file holds no one thing to compare with.
    """
    if not _differs(found, path):
        return False
    ballast = [np.full(500 * k, 7.25) for k in range(1, 9)]  # moves what memory is taken next
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        again = read_tif(path)
    del ballast
    return _differs(again, path) and found[0].tobytes() == again[0].tobytes()


def _differs(found: Any, path: Path) -> bool:
    import rasterio
    from rasterio.errors import NotGeoreferencedWarning

    from wavelet_gis.io.libraries import silent_libraries

    values, valid, transform = found
    with warnings.catch_warnings(), silent_libraries():
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        with rasterio.open(path) as tif:
            stored, mask = tif.read(1), tif.read_masks(1) != 0
            place = tuple(tif.transform)[:6]
    if stored.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            mask &= np.isfinite(stored) & (np.abs(stored) < 1e30)
    is_same = values.dtype == stored.dtype and values.tobytes() == stored.tobytes()
    return not (is_same and np.array_equal(valid, mask) and place == tuple(transform))


# -- layers and tables of triangles and points


def mesh_bases(folder: Path) -> list[Base]:
    """Return TINs as layers of triangles and as layers and tables of points."""
    import pyogrio
    import shapely

    rng = np.random.default_rng(4)
    lattice = np.stack(np.meshgrid(np.arange(9.0), np.arange(8.0)), axis=-1).reshape(-1, 2)
    plan = 10 * lattice + rng.uniform(-2, 2, lattice.shape)
    points = np.column_stack([plan, 300 + 9 * np.sin(plan[:, 0] / 20)])
    corner = np.add.outer(9 * np.arange(7), np.arange(8)).ravel()
    faces = np.concatenate([corner[:, None] + [0, 1, 10], corner[:, None] + [0, 10, 9]])
    utm = points + np.array([500000.0, 5100000.0, 0.0])
    degrees = points * np.array([1e-5, 1e-5, 1.0]) + np.array([11.0, 46.0, 0.0])
    bases = []
    for driver, suffix, vertices, epsg in (
        ("GPKG", "gpkg", utm, 25832),
        ("ESRI Shapefile", "shp", utm, 25832),
        ("FlatGeobuf", "fgb", utm, 25832),
        ("GeoJSON", "geojson", degrees, 4326),
        ("GML", "gml", utm, 25832),
        ("KML", "kml", degrees, 4326),
    ):
        triangles = shapely.polygons(vertices[faces][:, [0, 1, 2, 0]])
        shapes = {
            "triangles": ("Polygon Z", triangles),
            "points": ("Point Z", shapely.points(vertices)),
        }
        for what, (kind, geometry) in shapes.items():
            path = folder / f"base_{what}.{suffix}"
            pyogrio.raw.write(
                path, shapely.to_wkb(geometry), field_data=[np.arange(len(geometry))],
                fields=["id"], crs=f"EPSG:{epsg}", geometry_type=kind, driver=driver,
            )  # fmt: skip
            bases.append(Base(path.name, path.read_bytes(), 400))
    table = "\n".join(f"{x:.3f},{y:.3f},{z:.3f}" for x, y, z in utm)
    bases.append(Base("base.csv", f"x,y,z\n{table}\n".encode(), 400))
    bases.append(Base("base.xyz", table.replace(",", " ").encode(), 400))
    for base in bases:
        (folder / base.name).write_bytes(base.content)
    return bases


def read_mesh(path: Path) -> Any:
    """Return the finest mesh of a layer or table, taken through a pyramid and back."""
    from wavelet_core import analyse
    from wavelet_gis.workflows.open import open_input

    terrain = open_input(path)
    back: Any = terrain.geo_pyramid(analyse(terrain.mesh, levels=1)).restore()
    return getattr(back, "vertices", back)


def mesh_is_wrong(found: Any, expected: Any, path: Path, in_head: bool) -> bool:
    """Whether a vertex is none of the file's coordinates, or a place of the file is missing."""
    if not isinstance(found, np.ndarray):
        return False
    held = _coordinates(path)
    held = held[np.isfinite(held).all(axis=1)]
    slack = 1e-9 * max(1.0, float(np.abs(held).max(initial=0.0)))
    from scipy.spatial import cKDTree

    apart = cKDTree(held).query(found)[0]
    missed = cKDTree(found[:, :2]).query(held[:, :2])[0]
    return bool(apart.max() > slack or missed.max() > slack)


def _coordinates(path: Path) -> Any:
    if path.suffix in (".csv", ".xyz"):
        return np.array(list(_numbers(path)))
    import pyogrio
    import shapely

    from wavelet_gis.io.libraries import silent_libraries

    with silent_libraries(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        layers = pyogrio.list_layers(path)
        layer = next(name for name, kind in layers if kind is not None)
        geometry = pyogrio.raw.read(path, layer=layer, columns=[])[2]  # others may be damaged
    return shapely.get_coordinates(shapely.from_wkb(geometry), include_z=True)


def _numbers(path: Path) -> Iterator[list[float]]:
    for line in path.read_text("utf-8-sig").split("\n"):
        words = line.replace(",", " ").replace(";", " ").split()
        if len(words) < 3:
            continue
        try:
            yield [float(word) for word in words[:3]]
        except ValueError:
            continue


KINDS = {
    "las": Kind(las_bases, read_las, cloud_is_wrong, telling=""),
    "tif": Kind(tif_bases, read_tif, raster_is_wrong, telling="but GDAL reported"),
    "mesh": Kind(mesh_bases, read_mesh, mesh_is_wrong),
}
