"""How far a surface may be off, by place: what it is, and that it is kept."""

import json

import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import UTM, hills, write_las, write_tif

import wavelet_gis as wg
from wavelet_core.errors import OptionError
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_gis.cli.main import main
from wavelet_gis.errors import CrsWarning, InputFileError
from wavelet_gis.workflows.tolerance.by_place import tolerances

X, Y = 500000.0, 5100000.0
#: The DEM has 40 rows and 50 columns at 10 m: x from X + 5 to X + 495, y from Y - 5 to Y - 395.
ROWS, COLUMNS = 40, 50


@pytest.fixture
def dem(tmp_path):
    return write_tif(tmp_path / "dem.tif", hills(ROWS, COLUMNS))


@pytest.fixture
def terrain(dem):
    return wg.open(dem)


def write_zones(path, shapes, values, field="max_error", crs=UTM):
    pyogrio.raw.write(
        path,
        shapely.to_wkb(np.array(shapes, dtype=object)),
        [np.array(values)],
        [field],
        geometry_type="Polygon",
        crs=crs,
        layer="it",
    )
    return path


def box(west, north, east, south):
    """Return a rectangle by distances from the corner of the DEM."""
    return shapely.box(X + west, Y - south, X + east, Y - north)


@pytest.fixture
def zones(tmp_path):
    """A field in the west, and a dike in it and beyond."""
    shapes = [box(-1, -1, 250, 401), box(100, 190, 400, 210)]
    return write_zones(tmp_path / "zones.gpkg", shapes, [0.5, 0.05])


def of_cells(terrain):
    """Return row and column of each vertex."""
    x, y, _ = terrain.frame.to_file(terrain.mesh.vertices).T
    return np.rint((Y - y - 5) / 10).astype(int), np.rint((x - X - 5) / 10).astype(int)


def by_hand(terrain):
    rows, columns = of_cells(terrain)
    expected = np.where(columns * 10 + 5 <= 250, 0.5, 4.0)
    is_dike = (columns * 10 + 5 >= 100) & (columns * 10 + 5 <= 400)
    return np.where(is_dike & (rows * 10 + 5 >= 190) & (rows * 10 + 5 <= 210), 0.05, expected)


