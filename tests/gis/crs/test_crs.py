"""Units, the local metric frame, and where it refuses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wavelet_gis.crs.agreement import agreed
from wavelet_gis.crs.frame import (
    CoordinateSystem,
    Georeference,
    LocalFrame,
    metres_per_degree,
    vertical_unit_name,
    working_frame,
)
from wavelet_gis.crs.lookup import coordinate_system, epsg_of
from wavelet_gis.errors import CrsError

DEGREES = CoordinateSystem(
    wkt="x", name="WGS 84", kind="geographic", horizontal_unit=math.radians(1)
)


def test_metres_per_degree_are_those_of_the_ellipsoid():
    pyproj = pytest.importorskip("pyproj")
    geod = pyproj.Geod(ellps="WGS84")
    for latitude in (-60.0, -10.0, 0.0, 33.0, 45.0, 70.0):
        east, north = metres_per_degree(latitude, DEGREES)
        half = 5e-4
        assert east == pytest.approx(
            geod.inv(-half, latitude, half, latitude)[2] / (2 * half), rel=1e-8
        )
        assert north == pytest.approx(
            geod.inv(0, latitude - half, 0, latitude + half)[2] / (2 * half), rel=1e-8
        )


@given(
    west=st.floats(-179, 178),
    south=st.floats(-70, 68),
    points=st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(-100, 9000)), min_size=1),
    unit=st.sampled_from(["metre", "foot", "us_survey_foot"]),
)
def test_the_frame_is_left_as_it_was_entered(west, south, points, unit):
    frame = working_frame(DEGREES, (west, south, west + 1, south + 1), unit)
    coordinates = np.array(points) + np.array([west, south, 0])
    back = frame.to_file(frame.to_local(coordinates))
    np.testing.assert_allclose(back, coordinates, rtol=1e-14, atol=1e-12)


def test_feet_over_degrees_are_converted_and_not_mixed():
    frame = working_frame(DEGREES, (7, 43, 8, 44), "ft")
    assert frame.z_scale == 0.3048
    assert 70_000 < frame.x_scale < 90_000


@pytest.mark.parametrize(
    ("definition", "unit", "z_scale"),
    [
        ("EPSG:2154", None, 1.0),
        ("EPSG:2994", None, 1.0),  # x and y in feet, and so is z where nothing is said
        ("EPSG:2994", "metre", 1 / 0.3048),
        ("EPSG:2154+5703", None, 1.0),
        ("EPSG:2154", "foot", 0.3048),
        ("EPSG:2991+6360", None, 1200 / 3937),  # the vertical CRS is in US survey feet
        (None, None, 1.0),
        (None, "foot", 1.0),  # nothing is known to convert it to
    ],
)
def test_z_is_brought_to_the_unit_of_the_plane(definition, unit, z_scale):
    system = coordinate_system(definition)
    frame = working_frame(system, (600000, 6000000, 601000, 6001000), unit)
    assert frame.z_scale == pytest.approx(z_scale, rel=1e-12)
    assert (frame.x_origin, frame.y_origin, frame.x_scale, frame.y_scale) == (0, 0, 1, 1)


def test_a_projected_crs_is_worked_on_to_the_bit():
    coordinates = np.array([[635619.85, 848899.7, 406.59]])
    frame = working_frame(coordinate_system("EPSG:2154"), (0, 0, 1, 1))
    assert frame.is_identity
    assert frame.to_file(frame.to_local(coordinates)).tobytes() == coordinates.tobytes()


@pytest.mark.parametrize(
    "bounds",
    [
        (0, 40, 5, 45),  # five degrees of latitude at mid latitudes still serve
        (0, -5, 5, 5),
        (10, 60, 13, 62.5),
        (-125.0, 48.0, -124.0, 49.0),
        (359.0, 45.0, 361.0, 46.0),  # longitudes that run on
    ],
)
def test_what_one_frame_serves(bounds):
    frame = working_frame(DEGREES, bounds)
    for latitude in bounds[1::2]:
        east = metres_per_degree(latitude, DEGREES)[0]
        assert abs(frame.x_scale / east - 1) < 0.06


@pytest.mark.parametrize(
    ("bounds", "what"),
    [
        ((-180, -90, 180, 90), "reproject"),
        ((0, 40, 10, 50), "reproject"),
        ((0, 0, 30, 1), "reproject"),
        ((10, 78, 12, 81), "reproject"),
        ((500000, 5100000, 510000, 5110000), "not degrees"),
        ((0, 45, float("nan"), 46), "not finite"),
    ],
)
def test_what_no_frame_serves_is_refused_with_the_remedy(bounds, what):
    with pytest.raises(CrsError, match=what):
        working_frame(DEGREES, bounds)


def test_units_by_many_names():
    assert vertical_unit_name(" Metre ") == "metre"
    assert vertical_unit_name("ftUS") == "us_survey_foot"
    with pytest.raises(CrsError, match="fathom"):
        vertical_unit_name("fathom")


@pytest.mark.parametrize(
    ("definition", "kind", "unit"),
    [
        ("EPSG:4326", "geographic", math.radians(1)),
        ("EPSG:4807", "geographic", math.pi / 200),  # grads, from Paris
        ("EPSG:4979", "geographic", math.radians(1)),
        ("EPSG:2154", "projected", 1.0),
        ("EPSG:2225", "projected", 1200 / 3937),
        ("EPSG:4978", "unknown", 1.0),
        ('LOCAL_CS["site",UNIT["metre",1]]', "unknown", 1.0),
        ("", "unknown", 1.0),
    ],
)
def test_what_pyproj_tells(definition, kind, unit):
    system = coordinate_system(definition)
    assert system.kind == kind
    assert system.horizontal_unit == pytest.approx(unit, rel=1e-12)


def test_a_crs_that_is_none_is_refused():
    with pytest.raises(CrsError, match="EPSG:2154"):
        coordinate_system("Atlantis 1900")


def test_wkt_is_kept_as_it_came():
    wkt = 'LOCAL_CS["site",UNIT["metre",1]]'
    assert coordinate_system(wkt).wkt == wkt
    assert epsg_of(coordinate_system("EPSG:2154")) == 2154
    assert epsg_of(CoordinateSystem()) is None


def test_frames_and_systems_survive_json():
    system, frame = coordinate_system("EPSG:4326"), working_frame(DEGREES, (7, 43, 8, 44), "foot")
    assert CoordinateSystem.from_dict(system.to_dict()) == system
    assert LocalFrame.from_dict(frame.to_dict()) == frame


@pytest.mark.parametrize(
    "damage",
    [
        {"x_scale": 0.0},
        {"y_scale": float("inf")},
        {"z_scale": -1.0},
        {"x_origin": float("nan")},
        {"x_scale": "wide"},
        {"w_scale": 1.0},
    ],
)
def test_a_damaged_frame_is_refused(damage):
    with pytest.raises(CrsError, match=r"damaged|no length"):
        LocalFrame.from_dict(LocalFrame().to_dict() | damage)


@pytest.mark.parametrize(
    "damage",
    [{"kind": "flat"}, {"semi_major": None}, {"horizontal_unit": "m"}, {"vertical_unit": "cubit"}],
)
def test_a_damaged_system_is_refused(damage):
    with pytest.raises(CrsError):
        CoordinateSystem.from_dict(CoordinateSystem().to_dict() | damage)


@pytest.mark.parametrize("factors", [(0, 1), (1, 0), (-1, -1), (1, 0.3048)])
def test_units_in_which_nothing_can_be_measured(factors):
    """A unit of 0 metres, as one flipped byte makes it, ended in a division by zero."""
    pyproj = pytest.importorskip("pyproj")
    wkt = pyproj.CRS("EPSG:25832").to_wkt()
    head, axes = wkt.split("CS[Cartesian,2]")
    for factor in factors:
        axes = axes.replace('LENGTHUNIT["metre",1]', f'LENGTHUNIT["x{factor}",{factor}]', 1)
    with pytest.raises(CrsError, match="counts x and y in units of"):
        coordinate_system(head + "CS[Cartesian,2]" + axes)


def test_a_broken_crs_among_several_is_said_in_one_line():
    places = [Georeference(wkt="EPSG:32632"), Georeference(wkt='PROJCS["broken')]
    with pytest.raises(CrsError) as error:
        agreed(["a.tif", "b.tif"], places)
    assert "\n" not in str(error.value)
