"""Whatever holds terrain, opened: one file, several, a folder, an object or a pyramid file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from wavelet_core._threads import centre_of
from wavelet_gis.crs.frame import MAX_DISTORTION
from wavelet_gis.errors import CrsWarning, InputFileError
from wavelet_gis.io.formats import (
    POINT_TABLE_SUFFIXES,
    PYRAMID_SUFFIX,
    VECTOR_SUFFIXES,
    is_cloud,
    suffix_of,
)
from wavelet_gis.io.names import files_of, joint_name
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import collected, warn
from wavelet_gis.workflows.analyse import Analysis
from wavelet_gis.workflows.opening.input_options import CLOUD, PYRAMID, RASTER, require_meaning
from wavelet_gis.workflows.opening.layer_or_table import terrain_of_raster_or_vector
from wavelet_gis.workflows.opening.objects import terrain_of_object
from wavelet_gis.workflows.opening.pyramid import holds_pyramid, load, origin_kind
from wavelet_gis.workflows.opening.raster_or_cloud import open_terrain

__all__ = [
    "load",
    "open_data",
    "open_input",
    "open_pyramid_or_input",
    "open_terrain",
    "origin_kind",
]

Path = str | os.PathLike[str]

#: Beyond it there is a warning that a plane is untrue: the error that a frame for degrees may have.
LARGEST_SCALE_ERROR = MAX_DISTORTION


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
        A raster that GDAL reads; a LAS, LAZ or COPC file; the ``ept.json`` of
        Entwine Point Tiles, or its folder; points in a vector layer or in a table
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
        See `wavelet_gis.workflows.opening.raster_or_cloud.open_terrain`: ``band``,
        ``attributes``, ``classes``, ``crs``, ``vertical_unit`` and others.

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
        if suffix_of(data) == PYRAMID_SUFFIX and holds_pyramid(data):
            require_meaning(data, PYRAMID, shapes)
            return load(data)
        return open_input(data, layer=layer, z_field=z_field, **shapes, **options)
    with collected() as notes:
        terrain = terrain_of_object(data, z_field, options, shapes)
        _warn_of_scale(terrain)
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
            require_meaning(joint_name(files), CLOUD, {"layer": layer, "z_field": z_field})
            terrain = open_terrain(files, **options)
        else:
            terrain = _terrain_of_file(files[0], layer, z_field, options, shapes)
        _warn_of_scale(terrain)
    return _with_shapes(terrain.with_notes(notes), shapes)


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
    if not is_one or options.get("layer") or not holds_pyramid(files[0]):
        if level is not None:
            raise InputFileError(
                "{path}: this is no pyramid, and {0} is for one; leave it out.",
                "level",
                path=joint_name(files),
            )
        return open_input(path, **options)
    path = files[0]
    require_meaning(path, PYRAMID, options)
    for name in ("crs", "vertical_unit"):
        if options.get(name):
            raise InputFileError(
                "{path}: a pyramid has its own, so {0} is for other input only; leave it out.",
                name,
                path=path,
            )
    return load(path, level=level)


def _terrain_of_file(
    path: str,
    layer: str | None,
    z_field: str | None,
    options: dict[str, Any],
    shapes: dict[str, Any],
) -> Terrain:
    suffix = suffix_of(path)
    if suffix == PYRAMID_SUFFIX and layer is None and holds_pyramid(path):
        raise InputFileError(
            "{path}: this is a pyramid already; give its input, or, to analyse one of its layers, "
            "name it by {0}.",
            "layer",
            path=path,
        )
    kind = CLOUD if is_cloud(path) else RASTER
    is_open = kind == RASTER and suffix in (*VECTOR_SUFFIXES, *POINT_TABLE_SUFFIXES)
    if is_open and os.path.isfile(path):
        return terrain_of_raster_or_vector(path, layer, z_field, options, shapes)
    require_meaning(path, kind, {"layer": layer, "z_field": z_field})
    return open_terrain(path, **options)


def _with_shapes(terrain: Terrain, shapes: dict[str, Any]) -> Terrain:
    if all(value is None for value in shapes.values()):
        return terrain
    from wavelet_gis.workflows.lines.shapes import terrain_with_shapes

    return terrain_with_shapes(terrain, **shapes)


def _warn_of_scale(terrain: Terrain) -> None:
    """Warn where the plane is not true to scale, as Web Mercator far from the equator."""
    from wavelet_gis.crs.projection import scale_at

    x, y = centre_of(terrain.mesh.vertices)[0][:2]
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
