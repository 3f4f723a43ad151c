"""Breaklines, a clip polygon and fixed points, through Python and the command line."""

import json

import numpy as np
import pyogrio
import pytest
import shapely
from gis.samples import UTM, hills, write_las, write_tif

import wavelet_gis as wg
from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.cli.main import main
from wavelet_gis.errors import CrsWarning, InputFileError, LayerWarning
from wavelet_gis.model.tin import tin_with_lines

X, Y = 500000.0, 5100000.0
#: The middle of the DEM of 40 rows and 50 columns at 10 m: x from X + 5 to X + 495.
TOLERANCE = 0.1


def write_shapes(path, shapes, kind, crs=UTM):
    pyogrio.raw.write(
        path,
        shapely.to_wkb(np.array(shapes, dtype=object)),
        [],
        [],
        geometry_type=kind,
        crs=crs,
        layer="it",
    )
    return path


def line(*corners):
    """Return a line by x and y (and z) from the corner of the DEM."""
    return shapely.LineString([(X + c[0], Y - c[1], *c[2:]) for c in corners])


@pytest.fixture
def dem(tmp_path):
    return write_tif(tmp_path / "dem.tif", hills(40, 50))


@pytest.fixture
def dike(tmp_path):
    shape = line((23.0, 31.0), (171.5, 202.25), (433.0, 377.0))
    return write_shapes(tmp_path / "dike.gpkg", [shape], "LineString")


