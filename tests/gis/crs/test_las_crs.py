"""The CRS that WKT records and GeoTIFF keys of LAS files tell, and what they tell wrongly."""

import struct

import pytest
from pyproj import CRS

from wavelet_gis.crs.las import las_crs
from wavelet_gis.crs.lookup import coordinate_system

PROJECTED, GEOGRAPHIC, UNIT, VERTICAL, VERTICAL_UNIT, MODEL = 3072, 2048, 3076, 4096, 4099, 1024
METRE, FOOT, US_FOOT = 9001, 9002, 9003


def keys(**of_key):
    """Return a record of GeoTIFF keys, by the names above."""
    entries = [(globals()[name], value) for name, value in of_key.items()]
    data = struct.pack("<4H", 1, 1, 0, len(entries))
    return 34735, data + b"".join(struct.pack("<4H", key, 0, 1, value) for key, value in entries)


def wkt(text):
    return 2112, text if isinstance(text, bytes) else text.encode() + b"\0"


def parts_of(place):
    crs = CRS.from_wkt(place.wkt)
    return [part.to_epsg() for part in crs.sub_crs_list] if crs.is_compound else [crs.to_epsg()]


@pytest.mark.parametrize(
    ("datum", "unit", "expected"),
    [
        (5103, METRE, 5703),
        (5103, FOOT, 8228),
        (5103, US_FOOT, 6360),
        (5102, US_FOOT, 5702),
        (5102, METRE, 7968),
        (5101, METRE, 5701),
        (5105, METRE, 5705),
        (5703, METRE, 5703),
        (6360, US_FOOT, 6360),
    ],
)
def test_a_vertical_datum_and_a_unit_are_a_vertical_crs(datum, unit, expected):
    place = las_crs([keys(PROJECTED=2903, VERTICAL=datum, VERTICAL_UNIT=unit)])
    assert parts_of(place) == [2903, expected]
    assert place.notes == ()


@pytest.mark.parametrize(
    ("vertical", "unit", "words"),
    [
        (5103, None, "vertical datum NAVD88 .* left open"),
        (5101, FOOT, "Newlyn .* z in foot; .* left open"),
        (5030, METRE, "5030 as vertical CRS, which is none"),
        (1030, None, "which is none"),
        (4326, None, "which is none"),
        (5703, US_FOOT, "which is in metre, and say that z is in us survey foot"),
    ],
)
def test_a_height_that_is_not_known_leaves_the_horizontal_crs(vertical, unit, words):
    more = {} if unit is None else {"VERTICAL_UNIT": unit}
    place = las_crs([keys(PROJECTED=26910, VERTICAL=vertical, **more)])
    assert parts_of(place) == [26910]
    assert place.fault == ""
    assert len(place.notes) == 1
    import re

    assert re.search(words, place.notes[0])
    if unit:
        assert (
            place.vertical_unit == {METRE: "metre", FOOT: "foot", US_FOOT: "us_survey_foot"}[unit]
        )


@pytest.mark.parametrize("code", [25832, 2903, 2227, 3857])
@pytest.mark.parametrize("unit", [METRE, FOOT, US_FOOT])
def test_a_unit_that_the_crs_does_not_have_is_told(code, unit):
    place = las_crs([keys(PROJECTED=code, UNIT=unit)])
    factor = CRS.from_epsg(code).axis_info[0].unit_conversion_factor
    told = {METRE: 1.0, FOOT: 0.3048, US_FOOT: 1200 / 3937}[unit]
    assert bool(place.notes) == (abs(factor - told) > 1e-9)


def test_degrees_with_metres_of_height():
    place = las_crs([keys(GEOGRAPHIC=4269, VERTICAL=5103, VERTICAL_UNIT=METRE)])
    system = coordinate_system(place.wkt)
    assert system.kind == "geographic"
    assert system.vertical_unit == "metre"


@pytest.mark.parametrize("text", ["", "PROJCS[", b"\xff\xfe", "GEOGCS[nonsense]", b"\0\0"])
def test_keys_stand_in_for_a_broken_wkt_with_a_line(text):
    place = las_crs([wkt(text), keys(PROJECTED=25832)])
    assert parts_of(place) == [25832]
    assert "the CRS is that of the GeoTIFF keys" in place.notes[0]
    assert las_crs([wkt(text)]).fault


@pytest.mark.parametrize(
    ("name", "factor", "expected"),
    [
        ("Foot_US", 0.30480060960121924, "us_survey_foot"),
        ("US survey foot", 0.3048006096012192, "us_survey_foot"),
        ("Foot", 0.3048, "foot"),
        ("International Foot", 0.3048, "foot"),
        ("foot", 0.3048006096012192, "us_survey_foot"),
        ("something", 0.3048, "foot"),
        ("Meter", 1.0, "metre"),
    ],
)
def test_the_factor_of_a_unit_counts_not_its_name(name, factor, expected):
    text = (
        'COMPD_CS["both",' + CRS.from_epsg(26910).to_wkt("WKT1_GDAL")
        + f',VERT_CS["height",VERT_DATUM["NAVD88",2005],UNIT["{name}",{factor}],AXIS["Up",UP]]]'
    )  # fmt: skip
    place = las_crs([wkt(text)])
    system = coordinate_system(place.wkt)
    assert system.vertical_unit == expected
    assert system.horizontal_unit == 1.0


def test_a_unit_of_z_in_the_keys_only_adds_to_a_wkt():
    plain = CRS.from_epsg(26910).to_wkt()
    assert las_crs([wkt(plain), keys(VERTICAL_UNIT=FOOT)]).vertical_unit == "foot"
    both = CRS.from_user_input("EPSG:26910+5703").to_wkt()
    place = las_crs([wkt(both), keys(VERTICAL_UNIT=US_FOOT)])
    assert place.vertical_unit is None
    assert "the WKT says that z is in metre, the GeoTIFF keys in us survey foot" in place.notes[0]
    assert las_crs([wkt(both), keys(VERTICAL_UNIT=METRE)]).notes == ()


@pytest.mark.parametrize("data", [b"", b"\1", bytes(7), bytes(8), bytes(13), bytes(80)])
def test_keys_that_are_none(data):
    assert las_crs([(34735, data)]).wkt is None


def test_a_code_that_nobody_knows():
    place = las_crs([keys(PROJECTED=1100)])
    assert place.wkt is None
    assert "EPSG:1100 of its GeoTIFF keys is not known" in place.fault


def test_a_vertical_crs_is_no_horizontal_one():
    assert "no horizontal CRS" in las_crs([keys(PROJECTED=5703)]).fault
