"""The CRS of a LAS file, out of its WKT and GeoTIFF records."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import TYPE_CHECKING

from wavelet_gis.crs.frame import Georeference
from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.errors import CrsError

if TYPE_CHECKING:
    from pyproj import CRS

__all__ = ["las_crs"]

#: Records of the owner LASF_Projection.
_WKT, _GEO_KEYS = 2112, 34735

# GeoTIFF keys, and the codes of the GeoTIFF specification that matter here.
_MODEL_TYPE, _GEOGRAPHIC_CS, _PROJECTED_CS, _PROJECTED_UNIT, _VERTICAL_CS, _VERTICAL_UNIT = (
    1024,
    2048,
    3072,
    3076,
    4096,
    4099,
)
_MODEL_PROJECTED = 1
_EPSG_CODES = range(1024, 32767)
_UNITS = {9001: "metre", 9002: "foot", 9003: "us_survey_foot"}
_METRES = {9001: 1.0, 9002: 0.3048, 9003: 1200.0 / 3937.0}

#: Codes that stand for a vertical datum, in EPSG and in the first GeoTIFF specification: its name,
#: and the vertical CRS over it by unit.
_VERTICAL_DATUMS: dict[int, tuple[str, dict[str, int]]] = {
    5100: ("mean sea level", {"metre": 5714, "foot": 8050, "us_survey_foot": 8052}),
    5101: ("Ordnance Datum Newlyn", {"metre": 5701}),
    5102: ("NGVD29", {"metre": 7968, "us_survey_foot": 5702}),
    5103: ("NAVD88", {"metre": 5703, "foot": 8228, "us_survey_foot": 6360}),
    5104: ("Yellow Sea", {"metre": 5736}),
    5105: ("Baltic", {"metre": 5705}),
}


def las_crs(records: Sequence[tuple[int, bytes]]) -> Georeference:
    """Return the CRS of a LAS file and its unit of z, with what is wrong with them.

    The WKT record is preferred; where it is broken or empty, the GeoTIFF keys are tried.

    Parameters
    ----------
    records : sequence of (int, bytes)
        Number and content of the VLRs and EVLRs of the owner ``LASF_Projection``.
    """
    keys = _geo_keys(records)
    faults: list[str] = []
    for number, content in records:
        if number != _WKT:
            continue
        wkt = content.split(b"\0")[0].decode("utf-8", errors="replace").strip()
        if _is_understood(wkt, faults):
            return _of_wkt(wkt, keys)
    notes: list[str] = []
    crs = _from_keys(keys, faults, notes)
    unit = _UNITS.get(keys.get(_VERTICAL_UNIT, 0))
    if crs is None:
        return Georeference(None, unit, faults[0] if faults else "")
    if faults:
        notes.insert(0, f"{faults[0]}; the CRS is that of the GeoTIFF keys, {crs.name}")
    return Georeference(crs.to_wkt(), unit, notes=tuple(notes))


def _of_wkt(wkt: str, keys: dict[int, int]) -> Georeference:
    """Return what a good WKT says; GeoTIFF keys only add a unit of z that it leaves open."""
    unit = _UNITS.get(keys.get(_VERTICAL_UNIT, 0))
    stated = coordinate_system(wkt).vertical_unit
    if stated is None or unit is None:
        return Georeference(wkt, unit if stated is None else None)
    if stated == unit:
        return Georeference(wkt)
    return Georeference(
        wkt,
        notes=(
            f"the WKT says that z is in {_spaced(stated)}, the GeoTIFF keys in {_spaced(unit)}; "
            "the WKT holds",
        ),
    )


def _is_understood(wkt: str, faults: list[str]) -> bool:
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    if not wkt:
        faults.append("its WKT is empty")
        return False
    try:
        CRS.from_wkt(wkt)
        coordinate_system(wkt)
    except (CRSError, CrsError):
        faults.append(f"its WKT is not understood: {_printable(wkt)[:40]}...")
        return False
    return True


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in text)


def _geo_keys(records: Sequence[tuple[int, bytes]]) -> dict[int, int]:
    """Return the keys that hold their value themselves, by id."""
    for number, content in records:
        if number == _GEO_KEYS:
            found: dict[int, int] = {}
            for start in range(8, len(content) - 7, 8):
                key, tag, _, value = struct.unpack_from("<4H", content, start)
                if tag == 0 and key:
                    found.setdefault(key, value)
            return found
    return {}


def _from_keys(keys: dict[int, int], faults: list[str], notes: list[str]) -> CRS | None:
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    projected, geographic = keys.get(_PROJECTED_CS, 0), keys.get(_GEOGRAPHIC_CS, 0)
    if projected in _EPSG_CODES:
        code = projected
    elif projected or keys.get(_MODEL_TYPE) == _MODEL_PROJECTED:
        # The base CRS alone would turn metres into degrees.
        faults.append("its GeoTIFF keys define a projection of their own")
        return None
    elif geographic in _EPSG_CODES:
        code = geographic
    else:
        return None
    try:
        crs = CRS.from_epsg(code)
    except CRSError:
        faults.append(f"EPSG:{code} of its GeoTIFF keys is not known")
        return None
    is_plan = crs.is_projected or crs.is_geographic or crs.is_geocentric or crs.is_compound
    if not is_plan:
        faults.append(f"EPSG:{code} of its GeoTIFF keys is {crs.name}, no horizontal CRS")
        return None
    _note_unit(keys, crs, code, notes)
    if crs.is_compound or len(crs.axis_info) > 2:
        return crs
    return _with_height(crs, keys, notes)


def _note_unit(keys: dict[int, int], crs: CRS, code: int, notes: list[str]) -> None:
    """Say so where the keys have another unit of x and y than the CRS that they name."""
    named = _METRES.get(keys.get(_PROJECTED_UNIT, 0))
    if named is None or not crs.is_projected or not crs.axis_info:
        return
    actual = crs.axis_info[0].unit_conversion_factor
    if abs(named - actual) > 1e-9:
        notes.append(
            f"the GeoTIFF keys name EPSG:{code}, which counts in "
            f"{crs.axis_info[0].unit_name}, and say that x and y are in "
            f"{_spaced(_UNITS[keys[_PROJECTED_UNIT]])}; the former holds"
        )


def _with_height(crs: CRS, keys: dict[int, int], notes: list[str]) -> CRS:
    """Return the CRS together with the vertical one of the keys, where they name one that fits."""
    from pyproj.crs import CRS, CompoundCRS
    from pyproj.exceptions import CRSError

    vertical, unit = keys.get(_VERTICAL_CS, 0), _UNITS.get(keys.get(_VERTICAL_UNIT, 0))
    if vertical not in _EPSG_CODES:
        return crs
    if vertical in _VERTICAL_DATUMS:
        datum, by_unit = _VERTICAL_DATUMS[vertical]
        if unit is None or unit not in by_unit:
            z = f"z in {_spaced(unit)}" if unit else "no unit of z"
            notes.append(
                f"the GeoTIFF keys name the vertical datum {datum} ({vertical}), no vertical CRS, "
                f"and {z}; the vertical CRS is left open"
            )
            return crs
        code = by_unit[unit]
    else:
        code = vertical
    try:
        height = CRS.from_epsg(code)
        is_height = height.is_vertical and not height.is_compound
    except CRSError:
        is_height = False
    if not is_height:
        notes.append(
            f"the GeoTIFF keys name {vertical} as vertical CRS, which is none; it is left open"
        )
        return crs
    named = coordinate_system(height.to_wkt()).vertical_unit
    if unit is not None and named is not None and named != unit:
        notes.append(
            f"the GeoTIFF keys name EPSG:{code}, which is in {_spaced(named)}, and say that z is "
            f"in {_spaced(unit)}; the unit holds and the vertical CRS is left open"
        )
        return crs
    try:
        return CompoundCRS(f"{crs.name} + {height.name}", [crs, height])
    except CRSError:
        notes.append(f"EPSG:{code} does not go with {crs.name}; the vertical CRS is left open")
        return crs


def _spaced(unit: str) -> str:
    return unit.replace("_", " ")
