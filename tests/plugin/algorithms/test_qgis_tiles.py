"""Tile sets made and read in a real QGIS, which has neither rasterio, pyogrio nor Dask."""

import json
import time
from pathlib import Path

import numpy as np
import pytest
from qgis_layers import Log, hills, survey, write_las, write_raster

NEAR = 300  # metres


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    """Return a DEM of 90 x 120 cells with a hole."""
    values = hills(90, 120).astype("float32")
    values[20:24, 30:50] = -9999.0
    return write_raster(tmp_path_factory.mktemp("dem") / "dem.tif", values, nodata=-9999.0)


@pytest.fixture(scope="module")
def tiles(qgis, dem, tmp_path_factory):
    """Return what comes of a DEM in 3 x 4 tiles."""
    import processing

    folder = str(tmp_path_factory.mktemp("tiles") / "set")
    parameters = {"RASTERS": [dem], "TILE": 30, "OUTPUT": folder}
    return processing.run("terrainwavelets:tileterrain", parameters)


def region(tiles, **parameters):
    """Return the triangles of a region and the figures."""
    import processing

    return processing.run(
        "terrainwavelets:extractfromtiles",
        {"INPUT": tiles["INDEX"], "TIN": "memory:", **parameters},
    )


def test_a_dem_in_tiles_is_what_scripts_make_of_it(tiles, dem):
    from wavelet_gis.tiles.index import open_index
    from wavelet_gis.tiles.read import restored_raster

    index = open_index(tiles["OUTPUT"])
    assert (tiles["N_TILES"], tiles["N_MADE"], tiles["N_FOUND"], tiles["N_FAILED"]) == (
        12,
        17,
        0,
        0,
    )
    assert tiles["N_LEVELS"] == index.n_levels > 3
    assert {row["status"] for row in index.records.values()} == {"whole"}
    values = hills(90, 120).astype("float32")
    restored = restored_raster(index)
    is_hole = np.zeros(values.shape, dtype=bool)
    is_hole[20:24, 30:50] = True
    np.testing.assert_array_equal(restored.valid, ~is_hole)
    np.testing.assert_array_equal(restored.values[~is_hole], values[~is_hole])


def test_the_index_is_a_layer_in_the_crs_of_the_dem(tiles):
    from qgis.core import QgsVectorLayer

    layer = QgsVectorLayer(tiles["INDEX"], "index", "ogr")
    assert layer.isValid()
    assert layer.crs().authid() == "EPSG:2154"
    assert layer.featureCount() == 17
    rows = list(layer.getFeatures())
    assert {row["status"] for row in rows} == {"whole"}
    assert all(row["n_bytes"] > 0 and row["sha256"] for row in rows)
    whole = next(row for row in rows if row["stage"] == 2).geometry().boundingBox()
    assert (whole.width(), whole.height()) == (1200.0, 900.0)


def test_the_index_opens_styled(qgis, dem, tmp_path):
    import processing
    from processing.gui.Postprocessing import handleAlgorithmResults
    from qgis.core import QgsProcessingContext, QgsProcessingFeedback, QgsProject

    project = QgsProject()
    context = QgsProcessingContext()
    context.setProject(project)
    feedback = QgsProcessingFeedback()
    algorithm = qgis.processingRegistry().algorithmById("terrainwavelets:tileterrain").create()
    parameters = {"RASTERS": [dem], "TILE": 45, "OUTPUT": str(tmp_path / "set")}
    assert processing.run(algorithm, parameters, context=context, feedback=feedback)
    handleAlgorithmResults(algorithm, context, feedback, parameters=parameters)
    (layer,) = project.mapLayers().values()
    assert layer.name() == "Index of the tiles"
    assert layer.renderer().type() == "categorizedSymbol"
    assert [c.value() for c in layer.renderer().categories()] == [
        "whole",
        "loose",
        "empty",
        "failed",
    ]
    assert "n_tiles = 6" in layer.metadata().abstract()


