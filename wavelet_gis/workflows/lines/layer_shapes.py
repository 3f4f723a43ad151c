"""Shapes of vector files and GeoDataFrames, brought to the working frame of a terrain."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import CrsError, CrsWarning, InputFileError
from wavelet_gis.notes import warn

__all__ = ["LINES", "POINTS", "POLYGONS", "Place", "shapes_in_frame", "warn_of_one_crs"]

FloatArray = NDArray[np.float64]
Shapes = NDArray[Any]

#: Type ids of shapely, single and multi, and what such shapes are called.
POINTS, LINES, POLYGONS = ((0, 4), "points"), ((1, 2, 5), "lines"), ((3, 6), "polygons")


class Place(Protocol):
    """What has a CRS and a working frame: a terrain, or a pyramid with its place on earth."""

    @property
    def system(self) -> CoordinateSystem:
        """The CRS."""

    @property
    def frame(self) -> LocalFrame:
        """The working frame."""


def shapes_in_frame(
    place: Place,
    data: Any,
    option: str,
    kind: tuple[tuple[int, ...], str],
    field: str | None = None,
    field_option: str = "field",
) -> tuple[Shapes, NDArray[Any] | None]:
    """Return the shapes of a file or a GeoDataFrame, and a field of theirs.

    Parameters
    ----------
    place : Terrain or GeoPyramid
        Whose working frame the shapes are brought to.
    data : path or GeoDataFrame
        A vector file of one layer, or what geopandas read.
    option : str
        The parameter that names it, for errors.
    kind : pair
        `POINTS`, `LINES` or `POLYGONS`.
    field : str, optional
        Whose values are wanted.
    field_option : str
        The parameter that names the field, for errors.

    Returns
    -------
    shapes : (n,) object
        Of shapely; z is NaN for none. Empty ones are left out.
    values : (n,) or None
        Of the field.

    Raises
    ------
    InputFileError
        A file that cannot be read, holds shapes of another kind or none, or has no such field.
    CrsError
        Shapes that cannot be brought to the CRS of the terrain.
    OptionError
        Something that is neither path nor GeoDataFrame.
    """
    import shapely

    table: Any
    if isinstance(data, str | os.PathLike):
        from wavelet_gis.io.vector.vector_reader import read_shapes

        name = os.fspath(data)
        try:
            shapes, table, wkt = read_shapes(name, None, [] if field is None else [field])
        except InputFileError as error:
            if error.options:  # names the option for a layer of the input
                raise InputFileError(
                    "{path}: {0} must be a file of one layer; copy that layer into a file of its "
                    "own.",
                    option,
                    path=name,
                ) from error
            raise
    elif all(hasattr(data, part) for part in ("geometry", "crs", "columns")):
        name, shapes = type(data).__name__, np.asarray(data.geometry.values, dtype=object)
        table = data
        wkt = None if data.crs is None else data.crs.to_wkt()
    else:
        raise OptionError(
            "{0} is a {given}; give a path or a GeoDataFrame.", option, given=type(data).__name__
        )
    values = None
    if field is not None:
        if field not in table:
            raise InputFileError(
                "{name}: there is no field {field!r}; name one with {0}.",
                field_option,
                name=name,
                field=field,
            )
        values = np.asarray(table[field])
    is_shape = ~(shapely.is_missing(shapes) | shapely.is_empty(shapes))
    shapes = shapes[is_shape]
    kinds, noun = kind
    if len(shapes) == 0 or not set(shapely.get_type_id(shapes).tolist()) <= set(kinds):
        raise InputFileError(
            "{name}: {0} are to be {noun}, and the layer holds {found}; give a layer of {noun}.",
            option,
            name=name,
            noun=noun,
            found="none" if len(shapes) == 0 else "others",
        )
    move = _into_frame(place, name, wkt)
    moved = np.asarray(shapely.transform(shapes, move, include_z=True), dtype=object)
    return moved, None if values is None else values[is_shape]


def warn_of_one_crs(name: str, there: CoordinateSystem, here: CoordinateSystem) -> None:
    """Warn where only one of two sets of coordinates has a CRS.

    Parameters
    ----------
    name : str
        Of what is brought to the terrain.
    there, here : CoordinateSystem
        Its CRS, and that of the terrain.
    """
    if (there.wkt is None) != (here.wkt is None):
        warn(
            CrsWarning,
            "shapes_taken_as_they_are",
            "{name}: its CRS is {there} and that of the terrain {here}; x and y are taken as they "
            "are",
            stacklevel=5,
            name=name,
            there=there.name,
            here=here.name,
        )


def _into_frame(place: Place, name: str, wkt: str | None) -> Callable[[FloatArray], FloatArray]:
    """Return the map from a layer's coordinates to the working frame."""
    from wavelet_gis.crs.lookup import coordinate_system
    from wavelet_gis.crs.projection import projected

    there: CoordinateSystem = coordinate_system(wkt)
    here = place.system
    is_moved = there.wkt is not None and here.wkt is not None and there.wkt != here.wkt
    warn_of_one_crs(name, there, here)

    def move(coordinates: FloatArray) -> FloatArray:
        if not np.isfinite(coordinates[:, :2]).all() or np.isinf(coordinates[:, 2]).any():
            raise InputFileError(
                "{name}: a coordinate is not finite; leave that shape out.", name=name
            )
        moved = np.array(coordinates, dtype=np.float64)
        if is_moved:
            try:
                moved[:, 0], moved[:, 1] = projected(there, here, *coordinates[:, :2].T)
            except CrsError as error:
                raise CrsError(
                    "{name}: {there} cannot be transformed to {here}; reproject the layer first.",
                    name=name,
                    there=there.name,
                    here=here.name,
                ) from error
        return place.frame.to_local(moved)

    return move
