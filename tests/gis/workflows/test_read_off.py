"""Profiles, contours, differences and shapes of triangles: of surfaces whose answer is known."""

import csv
import xml.etree.ElementTree as ElementTree

import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import hills, write_tif

import wavelet_gis as wg
from wavelet_core.errors import Cancelled, OptionError
from wavelet_gis.errors import InputFileError
from wavelet_gis.report.profile_plot import MOST_DRAWN, profile_page, profile_svg

X, Y = 500000.0, 5100000.0  # corner of the rasters, whose cells are of 10 m


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("read_off")
    values = hills().astype("f4")
    values[5:9, 7:12] = -9999
    write_tif(path / "dem.tif", values, nodata=-9999)
    y, x = np.mgrid[0:40, 0:50]
    write_tif(path / "plane.tif", (100 + 2.0 * x + y).astype("f4"))
    return path


@pytest.fixture(scope="module")
def pyramid(folder):
    return wg.analyse(wg.open(folder / "dem.tif"), levels=5)


@pytest.fixture(scope="module")
def plane(folder):
    return wg.analyse(wg.open(folder / "plane.tif"), levels=5)


def write_lines(path, lines, crs="EPSG:32632"):
    wkb = np.array([shapely.to_wkb(shapely.LineString(line)) for line in lines], dtype=object)
    pyogrio.raw.write(path, wkb, [], [], geometry_type="LineString", crs=crs, driver="GPKG")
    return path


