"""Every model that comes with the plugin, loaded by the provider and run in a real QGIS."""

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from qgis_layers import Log, hills, read_raster, wkt_layer, write_las, write_raster

FOLDER = Path(__file__).resolve().parent.parent.parent / "processing_models"

#: Public ids, which never change, and what people read.
MODELS = {
    "dem_to_coarse_tin": "DEM to coarse TIN and details",
    "dem_to_hydraulic_mesh": "DEM and breaklines to hydraulic mesh",
    "point_cloud_to_dem": "Point cloud to filtered DEM",
    "dem_to_denoised_dem": "DEM to denoised DEM and report",
    "point_cloud_to_contours": "Point cloud to ground TIN and contours",
    "dem_to_simplified_cog": "DEM to simplified COG",
    "dems_to_change_by_scale": "Two DEMs to change by scale",
    "dem_to_landform_clusters": "DEM to landform clusters",
}


@pytest.fixture
def dem(tmp_path):
    return write_raster(tmp_path / "dem.tif", hills().astype("float32"), -9999.0)


@pytest.fixture
def run_model(provider):
    """Return a function that runs a model and loads its results: name -> (results, project)."""
    import processing
    from qgis.core import QgsProcessingContext, QgsProject

    project = QgsProject.instance()

    def run(name, parameters):
        context = QgsProcessingContext()
        context.setProject(project)
        log = Log()
        results = processing.runAndLoadResults(
            f"terrainwavelets:{name}", parameters, feedback=log, context=context
        )
        assert log.errors == []
        return results, {layer.name(): layer for layer in project.mapLayers().values()}

    yield run
    project.clear()


def test_every_file_is_listed_here():
    assert {path.stem for path in FOLDER.glob("*.model3")} == set(MODELS)


def texts_of(path):
    """Return what a model's file says, by the name of the entry."""
    said = {}
    for entry in ElementTree.parse(path).iter("Option"):
        if entry.get("type") == "QString":
            said.setdefault(entry.get("name"), []).append(entry.get("value"))
    return said


def test_the_files_are_those_of_their_description(tmp_path):
    """Help and formats of the algorithms had changed, those in the models had not."""
    script = FOLDER.parent / "scripts" / "qgis" / "models.py"
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    subprocess.run([sys.executable, script, tmp_path], check=True, env=environment)
    assert len(list(tmp_path.iterdir())) == len(MODELS)
    for path in FOLDER.glob("*.model3"):
        is_, due = texts_of(path), texts_of(tmp_path / path.name)
        for name in is_.keys() & due.keys():  # other versions of QGIS write more
            assert sorted(is_[name]) == sorted(due[name]), (path.name, name)


@pytest.mark.parametrize("name", MODELS)
def test_the_provider_lists_the_model_with_help_and_outputs(provider, name):
    model = provider.algorithm(name)
    assert model is not None, [a.name() for a in provider.algorithms()]
    assert model.displayName() == model.create().displayName() == MODELS[name]
    assert model.id() == model.create().id() == f"terrainwavelets:{name}"
    assert model.group()
    assert len(model.shortHelpString()) > 100
    outputs = [o for o in model.outputDefinitions() if o.description()]
    assert outputs
    assert all(output.description()[0].isupper() for output in outputs)
    for child in model.childAlgorithms().values():
        assert child.algorithm() is not None, child.algorithmId()
        assert child.description()


def test_dem_to_coarse_tin_and_details(run_model, dem):
    results, layers = run_model(
        "dem_to_coarse_tin",
        {
            "INPUT": dem,
            "LEVELS": 4,
            "MIN_MAGNITUDE": 0.1,
            "pyramid": "TEMPORARY_OUTPUT",
            "coarse_tin": "TEMPORARY_OUTPUT",
            "details_by_level": "TEMPORARY_OUTPUT",
        },
    )
    assert Path(results["pyramid"]).stat().st_size > 0
    assert layers["Coarse TIN"].renderer().type() == "graduatedSymbol"
    details = layers["Details by level"]
    assert details.renderer().type() == "categorizedSymbol"
    assert min(f["magnitude"] for f in details.getFeatures()) >= 0.1
    assert details.crs().authid() == "EPSG:2154"


