"""Whatever holds terrain, opened: files of many kinds, and objects of other packages.

Objects are known by what they offer, not by their class, so that nothing is imported for them.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError, PyramidError
from wavelet_gis.crs.frame import MAX_DISTORTION, CoordinateSystem, vertical_unit_name
from wavelet_gis.errors import CrsError, CrsWarning, InputFileError
from wavelet_gis.io.formats import (
    CLOUD_SUFFIXES,
    POINT_TABLE_SUFFIXES,
    PYRAMID_SUFFIX,
    VECTOR_SUFFIXES,
    suffix_of,
)
from wavelet_gis.io.names import files_of, readable, told_as_one
from wavelet_gis.model.attributes.categories import one_channel_per_category
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.model.origin import ORIGINS
from wavelet_gis.model.terrain import Terrain, terrain_of_cloud, terrain_of_dem, terrain_of_mesh
from wavelet_gis.model.tin import frame_of_coordinates, terrain_of_points, terrain_of_triangles
from wavelet_gis.notes import collected, warn
from wavelet_gis.workflows.analyse import Analysis
from wavelet_gis.workflows.input_options import (
    CLOUD,
    POINTS,
    PYRAMID,
    RASTER,
    TABLE,
    TRIANGLES,
    require_meaning,
)

__all__ = [
    "load",
    "open_data",
    "open_input",
    "open_pyramid_or_input",
    "open_terrain",
    "origin_kind",
]

Path = str | os.PathLike[str]

#: Beyond it a plane is told to be untrue: the same error that a frame for degrees may have.
LARGEST_SCALE_ERROR = MAX_DISTORTION

#: How far cells may be from even spacing, in parts of one; single precision leaves that much.
EVEN_SPACING = 1e-3


def open_terrain(
    path: Path | Sequence[Path],
    *,
    band: int | None = None,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    carry: bool = True,
    class_channels: bool = False,
    crs: str | None = None,
    vertical_unit: str | None = None,
    nodata: float | str | None = None,
    offline: bool = False,
    keep_noise: bool = False,
    keep_withheld: bool = False,
    duplicates: str | None = None,
    max_edge: float | Literal["auto"] | None = None,
    concave: bool = False,
) -> Terrain:
    """Return the terrain in a raster or a LAS file, or in several that are parts of one.

    Parameters
    ----------
    path : path or sequence of path
        ``.las`` and ``.laz`` are read with laspy, all else with GDAL; see `open_data` for several.
    band : int, optional
        Of a raster, from 1.
    attributes, classes, carry, keep_noise, keep_withheld
        Of a point cloud; see `wavelet_gis.io.las.read_cloud`.
    class_channels : bool
        Lift classes, return numbers and other categories as one channel of 0 and 1 each.
    crs : str, optional
        Instead of the CRS in the file.
    vertical_unit : str, optional
        Unit of z, instead of what the file tells.
    nodata, offline
        Of a raster; see `wavelet_gis.io.raster.read_dem`.
    duplicates, max_edge, concave
        Of a point cloud; see `wavelet_gis.model.points.mesh.cloud_mesh`.

    Raises
    ------
    InputFileError, CrsError, MeshError
        As the readers do.

    Warns
    -----
    CrsWarning
        When there is no CRS, or one whose x and y are not a map plane.
    UnitWarning
        When z is in another unit than the working frame and is converted.
    """
    from wavelet_gis.crs.lookup import coordinate_system

    override = coordinate_system(crs) if crs else None
    files = files_of(path)
    name = readable(told_as_one(files))
    free = {"any_crs": override is not None, "any_unit": vertical_unit is not None}
    if suffix_of(files[0]) in CLOUD_SUFFIXES:
        from wavelet_gis.io.las import read_cloud, read_clouds

        require_meaning(name, CLOUD, {"band": band, "nodata": nodata})
        options: dict[str, Any] = {
            "attributes": attributes,
            "classes": classes,
            "carry": carry,
            "keep_noise": keep_noise,
            "keep_withheld": keep_withheld,
        }
        cloud, place = (
            read_clouds(files, **free, **options) if files[1:] else read_cloud(files[0], **options)
        )
        if class_channels:
            cloud = one_channel_per_category(cloud)
        system = override or coordinate_system(place.wkt)
        return terrain_of_cloud(
            name,
            cloud,
            system,
            vertical_unit or place.vertical_unit,
            fault=place.fault,
            duplicates=duplicates,
            max_edge=max_edge,
            concave=concave,
        )
    from wavelet_gis.io.raster import read_dem, read_dems

    require_meaning(
        name,
        RASTER,
        {
            "attributes": attributes,
            "classes": classes,
            "class_channels": class_channels,
            "carry": carry,
            "keep_noise": keep_noise,
            "keep_withheld": keep_withheld,
            "duplicates": duplicates,
            "max_edge": max_edge,
            "concave": concave,
        },
    )
    options = {"band": band, "nodata": nodata, "offline": offline}
    dem, place = read_dems(files, **free, **options) if files[1:] else read_dem(files[0], **options)
    system = override or coordinate_system(place.wkt)
    unit = vertical_unit or _known_unit(place.vertical_unit)
    return terrain_of_dem(name, dem, system, unit)


def _tell_of_scale(terrain: Terrain) -> None:
    """Warn where the plane is not true to scale, as Web Mercator far from the equator."""
    from wavelet_gis.crs.projection import scale_at

    low, high = terrain.mesh.vertices.min(axis=0), terrain.mesh.vertices.max(axis=0)
    x, y = (low[:2] + high[:2]) / 2
    scale = scale_at(terrain.system, float(x), float(y))
    if abs(scale - 1.0) > LARGEST_SCALE_ERROR:
        how = f"{scale:.3g} times too long" if scale > 1 else f"{1 / scale:.3g} times too short"
        warn(
            CrsWarning,
            "plane_not_true_to_scale",
            "{name}: distances in {crs} are {how} here, and slopes and areas wrong with them; "
            "reproject the input, to its UTM zone for instance",
            stacklevel=3,
            name=terrain.name,
            crs=terrain.system.name,
            how=how,
        )


def _known_unit(unit: str | None) -> str | None:
    """Return the unit that a raster band names, if it is a length that we know."""
    try:
        return vertical_unit_name(unit) if unit else None
    except CrsError:
        return None


def open_data(
    data: Any,
    *,
    layer: str | None = None,
    z_field: str | None = None,
    breaklines: Any = None,
    clip: Any = None,
    fixed_points: Any = None,
    line_tolerance: float | None = None,
    **options: Any,
) -> Terrain | Analysis:
    """Return the terrain, or the pyramid, in a file or an object.

    Parameters
    ----------
    data : path, sequence of path, or object
        A raster that GDAL reads; a LAS, LAZ or COPC file; points in a vector layer or in a table
        (``.csv``, ``.xyz``); a TIN as a layer of triangles; a pyramid file. Or an open rasterio
        dataset, an xarray DataArray, a GeoDataFrame, a `TriangleMesh`, a `Dem`.
        Several rasters of one grid, or LAS files of one kind, or a folder of such, are one terrain:
        the mosaic, or the points of all, which is also what the pyramid gives back. Where rasters
        overlap, the first with data counts; a point record that two files have counts once.
    layer, z_field : str, optional
        Of a vector file: the layer, and the field with the elevation where points have no z.
    breaklines, clip, fixed_points : path or GeoDataFrame, optional
        Lines that become edges, polygons of which only the inside is left, and points that become
        vertices; all of them stay at every level. Lines and points with z keep it, others are laid
        on the terrain. What comes out is a TIN. See `wavelet_gis.workflows.lines.shapes`.
    line_tolerance : float, optional
        How far lines that are laid on the terrain may be off for the sake of fewer vertices, in the
        unit of z; by default a thousandth of the relief.
    **options
        See `wavelet_gis.workflows.open.open_terrain`: ``band``, ``attributes``, ``classes``,
        ``crs``, ``vertical_unit`` and others.

    Returns
    -------
    Terrain or Analysis
        To be analysed or simplified; or, of a pyramid file, what was saved.

    Raises
    ------
    InputFileError, CrsError, MeshError
        As the readers do.
    OptionError
        An object of another kind.
    """
    shapes = {
        "breaklines": breaklines,
        "clip": clip,
        "fixed_points": fixed_points,
        "line_tolerance": line_tolerance,
    }
    is_several = isinstance(data, list | tuple) and len(data) > 0
    if is_several and all(isinstance(one, str | os.PathLike) for one in data):
        return open_input(data, layer=layer, z_field=z_field, **shapes, **options)
    if isinstance(data, str | os.PathLike):
        if suffix_of(data) == PYRAMID_SUFFIX and _holds_pyramid(data):
            require_meaning(data, PYRAMID, shapes)
            return load(data)
        return open_input(data, layer=layer, z_field=z_field, **shapes, **options)
    with collected() as notes:
        terrain = _terrain_of_object(data, z_field, options, shapes)
        _tell_of_scale(terrain)
    return _with_shapes(terrain.with_notes(notes), shapes)


def open_input(
    path: Path | Sequence[Path],
    *,
    layer: str | None = None,
    z_field: str | None = None,
    breaklines: Any = None,
    clip: Any = None,
    fixed_points: Any = None,
    line_tolerance: float | None = None,
    **options: Any,
) -> Terrain:
    """Return the terrain in a file other than a pyramid, or in several; see `open_data`.

    Parameters
    ----------
    path : path or sequence of path
        The file, files or folder.
    layer, z_field, breaklines, clip, fixed_points, line_tolerance, **options
        See `open_data`.

    Notes
    -----
    A file that may be either is first tried as a raster: a GeoPackage of tiles, a table of x, y
    and z in which GDAL sees a grid.
    """
    shapes = {
        "breaklines": breaklines,
        "clip": clip,
        "fixed_points": fixed_points,
        "line_tolerance": line_tolerance,
    }
    with collected() as notes:
        files = files_of(path)
        if files[1:]:
            require_meaning(told_as_one(files), CLOUD, {"layer": layer, "z_field": z_field})
            terrain = open_terrain(files, **options)
        else:
            terrain = _terrain_of_file(files[0], layer, z_field, options, shapes)
        _tell_of_scale(terrain)
    return _with_shapes(terrain.with_notes(notes), shapes)


def _terrain_of_file(
    path: str,
    layer: str | None,
    z_field: str | None,
    options: dict[str, Any],
    shapes: dict[str, Any],
) -> Terrain:
    suffix = suffix_of(path)
    if suffix == PYRAMID_SUFFIX and layer is None and _holds_pyramid(path):
        raise InputFileError(
            "{path}: this is a pyramid already; give its input, or, to analyse one of its layers, "
            "name it by {0}.",
            "layer",
            path=path,
        )
    if suffix in (*VECTOR_SUFFIXES, *POINT_TABLE_SUFFIXES) and os.path.isfile(path):
        return _raster_or_vector(path, layer, z_field, options, shapes)
    kind = CLOUD if suffix in CLOUD_SUFFIXES else RASTER
    require_meaning(path, kind, {"layer": layer, "z_field": z_field})
    return open_terrain(path, **options)


def open_pyramid_or_input(
    path: Path | Sequence[Path], *, level: int | None = None, **options: Any
) -> Terrain | Analysis:
    """Return what a file holds, for uses that take a pyramid as well as any other terrain.

    Parameters
    ----------
    path : path or sequence of path
        The file; or several, or a folder, of other terrain.
    level : int, optional
        Of a pyramid: the finest that is wanted; see `load`.
    **options
        See `open_data`.

    Raises
    ------
    InputFileError
        Options that this kind of input does not have, or what the readers refuse.
    """
    files = files_of(path)
    is_one = len(files) == 1 and suffix_of(files[0]) == PYRAMID_SUFFIX
    if not is_one or options.get("layer") or not _holds_pyramid(files[0]):
        if level is not None:
            raise InputFileError(
                "{path}: this is no pyramid, and {0} is for one; leave it out.",
                "level",
                path=told_as_one(files),
            )
        return open_input(path, **options)
    path = files[0]
    require_meaning(path, PYRAMID, options)
    for name in ("crs", "vertical_unit"):
        if options.get(name):
            raise InputFileError(
                "{path}: a pyramid knows its own, and {0} is for other input; leave it out.",
                name,
                path=path,
            )
    return load(path, level=level)


def _with_shapes(terrain: Terrain, shapes: dict[str, Any]) -> Terrain:
    if all(value is None for value in shapes.values()):
        return terrain
    from wavelet_gis.workflows.lines.shapes import terrain_with_shapes

    return terrain_with_shapes(terrain, **shapes)


def load(path: str | os.PathLike[str], *, level: int | None = None) -> Analysis:
    """Return the pyramid in a pyramid file, everything in it checked.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.
    level : int, optional
        The finest that is wanted: where the file of a large raster holds it without the levels
        above, no more is read, and the pyramid ends there (`Pyramid.part`).

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    PyramidError
        When its parts are damaged or do not fit together.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_levels, read_pyramid

    return Analysis(read_pyramid(path) if level is None else read_levels(path, level))


