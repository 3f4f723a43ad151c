"""How far a surface may be off, by place: numbers, rasters, zones, and functions of the terrain."""

from __future__ import annotations

import ast
import os
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.features.shape import surface_shape
from wavelet_core.mesh.location import surface_errors
from wavelet_gis.errors import InputFileError
from wavelet_gis.workflows.layer_shapes import POLYGONS, Place, shapes_in_frame

__all__ = ["MaxError", "ZoneErrors", "is_by_place", "tolerances", "zone_errors"]

FloatArray = NDArray[np.float64]

#: A distance, the same for all; or what gives one by place: the path of a raster, a formula of
#: ``z`` and ``slope``, numbers for the vertices, or a function that returns them.
MaxError = float | str | os.PathLike[str] | NDArray[Any] | Callable[[TriangleMesh], ArrayLike]

#: Field of the zones that holds the tolerance, where no other is named.
ZONE_FIELD = "max_error"

#: Zones are told of one by one up to so many different tolerances, and in octaves beyond.
MOST_ZONES = 12

#: What a formula may call.
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": np.abs,
    "clip": np.clip,
    "exp": np.exp,
    "log": np.log,
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "sqrt": np.sqrt,
    "where": np.where,
}
_OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.USub: np.negative,
    ast.UAdd: np.positive,
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}
_NAMES = ("z", "slope")


class ZoneErrors(NamedTuple):
    """What came out where the tolerance is one, or of one octave, in the input's unit of z.

    least, most : float, tolerances; equal where the zone has one
    n_points, n_vertices : int, input vertices, and those that are vertices of the surface
    rmse, max_error : float
    """

    least: float
    most: float
    n_points: int
    n_vertices: int
    rmse: float
    max_error: float


