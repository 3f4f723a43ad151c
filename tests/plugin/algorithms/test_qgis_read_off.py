"""What is read off a pyramid: profiles, shape of a level, differences, triangles."""

import csv
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from qgis_layers import Log, hills, numbers, wkt_layer, write_raster

X, Y = 700000.0, 6600000.0  # corner of the raster, whose cells are of 10 m
LINE = f"LineString ({X + 15} {Y - 105}, {X + 785} {Y - 105})"


@pytest.fixture(scope="module")
def made(qgis, tmp_path_factory):
    """Return the folder of a DEM and its pyramid of five levels."""
    import processing

    folder = tmp_path_factory.mktemp("read_off")
    dem = write_raster(folder / "dem.tif", hills().astype("float32"))
    processing.run(
        "terrainwavelets:analysedem",
        {"INPUT": dem, "LEVELS": 5, "OUTPUT": str(folder / "p.gpkg")},
    )
    return folder


@pytest.fixture
def opened(qgis):
    """Return a function that runs an algorithm and gives the layers that it opens, by name."""
    import processing
    from qgis.core import QgsProcessingContext, QgsProject

    project = QgsProject.instance()

    def run(name, parameters):
        context = QgsProcessingContext()
        context.setProject(project)
        processing.runAndLoadResults(f"terrainwavelets:{name}", parameters, Log(), context)
        return {layer.name(): layer for layer in project.mapLayers().values()}

    yield run
    project.clear()


class TestProfile:
    def test_a_first_click_gives_points_and_a_plot(self, run, made):
        lines = wkt_layer("LineString", [LINE], "EPSG:2154")
        log = Log()
        found = run(
            "profile",
            {
                "INPUT": str(made / "p.gpkg"),
                "LINES": lines,
                "OUTPUT": "memory:",
                "PLOT": "TEMPORARY_OUTPUT",
            },
            log,
        )
        layer = found["OUTPUT"]
        names = [field.name() for field in layer.fields()]
        assert names[:2] == ["line", "distance"]
        assert names[2] == "z_05"
        assert names[-1] == "z_00"
        values = numbers(made / "dem.tif").reshape(60, 80)[10]
        for feature in layer.getFeatures():
            column = feature["distance"] / 10 + 1
            due = np.interp(column, np.arange(80), values)
            assert feature["z_05"] == pytest.approx(due, abs=1e-3)
        assert found["N_POINTS"] == layer.featureCount() == 78
        assert found["LENGTH"] == pytest.approx(770)
        assert found["MAX_DIFFERENCE"] > 0.1
        page = Path(found["PLOT"]).read_text("utf-8")
        assert page.count("<polyline") == 3
        assert "level 5: 4,800" in page
        assert [line for line in log.lines if line.startswith("line ")]

    def test_every_other_output_and_a_line_in_degrees(self, run, made, tmp_path):
        from qgis.core import (
            QgsCoordinateReferenceSystem,
            QgsCoordinateTransform,
            QgsGeometry,
            QgsProject,
        )

        geometry = QgsGeometry.fromWkt(LINE)
        systems = [QgsCoordinateReferenceSystem(f"EPSG:{code}") for code in (2154, 4326)]
        geometry.transform(QgsCoordinateTransform(*systems, QgsProject.instance()))
        parameters = {
            "INPUT": str(made / "p.gpkg"),
            "LINES": wkt_layer("LineString", [geometry.asWkt(12)], "EPSG:4326"),
            "LEVELS": "0, 5",
            "STEP": 20.0,
            "PICTURE": str(tmp_path / "p.svg"),
            "TABLE": str(tmp_path / "p.csv"),
        }
        found = run("profile", parameters)
        assert "OUTPUT" not in found
        rows = list(csv.DictReader(Path(found["TABLE"]).read_text("utf-8").splitlines()))
        assert list(rows[0])[-2:] == ["z_00", "z_05"]
        assert float(rows[-1]["distance"]) == pytest.approx(770, abs=0.01)
        assert Path(found["PICTURE"]).read_text("utf-8").startswith("<svg")

    def test_what_cannot_be_meant_is_refused(self, run, refused, provider, made):
        parameters = {"INPUT": str(made / "p.gpkg"), "OUTPUT": "memory:"}
        away = wkt_layer("LineString", ["LineString (0 0, 10 10)"], "EPSG:2154")
        assert "no part of the line" in refused("profile", {**parameters, "LINES": away})
        nothing = wkt_layer("LineString", [], "EPSG:2154")
        assert "no line" in refused("profile", {**parameters, "LINES": nothing})
        from qgis.core import QgsProcessingContext

        lines = wkt_layer("LineString", [LINE], "EPSG:2154")
        is_fine, why = provider.algorithm("profile").checkParameterValues(
            {**parameters, "LINES": lines, "LEVELS": "fine"}, QgsProcessingContext()
        )
        assert not is_fine
        assert "such as 0,4,8" in why