def test_dem_and_breaklines_to_hydraulic_mesh(run_model, dem, tmp_path):
    lines = wkt_layer("LineString", ["LineString (700100 6599900, 700700 6599500)"])
    results, layers = run_model(
        "dem_to_hydraulic_mesh",
        {
            "INPUT": dem,
            "BREAKLINES": lines,
            "TARGET_VERTICES": 500,
            "hydraulic_mesh": str(tmp_path / "mesh.2dm"),
            "triangles_of_the_mesh": "TEMPORARY_OUTPUT",
        },
    )
    text = Path(results["hydraulic_mesh"]).read_text()
    nodes = np.array([line.split()[2:] for line in text.splitlines() if line.startswith("ND")])
    assert len(nodes) == 500
    assert layers["Triangles of the mesh"].renderer().type() == "graduatedSymbol"
    ends = nodes.astype(float)[:, :2].tolist()
    assert [700100.0, 6599900.0] in ends
    assert [700700.0, 6599500.0] in ends
    mesh = layers["mesh"]
    assert mesh.dataProvider().vertexCount() == 500
    assert mesh.crs().authid() == "EPSG:2154"


def test_dem_to_denoised_dem_and_report(run_model, tmp_path):
    rough = hills(60, 60).astype("float32")
    dem = write_raster(tmp_path / "dem.tif", rough, -9999.0)
    results, layers = run_model(
        "dem_to_denoised_dem",
        {
            "INPUT": dem,
            "SIGMA_OF_NOISE": 0.5,
            "denoised_dem": str(tmp_path / "denoised.tif"),
            "difference": str(tmp_path / "difference.tif"),
            "quality_report": str(tmp_path / "report.html"),
        },
    )
    denoised = np.frombuffer(read_raster(results["denoised_dem"])["bytes"], "f4").reshape(60, 60)
    difference = np.frombuffer(read_raster(results["difference"])["bytes"], "f4").reshape(60, 60)
    assert np.allclose(denoised - rough, difference, atol=1e-4)
    noise = np.random.default_rng(7).normal(size=(60, 60)) * 0.5
    clean = rough - noise
    assert np.std(denoised - clean) < 0.5 * np.std(noise)
    assert layers["Denoised DEM"].renderer().type() == "hillshade"
    assert "</html>" in Path(results["quality_report"]).read_text(encoding="utf-8")


def test_point_cloud_to_filtered_dem(run_model, tmp_path):
    pytest.importorskip("laspy")
    generator = np.random.default_rng(5)
    plan = np.stack(np.meshgrid(np.arange(40.0), np.arange(40.0)), -1).reshape(-1, 2) * 25.0
    plan += generator.uniform(-8, 8, plan.shape)

    def terrain(x, y):
        return 100 + 15 * np.sin(x / 120) + 8 * np.cos(y / 150)

    is_tree = np.arange(len(plan)) % 10 == 0
    noise = generator.normal(0, 0.3, len(plan))
    z = terrain(*plan.T) + noise + np.where(is_tree, 20.0, 0.0)
    xyz = np.column_stack([700000.0 + plan[:, 0], 6600000.0 + plan[:, 1], z])
    points = write_las(tmp_path / "points.las", xyz, classification=np.where(is_tree, 5, 2))
    results, _ = run_model(
        "point_cloud_to_dem",
        {
            "INPUT": points,
            "CLASSES": "2",
            "SIGMA_OF_NOISE": 0.3,
            "CELL_SIZE": 20.0,
            "filtered_pyramid": str(tmp_path / "pyramid.gpkg"),
            "filtered_dem": str(tmp_path / "dem.tif"),
        },
    )
    raster = read_raster(results["filtered_dem"])
    values = np.frombuffer(raster["bytes"], "f4").reshape(raster["shape"])
    left, width, _, top, _, height = raster["transform"]
    x = left + width * (np.arange(values.shape[1]) + 0.5) - 700000.0
    y = top + height * (np.arange(values.shape[0]) + 0.5) - 6600000.0
    error = values - terrain(*np.meshgrid(x, y))
    # Without trees, and nearer to the terrain than the points were.
    assert np.isfinite(error).sum() > 2000
    assert np.sqrt(np.nanmean(error**2)) < 0.25