def is_by_place(max_error: MaxError | None, zones: Any = None) -> bool:
    """Return whether a tolerance differs from place to place."""
    return zones is not None or not (max_error is None or _is_number(max_error))


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
        A file that cannot be read, or that does not tell the tolerance of some vertex.
    OptionError
        A formula that is none, numbers of another length, negative ones or none for some vertex.
    """
    if zones is None and zone_field is not None:
        raise OptionError("{0} is of {1}; give both or none.", "zone_field", "zones")
    limits = np.full(mesh.n_vertices, np.nan)
    if max_error is not None:
        limits[:] = _of_terrain(place, mesh, max_error)
    if zones is not None:
        _set_in_zones(limits, place, mesh, zones, zone_field or ZONE_FIELD)
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


def zone_errors(
    mesh: TriangleMesh,
    vertex_ids: NDArray[np.int64],
    points: FloatArray,
    limits: FloatArray,
    z_scale: float,
) -> tuple[ZoneErrors, ...]:
    """Return vertices and errors of a surface by its tolerance, the strictest zone first.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface.
    vertex_ids : (n_vertices,) int64
        Input vertices that it has.
    points : (n_points, 3) float64
        The input vertices.
    limits : (n_points,) float64
        From `tolerances`.
    z_scale : float
        Working units in one of the input's unit of z.
    """
    errors = np.abs(surface_errors(mesh, points)) / z_scale
    levels = np.unique(limits)
    zone = np.searchsorted(levels, limits)
    if len(levels) > MOST_ZONES:
        octave = np.floor(np.log2(np.maximum(limits, np.finfo(float).tiny)))
        zone = np.searchsorted(np.unique(octave), octave)
    is_vertex = np.zeros(len(points), dtype=bool)
    is_vertex[vertex_ids] = True
    rows = []
    for number in range(int(zone.max(initial=-1)) + 1):
        inside = zone == number
        covered = errors[inside & np.isfinite(errors)]
        rows.append(
            ZoneErrors(
                float(limits[inside].min()),
                float(limits[inside].max()),
                int(inside.sum()),
                int((inside & is_vertex).sum()),
                float(np.sqrt(np.mean(covered**2))) if len(covered) else 0.0,
                float(covered.max(initial=0.0)),
            )
        )
    return tuple(rows)


def _of_terrain(place: Place, mesh: TriangleMesh, max_error: MaxError) -> ArrayLike:
    if _is_number(max_error):
        return float(max_error)  # type: ignore[arg-type]
    if isinstance(max_error, str):
        formula = _parsed(max_error)
        if formula is not None:
            return _value(formula, _variables(place, mesh), max_error)
    if isinstance(max_error, str | os.PathLike):
        return _of_raster(place, mesh, max_error)
    values = np.asarray(max_error(mesh) if callable(max_error) else max_error)
    if values.shape not in ((), (mesh.n_vertices,)) or values.dtype.kind not in "iuf":
        raise OptionError(
            "{0} has the shape {shape} and type {dtype}; give one number for each of {n} input "
            "points.",
            "max_error",
            shape=values.shape,
            dtype=values.dtype,
            n=mesh.n_vertices,
        )
    return values


def _is_number(max_error: object) -> bool:
    if isinstance(max_error, str):
        try:
            float(max_error)
        except ValueError:
            return False
        return True
    return isinstance(max_error, int | float | np.number) and not isinstance(max_error, bool)


# -- formulas ------------------------------------------------------------------------------------


def _parsed(text: str) -> ast.expr | None:
    """Return a formula, or None of what is to be a file."""
    if os.path.exists(text):
        return None
    try:
        formula = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    if isinstance(formula, ast.Attribute):  # a file's name, as Python reads it
        return None
    return formula


def _variables(place: Place, mesh: TriangleMesh) -> dict[str, Callable[[], FloatArray]]:
    return {
        "z": lambda: place.frame.to_file(mesh.vertices)[:, 2],
        "slope": lambda: surface_shape(mesh).slope,
    }


def _value(part: ast.expr, variables: dict[str, Callable[[], FloatArray]], text: str) -> Any:
    """Return what a part of a formula comes to; only numbers, names and calls that are known."""

    def of(node: ast.expr) -> Any:
        return _value(node, variables, text)

    if isinstance(part, ast.Constant) and isinstance(part.value, int | float):
        return float(part.value)
    if isinstance(part, ast.Name) and part.id in variables:
        return variables[part.id]()
    with np.errstate(all="ignore"):
        if isinstance(part, ast.BinOp) and type(part.op) in _OPERATORS:
            return _OPERATORS[type(part.op)](of(part.left), of(part.right))
        if isinstance(part, ast.UnaryOp) and type(part.op) in _OPERATORS:
            return _OPERATORS[type(part.op)](of(part.operand))
        if isinstance(part, ast.Compare) and len(part.ops) == 1 and type(part.ops[0]) in _OPERATORS:
            return _OPERATORS[type(part.ops[0])](of(part.left), of(part.comparators[0]))
        if (
            isinstance(part, ast.Call)
            and isinstance(part.func, ast.Name)
            and part.func.id in _FUNCTIONS
            and not part.keywords
        ):
            try:
                return _FUNCTIONS[part.func.id](*(of(argument) for argument in part.args))
            except (TypeError, ValueError) as error:
                raise OptionError(
                    "{0} {text!r}: {call} takes other arguments ({reason}).",
                    "max_error",
                    text=text,
                    call=part.func.id,
                    reason=str(error).split("\n")[0],
                ) from error
    raise OptionError(
        "{0} {text!r} is no raster that is there, and as a formula {part!r} is not understood; "
        "formulas have numbers, {names}, + - * / **, comparisons and {calls}.",
        "max_error",
        text=text,
        part=ast.unparse(part),
        names=" and ".join(_NAMES),
        calls=", ".join(_FUNCTIONS),
    )


# -- rasters and zones ---------------------------------------------------------------------------


def _of_raster(place: Place, mesh: TriangleMesh, path: str | os.PathLike[str]) -> FloatArray:
    """Return the cell that each vertex lies in; NaN where there is none, or none with data."""
    from wavelet_gis.crs.lookup import coordinate_system
    from wavelet_gis.crs.projection import projected
    from wavelet_gis.io.raster.raster_reader import read_dem

    dem, told = read_dem(path)
    x, y = place.frame.to_file(mesh.vertices)[:, :2].T
    there = coordinate_system(told.wkt)
    if there.wkt is not None and place.system.wkt is not None and there.wkt != place.system.wkt:
        x, y = projected(place.system, there, x, y)
    columns, rows = dem.geometry.cells(x, y)
    column, row = np.rint(columns), np.rint(rows)
    n_rows, n_columns = dem.values.shape
    inside = (column >= 0) & (column < n_columns) & (row >= 0) & (row < n_rows)
    at = row[inside].astype(np.int64), column[inside].astype(np.int64)
    values = np.full(mesh.n_vertices, np.nan)
    found = dem.values[at] * dem.scale + dem.offset
    values[inside] = np.where(dem.valid[at], found, np.nan)
    if np.isnan(values).all():
        raise InputFileError(
            "{path}: no input point lies in a cell of this raster; check its extent and its CRS.",
            path=os.fspath(path),
        )
    return values


def _set_in_zones(
    limits: FloatArray, place: Place, mesh: TriangleMesh, zones: Any, field: str
) -> None:
    import shapely

    shapes, given = shapes_in_frame(place, zones, "zones", POLYGONS, field)
    assert given is not None
    try:
        values = np.array([np.nan if value is None else float(value) for value in given])
    except (TypeError, ValueError) as error:
        raise InputFileError(
            "{name}: field {field!r} does not hold numbers; name another with {0}.",
            "zone_field",
            name=zones if isinstance(zones, str | os.PathLike) else type(zones).__name__,
            field=field,
        ) from error
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
            name=os.fspath(zones) if isinstance(zones, str | os.PathLike) else "the zones",
            field=field,
        )
