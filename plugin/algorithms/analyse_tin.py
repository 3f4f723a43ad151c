"""A layer of points or triangles, with breaklines, becomes a pyramid file."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingFeatureSource,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterNumber,
    QgsWkbTypes,
)

from ..base import Values
from ..parameters.analysis_options import (
    add_weights_parameter,
    vertical_unit,
    weight_options,
    weights_refusal,
)
from ..parameters.request import Request
from ..ui.enums import (
    ANY_FIELD,
    LINES,
    NUMERIC_FIELD,
    POINTS,
    POLYGON_GEOMETRY,
    POLYGONS,
    REAL_NUMBER,
)
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._analysis import AnalysisAlgorithm

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wavelet_gis.crs.frame import CoordinateSystem
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.model.terrain import Terrain
    from wavelet_gis.workflows.options import WaveletOptions

    from ..qgis_io.background import Work


#: Parts of the bar: until when points are placed, and lines laid on them; reading goes before.
PLACED_BY, LAID_BY = 0.07, 0.15


class AnalyseTin(AnalysisAlgorithm):
    """Vector layer to pyramid."""

    source: QgsProcessingFeatureSource
    breaklines: QgsProcessingFeatureSource | None
    clip: QgsProcessingFeatureSource | None
    #: Where the terrain is known along the lines, in the working frame.
    profile: NDArray[np.float64] | None

    def name(self) -> str:
        """Return the public id."""
        return "analysetin"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Analyse points or TIN")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Points with breaklines, or triangles, to a reversible pyramid of TINs")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "tin,points,triangles,triangulate,delaunay,breaklines,survey,pyramid,wavelet,"
            "multiresolution,analyze"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Turns a layer of points or of triangles into a reversible wavelet pyramid. Points are "
            "triangulated (Delaunay in plan), with breaklines as edges and clipped to a polygon if "
            "wanted. Locked points and the vertices of breaklines stay at every level, where they "
            "are and as high as they are."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add(
            QgsProcessingParameterFeatureSource(
                "INPUT", tr("Points or triangles"), [POINTS, POLYGONS]
            ),
            tr(
                "Points with Z or with a field of elevations, or polygons with Z that are all "
                "triangles. Of points at the same x and y the lowest is taken."
            ),
        )
        self.add(
            QgsProcessingParameterField(
                "Z_FIELD",
                tr("Field with the elevation"),
                None,
                "INPUT",
                NUMERIC_FIELD,
                optional=True,
            ),
            tr("Of points; empty for the Z of the geometry."),
        )
        self.add(
            QgsProcessingParameterField(
                "ATTRIBUTES",
                tr("Attributes"),
                None,
                "INPUT",
                NUMERIC_FIELD,
                allowMultiple=True,
                optional=True,
            ),
            tr("Numeric fields of points that are transformed along with the elevation."),
        )
        add_weights_parameter(self)
        self.add(
            QgsProcessingParameterFeatureSource(
                "BREAKLINES", tr("Breaklines"), [LINES], optional=True
            ),
            tr(
                "Become edges of the TIN. Without Z they are laid on the TIN of the points, all "
                "along; with Z they keep it. Where they cross, they are cut."
            ),
        )
        self.add(
            QgsProcessingParameterFeatureSource(
                "CLIP", tr("Clip polygon"), [POLYGONS], optional=True
            ),
            tr(
                "Only the terrain inside; its outline becomes edges of the TIN and is laid on the "
                "TIN of the points."
            ),
        )
        self.add(
            QgsProcessingParameterField(
                "LOCK_FIELD",
                tr("Field that locks points"),
                None,
                "INPUT",
                ANY_FIELD,
                optional=True,
            ),
            tr("Points whose value is anything but 0, false or NULL stay at every level."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean(
                "LOCK_BREAKLINES", tr("Lock breaklines and outline"), True
            ),
            tr(
                "Keep the vertices of breaklines and of the outline, and so the lines, at every "
                "level."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber(
                "LINE_TOLERANCE",
                tr("Tolerance along lines without Z"),
                REAL_NUMBER,
                None,
                optional=True,
                minValue=0.0,
            ),
            tr(
                "A line that is laid on the terrain keeps only as many vertices as it needs to be "
                "nowhere farther above or below it, in the unit of elevation. Empty for the "
                "largest error where that is a stop rule, else for a thousandth of the relief."
            ),
            advanced=True,
        )
        self.add_analysis_parameters()
        for name, description in (
            ("RMSE_LINES", tr("RMSE along breaklines and outline, in the unit of elevation")),
            (
                "MAX_ERROR_LINES",
                tr("Largest error along breaklines and outline, in the unit of elevation"),
            ),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def refusal(self, request: Request) -> str | None:
        """Refuse weights that are no numbers."""
        return weights_refusal(request)

    def take_layers(self, request: Request) -> None:
        """Take the sources, in the thread that the layers live in."""
        source = request.source("INPUT")
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(request.parameters, "INPUT"))
        self.source = source
        self.breaklines = request.source("BREAKLINES")
        self.clip = request.source("CLIP")

    def terrain(self, request: Request) -> Terrain:
        """Return the terrain in the layers."""
        from ..qgis_io.crs_and_progress import coordinate_system

        system = coordinate_system(self.source.sourceCrs())
        self.profile = None
        if _holds_polygons(self.source):
            return self._terrain_of_triangles(request, system)
        return self._terrain_of_points(request, system)

    def more_options(self, request: Request, terrain: Terrain) -> WaveletOptions:
        """Return the weights of the attributes."""
        return {"attribute_weights": weight_options(request, terrain.mesh.attribute_names)}

    def more_figures(self, request: Request, geo: GeoPyramid) -> Values:
        """Return how far the coarsest level is from the terrain along the lines."""
        from wavelet_gis.workflows.extract import measured

        if self.profile is None or len(self.profile) == 0:
            return {}
        profile = self.profile
        errors = request.computed(
            lambda work: measured(geo.pyramid.mesh(0), profile, geo.frame.z_scale), 0.95, 1.0
        )
        request.say(
            tr("Along breaklines and outline: RMSE {:.4g}, largest error {:.4g}").format(
                errors.rmse, errors.max_error
            )
        )
        return {"RMSE_LINES": errors.rmse, "MAX_ERROR_LINES": errors.max_error}

    def _terrain_of_triangles(self, request: Request, system: CoordinateSystem) -> Terrain:
        from wavelet_gis.model.tin import terrain_of_triangles

        from ..qgis_io.vectors import read_triangles

        if self.breaklines is not None or self.clip is not None:
            raise QgsProcessingException(
                tr(
                    "Breaklines and clip polygons are for points; the edges of a triangle layer "
                    "stay as they are. Take its vertices, or leave them out."
                )
            )
        request.stage(tr("Reading the triangles"))
        corners = read_triangles(self.source, request.feedback)
        name, unit = self.source.sourceName(), vertical_unit(request)
        return request.computed(
            lambda work: terrain_of_triangles(name, corners, system, unit), 0.05, 0.15
        )

    def _terrain_of_points(self, request: Request, system: CoordinateSystem) -> Terrain:
        import numpy as np

        from wavelet_core import TriangleMesh
        from wavelet_gis.model.terrain import terrain_of_mesh
        from wavelet_gis.model.tin import frame_of_coordinates, points_merged, tin_with_lines
        from wavelet_gis.workflows.lines.constraints import Constraints, laid, locked_vertices

        from ..qgis_io.constraints import read_constraints
        from ..qgis_io.vectors import READ_BY, read_points

        request.stage(tr("Reading the points"))
        name, attribute_names = self.source.sourceName(), request.strings("ATTRIBUTES")
        points = read_points(
            self.source,
            request.text("Z_FIELD") or None,
            attribute_names,
            request.text("LOCK_FIELD") or None,
            request.feedback,
        )
        frame, unit = frame_of_coordinates(name, points.xyz, system, vertical_unit(request))
        constraints = read_constraints(
            self.breaklines,
            self.clip,
            self.source.sourceCrs(),
            request.transforms,
            request.feedback,
        )

        def place(work: Work) -> tuple[NDArray[np.bool_], bool, NDArray[np.float64]]:
            inside = constraints.contains(points.xyz[:, :2], work.progress)
            is_asked = bool(constraints.breaklines) and inside.any()
            meets = not is_asked or constraints.meets(points.xyz[inside])
            return inside, meets, frame.to_local(points.xyz)

        inside, meets, local = request.computed(place, READ_BY, PLACED_BY)
        if not inside.any():
            raise QgsProcessingException(
                tr("No point is inside the clip polygon; check that the layers overlap.")
            )
        if not meets:
            raise QgsProcessingException(
                tr(
                    "No breakline is where the points are; check that the layers overlap, or leave "
                    "the breaklines out."
                )
            )

        def contains(positions: NDArray[np.float64]) -> NDArray[np.bool_]:
            x, y = positions.T
            return constraints.contains(np.column_stack([frame.file_x(x), frame.file_y(y)]))

        lines = Constraints(
            [frame.to_local(line) for line in constraints.breaklines],
            [frame.to_local(ring) for ring in constraints.outline],
            contains,
        )
        begins = PLACED_BY
        if lines.breaklines or lines.outline:
            begins = LAID_BY
            request.stage(tr("Laying lines on the terrain"))
            tolerance = _first_of(request, "LINE_TOLERANCE", "MAX_ERROR")
            within = None if tolerance is None else tolerance * frame.z_scale
            lines, self.profile = request.computed(
                lambda work: laid(lines, TriangleMesh.from_points(local), within),
                PLACED_BY,
                LAID_BY,
            )
        request.stage(tr("Triangulating {} points").format(int(inside.sum())))

        locks_lines, profile = request.flag("LOCK_BREAKLINES"), self.profile

        def triangulate(work: Work) -> Terrain:
            tin = tin_with_lines(
                local[inside],
                points.attributes[inside],
                attribute_names,
                breaklines=lines.breaklines,
                outline=lines.outline,
                contains=contains,
                is_marked=points.is_marked[inside],
            )
            merged = points_merged(name, points.xyz[inside], local[inside])
            return replace(
                terrain_of_mesh(name, tin.mesh, system, frame, unit),
                merged=np.concatenate([merged, tin.replaced]),
                locked=locked_vertices(tin, lines=locks_lines),
                profile=profile,
            )

        return request.computed(triangulate, begins, 0.25)


def _first_of(request: Request, *names: str) -> float | None:
    """Return the first number that is given."""
    numbers = (request.number(name) for name in names)
    return next((number for number in numbers if number is not None), None)


def _holds_polygons(source: QgsProcessingFeatureSource) -> bool:
    kind = QgsWkbTypes.geometryType(source.wkbType())
    return bool(kind == POLYGON_GEOMETRY)
