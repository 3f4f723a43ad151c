"""Spatial layers into a pyramid file, with GDAL for the tables and sqlite3 for the rows.

GDAL's Python classes take some 15 microseconds a feature, a quarter of a minute for the details of
a million-cell DEM; rows inserted by sqlite3 take a tenth of that. GDAL still makes the tables, the
CRS entry and the spatial index, so that the file is what it would be.
"""

from __future__ import annotations

import os
import sqlite3
import struct
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from osgeo import gdal, ogr, osr

from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .crs_and_progress import require_running
from .gdal_errors import without_exceptions

if TYPE_CHECKING:
    from qgis.core import QgsFeedback

    from wavelet_gis.products.layers import Layer
    from wavelet_gis.tiles.index import TileIndex

    from .background import Work

Path = str | os.PathLike[str]

_GEOMETRY_TYPES = {"Point Z": ogr.wkbPoint25D, "Polygon Z": ogr.wkbPolygon25D}
#: Rows inserted between two looks at the cancel button.
CHUNK = 20_000


def layer_names(path: Path) -> list[str]:
    """Return the names of the layers with geometries in a GeoPackage, in order."""
    with closing(sqlite3.connect(path)) as connection:
        rows = connection.execute(
            "SELECT table_name FROM gpkg_contents WHERE data_type = 'features' ORDER BY 1"
        ).fetchall()
    return [str(name) for (name,) in rows]


def add_layers(
    path: Path,
    layers: Iterable[Layer],
    wkt: str | None,
    feedback: QgsFeedback | Work,
    report: Callable[[float], bool],
    n_rows: int,
) -> None:
    """Add layers and their styles to a GeoPackage that is there already.

    Parameters
    ----------
    path : path
    layers : iterable of wavelet_gis.products.layers.Layer
    wkt : str or None
        CRS of all of them.
    feedback : QgsFeedback or Work
        Holds the cancel button.
    report : callable
        Takes the fraction that is done.
    n_rows : int
        Of all layers together.

    Raises
    ------
    QgsProcessingException
        When GDAL or SQLite cannot write.
    Cancelled
    """
    from wavelet_gis.io.geopackage import check_database, check_rows, widen_pages, write_styles
    from wavelet_gis.io.read_back import read_back

    styles, rows, done = [], {}, 0
    widen_pages(path)
    for layer in layers:
        require_running(feedback)
        _create(path, layer, wkt)
        for n_inserted in _insert(path, layer):
            done += n_inserted
            report(0.9 * min(done / max(n_rows, 1), 1.0))
            require_running(feedback)
        _index(path, layer)
        rows[layer.name] = len(layer.geometry)
        styles.append((layer.name, layer.title, layer.style, layer.description))
    write_styles(path, styles)
    report(0.95)
    read_back(path, check_database)
    require_running(feedback)
    read_back(path, partial(check_rows, n_rows=rows))


def write_tile_index(index: TileIndex) -> None:
    """Write the GeoPackage of a tile set, as `wavelet_gis.tiles.index.write_index` does.

    Raises
    ------
    QgsProcessingException
        When GDAL or SQLite cannot write.
    """
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.tiles.index import INDEX, LAYER, check_index, footprints, index_fields

    path, fields, wkt = index.folder / INDEX, index_fields(index), index.plan.coordinate_system.wkt
    refusal = partial(_unwritable, path, LAYER)
    columns = [column.tolist() for column in fields.values()]
    with new_file(path, overwrite=True) as scratch:
        with (
            without_exceptions(gdal, refusal),
            without_exceptions(ogr, refusal),
            without_exceptions(osr, refusal),
        ):
            driver = gdal.GetDriverByName("GPKG")
            dataset = driver.Create(str(scratch), 0, 0, 0, gdal.GDT_Unknown)
            options = ["GEOMETRY_NAME=geom", "FID=fid"]
            table = dataset and dataset.CreateLayer(LAYER, _system(wkt), ogr.wkbPolygon, options)
            if not table:
                raise refusal(gdal.GetLastErrorMsg())
            for name, column in fields.items():
                table.CreateField(ogr.FieldDefn(name, _field_type(column)))
            for shape, *values in zip(footprints(index), *columns, strict=True):
                feature = ogr.Feature(table.GetLayerDefn())
                feature.SetGeometry(ogr.CreateGeometryFromWkb(shape))
                for name, value in zip(fields, values, strict=True):
                    if value == value:  # not a number is no value
                        feature.SetField(name, value)
                if table.CreateFeature(feature):
                    raise refusal(gdal.GetLastErrorMsg())
            dataset.FlushCache()
            table = dataset = None
        check_index(scratch, len(index.records))


