"""The terrain in an object: one of ours, or of another package.

Objects of other packages are known by what they offer, not by their class, so that nothing is
imported for them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.terrain import Terrain, terrain_of_dem, terrain_of_mesh
from wavelet_gis.model.tin import frame_of_coordinates
from wavelet_gis.workflows.opening.data_array import terrain_of_data_array
from wavelet_gis.workflows.opening.input_options import (
    POINTS,
    RASTER,
    TRIANGLES,
    require_meaning,
    system_given,
)
from wavelet_gis.workflows.opening.layer_or_table import terrain_of_layer
from wavelet_gis.workflows.opening.raster_or_cloud import open_terrain

if TYPE_CHECKING:
    from wavelet_gis.io.vector.vector_reader import VectorTerrain

__all__ = ["terrain_of_object"]


def terrain_of_object(
    data: Any, z_field: str | None, options: dict[str, Any], shapes: dict[str, Any]
) -> Terrain:
    """Return the terrain in an object.

    Parameters
    ----------
    data : object
        See `wavelet_gis.workflows.open.open_data`.
    z_field : str, optional
        Of a GeoDataFrame: the field with the elevation.
    options : dict
        Those of `open_terrain`.
    shapes : dict
        Lines and points that are laid on the terrain later, only to be refused here.

    Raises
    ------
    OptionError
        It is none that holds terrain.
    """
    name = type(data).__name__
    system, unit = system_given(options.get("crs")), options.get("vertical_unit")
    given = {**options, **shapes, "z_field": z_field}
    if isinstance(data, Dem):
        require_meaning(name, RASTER, given)
        return terrain_of_dem(name, data, system or CoordinateSystem(), unit)
    if isinstance(data, TriangleMesh):
        require_meaning(name, TRIANGLES, given)
        return _terrain_of_triangle_mesh(name, data, system, unit)
    if all(hasattr(data, part) for part in ("read_masks", "transform", "name")):
        require_meaning(name, RASTER, given)
        return open_terrain(data.name, **options)  # a rasterio dataset
    if all(hasattr(data, part) for part in ("dims", "coords", "values")):
        require_meaning(name, RASTER, given)
        return terrain_of_data_array(data, system, unit)
    if all(hasattr(data, part) for part in ("geometry", "crs", "columns")):
        found = _read_frame(name, data, z_field, options)
        require_meaning(name, POINTS if found.corners is None else TRIANGLES, given)
        return terrain_of_layer(name, found, system, unit)
    raise OptionError(
        f"a {name} holds no terrain; give a path, a rasterio dataset, an xarray DataArray, a "
        "GeoDataFrame, a TriangleMesh or a Dem."
    )


def _terrain_of_triangle_mesh(
    name: str, data: TriangleMesh, system: CoordinateSystem | None, unit: str | None
) -> Terrain:
    place = system or CoordinateSystem()
    frame, unit_name = frame_of_coordinates(name, data.vertices, place, unit)
    local = TriangleMesh(
        frame.to_local(data.vertices), data.faces, data.attributes, data.attribute_names
    )
    return terrain_of_mesh(name, local, place, frame, unit_name)


def _read_frame(
    name: str, data: Any, z_field: str | None, options: dict[str, Any]
) -> VectorTerrain:
    """Return the points or triangles in a GeoDataFrame."""
    from wavelet_gis.io.vector.vector_reader import vector_terrain

    names = tuple(options.get("attributes", ()))
    geometries = np.asarray(data.geometry.values, dtype=object)
    wkt = None if data.crs is None else data.crs.to_wkt()
    return vector_terrain(name, geometries, data, wkt, z_field=z_field, attributes=names)
