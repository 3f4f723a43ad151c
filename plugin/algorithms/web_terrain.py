"""A level of a pyramid as quantized-mesh tiles, for globes in browsers and QGIS's 3D views."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterNumber,
)

from ..base import Values
from ..parameters.pyramid import checked_level
from ..parameters.request import Request
from ..ui import dependencies
from ..ui.enums import REAL_NUMBER, WHOLE_NUMBER
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.tiles.globe.tileset import Tileset

    from ..qgis_io.background import Work

#: Part of the bar in which the pyramid is read. The tiles of a million cells take 25 times as long,
#: but half as many points are read for longer, and even then the bar has to be seen to move.
READING = 0.1


class WebTerrain(PyramidAlgorithm):
    """Pyramid to tiles."""

    GROUP = "reconstruction"
    PACKAGES = (dependencies.PYPROJ,)

    def name(self) -> str:
        """Return the public id."""
        return "webterrain"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Terrain for the web")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Quantized-mesh tiles of all zooms for globes such as CesiumJS, and for QGIS")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "quantized mesh,cesium,globe,tiles,terrain,3d,web,layer.json,level,pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Writes the terrain as tiles of triangles for all zooms, without cracks between them, "
            "each zoom half as far off as the one before. A web server that gives the folder to a "
            "globe is all that it takes; QGIS reads it as a quantized-mesh layer."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVEL")
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, None, True, 0),
            tr("0 is the coarsest. Empty for the input itself."),
        )
        self.add(
            QgsProcessingParameterNumber("MAX_ERROR", tr("Largest error"), REAL_NUMBER, None, True),
            tr(
                "Of the finest zoom, in metres; twice that for the next, and so on. Empty for a "
                "tenth of the spacing of the points."
            ),
        )
        self.add(
            QgsProcessingParameterNumber("ZOOM", tr("Finest zoom"), WHOLE_NUMBER, None, True, 0),
            tr("Empty for the one whose tiles have some 128 points along each side."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber("FILL", tr("Height beyond the data"), REAL_NUMBER, 0.0),
            tr("In metres."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean("NORMALS", tr("Write normals"), False),
            tr("For light and shade."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFolderDestination("OUTPUT", tr("Folder of tiles")),
            tr("With <i>layer.json</i> and the tiles. An earlier tile set there is replaced."),
        )
        for name, description in (
            ("N_TILES", tr("Number of tiles")),
            ("N_ZOOMS", tr("Number of zooms")),
            ("MAX_ERROR_FINEST", tr("Largest error of the finest zoom, in metres")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def work(self, request: Request) -> Values:
        """Cut the tiles, write them."""
        from wavelet_gis.tiles.globe.tileset import terrain_tiles

        geo = self.geo_pyramid(request, reading=READING)
        given = request.whole("LEVEL")
        level = None if given is None else checked_level(geo, given)
        request.stage(tr("Writing the tiles"))
        path = request.text("OUTPUT")
        if Path(path).is_dir() and not any(Path(path).iterdir()):
            Path(path).rmdir()  # a temporary folder, which QGIS has made
        finest, max_error = request.whole("ZOOM"), request.size("MAX_ERROR")
        fill, normals = request.number("FILL") or 0.0, request.flag("NORMALS")

        def write(work: Work) -> Tileset:  # aside, until the last tile is there
            return terrain_tiles(
                geo,
                path,
                level=level,
                zoom=finest,
                max_error=max_error,
                fill=fill,
                normals=normals,
                overwrite=True,
                progress=work.progress,
            )

        tiles = request.computed(write, 0.05, 1.0)
        request.say(tr(" zoom   tiles  vertices  largest error (m)"))
        for zoom in tiles.zooms:
            request.say(
                f"{zoom.zoom:5d} {zoom.n_tiles:7d} {zoom.n_vertices:9d} {zoom.max_error:18.4f}"
            )
        return {
            "OUTPUT": path,
            "N_TILES": tiles.figures()["n_tiles"],
            "N_ZOOMS": len(tiles.zooms),
            "MAX_ERROR_FINEST": tiles.zooms[-1].max_error,
        }