def slow_errors(mesh, points):
    """Return the distance of points from a surface by looking at every triangle."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    det = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
    errors = np.full(len(points), np.nan)
    for k, (x, y, z) in enumerate(points):
        at_b = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (y - a[:, 1])) / det
        at_c = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])) / det
        inside = (at_b >= -1e-9) & (at_c >= -1e-9) & (at_b + at_c <= 1 + 1e-9)
        heights = a[:, 2] + at_b * (b[:, 2] - a[:, 2]) + at_c * (c[:, 2] - a[:, 2])
        if inside.any():
            errors[k] = np.abs(heights[inside] - z).min()
    return errors


def require_kept(surface, terrain, limits):
    errors = slow_errors(surface.mesh, terrain.mesh.vertices) / terrain.frame.z_scale
    assert np.isfinite(errors).all()
    assert (errors <= limits + 1e-9).all()
    build_connectivity(surface.mesh.faces.astype(np.int32), surface.mesh.n_vertices)
    assert surface.mesh.plan_areas.min() > 0
    assert surface.mesh.plan_areas.sum() == pytest.approx(terrain.mesh.plan_areas.sum())


class TestWhatItIs:
    def test_the_strictest_zone_counts_and_the_number_outside(self, terrain, zones):
        found = tolerances(terrain, terrain.mesh, 4.0, zones)
        np.testing.assert_array_equal(found, by_hand(terrain))

    def test_zones_in_another_crs_and_another_field(self, terrain, tmp_path):
        import pyproj

        move = pyproj.Transformer.from_crs(UTM, 4326, always_xy=True).transform
        shape = shapely.transform(
            shapely.segmentize(box(-1, -1, 252, 401), 10.0),
            lambda xy: np.column_stack(move(xy[:, 0], xy[:, 1])),
        )
        path = write_zones(tmp_path / "z.gpkg", [shape], [0.25], "tol", "EPSG:4326")
        found = tolerances(terrain, terrain.mesh, 1.0, path, "tol")
        columns = of_cells(terrain)[1]
        np.testing.assert_array_equal(found, np.where(columns < 25, 0.25, 1.0))

    def test_a_geodataframe_and_a_zone_without_a_number(self, terrain):
        geopandas = pytest.importorskip("geopandas")
        frame = geopandas.GeoDataFrame(
            {"max_error": [None, 0.5]},
            geometry=[box(0, 0, 100, 400), box(0, 0, 250, 400)],
            crs=UTM,
        )
        found = tolerances(terrain, terrain.mesh, 2.0, frame)
        np.testing.assert_array_equal(found, np.where(of_cells(terrain)[1] < 25, 0.5, 2.0))

    def test_a_raster_counts_cell_by_cell(self, terrain, tmp_path):
        values = np.arange(20 * 25, dtype="float32").reshape(20, 25) / 100
        place = rasterio.Affine(20.0, 0.0, X, 0.0, -20.0, Y)
        path = write_tif(tmp_path / "tolerance.tif", values, transform=place)
        rows, columns = of_cells(terrain)
        found = tolerances(terrain, terrain.mesh, path)
        np.testing.assert_array_equal(found, values[rows // 2, columns // 2])

    def test_a_raster_with_a_hole_says_how_many_points_it_leaves_out(self, terrain, tmp_path):
        values = np.ones((ROWS, COLUMNS), "float32")
        values[3, :7] = -1.0
        path = write_tif(tmp_path / "t.tif", values, nodata=-1.0)
        with pytest.raises(OptionError, match="7 of 2000 input points have no tolerance"):
            tolerances(terrain, terrain.mesh, path)

    @pytest.mark.parametrize(
        ("formula", "expected"),
        [
            ("0.1 + 0.02 * slope", lambda z, slope: 0.1 + 0.02 * slope),
            ("max(0.1, slope / 10, 0.2)", lambda z, slope: np.maximum(0.2, slope / 10)),
            ("where(z < 105, 0.05, 2)", lambda z, slope: np.where(z < 105, 0.05, 2.0)),
            ("min(sqrt(abs(-z)) ** 2 / 100, 3)", lambda z, slope: np.minimum(z / 100, 3)),
            ("min(1" + 400 * "0" + ", 2)", lambda z, slope: np.full(len(z), 2.0)),
        ],
    )
    def test_a_formula_of_height_and_slope(self, terrain, formula, expected):
        from wavelet_core.features.shape import surface_shape

        z = terrain.frame.to_file(terrain.mesh.vertices)[:, 2]
        found = tolerances(terrain, terrain.mesh, formula)
        np.testing.assert_allclose(found, expected(z, surface_shape(terrain.mesh).slope))

    def test_a_formula_of_feet_gives_feet(self, tmp_path):
        feet = wg.open(write_tif(tmp_path / "feet.tif", hills(9, 9), crs="EPSG:2264"))
        found = tolerances(feet, feet.mesh, "z")
        np.testing.assert_allclose(np.sort(found), np.sort(hills(9, 9).ravel()), rtol=1e-6)

    def test_numbers_and_functions(self, terrain):
        ramp = np.linspace(0.1, 1.0, terrain.mesh.n_vertices)
        np.testing.assert_array_equal(tolerances(terrain, terrain.mesh, ramp), ramp)
        found = tolerances(terrain, terrain.mesh, lambda mesh: mesh.vertices[:, 2] * 0 + 0.3)
        assert set(found) == {0.3}


class TestRefusals:
    @pytest.mark.parametrize(
        "text",
        [
            "__import__('os').system('true')", "().__class__", "z.real", "[1, 2][0]", "lambda: 1",
            "slope if z else 1", "open('x')", "z @ z", "w + 1", "'a' * 9", "min()", "no_such.tif",
            "9 ** 9 ** 9 * 0", "(" * 500 + "1" + ")" * 500, "where(z)", "-1", "slope > 20",
            "sqrt(slope, z)", "abs(slope, z)", "log(slope, z)", "z - 1e9",
            "clip(z, a_min=1)", "True and z", "z < 1 < 2", "1j",
        ],
    )  # fmt: skip
    def test_formulas_that_are_none(self, dem, tmp_path, capsys, text):
        output = tmp_path / "o.gpkg"
        code = main(["simplify", str(dem), str(output), f"--max-error={text}"])
        said = capsys.readouterr().err.strip().splitlines()
        assert code in (1, 2)
        assert not any("Traceback" in line for line in said)
        assert "unforeseen" not in said[-1]
        assert " error: " in said[-1]
        assert not output.exists()

    def test_what_contradicts(self, terrain, zones, tmp_path):
        analysis = wg.analyse(terrain, levels=2)
        for options in (
            {"vertices": 100, "zones": zones},
            {"max_rms": 1.0, "zones": zones},
            {"max_error": 1.0, "zone_field": "max_error"},
            {"zones": zones},
            {"max_error": [1.0, 2.0]},
            {"max_error": 1.0, "zones": zones, "norm": "rms"},
            {"max_error": 1.0, "zones": zones, "update": "minimum_norm"},
            {"max_error": 1.0, "zones": zones, "design": "GLMN"},
            {"max_error": 1.0, "zones": 3},
        ):
            with pytest.raises(OptionError):
                wg.simplify(terrain, **options)
        for options in (
            {"level": 1, "zones": zones},
            {"level": 1, "refine": 3},
            {"max_error": 1.0, "zones": zones, "vertices": 9},
        ):
            with pytest.raises(OptionError):
                wg.extract(analysis, **options)

    def test_zones_beside_another_rule_are_named(self, terrain, zones):
        with pytest.raises(OptionError, match="zones go with max_error only"):
            wg.simplify(terrain, vertices=50, zones=zones)

    def test_a_negative_number_in_a_zone_is_that_of_the_field(self, terrain, tmp_path):
        path = write_zones(tmp_path / "n.gpkg", [box(0, 0, 100, 100)], [-0.5])
        with pytest.raises(InputFileError, match=r"holds -0\.5"):
            tolerances(terrain, terrain.mesh, 1.0, path)

    def test_a_raster_without_crs_is_told_of(self, terrain, tmp_path):
        path = write_tif(tmp_path / "t.tif", np.ones((ROWS, COLUMNS), "float32"), crs=None)
        with pytest.warns(CrsWarning, match="taken as they are"):
            tolerances(terrain, terrain.mesh, path)

    def test_zones_that_tell_nothing(self, terrain, tmp_path):
        far = write_zones(tmp_path / "far.gpkg", [box(9000, 0, 9100, 10)], [0.5])
        words = write_zones(tmp_path / "words.gpkg", [box(0, 0, 100, 100)], ["a"])
        with pytest.raises(InputFileError, match="no input point lies in a zone"):
            tolerances(terrain, terrain.mesh, 1.0, far)
        with pytest.raises(InputFileError, match="does not hold numbers"):
            tolerances(terrain, terrain.mesh, 1.0, words)
        with pytest.raises(InputFileError, match="no field 'other'"):
            tolerances(terrain, terrain.mesh, 1.0, far, "other")
        with pytest.raises(InputFileError):
            tolerances(terrain, terrain.mesh, 1.0, tmp_path / "none.gpkg")
        place = rasterio.Affine(10.0, 0.0, 0.0, 0.0, -10.0, 0.0)
        beyond = write_tif(tmp_path / "b.tif", hills(4, 4), transform=place)
        with pytest.raises(InputFileError, match="no input point lies in a cell"):
            tolerances(terrain, terrain.mesh, beyond)


class TestKept:
    @pytest.mark.parametrize("refine", [None, 0])
    def test_simplify(self, terrain, zones, refine):
        tin = wg.simplify(terrain, max_error=4.0, zones=zones, refine=refine)
        limits = by_hand(terrain)
        require_kept(tin, terrain, limits)
        np.testing.assert_array_equal(tin.mesh.vertices, terrain.mesh.vertices[tin.vertex_ids])
        assert [zone.least for zone in tin.zones] == [0.05, 0.5, 4.0]
        assert sum(zone.n_points for zone in tin.zones) == terrain.mesh.n_vertices
        assert sum(zone.n_vertices for zone in tin.zones) == tin.mesh.n_vertices
        errors = slow_errors(tin.mesh, terrain.mesh.vertices)
        for zone in tin.zones:
            inside = limits == zone.least
            assert zone.max_error == pytest.approx(errors[inside].max(), abs=1e-9)
            assert zone.rmse == pytest.approx(np.sqrt(np.mean(errors[inside] ** 2)), abs=1e-9)
        uniform = wg.simplify(terrain, max_error=0.05)
        assert tin.mesh.n_vertices < 0.7 * uniform.mesh.n_vertices

    @pytest.mark.parametrize("options", [{}, {"norm": "max"}, {"design": "GLMN", "levels": 5}])
    @pytest.mark.parametrize("refine", [0, None, 2])
    def test_extract_from_any_pyramid(self, terrain, zones, options, refine, tmp_path):
        path = tmp_path / "p.gpkg"
        wg.save(wg.analyse(terrain, **options), path)
        surface = wg.extract(wg.load(path), max_error=4.0, zones=zones, refine=refine)
        require_kept(surface, terrain, by_hand(terrain))
        fresh = wg.simplify(terrain, max_error=4.0, zones=zones)
        if refine is None and not options:
            assert surface.mesh.n_vertices < 1.1 * fresh.mesh.n_vertices

    def test_many_tolerances_are_told_of_in_octaves(self, terrain):
        limits = np.geomspace(0.1, 3.0, terrain.mesh.n_vertices)
        tin = wg.simplify(terrain, max_error=limits)
        require_kept(tin, terrain, limits)
        assert 4 <= len(tin.zones) <= 6
        assert all(zone.most <= 2 * zone.least for zone in tin.zones)

    def test_no_tolerance_somewhere_and_none_anywhere(self, terrain):
        columns = of_cells(terrain)[1]
        limits = np.where(columns < 25, np.inf, 0.0)
        tin = wg.simplify(terrain, max_error=limits)
        require_kept(tin, terrain, limits)

    @pytest.mark.filterwarnings("ignore:.*holds at the vertices")
    def test_a_cloud_with_breaklines(self, tmp_path):
        path = write_las(tmp_path / "c.las", 1500)  # 100 m wide, in the corner
        zones = write_zones(tmp_path / "z.gpkg", [shapely.box(X, Y, X + 50, Y + 100)], [0.3])
        lines = tmp_path / "lines.gpkg"
        shape = shapely.LineString([(X + 20, Y + 20), (X + 83, Y + 70)])
        pyogrio.raw.write(
            lines, shapely.to_wkb(np.array([shape])), [], [], geometry_type="LineString", crs=UTM,
            layer="it",
        )  # fmt: skip
        terrain = wg.open(path, breaklines=lines)
        tin = wg.simplify(terrain, max_error=5.0, zones=zones)
        limits = tolerances(terrain, terrain.mesh, 5.0, zones)
        require_kept(tin, terrain, limits)
        assert set(np.flatnonzero(terrain.locked)) <= set(tin.vertex_ids.tolist())

    def test_the_command_tells_of_each_zone(self, dem, zones, tmp_path, capsys):
        pyramid, output = tmp_path / "p.gpkg", tmp_path / "o.gpkg"
        assert main(["analyse", str(dem), str(pyramid)]) == 0
        capsys.readouterr()
        given = ["--max-error", "4", "--zones", str(zones)]
        for words in (["simplify", str(dem)], ["extract", str(pyramid)]):
            assert main([*words, str(output), *given, "--overwrite", "--json"]) == 0
            figures = json.loads(capsys.readouterr().out)
            assert [zone["least"] for zone in figures["zones"]] == [0.05, 0.5, 4.0]
            assert all(zone["max_error"] <= zone["most"] for zone in figures["zones"])
            assert main([*words, str(output), *given, "--overwrite"]) == 0
            table = capsys.readouterr().out.splitlines()
            assert any("tolerance" in line and "vertices" in line for line in table)
        assert main(["simplify", str(dem), str(zones), *given, "--overwrite"]) == 1
        assert "input" in capsys.readouterr().err
