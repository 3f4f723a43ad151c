"""Write the models of processing_models/ anew, with the QGIS of this Python.

Run it when a model changes: QT_QPA_PLATFORM=offscreen .venv-qgis/bin/python scripts/qgis-models.py
The models are small enough to be told here, step by step, which also reads better than their XML.
"""

import sys
import tempfile
from pathlib import Path

from qgis.core import (
    QgsApplication,
    QgsProcessing,
    QgsProcessingModelAlgorithm,
    QgsProcessingModelChildAlgorithm,
    QgsProcessingModelChildParameterSource,
    QgsProcessingModelOutput,
    QgsProcessingModelParameter,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFile,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
)
from qgis.PyQt.QtCore import QPointF

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "processing_models"
GROUP = "Models"

INTEGER = QgsProcessingParameterNumber.Type.Integer
DOUBLE = QgsProcessingParameterNumber.Type.Double


class Model:
    """A model under construction; inputs on the left, steps from left to right."""

    def __init__(self, name, description):
        self.model = QgsProcessingModelAlgorithm(name, GROUP, "models")
        self.help = {"ALG_DESC": description, "ALG_CREATOR": "Terrain Wavelets"}
        self.order = []
        self.n_inputs = 0
        self.n_steps = 0

    def input(self, parameter, help_text):
        """Add an input of the model."""
        component = QgsProcessingModelParameter(parameter.name())
        component.setPosition(QPointF(120, 80 + 90 * self.n_inputs))
        self.model.addModelParameter(parameter, component)
        self.help[parameter.name()] = help_text
        self.order.append(parameter.name())
        self.n_inputs += 1

    def step(self, child_id, algorithm, description, outputs=None, **parameters):
        """Add a step.

        A parameter is a value, ``input_("NAME")`` or ``result("child", "OUTPUT")``; ``outputs``
        maps the step's output names to ``(name for a person, help)``; a name with a ``!`` behind
        it is an output that cannot be skipped.
        """
        child = QgsProcessingModelChildAlgorithm(algorithm)
        assert child.algorithm(), f"{algorithm} is not in this QGIS"
        child.setChildId(child_id)
        child.setDescription(description)
        child.setPosition(QPointF(380 + 260 * self.n_steps, 120 + 40 * (self.n_steps % 2)))
        for name, value in parameters.items():
            assert child.algorithm().parameterDefinition(name), f"{algorithm} has no {name}"
            source = (
                value
                if isinstance(value, QgsProcessingModelChildParameterSource)
                else QgsProcessingModelChildParameterSource.fromStaticValue(value)
            )
            child.addParameterSources(name, [source])
        model_outputs = {}
        for k, (name, (marked, help_text)) in enumerate((outputs or {}).items()):
            label = marked.rstrip("!")
            output = QgsProcessingModelOutput(label, label)
            output.setMandatory(marked.endswith("!"))
            output.setChildId(child_id)
            output.setChildOutputName(name)
            output.setPosition(child.position() + QPointF(60, 140 + 60 * k))
            model_outputs[label] = output
            self.help[f"{child_id}:{label}"] = help_text
        child.setModelOutputs(model_outputs)
        self.model.addChildAlgorithm(child)
        self.n_steps += 1

    def write(self, file_name):
        """Write the model."""
        self.model.setHelpContent(self.help)
        self.model.setParameterOrder(self.order)
        self.model.updateDestinationParameters()
        path = FOLDER / file_name
        assert self.model.toFile(str(path)), path
        print(path.relative_to(ROOT))


def input_(name):
    """Take a parameter's value from an input of the model."""
    return QgsProcessingModelChildParameterSource.fromModelParameter(name)


def given_or(name, default):
    """Take a parameter's value from an input of the model, or its default where it is left out.

    QGIS hands on None for what a caller leaves out, whatever default the model shows.
    """
    literal = repr(default) if not isinstance(default, str) else f"'{default}'"
    return QgsProcessingModelChildParameterSource.fromExpression(f"coalesce(@{name}, {literal})")


def result(child_id, output):
    """Take a parameter's value from the output of an earlier step."""
    return QgsProcessingModelChildParameterSource.fromChildOutput(child_id, output)


def optional_number(name, description, kind, default=None, least=0):
    """Return a number that may be left empty."""
    return QgsProcessingParameterNumber(name, description, kind, default, True, least)


