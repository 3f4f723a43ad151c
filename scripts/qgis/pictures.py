"""Draw the pictures of docs/howto/qgis.md, with the QGIS of this Python and matplotlib's DEM.

    QT_QPA_PLATFORM=offscreen .venv-qgis/bin/python scripts/qgis/pictures.py DEM.tif [--full FOLDER]

DEM.tif is matplotlib's DEM of Jacksboro in a projected CRS (`examples/demo.py` writes it in
degrees; ``gdalwarp -ot Float32 -t_srs EPSG:26916 -tr 80 80 -r cubic``). Every dialog with all
parameters open, every result as it opens, every model in the modeler and what it makes, the page
of options. In --full each is kept in full size; docs/images/qgis gets contact sheets and a few by
themselves.
"""

import argparse
import math
import os
import sys
import tempfile
from pathlib import Path
from unittest.mock import Mock, patch

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

import numpy as np  # noqa: E402
import qgis_layers  # noqa: E402
from qgis_fixtures import started_qgis  # noqa: E402

application = started_qgis()

import processing  # noqa: E402
from processing.gui.AlgorithmDialog import AlgorithmDialog  # noqa: E402
from processing.modeler.ModelerScene import ModelerScene  # noqa: E402
from qgis.core import (  # noqa: E402
    QgsMapRendererParallelJob,
    QgsMapSettings,
    QgsMeshLayer,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProject,
)
from qgis.PyQt.QtCore import QRectF, QSize, Qt  # noqa: E402
from qgis.PyQt.QtGui import QColor, QFont, QImage, QPainter  # noqa: E402
from qgis.PyQt.QtSvg import QSvgRenderer  # noqa: E402
from qgis.PyQt.QtWidgets import QApplication, QScrollArea, QWidget  # noqa: E402

DOCS = ROOT / "docs" / "images" / "qgis"


