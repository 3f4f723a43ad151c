"""The layers of a pyramid: what is in them, and that QGIS and GDAL take them."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pyogrio
import pytest
import shapely

from wavelet_gis.io.pyramid.pyramid_file import write_pyramid
from wavelet_gis.io.vector.vector_writer import add_layers
from wavelet_gis.products.layers import coarse_layers, detail_layers, slopes, tin_layers
from wavelet_gis.products.styles import detail_style, tin_style, vertex_style
from wavelet_gis.products.wkb import points_wkb, triangles_wkb


@pytest.fixture(scope="module", params=["raster", "cloud"])
def geo(request):
    return request.getfixturevalue(f"{request.param}_record")


@pytest.fixture(scope="module")
def geopackage(geo, tmp_path_factory):
    path = tmp_path_factory.mktemp("layers") / "pyramid.gpkg"
    write_pyramid(path, geo)
    add_layers(path, [*coarse_layers(geo), *detail_layers(geo)], geo.system)
    return path


def test_wkb_is_what_shapely_reads(rng):
    vertices = rng.normal(size=(5, 3))
    faces = np.array([[0, 1, 2], [2, 3, 4]])
    points = shapely.from_wkb(points_wkb(vertices))
    assert (shapely.get_coordinates(points, include_z=True) == vertices).all()
    polygons = shapely.from_wkb(triangles_wkb(vertices, faces))
    assert (shapely.get_type_id(polygons) == shapely.GeometryType.POLYGON).all()
    corners = shapely.get_coordinates(polygons, include_z=True).reshape(2, 4, 3)
    assert (corners == vertices[faces[:, [0, 1, 2, 0]]]).all()
    assert len(points_wkb(vertices[:0])) == 0


def test_it_is_a_valid_geopackage(geopackage, validate_gpkg):
    validate_gpkg(geopackage)


def test_every_layer_is_there_and_has_its_geometry(geo, geopackage):
    layers = dict(pyogrio.list_layers(geopackage))
    details = {f"detail_level_{k:02d}": "Point Z" for k in range(geo.pyramid.n_levels)}
    tables = ["metadata", "levels", "arrays", "chunks"]
    assert layers == {
        "coarse_tin": "Polygon Z",
        "coarse_vertices": "Point Z",
        **details,
        **{f"wavelet_{name}": None for name in tables},
        "layer_styles": None,
    }
    for name in ("coarse_tin", *details):
        info = pyogrio.read_info(geopackage, layer=name)
        assert "32632" in info["crs"]
        assert info["geometry_name"] == "geom"


def read(geopackage, layer):
    meta, _, geometry, fields = pyogrio.raw.read(geopackage, layer=layer)
    return shapely.from_wkb(geometry), dict(zip(meta["fields"], fields, strict=True))


def test_the_coarse_tin_is_the_coarsest_mesh(geo, geopackage):
    mesh = geo.file_mesh(geo.pyramid.mesh(0))
    polygons, fields = read(geopackage, "coarse_tin")
    corners = shapely.get_coordinates(polygons, include_z=True).reshape(-1, 4, 3)[:, :3]
    assert (corners == mesh.vertices[mesh.faces]).all()
    np.testing.assert_allclose(fields["elevation"], corners[:, :, 2].mean(axis=1))
    ids = geo.pyramid.vertex_ids(0)
    assert (fields["vertex_b"] == ids[mesh.faces[:, 1]]).all()
    assert (0 <= fields["slope"]).all()
    assert (fields["slope"] < 90).all()


def test_the_vertices_carry_ids_and_attributes(geo, geopackage):
    points, fields = read(geopackage, "coarse_vertices")
    mesh = geo.file_mesh(geo.pyramid.mesh(0))
    assert (shapely.get_coordinates(points, include_z=True) == mesh.vertices).all()
    assert (fields["vertex_id"] == geo.pyramid.vertex_ids(0)).all()
    for k, name in enumerate(mesh.attribute_names):
        assert (fields[name] == mesh.attributes[:, k]).all()


def test_details_lie_at_the_removed_vertices(geo, geopackage):
    pyramid = geo.pyramid
    for level in range(pyramid.n_levels):
        detail = pyramid.detail(level)
        points, fields = read(geopackage, f"detail_level_{level:02d}")
        assert (fields["vertex_id"] == detail.vertex_ids).all()
        assert (fields["level"] == level).all()
        assert (shapely.get_coordinates(points, include_z=True) == detail.positions).all()
        for k, channel in enumerate(pyramid.channels):
            assert (fields[f"w_{channel}"] == detail.vectors[:, k]).all()
        np.testing.assert_allclose(fields["magnitude"], detail.magnitude)


def test_every_layer_has_one_default_style(geopackage):
    import sqlite3
    from contextlib import closing

    with closing(sqlite3.connect(geopackage)) as connection, connection:
        styles = connection.execute(
            "SELECT f_table_name, f_geometry_column, useAsDefault, styleQML FROM layer_styles"
        ).fetchall()
    spatial = [name for name, kind in pyogrio.list_layers(geopackage) if kind]
    assert sorted(name for name, *_ in styles) == sorted(spatial)
    for _, column, is_default, qml in styles:
        assert (column, is_default) == ("geom", 1)
        assert ElementTree.fromstring(qml).find("renderer-v2") is not None


def test_styles_are_sound_for_odd_values():
    for values in (np.array([]), np.array([5.0]), np.full(9, 2.0), np.array([-1e30, 1e30])):
        renderer = ElementTree.fromstring(tin_style(values)).find("renderer-v2")
        n_ranges = len(renderer.find("ranges"))
        assert n_ranges == len(renderer.find("symbols")) >= 1
        for level in range(3):
            assert ElementTree.fromstring(detail_style(level, 3, np.abs(values))) is not None
    assert ElementTree.fromstring(detail_style(0, 1, np.array([np.nan, np.inf]))) is not None
    assert ElementTree.fromstring(vertex_style()) is not None


def test_levels_differ_in_colour():
    values = np.ones(3)
    styles = {detail_style(level, 8, values) for level in range(8)}
    assert len(styles) == 8


def test_slopes_of_known_faces():
    from wavelet_core import TriangleMesh

    mesh = TriangleMesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, np.sqrt(3)]], [[0, 1, 2], [1, 3, 2]]
    )
    np.testing.assert_allclose(slopes(mesh)[0], 0, atol=1e-12)
    assert 60 < slopes(mesh)[1] < 70


def test_attributes_with_names_that_sqlite_takes_for_one(raster_record, tmp_path):
    from wavelet_core import TriangleMesh

    mesh = raster_record.pyramid.mesh(0)
    names = ("Intensity", "intensity", "fid", "geom", "vertex_id", "elevation")
    attributes = np.arange(6.0) + np.zeros((mesh.n_vertices, 1))
    named = TriangleMesh(mesh.vertices, mesh.faces, attributes, names)
    ids = raster_record.pyramid.vertex_ids(0)
    add_layers(tmp_path / "a.gpkg", tin_layers(raster_record, named, ids), raster_record.system)
    _, fields = read(tmp_path / "a.gpkg", "tin_vertices")
    values = {name: column[0] for name, column in fields.items()}
    assert values["Intensity"] == 0
    assert values["intensity_2"] == 1
    assert values["fid_2"] == 2
    assert values["geom_2"] == 3
    assert values["vertex_id_2"] == 4
    assert values["elevation_2"] == 5
