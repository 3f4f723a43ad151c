"""Whether several files lie in one coordinate system."""

from __future__ import annotations

from collections.abc import Sequence

from wavelet_gis.crs.frame import Georeference
from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.errors import InputFileError

__all__ = ["agreed"]


def agreed(
    names: Sequence[str],
    places: Sequence[Georeference],
    *,
    any_crs: bool = False,
    any_unit: bool = False,
) -> Georeference:
    """Return the georeference that several files have, which must be the same.

    Parameters
    ----------
    names : sequence of str
        Of the files, for messages.
    places : sequence of Georeference
        That of each.
    any_crs, any_unit : bool
        Whether the CRS, or the unit of z, is given otherwise: theirs need not be the same, and
        what is returned has none.

    Raises
    ------
    InputFileError
        Two that contradict each other, in the CRS or the unit of z.
    """
    places = [
        place._replace(
            wkt=None if any_crs else place.wkt,
            vertical_unit=None if any_unit else place.vertical_unit,
        )
        for place in places
    ]
    first = places[0]
    for name, place in zip(names[1:], places[1:], strict=True):
        if not _is_same(first.wkt, place.wkt):
            raise InputFileError(
                "{name}: its CRS is {here}, that of {first} is {there}; reproject one, or, if that "
                "is a mistake, give the CRS of all with {0}.",
                "crs",
                name=name,
                here=_described(place),
                first=names[0],
                there=_described(first),
            )
        if first.vertical_unit != place.vertical_unit:
            raise InputFileError(
                "{name}: its unit of z is {here}, that of {first} is {there}; convert one, or, if "
                "that is a mistake, give the unit of all with {0}.",
                "vertical_unit",
                name=name,
                here=place.vertical_unit or "not given",
                first=names[0],
                there=first.vertical_unit or "not given",
            )
    return first


def _described(place: Georeference) -> str:
    return coordinate_system(place.wkt).name if place.wkt else "not given"


def _is_same(one: str | None, other: str | None) -> bool:
    if one == other:
        return True
    if not one or not other:
        return False
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        return bool(CRS.from_user_input(one) == CRS.from_user_input(other))
    except CRSError:  # what is wrong with it is said as it is described
        return False
