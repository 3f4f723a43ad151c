"""How far a surface may be off, by place: numbers, rasters, zones, and functions of the terrain."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.features.shape import surface_shape
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import Dem
from wavelet_gis.workflows.lines.layer_shapes import (
    POLYGONS,
    Place,
    shapes_in_frame,
    warn_of_one_crs,
)
from wavelet_gis.workflows.tolerance.formula import parsed, value_of

__all__ = [
    "ByPlace",
    "MaxError",
    "is_by_place",
    "is_number",
    "tolerances",
    "values_by_place",
    "values_in_cells",
]

FloatArray = NDArray[np.float64]

#: A distance, the same for all; or what gives one by place: the path of a raster, a formula of
#: ``z`` and ``slope``, numbers for the vertices, or a function that returns them.
MaxError = float | str | os.PathLike[str] | NDArray[Any] | Callable[[TriangleMesh], ArrayLike]

#: Field of the zones that holds the tolerance, where no other is named.
ZONE_FIELD = "max_error"


def is_by_place(
    max_error: MaxError | None, zones: Any = None, zone_field: str | None = None
) -> bool:
    """Return whether a tolerance differs from place to place."""
    if zones is None and zone_field is not None:
        raise OptionError("{0} goes with {1}; give both or neither.", "zone_field", "zones")
    return zones is not None or not (max_error is None or is_number(max_error))


def tolerances(
    place: Place,
    mesh: TriangleMesh,
    max_error: MaxError | None,
    zones: Any = None,
    zone_field: str | None = None,
) -> FloatArray:
    """Return the largest vertical distance that each vertex of a terrain may have.

    Parameters
    ----------
    place : Terrain or GeoPyramid
        Whose mesh it is.
    mesh : TriangleMesh
        The finest one, in the working frame.
    max_error : float, path, str, array_like or callable, optional
        One number; a raster that GDAL reads, in any CRS, whose cells count as they lie around the
        vertices; a formula of ``z``, in the unit of the input, and of ``slope`` in degrees, such as
        ``"max(0.1, 0.02 * slope)"``; one number for each vertex; or a function of ``mesh`` that
        returns those. In the input's unit of z.
    zones : path or GeoDataFrame, optional
        Polygons with a tolerance of their own; where several overlap the least counts.
        ``max_error`` holds outside.
    zone_field : str, optional
        The field of the zones that holds it, ``max_error`` by default.

    Returns
    -------
    (n_vertices,) float64
        In the input's unit of z.

    Raises
    ------
    InputFileError
        A file that cannot be read, or that has no tolerance for some vertex.
    OptionError
        A formula that is none, numbers of another length, negative ones or none for some vertex.
    """
    options = ByPlace("max_error", "zones", "zone_field")
    limits = values_by_place(place, mesh, max_error, zones, zone_field or ZONE_FIELD, options)
    n_without = int(np.isnan(limits).sum())
    if n_without:
        raise OptionError(
            "{n_without} of {n} input points have no tolerance; {0} has to give one everywhere"
            + (" outside {1}." if zones is not None else "."),
            "max_error",
            "zones",
            n_without=n_without,
            n=mesh.n_vertices,
        )
    if not (limits >= 0).all():
        raise OptionError(
            "{0} is below 0 at {n} input points, down to {least:.4g}; give distances of 0 or more.",
            "max_error",
            n=int((limits < 0).sum()),
            least=float(limits.min()),
        )
    return limits


class ByPlace(NamedTuple):
    """The options that say something by place, for errors.

    values : str, of a number or what gives one by place
    zones, field : str, of polygons, and of the field of theirs that holds it
    """

    values: str
    zones: str
    field: str


def values_by_place(
    place: Place,
    mesh: TriangleMesh,
    given: MaxError | None,
    zones: Any,
    field: str,
    options: ByPlace,
) -> FloatArray:
    """Return numbers for the vertices of a terrain, NaN where nothing says any.

    Parameters
    ----------
    place, mesh, zones
        See `tolerances`.
    given : float, path, str, array_like or callable, optional
        What ``max_error`` is to `tolerances`.
    field : str
        Of the zones, where there are some.
    options : ByPlace
        Their names.

    Raises
    ------
    InputFileError
        A file that cannot be read, or that has no number for any vertex.
    OptionError
        A formula that is none, or numbers of another length.
    """
    values = np.full(mesh.n_vertices, np.nan)
    if given is not None:
        values[:] = _of_terrain(place, mesh, given, options.values)
    if zones is not None:
        _set_in_zones(values, place, mesh, zones, field, options)
    return values


def _of_terrain(place: Place, mesh: TriangleMesh, given: MaxError, option: str) -> ArrayLike:
    if is_number(given):
        return float(given)  # type: ignore[arg-type]
    if isinstance(given, str):
        formula = parsed(given)
        if formula is not None:
            value: ArrayLike = value_of(formula, _variables(place, mesh), given, option)
            if np.asarray(value).dtype == bool:
                raise OptionError(
                    "{0} {text!r} is a comparison, not a distance; write where(condition, a, b).",
                    option,
                    text=given,
                )
            return value
    if isinstance(given, str | os.PathLike):
        return _of_raster(place, mesh, given)
    values = np.asarray(given(mesh) if callable(given) else given)
    if values.shape not in ((), (mesh.n_vertices,)) or values.dtype.kind not in "iuf":
        raise OptionError(
            "{0} has the shape {shape} and type {dtype}; give one number for each of {n} input "
            "points.",
            option,
            shape=values.shape,
            dtype=values.dtype,
            n=mesh.n_vertices,
        )
    return values


def _variables(place: Place, mesh: TriangleMesh) -> dict[str, Callable[[], FloatArray]]:
    return {
        "z": lambda: place.frame.to_file(mesh.vertices)[:, 2],
        "slope": lambda: surface_shape(mesh).slope,
    }


def is_number(max_error: object) -> bool:
    """Return whether an option is one number, also as a text."""
    if isinstance(max_error, str):
        try:
            float(max_error)
        except ValueError:
            return False
        return True
    return isinstance(max_error, int | float | np.number) and not isinstance(max_error, bool)


def values_in_cells(dem: Dem, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the values of the cells that places lie in; NaN where there is none with data.

    Parameters
    ----------
    dem : Dem
        A raster of any numbers.
    x, y : (n,) float64
        Places in its CRS.
    """
    columns, rows = dem.geometry.cells(x, y)
    column, row = np.rint(columns), np.rint(rows)  # NaN is in none
    n_rows, n_columns = dem.values.shape
    inside = (column >= 0) & (column < n_columns) & (row >= 0) & (row < n_rows)
    at = row[inside].astype(np.int64), column[inside].astype(np.int64)
    values = np.full(len(x), np.nan)
    found = dem.values[at] * dem.scale + dem.offset
    values[inside] = np.where(dem.valid[at], found, np.nan)
    return values