def test_a_second_run_makes_what_is_missing(run, dem, tmp_path):
    folder = tmp_path / "set"
    parameters = {"RASTERS": [dem], "TILE": 45, "OUTPUT": str(folder)}
    first = run("tileterrain", parameters)
    piece = folder / "pieces" / "0" / "00000_00001.gpkg"
    before = piece.read_bytes()
    piece.unlink()
    second = run("tileterrain", parameters)
    assert (first["N_MADE"], second["N_MADE"], second["N_FOUND"]) == (9, 1, 8)
    assert piece.read_bytes() == before
    other = run("tileterrain", {**parameters, "TILE": 60})
    assert (other["N_MADE"], other["N_FOUND"]) == (3, 0)


def test_several_rasters_are_one(run, tmp_path):
    values = hills(40, 80).astype("float32")
    paths = [
        write_raster(tmp_path / "west.tif", values[:, :40].copy()),
        write_raster(tmp_path / "east.tif", values[:, 40:].copy(), origin=(700400.0, 6600000.0)),
    ]
    made = run("tileterrain", {"RASTERS": paths, "TILE": 40, "OUTPUT": str(tmp_path / "set")})
    from wavelet_gis.tiles.read import restored_raster

    np.testing.assert_array_equal(restored_raster(made["OUTPUT"]).values, values)


def test_clouds_are_tiled_and_come_back(run, tmp_path):
    pytest.importorskip("laspy")
    pytest.importorskip("pyproj")
    path = write_las(tmp_path / "points.las", survey(12_000))
    parameters = {"CLOUDS": [path], "TILE": 500, "OUTPUT": str(tmp_path / "set")}
    made = run("tileterrain", parameters)
    assert (made["N_TILES"], made["N_FAILED"]) == (4, 0)
    from wavelet_gis.tiles.cloud.restore import restore_source
    from wavelet_gis.tiles.index import open_index

    restore_source(open_index(made["OUTPUT"]), 0, tmp_path / "same.las")
    assert (tmp_path / "same.las").read_bytes() == Path(path).read_bytes()
    found = region(made, MAX_ERROR=0.5, EXTENT="700100,700400,6600100,6600400 [EPSG:2154]")
    assert found["MAX_ERROR_SURFACE"] <= 0.5
    assert found["N_UNCOVERED"] == 0


def test_progress_goes_by_tiles(run, dem, tmp_path):
    log = Log()
    texts = []
    log.setProgressText = texts.append
    made = run("tileterrain", {"RASTERS": [dem], "TILE": 20, "OUTPUT": str(tmp_path / "set")}, log)
    assert made["N_MADE"] == 24 + 6 + 2 + 1
    assert log.fractions == sorted(log.fractions)
    assert log.fractions[-1] == 100
    assert [text for text in texts if text.startswith("Tile ")] == [
        *(f"Tile {n + 1} of 33: stage 0, row {n // 6}, column {n % 6}" for n in range(24)),
        *(f"Tile {n + 25} of 33: stage 1, row {n // 3}, column {n % 3}" for n in range(6)),
        *(f"Tile {n + 31} of 33: stage 2, row 0, column {n}" for n in range(2)),
        "Tile 33 of 33: stage 3, row 0, column 0",
    ]


def test_a_cancelled_run_goes_on(run, dem, tmp_path):
    parameters = {"RASTERS": [dem], "TILE": 20, "OUTPUT": str(tmp_path / "set")}
    log = Log()
    show = log.setProgressText

    def show_and_cancel(text):
        show(text)
        if "Tile 5 of" in text:
            log.cancel()

    log.setProgressText = show_and_cancel
    assert not run("tileterrain", parameters, feedback=log).get("INDEX")
    time.sleep(2)  # the tile in hand is left where it next says how far it is
    records = len(list((tmp_path / "set" / "pieces").rglob("*.json")))
    assert 4 <= records < 33
    second = run("tileterrain", parameters)
    assert second["N_FOUND"] == records
    assert second["N_FOUND"] + second["N_MADE"] == 33


def test_a_cancel_is_answered_at_once(qgis, dem, tmp_path, monkeypatch):
    """A tile may take minutes: nobody waits for it."""
    from qgis.core import QgsProcessingContext

    from wavelet_gis.tiles import piece

    def slow(folder, one, inputs, read, progress):
        for k in range(100):
            time.sleep(0.1)
            if not progress(k / 100):
                break
        raise AssertionError("nobody asks for it any more")

    monkeypatch.setattr(piece, "make_piece", slow)
    algorithm = qgis.processingRegistry().algorithmById("terrainwavelets:tileterrain").create()
    log = Log(cancel_at=3)
    began = time.monotonic()
    parameters = {"RASTERS": [dem], "TILE": 30, "OUTPUT": str(tmp_path / "set")}
    results, _ = algorithm.run(parameters, QgsProcessingContext(), log)
    assert results == {}
    assert time.monotonic() - began < 8


