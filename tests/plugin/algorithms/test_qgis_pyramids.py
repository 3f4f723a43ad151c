"""Pyramids as things one has: offered by dialogs, found again, and on the map when asked for."""

import pytest
from qgis_layers import Log, hills, wkt_layer, write_raster


@pytest.fixture
def project(qgis):
    from qgis.core import QgsProject

    yield QgsProject.instance()
    QgsProject.instance().clear()


@pytest.fixture
def dem(qgis, tmp_path):
    return write_raster(tmp_path / "hills.tif", hills().astype("float32"))


def dialog_of(provider, name):
    from processing.gui.AlgorithmDialog import AlgorithmDialog

    return AlgorithmDialog(provider.algorithm(name).create(), False, None)


def listed(dialog):
    combo = dialog.mainWidget().wrappers["INPUT"].choice.combo
    return {combo.itemData(k): combo.itemText(k) for k in range(combo.count())}


class TestTheList:
    def test_a_temporary_pyramid_is_found_again_and_chosen(self, provider, run, dem):
        made = run("analysedem", {"INPUT": dem, "LEVELS": 3, "OUTPUT": "TEMPORARY_OUTPUT"})
        dialog = dialog_of(provider, "qualityreport")
        wrapper = dialog.mainWidget().wrappers["INPUT"]
        assert wrapper.parameterValue() == made["OUTPUT"]
        assert listed(dialog)[made["OUTPUT"]] == "OUTPUT.gpkg (temporary): hills, 3 levels"
        parameters = dialog.mainWidget().createProcessingParameters()
        assert parameters["INPUT"] == made["OUTPUT"]

    def test_one_on_the_map_is_offered_and_other_geopackages_are_not(
        self, provider, run, project, dem, tmp_path, monkeypatch
    ):
        from qgis.core import QgsVectorLayer
        from terrain_wavelets.plugin.ui import known_pyramids

        path = run("analysedem", {"INPUT": dem, "LEVELS": 3, "OUTPUT": str(tmp_path / "p.gpkg")})
        other = run("extractlevel", {"INPUT": path["OUTPUT"], "TIN": str(tmp_path / "tin.gpkg")})
        monkeypatch.setattr(known_pyramids, "_made", {})  # as in the next session
        for source in (f"{path['OUTPUT']}|layername=coarse_tin", other["TIN"]):
            layer = QgsVectorLayer(source, "of a file", "ogr")
            assert layer.isValid()
            project.addMapLayer(layer)
        assert list(listed(dialog_of(provider, "detaillayers"))) == [path["OUTPUT"]]

    def test_a_file_that_is_gone_is_not_offered(self, provider, run, dem, tmp_path):
        path = tmp_path / "gone.gpkg"
        run("analysedem", {"INPUT": dem, "LEVELS": 3, "OUTPUT": str(path)})
        path.unlink()
        assert str(path) not in listed(dialog_of(provider, "reconstruct"))

    def test_any_path_may_be_typed(self, provider, run, dem, tmp_path):
        path = str(tmp_path / "p.gpkg")
        run("analysedem", {"INPUT": dem, "LEVELS": 3, "OUTPUT": path})
        dialog = dialog_of(provider, "extractlevel")
        wrapper = dialog.mainWidget().wrappers["INPUT"]
        wrapper.choice.combo.setEditText("nothing here.gpkg")
        assert wrapper.parameterValue() == "nothing here.gpkg"
        assert wrapper.choice.table.isHidden()
        wrapper.choice.combo.setEditText(path)
        assert wrapper.parameterValue() == path
        assert wrapper.choice.table.rowCount() == 4

    def test_the_table_has_the_levels_and_a_click_takes_one(self, provider, run, dem):
        made = run("analysedem", {"INPUT": dem, "LEVELS": 3, "OUTPUT": "TEMPORARY_OUTPUT"})
        dialog = dialog_of(provider, "extractlevel")
        wrappers = dialog.mainWidget().wrappers
        table = wrappers["INPUT"].choice.table
        rows = [[table.item(r, c).text() for c in range(4)] for r in range(table.rowCount())]
        assert [row[0] for row in rows] == ["0", "1", "2", "3"]
        assert rows[0][1:] == [
            f"{made['COARSE_VERTICES']:,}",
            f"{made['RMSE_SURFACE']:.4g}",
            f"{made['MAX_ERROR_SURFACE']:.4g}",
        ]
        assert rows[3][1:] == ["4,800", "0", "0"]
        table.cellClicked.emit(2, 1)
        assert wrappers["LEVEL"].parameterValue() == 2

    def test_models_and_batches_keep_the_widgets_of_qgis(self, provider):
        from processing.gui.BatchAlgorithmDialog import BatchAlgorithmDialog
        from processing.modeler.ModelerParametersDialog import ModelerParametersDialog
        from qgis.core import QgsProcessingModelAlgorithm
        from qgis.gui import QgsProcessingModelerParameterWidget

        algorithm = provider.algorithm("extractlevel")
        modeler = ModelerParametersDialog(algorithm.create(), QgsProcessingModelAlgorithm())
        widget = modeler.widget.widget.wrappers["INPUT"]
        assert isinstance(widget, QgsProcessingModelerParameterWidget)
        batch = BatchAlgorithmDialog(algorithm.create())
        assert batch.mainWidget().tblParameters.rowCount() > 0