def _of_raster(place: Place, mesh: TriangleMesh, path: str | os.PathLike[str]) -> FloatArray:
    """Return the cell that each vertex lies in; NaN where there is none, or none with data."""
    from wavelet_gis.crs.lookup import coordinate_system
    from wavelet_gis.crs.projection import projected
    from wavelet_gis.io.raster.raster_reader import read_dem

    dem, georeference = read_dem(path)
    x, y = place.frame.to_file(mesh.vertices)[:, :2].T
    there = coordinate_system(georeference.wkt)
    warn_of_one_crs(os.fspath(path), there, place.system)
    if there.wkt is not None and place.system.wkt is not None and there.wkt != place.system.wkt:
        x, y = projected(place.system, there, x, y)
    values = values_in_cells(dem, x, y)
    if np.isnan(values).all():
        raise InputFileError(
            "{path}: no input point lies in a cell of this raster; check its extent and its CRS.",
            path=os.fspath(path),
        )
    return values


def _set_in_zones(
    limits: FloatArray,
    place: Place,
    mesh: TriangleMesh,
    zones: Any,
    field: str,
    options: ByPlace,
) -> None:
    import shapely

    name = os.fspath(zones) if isinstance(zones, str | os.PathLike) else type(zones).__name__
    shapes, given = shapes_in_frame(place, zones, options.zones, POLYGONS, field, options.field)
    assert given is not None
    try:
        values = np.array([np.nan if value is None else float(value) for value in given])
    except (TypeError, ValueError) as error:
        raise InputFileError(
            "{name}: field {field!r} does not hold numbers; name another with {0}.",
            options.field,
            name=name,
            field=field,
        ) from error
    if (values < 0).any():
        raise InputFileError(
            "{name}: field {field!r} holds {value:g}; give 0 or more ({0}).",
            options.field,
            name=name,
            field=field,
            value=float(np.nanmin(values)),
        )
    x, y = mesh.vertices[:, :2].T
    tree = shapely.STRtree(shapely.points(x, y))
    n_inside = 0
    order = np.argsort(-values, kind="stable")  # the strictest last; what has none comes to nothing
    for shape, value in zip(shapes[order], values[order], strict=True):
        if np.isnan(value):
            continue
        inside = tree.query(shape, predicate="covers")
        n_inside += len(inside)
        limits[inside] = value
    if n_inside == 0:
        raise InputFileError(
            "{name}: no input point lies in a zone with a number in {field!r}; check the extent, "
            "the CRS and the field.",
            name=name,
            field=field,
        )