def test_a_tile_that_cannot_be_made_is_told(run, dem, tmp_path, monkeypatch):
    from wavelet_gis.errors import InputFileError
    from wavelet_gis.tiles import piece

    make = piece._tile

    def failing(plan, one, read, progress):
        if (one.row, one.column) == (0, 1):
            raise InputFileError("the disk is not there.")
        return make(plan, one, read, progress)

    monkeypatch.setattr(piece, "_tile", failing)
    log = Log()
    made = run(
        "tileterrain",
        {"RASTERS": [dem], "TILE": 45, "OUTPUT": str(tmp_path / "set")},
        feedback=log,
    )
    assert made["N_FAILED"] == 1
    assert any("row 0, column 1: the disk is not there." in line for line in log.lines)
    assert any("set aside" in line for line in log.warnings)


def test_tiles_of_a_damaged_file_are_set_aside(run, dem, tmp_path):
    damaged = tmp_path / "cut.tif"
    damaged.write_bytes(Path(dem).read_bytes()[:-15_000])  # of 43,200: the last third of the rows
    log = Log()
    parameters = {"RASTERS": [str(damaged)], "TILE": 45, "OUTPUT": str(tmp_path / "set")}
    made = run("tileterrain", parameters, feedback=log)
    assert made["N_FAILED"] == 3
    assert made["N_MADE"] == 9
    assert any("the file is damaged" in line for line in log.lines)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({}, "DEMs or point clouds"),
        ({"RASTERS": ["{dem}"], "CLOUDS": ["{dem}"]}, "DEMs or point clouds"),
        ({"CLOUDS": ["/nowhere.laz"]}, "no such file"),
        ({"CLOUDS": ["{dem}"], "CLASSES": "ground"}, "Classes are numbers"),
    ],
)
def test_inputs_that_cannot_be_meant_are_refused(provider, dem, tmp_path, parameters, told):
    from qgis.core import QgsProcessingContext

    filled = {
        key: [one.format(dem=dem) for one in value] if isinstance(value, list) else value
        for key, value in parameters.items()
    }
    algorithm = provider.algorithm("tileterrain").create()
    is_fine, why = algorithm.checkParameterValues(
        {**filled, "OUTPUT": str(tmp_path / "set")}, QgsProcessingContext()
    )
    assert not is_fine
    assert told in why


def test_layers_that_are_no_files_or_hide_values_are_refused(refused, dem, tmp_path):
    from qgis.core import QgsProject, QgsRasterLayer, QgsRasterRange

    layer = QgsRasterLayer(dem, "hidden")
    layer.dataProvider().setUserNoDataValue(1, [QgsRasterRange(0.0, 280.0)])
    QgsProject.instance().addMapLayer(layer)
    try:
        parameters = {"RASTERS": [layer], "OUTPUT": str(tmp_path / "set")}
        assert "export the layer" in refused("tileterrain", parameters)
    finally:
        QgsProject.instance().removeMapLayer(layer.id())
    assert not (tmp_path / "set").exists()


