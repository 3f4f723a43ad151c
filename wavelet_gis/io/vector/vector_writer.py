"""Layers into GeoPackages, through pyogrio."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from functools import partial

from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.errors import CrsWarning, OutputFileError
from wavelet_gis.io.geopackage import (
    LayerStyle,
    check_database,
    check_rows,
    widen_pages,
    write_styles,
)
from wavelet_gis.io.names import plain_folder
from wavelet_gis.io.read_back import read_back, room_at
from wavelet_gis.products.layers import Layer

__all__ = ["add_layers"]


def add_layers(
    path: str | os.PathLike[str], layers: Iterable[Layer], system: CoordinateSystem
) -> int:
    """Write layers and their styles into a GeoPackage, which is made if it is not there.

    Parameters
    ----------
    path : path
        The file.
    layers : iterable of Layer
        Written one after the other, so that only one need be in memory.
    system : CoordinateSystem
        The CRS of all of them.

    Returns
    -------
    int
        Number of features written.

    Raises
    ------
    OutputFileError
        When GDAL cannot write them.
    """
    styles: list[LayerStyle] = []
    n_rows: dict[str, int] = {}
    n_features = 0
    crs = _crs_for_gdal(system)
    if os.path.exists(path):
        widen_pages(path)
    for layer in layers:
        with plain_folder(path) as name:
            _write_layer(name, layer, crs)
        n_rows[layer.name] = len(layer.geometry)
        styles.append((layer.name, layer.title, layer.style, layer.description))
        n_features += len(layer.geometry)
    write_styles(path, styles)
    read_back(path, check_database)
    read_back(path, partial(check_rows, n_rows={**n_rows, **_index_rows(n_rows)}))
    return n_features


def _write_layer(path: str | os.PathLike[str], layer: Layer, crs: str | None) -> None:
    from pyogrio.errors import DataLayerError, DataSourceError, FeatureError
    from pyogrio.raw import write

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "'crs' was not provided")
        try:
            write(
                os.fspath(path),
                layer.geometry,
                list(layer.fields.values()),
                list(layer.fields),
                layer=layer.name,
                driver="GPKG",
                geometry_type=layer.geometry_type,
                crs=crs,
                layer_options={
                    "DESCRIPTION": layer.description,
                    "IDENTIFIER": layer.name,
                    "GEOMETRY_NAME": "geom",
                    "FID": "fid",
                },
                dataset_options={} if os.path.exists(path) else {"VERSION": "1.2"},
            )
        except (DataSourceError, DataLayerError, FeatureError) as error:
            # GDAL quotes whole schemas before it comes to the point.
            reason = str(error).rsplit("failed: ", 1)[-1]
            raise OutputFileError(
                f"layer {layer.name} cannot be written ({reason}); "
                f"{room_at(os.path.dirname(os.path.realpath(path)))}."
            ) from error


def _index_rows(n_rows: dict[str, int]) -> dict[str, int]:
    """Return the rows that the spatial indices must have, which GDAL fills when it closes."""
    return {f"rtree_{table}_geom": n for table, n in n_rows.items()}


def _crs_for_gdal(system: CoordinateSystem) -> str | None:
    """Return the definition for the layers; None where a GeoPackage could not hold it."""
    if system.wkt is None:
        return None
    if system.kind == "unknown":
        from pyproj import CRS

        if not CRS.from_wkt(system.wkt).is_geocentric:
            return system.wkt
        # x and y on a map are no geocentric coordinates; QGIS would put them in the earth.
        warnings.warn(
            f"the layers are written without the geocentric CRS {system.name!r}, in which no map "
            "can be drawn; set their CRS in QGIS",
            CrsWarning,
            stacklevel=3,
        )
        return None
    return system.wkt
