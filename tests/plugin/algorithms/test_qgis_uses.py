"""What a pyramid is used for: filters, energy, clusters, classes, the report; in a real QGIS."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from qgis_layers import Log, hills, numbers, wkt_layer, write_raster


@pytest.fixture(scope="module")
def pyramid(qgis, tmp_path_factory):
    """Return a pyramid of a DEM that is smooth in the west and rough in the east."""
    import processing

    folder = tmp_path_factory.mktemp("uses")
    rough = np.random.default_rng(1).normal(size=(80, 100)) * 3.0
    rough[:, :50] = 0
    path = write_raster(folder / "dem.tif", (hills(80, 100) + rough).astype("float32"))
    return processing.run(
        "terrainwavelets:analysedem",
        {
            "INPUT": path,
            "OUTPUT": str(folder / "p.gpkg"),
            "LEVELS": 6,
            "PARTITION": "random",
            "PREDICTION": "plane",
        },
    )["OUTPUT"]


class TestFilter:
    def test_unit_gains_change_nothing(self, run, pyramid, tmp_path):
        made = run(
            "filterlevels",
            {"INPUT": pyramid, "GAINS": [5, 1.0], "DEM": str(tmp_path / "f.tif")},
        )
        assert made["MAX_CHANGE"] == pytest.approx(0.0, abs=1e-9)

    def test_without_the_finest_details_the_rough_half_is_smoother(self, run, pyramid, tmp_path):
        original = run("reconstruct", {"INPUT": pyramid, "DEM": str(tmp_path / "o.tif")})
        made = run(
            "filterlevels",
            {
                "INPUT": pyramid,
                "LAST_LEVEL": 3,
                "DEM": str(tmp_path / "f.tif"),
                "DIFFERENCE": str(tmp_path / "d.tif"),
                "OUTPUT": str(tmp_path / "f.gpkg"),
            },
        )
        before, after = numbers(original["DEM"]), numbers(made["DEM"])
        difference = numbers(made["DIFFERENCE"])
        assert np.allclose(after - before, difference, atol=1e-4)
        assert np.std(difference[:, 55:]) > 2 * np.std(difference[:, :45])
        assert made["RMS_CHANGE"] == pytest.approx(np.sqrt(np.mean(difference**2)), rel=1e-3)
        # The pyramid that was written holds the same terrain, and says that it was changed.
        again = run("reconstruct", {"INPUT": made["OUTPUT"], "DEM": str(tmp_path / "a.tif")})
        assert again["EXACT"] == "no"
        assert np.array_equal(numbers(again["DEM"]), after)

    def test_a_first_click_removes_noise_and_says_so(self, run, pyramid, tmp_path):
        log = Log()
        made = run("filterlevels", {"INPUT": pyramid, "DEM": str(tmp_path / "f.tif")}, log)
        assert made["SIGMA"] > 0
        assert made["RMS_CHANGE"] > 0
        assert any("noise is removed" in line for line in log.lines)

    def test_stripes_along_rows_are_looked_for_and_told(self, run, pyramid, tmp_path):
        log = Log()
        parameters = {"INPUT": pyramid, "DENOISE": True, "STRIPES": "rows", "PYRAMIDS": 1}
        run("filterlevels", {**parameters, "DEM": str(tmp_path / "f.tif")}, log)
        assert any("lines" in line and "offsets" in line for line in log.lines)

    def test_gains_that_are_no_numbers_are_refused_before_it_starts(self, provider, pyramid):
        from qgis.core import QgsProcessingContext

        algorithm = provider.algorithm("filterlevels").create()
        parameters = {"INPUT": pyramid, "DEM": "TEMPORARY_OUTPUT", "GAINS": ["five", "x"]}
        is_fine, message = algorithm.checkParameterValues(parameters, QgsProcessingContext())
        assert not is_fine
        assert "pairs" in message

    def test_cancel_while_denoising_leaves_nothing_behind(self, run, pyramid, tmp_path):
        log = Log(cancel_at=20)
        made = run(
            "filterlevels",
            {"INPUT": pyramid, "DENOISE": True, "DEM": str(tmp_path / "f.tif")},
            feedback=log,
        )
        assert not made.get("DEM")
        assert list(tmp_path.iterdir()) == []


class TestCancelledBetweenOutputs:
    """What was written before is taken back, whole or not: half of the outputs is no result."""

    def run_until(self, qgis, name, parameters, is_time):
        from qgis.core import QgsProcessingContext

        self.log = log = Log()
        log.progressChanged.connect(lambda: is_time() and log.cancel())
        log.isCanceled = lambda: is_time() or Log.isCanceled(log)
        algorithm = qgis.processingRegistry().algorithmById(f"terrainwavelets:{name}").create()
        results, _ = algorithm.run(parameters, QgsProcessingContext(), log)
        return results, log

    def test_the_first_raster_goes_when_the_second_is_cancelled(self, qgis, pyramid, tmp_path):
        first, second = tmp_path / "aspect.tif", tmp_path / "slope.tif"
        there = tmp_path / "there.tif"
        there.write_bytes(b"of another run")
        parameters = {"INPUT": pyramid, "LEVEL": 2, "SLOPE": str(second), "ASPECT": str(first)}
        written = [first, second]
        results, log = self.run_until(
            qgis, "shapeoflevel", parameters, lambda: any(path.exists() for path in written)
        )
        assert results == {}
        assert log.lines[-1] == "Cancelled; nothing was written."
        assert sorted(tmp_path.iterdir()) == [there]

    def test_the_layer_of_details_goes_with_what_is_in_it(self, qgis, pyramid, tmp_path):
        path = tmp_path / "details.gpkg"
        parameters = {"INPUT": pyramid, "OUTPUT": str(path)}
        results, _ = self.run_until(qgis, "detaillayers", parameters, path.exists)
        assert results == {}
        assert list(tmp_path.iterdir()) == []

    def test_what_was_written_before_a_refusal_goes_too(self, qgis, pyramid, tmp_path, monkeypatch):
        from qgis.core import QgsProcessingContext

        from wavelet_core.errors import WaveletError
        from wavelet_gis.workflows.extract import Surface

        def failing(*arguments, **options):
            raise WaveletError("the outline meets itself.")

        monkeypatch.setattr(Surface, "write", failing)
        tin, mesh = tmp_path / "tin.gpkg", tmp_path / "mesh.2dm"
        algorithm = qgis.processingRegistry().algorithmById("terrainwavelets:extractlevel").create()
        parameters = {"INPUT": pyramid, "LEVEL": 2, "TIN": str(tin), "MESH": str(mesh)}
        log = Log()
        _, is_done = algorithm.run(parameters, QgsProcessingContext(), log)
        assert not is_done
        assert log.errors == ["The outline meets itself."]
        assert list(tmp_path.iterdir()) == []

    def test_a_refusal_leaves_nothing_in_memory(self, qgis, pyramid, monkeypatch):
        import gc
        import weakref

        from qgis.core import QgsProcessingContext

        from wavelet_core.errors import WaveletError
        from wavelet_gis.workflows import extract

        held = []

        class Large:
            pass

        def failing(*arguments, **options):
            in_the_frame = Large()
            held.append(weakref.ref(in_the_frame))
            raise WaveletError("no.")

        monkeypatch.setattr(extract, "extract", failing)
        algorithm = qgis.processingRegistry().algorithmById("terrainwavelets:extractlevel").create()
        parameters = {"INPUT": pyramid, "LEVEL": 2, "RASTER": "TEMPORARY_OUTPUT"}
        _, is_done = algorithm.run(parameters, QgsProcessingContext(), Log())
        assert not is_done
        gc.collect()
        assert len(held) == 1
        assert held[0]() is None

    @pytest.mark.parametrize("output", ["memory:", "/no/such/folder/levels.gpkg"])
    def test_a_refusal_is_not_held_by_qgis(self, qgis, pyramid, output):
        """Neither one of the work nor one before it; else steps of a model kept their layers."""
        import gc
        import weakref

        from qgis.core import QgsProcessingContext

        held = []

        class Large:
            pass

        def refused():
            large = Large()
            algorithm = qgis.processingRegistry().algorithmById("terrainwavelets:extractlevel")
            algorithm = algorithm.create()
            held.extend([weakref.ref(large), weakref.ref(algorithm)])
            log, parameters = Log(), {"INPUT": pyramid, "LEVEL": 99, "TIN": output}
            _, is_done = algorithm.run(parameters, QgsProcessingContext(), log)
            assert not is_done
            assert len(log.errors) == 1

        refused()
        gc.collect()
        of_caller, algorithm = held
        assert of_caller() is None
        assert algorithm() is None

    def test_a_layer_that_features_are_added_to_stays(self, qgis, pyramid, tmp_path):
        """It holds what the user had in it before."""
        import processing
        from qgis.core import (
            QgsProcessingOutputLayerDefinition,
            QgsRemappingSinkDefinition,
            QgsVectorLayer,
        )

        path = tmp_path / "mine.gpkg"
        processing.run("terrainwavelets:detaillayers", {"INPUT": pyramid, "OUTPUT": str(path)})
        layer = QgsVectorLayer(str(path), "mine", "ogr")
        mapping = QgsRemappingSinkDefinition()
        mapping.setDestinationFields(layer.fields())
        mapping.setDestinationWkbType(layer.wkbType())
        mapping.setDestinationCrs(layer.crs())
        n_before = layer.featureCount()
        output = QgsProcessingOutputLayerDefinition(str(path))
        output.setRemappingDefinition(mapping)
        parameters = {"INPUT": pyramid, "OUTPUT": output}
        results, _ = self.run_until(
            qgis, "detaillayers", parameters, lambda: max(self.log.fractions, default=0) > 40
        )
        assert results == {}
        assert QgsVectorLayer(str(path), "mine", "ogr").featureCount() >= n_before

    def test_a_table_in_a_database_of_the_user_leaves_the_database(self, qgis, pyramid, tmp_path):
        import sqlite3

        path = tmp_path / "mine.gpkg"
        with sqlite3.connect(path) as database:
            database.execute("CREATE TABLE mine (a)")
        parameters = {"INPUT": pyramid, "OUTPUT": f"ogr:dbname='{path}' table=\"details\" (geom)"}
        n_seen = []
        self.run_until(
            qgis, "detaillayers", parameters, lambda: n_seen.append(1) or len(n_seen) > 20
        )
        with sqlite3.connect(path) as database:
            assert database.execute("SELECT count(*) FROM mine").fetchone() == (0,)


def test_energy_maps_where_the_terrain_is_rough(run, pyramid, tmp_path):
    from osgeo import gdal

    made = run(
        "detaillayers",
        {"INPUT": pyramid, "OUTPUT": "TEMPORARY_OUTPUT", "ENERGY": str(tmp_path / "e.tif")},
    )
    dataset = gdal.Open(made["ENERGY"])
    assert dataset.RasterCount == 6
    finest = dataset.GetRasterBand(6)
    assert "level 5" in finest.GetDescription()
    energy = np.frombuffer(finest.ReadRaster(), "f4").reshape(80, 100)
    assert np.nanmean(energy[:, 55:]) > 3 * np.nanmean(energy[:, :45])


class TestClusters:
    def test_two_clusters_are_the_two_halves(self, run, pyramid, tmp_path):
        made = run(
            "clusterdetails",
            {
                "INPUT": pyramid,
                "COUNT": 2,
                "RASTER": str(tmp_path / "c.tif"),
                "OUTPUT": "TEMPORARY_OUTPUT",
                "SUMMARY": str(tmp_path / "c.json"),
            },
        )
        assert made["N_CLUSTERS"] == 2
        labels = numbers(made["RASTER"], "u1")
        assert (labels[:, :45] == 0).mean() > 0.9
        assert (labels[:, 55:] == 1).mean() > 0.9
        assert made["OUTPUT"].featureCount() == 8000
        summary = json.loads(Path(made["SUMMARY"]).read_text())
        assert [row["label"] for row in summary["clusters"]] == [0, 1]

    def test_the_bar_never_runs_back_whichever_outputs_are_wanted(self, run, pyramid, tmp_path):
        """The points began where the raster had begun, behind where it had ended."""
        log = Log()
        outputs = {"RASTER": str(tmp_path / "c.tif"), "OUTPUT": "TEMPORARY_OUTPUT"}
        run("clusterdetails", {"INPUT": pyramid, "COUNT": 2, **outputs}, log)
        assert max(log.fractions) > 90
        steps = list(pairwise(log.fractions))
        assert [step for step in steps if step[1] < step[0]] == []

    def test_classes_are_learned_from_training_areas(self, run, pyramid, tmp_path):
        pytest.importorskip("sklearn")
        import processing

        boxes = [(700050, 700200), (700800, 700950)]
        wkts = [f"Polygon (({a} 6599300, {b} 6599300, {b} 6599900, {a} 6599900, {a} 6599300))"
                for a, b in boxes]  # fmt: skip
        areas = wkt_layer("Polygon", wkts)
        areas = processing.run(
            "native:fieldcalculator",
            {
                "INPUT": areas,
                "FIELD_NAME": "kind",
                "FIELD_TYPE": 1,
                "FORMULA": "if(x_min($geometry) < 700500, 3, 7)",
                "OUTPUT": "TEMPORARY_OUTPUT",
            },
        )["OUTPUT"]
        made = run(
            "clusterdetails",
            {
                "INPUT": pyramid,
                "LEARN_FROM": "training areas",
                "TRAINING": areas,
                "CLASS_FIELD": "kind",
                "RASTER": str(tmp_path / "c.tif"),
            },
        )
        labels = numbers(made["RASTER"], "u1")
        assert set(np.unique(labels)) == {3, 7}
        assert (labels[:, :45] == 3).mean() > 0.9
        assert (labels[:, 55:] == 7).mean() > 0.9

    def test_training_without_a_layer_is_refused(self, provider, pyramid):
        from qgis.core import QgsProcessingContext

        algorithm = provider.algorithm("clusterdetails").create()
        parameters = {"INPUT": pyramid, "LEARN_FROM": "training areas", "RASTER": "x.tif"}
        is_fine, message = algorithm.checkParameterValues(parameters, QgsProcessingContext())
        assert not is_fine
        assert "training" in message


def test_report_needs_no_network(run, pyramid, tmp_path):
    made = run(
        "qualityreport",
        {
            "INPUT": pyramid,
            "OUTPUT": str(tmp_path / "r.html"),
            "FIGURES": str(tmp_path / "r.json"),
        },
    )
    page = Path(made["OUTPUT"]).read_text(encoding="utf-8")
    assert "<img" in page or "<svg" in page
    assert 'src="http' not in page
    figures = json.loads(Path(made["FIGURES"]).read_text())
    assert figures["levels"][-1]["n_vertices"] == made["COARSE_VERTICES"]


def test_two_in_batch(provider, pyramid, tmp_path):
    """Run one algorithm twice over, as the batch panel does: a new instance for each row."""
    from qgis.core import QgsProcessingContext

    algorithm = provider.algorithm("extractlevel")
    for level in (0, 3):
        context = QgsProcessingContext()
        parameters = {
            "INPUT": pyramid,
            "LEVEL": level,
            "TIN": str(tmp_path / f"level_{level}.gpkg"),
        }
        results, is_ok = algorithm.create().run(parameters, context, Log())
        assert is_ok
        assert Path(results["TIN"].split("|")[0]).stat().st_size > 0
    sizes = [(tmp_path / f"level_{level}.gpkg").stat().st_size for level in (0, 3)]
    assert sizes[1] > sizes[0]


@pytest.fixture
def opened(qgis):
    """Return a function that runs an algorithm and returns the layers that it opens, by name."""
    import processing
    from qgis.core import QgsProcessingContext, QgsProject

    project = QgsProject.instance()

    def run_and_open(name, parameters):
        context = QgsProcessingContext()
        context.setProject(project)
        processing.runAndLoadResults(f"terrainwavelets:{name}", parameters, context=context)
        return {layer.name(): layer for layer in project.mapLayers().values()}

    yield run_and_open
    project.clear()


class TestEveryOutputOpensStyled:
    def test_energy_is_one_band_in_a_ramp_from_nothing(self, opened, pyramid):
        parameters = {"INPUT": pyramid, "OUTPUT": "TEMPORARY_OUTPUT", "ENERGY": "TEMPORARY_OUTPUT"}
        renderer = opened("detaillayers", parameters)["Energy by level"].renderer()
        assert renderer.type() == "singlebandpseudocolor"
        assert renderer.classificationMin() == 0
        assert renderer.classificationMax() > 0

    def test_a_difference_is_white_where_nothing_changed(self, opened, pyramid):
        parameters = {
            "INPUT": pyramid,
            "LAST_LEVEL": 3,
            "DEM": "TEMPORARY_OUTPUT",
            "DIFFERENCE": "TEMPORARY_OUTPUT",
        }
        layer = opened("filterlevels", parameters)["Difference of the DEMs"]
        items = layer.renderer().shader().rasterShaderFunction().colorRampItemList()
        values = [item.value for item in items]
        assert values[0] == -values[-1] < 0
        (middle,) = (item for item in items if item.value == 0)
        assert middle.color.getRgb()[:3] == (247, 247, 247)

    @pytest.mark.parametrize("options", [{"LOOK": "difference"}, {"DROP_COARSE": True}])
    def test_what_is_about_zero_is_not_shaded(self, opened, pyramid, options):
        parameters = {"INPUT": pyramid, "LAST_LEVEL": 3, "DEM": "TEMPORARY_OUTPUT", **options}
        layer = opened("filterlevels", parameters)["Filtered DEM"]
        assert layer.renderer().type() == "singlebandpseudocolor"

    def test_vertices_of_a_level_and_a_temporary_mesh(self, opened, pyramid):
        parameters = {
            "INPUT": pyramid,
            "TIN": "TEMPORARY_OUTPUT",
            "VERTICES": "TEMPORARY_OUTPUT",
            "MESH": "TEMPORARY_OUTPUT",
        }
        layers = opened("extractlevel", parameters)
        assert set(layers) == {"TIN of the level", "Vertices of the level", "Mesh of the level"}
        for layer in layers.values():
            assert layer.metadata().abstract().startswith("Extract level: ")
            assert "<i>" not in layer.metadata().abstract()
            assert "MAX_ERROR_SURFACE = " in layer.metadata().abstract()
            assert "suffix chooses" not in layer.metadata().abstract()
            (command,) = layer.metadata().history()
            assert command.startswith('processing.run("terrainwavelets:extractlevel"')
            assert layer.metadata().crs() == layer.crs()
        symbol = layers["Vertices of the level"].renderer().symbol()
        assert symbol.color().getRgb()[:3] == (60, 60, 60)

    def test_a_cluster_has_one_colour_as_raster_and_as_points(self, opened, pyramid):
        parameters = {
            "INPUT": pyramid,
            "COUNT": 3,
            "RASTER": "TEMPORARY_OUTPUT",
            "OUTPUT": "TEMPORARY_OUTPUT",
        }
        layers = opened("clusterdetails", parameters)
        of_cells = {
            int(c.value): c.color.name() for c in layers["Map of clusters"].renderer().classes()
        }
        of_points = {
            int(c.value()): c.symbol().color().name()
            for c in layers["Clustered vertices"].renderer().categories()
        }
        assert of_cells == of_points
        assert len(set(of_cells.values())) == 3


def test_a_size_is_filtered_in_the_unit_of_the_layer_on_a_default_pyramid(run, tmp_path):
    path = write_raster(tmp_path / "feet.tif", hills(60, 60).astype("float32"), None, 2264, cell=1)
    pyramid = run("analysedem", {"INPUT": path, "OUTPUT": str(tmp_path / "p.gpkg")})["OUTPUT"]
    log = Log()
    parameters = {"INPUT": pyramid, "SMALLEST_SIZE": 12.0, "DEM": str(tmp_path / "f.tif")}
    made = run("filterlevels", parameters, feedback=log)
    assert made["RMS_CHANGE"] > 0
    (line,) = [line for line in log.lines if "sizes of" in line]
    assert "3.65761" in line  # twelve feet, in metres


class TestContours:
    def test_a_first_click_gives_about_twenty_heights_of_a_fitting_level(self, run, pyramid):
        log = Log()
        made = run("contours", {"INPUT": pyramid, "OUTPUT": "memory:"}, log)
        layer = made["OUTPUT"]
        heights = {f["elevation"] for f in layer.getFeatures()}
        assert 8 <= len(heights) <= 40
        assert layer.featureCount() == made["N_CONTOURS"]
        assert 0 < made["FOUND_LEVEL"] <= 6
        for feature in layer.getFeatures():
            assert feature["elevation"] % made["FOUND_INTERVAL"] == pytest.approx(0, abs=1e-9)
            assert {v.z() for v in feature.geometry().vertices()} == {feature["elevation"]}

    def test_the_coarser_the_level_the_smoother_the_contours(self, run, pyramid):
        def n_points(level):
            parameters = {"INPUT": pyramid, "LEVEL": level, "INTERVAL": 10, "OUTPUT": "memory:"}
            layer = run("contours", parameters)["OUTPUT"]
            return sum(f.geometry().constGet().nCoordinates() for f in layer.getFeatures())

        assert n_points(0) < n_points(3) < n_points(6)

    def test_every_fifth_is_marked_and_drawn_thick(self, run, pyramid):
        import processing
        from qgis.core import QgsProcessingContext, QgsProject

        project = QgsProject.instance()
        context = QgsProcessingContext()
        context.setProject(project)
        processing.runAndLoadResults(
            "terrainwavelets:contours",
            {"INPUT": pyramid, "INTERVAL": 4.0, "OUTPUT": "TEMPORARY_OUTPUT"},
            context=context,
            feedback=Log(),
        )
        (layer,) = project.mapLayers().values()
        marked = {f["elevation"] for f in layer.getFeatures() if f["is_index"]}
        assert marked
        assert all(height % 20 == 0 for height in marked)
        thin, thick = (category.symbol().width() for category in layer.renderer().categories())
        assert thick > 2 * thin
        assert "FOUND_LEVEL = " in layer.metadata().abstract()
        project.clear()