def test_the_levels_are_in_the_log_where_there_is_no_window(run, dem, tmp_path):
    path = str(tmp_path / "p.gpkg")
    made = run("analysedem", {"INPUT": dem, "LEVELS": 3, "OUTPUT": path})
    log = Log()
    run("extractlevel", {"INPUT": path, "LEVEL": 1, "TIN": "memory:"}, feedback=log)
    head = next(k for k, line in enumerate(log.lines) if line.startswith("level "))
    rows = [line.split() for line in log.lines[head + 1 : head + 5]]
    assert [row[0] for row in rows] == ["0", "1", "2", "3"]
    assert rows[0][1] == str(made["COARSE_VERTICES"])
    assert rows[0][4] == f"{made['MAX_ERROR_SURFACE']:.4f}"


@pytest.mark.parametrize("asked", [True, False])
def test_a_pyramid_is_added_to_the_map_when_asked(run, project, dem, asked):
    from qgis.core import QgsProcessingContext

    context = QgsProcessingContext()
    context.setProject(project)
    made = run(
        "analysedem",
        {"INPUT": dem, "LEVELS": 2, "OUTPUT": "TEMPORARY_OUTPUT", "ADD_TO_MAP": asked},
        context=context,
    )
    opened = {
        source.split("=")[-1]
        for source in context.layersToLoadOnCompletion()
        if source.startswith(f"{made['OUTPUT']}|layername=")
    }
    layers = {"coarse_tin", "coarse_vertices", "detail_level_00", "detail_level_01"}
    assert opened == (layers if asked else set())


def test_a_pyramid_without_layers_takes_some(run, project, dem, tmp_path):
    from osgeo_utils.samples import validate_gpkg
    from qgis.core import (
        QgsFeedback,
        QgsProviderRegistry,
        QgsVectorFileWriter,
        QgsVectorLayer,
    )
    from terrain_wavelets.plugin.qgis_io.geopackage import add_layers

    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, read_summary
    from wavelet_gis.products.layers import coarse_layers

    out = str(tmp_path / "o.gpkg")
    run("analysedem", {"INPUT": dem, "OUTPUT": out, "LEVELS": 3, "LAYERS": "none"})
    plain = {"wavelet_metadata", "wavelet_levels", "wavelet_arrays", "wavelet_chunks"}

    def names():
        connection = (
            QgsProviderRegistry.instance().providerMetadata("ogr").createConnection(out, {})
        )
        return {table.tableName() for table in connection.tables()}

    assert names() == plain
    assert all(QgsVectorLayer(f"{out}|layername={name}").isValid() for name in plain)
    before = read_summary(out)
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.layerName = "point"
    options.actionOnExistingFile = QgsVectorFileWriter.CreateOrOverwriteLayer
    point = wkt_layer("Point", ["Point (1 2)"])
    QgsVectorFileWriter.writeAsVectorFormatV3(point, out, project.transformContext(), options)
    assert QgsVectorLayer(f"{out}|layername=point").featureCount() == 1
    geo = read_pyramid(out)
    add_layers(out, coarse_layers(geo), geo.system.wkt, QgsFeedback(), lambda _: True, 1)
    tin = QgsVectorLayer(f"{out}|layername=coarse_tin", "tin")
    assert tin.renderer().type() == "graduatedSymbol"
    assert tin.hasSpatialIndex() == tin.SpatialIndexPresence.SpatialIndexPresent
    assert names() >= {*plain, "point", "coarse_tin"}
    validate_gpkg.check(out)
    assert read_summary(out) == before
