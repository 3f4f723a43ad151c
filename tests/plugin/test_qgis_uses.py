"""What a pyramid is used for: filters, energy, clusters, classes, the report; in a real QGIS."""

import json
from pathlib import Path

import numpy as np
import pytest
from qgis_layers import Log, hills, read_raster, wkt_layer, write_raster


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


def numbers(path, dtype="f4"):
    raster = read_raster(path)
    return np.frombuffer(raster["bytes"], dtype).reshape(raster["shape"])


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


class TestSimplify:
    @pytest.fixture
    def dem(self, tmp_path):
        return write_raster(tmp_path / "dem.tif", hills(90, 70).astype("float32"), -9999.0)

    def test_the_number_of_vertices_is_exact(self, run, dem, tmp_path):
        made = run(
            "simplifydem",
            {
                "INPUT": dem,
                "VERTICES": 400,
                "TIN": "TEMPORARY_OUTPUT",
                "RASTER": str(tmp_path / "r.tif"),
                "MESH": str(tmp_path / "m.2dm"),
                "OUTPUT": str(tmp_path / "p.gpkg"),
            },
        )
        assert made["N_VERTICES"] == 400
        assert made["TIN"].featureCount() == made["N_FACES"]
        error = numbers(made["RASTER"]) - numbers(dem)
        assert np.sqrt(np.mean(error**2)) == pytest.approx(made["RMSE_SURFACE"], rel=1e-3)
        assert np.abs(error).max() == pytest.approx(made["MAX_ERROR_SURFACE"], rel=1e-3)
        back = run("reconstruct", {"INPUT": made["OUTPUT"], "DEM": str(tmp_path / "b.tif")})
        assert back["EXACT"] == "yes"

    def test_fitted_heights_have_the_smaller_mean_square(self, run, dem):
        parameters = {"INPUT": dem, "VERTICES": 200, "TIN": "TEMPORARY_OUTPUT"}
        fitted, lifted = run("simplifydem", parameters), run("simplifydem", parameters | {"FIT": 0})
        assert fitted["RMSE_SURFACE"] < 0.97 * lifted["RMSE_SURFACE"]

    @pytest.mark.parametrize(
        ("rule", "figure"), [("MAX_ERROR", "MAX_ERROR_SURFACE"), ("RMSE", "RMSE_SURFACE")]
    )
    def test_a_tolerance_is_kept(self, run, dem, rule, figure):
        made = run("simplifydem", {"INPUT": dem, rule: 6.0, "TIN": "TEMPORARY_OUTPUT"})
        assert 0 < made[figure] <= 6.0
        assert made["N_VERTICES"] < 6300

    @pytest.mark.parametrize(
        ("suffix", "start"),
        [
            (".2dm", b"MESH2D"),
            (".ply", b"ply"),
            (".obj", b"#"),
            (".stl", b"origin"),
            (".glb", b"glTF"),
            (".xml", b"<?xml"),
            (".dxf", b"  0"),
        ],
    )
    def test_every_mesh_format(self, run, dem, tmp_path, suffix, start):
        library = {".glb": "trimesh", ".dxf": "ezdxf"}.get(suffix)
        if library:
            pytest.importorskip(library)
        path = tmp_path / f"m{suffix}"
        made = run("simplifydem", {"INPUT": dem, "VERTICES": 60, "MESH": str(path)})
        assert made["MESH"] == str(path)
        content = path.read_bytes()
        assert content.startswith(start)
        n_written = {
            ".2dm": content.count(b"E3T"),
            ".stl": int.from_bytes(content[80:84], "little"),
            ".xml": content.count(b"<F>"),
            ".dxf": content.count(b"3DFACE"),
        }
        if suffix in n_written:
            assert n_written[suffix] == made["N_FACES"]

    def test_two_rules_are_refused(self, provider, dem):
        from qgis.core import QgsProcessingContext

        algorithm = provider.algorithm("simplifydem").create()
        is_fine, message = algorithm.checkParameterValues(
            {"INPUT": dem, "VERTICES": 5, "RMSE": 1.0}, QgsProcessingContext()
        )
        assert not is_fine
        assert "one of three" in message

    def test_the_number_of_vertices_is_no_output(self, run, dem, tmp_path, monkeypatch):
        here = tmp_path / "here"
        here.mkdir()
        monkeypatch.chdir(here)
        made = run("simplifydem", {"INPUT": dem, "VERTICES": 60, "TIN": "TEMPORARY_OUTPUT"})
        assert "VERTICES" not in made
        assert list(here.iterdir()) == []

    def test_without_a_rule_a_twentieth_of_the_cells_stays(self, run, dem):
        made = run("simplifydem", {"INPUT": dem, "TIN": "TEMPORARY_OUTPUT"})
        assert made["N_VERTICES"] == round(made["N_INPUT_VERTICES"] / 20)


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