def origin_kind(path: str | os.PathLike[str]) -> str:
    """Return what a pyramid file was made from, without its arrays: ``raster`` and so on.

    Parameters
    ----------
    path : path
        A pyramid file.

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    PyramidError
        When it claims a kind that is none of ours.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_summary

    source = read_summary(path).get("source")
    kind = source.get("kind") if isinstance(source, dict) else None
    if not isinstance(kind, str) or kind not in ORIGINS:
        raise PyramidError(
            f"{path}: the file claims a source of kind {kind!r}; analyse the input anew."
        )
    return kind


def _holds_pyramid(path: str | os.PathLike[str]) -> bool:
    from wavelet_gis.io.geopackage import is_system_fault
    from wavelet_gis.io.pyramid.pyramid_file import read_summary

    try:
        read_summary(path)
    except InputFileError as error:
        if is_system_fault(error):
            raise
        return False  # no GeoPackage, or one without our tables
    return True


def _raster_or_vector(
    path: str | os.PathLike[str],
    layer: str | None,
    z_field: str | None,
    options: dict[str, Any],
    shapes: dict[str, Any],
) -> Terrain:
    names = tuple(options.get("attributes", ()))
    given = {**options, **shapes, "layer": layer, "z_field": z_field}
    no_raster: InputFileError | None = None
    if layer is None and z_field is None and not names:
        try:
            return open_terrain(path, **options)
        except InputFileError as error:
            no_raster = error
    name = os.fspath(path)
    system, unit = _system(options), options.get("vertical_unit")
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
    return _terrain_of_vector(name, found, system, unit)


def _is_about_content(error: InputFileError) -> bool:
    """Whether the file was read as points or triangles, so that this is what is wrong with it."""
    return "cannot be read" not in str(error)


def _terrain_of_vector(
    name: str, found: Any, system: CoordinateSystem | None, unit: str | None
) -> Terrain:
    from wavelet_gis.crs.lookup import coordinate_system

    place = system or coordinate_system(found.wkt)
    if found.corners is not None:
        return terrain_of_triangles(name, found.corners, place, unit)
    return terrain_of_points(
        name, found.points, found.attributes, found.attribute_names, place, unit
    )


def _terrain_of_object(
    data: Any, z_field: str | None, options: dict[str, Any], shapes: dict[str, Any]
) -> Terrain:
    name = type(data).__name__
    system, unit = _system(options), options.get("vertical_unit")
    given = {**options, **shapes, "z_field": z_field}
    if isinstance(data, Dem):
        require_meaning(name, RASTER, given)
        return terrain_of_dem(name, data, system or CoordinateSystem(), unit)
    if isinstance(data, TriangleMesh):
        require_meaning(name, TRIANGLES, given)
        place = system or CoordinateSystem()
        frame, unit_name = frame_of_coordinates(name, data.vertices, place, unit)
        local = TriangleMesh(
            frame.to_local(data.vertices), data.faces, data.attributes, data.attribute_names
        )
        return terrain_of_mesh(name, local, place, frame, unit_name)
    if all(hasattr(data, part) for part in ("read_masks", "transform", "name")):
        require_meaning(name, RASTER, given)
        return open_terrain(data.name, **options)  # a rasterio dataset
    if all(hasattr(data, part) for part in ("dims", "coords", "values")):
        require_meaning(name, RASTER, given)
        return _terrain_of_data_array(data, system, unit)
    if all(hasattr(data, part) for part in ("geometry", "crs", "columns")):
        from wavelet_gis.io.vector.vector_reader import vector_terrain

        names = tuple(options.get("attributes", ()))
        geometries = np.asarray(data.geometry.values, dtype=object)
        wkt = None if data.crs is None else data.crs.to_wkt()
        found = vector_terrain(name, geometries, data, wkt, z_field=z_field, attributes=names)
        require_meaning(name, POINTS if found.corners is None else TRIANGLES, given)
        return _terrain_of_vector(name, found, system, unit)
    raise OptionError(
        f"a {name} holds no terrain; give a path, a rasterio dataset, an xarray DataArray, a "
        "GeoDataFrame, a TriangleMesh or a Dem."
    )


def _terrain_of_data_array(
    array: Any, system: CoordinateSystem | None, unit: str | None
) -> Terrain:
    """Return the terrain in an xarray DataArray with two evenly spaced coordinates."""
    flat = array.squeeze()
    if len(flat.dims) != 2:
        raise OptionError(
            f"the DataArray has the dimensions {', '.join(map(str, array.dims))}; choose two, such "
            "as array.sel(band=1)."
        )
    across = [dim for dim in flat.dims if str(dim).lower() in ("x", "lon", "longitude", "easting")]
    if len(across) != 1:
        raise OptionError(
            f"the DataArray has the dimensions {', '.join(map(str, flat.dims))}; call them y and x."
        )
    x_dim = across[0]
    y_dim = next(dim for dim in flat.dims if dim != x_dim)
    flat = flat.transpose(y_dim, x_dim)
    x0, dx = _even_spacing(str(x_dim), flat.coords[x_dim].values)
    y0, dy = _even_spacing(str(y_dim), flat.coords[y_dim].values)
    values = np.ascontiguousarray(flat.values)
    nodata = _nodata_of(array)
    valid = np.isfinite(values) if values.dtype.kind == "f" else np.ones(values.shape, dtype=bool)
    if nodata is not None:
        valid &= values != nodata
    geometry = GridGeometry(
        (values.shape[0], values.shape[1]), (dx, 0.0, x0 - dx / 2, 0.0, dy, y0 - dy / 2)
    )
    name = str(array.name or "DataArray")
    return terrain_of_dem(
        name, Dem(values, valid, geometry, nodata), system or _system_of_array(array), unit
    )


def _even_spacing(name: str, values: Any) -> tuple[float, float]:
    centres = np.asarray(values, dtype=np.float64)
    if len(centres) < 2:
        raise OptionError(f"the coordinate {name} has {len(centres)} value; a surface needs two.")
    step = (centres[-1] - centres[0]) / (len(centres) - 1)
    if step == 0 or np.abs(np.diff(centres) - step).max() > EVEN_SPACING * abs(step):
        raise OptionError(f"the coordinate {name} is not evenly spaced; interpolate it first.")
    return float(centres[0]), float(step)


def _nodata_of(array: Any) -> Any:
    for holder in (array.attrs, getattr(array, "encoding", {})):
        for key in ("_FillValue", "nodata", "missing_value"):
            if holder.get(key) is not None:
                return np.asarray(holder[key]).item()
    return None


def _system_of_array(array: Any) -> CoordinateSystem:
    """Return the CRS as rioxarray and CF keep it: in the attributes of a coordinate."""
    from wavelet_gis.crs.lookup import coordinate_system

    mapping = array.attrs.get("grid_mapping") or array.encoding.get("grid_mapping", "spatial_ref")
    if mapping in array.coords:
        attributes = array.coords[mapping].attrs
        return coordinate_system(attributes.get("crs_wkt") or attributes.get("spatial_ref"))
    crs = array.attrs.get("crs")
    return coordinate_system(None if crs is None else str(crs))


def _system(options: dict[str, Any]) -> CoordinateSystem | None:
    if not options.get("crs"):
        return None
    from wavelet_gis.crs.lookup import coordinate_system

    return coordinate_system(options["crs"])
