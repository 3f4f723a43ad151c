"""Points and triangles out of vector layers, through pyogrio and shapely."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import InputFileError, LayerWarning
from wavelet_gis.io.libraries import silent_libraries
from wavelet_gis.notes import warn

__all__ = ["VectorTerrain", "read_shapes", "read_vector", "vector_terrain"]

#: What pyogrio lets through of what a damaged file makes of it.
_READ_ERRORS = (ValueError, KeyError, IndexError, OverflowError)

_POINTS, _POLYGONS = {0, 4}, {3, 6}  # type ids of shapely: single and multi


class VectorTerrain(NamedTuple):
    """What a layer holds: points, or triangles.

    points : (n_points, 3) float64, or None
    attributes : (n_points, n_attributes) float64
    attribute_names : tuple of str
    corners : (n_faces, 3, 3) float64, or None
    wkt : str or None, the CRS
    """

    points: NDArray[np.float64] | None
    attributes: NDArray[np.float64]
    attribute_names: tuple[str, ...]
    corners: NDArray[np.float64] | None
    wkt: str | None


def read_vector(
    path: str | os.PathLike[str],
    *,
    layer: str | None = None,
    z_field: str | None = None,
    attributes: tuple[str, ...] = (),
) -> VectorTerrain:
    """Return the points or triangles in a vector file.

    Parameters
    ----------
    path : path
        Any vector file that GDAL reads.
    layer : str, optional
        Where the file holds several.
    z_field, attributes
        See `vector_terrain`.

    Raises
    ------
    InputFileError
        When the file cannot be read, or `vector_terrain` refuses it.
    """
    wanted = [*([z_field] if z_field else []), *attributes]
    shapes, table, wkt = read_shapes(path, layer, wanted)
    return vector_terrain(
        os.fspath(path), shapes, table, wkt, z_field=z_field, attributes=attributes
    )


def read_shapes(
    path: str | os.PathLike[str], layer: str | None = None, fields: Sequence[str] = ()
) -> tuple[NDArray[Any], dict[str, NDArray[Any]], str | None]:
    """Return the shapes in a vector file, fields of theirs, and the WKT of the CRS.

    Parameters
    ----------
    path : path
        Any vector file that GDAL reads.
    layer : str, optional
        Where the file holds several.
    fields : sequence of str
        Which to read.

    Raises
    ------
    InputFileError
        When the file cannot be read.
    """
    import pyogrio
    import shapely

    name = os.fspath(path)
    try:
        with silent_libraries() as said, warnings.catch_warnings(record=True) as raised:
            warnings.simplefilter("always")
            if layer is None:
                layer = _only_layer(name, pyogrio.list_layers(name))
            meta, _, geometry, columns = pyogrio.raw.read(name, layer=layer, columns=list(fields))
    except (*_READ_ERRORS, pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as error:
        lines = str(error).splitlines() or [type(error).__name__]
        reason = lines[0].rstrip(".")
        raise InputFileError(f"{name}: the layer cannot be read ({reason}).") from error
    try:
        shapes = shapely.from_wkb(geometry)
    except shapely.errors.ShapelyError as error:
        reason = str(error).splitlines()[0].rstrip(".")
        raise InputFileError(
            f"{name}: a shape of the layer {layer} is damaged ({reason}); get the file again."
        ) from error
    said += [str(warning.message) for warning in raised]
    if said:
        warn(
            LayerWarning,
            "layer_read_with_complaints",
            "{name}: read, but GDAL reported: {complaint}",
            name=name,
            complaint=said[0],
        )
    return shapes, dict(zip(meta["fields"], columns, strict=True)), meta["crs"]


def _only_layer(name: str, layers: NDArray[Any]) -> str:
    """Return the one layer with shapes, which need not be named."""
    spatial = [str(layer) for layer, kind in layers if kind is not None]
    if len(spatial) == 1:
        return spatial[0]
    if not spatial:
        raise InputFileError(f"{name}: the layer cannot be read (there is none with shapes).")
    raise InputFileError(
        "{name}: there are the layers {layers}; name one with {0}.",
        "layer",
        name=name,
        layers=", ".join(spatial),
    )


def vector_terrain(
    name: str,
    shapes: NDArray[Any],
    table: Any,
    wkt: str | None,
    *,
    z_field: str | None = None,
    attributes: tuple[str, ...] = (),
) -> VectorTerrain:
    """Return the points or triangles among shapes.

    Parameters
    ----------
    name : str
        For messages.
    shapes : (n,) array of shapely geometries
        Points, or triangles as polygons; empty ones are left out.
    table : mapping of str to (n,) arrays
        The fields.
    wkt : str or None
        The CRS.
    z_field : str, optional
        Field with the elevation of points; by default z of the geometry.
    attributes : tuple of str
        Fields of points to lift along.

    Raises
    ------
    InputFileError
        Lines, polygons that are no triangles, no elevation, no such field, or one without numbers.
    """
    import shapely

    missing = [field for field in (z_field, *attributes) if field and field not in table]
    if missing:
        raise InputFileError(f"{name}: there is no field {missing[0]!r}.")
    filled = ~(shapely.is_missing(shapes) | shapely.is_empty(shapes))
    shapes = shapes[filled]
    kinds = set(shapely.get_type_id(shapes).tolist())
    if kinds and kinds <= _POINTS:
        points, owner = shapely.get_coordinates(shapes, include_z=True, return_index=True)
        rows = np.flatnonzero(filled)[owner]
        if z_field is not None:
            points[:, 2] = _numbers(name, table, z_field, "z_field")[rows]
        elif np.isnan(points[:, 2]).all():
            raise InputFileError(
                "{name}: the points have no z; name the field with the elevation by {0}.",
                "z_field",
                name=name,
            )
        columns = [_numbers(name, table, field, "attributes")[rows] for field in attributes]
        values = np.column_stack(columns) if columns else np.empty((len(points), 0))
        return VectorTerrain(points, values, attributes, None, wkt)
    if kinds and kinds <= _POLYGONS:
        return VectorTerrain(None, np.empty((0, 0)), (), _corners(name, shapes), wkt)
    raise InputFileError(
        f"{name}: the layer holds neither points nor triangles; a terrain is made of these."
    )


def _numbers(name: str, table: Any, field: str, option: str) -> NDArray[np.float64]:
    """Return the numbers of a field."""
    try:
        return np.asarray(table[field], dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputFileError(
            "{name}: field {field!r} does not hold numbers; name another with {0}.",
            option,
            name=name,
            field=field,
        ) from error


def _corners(name: str, shapes: NDArray[Any]) -> NDArray[np.float64]:
    import shapely

    parts = shapely.get_parts(shapes)
    counts = shapely.get_num_coordinates(parts)
    if not (counts == 4).all():
        raise InputFileError(
            f"{name}: a polygon has {int(counts[counts != 4][0]) - 1} corners; a TIN is made of "
            "triangles."
        )
    rings = shapely.get_coordinates(parts, include_z=True).reshape(-1, 4, 3)
    if np.isnan(rings).any():
        raise InputFileError(f"{name}: the triangles have no z; give a layer of type Polygon Z.")
    return np.ascontiguousarray(rings[:, :3])