def test_point_cloud_to_contours(run_model, tmp_path):
    pytest.importorskip("laspy")
    plan = np.random.default_rng(3).random((4000, 2)) * 400
    is_tree = np.arange(4000) % 5 == 0
    z = 100 + plan[:, 0] / 20 + np.where(is_tree, 30.0, 0.0)  # a plane: straight contours
    xyz = np.column_stack([700000 + plan[:, 0], 6600000 + plan[:, 1], z])
    points = write_las(tmp_path / "points.las", xyz, classification=np.where(is_tree, 5, 2))
    _, layers = run_model(
        "point_cloud_to_contours",
        {
            "INPUT": points,
            "INTERVAL": 5.0,
            "ground_tin": "TEMPORARY_OUTPUT",
            "ground_dem": "TEMPORARY_OUTPUT",
            "contours": str(tmp_path / "contours.gpkg"),
        },
    )
    assert layers["Ground TIN"].featureCount() < 50  # a plane needs few triangles
    (contours,) = [layer for name, layer in layers.items() if name.lower() == "contours"]
    assert {f["elevation"] for f in contours.getFeatures()} == {105.0, 110.0, 115.0}
    for feature in contours.getFeatures():
        x = np.array([vertex.x() for vertex in feature.geometry().vertices()])
        assert np.abs(x - 700000 - 20 * (feature["elevation"] - 100)).max() < 4


def test_a_step_that_cannot_be_meant_is_refused_without_a_traceback(provider, tmp_path):
    """QGIS asks a model's steps nothing before they run."""
    pytest.importorskip("laspy")
    from qgis.core import QgsProcessingContext, QgsProcessingException

    model, log = provider.algorithm("point_cloud_to_contours").create(), Log()
    parameters = {
        "INPUT": write_las(tmp_path / "points.las", np.random.default_rng(3).random((50, 3))),
        "CLASSES": "no such thing",
        "contours": str(tmp_path / "contours.gpkg"),
    }
    with pytest.raises(QgsProcessingException) as refused:
        model.run(parameters, QgsProcessingContext(), log, {}, False)
    said = [*log.errors, *log.warnings, str(refused.value)]
    assert all("Traceback" not in line for line in said), said
    assert "separated by commas, such as 2,9" in said[-1]


def test_dem_to_simplified_cog(run_model, dem, tmp_path):
    from osgeo import gdal

    results, _ = run_model(
        "dem_to_simplified_cog",
        {"INPUT": dem, "MAX_ERROR": 2.0, "simplified_dem": str(tmp_path / "cog.tif")},
    )
    dataset = gdal.Open(results["simplified_dem"])
    assert dataset.GetMetadata("IMAGE_STRUCTURE")["LAYOUT"] == "COG"
    values = np.frombuffer(dataset.ReadRaster(), "f4").reshape(60, 80)
    largest = np.abs(values - hills()).max()
    stated = dataset.GetMetadata()
    assert 0.5 < largest <= 2.0 + 1e-3
    assert float(stated["MAX_ERROR"]) == pytest.approx(largest, abs=1e-3)
    assert 0 < float(stated["RMSE"]) < largest


def test_dems_to_change_by_scale(run_model, tmp_path):
    before = hills(80, 80).astype("float32")
    rows, columns = np.mgrid[:80, :80]
    slide = 6.0 * np.exp(-((rows - 40) ** 2 + (columns - 40) ** 2) / 200)
    noise = np.random.default_rng(4).normal(0, 0.5, (80, 80))
    after = (before + slide + noise).astype("float32")
    results, layers = run_model(
        "dems_to_change_by_scale",
        {
            "BEFORE": write_raster(tmp_path / "a.tif", before),
            "AFTER": write_raster(tmp_path / "b.tif", after),
            "SMALLEST_SIZE": 45.0,  # of cells of 10 m
            "change": str(tmp_path / "change.tif"),
            "change_by_level": str(tmp_path / "levels.tif"),
        },
    )
    change = np.frombuffer(read_raster(results["change"])["bytes"], "f4").reshape(80, 80)
    assert np.std(change - slide) < 0.5 * np.std(noise)
    assert abs(change[40, 40] - 6.0) < 1.0
    assert layers["Change by level"].bandCount() == 12