def test_a_folder_of_something_else_is_not_replaced(refused, dem, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    assert "no folder with a plan.json" in refused(
        "tileterrain", {"RASTERS": [dem], "OUTPUT": str(tmp_path)}
    )
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_levels_of_the_whole_are_those_of_a_script(tiles):
    from wavelet_gis.tiles.read import extract_region

    for level in (0, 2, tiles["N_LEVELS"]):
        found = region(tiles, LEVEL=level)
        mesh = extract_region(tiles["OUTPUT"], level=level).surface.mesh
        assert (found["N_VERTICES"], found["N_FACES"]) == (mesh.n_vertices, mesh.n_faces)
        assert found["TIN"].featureCount() == mesh.n_faces
        assert found["FOUND_LEVEL"] == level


def test_an_extent_in_another_crs_is_the_same_region(tiles):
    from qgis.core import (
        QgsCoordinateReferenceSystem,
        QgsCoordinateTransform,
        QgsProject,
        QgsRectangle,
    )

    box = QgsRectangle(700100, 6599500, 700100 + NEAR, 6599500 + NEAR)
    own = region(tiles, LEVEL=tiles["N_LEVELS"], EXTENT=box)
    assert own["TIN"].extent().contains(box)
    assert own["N_TILES"] < 12
    assert own["N_VERTICES"] < 0.2 * 90 * 120
    to_degrees = QgsCoordinateTransform(
        QgsCoordinateReferenceSystem("EPSG:2154"),
        QgsCoordinateReferenceSystem("EPSG:4326"),
        QgsProject.instance(),
    )
    degrees = to_degrees.transformBoundingBox(box)
    text = (
        f"{degrees.xMinimum()},{degrees.xMaximum()},{degrees.yMinimum()},{degrees.yMaximum()} "
        "[EPSG:4326]"
    )
    other = region(tiles, LEVEL=tiles["N_LEVELS"], EXTENT=text)
    assert own["N_VERTICES"] <= other["N_VERTICES"] < 1.2 * own["N_VERTICES"]


def test_a_largest_error_is_kept_and_told(tiles, tmp_path):
    raster = str(tmp_path / "region.tif")
    found = region(tiles, MAX_ERROR=3.0, RASTER=raster)
    assert 0 < found["MAX_ERROR_SURFACE"] <= 3.0
    assert found["N_UNCOVERED"] == 0
    assert found["N_VERTICES"] < 0.5 * 90 * 120
    assert Path(raster).is_file()


def test_polygons_need_shapely_and_it_is_said(refused, run, tiles, tmp_path):
    import importlib.util

    from qgis.core import QgsFeature, QgsGeometry, QgsRectangle, QgsVectorLayer

    layer = QgsVectorLayer("Polygon?crs=EPSG:2154", "area", "memory")
    feature = QgsFeature()
    box = QgsRectangle(700100, 6599500, 700100 + NEAR, 6599500 + NEAR)
    feature.setGeometry(QgsGeometry.fromRect(box))
    layer.dataProvider().addFeatures([feature])
    parameters = {"INPUT": tiles["INDEX"], "POLYGONS": layer, "LEVEL": 1, "TIN": "memory:"}
    if importlib.util.find_spec("shapely") is None:
        assert "shapely" in refused("extractfromtiles", parameters)
        return
    found = run("extractfromtiles", parameters)
    assert found["N_FACES"] == region(tiles, LEVEL=1, EXTENT=box)["N_FACES"]


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"INPUT": "{gpkg}"}, "no index of tiles"),
        ({"LEVEL": 2, "MAX_ERROR": 1.0}, "not both"),
        ({"LEVEL": 900}, "there is no level 900"),
        ({"EXTENT": "0,1,0,1 [EPSG:2154]"}, "no tile reaches into the region"),
        ({"TIN": None}, "No output is chosen"),
    ],
)
def test_regions_that_cannot_be_meant_are_refused(refused, tiles, parameters, told):
    piece = Path(tiles["OUTPUT"]) / "pieces" / "0" / "00000_00000.gpkg"
    filled = {k: v.format(gpkg=piece) if isinstance(v, str) else v for k, v in parameters.items()}
    given = {"INPUT": tiles["INDEX"], "TIN": "memory:", **filled}
    assert told in refused("extractfromtiles", given)


def test_the_plan_says_how_the_file_is_read(tiles, dem):
    plan = json.loads((Path(tiles["OUTPUT"]) / "plan.json").read_text("utf-8"))
    assert plan["files"][0][0] == dem
    assert plan["reading"] == {"band": 1, "nodata": None, "offline": False}


def test_a_band_that_is_not_there_is_refused_by_its_number(qgis, dem, tmp_path):
    """It said that the raster cannot be read, and nothing of why."""
    import processing
    from qgis.core import QgsProcessingException

    parameters = {"RASTERS": [dem], "BAND": 2, "TILE": 30, "OUTPUT": str(tmp_path / "set")}
    with pytest.raises(QgsProcessingException, match="there is no band 2; the raster has 1"):
        processing.run("terrainwavelets:tileterrain", parameters)
    assert not (tmp_path / "set").exists()
