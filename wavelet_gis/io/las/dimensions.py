"""The dimensions of LAS points: which are lifted as attributes, which are carried along."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import InputFileError
from wavelet_gis.model.attributes.ground import GROUND_CLASS, height_above_ground
from wavelet_gis.model.points.cloud import PointAttribute

if TYPE_CHECKING:
    from laspy import LasHeader
    from laspy.point.record import PackedPointRecord

__all__ = ["ALIASES", "HEIGHT_ABOVE_GROUND", "carried_fields", "lifted_attributes", "select"]

#: Name of the attribute that is computed rather than read.
HEIGHT_ABOVE_GROUND = "hag"

#: What people call dimensions, beside the names that laspy gives them.
ALIASES: dict[str, tuple[str, ...]] = {
    "class": ("classification",),
    "rgb": ("red", "green", "blue"),
    "returns": ("return_number", "number_of_returns"),
}


def lifted_attributes(
    name: str, wanted: Sequence[str], points: PackedPointRecord, header: LasHeader
) -> list[PointAttribute]:
    """Return the attributes that are lifted, of all points.

    Parameters
    ----------
    name : str
        Of the file, for messages.
    wanted : sequence of str
        See `read_cloud`.
    points : PackedPointRecord
    header : LasHeader
    """
    lifted = [
        attribute
        for one in dict.fromkeys(wanted)
        for attribute in _attributes(name, one, points, header)
    ]
    _check_names(name, lifted)
    return lifted


def _attributes(
    name: str, wanted: str, points: PackedPointRecord, header: LasHeader
) -> list[PointAttribute]:
    available = list(points.point_format.dimension_names)
    if wanted not in available and wanted in ALIASES:
        return [
            attribute
            for part in ALIASES[wanted]
            for attribute in _attributes(name, part, points, header)
        ]
    if wanted not in available and wanted == HEIGHT_ABOVE_GROUND:
        return [_height_attribute(points, header)]
    matches = [d for d in available if d == wanted] or [
        d for d in available if d.lower() == wanted.lower()
    ]
    if not matches or matches[0] in ("X", "Y", "Z"):
        choices = ", ".join(d for d in available if d not in ("X", "Y", "Z"))
        raise InputFileError(
            f"{name}: there is no dimension {wanted!r}; the file has {choices} (and hag can be "
            "computed)."
        )
    return _dimension(matches[0], points)


def _dimension(dimension: str, points: PackedPointRecord) -> list[PointAttribute]:
    info = points.point_format.dimension_by_name(dimension)
    packed = dimension not in (points.array.dtype.names or ())
    values = np.array(points[dimension]) if packed else points.array[dimension]
    n_components = 1 if values.ndim == 1 else values.shape[1]
    scales = np.ones(n_components) if info.scales is None else np.asarray(info.scales)
    offsets = np.zeros(n_components) if info.offsets is None else np.asarray(info.offsets)
    if n_components == 1:
        column = values if values.ndim == 1 else values[:, 0]
        component = None if values.ndim == 1 else 0
        return [
            PointAttribute(
                dimension, dimension, column, component, float(scales[0]), float(offsets[0])
            )
        ]
    return [
        PointAttribute(
            f"{dimension}_{k}", dimension, values[:, k], k, float(scales[k]), float(offsets[k])
        )
        for k in range(n_components)
    ]


def _height_attribute(points: PackedPointRecord, header: LasHeader) -> PointAttribute:
    integers = np.column_stack([points.array[axis] for axis in "XYZ"])
    coordinates = integers * np.asarray(header.scales) + np.asarray(header.offsets)
    is_ground = (np.array(points["classification"]) == GROUND_CLASS) & ~np.array(
        points["withheld"]
    ).astype(bool)
    heights = height_above_ground(coordinates, is_ground)
    return PointAttribute(HEIGHT_ABOVE_GROUND, HEIGHT_ABOVE_GROUND, heights)


def _check_names(name: str, lifted: list[PointAttribute]) -> None:
    seen: set[str] = set()
    for attribute in lifted:
        if attribute.name in seen:
            raise InputFileError(
                f"{name}: attribute {attribute.name!r} is requested twice; name it once."
            )
        seen.add(attribute.name)


def carried_fields(
    points: PackedPointRecord,
    lifted: list[PointAttribute],
    chosen: NDArray[np.bool_] | None = None,
) -> dict[str, NDArray[Any]]:
    """Return the fields of the records that the pyramid does not hold.

    A lifted sub-field (the class of formats 0 to 5 shares its byte with flags) stays in its
    byte, and so do the other components of an array.
    """
    whole = {a.dimension for a in lifted if a.component is None}
    names = points.array.dtype.names or ()
    return {
        name: select(points.array[name], chosen)
        for name in names
        if name not in ("X", "Y", "Z") and name not in whole
    }


def select(values: NDArray[Any], chosen: NDArray[np.bool_] | None) -> NDArray[Any]:
    """Return the values of chosen points; of all where None are chosen."""
    return np.ascontiguousarray(values if chosen is None else values[chosen])