def dem_to_coarse_tin_and_details():
    """DEM to coarse TIN and details by level."""
    model = Model(
        "DEM to coarse TIN and details",
        "Analyses a DEM and shows both halves of its pyramid: the coarse TIN, and the details that "
        "were lifted off it, coloured by level. The pyramid itself can be kept for later.",
    )
    model.input(QgsProcessingParameterRasterLayer("INPUT", "DEM"), "Raster of elevations.")
    model.input(
        optional_number("LEVELS", "Most levels", INTEGER, 8, 1),
        "Each level removes up to a quarter of the vertices.",
    )
    model.input(
        optional_number("MIN_MAGNITUDE", "Smallest detail shown", DOUBLE, 0.0),
        "Details that are shorter, in the unit of elevation, are left out of the layer.",
    )
    model.step(
        "analyse",
        "terrainwavelets:analysedem",
        "Analyse the DEM",
        INPUT=input_("INPUT"),
        LEVELS=given_or("LEVELS", 8),
        outputs={
            "OUTPUT": ("Pyramid", "GeoPackage from which every level is rebuilt."),
            "COARSE_TIN": ("Coarse TIN", "Triangles of the coarsest level."),
        },
    )
    model.step(
        "details",
        "terrainwavelets:detaillayers",
        "Show the details",
        INPUT=result("analyse", "OUTPUT"),
        MIN_MAGNITUDE=given_or("MIN_MAGNITUDE", 0.0),
        outputs={"OUTPUT": ("Details by level", "Removed vertices, sized by magnitude.")},
    )
    model.write("dem_to_coarse_tin.model3")


def dem_and_breaklines_to_mesh():
    """DEM and breaklines to a mesh for hydraulic modelling."""
    model = Model(
        "DEM and breaklines to hydraulic mesh",
        "Turns the cells of a DEM and a layer of breaklines (banks, dykes, road edges) into a "
        "triangle mesh of the size that a hydraulic model can take. The breaklines stay edges of "
        "the mesh, however coarse it is.",
    )
    source_type = QgsProcessing.SourceType
    model.input(QgsProcessingParameterRasterLayer("INPUT", "DEM"), "Raster of elevations.")
    model.input(
        QgsProcessingParameterFeatureSource(
            "BREAKLINES", "Breaklines", [source_type.TypeVectorLine], optional=True
        ),
        "Lines that stay edges of the mesh; without Z they are laid on the DEM, all along.",
    )
    model.input(
        QgsProcessingParameterFeatureSource(
            "CLIP", "Area of the model", [source_type.TypeVectorPolygon], optional=True
        ),
        "Polygon that the mesh is clipped to.",
    )
    model.input(
        optional_number("TARGET_VERTICES", "Number of mesh vertices", INTEGER, 20000, 3),
        "The mesh has exactly this many, if the breaklines allow.",
    )
    model.input(
        optional_number("LINE_TOLERANCE", "Tolerance along lines without Z", DOUBLE),
        "How far such a line may be above or below the DEM, in the unit of elevation; empty for a "
        "thousandth of the relief.",
    )
    model.step(
        "points",
        "native:pixelstopoints",
        "Cells to points",
        INPUT_RASTER=input_("INPUT"),
        RASTER_BAND=1,
        FIELD_NAME="elevation",
    )
    model.step(
        "analyse",
        "terrainwavelets:analysetin",
        "Triangulate and analyse",
        INPUT=result("points", "OUTPUT"),
        Z_FIELD="elevation",
        BREAKLINES=input_("BREAKLINES"),
        CLIP=input_("CLIP"),
        TARGET_VERTICES=given_or("TARGET_VERTICES", 20000),
        LINE_TOLERANCE=input_("LINE_TOLERANCE"),
    )
    model.step(
        "mesh",
        "terrainwavelets:extractlevel",
        "Write the mesh",
        INPUT=result("analyse", "OUTPUT"),
        LEVEL=0,
        outputs={
            "MESH": ("Hydraulic mesh!", "2DM file, a mesh layer in QGIS."),
            "TIN": ("Triangles of the mesh", "The same as polygons."),
        },
    )
    model.write("dem_to_hydraulic_mesh.model3")


