"""Layers and tables as `tests/tools/mutate.py mesh` made them: one line, at once, no traceback."""

import numpy as np
import pyogrio
import pytest
import shapely

from wavelet_core import TriangleMesh
from wavelet_core.errors import MeshError
from wavelet_gis.errors import InputFileError, LayerWarning
from wavelet_gis.io.vector.point_table import read_point_table
from wavelet_gis.workflows.open import open_input

TRIANGLE = [[5e5, 5.1e6, 300.0], [500010.0, 5.1e6, 301.0], [5e5, 5100010.0, 302.0]]


def write_layer(path, shapes, kind):
    wkb = shapely.to_wkb(np.asarray(shapes, dtype=object))
    write_wkb(path, wkb, kind)


def write_wkb(path, wkb, kind):
    pyogrio.raw.write(
        path, wkb, [np.arange(len(wkb))], ["id"], crs="EPSG:25832", geometry_type=kind,
        driver="GPKG",
    )  # fmt: skip


def one_line(path):
    with pytest.raises(InputFileError) as caught:
        open_input(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_ring_that_is_not_closed(tmp_path):
    ring = shapely.to_wkb(shapely.polygons([TRIANGLE]))[0]
    damaged = bytearray(ring)
    damaged[-24] ^= 4  # x of the last corner
    write_wkb(tmp_path / "open.gpkg", np.array([bytes(damaged)], dtype=object), "Polygon Z")
    assert "a shape of the layer open is damaged" in one_line(tmp_path / "open.gpkg")


@pytest.mark.parametrize("number", ["1e308", "-1e308", "1e16"])
@pytest.mark.parametrize("column", [0, 1])
def test_a_point_where_no_crs_reaches_is_refused_before_it_is_triangulated(
    tmp_path, number, column
):
    """The triangulation never came back from a point at 1e308."""
    rows = [[f"{value}" for value in corner] for corner in [*TRIANGLE, *np.add(TRIANGLE, 3.0)]]
    rows[2][column] = number
    (tmp_path / "far.csv").write_text("x,y,z\n" + "\n".join(map(",".join, rows)) + "\n")
    assert "which no terrain has" in one_line(tmp_path / "far.csv")


def test_a_height_beyond_all_measure_is_refused_in_points_and_in_triangles(tmp_path):
    """Its square ended in an OverflowError."""
    corners = [*TRIANGLE[:2], [*TRIANGLE[2][:2], 1e200]]
    write_layer(tmp_path / "t.gpkg", [shapely.Polygon(corners)], "Polygon Z")
    write_layer(tmp_path / "p.gpkg", shapely.points(corners), "Point Z")
    for name in ("t.gpkg", "p.gpkg"):
        assert "z 1e+200, which no terrain has" in one_line(tmp_path / name)


def test_a_kml_with_bytes_that_are_no_text(tmp_path):
    """GDAL's complaint quotes them, and rasterio fails to decode it."""
    (tmp_path / "x.kml").write_bytes(b'<?xml version="1.0"?><kml xmlns="http\xff://x"><\xff></kml>')
    one_line(tmp_path / "x.kml")


def test_what_gdal_complains_of_is_told_and_not_printed(tmp_path, capfd):
    path = tmp_path / "odd.gpkg"
    write_layer(path, shapely.points([*TRIANGLE, [500010.0, 5100010.0, 3.0]]), "Point Z")
    content = bytearray(path.read_bytes())
    content[68:72] = b"GPIG"
    path.write_bytes(content)
    with pytest.warns(LayerWarning, match="read, but GDAL reported: .*application_id"):
        assert open_input(path).mesh.n_vertices == 4
    assert capfd.readouterr().err == ""


def test_numbers_too_large_for_their_squares_are_refused():
    points = np.array(TRIANGLE)
    points[1, 0] = 1e80
    with pytest.raises(MeshError, match="vertex 1: its coordinate is beyond 1e\\+75"):
        TriangleMesh.from_points(points)
    with pytest.raises(MeshError, match="vertex 2: its attribute is beyond"):
        TriangleMesh.from_points(np.array(TRIANGLE), np.array([1.0, 2.0, -1e90]), ["a"])


def test_points_that_the_triangulation_takes_for_equal_are_refused_in_one_line():
    points = [[0.0, 0.0, 1.0], [3e-241, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 2.0]]
    try:
        mesh = TriangleMesh.from_points(points)
    except MeshError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert mesh.n_vertices == 4


def test_a_number_with_a_comment_mark_in_it_is_no_shorter_number(tmp_path):
    """``301.#94`` was read as 301 without a word; lines that begin with the mark are comments."""
    rows = [f"{x:.1f},{y:.1f},{300 + x * y:.3f}" for x in range(4) for y in range(4)]
    text = "# a survey\nx,y,z\n# of a hill\n" + "\n".join(rows) + "\n"
    path = tmp_path / "points.csv"
    path.write_text(text.partition("\n")[2])
    assert len(read_point_table(path).points) == 16
    path.write_text(text.partition("\n")[2].replace("309.000", "309.#00"))
    assert "309.#00" in one_line(path)
    path = tmp_path / "points.xyz"
    path.write_text("\n# of a hill\n".join(rows).replace(",", " ") + "\n")
    assert len(read_point_table(path).points) == 16


@pytest.mark.parametrize(
    "heading", ["# x y z intensity", "# a survey\n#X Y Z intensity", "#x,y,z,intensity"]
)
def test_names_in_a_comment_are_those_of_the_columns(tmp_path, heading):
    """``# x y z intensity`` made x of the second column, y of the third, z of the intensity."""
    path = tmp_path / "points.xyz"
    path.write_text(f"{heading}\n0 1 10 100\n1 2 11 200\n2 5 12 300\n")
    expected = [[0, 1, 10], [1, 2, 11], [2, 5, 12]]
    np.testing.assert_array_equal(read_point_table(path).points, expected)
    table = read_point_table(path, ("intensity",))
    np.testing.assert_array_equal(table.attributes, [[100], [200], [300]])


@pytest.mark.parametrize(
    "comment", ["# made by a scanner", "# the columns are x y z", "# z y x\n#"]
)
def test_a_table_may_begin_with_a_comment(tmp_path, comment):
    """It was refused for want of a column x, or its words were taken for names of columns."""
    path = tmp_path / "points.xyz"
    path.write_text(f"{comment}\n0 1 10\n1 2 11\n2 5 12\n")
    first = [10, 1, 0] if "z y x\n" in comment else [0, 1, 10]
    np.testing.assert_array_equal(read_point_table(path).points[0], first)
    path.write_text(f"{comment}\nx;y;z\n0;1;10\n")
    np.testing.assert_array_equal(read_point_table(path).points[0], [0, 1, 10])


@pytest.mark.parametrize(("option", "value"), [("attributes", ("name",)), ("z_field", "name")])
def test_a_field_of_words_is_refused_in_one_line(tmp_path, option, value):
    """It ended in ``could not convert string to float``."""
    path = tmp_path / "points.gpkg"
    points = shapely.to_wkb(np.array([shapely.Point(*corner) for corner in TRIANGLE], dtype=object))
    pyogrio.raw.write(
        path, points, [np.array(["a", "b", "c"], dtype=object)], ["name"], crs="EPSG:25832",
        geometry_type="Point Z", driver="GPKG",
    )  # fmt: skip
    with pytest.raises(
        InputFileError, match=rf"'name' does not hold numbers; name another with {option}"
    ):
        open_input(path, **{option: value})
