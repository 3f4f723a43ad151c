"""The parameters by which algorithms take a point cloud file, and its reading."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterCrs,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFile,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

from ..base import TerrainWaveletsAlgorithm
from ..parameters.analysis_options import (
    add_weights_parameter,
    vertical_unit,
    weight_options,
    weights_refusal,
)
from ..parameters.choices import choice, duplicate_rules
from ..parameters.request import Request
from ..ui import dependencies
from ..ui.enums import REAL_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.file_metadata import file_widget
from ..ui.translation import tr
from ._cloud_source import CloudSource, cloud_source

if TYPE_CHECKING:
    from wavelet_gis.crs.frame import CoordinateSystem, Georeference
    from wavelet_gis.model.points.cloud import PointCloud
    from wavelet_gis.model.terrain import Terrain
    from wavelet_gis.workflows.options import WaveletOptions

    from ..qgis_io.background import Work

#: Dimensions that are offered by name; any other can be written in.
ATTRIBUTES = ("classification", "hag", "intensity", "rgb", "return_number", "number_of_returns")


#: Classes that the log names one by one.
MOST_NAMED = 12


def add_kept_parameters(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare which points are part of the surface."""
    algorithm.add(
        QgsProcessingParameterBoolean("KEEP_NOISE", tr("Keep points of noise"), False),
        tr(
            "Let points of the classes 7 and 18 be part of the surface. Otherwise they are "
            "only carried, and the reconstructed file has them."
        ),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterBoolean("KEEP_WITHHELD", tr("Keep withheld points"), False),
        tr("The same for points with the withheld flag."),
        advanced=True,
    )
    algorithm.add(
        choice("DUPLICATES", tr("Height of points at one place"), duplicate_rules()),
        tr("Which height points have that share x and y; each of them comes back."),
        advanced=True,
    )


