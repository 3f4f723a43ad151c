"""A region of a tile set at one level, or within a tolerance, as TIN, points, raster or mesh."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsFeatureRequest,
    QgsGeometry,
    QgsProcessingOutputNumber,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFile,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..base import TerrainWaveletsAlgorithm, Values
from ..parameters.mesh_output import add_mesh_parameter, mesh_packages
from ..parameters.request import Request
from ..parameters.surface_output import (
    add_cell_size_parameter,
    add_error_outputs,
    surface_figures,
    write_surface,
)
from ..ui import dependencies
from ..ui.enums import POINTS, POLYGONS, REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._tiles_input import crs_of_plan

if TYPE_CHECKING:
    from wavelet_gis.tiles.index import TileIndex
    from wavelet_gis.tiles.plan import TilePlan
    from wavelet_gis.tiles.read import Region

    from ..qgis_io.background import Work

#: Parts of the bar: opening the index, and reading the tiles.
OPENED, READ = 0.05, 0.6


class ExtractFromTiles(TerrainWaveletsAlgorithm):
    """Tile set to the surface of a region."""

    polygons: list[QgsGeometry]

    GROUP = "reconstruction"

    def name(self) -> str:
        """Return the public id."""
        return "extractfromtiles"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Extract from tiles")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("A region of a tiled pyramid at any level or accuracy, as TIN, raster or mesh")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "tiles,index,region,clip,extent,tin,mesh,2dm,raster,level of detail,lod,large,pyramid,"
            "wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Gives a region of what <i>Tile large DEM or point clouds</i> made, at a level or as "
            "coarse as a largest error allows, without cracks between tiles. Only the tiles that "
            "it needs are read. Triangles that reach into the region are given whole."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add(
            QgsProcessingParameterFile(
                "INPUT",
                tr("Index of the tiles"),
                extension="gpkg",
                fileFilter=tr("Index of tiles (*.gpkg)"),
            ),
            tr("The file <i>index.gpkg</i> in the folder of the tiles."),
        )
        self.add(
            QgsProcessingParameterExtent("EXTENT", tr("Extent"), optional=True),
            tr("The region, in any CRS. Empty, and no polygons either, for all."),
        )
        self.add(
            QgsProcessingParameterFeatureSource(
                "POLYGONS", tr("Or polygons"), [POLYGONS], optional=True
            ),
            tr("Instead: the region is that of all of them. This needs shapely."),
        )
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, 0, minValue=0),
            tr("Of the whole: 0 is the coarsest; the number of levels is the input itself."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "MAX_ERROR", tr("Largest error"), REAL_NUMBER, None, True, 0.0
            ),
            tr(
                "Instead of a level: fine only where it has to be for no input point of the region "
                "to be farther above or below the surface, in the unit of elevation."
            ),
        )
        add_cell_size_parameter(
            self, tr("In the unit of the CRS. Empty for the mean spacing of the vertices.")
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "TIN", tr("TIN of the region"), POLYGONS, optional=True, createByDefault=True
            ),
            tr("Triangles with mean elevation and slope (degrees)."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "VERTICES",
                tr("Vertices of the region"),
                POINTS,
                optional=True,
                createByDefault=False,
            ),
            tr("Points with elevation and attributes; <i>vertex_id</i> counts the input's cells."),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", tr("Raster of the region"), optional=True, createByDefault=False
            ),
            tr("The TIN evaluated at the cell centres, 32-bit floats."),
        )
        add_mesh_parameter(self, tr("Mesh of the region"))
        for name, description in (
            ("N_VERTICES", tr("Number of vertices")),
            ("N_FACES", tr("Number of triangles")),
            ("N_TILES", tr("Tiles and groups that were read")),
            ("FOUND_LEVEL", tr("Level, or the finest one in the region")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))
        add_error_outputs(self, tr("of the surface"))

    def refusal(self, request: Request) -> str | None:
        """Refuse an index that is not there, two regions, or two rules."""
        from wavelet_gis.tiles.index import is_index

        path = request.input_file("INPUT")
        if not os.path.isfile(path) or not is_index(path):
            return tr("{}: this is no index of tiles; choose index.gpkg in their folder.").format(
                path
            )
        if request.has("EXTENT") and request.has("POLYGONS"):
            return tr("Give an extent or polygons, not both.")
        if request.has("MAX_ERROR") and request.whole("LEVEL"):
            return tr("Give a level or the largest error, not both.")
        return super().refusal(request)

    def packages(self, request: Request) -> tuple[dependencies.Package, ...]:
        """Return what the region and writing the mesh need."""
        region = (dependencies.SHAPELY,) if request.has("POLYGONS") else ()
        return (*region, *mesh_packages(request))

    def take_layers(self, request: Request) -> None:
        """Take the polygons of the region from their layer, in its own thread."""
        self.polygons = []
        source = request.source("POLYGONS")
        if source is None:
            return
        asked = QgsFeatureRequest().setDestinationCrs(
            crs_of_plan(_plan_at(request.input_file("INPUT"))), request.transforms
        )
        geometries = (feature.geometry() for feature in source.getFeatures(asked))
        self.polygons = [geometry for geometry in geometries if not geometry.isEmpty()]
        for geometry in self.polygons:
            geometry.convertToStraightSegment()
        if not self.polygons:
            raise QgsProcessingException(tr("There is no polygon in the layer; choose another."))

    def work(self, request: Request) -> Values:
        """Read the tiles, put the region together and write what was asked for."""
        request.stage(tr("Reading the index"))
        path = request.input_file("INPUT")
        index = request.computed(lambda work: _index_at(path), 0.0, OPENED)
        request.say(tr("Levels: 0 (coarsest) to {}").format(index.n_levels))
        max_error = request.number("MAX_ERROR")
        level = (request.whole("LEVEL") or 0) if max_error is None else None
        bbox = self._box(request, index.plan)
        polygon = self._polygon()
        request.stage(tr("Reading the tiles"))

        def extract(work: Work) -> Region:
            from wavelet_gis.tiles.read import extract_region

            return extract_region(
                index,
                level=level,
                max_error=max_error,
                bbox=bbox,
                polygon=polygon,
                progress=work.progress,
            )

        region = request.computed(extract, OPENED, READ)
        surface = region.surface
        request.figures = {
            **surface_figures(surface),
            "N_TILES": len(region.pieces),
            "FOUND_LEVEL": surface.level,
        }
        results = write_surface(request, surface)
        if not results:
            raise QgsProcessingException(
                tr("No output is chosen; choose a TIN, vertices, a raster or a mesh.")
            )
        return {**request.figures, **results}

    def _box(self, request: Request, plan: TilePlan) -> tuple[float, float, float, float] | None:
        """Return the extent in the CRS of the tiles; None where there is none."""
        if not request.has("EXTENT"):
            return None
        extent = self.parameterAsExtent(
            request.parameters, "EXTENT", request.context, crs_of_plan(plan)
        )
        return extent.xMinimum(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum()

    def _polygon(self) -> Any:
        """Return the polygons as one shape; None where there are none."""
        if not self.polygons:
            return None
        import shapely

        shapes = [shapely.from_wkb(bytes(geometry.asWkb())) for geometry in self.polygons]
        return shapely.union_all(shapely.force_2d(shapes))


def _plan_at(path: str) -> TilePlan:
    from pathlib import Path

    from wavelet_gis.tiles.plan import PLAN, TilePlan

    file = Path(path).parent / PLAN
    return TilePlan.from_json(file.read_text("utf-8"), str(file))


def _index_at(path: str) -> TileIndex:
    from wavelet_gis.tiles.index import open_index

    return open_index(path)