class TestShape:
    def test_slope_and_curvature_flatten_with_the_level(self, run, made, tmp_path):
        def means(level):
            outputs = {
                name: str(tmp_path / f"{name}_{level}.tif")
                for name in ("SLOPE", "ASPECT", "MEAN_CURVATURE")
            }
            run("shapeoflevel", {"INPUT": str(made / "p.gpkg"), "LEVEL": level, **outputs})
            slope, aspect, curvature = (numbers(path) for path in outputs.values())
            assert slope.size == 60 * 80
            assert np.nanmin(aspect) >= 0
            assert np.nanmax(aspect) <= 360
            return np.nanmean(slope), np.nanstd(curvature)

        fine, coarse = means(5), means(0)
        assert coarse[1] < 0.8 * fine[1]
        assert coarse[0] == pytest.approx(fine[0], rel=0.1)

    def test_shape_is_of_windows_or_less_smooth_of_the_surface(self, run, made, tmp_path):
        bent = {}
        for fit in (None, "windows", "surface"):
            path = str(tmp_path / f"{fit}.tif")
            given = {} if fit is None else {"FIT": fit}
            run(
                "shapeoflevel",
                {"INPUT": str(made / "p.gpkg"), "LEVEL": 2, "MEAN_CURVATURE": path, **given},
            )
            bent[fit] = numbers(path)
        assert np.array_equal(bent[None], bent["windows"])
        assert np.nanstd(bent["surface"]) > np.nanstd(bent["windows"])

    def test_they_open_in_colours_that_mean_something(self, opened, made):
        layers = opened(
            "shapeoflevel",
            {
                "INPUT": str(made / "p.gpkg"),
                "LEVEL": 2,
                **dict.fromkeys(
                    ("SLOPE", "ASPECT", "PROFILE_CURVATURE", "TANGENTIAL_CURVATURE"),
                    "TEMPORARY_OUTPUT",
                ),
            },
        )
        assert set(layers) == {"Slope", "Aspect", "Profile curvature", "Tangential curvature"}
        for name, low_is_high in (("Aspect", True), ("Slope", False)):
            items = layers[name].renderer().shader().rasterShaderFunction().colorRampItemList()
            assert (items[0].color == items[-1].color) is low_is_high
        items = layers["Profile curvature"].renderer().shader().rasterShaderFunction()
        low, high = items.minimumValue(), items.maximumValue()
        assert low == -high
        assert "LEVEL = 2" in layers["Slope"].metadata().abstract()

    def test_landforms_and_heights_above_a_distance(self, run, refused, made, tmp_path):
        outputs = {name: str(tmp_path / f"{name}.tif") for name in ("LANDFORMS", "RESIDUAL")}
        pyramid = {"INPUT": str(made / "p.gpkg")}
        run("shapeoflevel", {**pyramid, "LEVEL_METRES": 12.0, **outputs})
        forms, above = numbers(outputs["LANDFORMS"], "u1"), numbers(outputs["RESIDUAL"])
        assert set(np.unique(forms)) <= {0, 1, 2, 3, 4, 5}
        assert len(np.unique(forms)) > 2
        assert abs(above.mean()) < 0.2 * above.std()
        both = refused("shapeoflevel", {**pyramid, "LEVEL": 1, "LEVEL_METRES": 12.0, **outputs})
        assert "exclude each other" in both
        far = refused("shapeoflevel", {**pyramid, "LEVEL_METRES": 1e6, **outputs})
        assert "levels' spacings are" in far

    def test_landforms_open_by_their_names(self, opened, made):
        outputs = dict.fromkeys(("LANDFORMS", "RESIDUAL"), "TEMPORARY_OUTPUT")
        layers = opened("shapeoflevel", {"INPUT": str(made / "p.gpkg"), "LEVEL": 2, **outputs})
        classes = layers["Landforms"].renderer().classes()
        assert [entry.label for entry in classes][:3] == ["planar", "pit", "channel"]
        assert set(layers) == {"Landforms", "Residual topography"}

    def test_no_output_is_refused(self, refused, made):
        assert "choose a raster" in refused("shapeoflevel", {"INPUT": str(made / "p.gpkg")})