@pytest.mark.parametrize(
    "words",
    ["mesh from dem", "tin", "decimate", "thin", "generalise", "generalize", "dem to tin"],
)
def test_the_toolbox_finds_the_way_from_a_dem_to_a_tin(provider, words):
    algorithm = provider.algorithm("simplifydem")
    shown = [algorithm.displayName(), algorithm.shortDescription(), *algorithm.tags()]
    text = " ".join(shown).lower()
    assert all(word in text for word in words.split())


def test_every_algorithm_is_described_in_one_line(provider):
    for algorithm in provider.algorithms():
        if algorithm.group() != "Models":
            assert 20 < len(algorithm.shortDescription()) < 100, algorithm.name()


def test_a_dialog_offers_what_the_tables_hold(provider):
    import wavelet_core
    from wavelet_gis.io.formats import MESH_FORMATS

    algorithm = provider.algorithm("simplifydem")
    for name in ("PARTITION", "NORM", "PREDICTION", "UPDATE", "SIGNAL"):
        parameter = algorithm.parameterDefinition(name)
        table = getattr(wavelet_core, f"{name}S")
        assert parameter.options() == ["default", *table]
        assert all(row.help in parameter.help() for row in table.values())
    mesh = algorithm.parameterDefinition("MESH")
    assert all(f"(*{row.suffix})" in mesh.fileFilter() for row in MESH_FORMATS)
    assert mesh.fileFilter().startswith("2DM")


def test_a_new_row_of_a_table_is_in_the_dialog(qgis, monkeypatch):
    from terrain_wavelets.plugin.algorithms import ALGORITHMS

    import wavelet_core
    from wavelet_gis.io import formats

    first = next(iter(wavelet_core.PREDICTIONS.values()))
    new = first._replace(name="median", short="MD", help="the median of the neighbours")
    monkeypatch.setitem(wavelet_core.PREDICTIONS, "median", new)
    row = formats.MeshFormat(".msh", "Gmsh", "a:b", "finite elements")
    monkeypatch.setattr(formats, "MESH_FORMATS", (*formats.MESH_FORMATS, row))
    (algorithm,) = (a() for a in ALGORITHMS if a().name() == "simplifydem")
    algorithm.initAlgorithm()
    prediction = algorithm.parameterDefinition("PREDICTION")
    assert "median" in prediction.options()
    assert "the median of the neighbours (MD" in prediction.help()
    assert "Gmsh (*.msh)" in algorithm.parameterDefinition("MESH").fileFilter()


def test_dialogs_open_without_scipy_and_say_what_is_missing(qgis, monkeypatch):
    from qgis.core import QgsProcessingContext
    from terrain_wavelets.plugin.algorithms import ALGORITHMS
    from terrain_wavelets.plugin.ui import dependencies

    find = dependencies.missing
    gone = dependencies.SCIPY
    monkeypatch.setattr(
        dependencies, "missing", lambda packages: [p for p in packages if p == gone or find([p])]
    )
    for kind in ALGORITHMS:
        algorithm = kind()
        algorithm.initAlgorithm()
        is_fine, message = algorithm.checkParameterValues({}, QgsProcessingContext())
        assert not is_fine
        assert "missing Python package: scipy" in message


def test_a_command_for_a_terminal_is_quoted(qgis, monkeypatch):
    from terrain_wavelets.plugin.ui import dependencies

    monkeypatch.setattr(dependencies.sys, "platform", "darwin")
    assert "'laspy[lazrs]'" in dependencies.remedy([dependencies.LASPY])
    monkeypatch.setattr(dependencies.sys, "platform", "win32")
    assert '"laspy[lazrs]"' in dependencies.remedy([dependencies.LASPY])


