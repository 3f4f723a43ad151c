"""Every dialog opens, and results look as they should; pictures of both are kept for the docs.

Set ``TERRAIN_WAVELETS_PICTURES`` to a folder to keep the pictures.
"""

import os
from pathlib import Path
from unittest.mock import Mock

import pytest
from qgis_layers import hills, write_raster

ALGORITHMS = (
    "analysedem",
    "analysepointcloud",
    "analysetin",
    "extractlevel",
    "simplifydem",
    "reconstruct",
    "detaillayers",
    "clusterdetails",
    "filterlevels",
    "qualityreport",
    "simplifypointcloud",
    "thinpointcloud",
    "classifyground",
    "webterrain",
    "tileterrain",
    "extractfromtiles",
    "contours",
    "profile",
    "shapeoflevel",
    "difference",
    "changebyscale",
    "meshquality",
    "dem_to_coarse_tin",
    "dem_to_hydraulic_mesh",
    "point_cloud_to_dem",
    "dem_to_denoised_dem",
    "point_cloud_to_contours",
    "dem_to_simplified_cog",
    "dems_to_change_by_scale",
    "dem_to_landform_clusters",
)
KEPT = os.environ.get("TERRAIN_WAVELETS_PICTURES")


@pytest.fixture
def keep():
    """Return a function that checks a picture, and saves it where the docs' pictures are made."""

    def check_and_save(image, name):
        assert not image.isNull()
        colours = {
            image.pixel(x, y)
            for x in range(0, image.width(), 7)
            for y in range(0, image.height(), 7)
        }
        assert len(colours) > 8, f"the picture {name} is blank"
        if KEPT:
            Path(KEPT).mkdir(parents=True, exist_ok=True)
            assert image.save(str(Path(KEPT) / f"{name}.png"))

    return check_and_save


def picture_of(widget, width, height):
    """Return what a widget shows; afterwards it is gone, and no end of a layer concerns it."""
    from qgis.PyQt.QtCore import QCoreApplication, QEvent
    from qgis.PyQt.QtWidgets import QApplication

    widget.resize(width, height)
    widget.show()
    for _ in range(5):
        QApplication.processEvents()
    image = widget.grab().toImage()
    widget.close()
    widget.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    return image


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_dialog_opens(provider, keep, algorithm):
    from processing.gui.AlgorithmDialog import AlgorithmDialog

    dialog = AlgorithmDialog(provider.algorithm(algorithm).create(), False, None)
    labels = {p.description() for p in dialog.algorithm().parameterDefinitions()}
    assert labels
    keep(picture_of(dialog, 900, 620), "dialog_" + algorithm.lower().replace(" ", "_"))


def test_toolbox_lists_the_provider(qgis, keep, monkeypatch):
    from processing.gui import ProcessingToolbox as module  # noqa: N813 - the module has the class's name
    from qgis.PyQt.QtCore import QSize, Qt

    window = Mock()
    window.iconSize.return_value = QSize(16, 16)
    monkeypatch.setattr(module, "iface", window)
    toolbox = module.ProcessingToolbox()
    tree = toolbox.algorithmTree
    tree.setFilterString("terrain wavelets")
    model = tree.model()
    names = [
        model.index(row, 0).data(Qt.ItemDataRole.DisplayRole) for row in range(model.rowCount())
    ]
    assert "Terrain Wavelets" in names
    tree.expandAll()
    keep(picture_of(toolbox, 420, 560), "toolbox")


@pytest.fixture(scope="module")
def pyramid_by(qgis, data_folder, tmp_path_factory):
    """Return a function to the path of a pyramid; of real terrain where the data are at hand."""
    import processing

    folder = tmp_path_factory.mktemp("pictures")
    path = data_folder / "dems" / "lidar_dem_400.tif"
    if not path.is_file():
        path = write_raster(folder / "d.tif", hills(200, 300).astype("float32"))

    def analysed(name, **options):
        output = str(folder / f"{name}.gpkg")
        parameters = {"INPUT": str(path), "LEVELS": 8, "OUTPUT": output, **options}
        return processing.run("terrainwavelets:analysedem", parameters)["OUTPUT"]

    return analysed


def map_of(layers, width=900, height=640):
    """Return the map of styled layers."""
    from qgis.core import QgsMapRendererParallelJob, QgsMapSettings
    from qgis.PyQt.QtCore import QSize
    from qgis.PyQt.QtGui import QColor

    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setDestinationCrs(layers[0].crs())
    extent = layers[-1].extent()
    extent.scale(0.5)
    settings.setExtent(extent)
    settings.setOutputSize(QSize(width, height))
    settings.setBackgroundColor(QColor("white"))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    return job.renderedImage()


def test_styled_results(qgis, pyramid_by, tmp_path, keep):
    import processing
    from qgis.core import QgsProcessingContext, QgsProject

    project = QgsProject.instance()
    context = QgsProcessingContext()
    context.setProject(project)
    surface = pyramid_by("surface")
    # Levels that mean the same scale everywhere.
    scales = pyramid_by("scales", PARTITION="random", PREDICTION="plane")
    for pyramid, algorithm, parameters in (
        (surface, "extractlevel", {"LEVEL": 0, "TIN": "TEMPORARY_OUTPUT"}),
        (surface, "detaillayers", {"LAST_LEVEL": 3, "OUTPUT": "TEMPORARY_OUTPUT"}),
        (surface, "reconstruct", {"DEM": str(tmp_path / "dem.tif")}),
        (surface, "extractlevel", {"LEVEL": 1, "VERTICES": "TEMPORARY_OUTPUT"}),
        (
            scales,
            "detaillayers",
            {"OUTPUT": str(tmp_path / "d.gpkg"), "ENERGY": "TEMPORARY_OUTPUT"},
        ),
        (
            scales,
            "filterlevels",
            {"LAST_LEVEL": 3, "DEM": "TEMPORARY_OUTPUT", "DIFFERENCE": "TEMPORARY_OUTPUT"},
        ),
        (
            scales,
            "clusterdetails",
            {"COUNT": 4, "RASTER": "TEMPORARY_OUTPUT", "OUTPUT": "TEMPORARY_OUTPUT"},
        ),
    ):
        processing.runAndLoadResults(
            f"terrainwavelets:{algorithm}", {"INPUT": pyramid, **parameters}, context=context
        )
    by_name = {layer.name(): layer for layer in project.mapLayers().values()}
    hillshade = by_name["Reconstructed DEM"]
    keep(map_of([by_name["TIN of the level"]]), "result_tin")
    keep(map_of([by_name["Details by level"], hillshade]), "result_details")
    keep(map_of([hillshade]), "result_hillshade")
    keep(map_of([by_name["Energy by level"]]), "result_energy")
    keep(map_of([by_name["Difference of the DEMs"]]), "result_difference")
    keep(map_of([by_name["Vertices of the level"], hillshade]), "result_vertices")
    by_name["Map of clusters"].setOpacity(0.6)
    keep(map_of([by_name["Map of clusters"], hillshade]), "result_clusters")
    keep(map_of([by_name["Clustered vertices"]]), "result_clustered_vertices")
    project.clear()