class Pictures:
    """Pictures by name, kept in full and put on contact sheets."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.images = folder, {}
        folder.mkdir(parents=True, exist_ok=True)

    def keep(self, name: str, image: QImage) -> None:
        """Keep a picture, and write it in full."""
        assert not image.isNull(), name
        image = image.convertToFormat(QImage.Format.Format_RGB32)
        self.images[name] = image
        image.save(str(self.folder / f"{name}.png"))
        print(name, image.width(), image.height(), flush=True)

    def sheet(self, name: str, names: list[str], width: int, columns: int, height: int) -> None:
        """Put pictures beside each other, each scaled into a cell, its name above it."""
        rows, margin, head = math.ceil(len(names) / columns), 10, 22
        cell = (width - margin) // columns
        sheet = QImage(width, rows * (height + head + margin) + margin, QImage.Format.Format_RGB32)
        sheet.fill(QColor("white"))
        painter = QPainter(sheet)
        painter.setFont(QFont("DejaVu Sans", 9))
        for k, one in enumerate(names):
            x = margin + (k % columns) * cell
            y = margin + (k // columns) * (height + head + margin)
            small = self.images[one].scaled(
                cell - margin,
                height,
                Qt.AspectRatioMode.KeepAspectRatio,
                Qt.TransformationMode.SmoothTransformation,
            )
            painter.drawText(x, y + 15, one.split("_", 1)[1].replace("_", " "))
            painter.drawImage(x, y + head, small)
        painter.end()
        save(sheet, name)

    def alone(self, name: str, width: int = 0) -> None:
        """Put a picture into the docs by itself."""
        image = self.images[name]
        if width and image.width() > width:
            image = image.scaledToWidth(width, Qt.TransformationMode.SmoothTransformation)
        save(image, name)


def save(image: QImage, name: str) -> None:
    """Save with a palette of its own, which takes a third of the bytes."""
    from PIL import Image

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.png")
        image.save(path)
        with Image.open(path) as full:
            few = full.convert("RGB").quantize(160, dither=Image.Dither.NONE)
            few.save(DOCS / f"{name}.png", optimize=True)


def settle() -> None:
    """Let widgets take their places."""
    for _ in range(8):
        QApplication.processEvents()


def grabbed(widget, width: int, height: int) -> QImage:
    """Return what a widget shows."""
    widget.resize(width, height)
    widget.show()
    settle()
    image = widget.grab().toImage()
    widget.close()
    return image


def dialog(pictures: Pictures, algorithm) -> None:
    """Draw a dialog with all that it asks, the advanced parameters too."""
    made = AlgorithmDialog(algorithm.create(), False, None)
    made.resize(1000, 800)
    made.show()
    settle()
    # Processing's own widgets, whose Python class depends on the version
    boxes = [w for w in made.findChildren(QWidget) if w.inherits("QgsCollapsibleGroupBoxBasic")]
    for box in boxes:
        box.setProperty("collapsed", False)
    settle()
    area = made.mainWidget().findChild(QScrollArea)
    assert boxes or not any(
        p.flags() & p.Flag.FlagAdvanced for p in algorithm.parameterDefinitions()
    )
    inner = area.widget().sizeHint().height()
    pictures.keep(f"dialog_{algorithm.name()}", grabbed(made, 1000, inner + 200))


def on_map(layers, scale: float = 1.0, size=(720, 560)) -> QImage:
    """Return the map of layers, the first on top."""
    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setDestinationCrs(layers[-1].crs())
    extent = layers[-1].extent()
    extent.scale(scale)
    settings.setExtent(extent)
    settings.setOutputSize(QSize(*size))
    settings.setBackgroundColor(QColor("white"))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    return job.renderedImage()


def opened(algorithm: str, parameters: dict) -> dict:
    """Run an algorithm as a dialog does, and return the layers that open, by name."""
    project = QgsProject.instance()
    before = set(project.mapLayers())
    context = QgsProcessingContext()
    context.setProject(project)
    processing.runAndLoadResults(
        f"terrainwavelets:{algorithm}", parameters, QgsProcessingFeedback(False), context
    )
    new = [layer for key, layer in project.mapLayers().items() if key not in before]
    return {layer.name(): layer for layer in new}


def from_svg(path: str) -> QImage:
    """Return an SVG file as a picture."""
    renderer = QSvgRenderer(path)
    image = QImage(renderer.defaultSize(), QImage.Format.Format_RGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    renderer.render(painter)
    painter.end()
    return image


def model(pictures: Pictures, algorithm) -> None:
    """Draw a model as the modeler shows it."""
    made, context = algorithm.create(), QgsProcessingContext()
    scene = ModelerScene()
    scene.createItems(made, context)
    box = scene.itemsBoundingRect().adjusted(-20, -20, 20, 20)
    image = QImage(int(box.width()), int(box.height()), QImage.Format.Format_RGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    scene.render(painter, QRectF(image.rect()), box)
    painter.end()
    pictures.keep(f"model_{algorithm.name()}", image)


def results(pictures: Pictures, dem: str, folder: Path) -> None:
    """Draw every result as it opens, over the hillshade where that helps."""
    scales = {"PARTITION": "random", "PREDICTION": "plane"}
    paths = {}
    for name, options in (("surface", {}), ("scales", scales)):
        paths[name] = str(folder / f"{name}.gpkg")
        parameters = {"INPUT": dem, "LEVELS": 10, "OUTPUT": paths[name], **options}
        processing.run("terrainwavelets:analysedem", parameters)
    surface, by_scale = paths["surface"], paths["scales"]
    temporary = "TEMPORARY_OUTPUT"
    hillshade = opened("reconstruct", {"INPUT": surface, "DEM": temporary})["Reconstructed DEM"]

    def keep(name, layers, scale=0.5, over=True):
        below = [hillshade] if over else []
        pictures.keep(f"result_{name}", on_map([*layers, *below], scale))

    keep("hillshade", [], over=True)
    tin = opened("extractlevel", {"INPUT": surface, "LEVEL": 0, "TIN": temporary})
    keep("tin", [tin["TIN of the level"]], over=False)
    vertices = opened("extractlevel", {"INPUT": surface, "LEVEL": 1, "VERTICES": temporary})
    keep("vertices", [vertices["Vertices of the level"]])
    details = opened("detaillayers", {"INPUT": surface, "LAST_LEVEL": 3, "OUTPUT": temporary})
    keep("details", [details["Details by level"]])
    maps = dict.fromkeys(("OUTPUT", "ENERGY", "ROUGHNESS", "DEVIATION"), temporary)
    mapped = opened("detaillayers", {"INPUT": by_scale, **maps})
    for title in ("Energy by level", "Roughness by scale", "Deviation by scale"):
        keep(title.lower().replace(" ", "_"), [mapped[title]], over=False)
    lines = opened("contours", {"INPUT": surface, "INTERVAL": 40, "OUTPUT": temporary})
    keep("contours", [lines["Contours"]])
    smooth = opened("contours", {"INPUT": surface, "INTERVAL": 40, "LEVEL": 0, "OUTPUT": temporary})
    keep("contours_of_level_0", [smooth["Contours"]])
    shape = opened(
        "shapeoflevel",
        {
            "INPUT": surface,
            "LEVEL": 4,
            **dict.fromkeys(
                (
                    "SLOPE",
                    "ASPECT",
                    "PROFILE_CURVATURE",
                    "TANGENTIAL_CURVATURE",
                    "MEAN_CURVATURE",
                    "LANDFORMS",
                    "RESIDUAL",
                ),
                temporary,
            ),
        },
    )
    for title, layer in sorted(shape.items()):
        keep(title.lower().replace(" ", "_"), [layer], over=False)
    later = str(folder / "later.gpkg")
    after = with_a_mound(dem, folder / "after.tif")
    processing.run("terrainwavelets:analysedem", {"INPUT": after, "OUTPUT": later, **scales})
    change = opened("changebyscale", {"INPUT": later, "EARLIER": dem, "OUTPUT": temporary})
    keep("change_by_scale", [change["Change by scale"]], over=False)
    difference = opened("difference", {"INPUT": surface, "LEVEL": 0, "OUTPUT": temporary})
    keep("difference", [difference["Difference of the surfaces"]], over=False)
    filtered = opened(
        "filterlevels",
        {"INPUT": by_scale, "LAST_LEVEL": 4, "DEM": temporary, "DIFFERENCE": temporary},
    )
    keep("filtered", [filtered["Filtered DEM"]], over=False)
    keep("filter_difference", [filtered["Difference of the DEMs"]], over=False)
    clusters = opened(
        "clusterdetails", {"INPUT": by_scale, "COUNT": 4, "RASTER": temporary, "OUTPUT": temporary}
    )
    clusters["Map of clusters"].setOpacity(0.6)
    keep("clusters", [clusters["Map of clusters"]])
    keep("clustered_vertices", [clusters["Clustered vertices"]])
    mesh = opened("extractlevel", {"INPUT": surface, "LEVEL": 0, "MESH": str(folder / "m.2dm")})
    keep("mesh", list(mesh.values()), over=False)
    box = hillshade.extent()
    ends = [
        (box.xMinimum() + share * box.width(), box.yMinimum() + up * box.height())
        for share, up in ((0.1, 0.2), (0.9, 0.85))
    ]
    line = qgis_layers.wkt_layer(
        "LineString",
        [f"LineString ({', '.join(f'{x} {y}' for x, y in ends)})"],
        hillshade.crs().authid(),
    )
    made = processing.run(
        "terrainwavelets:profile",
        {"INPUT": surface, "LINES": line, "PICTURE": str(folder / "profile.svg")},
    )
    pictures.keep("result_profile", from_svg(made["PICTURE"]))


def with_a_mound(dem: str, path: Path) -> str:
    """Write a DEM with a mound of 15 m on it; return where it is."""
    x_min, cell, _, y_max, _, _ = qgis_layers.read_raster(dem)["transform"]
    later = qgis_layers.numbers(dem).astype(np.float32)
    rows, columns = np.mgrid[: later.shape[0], : later.shape[1]]
    mound = 15 * np.exp(-((rows - 150) ** 2 + (columns - 200) ** 2) / 600)
    later[later > 0] += mound[later > 0]
    return qgis_layers.write_raster(
        path, later, nodata=-32768.0, epsg=26916, origin=(x_min, y_max), cell=cell
    )


def models(pictures: Pictures, provider, dem: str, folder: Path) -> None:
    """Draw every model, and what it makes of the DEM, or of points on it."""
    x_min, cell, _, y_max, _, _ = qgis_layers.read_raster(dem)["transform"]
    heights = qgis_layers.numbers(dem)
    n_rows, n_columns = heights.shape
    draw = np.random.default_rng(0)
    rows, columns = draw.integers(1, n_rows - 1, 60_000), draw.integers(1, n_columns - 1, 60_000)
    places = np.column_stack(
        [
            x_min + cell * (columns + draw.random(60_000)),
            y_max - cell * (rows + draw.random(60_000)),
            heights[rows, columns],
        ]
    )
    cloud = qgis_layers.write_las(
        folder / "cloud.las",
        places[places[:, 2] > 0],
        26916,
        classification=np.full((places[:, 2] > 0).sum(), 2, "u1"),
    )
    after = with_a_mound(dem, folder / "after.tif")
    for algorithm in provider.algorithms():
        if algorithm.group() != "Models":
            continue
        model(pictures, algorithm)
        parameters = {}
        for definition in algorithm.parameterDefinitions():
            name = definition.name()
            if definition.isDestination():
                parameters[name] = "TEMPORARY_OUTPUT"
            elif definition.type() == "raster":
                parameters[name] = after if parameters else dem
            elif definition.type() == "file":
                parameters[name] = cloud
        layers = opened(algorithm.name(), parameters)
        shown = [layer for layer in layers.values() if layer.isSpatial()]
        # lines and points above areas, areas above rasters
        order = {"vector": 0, "mesh": 1, "raster": 2}
        shown.sort(key=lambda layer: (order[kind_of(layer)], dimension_of(layer)))
        pictures.keep(f"made_{algorithm.name()}", on_map(shown, 0.6))
        print("   ", [layer.name() for layer in shown], flush=True)
        QgsProject.instance().clear()


def kind_of(layer) -> str:
    """Return what a layer is, for the order on the map."""
    if isinstance(layer, QgsMeshLayer):
        return "mesh"
    return "raster" if hasattr(layer, "bandCount") else "vector"


def dimension_of(layer) -> int:
    """Return 0 for points, 1 for lines, 2 for areas."""
    return int(layer.geometryType()) if hasattr(layer, "geometryType") else 9


def toolbox(pictures: Pictures) -> None:
    """Draw the toolbox with our algorithms."""
    from processing.gui import ProcessingToolbox as module  # noqa: N813 - so it is called

    window = Mock()
    window.iconSize.return_value = QSize(16, 16)
    module.iface = window
    made = module.ProcessingToolbox()
    made.algorithmTree.setFilterString("terrain wavelets")
    made.algorithmTree.expandAll()
    pictures.keep("toolbox", grabbed(made, 420, 900))


def options_page(pictures: Pictures) -> None:
    """Draw the page of the Processing options, our part open, as where two packages are missing."""
    from qgis.PyQt.QtWidgets import QTreeWidget, QTreeWidgetItem
    from terrain_wavelets.plugin.ui import dependencies, options_page

    tree = QTreeWidget()
    tree.setColumnCount(2)
    tree.setHeaderLabels(["Setting", "Value"])
    top = QTreeWidgetItem(tree, ["Terrain Wavelets", ""])
    is_hidden = {dependencies.LAZRS, dependencies.CGAL}.intersection
    with patch.object(dependencies, "missing", lambda packages: list(is_hidden(packages))):
        for _, description, value in options_page.rows():
            QTreeWidgetItem(top, [description, value])
    tree.expandAll()
    for column in (0, 1):
        tree.resizeColumnToContents(column)
    width = sum(map(tree.columnWidth, (0, 1)))
    pictures.keep("options_page", grabbed(tree, width + 20, 280))


def main() -> None:
    """Draw what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dem")
    parser.add_argument("--full", type=Path, default=Path(tempfile.mkdtemp()))
    parser.add_argument("--only", default="dialogs,results,models,options")
    chosen = parser.parse_args()
    provider = application.processingRegistry().providerById("terrainwavelets")
    pictures, folder = Pictures(chosen.full), Path(tempfile.mkdtemp())
    parts = chosen.only.split(",")
    if "dialogs" in parts:
        pyramid = str(folder / "jacksboro.gpkg")
        processing.run("terrainwavelets:analysedem", {"INPUT": chosen.dem, "OUTPUT": pyramid})
        algorithms = [a for a in provider.algorithms() if a.group() != "Models"]
        for algorithm in algorithms:
            dialog(pictures, algorithm)
        names = [f"dialog_{a.name()}" for a in algorithms]
        pictures.sheet("sheet_dialogs", names, 1500, 5, 420)
        pictures.alone("dialog_extractlevel", 800)
        pictures.alone("dialog_tileterrain", 800)
    if "results" in parts:
        results(pictures, chosen.dem, folder)
        names = [name for name in pictures.images if name.startswith("result_")]
        names.remove("result_profile")
        pictures.sheet("sheet_results", names, 1400, 4, 265)
        for name in ("result_tin", "result_details", "result_contours", "result_profile"):
            pictures.alone(name)
        QgsProject.instance().clear()
    if "models" in parts:
        models(pictures, provider, chosen.dem, folder)
        names = [name for name in pictures.images if name.startswith("model_")]
        pictures.sheet("sheet_models", names, 1400, 2, 330)
        pictures.sheet("sheet_made", [f"made_{n[6:]}" for n in names], 1400, 4, 265)
    if "options" in parts:
        toolbox(pictures)
        pictures.alone("toolbox")
        options_page(pictures)
        pictures.alone("options_page")
    sys.stdout.flush()
    os._exit(0)  # QGIS crashes at exit while Python holds layers


if __name__ == "__main__":
    main()