class TestDifference:
    def test_the_input_less_its_dem_is_nothing(self, run, made, tmp_path):
        parameters = {"INPUT": str(made / "p.gpkg"), "LESS_DEM": str(made / "dem.tif")}
        found = run("difference", {**parameters, "LEVEL": 5, "OUTPUT": str(tmp_path / "a.tif")})
        assert max(abs(found["LOWEST"]), abs(found["HIGHEST"])) < 1e-3
        coarse = run("difference", {**parameters, "LEVEL": 0, "OUTPUT": str(tmp_path / "b.tif")})
        assert coarse["RMS"] > 0.1
        other = {"INPUT": str(made / "p.gpkg"), "LEVEL": 5, "LESS_LEVEL": 0}
        back = run("difference", {**other, "OUTPUT": str(tmp_path / "c.tif")})
        assert back["RMS"] == pytest.approx(coarse["RMS"], rel=1e-3)
        assert back["MEAN"] == pytest.approx(-coarse["MEAN"], abs=1e-4)

    def test_a_dem_in_another_crs_is_refused(self, refused, made, tmp_path):
        other = write_raster(tmp_path / "o.tif", hills().astype("float32"), epsg=32631)
        told = refused(
            "difference",
            {"INPUT": str(made / "p.gpkg"), "LESS_DEM": other, "OUTPUT": str(tmp_path / "d.tif")},
        )
        assert "reproject it" in told


class TestChangeByScale:
    def test_a_mound_is_found_in_the_coarse_bands(self, run, made, tmp_path):
        from osgeo import gdal

        y, x = np.mgrid[0 : hills().shape[0], 0 : hills().shape[1]]
        mound = 3.0 * np.exp(-((x - 20) ** 2 + (y - 15) ** 2) / 60.0)
        earlier = write_raster(tmp_path / "before.tif", (hills() - mound).astype("float32"))
        output = str(tmp_path / "change.tif")
        found = run(
            "changebyscale", {"INPUT": str(made / "p.gpkg"), "EARLIER": earlier, "OUTPUT": output}
        )
        assert found["HIGHEST"] == pytest.approx(3.0, abs=0.01)
        assert found["LOWEST"] == pytest.approx(0.0, abs=0.01)
        bands = gdal.Open(output).ReadAsArray()
        assert bands[0] == pytest.approx(mound, abs=1e-3)
        assert bands[1:].sum(axis=0) == pytest.approx(bands[0], abs=1e-3)
        assert np.abs(bands[1:-1].sum(axis=0)).max() > 3 * np.abs(bands[-1]).max()

    def test_an_earlier_dem_in_another_crs_is_refused(self, refused, made, tmp_path):
        other = write_raster(tmp_path / "o.tif", hills().astype("float32"), epsg=32631)
        parameters = {"INPUT": str(made / "p.gpkg"), "OUTPUT": str(tmp_path / "d.tif")}
        assert "reproject it" in refused("changebyscale", {**parameters, "EARLIER": other})


