"""The terrain in points and triangles: a vector layer, or a table of x, y and z."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.formats import POINT_TABLE_SUFFIXES, suffix_of
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.model.tin import terrain_of_points, terrain_of_triangles
from wavelet_gis.workflows.opening.input_options import (
    POINTS,
    TABLE,
    TRIANGLES,
    require_meaning,
    system_given,
)
from wavelet_gis.workflows.opening.raster_or_cloud import open_terrain

if TYPE_CHECKING:
    from wavelet_gis.io.vector.vector_reader import VectorTerrain

__all__ = ["terrain_of_layer", "terrain_of_raster_or_vector"]


def terrain_of_raster_or_vector(
    path: str | os.PathLike[str],
    layer: str | None,
    z_field: str | None,
    options: dict[str, Any],
    shapes: dict[str, Any],
) -> Terrain:
    """Return the terrain in a file that may hold a raster, or else points or triangles.

    Parameters
    ----------
    path : path
        Of a file whose suffix leaves it open.
    layer, z_field
        See `wavelet_gis.workflows.open.open_data`; with either, it is not tried as a raster.
    options : dict
        Those of `open_terrain`.
    shapes : dict
        Lines and points that are laid on the terrain later, only to be refused here.

    Raises
    ------
    InputFileError
        It is neither, or it has no terrain in it.
    """
    names = tuple(options.get("attributes", ()))
    given = {**options, **shapes, "layer": layer, "z_field": z_field}
    no_raster: InputFileError | None = None
    if layer is None and z_field is None and not names:
        try:
            return open_terrain(path, **options)
        except InputFileError as error:
            no_raster = error
    name = os.fspath(path)
    system, unit = system_given(options.get("crs")), options.get("vertical_unit")
    try:
        if suffix_of(path) in POINT_TABLE_SUFFIXES:
            from wavelet_gis.io.vector.point_table import read_point_table

            table = read_point_table(path, names)
            require_meaning(path, TABLE, given)
            return terrain_of_points(
                name, table.points, table.attributes, names, system or CoordinateSystem(), unit
            )
        from wavelet_gis.io.vector.vector_reader import read_vector

        found = read_vector(path, layer=layer, z_field=z_field, attributes=names)
    except InputFileError as error:
        is_table = suffix_of(path) in POINT_TABLE_SUFFIXES
        if no_raster is None or is_table or _is_about_content(error):
            raise
        if "no raster that GDAL can open" in str(no_raster):
            raise InputFileError(
                f"{name}: this is neither a raster nor a layer that GDAL can open; check the file "
                "and its suffix."
            ) from error
        raise no_raster from error
    require_meaning(path, POINTS if found.corners is None else TRIANGLES, given)
    return terrain_of_layer(name, found, system, unit)


def terrain_of_layer(
    name: str, found: VectorTerrain, system: CoordinateSystem | None, unit: str | None
) -> Terrain:
    """Return the terrain of the points or triangles that a layer holds.

    Parameters
    ----------
    name : str
        For messages.
    found : VectorTerrain
        What was read of it.
    system, unit
        Instead of what the layer says.
    """
    from wavelet_gis.crs.lookup import coordinate_system

    place = system or coordinate_system(found.wkt)
    if found.corners is not None:
        return terrain_of_triangles(name, found.corners, place, unit)
    assert found.points is not None
    return terrain_of_points(
        name, found.points, found.attributes, found.attribute_names, place, unit
    )


def _is_about_content(error: InputFileError) -> bool:
    """Whether the file was read as points or triangles, so that this is what is wrong with it."""
    return "cannot be read" not in str(error)
