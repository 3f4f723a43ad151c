"""Units of every pair, and planes that are true to scale."""

import itertools
import re
import warnings

import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_tif
from pyproj import CRS

from wavelet_core import analyse, synthetic
from wavelet_gis.crs.frame import (
    VERTICAL_UNITS,
    CoordinateSystem,
    assumed_vertical_unit,
    working_frame,
)
from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.crs.projection import plane_for, projected, scale_at
from wavelet_gis.errors import CrsError, CrsWarning, OutputFileError, UnitWarning
from wavelet_gis.io.mesh.meshes import MESH_SUFFIXES, write_mesh
from wavelet_gis.notes import collected
from wavelet_gis.products.plane_mesh import plane_mesh
from wavelet_gis.workflows.open import open_input, open_terrain

UTM = "+proj=utm +zone=32 +datum=WGS84"
HORIZONTAL = {"m": 1.0, "ft": 0.3048, "us-ft": 1200 / 3937, "km": 1000.0}
LANDXML = {"m": "meter", "ft": "foot", "us-ft": "USSurveyFoot", "km": "kilometer"}


def dem_in(tmp_path, unit, vertical=None, z_in_metres=True):
    """Write a DEM whose ground is the same whatever the units are."""
    metres = HORIZONTAL[unit]
    z_unit = VERTICAL_UNITS[vertical] if vertical else (1.0 if z_in_metres else metres)
    transform = rasterio.Affine(10 / metres, 0, 5e5 / metres, 0, -10 / metres, 5.1e6 / metres)
    values = hills(20, 20) / z_unit
    crs = CRS.from_proj4(f"{UTM} +units={unit}").to_wkt("WKT1_GDAL")
    return write_tif(tmp_path / f"{unit}.tif", values, crs=crs, transform=transform)


def geo_of(path, **options):
    terrain = open_terrain(path, **options)
    return terrain.geo_pyramid(analyse(terrain.mesh, levels=1))


@pytest.mark.parametrize(("unit", "vertical"), list(itertools.product(HORIZONTAL, VERTICAL_UNITS)))
def test_slopes_are_those_of_the_ground_for_any_pair_of_units(tmp_path, unit, vertical):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnitWarning)
        geo = geo_of(dem_in(tmp_path, unit, vertical), vertical_unit=vertical)
    mesh = geo.pyramid.synthesise()
    metres = mesh.vertices * HORIZONTAL[unit]
    np.testing.assert_allclose(np.ptp(metres[:, 2]), np.ptp(hills(20, 20)), rtol=1e-9)
    np.testing.assert_allclose(np.ptp(metres[:, 0]), 190.0, rtol=1e-9)
    # What goes into a mesh file has one unit, and LandXML names it.
    write_mesh(tmp_path / "a.xml", plane_mesh(geo, mesh).mesh, geo.system.wkt)
    named = re.search(r'linearUnit="(\w+)"', (tmp_path / "a.xml").read_text("utf-8"))[1]
    assert named == LANDXML[unit]
    z = re.findall(r'<P id="\d+">\S+ \S+ (\S+)</P>', (tmp_path / "a.xml").read_text("utf-8"))
    heights = np.array(z, dtype=float) * HORIZONTAL[unit]
    np.testing.assert_allclose(np.ptp(heights), np.ptp(hills(20, 20)), rtol=1e-9)


def test_heights_over_kilometres_are_metres_and_told(tmp_path):
    source = dem_in(tmp_path, "km")
    with pytest.warns(UnitWarning, match="units of 1000 m.*metres are assumed"):
        terrain = open_terrain(source)
    assert terrain.vertical_unit == "metre"
    slope = np.ptp(terrain.mesh.vertices[:, 2]) / np.ptp(terrain.mesh.vertices[:, 0])
    assert slope < 1


@pytest.mark.parametrize(
    ("definition", "unit"),
    [
        ("EPSG:32632", "metre"),
        ("EPSG:4326", "metre"),
        ("EPSG:2264", "us_survey_foot"),
        ("EPSG:2222", "foot"),
        (f"{UTM} +units=km", "metre"),
        (f"{UTM} +units=link", "metre"),
        ("", "unit of x and y"),
    ],
)
def test_the_unit_of_z_where_nothing_tells_it(definition, unit):
    assert assumed_vertical_unit(coordinate_system(definition)) == unit


@pytest.mark.parametrize(
    ("wkt", "unit"),
    [
        ('PROJCS["x",GEOGCS["g",UNIT["Degree",0.0174]],UNIT["Foot_US",0.3048006096012192]]', "USS"),
        ('PROJCS["x",UNIT["Foot",0.3048]]', "foot"),
        ('PROJCS["a [foot] plan",UNIT["Meter",1.0]]', "meter"),
        (CRS("EPSG:26910+6360").to_wkt("WKT1_GDAL"), "meter"),
        (CRS("EPSG:26910+6360").to_wkt(), "meter"),
        (CRS("EPSG:2264+6360").to_wkt(), "USS"),
        (CRS("EPSG:2264").to_wkt("WKT1_ESRI"), "USS"),
        (CRS("EPSG:2222+5703").to_wkt(), "foot"),
    ],
)
def test_landxml_has_the_unit_of_x_and_y(tmp_path, wkt, unit):
    geo_mesh = synthetic.hills(4, 4)
    write_mesh(tmp_path / "a.xml", geo_mesh, wkt)
    assert f'linearUnit="{unit}' in (tmp_path / "a.xml").read_text("utf-8")