def test_the_mesh_quality_is_a_table(run, made):
    found = run(
        "meshquality", {"INPUT": str(made / "p.gpkg"), "LEVELS": "0,5", "OUTPUT": "memory:"}
    )
    rows = list(found["OUTPUT"].getFeatures())
    assert [row["level"] for row in rows] == [0, 5]
    assert rows[1]["median_angle"] == pytest.approx(45)
    assert rows[1]["longest_edge"] == pytest.approx(10 * 2**0.5)
    assert found["SMALLEST_ANGLE"] == pytest.approx(min(row["smallest_angle"] for row in rows))
    assert not found["OUTPUT"].isSpatial()


def test_terrain_for_the_web_is_a_set_of_tiles(run, made, tmp_path):
    pytest.importorskip("pyproj")
    folder = tmp_path / "tiles"
    parameters = {"INPUT": str(made / "p.gpkg"), "MAX_ERROR": 2.0, "OUTPUT": str(folder)}
    for _ in range(2):  # the second replaces the first
        found = run("webterrain", parameters)
        tiles = list(folder.rglob("*.terrain"))
        assert len(tiles) == found["N_TILES"] > 2
        assert (folder / "layer.json").is_file()
        assert found["MAX_ERROR_FINEST"] <= 2.0
    temporary = run("webterrain", {**parameters, "OUTPUT": "TEMPORARY_OUTPUT"})
    assert (Path(temporary["OUTPUT"]) / "layer.json").is_file()


def test_a_folder_of_something_else_is_not_replaced(refused, made, tmp_path):
    pytest.importorskip("pyproj")
    (tmp_path / "notes.txt").write_text("mine")
    told = refused("webterrain", {"INPUT": str(made / "p.gpkg"), "OUTPUT": str(tmp_path)})
    assert "layer.json" in told or "tile set" in told
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_reading_bands_back_moves_the_bar_and_heeds_cancel(qgis, provider, tmp_path):
    """Two seconds passed for thirty bands of a million cells."""
    from qgis.core import QgsCoordinateReferenceSystem, QgsFeedback
    from terrain_wavelets.plugin.qgis_io.raster_writer import write_bands

    from wavelet_core import Cancelled
    from wavelet_gis.model.dem import GridGeometry
    from wavelet_gis.products.vertex_raster import Bands

    geometry = GridGeometry((10, 12), (1.0, 0.0, 5e5, 0.0, -1.0, 5e6))
    values = np.arange(360, dtype="<f4").reshape(3, 10, 12)
    bands = Bands(values, ("a", "b", "c"), geometry)
    crs, seen = QgsCoordinateReferenceSystem("EPSG:25832"), []
    write_bands(str(tmp_path / "a.tif"), bands, crs, QgsFeedback(), seen.append)
    assert seen == sorted(seen)
    assert len(seen) == 6
    feedback = QgsFeedback()

    def cancel_at_the_end(share):
        if share > 0.75:
            feedback.cancel()

    with pytest.raises(Cancelled):
        write_bands(str(tmp_path / "b.tif"), bands, crs, feedback, cancel_at_the_end)
    assert [path.name for path in tmp_path.iterdir()] == ["a.tif"]


class TestScales:
    def test_roughness_and_deviation_have_the_strongest_first(self, run, made, tmp_path):
        outputs = {name: str(tmp_path / f"{name}.tif") for name in ("ROUGHNESS", "DEVIATION")}
        run("detaillayers", {"INPUT": str(made / "p.gpkg"), "OUTPUT": "memory:", **outputs})
        for path in outputs.values():
            raster = gdal.Open(path)
            assert raster.RasterCount >= 3
            bands = np.frombuffer(raster.ReadRaster(), "f4").reshape(-1, 60, 80)
            np.testing.assert_array_equal(np.abs(bands[0]), np.abs(bands[2:]).max(axis=0))