class CloudInput(TerrainWaveletsAlgorithm):
    """Base of the algorithms that start from a LAS, LAZ or COPC file, or a layer of one."""

    source: CloudSource

    PAGE = "point-clouds"
    #: Whether the points of the ground alone are taken where no classes are named and it has some.
    TAKES_GROUND: ClassVar[bool] = False

    def add_input_parameter(self) -> None:
        """Declare INPUT."""
        parameter = QgsProcessingParameterFile("INPUT", tr("Point cloud"))
        parameter.setFileFilter("")  # with one, QGIS refuses the names of layers
        parameter.setMetadata(file_widget("CloudWrapper"))
        self.add(
            parameter,
            tr(
                "A file, or a point cloud layer of the project, by its name or id: its filter by "
                "class and its CRS count. Read by the plugin itself, so no point cloud support in "
                "QGIS is needed."
            ),
        )

    def add_crs_parameter(self) -> None:
        """Declare CRS."""
        self.add(
            QgsProcessingParameterCrs("CRS", tr("CRS of the points"), optional=True),
            tr("Instead of the CRS in the file, or where it has none."),
            advanced=True,
        )

    def add_cloud_parameters(self) -> None:
        """Declare INPUT and what is taken of it."""
        self.add_input_parameter()
        self.add(
            QgsProcessingParameterEnum(
                "ATTRIBUTES",
                tr("Attributes"),
                options=list(ATTRIBUTES),
                allowMultiple=True,
                defaultValue=[],
                optional=True,
                usesStaticStrings=True,
            ),
            tr(
                "What is transformed along with the elevation. <i>hag</i> is the height above the "
                "TIN of the ground points (class 2), in the unit of elevation."
            ),
        )
        self.add(
            QgsProcessingParameterString("OTHER_ATTRIBUTES", tr("Other attributes"), optional=True),
            tr("Names of further dimensions of the file, separated by commas."),
            advanced=True,
        )
        add_weights_parameter(self)
        self.add(
            QgsProcessingParameterString("CLASSES", tr("Classes"), optional=True),
            tr(
                "Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 "
                "for ground and water. Empty for those of the ground, if the file has them, else "
                "for all."
            )
            if self.TAKES_GROUND
            else tr(
                "Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 "
                "for ground and water. Empty for all points."
            ),
        )
        self.add(
            QgsProcessingParameterBoolean("CARRY", tr("Keep all other dimensions"), True),
            tr(
                "Keep what is not transformed (GPS time, flags, ...) in the pyramid, so that the "
                "reconstructed file has it too."
            ),
            advanced=True,
        )
        self._add_surface_parameters()
        self.add_crs_parameter()

    def _add_surface_parameters(self) -> None:
        add_kept_parameters(self)
        self.add(
            QgsProcessingParameterNumber(
                "MAX_EDGE", tr("Longest edge"), REAL_NUMBER, None, optional=True, minValue=0.0
            ),
            tr(
                "Triangles with a longer edge are left out, as gaps of the point cloud; in the "
                "unit of x and y, or metres for a geographic CRS. 0 for five times the spacing "
                "that 95 % of the points keep; empty to fill the convex hull."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean("CONCAVE", tr("Gaps at the outline only"), False),
            tr("Leave out only what such edges open to the outside; gaps inside stay closed."),
            advanced=True,
        )

    def refusal(self, request: Request) -> str | None:
        """Refuse a file that is not there, and classes or weights that are no numbers."""
        fault = cloud_source(request, "INPUT").fault
        if fault is not None:
            return fault
        try:
            request.whole_numbers("CLASSES")
        except ValueError:
            return tr("Classes are numbers separated by commas, such as 2,9.")
        return weights_refusal(request)

    def packages(self, request: Request) -> tuple[dependencies.Package, ...]:
        """Return what reading the file needs: no lazrs where QGIS itself can unpack LAZ."""
        from ..qgis_io.laz_unpacker import unpacker

        path = request.input_file("INPUT")
        return dependencies.for_las("" if unpacker(path) else path)

    def take_layers(self, request: Request) -> None:
        """Take from a layer, in its own thread, its file, its filter and its CRS."""
        self.source = cloud_source(request, "INPUT")
        if self.source.fault is not None:
            raise QgsProcessingException(self.source.fault)

    def read_points(self, request: Request, **options: Any) -> tuple[PointCloud, Georeference]:
        """Return the points in the file, unpacked first where lazrs is missing.

        Parameters
        ----------
        request : Request
        **options
            See `wavelet_gis.io.las.read_cloud`.
        """
        from wavelet_gis.io.las import read_cloud

        from ..qgis_io.laz_unpacker import as_las

        path = self.source.path
        request.stage(tr("Reading the points"))
        with as_las(path, request.feedback) as source:
            if source != path:
                request.say(tr("Unpacked by QGIS's pdal_wrench, since lazrs is missing"))
            return request.computed(lambda work: read_cloud(source, **options), 0.0, 0.05)

    def system_of(self, request: Request, place: Georeference) -> CoordinateSystem:
        """Return the CRS of the points: that chosen, that of the layer, or that of the file."""
        from ..qgis_io.crs_and_progress import coordinate_system

        crs = request.crs("CRS")
        if not crs.isValid():
            crs = self.source.crs
        if not crs.isValid() and place.wkt:
            crs = QgsCoordinateReferenceSystem.fromWkt(place.wkt)
            if not crs.isValid():
                raise QgsProcessingException(
                    tr("{}: QGIS does not understand the CRS in the file; choose one.").format(
                        self.source.path
                    )
                )
        return coordinate_system(crs)

    def terrain(self, request: Request) -> Terrain:
        """Return the terrain in the file."""
        from wavelet_gis.model.terrain import terrain_of_cloud

        path = self.source.path
        attributes = [*request.choices("ATTRIBUTES"), *request.words("OTHER_ATTRIBUTES")]
        classes = self._classes(request)
        takes_ground = self.TAKES_GROUND and classes is None
        cloud, place = self.read_points(
            request,
            attributes=attributes,
            classes=classes,
            ground_first=takes_ground,
            carry=request.flag("CARRY"),
            keep_noise=request.flag("KEEP_NOISE"),
            keep_withheld=request.flag("KEEP_WITHHELD"),
        )
        if takes_ground:
            request.say(
                tr("Taken: the {} points of the ground (class 2), of {}").format(
                    cloud.n_points, cloud.n_in_file
                )
                if cloud.classes
                else tr("Taken: all points, since none is classified as ground (class 2)")
            )
        max_edge = request.number("MAX_EDGE")
        request.stage(tr("Triangulating {} points").format(cloud.n_points))
        system = self.system_of(request, place)
        unit = vertical_unit(request) or place.vertical_unit
        duplicates = request.text("DUPLICATES") or None
        concave = request.flag("CONCAVE")

        def triangulate(work: Work) -> Terrain:
            return terrain_of_cloud(
                path,
                cloud,
                system,
                unit,
                fault=place.fault,
                duplicates=duplicates,
                max_edge="auto" if max_edge == 0 else max_edge,
                concave=concave,
            )

        return request.computed(triangulate, 0.05, 0.15)

    def _classes(self, request: Request) -> list[int] | None:
        """Return the classes that are read: those named, of those that a layer's filter leaves."""
        named, left = request.whole_numbers("CLASSES"), self.source.classes
        if left is None:
            return named or None
        listed = (
            ", ".join(map(str, left))
            if len(left) <= MOST_NAMED
            else tr("{} classes").format(len(left))
        )
        request.say(tr("The filter of the layer {} leaves: {}").format(self.source.layer, listed))
        chosen = [number for number in left if not named or number in named]
        if not chosen:
            raise QgsProcessingException(
                tr("{}: its filter leaves none of the classes that are named; change one.").format(
                    self.source.layer
                )
            )
        return chosen

    def more_options(self, request: Request, terrain: Terrain) -> WaveletOptions:
        """Return the weights of the attributes."""
        from wavelet_gis.io.las import ALIASES
        from wavelet_gis.model.points.cloud import PointCloud

        assert isinstance(terrain.original, PointCloud)
        names_of_dimension: dict[str, list[str]] = {}
        for attribute in terrain.original.attributes:
            names_of_dimension.setdefault(attribute.dimension, []).append(attribute.name)
        names = terrain.mesh.attribute_names
        groups = {**ALIASES, **names_of_dimension}
        return {"attribute_weights": weight_options(request, names, groups)}