def point_cloud_to_filtered_dem():
    """Point cloud to filtered DEM."""
    model = Model(
        "Point cloud to filtered DEM",
        "Takes the ground points of a LAS or LAZ file, removes the noise of the scanner while "
        "banks and ridges stay, and gives a DEM of any cell size.",
    )
    model.input(
        QgsProcessingParameterFile(
            "INPUT", "Point cloud file", fileFilter="LAS and LAZ (*.las *.laz *.LAS *.LAZ)"
        ),
        "With classified ground, or see below.",
    )
    model.input(
        QgsProcessingParameterString("CLASSES", "Classes", "2", optional=True),
        "ASPRS classes of the points that make the ground; empty for all points.",
    )
    model.input(
        optional_number("SIGMA_OF_NOISE", "Standard deviation of the noise", DOUBLE),
        "In the unit of elevation; empty to have it estimated.",
    )
    model.input(
        optional_number("CELL_SIZE", "Cell size", DOUBLE),
        "Of the DEM, in the unit of the CRS; empty for the mean spacing of the points.",
    )
    model.step(
        "analyse",
        "terrainwavelets:analysepointcloud",
        "Analyse the points",
        INPUT=input_("INPUT"),
        CLASSES=given_or("CLASSES", "2"),
        LEVELS=8,
    )
    model.step(
        "filter",
        "terrainwavelets:filterlevels",
        "Remove the noise",
        INPUT=result("analyse", "OUTPUT"),
        DENOISE=True,
        SIGMA_OF_NOISE=input_("SIGMA_OF_NOISE"),
        outputs={"OUTPUT": ("Filtered pyramid!", "GeoPackage from which every level is rebuilt.")},
    )
    model.step(
        "raster",
        "terrainwavelets:extractlevel",
        "Make the DEM",
        INPUT=result("filter", "OUTPUT"),
        LEVEL=result("analyse", "N_LEVELS"),
        CELL_SIZE=input_("CELL_SIZE"),
        outputs={"RASTER": ("Filtered DEM!", "Elevations without the noise.")},
    )
    model.write("point_cloud_to_dem.model3")


def dem_to_denoised_dem_and_report():
    """DEM to denoised DEM, difference and report."""
    model = Model(
        "DEM to denoised DEM and report",
        "Removes the noise of a DEM while banks and ridges stay, and shows what was taken: the "
        "difference as a raster, and a report on the quality of every level.",
    )
    model.input(QgsProcessingParameterRasterLayer("INPUT", "DEM"), "Raster of elevations.")
    model.input(
        optional_number("SIGMA_OF_NOISE", "Standard deviation of the noise", DOUBLE),
        "In the unit of elevation; empty to have it estimated.",
    )
    model.step(
        "analyse",
        "terrainwavelets:analysedem",
        "Analyse the DEM",
        INPUT=input_("INPUT"),
        LEVELS=8,
    )
    model.step(
        "filter",
        "terrainwavelets:filterlevels",
        "Remove the noise",
        INPUT=result("analyse", "OUTPUT"),
        DENOISE=True,
        SIGMA_OF_NOISE=input_("SIGMA_OF_NOISE"),
        outputs={
            "DEM": ("Denoised DEM!", "Elevations without the noise."),
            "DIFFERENCE": ("Difference", "Denoised minus original elevation."),
        },
    )
    model.step(
        "report",
        "terrainwavelets:qualityreport",
        "Report",
        INPUT=result("filter", "OUTPUT"),
        outputs={"OUTPUT": ("Quality report", "HTML page on the denoised pyramid.")},
    )
    model.write("dem_to_denoised_dem.model3")


def main():
    """Write all models."""
    application = QgsApplication([], False)
    application.initQgis()
    sys.path.append(str(Path(QgsApplication.pkgDataPath()) / "python" / "plugins"))
    from processing.core.Processing import Processing

    Processing.initialize()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "terrain_wavelets").symlink_to(ROOT, target_is_directory=True)
        sys.path.insert(0, folder)
        from terrain_wavelets.plugin.packages import install_finder
        from terrain_wavelets.plugin.provider import TerrainWaveletsProvider

        install_finder()
        provider = TerrainWaveletsProvider()
        QgsApplication.processingRegistry().addProvider(provider)
        dem_to_coarse_tin_and_details()
        dem_and_breaklines_to_mesh()
        point_cloud_to_filtered_dem()
        dem_to_denoised_dem_and_report()


if __name__ == "__main__":
    main()