def test_landxml_refuses_a_unit_that_it_cannot_name(tmp_path):
    geo_mesh = synthetic.hills(4, 4)
    with pytest.raises(OutputFileError, match=r"0\.201168"):
        write_mesh(tmp_path / "a.xml", geo_mesh, 'PROJCS["x",UNIT["link",0.201168]]')


@pytest.mark.parametrize(
    ("definition", "x", "y", "scale"),
    [
        ("EPSG:3857", 1e6, 11e6, 2.9),
        ("EPSG:3857", 1e6, 0, 1.0),
        ("EPSG:3395", 1e6, 11e6, 2.9),
        ("EPSG:32632", 5e5, 5.1e6, 1.0),
        ("EPSG:4326", 7, 44, 1.0),
    ],
)
def test_the_scale_of_a_plane(definition, x, y, scale):
    assert scale_at(coordinate_system(definition), x, y) == pytest.approx(scale, abs=0.05)


def test_web_mercator_in_the_north_is_told(tmp_path):
    transform = rasterio.Affine(10.0, 0.0, 1e6, 0.0, -10.0, 11e6)
    source = write_tif(tmp_path / "a.tif", hills(), crs="EPSG:3857", transform=transform)
    with pytest.warns(CrsWarning, match=r"Mercator are 2\.89 times too long"):
        terrain = open_input(source)
    assert [note.code for note in terrain.notes] == ["plane_not_true_to_scale"]


@pytest.mark.parametrize(
    ("crs", "west", "north", "code"),
    [
        ("EPSG:4326", 7.0, 44.0, 32632),
        ("EPSG:4326", -70.0, -33.0, 32719),
        ("EPSG:4326", 182.0, 10.0, 32601),  # 178 W
        ("EPSG:4258", 7.0, 44.0, 25832),
        ("EPSG:4269", -120.0, 40.0, 26911),
        ("EPSG:4326", 10.0, 86.0, 5041),
    ],
)
def test_degrees_go_to_the_utm_zone_that_fits(crs, west, north, code):
    system = coordinate_system(crs)
    plane = plane_for(system, np.array([[west, north], [west + 0.01, north + 0.01]]))
    assert CRS(plane.wkt).to_epsg() == code
    east, north_of = projected(system, plane, np.array([west]), np.array([north]))
    assert np.isfinite([east, north_of]).all()


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_no_mesh_file_has_degrees(tmp_path, suffix):
    pytest.importorskip({".glb": "trimesh", ".dxf": "ezdxf"}.get(suffix, "numpy"))
    transform = rasterio.Affine(0.0003, 0.0, 7.0, 0.0, -0.0003, 44.0)
    source = write_tif(tmp_path / "a.tif", hills(), crs="EPSG:4326", transform=transform)
    geo = geo_of(source)
    with collected() as notes:
        placed = plane_mesh(geo, geo.pyramid.synthesise())
    assert placed.system.name == "WGS 84 / UTM zone 32N"
    assert "instead of degrees" in notes[0].text
    size = np.ptp(placed.mesh.vertices, axis=0)
    assert 1100 < size[0] < 1300  # 49 cells of 24 m
    assert 1250 < size[1] < 1400  # 39 cells of 33 m
    np.testing.assert_allclose(size[2], np.ptp(hills()), rtol=1e-9)
    write_mesh(tmp_path / f"a{suffix}", placed.mesh, placed.system.wkt)


def test_a_mesh_goes_to_the_crs_that_is_named(tmp_path):
    source = write_tif(tmp_path / "a.tif", hills())
    geo = geo_of(source)
    mesh = geo.pyramid.synthesise()
    with collected() as notes:
        plane_mesh(geo, mesh)
    assert notes == []
    placed = plane_mesh(geo, mesh, "EPSG:25833")
    assert "zone 33N" in placed.system.name
    assert not np.allclose(placed.mesh.vertices[:, 0], mesh.vertices[:, 0])
    with pytest.raises(CrsError, match="is not projected"):
        plane_mesh(geo, mesh, "EPSG:4326")


def test_data_on_both_sides_of_the_antimeridian_are_named():
    degrees = CoordinateSystem(kind="geographic", horizontal_unit=np.pi / 180)
    with pytest.raises(CrsError, match="antimeridian"):
        working_frame(degrees, (-179.9, -17.0, 179.9, -16.0))
    working_frame(degrees, (179.9, -17.0, 180.1, -16.0))