def height_at(mesh, x, y):
    """Return the height of a mesh at a place by looking at all of its triangles."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    det = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
    at_b = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (y - a[:, 1])) / det
    at_c = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])) / det
    inside = (at_b >= -1e-9) & (at_c >= -1e-9) & (at_b + at_c <= 1 + 1e-9)
    z = a[:, 2] + at_b * (b[:, 2] - a[:, 2]) + at_c * (c[:, 2] - a[:, 2])
    assert inside.any(), (x, y)
    assert np.ptp(z[inside]) < 1e-5
    return z[inside][0]


def edges_of(mesh):
    return {tuple(sorted(e)) for e in mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).tolist()}


def assert_line_is_edges(mesh, shape):
    """Assert that the edges of a mesh that lie on a line are as long as it, in plan."""
    near = shape.buffer(1e-4)
    segments = [mesh.vertices[list(edge), :2] for edge in edges_of(mesh)]
    on_line = [s for s in segments if near.covers(shapely.LineString(s))]
    length = sum(np.hypot(*(s[1] - s[0])) for s in on_line)
    assert length == pytest.approx(shape.length, rel=1e-6)


def assert_tiled(mesh, area):
    """Assert that the triangles are counter-clockwise and have the area of a polygon together."""
    corners = mesh.vertices[mesh.faces][:, :, :2]
    sides = corners[:, 1:] - corners[:, :1]
    doubled = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 1, 0] * sides[:, 0, 1]
    assert (doubled > 0).all()
    assert doubled.sum() / 2 == pytest.approx(area, rel=1e-6)


def places_along(shape, step=1.7):
    for at in np.arange(0.0, shape.length, step):
        yield shape.interpolate(at).coords[0]


def test_a_line_without_z_lies_on_the_dem_all_along(dem, dike):
    shape = line((23.0, 31.0), (171.5, 202.25), (433.0, 377.0))
    plain = wg.open(dem).mesh
    terrain = wg.open(dem, breaklines=dike, line_tolerance=TOLERANCE)
    assert_tiled(terrain.mesh, 490.0 * 390.0)
    for tin in (
        terrain.mesh,
        wg.simplify(terrain, vertices=300).mesh,
        wg.simplify(terrain, max_error=2.0).mesh,
    ):
        assert_line_is_edges(tin, shape)
        off = [abs(height_at(tin, *p) - height_at(plain, *p)) for p in places_along(shape)]
        assert max(off) <= TOLERANCE * (1 + 1e-6)


def test_the_error_along_lines_is_told(dem, dike, capsys):
    words = ["simplify", dem, "tin.ply", "--breaklines", dike, "--line-tolerance", "0.1"]
    words[2] = dem.with_suffix(".ply")
    words = [*map(str, words), "--vertices", "300"]
    assert main(words) == 0
    assert "along the lines: RMSE " in capsys.readouterr().out
    assert main([*words, "--overwrite", "--json"]) == 0
    along = json.loads(capsys.readouterr().out)["along_lines"]
    assert 0 < along["rmse"] <= along["max_error"] <= 0.1 * (1 + 1e-6)
    assert along["n_uncovered"] == 0


def test_max_error_is_the_tolerance_of_lines_too(dem, dike, capsys):
    output = str(dem.with_suffix(".ply"))
    words = ["simplify", str(dem), output, "--breaklines", str(dike), "--json"]
    vertices = []
    for rule in ("0.5", "3"):
        assert main([*words, "--max-error", rule, "--overwrite"]) == 0
        figures = json.loads(capsys.readouterr().out)
        assert figures["along_lines"]["max_error"] <= float(rule) * (1 + 1e-6)
        assert figures["max_error"] <= float(rule) * (1 + 1e-6)
        vertices.append(figures["n_vertices"])
    assert vertices[1] < vertices[0]


def test_a_line_with_z_keeps_it(dem, tmp_path):
    # Along a row of cell centres, where the cells would split it.
    shape = line((55.0, 105.0, 400.0), (255.0, 105.0, 410.0))
    path = write_shapes(tmp_path / "wall.gpkg", [shape], "LineString Z")
    terrain = wg.open(dem, breaklines=path)
    for tin in (terrain.mesh, wg.simplify(terrain, vertices=200).mesh):
        assert_line_is_edges(tin, shape)
        for at in np.linspace(0, 200, 41):
            z = height_at(tin, X + 55 + at, Y - 105)
            assert z == pytest.approx(400 + at / 20, abs=1e-6)
    # The cells under the wall are input points still, and far from it.
    assert wg.simplify(terrain, vertices=200).errors.max_error > 20


def test_a_line_stays_at_every_level_of_a_pyramid_of_points(tmp_path, dike):
    rng = np.random.default_rng(5)
    x, y = X + rng.uniform(0, 500, 3000), Y - rng.uniform(0, 400, 3000)
    points = np.column_stack([x, y, 300 + 30 * np.sin(x / 60)])
    table = tmp_path / "points.csv"
    np.savetxt(table, points, delimiter=",", header="x,y,z", comments="", fmt="%.3f")
    shape = line((23.0, 31.0), (171.5, 202.25), (433.0, 377.0))
    terrain = wg.open(table, breaklines=dike, crs=UTM)
    analysis = wg.analyse(terrain)
    out = tmp_path / "points.gpkg"
    wg.save(analysis, out)
    stored = wg.load(out)
    assert stored.n_levels > 5
    for level in range(stored.n_levels + 1):
        assert_line_is_edges(stored.mesh(level), shape)
    back = stored.restore()
    assert isinstance(back, TriangleMesh)
    np.testing.assert_allclose(back.vertices, terrain.mesh.vertices, atol=1e-8)


def test_points_beneath_a_line_do_not_split_it(tmp_path):
    x, y = np.meshgrid(X + 10.0 * np.arange(30), Y - 10.0 * np.arange(30))
    points = np.column_stack([x.ravel(), y.ravel(), 300 + 9 * np.sin(x.ravel() / 40)])
    table = tmp_path / "points.csv"  # in no order, so that it is not taken for a grid
    np.random.default_rng(1).shuffle(points[1:])
    np.savetxt(table, np.delete(points, 5, axis=0), delimiter=",", header="x,y,z", comments="")
    shape = line((20, 100), (270, 100))
    path = write_shapes(tmp_path / "row.gpkg", [shape], "LineString")
    terrain = wg.open(table, crs=UTM, breaklines=path, line_tolerance=4.0)
    assert len(terrain.merged) > 10
    analysis = wg.analyse(terrain)
    for level in range(analysis.n_levels + 1):
        assert_line_is_edges(analysis.mesh(level), shape)
    assert analysis.along_lines.max_error <= 4.0


def test_points_at_places_that_lines_take_count_in_the_errors(dem, tmp_path):
    wall = write_shapes(
        tmp_path / "wall.gpkg", [line((55, 105, 900), (255, 105, 900))], "LineString Z"
    )
    point = shapely.Point(X + 305, Y - 305, 900)
    fixed = write_shapes(tmp_path / "fixed.gpkg", [point], "Point Z")
    terrain = wg.open(dem, breaklines=wall, fixed_points=fixed)
    assert len(terrain.points_for_errors()) == 2000 + 2 + 1  # the cells, both ends, the point
    assert len(terrain.merged) == 21 + 1


def test_fixed_points_stay_at_every_level_where_they_are(tmp_path):
    cloud = write_las(tmp_path / "cloud.laz", 3000)
    given = np.array([[10.5, 20.25, 312.5], [70.125, 55.5, 280.0], [33.0, 81.0, 299.0]])
    path = write_shapes(
        tmp_path / "fixed.gpkg", shapely.points(given + np.array([X, Y, 0])), "Point Z"
    )
    terrain = wg.open(cloud, fixed_points=path)
    analysis = wg.analyse(terrain)
    assert "pyramid_of_a_tin" in [note.code for note in analysis.notes]
    places = {tuple(v) for v in (given + np.array([X, Y, 0])).tolist()}
    for level in range(analysis.n_levels + 1):
        assert places <= {tuple(v) for v in analysis.mesh(level).vertices.tolist()}
    tin = wg.simplify(terrain, vertices=60)
    assert places <= {tuple(v) for v in tin.file_mesh.vertices.tolist()}


def test_a_fixed_point_without_z_is_on_the_terrain_and_one_at_a_vertex_stands_for_it(dem, tmp_path):
    points = [shapely.Point(X + 105, Y - 105), shapely.Point(X + 217.5, Y - 133.0)]
    path = write_shapes(tmp_path / "fixed.gpkg", points, "Point")
    plain, terrain = wg.open(dem).mesh, wg.open(dem, fixed_points=path)
    assert terrain.mesh.n_vertices == plain.n_vertices + 1
    kept = terrain.mesh.vertices[terrain.locked]
    assert len(kept) == 2
    for x, y, z in kept:
        assert z == pytest.approx(height_at(plain, x, y), abs=1e-9)


def test_a_clip_polygon_with_a_hole(dem, tmp_path):
    outer = shapely.box(X + 52.5, Y - 352.0, X + 401.0, Y - 60.0)
    hole = shapely.box(X + 150.0, Y - 250.0, X + 210.0, Y - 190.0)
    area = outer.difference(hole)
    path = write_shapes(tmp_path / "area.gpkg", [area], "Polygon")
    terrain = wg.open(dem, clip=path)
    coarse = wg.simplify(terrain, vertices=300)
    for tin in (terrain.mesh, coarse.mesh):
        assert_tiled(tin, area.area)
        centres = tin.vertices[tin.faces][:, :, :2].mean(axis=1)
        assert shapely.contains_xy(area, *centres.T).all()
        assert_line_is_edges(tin, outer.exterior)
        assert_line_is_edges(tin, hole.exterior)
    assert coarse.along_lines.max_error <= 1e-3 * np.ptp(wg.open(dem).mesh.vertices[:, 2])


def test_a_clip_polygon_beyond_the_terrain_ends_with_it(dem, tmp_path):
    area = shapely.box(X - 1000, Y - 200, X + 1000, Y + 1000)
    terrain = wg.open(dem, clip=write_shapes(tmp_path / "area.gpkg", [area], "Polygon"))
    assert_tiled(terrain.mesh, 490.0 * 195.0)


def test_a_line_across_a_hole_in_the_data_ends_at_it(tmp_path):
    values = hills(40, 50)
    values[15:20, 20:26] = -9999.0
    dem = write_tif(tmp_path / "holed.tif", values, nodata=-9999.0)
    plain = wg.open(dem).mesh
    shape = line((23.0, 171.5), (433.0, 177.0))
    path = write_shapes(tmp_path / "line.gpkg", [shape], "LineString")
    terrain = wg.open(dem, breaklines=path)
    hole = shapely.box(X + 195, Y - 205, X + 265, Y - 145)
    for tin in (terrain.mesh, wg.simplify(terrain, vertices=400).mesh):
        # Three cells with data around a corner of the hole have a triangle.
        assert_tiled(tin, 490.0 * 390.0 - hole.area + 4 * 50.0)
        assert_line_is_edges(tin, shape.difference(hole))
    (told,) = [note for note in terrain.notes if note.code == "breaklines_outside"]
    assert told.figures["share"] == pytest.approx(70 / 410, rel=1e-2)
    assert plain.n_vertices < terrain.mesh.n_vertices


def test_lines_that_cross_are_cut_with_a_note(dem, tmp_path):
    shapes = [line((50, 50), (400, 300)), line((50, 300), (400, 55)), line((200, 20), (201, 350))]
    path = write_shapes(tmp_path / "cross.gpkg", shapes, "LineString")
    terrain = wg.open(dem, breaklines=path)
    (told,) = [note for note in terrain.notes if note.code == "breaklines_cross"]
    assert told.figures["n_crossings"] == 3
    tin = wg.simplify(terrain, vertices=300).mesh
    for shape in shapes:
        assert_line_is_edges(terrain.mesh, shape)
        assert_line_is_edges(tin, shape)


def test_lines_that_cross_at_other_heights_meet_in_the_middle_with_a_warning(dem, tmp_path):
    shapes = [line((50, 52, 400), (250, 252, 400)), line((50, 252, 404), (250, 52, 404))]
    path = write_shapes(tmp_path / "cross.gpkg", shapes, "LineString Z")
    with pytest.warns(LayerWarning, match="up to 4 apart"):
        terrain = wg.open(dem, breaklines=path)
    assert height_at(terrain.mesh, X + 150, Y - 152) == pytest.approx(402)


def test_a_line_file_of_another_crs_is_transformed(dem, dike, tmp_path):
    import geopandas

    there = tmp_path / "degrees.gpkg"
    frame = geopandas.read_file(dike).to_crs("EPSG:4326")
    frame.to_file(there)
    expected = wg.open(dem, breaklines=dike, line_tolerance=TOLERANCE).mesh
    for data in (there, frame):
        found = wg.open(dem, breaklines=data, line_tolerance=TOLERANCE).mesh
        assert found.n_vertices == expected.n_vertices
        np.testing.assert_allclose(found.vertices, expected.vertices, atol=1e-3)


def test_a_terrain_in_degrees_takes_lines_in_metres(tmp_path):
    from pyproj import Transformer

    cloud = write_las(tmp_path / "cloud.laz", 3000, crs="EPSG:4326", degrees=True)
    degrees = shapely.LineString([(11.0002, 46.0002), (11.0008, 46.0007)])
    to_utm = Transformer.from_crs("EPSG:4326", UTM, always_xy=True)
    metres = shapely.transform(
        degrees, lambda c: np.column_stack(to_utm.transform(c[:, 0], c[:, 1]))
    )
    path = write_shapes(tmp_path / "line.gpkg", [metres], "LineString")
    terrain = wg.open(cloud, breaklines=path)
    tin = wg.simplify(terrain, vertices=200)
    local = shapely.transform(
        degrees, lambda c: terrain.frame.to_local(np.column_stack([c, 0 * c[:, 0]]))[:, :2]
    )
    assert_line_is_edges(tin.mesh, local)


def test_a_line_file_without_crs_is_taken_as_it_is_and_told(dem, tmp_path):
    with pytest.warns(UserWarning, match="'crs' was not provided"):
        write_shapes(tmp_path / "bare.gpkg", [line((50, 50), (400, 300))], "LineString", crs=None)
    path = tmp_path / "bare.gpkg"
    with pytest.warns(CrsWarning, match="taken as they are"):
        wg.open(dem, breaklines=path)


def test_outside_the_data_is_refused_and_partly_outside_is_told(dem, tmp_path):
    far = write_shapes(tmp_path / "far.gpkg", [line((5000, 0), (6000, 0))], "LineString")
    with pytest.raises(InputFileError, match="nothing of breaklines is where the terrain is"):
        wg.open(dem, breaklines=far)
    box = write_shapes(tmp_path / "box.gpkg", [shapely.box(0, 0, 1, 1)], "Polygon")
    with pytest.raises(InputFileError, match="nothing of clip is where the terrain is"):
        wg.open(dem, clip=box)
    point = write_shapes(tmp_path / "p.gpkg", [shapely.Point(0, 0)], "Point")
    with pytest.raises(InputFileError, match="nothing of fixed_points is where"):
        wg.open(dem, fixed_points=point)
    half = write_shapes(tmp_path / "half.gpkg", [line((-240, 100), (250, 100))], "LineString")
    terrain = wg.open(dem, breaklines=half)
    (told,) = [note for note in terrain.notes if note.code == "breaklines_outside"]
    assert told.figures["share"] == pytest.approx(0.5)
    assert_line_is_edges(terrain.mesh, line((5, 100), (250, 100)))


def test_the_pyramid_of_a_raster_is_refused_in_one_line(dem, dike, tmp_path, capsys):
    output = tmp_path / "dem.gpkg"
    assert main(["analyse", str(dem), str(output), "--breaklines", str(dike)]) == 1
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert "--breaklines" in said
    assert "simplify" in said
    assert not output.exists()


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"line_tolerance": 0.1}, OptionError, "line_tolerance is for lines"),
        ({"clip": "dike.gpkg"}, InputFileError, "clip are to be polygons"),
        ({"fixed_points": "dike.gpkg"}, InputFileError, "fixed_points are to be points"),
        ({"breaklines": "none.gpkg"}, InputFileError, "none.gpkg"),
        ({"breaklines": "dike.gpkg", "line_tolerance": -1.0}, OptionError, "give 0 or more"),
        ({"breaklines": 3}, OptionError, "give a path or a GeoDataFrame"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_refusals(options, error, match, dem, dike, monkeypatch):
    monkeypatch.chdir(dike.parent)
    with pytest.raises(error, match=match):
        wg.open(dem, **options)


def test_a_tin_and_a_pyramid_take_no_lines(dem, dike, tmp_path):
    with pytest.raises(InputFileError, match="this is a layer of triangles, and breaklines"):
        wg.open(wg.open(dem).mesh, breaklines=dike)
    pyramid = tmp_path / "pyramid.gpkg"
    wg.save(wg.analyse(wg.open(dem), levels=2), pyramid)
    with pytest.raises(InputFileError, match="this is a pyramid, and breaklines"):
        wg.open(pyramid, breaklines=dike)


def test_an_output_that_is_the_line_file_is_refused(dem, dike, capsys):
    before = dike.read_bytes()
    words = ["simplify", dem, dike, "--breaklines", dike, "--vertices", "300", "--overwrite"]
    assert main([str(word) for word in words]) == 1
    assert dike.read_bytes() == before


def test_points_that_are_all_on_the_clip_polygon_leave_its_corners(tmp_path):
    """The corners asked for the attributes of the nearest point inside, and there was none."""
    points = [(X + 1, Y, 5.0), (X + 2, Y + 1, 6.0), (X, Y + 1, 7.0), (X + 1, Y + 2, 8.0)]
    write_shapes(tmp_path / "points.gpkg", [shapely.Point(*p) for p in points], "Point Z")
    inside = shapely.Polygon([(X + 1, Y), (X + 2, Y + 1), (X + 1, Y + 2), (X, Y + 1)])
    write_shapes(tmp_path / "clip.gpkg", [inside], "Polygon")
    terrain = wg.open(tmp_path / "points.gpkg", clip=tmp_path / "clip.gpkg")
    assert (terrain.mesh.n_vertices, terrain.mesh.n_faces) == (4, 2)
    ring = np.array([[-1, -1, 0], [3, -1, 0], [3, 3, 0], [-1, 3, 0], [-1, -1, 0]], dtype=float)
    on_it = np.array([[1, -1, 5], [3, 1, 6], [1, 3, 7]], dtype=float)
    tin = tin_with_lines(on_it, np.array([[1.0], [2.0], [3.0]]), ["class"], outline=[ring])
    assert tin.mesh.n_vertices == 4
    assert set(tin.mesh.attributes.ravel()) <= {1.0, 2.0, 3.0}
    assert len(tin.replaced) == 3
