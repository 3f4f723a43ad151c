"""Write the models of processing_models/ anew, with the QGIS of this Python.

Run it when a model changes, or the help or formats of an algorithm that one uses:
QT_QPA_PLATFORM=offscreen .venv-qgis/bin/python scripts/qgis/models.py [FOLDER]
The models are small enough to be told here, step by step, which also reads better than their XML.
"""

import re
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

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(sys.argv[1]) if sys.argv[1:] else ROOT / "processing_models"
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
        # QGIS writes a tag's attributes in another order each time.
        text = re.sub(r'(?: \w+="[^"]*")+', _in_order, path.read_text("utf-8"))
        path.write_text(text, "utf-8")
        print(path)


def _in_order(attributes):
    return "".join(sorted(re.findall(r' \w+="[^"]*"', attributes[0])))


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


def lidar_to_contours():
    """Point cloud to ground TIN, DEM and contours."""
    model = Model(
        "Point cloud to ground TIN and contours",
        "Thins the ground points of a LAS or LAZ file to a TIN that is nowhere farther off than "
        "you say, and draws contours that are as smooth as that allows.",
    )
    model.input(
        QgsProcessingParameterFile(
            "INPUT", "Point cloud file", fileFilter="LAS and LAZ (*.las *.laz *.LAS *.LAZ)"
        ),
        "With classified ground, or see below.",
    )
    model.input(
        QgsProcessingParameterString("CLASSES", "Classes", None, optional=True),
        "ASPRS classes of the points that make the ground; empty for class 2, or for all points "
        "where none has it.",
    )
    model.input(
        optional_number("MAX_ERROR", "Largest error", DOUBLE, 0.25),
        "No ground point is farther above or below the TIN, in the unit of elevation.",
    )
    model.input(
        optional_number("INTERVAL", "Interval of the contours", DOUBLE, None, 0.001),
        "In the unit of elevation; empty for a round one that gives about twenty.",
    )
    model.input(
        optional_number("CELL_SIZE", "Cell size", DOUBLE),
        "Of the ground DEM, in the unit of the CRS; empty for the spacing of the points.",
    )
    model.step(
        "simplify",
        "terrainwavelets:simplifypointcloud",
        "Thin the ground to a TIN",
        INPUT=input_("INPUT"),
        CLASSES=given_or("CLASSES", ""),
        MAX_ERROR=given_or("MAX_ERROR", 0.25),
        CELL_SIZE=input_("CELL_SIZE"),
        outputs={
            "TIN": ("Ground TIN", "Triangles of the ground."),
            "RASTER": ("Ground DEM!", "The TIN as a raster."),
        },
    )
    model.step(
        "contours",
        "terrainwavelets:contours",
        "Draw contours",
        INPUT=result("simplify", "OUTPUT"),
        INTERVAL=input_("INTERVAL"),
        outputs={
            "OUTPUT": (
                "Contours!",
                "Of the coarsest level whose RMSE is at most a fifth of the interval.",
            )
        },
    )
    model.write("point_cloud_to_contours.model3")


def dem_to_simplified_cog():
    """DEM to a simplified raster for viewsheds and the web."""
    model = Model(
        "DEM to simplified COG",
        "Takes out of a DEM what is smaller than an error that you allow, and writes it as a "
        "cloud-optimised GeoTIFF, which is smaller and quicker, for viewsheds say. Its largest "
        "error and RMSE are in the metadata of the file.",
    )
    model.input(QgsProcessingParameterRasterLayer("INPUT", "DEM"), "Raster of elevations.")
    model.input(
        optional_number("MAX_ERROR", "Largest error", DOUBLE, 1.0),
        "No cell is farther off, in the unit of elevation.",
    )
    model.step(
        "simplify",
        "terrainwavelets:simplifydem",
        "Simplify the DEM",
        INPUT=input_("INPUT"),
        MAX_ERROR=given_or("MAX_ERROR", 1.0),
        outputs={"TIN": ("Simplified TIN", "Triangles between the vertices that are left.")},
    )
    model.step(
        "cog",
        "gdal:translate",
        "Write the COG",
        INPUT=result("simplify", "RASTER"),
        EXTRA=QgsProcessingModelChildParameterSource.fromExpression(
            "concat('-of COG -co COMPRESS=DEFLATE -co PREDICTOR=YES -mo MAX_ERROR=', "
            "to_string(@Simplify_the_DEM_MAX_ERROR_SURFACE), ' -mo RMSE=', "
            "to_string(@Simplify_the_DEM_RMSE_SURFACE))"
        ),
        outputs={"OUTPUT": ("Simplified DEM!", "Cloud-optimised GeoTIFF.")},
    )
    model.write("dem_to_simplified_cog.model3")