def test_an_outline_that_may_move_lets_a_level_be_coarser(run, tmp_path):
    values = hills(40, 50).astype("float32")
    rows, columns = np.mgrid[:40, :50]
    values[np.hypot(rows - 20, columns - 25) > 17] = -9999.0
    path = write_raster(tmp_path / "round.tif", values, -9999.0)
    parameters = {"INPUT": path, "VERTICES": 12, "TIN": "TEMPORARY_OUTPUT"}
    log = Log()
    fixed = run("simplifydem", parameters, feedback=log)
    assert fixed["N_VERTICES"] > 12
    assert any("12" in line and "asked" in line for line in log.lines), log.lines
    moved = run("simplifydem", {**parameters, "OUTLINE_TOLERANCE": 40.0})
    assert moved["N_VERTICES"] == 12


def test_what_is_noted_of_an_input_is_in_the_log(run, tmp_path):
    values = hills(30, 40).astype("float32")
    path = write_raster(tmp_path / "d.tif", values, None, 4326, (7.0, 44.0), 1 / 3600)
    log = Log()
    parameters = {"INPUT": path, "OUTPUT": str(tmp_path / "p.gpkg"), "LEVELS": 1}
    run("analysedem", parameters, feedback=log)
    assert any("local metric frame" in line for line in log.lines)


def test_an_error_names_parameters_as_the_dialog_does(provider):
    from wavelet_core import OptionError

    error = OptionError("{0} is {given}; leave out {1}.", "max_rms", "target_vertices", given=-1)
    assert provider.algorithm("simplifydem").in_words(error) == (
        "'RMSE' is -1; leave out 'Number of vertices'."
    )
    assert provider.algorithm("analysedem").in_words(error) == (
        "'Stop at this RMSE' is -1; leave out 'Stop at this number of vertices'."
    )


def test_a_size_is_filtered_in_the_unit_of_the_layer_on_a_default_pyramid(run, tmp_path):
    path = write_raster(tmp_path / "feet.tif", hills(60, 60).astype("float32"), None, 2264, cell=1)
    pyramid = run("analysedem", {"INPUT": path, "OUTPUT": str(tmp_path / "p.gpkg")})["OUTPUT"]
    log = Log()
    parameters = {"INPUT": pyramid, "SMALLEST_SIZE": 12.0, "DEM": str(tmp_path / "f.tif")}
    made = run("filterlevels", parameters, feedback=log)
    assert made["RMS_CHANGE"] > 0
    (line,) = [line for line in log.lines if "sizes of" in line]
    assert "3.65761" in line  # twelve feet, in metres


def test_computing_answers_a_cancel_and_moves_the_bar(qgis):
    """A step that asks nobody for long, as a triangulation does."""
    import threading
    import time

    from terrain_wavelets.plugin.qgis_io.patience import computed

    from wavelet_core.errors import Cancelled

    log, told = Log(), []
    timer = threading.Timer(1.5, log.cancel)
    timer.start()
    began = time.perf_counter()

    def work(work):
        time.sleep(8)
        told.append(work.progress(1.0))

    with pytest.raises(Cancelled):
        computed(log, work, 0.2, 0.6)
    assert time.perf_counter() - began < 4
    assert len(set(log.fractions)) >= 3
    assert log.fractions == sorted(log.fractions)
    assert min(log.fractions) >= 20
    assert max(log.fractions) < 60
    assert not told, "nobody waited for it"


def test_what_is_computed_comes_back_with_its_warnings_notes_and_errors(qgis):
    from terrain_wavelets.plugin.qgis_io.patience import computed
    from terrain_wavelets.plugin.ui.warning_log import shown_in

    from wavelet_core.errors import MeshError
    from wavelet_gis.errors import TerrainWarning
    from wavelet_gis.notes import collected, warn

    log = Log()

    def work(work):
        warn(TerrainWarning, "odd", "this is odd")
        work.teller(log.pushInfo)("begun")
        assert work.progress(0.5)
        return 7

    with shown_in(log, str), collected() as notes:
        assert computed(log, work, 0.0, 1.0) == 7
    assert [note.code for note in notes] == ["odd"]
    assert any("this is odd" in line for line in log.warnings)
    assert log.lines == ["begun"]

    def fails(work):
        raise MeshError("no mesh")

    with pytest.raises(MeshError, match="no mesh"):
        computed(log, fails, 0.0, 1.0)


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
        symbol = layer.renderer().symbol().symbolLayer(0)
        assert symbol.dataDefinedProperties().hasActiveProperties()
        assert "FOUND_LEVEL = " in layer.metadata().abstract()
        project.clear()
