"""A layer of points or triangles, with breaklines, becomes a pyramid file."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsWkbTypes,
)

from ..parameters.analysis_options import (
    add_weights_parameter,
    vertical_unit,
    weight_options,
    weights_refusal,
)
from ..ui import dependencies
from ._analysis import AnalysisAlgorithm


class AnalyseTin(AnalysisAlgorithm):
    """Vector layer to pyramid."""

    def name(self):
        """Return the public id."""
        return "analysetin"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Analyse points or TIN")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr(
            "tin,points,triangles,breaklines,survey,pyramid,wavelet,multiresolution"
        ).split(",")

    def about(self):
        """Return what it does."""
        return self.tr(
            "Turns a layer of points or of triangles into a reversible wavelet pyramid. Points are "
            "triangulated (Delaunay in plan), with breaklines as edges and clipped to a polygon if "
            "wanted. Locked points and the vertices of breaklines stay at every level, where they "
            "are and as high as they are."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        source_type = QgsProcessing.SourceType
        self.add(
            QgsProcessingParameterFeatureSource(
                "INPUT",
                self.tr("Points or triangles"),
                [source_type.TypeVectorPoint, source_type.TypeVectorPolygon],
            ),
            self.tr(
                "Points with Z or with a field of elevations, or polygons with Z that are all "
                "triangles. Of points at the same x and y the lowest counts."
            ),
        )
        self.add(
            QgsProcessingParameterField(
                "Z_FIELD",
                self.tr("Field with the elevation"),
                None,
                "INPUT",
                QgsProcessingParameterField.DataType.Numeric,
                optional=True,
            ),
            self.tr("Of points; empty for the Z of the geometry."),
        )
        self.add(
            QgsProcessingParameterField(
                "ATTRIBUTES",
                self.tr("Attributes"),
                None,
                "INPUT",
                QgsProcessingParameterField.DataType.Numeric,
                allowMultiple=True,
                optional=True,
            ),
            self.tr("Numeric fields of points that are transformed along with the elevation."),
        )
        add_weights_parameter(self)
        self.add(
            QgsProcessingParameterFeatureSource(
                "BREAKLINES", self.tr("Breaklines"), [source_type.TypeVectorLine], optional=True
            ),
            self.tr(
                "Become edges of the TIN. Where they have no Z, they lie on the TIN of the points; "
                "where they cross, they are cut."
            ),
        )
        self.add(
            QgsProcessingParameterFeatureSource(
                "CLIP", self.tr("Clip polygon"), [source_type.TypeVectorPolygon], optional=True
            ),
            self.tr("Only the terrain inside; its outline becomes edges of the TIN."),
        )
        self.add(
            QgsProcessingParameterField(
                "LOCK_FIELD",
                self.tr("Field that locks points"),
                None,
                "INPUT",
                QgsProcessingParameterField.DataType.Any,
                optional=True,
            ),
            self.tr("Points where it holds anything but 0, false or NULL stay at every level."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean("LOCK_BREAKLINES", self.tr("Lock breaklines"), True),
            self.tr("Keep the vertices of breaklines, and so the lines, at every level."),
            advanced=True,
        )
        self.add_analysis_parameters()

    def checkParameterValues(self, parameters, context):
        """Refuse weights that are no numbers."""
        is_fine, message = super().checkParameterValues(parameters, context)
        refusal = weights_refusal(self, parameters, context) if is_fine else message
        return refusal is None, refusal or ""

    def packages(self, parameters, context):
        """Return the Delaunay library, where points are to be triangulated."""
        source = self.parameterAsSource(parameters, "INPUT", context)
        is_triangles = source is not None and _holds_polygons(source)
        return () if is_triangles else (dependencies.PYTHONCDT,)

    def prepare(self, parameters, context, feedback):
        """Take the sources, in the thread that the layers live in."""
        self.source = self.parameterAsSource(parameters, "INPUT", context)
        if self.source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, "INPUT"))
        self.breaklines = self.parameterAsSource(parameters, "BREAKLINES", context)
        self.clip = self.parameterAsSource(parameters, "CLIP", context)

    def terrain(self, parameters, context, feedback):
        """Return the terrain in the layers."""
        from wavelet_gis.model.terrain import terrain_of_mesh
        from wavelet_gis.model.tin import frame_of_coordinates

        from ..qgis_io.crs_and_progress import coordinate_system

        system = coordinate_system(self.source.sourceCrs())
        unit = vertical_unit(self, parameters, context)
        name = self.source.sourceName()
        self.locked = None
        if _holds_polygons(self.source):
            mesh, frame, unit = self._mesh_of_triangles(name, system, unit, feedback)
        else:
            points = self._points(parameters, context, feedback)
            frame, unit = frame_of_coordinates(name, points.xyz, system, unit)
            mesh = self._mesh_of_points(parameters, context, points, frame, feedback)
        return terrain_of_mesh(name, mesh, system, frame, unit)

    def more_options(self, parameters, context, terrain):
        """Return the locked vertices and the weights of the attributes."""
        names = terrain.mesh.attribute_names
        options = weight_options(self, parameters, context, names)
        if self.locked is not None and self.locked.any():
            options["locked"] = self.locked
        return options

    def _mesh_of_triangles(self, name, system, unit, feedback):
        from wavelet_gis.model.tin import frame_of_coordinates, mesh_of_corners

        from ..qgis_io.vectors import read_triangles

        if self.breaklines is not None or self.clip is not None:
            raise QgsProcessingException(
                self.tr(
                    "Breaklines and clip polygons are for points; the edges of a triangle layer "
                    "stay as they are. Take its vertices, or leave them out."
                )
            )
        feedback.setProgressText(self.tr("Reading the triangles"))
        corners = read_triangles(self.source, feedback)
        frame, unit = frame_of_coordinates(name, corners.reshape(-1, 3), system, unit)
        return (
            mesh_of_corners(frame.to_local(corners.reshape(-1, 3)).reshape(corners.shape)),
            frame,
            unit,
        )

    def _points(self, parameters, context, feedback):
        from ..qgis_io.vectors import read_points

        feedback.setProgressText(self.tr("Reading the points"))
        self.attribute_names = self.parameterAsStrings(parameters, "ATTRIBUTES", context)
        return read_points(
            self.source,
            self.parameterAsString(parameters, "Z_FIELD", context) or None,
            self.attribute_names,
            self.parameterAsString(parameters, "LOCK_FIELD", context) or None,
            feedback,
        )

    def _mesh_of_points(self, parameters, context, points, frame, feedback):
        import numpy as np

        from wavelet_gis.model.tin import tin_with_lines

        from ..qgis_io.constraints import read_constraints
        from ..qgis_io.crs_and_progress import require_running

        constraints = read_constraints(
            self.breaklines,
            self.clip,
            self.source.sourceCrs(),
            context.transformContext(),
            feedback,
        )
        inside = constraints.contains(points.xyz[:, :2])
        if not inside.any():
            raise QgsProcessingException(
                self.tr("No point is inside the clip polygon; check that the layers overlap.")
            )
        if constraints.breaklines and not constraints.meets(points.xyz[inside]):
            raise QgsProcessingException(
                self.tr(
                    "No breakline is where the points are; check that the layers overlap, or leave "
                    "the breaklines out."
                )
            )
        require_running(feedback)
        feedback.setProgressText(self.tr("Triangulating {} points").format(int(inside.sum())))

        def contains(positions):
            x, y = positions.T
            return constraints.contains(np.column_stack([frame.file_x(x), frame.file_y(y)]))

        tin = tin_with_lines(
            frame.to_local(points.xyz[inside]),
            points.attributes[inside],
            self.attribute_names,
            breaklines=[frame.to_local(line) for line in constraints.breaklines],
            outline=[frame.to_local(ring) for ring in constraints.outline],
            contains=contains,
            is_marked=points.is_marked[inside],
        )
        self.locked = tin.is_marked
        if self.parameterAsBool(parameters, "LOCK_BREAKLINES", context):
            self.locked = tin.is_marked | tin.is_on_line
        return tin.mesh


def _holds_polygons(source) -> bool:
    kind = QgsWkbTypes.geometryType(source.wkbType())
    return kind == QgsWkbTypes.GeometryType.PolygonGeometry