def _system(wkt: str | None) -> Any:
    if not wkt:
        return None
    system = osr.SpatialReference()
    system.ImportFromWkt(wkt)
    return system


def _create(path: Path, layer: Layer, wkt: str | None) -> None:
    refusal = partial(_failure, path, layer)
    with (
        without_exceptions(gdal, refusal),
        without_exceptions(ogr, refusal),
        without_exceptions(osr, refusal),
    ):
        dataset = gdal.OpenEx(str(path), gdal.OF_VECTOR | gdal.OF_UPDATE)
        options = [
            f"DESCRIPTION={layer.description}",
            f"IDENTIFIER={layer.name}",
            "GEOMETRY_NAME=geom",
            "FID=fid",
            "SPATIAL_INDEX=NO",
        ]
        table = dataset and dataset.CreateLayer(
            layer.name, _system(wkt), _GEOMETRY_TYPES[layer.geometry_type], options
        )
        if not table:
            raise refusal(gdal.GetLastErrorMsg())
        for name, column in layer.fields.items():
            table.CreateField(ogr.FieldDefn(name, _field_type(column)))
        dataset.FlushCache()  # the file is another's from here on, even where a frame is kept
        table = dataset = None


def _insert(path: Path, layer: Layer) -> Iterator[int]:
    """Insert the rows of a layer and yield how many, after each piece of them."""
    from wavelet_gis.io.geopackage import open_for_writing

    names = ", ".join(_quoted(name) for name in ("geom", *layer.fields))
    marks = ", ".join("?" * (1 + len(layer.fields)))
    columns = [column.tolist() for column in layer.fields.values()]
    with open_for_writing(path) as connection:
        (srs_id,) = connection.execute(
            "SELECT srs_id FROM gpkg_geometry_columns WHERE table_name = ?", (layer.name,)
        ).fetchone()
        # Magic, version, flags (little-endian, no envelope), CRS: the header of a geometry.
        header = struct.pack("<2sBBi", b"GP", 0, 1, srs_id)
        for start in range(0, len(layer.geometry), CHUNK):
            stop = start + CHUNK
            blobs = [header + wkb for wkb in layer.geometry[start:stop]]
            connection.executemany(
                # Names cannot be bound; they are quoted.
                f"INSERT INTO {_quoted(layer.name)} ({names}) VALUES ({marks})",  # nosec B608
                zip(blobs, *(column[start:stop] for column in columns), strict=True),
            )
            yield len(blobs)
        if len(layer.geometry):
            connection.execute(
                "UPDATE gpkg_contents SET min_x = ?, min_y = ?, max_x = ?, max_y = ? "
                "WHERE table_name = ?",
                (*_bounds(layer), layer.name),
            )


def _quoted(name: str) -> str:
    """Return a name as SQL takes it, whatever is in it."""
    return '"' + name.replace('"', '""') + '"'


def _index(path: Path, layer: Layer) -> None:
    refusal = partial(_failure, path, layer)
    with without_exceptions(gdal, refusal), without_exceptions(ogr, refusal):
        dataset = gdal.OpenEx(str(path), gdal.OF_VECTOR | gdal.OF_UPDATE)
        if dataset is None:
            raise refusal(gdal.GetLastErrorMsg())
        dataset.ExecuteSQL(f"SELECT CreateSpatialIndex('{layer.name}', 'geom')")
        dataset = None  # closes the file


def _bounds(layer: Layer) -> tuple[float, float, float, float]:
    """Return the smallest and largest x and y in the geometries, read out of their bytes."""
    joined = np.frombuffer(b"".join(layer.geometry.tolist()), np.uint8).reshape(
        len(layer.geometry), -1
    )
    start = 5 if layer.geometry_type == "Point Z" else 13
    xyz = np.ascontiguousarray(joined[:, start:]).view("<f8").reshape(-1, 3)
    (x_min, y_min, _), (x_max, y_max, _) = xyz.min(axis=0), xyz.max(axis=0)
    return float(x_min), float(y_min), float(x_max), float(y_max)


def _field_type(column: NDArray[Any]) -> int:
    if column.dtype.kind == "O":
        return ogr.OFTString
    if column.dtype.kind == "f":
        return ogr.OFTReal
    return ogr.OFTInteger64 if column.dtype.itemsize > 4 else ogr.OFTInteger


def _failure(path: Path, layer: Layer, reason: str) -> QgsProcessingException:
    return _unwritable(path, layer.name, reason)


def _unwritable(path: Path, layer: str, reason: str) -> QgsProcessingException:
    return QgsProcessingException(
        tr("{}: layer {} cannot be written ({}); check the disk and the name.").format(
            path, layer, reason
        )
    )