def test_dems_of_other_cells_to_change_by_scale(run_model, tmp_path):
    """GDAL's calculator, which the model began with, ended in a traceback of numpy's."""
    rows, columns = np.mgrid[:40, :50]
    before = (rows + 2.0 * columns).astype("float32")  # a plane: read off exactly between cells
    rows, columns = np.mgrid[:90, :110]
    after = (0.5 * rows - 0.25 + 2.0 * (0.5 * columns - 0.25) + 3.0).astype("float32")
    results, _ = run_model(
        "dems_to_change_by_scale",
        {
            "BEFORE": write_raster(tmp_path / "a.tif", before),
            "AFTER": write_raster(tmp_path / "b.tif", after, cell=5.0),
            "change": str(tmp_path / "change.tif"),
        },
    )
    change = np.frombuffer(read_raster(results["change"])["bytes"], "f4").reshape(before.shape)
    assert np.allclose(change, 3.0, atol=1e-3)


@pytest.mark.parametrize(
    ("moved", "says"),
    [
        ({"epsg": 25832}, "CRS"),
        ({"origin": (900000.0, 6600000.0)}, "overlap"),
    ],
)
def test_dems_that_have_nothing_in_common_are_refused_in_one_line(provider, tmp_path, moved, says):
    from qgis.core import QgsProcessingContext, QgsProcessingException

    flat = np.full((30, 30), 5.0, dtype="float32")
    model, log = provider.algorithm("dems_to_change_by_scale").create(), Log()
    parameters = {
        "BEFORE": write_raster(tmp_path / "earlier.tif", flat),
        "AFTER": write_raster(tmp_path / "later.tif", flat, **moved),
        "change": str(tmp_path / "change.tif"),
    }
    with pytest.raises(QgsProcessingException) as refused:
        model.run(parameters, QgsProcessingContext(), log, {}, False)
    said = [*log.errors, *log.warnings, str(refused.value)]
    assert all("Traceback" not in line for line in said), said
    assert says in said[-1]
    assert "\n" not in said[-1].strip()


def test_dem_to_landform_clusters(run_model, tmp_path):
    rough = np.random.default_rng(1).normal(size=(80, 100)) * 3.0
    rough[:, :50] = 0
    x = np.arange(100.0)
    dem = write_raster(tmp_path / "dem.tif", (x + rough).astype("float32"))
    results, layers = run_model(
        "dem_to_landform_clusters",
        {"INPUT": dem, "COUNT": 2, "landforms": str(tmp_path / "landforms.tif")},
    )
    labels = read_raster(results["landforms"])
    values = np.frombuffer(labels["bytes"], "u1").reshape(labels["shape"])
    assert np.mean(values[:, 55:]) - np.mean(values[:, :45]) == pytest.approx(1, abs=0.1)
    assert layers["Landforms"].renderer().type() == "paletted"


class TestParametersLeftOut:
    """What a caller leaves out has the value that the dialog shows, not none at all."""

    def test_levels_and_magnitude(self, run_model, provider, dem):
        shown = provider.algorithm("dem_to_coarse_tin").parameterDefinition("LEVELS")
        _, layers = run_model(
            "dem_to_coarse_tin",
            {
                "INPUT": dem,
                "pyramid": "TEMPORARY_OUTPUT",
                "details_by_level": "TEMPORARY_OUTPUT",
            },
        )
        levels = layers["Details by level"].uniqueValues(1)
        assert levels == set(range(shown.defaultValue()))

    def test_size_of_the_mesh(self, run_model, tmp_path):
        dem = write_raster(tmp_path / "large.tif", hills(160, 160).astype("float32"))
        results, _ = run_model(
            "dem_to_hydraulic_mesh",
            {"INPUT": dem, "hydraulic_mesh": str(tmp_path / "mesh.2dm")},
        )
        text = Path(results["hydraulic_mesh"]).read_text()
        assert sum(line.startswith("ND") for line in text.splitlines()) == 20000

    def test_classes(self, run_model, tmp_path):
        pytest.importorskip("laspy")
        plan = np.random.default_rng(2).random((400, 2)) * 200 + [700000, 6600000]
        is_tree = np.arange(400) % 4 == 0
        z = np.where(is_tree, 150.0, 100.0)
        points = write_las(
            tmp_path / "points.las",
            np.column_stack([plan, z]),
            classification=np.where(is_tree, 5, 2),
        )
        results, _ = run_model(
            "point_cloud_to_dem",
            {
                "INPUT": points,
                "filtered_pyramid": str(tmp_path / "p.gpkg"),
                "filtered_dem": str(tmp_path / "dem.tif"),
            },
        )
        raster = read_raster(results["filtered_dem"])
        assert np.nanmax(np.frombuffer(raster["bytes"], "f4")) < 101
