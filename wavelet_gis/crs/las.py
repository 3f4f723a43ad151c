"""The CRS of a LAS file, out of its WKT and GeoTIFF records."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wavelet_gis.crs.frame import Georeference

if TYPE_CHECKING:
    from laspy import LasHeader
    from pyproj import CRS

__all__ = ["las_crs"]

# GeoTIFF keys, and the codes of the GeoTIFF specification that matter here.
_MODEL_TYPE, _GEOGRAPHIC_CS, _PROJECTED_CS, _VERTICAL_CS, _VERTICAL_UNIT = (
    1024,
    2048,
    3072,
    4096,
    4099,
)
_MODEL_PROJECTED = 1
_EPSG_CODES = range(1024, 32767)
_UNITS = {9001: "metre", 9002: "foot", 9003: "us_survey_foot"}


def las_crs(header: LasHeader) -> Georeference:
    """Return the CRS of a LAS file and its unit of z, with what is wrong with them.

    The WKT record is preferred; where it is broken or empty, the GeoTIFF keys are tried.

    Parameters
    ----------
    header : LasHeader
        As laspy read it.
    """
    records = [*header.vlrs, *(header.evlrs or [])]
    records = [r for r in records if r.user_id.strip() == "LASF_Projection"]
    keys = _geo_keys(records)
    unit = _UNITS.get(keys.get(_VERTICAL_UNIT, 0))
    faults: list[str] = []
    for geo in records:
        if geo.record_id == 2112:
            wkt = _text_of(geo)
            if _is_understood(wkt, faults):
                return Georeference(wkt, unit)
    crs = _from_keys(keys, faults)
    if crs is not None:
        return Georeference(crs.to_wkt(), unit)
    return Georeference(None, unit, faults[0] if faults else "")


def _text_of(geo: Any) -> str:
    raw: bytes = geo.record_data_bytes()
    return raw.split(b"\0")[0].decode("utf-8", errors="replace").strip()


def _is_understood(wkt: str, faults: list[str]) -> bool:
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    if not wkt:
        faults.append("its WKT is empty")
        return False
    try:
        CRS.from_wkt(wkt)
    except CRSError:
        faults.append(f"its WKT is not understood: {wkt[:40]}...")
        return False
    return True


def _geo_keys(records: list[Any]) -> dict[int, int]:
    """Return the keys that hold their value themselves, by id."""
    for geo in records:
        if geo.record_id == 34735 and hasattr(geo, "geo_keys"):
            return {
                int(key.id): int(key.value_offset)
                for key in geo.geo_keys
                if int(key.tiff_tag_location) == 0
            }
    return {}


def _from_keys(keys: dict[int, int], faults: list[str]) -> CRS | None:
    from pyproj import CRS
    from pyproj.crs import CompoundCRS
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
        vertical = keys.get(_VERTICAL_CS, 0)
        if vertical in _EPSG_CODES and not crs.is_compound:
            height = CRS.from_epsg(vertical)
            if height.is_vertical:
                return CompoundCRS(f"{crs.name} + {height.name}", [crs, height])
    except CRSError:
        faults.append(f"EPSG:{code} of its GeoTIFF keys is not known")
        return None
    return crs