class TestProfile:
    def test_the_finest_level_along_a_row_is_the_row(self, pyramid, folder):
        line = [[X + 5, Y - 25], [X + 495, Y - 25]]
        found = wg.profile(pyramid, line, levels=[5], step=10.0)
        np.testing.assert_allclose(found.distance, np.arange(50) * 10.0)
        with rasterio.open(folder / "dem.tif") as dataset:
            np.testing.assert_allclose(found.heights[:, 0], dataset.read(1)[2], rtol=1e-6)
        np.testing.assert_allclose(found.places[:, 0], X + 5 + found.distance)

    def test_every_level_of_a_plane_is_the_plane(self, plane):
        found = wg.profile(plane, [[X + 8, Y - 8], [X + 300, Y - 350], [X + 490, Y - 40]])
        assert found.levels[0] == 5
        assert found.levels[-1] == 0
        x, y = (found.places - [X + 5, Y - 5]).T
        due = 100 + 2.0 * x / 10 - y / 10
        np.testing.assert_allclose(
            found.heights, np.tile(due[:, None], len(found.levels)), atol=1e-3
        )
        corner = np.hypot(292, 342)
        assert np.isclose(found.distance, corner).sum() == 1, "the corner of the line is a point"

    def test_over_a_hole_there_is_no_height_and_the_curve_is_broken(self, pyramid):
        found = wg.profile(pyramid, [[X + 5, Y - 65], [X + 495, Y - 65]], levels=[5, 0], step=5.0)
        is_gap = ~np.isfinite(found.heights[:, 0])
        assert is_gap.any()
        assert (np.abs(found.places[is_gap, 0] - (X + 95)) < 35).all()
        picture = ElementTree.fromstring(profile_svg(found))
        curves = picture.findall(".//{http://www.w3.org/2000/svg}polyline")
        assert len(curves) == 2 * 2 + 2  # two parts of each level, and of the lower chart's one

    def test_a_file_in_another_crs_gives_the_same(self, pyramid, tmp_path):
        line = [[X + 50, Y - 50], [X + 400, Y - 300]]
        from pyproj import Transformer

        turned = Transformer.from_crs(32632, 4326, always_xy=True)
        degrees = list(zip(*turned.transform(*zip(*line, strict=True)), strict=True))
        path = write_lines(tmp_path / "lines.gpkg", [degrees], "EPSG:4326")
        due, found = wg.profile(pyramid, line), wg.profile(pyramid, path)
        np.testing.assert_allclose(found.heights, due.heights, atol=1e-3)

    def test_degrees_are_walked_in_metres(self, tmp_path):
        transform = rasterio.Affine(1e-4, 0, 11.0, 0, -1e-4, 46.0)
        path = write_tif(
            tmp_path / "d.tif", hills().astype("f4"), crs="EPSG:4326", transform=transform
        )
        found = wg.profile(
            wg.analyse(wg.open(path), levels=2), [[11.0005, 45.998], [11.0045, 45.998]]
        )
        assert found.distance[-1] == pytest.approx(
            0.004 * 111_320 * np.cos(np.radians(46)), rel=0.01
        )
        assert found.places[-1] == pytest.approx([11.0045, 45.998])

    def test_the_table_holds_every_point_and_nothing_for_a_gap(self, pyramid, tmp_path):
        found = wg.profile(pyramid, [[X - 20, Y - 65], [X + 495, Y - 65]], levels=[0, 5])
        wg.save(found, tmp_path / "p.csv")
        with open(tmp_path / "p.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert list(rows[0]) == ["line", "distance", "x", "y", "z_00", "z_05"]
        assert len(rows) == len(found.line)
        assert rows[0]["z_05"] == ""
        wg.save(found, tmp_path / "p.gpkg")
        assert pyogrio.read_info(tmp_path / "p.gpkg", layer="profile")["features"] == len(rows)
        _, _, geometry, _ = pyogrio.raw.read(tmp_path / "p.gpkg", layer="profile")
        # Beside the terrain points lay at a height of 0.
        z = shapely.get_z(shapely.from_wkb(geometry))
        np.testing.assert_array_equal(z, found.heights[:, 1])

    def test_several_lines_are_told_apart(self, pyramid):
        lines = [[[X + 5, Y - 25], [X + 95, Y - 25]], [[X + 5, Y - 95], [X + 5, Y - 295]]]
        found = wg.profile(pyramid, lines, levels=[0])
        assert set(found.line) == {0, 1}
        rows = found.figures()["profiles"]
        # Tables and figures count lines as the plot does, from 1.
        assert [row["line"] for row in rows] == sorted(set(found.table()["line"])) == [1, 2]
        assert [row["length"] for row in rows] == pytest.approx([90, 200])
        page = profile_page(found)
        assert "Line 1" in page
        assert "Line 2" in page

    def test_of_a_line_beside_the_terrain_no_difference_is_claimed(self, pyramid):
        lines = [[[X + 5, Y - 25], [X + 95, Y - 25]], [[X - 900, Y], [X - 500, Y]]]
        rows = wg.profile(pyramid, lines, levels=[0, 5]).figures()["profiles"]
        assert rows[0]["max_difference"] > 0
        assert all(np.isnan(row["rms_difference"]) for row in rows[2:])
        assert all(np.isnan(row["max_difference"]) for row in rows[2:])
        assert "nan" not in profile_page(wg.profile(pyramid, lines, levels=[0, 5]))

    def test_of_many_points_the_highest_and_the_lowest_are_drawn(self, pyramid):
        found = wg.profile(pyramid, [[X + 5, Y - 25], [X + 495, Y - 25]], levels=[5], step=0.01)
        assert len(found.line) > 10 * MOST_DRAWN
        curve = ElementTree.fromstring(profile_svg(found)).find(
            ".//{http://www.w3.org/2000/svg}polyline"
        )
        drawn = np.array([p.split(",")[1] for p in curve.get("points").split()], dtype=float)
        assert len(drawn) <= MOST_DRAWN + 2
        full = found.heights[:, 0]
        span = drawn.max() - drawn.min()
        relief = np.interp([full.min(), full.max()], np.sort(full), np.sort(full))
        assert span == pytest.approx(300 / 1.08 * (relief[1] - relief[0]) / np.ptp(full), abs=0.3)

    @pytest.mark.parametrize(
        ("line", "options", "told"),
        [
            ([[X, Y], [X, Y]], {}, "no length"),
            ([[X - 900, Y], [X - 500, Y]], {}, "no part of the line"),
            ([[X, Y], [X + 100, Y - 100]], {"levels": [9]}, "no level 9"),
            ([[X, Y], [X + 100, Y - 100]], {"step": 0.0}, "above 0"),
            ([[X, Y], [X + 100, Y - 100]], {"step": 1e-7}, "larger"),
            ("nonsense.gpkg", {}, "nonsense.gpkg"),
            ([[X, Y, 3], [X, "a", 3]], {}, "no list of x and y"),
            ([], {}, "no list of x and y"),
        ],
    )
    def test_what_cannot_be_meant_is_refused(self, pyramid, line, options, told):
        with pytest.raises((OptionError, InputFileError), match=told):
            wg.profile(pyramid, line, **options)

    def test_it_stops_when_told_to(self, pyramid):
        with pytest.raises(Cancelled):
            wg.profile(pyramid, [[X, Y], [X + 300, Y - 300]], progress=lambda fraction: False)


class TestContours:
    def test_contours_of_a_plane_are_straight_at_every_level(self, plane):
        for level in (0, 5):
            found = wg.contours(plane, interval=10.0, level=level)
            assert found.heights.tolist() == list(range(110, 240, 10))
            for height, line in zip(found.heights, found.lines, strict=True):
                x, y = (line[:, :2] - [X + 5, Y - 5]).T / 10
                np.testing.assert_allclose(100 + 2 * x - y, height, atol=1e-3)

    def test_left_alone_it_takes_a_round_interval_and_the_coarsest_level_that_fits(self, pyramid):
        found = wg.contours(pyramid)
        errors = {e.level: e.rmse_surface for e in pyramid.geo.with_errors().errors}
        assert errors[found.level] <= 0.2 * found.interval
        assert found.level == 0 or errors[found.level - 1] > 0.2 * found.interval
        assert 10 < len(set(found.heights)) < 40

    def test_the_file_holds_lines_with_their_heights(self, pyramid, tmp_path, validate_gpkg):
        found = wg.contours(pyramid, interval=5.0, level=2, base=1.0)
        wg.save(found, tmp_path / "c.gpkg")
        validate_gpkg(tmp_path / "c.gpkg")
        _, _, geometry, fields = pyogrio.raw.read(tmp_path / "c.gpkg", layer="contours")
        shapes = shapely.from_wkb(geometry)
        assert {shape.geom_type for shape in shapes} == {"LineString"}
        heights = [shapely.get_coordinates(shape, include_z=True)[0, 2] for shape in shapes]
        assert heights == pytest.approx(fields[0])
        assert (fields[1] == (np.rint((fields[0] - 1) / 5) % 5 == 0)).all()

    @pytest.mark.parametrize(
        ("options", "told"),
        [
            ({"interval": 0.0}, "above 0"),
            ({"interval": 1e-9}, "larger"),
            ({"level": 7}, "level 7"),
            ({"base": float("nan")}, "base is nan"),
        ],
    )
    def test_what_cannot_be_meant_is_refused(self, pyramid, options, told):
        with pytest.raises(OptionError, match=told):
            wg.contours(pyramid, **options)


class TestDifference:
    def test_the_finest_level_is_its_dem(self, pyramid, folder, tmp_path):
        found = wg.difference(pyramid, level=5, less=folder / "dem.tif")
        assert found.figures()["n_cells"] == 40 * 50 - 20
        assert np.abs(found.dem.values[found.dem.valid]).max() < 1e-4
        wg.save(found, tmp_path / "d.tif")
        with rasterio.open(tmp_path / "d.tif") as dataset:
            assert dataset.crs.to_epsg() == 32632
            assert np.isnan(dataset.read(1)[6, 8])

    def test_it_is_the_level_less_the_other(self, pyramid, folder, tmp_path):
        with rasterio.open(folder / "dem.tif") as dataset:
            values = dataset.read(1)
        lower = write_tif(
            tmp_path / "lower.tif", np.where(values > 0, values - 2, -9999), nodata=-9999
        )
        assert wg.difference(pyramid, level=5, less=lower).figures()["mean"] == pytest.approx(2)
        up, down = (wg.difference(pyramid, level=a, less=b) for a, b in ((0, 5), (5, 0)))
        np.testing.assert_allclose(up.dem.values, -down.dem.values, atol=1e-5)
        due = pyramid.geo.with_errors().errors_at(0)
        assert wg.difference(pyramid).figures()["rms"] == pytest.approx(due.rmse_surface, rel=1e-3)

    def test_a_dem_in_feet_is_not_taken_from_metres(self, pyramid, tmp_path):
        feet = write_tif(tmp_path / "feet.tif", hills().astype("f4"))
        with rasterio.open(feet, "r+") as dataset:
            dataset.units = ("ft",)
        with pytest.raises(InputFileError, match=r"feet\.tif: its heights are in ft, .* in metre"):
            wg.difference(pyramid, less=feet)
        with rasterio.open(feet, "r+") as dataset:
            dataset.units = ("m",)
        assert wg.difference(pyramid, less=feet).figures()["n_cells"] > 0

    def test_a_level_may_be_a_number_of_numpy(self, pyramid):
        level = np.int64(5)
        assert wg.difference(pyramid, less=level).figures() == wg.difference(pyramid).figures()

    def test_what_does_not_fit_is_refused(self, pyramid, tmp_path):
        other = write_tif(tmp_path / "other.tif", hills().astype("f4"), crs="EPSG:2154")
        with pytest.raises(InputFileError, match="CRS"):
            wg.difference(pyramid, less=other)
        away = rasterio.Affine(10.0, 0.0, 900000.0, 0.0, -10.0, 5100000.0)
        beside = write_tif(tmp_path / "beside.tif", hills().astype("f4"), transform=away)
        with pytest.raises(InputFileError, match="overlap"):
            wg.difference(pyramid, less=beside)
        with pytest.raises(OptionError, match="which has its own"):
            wg.difference(pyramid, less=other, cell_size=3.0)


class TestMeshQuality:
    def test_the_triangles_of_a_grid_are_halves_of_its_squares(self, plane):
        rows = wg.mesh_quality(plane)
        assert [row.level for row in rows] == list(range(6))
        finest = rows[-1]
        assert finest.n_vertices == 2000
        assert finest[3:7] == pytest.approx((45, 45, 45, 90))
        assert finest.sliver_share == 0
        assert finest[8:] == pytest.approx((10, 10 * 2**0.5, 50, 50))
        assert rows[0].longest_edge > finest.longest_edge

    def test_the_levels_that_are_asked_for(self, plane):
        assert [row.level for row in wg.mesh_quality(plane, levels=[3, 0])] == [0, 3]
        with pytest.raises(OptionError, match="no level 6"):
            wg.mesh_quality(plane, levels=[6])

    def test_progress_counts_vertices_not_levels(self, plane):
        """The finest of many levels takes a quarter of the time, and had a twelfth of the bar."""
        seen = []
        rows = wg.mesh_quality(plane, progress=lambda fraction: seen.append(fraction) or True)
        sizes = np.cumsum([row.n_vertices for row in rows])
        assert seen[2::3] == pytest.approx(sizes / sizes[-1])
        assert seen == sorted(seen)


def test_the_bands_of_energy_report_what_follows_their_columns(plane):
    """Naming the bands takes three times as long as their columns, after which all was said."""
    seen = []
    wg.details(plane).raster(progress=lambda fraction: seen.append(fraction) or True)
    assert seen == sorted(seen)
    assert sum(fraction > 0.15 for fraction in seen) > 5


def test_aspects_around_north_are_not_averaged_to_the_south(tmp_path):
    y, x = np.mgrid[0:40, 0:50]
    hollow = 100 + 3.0 * y - 20 * np.cos((x - 24.5) / 12)  # it falls to the north
    pyramid = wg.analyse(wg.open(write_tif(tmp_path / "n.tif", hollow.astype("f4"))), levels=6)
    bands = wg.details(pyramid, what="shape", level=0).raster(cell_size=1.0)
    aspect = bands.values[bands.names.index("aspect")]
    off_north = np.abs((aspect + 180) % 360 - 180)
    assert np.nanmax(off_north) < 60
    slope = bands.values[bands.names.index("slope")]
    assert 10 < np.nanmean(slope) < 30