def dems_to_change_by_scale():
    """Two DEMs of different years to their difference, by scale."""
    model = Model(
        "Two DEMs to change by scale",
        "Subtracts a DEM from a later one and keeps the change that is larger on the ground than "
        "you say: slides and fills stay, noise and vegetation go. A map for each level shows at "
        "which scale the change is.",
    )
    model.input(
        QgsProcessingParameterRasterLayer("BEFORE", "Earlier DEM"),
        "Elevations. The change is on its cells.",
    )
    model.input(
        QgsProcessingParameterRasterLayer("AFTER", "Later DEM"),
        "Elevations in the same CRS; its cells may differ, its surface is read off between them.",
    )
    model.input(
        optional_number("SMALLEST_SIZE", "Smallest size of a change", DOUBLE, 20.0),
        "Change that is smaller on the ground is left out; in the unit of x and y.",
    )
    # Not GDAL's raster calculator, which takes cells of one grid only and ends in a traceback.
    model.step(
        "later",
        "terrainwavelets:analysedem",
        "Take the surface of the later DEM",
        INPUT=input_("AFTER"),
        LEVELS=1,
        PARTITION="random",
        PREDICTION="plane",
    )
    model.step(
        "difference",
        "terrainwavelets:difference",
        "Subtract the earlier DEM",
        INPUT=result("later", "OUTPUT"),
        LEVEL=result("later", "N_LEVELS"),
        LESS_DEM=input_("BEFORE"),
    )
    model.step(
        "analyse",
        "terrainwavelets:analysedem",
        "Analyse the difference",
        INPUT=result("difference", "OUTPUT"),
        LEVELS=12,
        PARTITION="random",
        PREDICTION="plane",
    )
    model.step(
        "filter",
        "terrainwavelets:filterlevels",
        "Leave out small change",
        INPUT=result("analyse", "OUTPUT"),
        SMALLEST_SIZE=given_or("SMALLEST_SIZE", 20.0),
        LOOK="difference",
        outputs={"DEM": ("Change!", "Difference without what is smaller.")},
    )
    model.step(
        "energy",
        "terrainwavelets:detaillayers",
        "Map the change of each level",
        INPUT=result("analyse", "OUTPUT"),
        outputs={"ENERGY": ("Change by level", "A band for each level.")},
    )
    model.write("dems_to_change_by_scale.model3")


def dem_to_landform_clusters():
    """DEM to clusters of landforms by scale."""
    model = Model(
        "DEM to landform clusters",
        "Groups the places of a DEM by how rough they are at each scale: plains, slopes, gullies, "
        "woods or walls fall apart without being taught.",
    )
    model.input(QgsProcessingParameterRasterLayer("INPUT", "DEM"), "Raster of elevations.")
    model.input(
        optional_number("COUNT", "Number of clusters", INTEGER, None, 1),
        "Empty for a number found from the data (2 to 10).",
    )
    model.step(
        "analyse",
        "terrainwavelets:analysedem",
        "Analyse the DEM",
        INPUT=input_("INPUT"),
        LEVELS=8,
        PARTITION="random",
        PREDICTION="plane",
    )
    model.step(
        "cluster",
        "terrainwavelets:clusterdetails",
        "Find the clusters",
        INPUT=result("analyse", "OUTPUT"),
        COUNT=input_("COUNT"),
        outputs={"RASTER": ("Landforms!", "Labels from smooth to rough.")},
    )
    model.write("dem_to_landform_clusters.model3")


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
        lidar_to_contours()
        dem_to_simplified_cog()
        dems_to_change_by_scale()
        dem_to_landform_clusters()


if __name__ == "__main__":
    main()
