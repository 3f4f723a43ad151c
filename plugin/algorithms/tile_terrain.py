"""Rasters or point clouds of any size as a tiled pyramid: one pyramid file a tile, and an index."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingOutputNumber,
    QgsProcessingOutputVectorLayer,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterNumber,
)

from ..base import Values
from ..parameters.analysis_options import add_vertical_unit
from ..parameters.request import Request
from ..ui.enums import REAL_NUMBER, WHOLE_NUMBER
from ..ui.layer_styles import apply_qml
from ..ui.translation import tr
from ._tiles_input import TilesInput

if TYPE_CHECKING:
    from wavelet_gis.tiles.plan import Piece
    from wavelet_gis.tiles.tile import Tiled

    from ..qgis_io.background import Work

#: Part of the bar in which the headers are read.
PLANNING = 0.02


class TileTerrain(TilesInput):
    """Files to tile set."""

    GROUP = "analysis"

    def name(self) -> str:
        """Return the public id."""
        return "tileterrain"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Tile large DEM or point clouds")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Terrain beyond memory to a tiled pyramid: a file for each tile, and an index")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "tile,tiles,large,big,huge,out of core,mosaic,dem,las,laz,copc,ept,lidar,index,pyramid,"
            "wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Turns a DEM or point clouds that need not fit into memory into a pyramid of tiles. "
            "Each tile is analysed by itself, its border locked; then two by two tiles become one, "
            "up to a single one for the whole. At any level the tiles together are one TIN, "
            "without cracks. <i>Extract from tiles</i> gives any region at any level. A run that "
            "was cancelled, or stopped in any other way, goes on where it was when it is started "
            "again with the same parameters."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_tiles_input()
        self.add(
            QgsProcessingParameterNumber(
                "TILE", tr("Side of a tile"), REAL_NUMBER, None, True, 0.0
            ),
            tr(
                "Of DEMs in cells, 1024 if empty; a tile of so many needs some 1.7 GB of memory. "
                "Of point clouds in the unit of x and y; if empty, such that a tile has about a "
                "million points, which need about 1 GB."
            ),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LEVELS", tr("Most levels of a tile"), WHOLE_NUMBER, None, True, 1, 64
            ),
            tr("Of each tile, and of each group of four. Empty for 64."),
            advanced=True,
        )
        self.add_reading_parameters()
        add_vertical_unit(self)
        self.add(
            QgsProcessingParameterBoolean("ADD_TO_MAP", tr("Add the index to the map"), True),
            tr("Opens the footprints of the tiles, with their sizes and errors."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFolderDestination("OUTPUT", tr("Folder of tiles")),
            tr(
                "With <i>index.gpkg</i> and the tiles. Of an earlier run with the same parameters "
                "what is whole is kept; tiles of another input are replaced."
            ),
        )
        self.addOutput(QgsProcessingOutputVectorLayer("INDEX", tr("Index of the tiles")))
        for name, description in (
            ("N_TILES", tr("Number of tiles")),
            ("N_LEVELS", tr("Number of levels of the whole")),
            ("N_MADE", tr("Tiles and groups made in this run")),
            ("N_FOUND", tr("Tiles and groups that were there before")),
            ("N_FAILED", tr("Tiles and groups that were set aside")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def work(self, request: Request) -> Values:
        """Make all tiles and groups, then the index."""
        from wavelet_gis.tiles.index import INDEX

        request.stage(tr("Reading the headers"))
        plan = request.computed(lambda work: self.plan(request, work), 0.0, PLANNING)
        n_tiles = len(plan.pieces(0))
        n_pieces = sum(len(plan.pieces(stage)) for stage in range(plan.n_stages))
        request.say(
            tr("{} tiles, {} with groups, in {} stages").format(n_tiles, n_pieces, plan.n_stages)
        )
        path = request.text("OUTPUT")
        request.stage(tr("Making the tiles"))

        def make(work: Work) -> Tiled:  # each piece aside, until it is there
            from wavelet_gis.tiles.tile import run_plan

            from ..qgis_io.geopackage import write_tile_index

            run = _Run(request, work, n_pieces, self.read(work))
            return run_plan(
                plan,
                path,
                1,  # another process would be another QGIS
                overwrite=True,
                on_piece=run.on_piece,
                make=run.make,
                write=write_tile_index,
            )

        tiled = request.computed(make, PLANNING, 1.0)
        figures = tiled.figures()
        request.figures = {name: figures[name] for name in ("n_tiles", "n_pieces", "n_levels")}
        index = str(tiled.index.folder / INDEX)
        self._add_to_map(request, index)
        return {
            "OUTPUT": path,
            "INDEX": index,
            "N_TILES": figures["n_tiles"],
            "N_LEVELS": figures["n_levels"],
            "N_MADE": figures["n_made"],
            "N_FOUND": figures["n_found"],
            "N_FAILED": len(figures["failed"]),
        }

    def cancelled(self) -> str:
        """Return what is told after a cancel: what was made stays."""
        return tr(
            "Cancelled; the tiles that were made stay, and the same parameters go on from there."
        )

    def _add_to_map(self, request: Request, index: str) -> None:
        project = request.context.project()
        if not request.flag("ADD_TO_MAP") or project is None:
            return
        from wavelet_gis.products.styles import tile_style

        details = QgsProcessingContext.LayerDetails(tr("Index of the tiles"), project, "INDEX")
        request.context.addLayerToLoadOnCompletion(index, details)
        request.finish("INDEX", index, partial(apply_qml, qml=tile_style()))


class _Run:
    """What the pieces that are made tell of themselves, in the thread of the work."""

    def __init__(self, request: Request, work: Work, n_pieces: int, read: Any) -> None:
        self._work, self._n_pieces, self._read = work, n_pieces, read
        self._show = work.in_log(request.feedback.setProgressText)
        self._say = work.in_log(request.say)
        self._n_done = 0

    def make(self, folder: str, piece: Piece, inputs: dict[str, str]) -> dict[str, Any]:
        """Make a piece, as `wavelet_gis.tiles.piece.make_piece` does."""
        from wavelet_gis.tiles.piece import make_piece

        self._show(
            tr("Tile {} of {}: stage {}, row {}, column {}").format(
                self._n_done + 1, self._n_pieces, piece.stage, piece.row, piece.column
            )
        )
        return make_piece(folder, piece, inputs, self._read, self._report)

    def on_piece(self, record: dict[str, Any], n_done: int, n_total: int) -> None:
        """Tell of a piece that is there, and stop once nobody waits any more."""
        from wavelet_core.errors import Cancelled

        self._n_done = n_done
        if record["status"] == "failed":
            self._say(
                tr("Set aside: stage {}, row {}, column {}: {}").format(
                    record["stage"], record["row"], record["column"], record["reason"]
                )
            )
        if not self._report(0.0):
            raise Cancelled("cancelled between two tiles")

    def _report(self, fraction: float) -> bool:
        return self._work.progress((self._n_done + fraction) / self._n_pieces)
