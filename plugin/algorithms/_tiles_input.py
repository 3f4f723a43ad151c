"""The inputs of a tile set, of which no more is in memory at once than a tile."""

from __future__ import annotations

import contextlib
import os
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessingParameterCrs,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
    QgsRasterLayer,
)

from ..base import TerrainWaveletsAlgorithm
from ..parameters.analysis_options import vertical_unit
from ..ui import dependencies
from ..ui.enums import FILES, RASTERS, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._cloud_input import add_kept_parameters

if TYPE_CHECKING:
    from wavelet_gis.crs.frame import Georeference
    from wavelet_gis.io.raster import CellWindow
    from wavelet_gis.model.dem import Dem
    from wavelet_gis.tiles.plan import TilePlan

    from ..parameters.request import Request
    from ..qgis_io.background import Work
    from ..qgis_io.raster_reader import RasterInput


class TilesInput(TerrainWaveletsAlgorithm):
    """Base of the algorithm that takes many files as one terrain."""

    rasters: list[RasterInput]

    def add_tiles_input(self) -> None:
        """Declare RASTERS and CLOUDS."""
        self.add(
            QgsProcessingParameterMultipleLayers("RASTERS", tr("DEMs"), RASTERS, optional=True),
            tr(
                "One raster of any size, or several with cells in one grid; where they overlap, "
                "the first that has data counts. Layers of files on this machine, read as the "
                "files are."
            ),
        )
        self.add(
            QgsProcessingParameterMultipleLayers(
                "CLOUDS",
                tr("Or point clouds"),
                FILES,
                optional=True,
            ),
            tr(
                "Instead: LAS, LAZ or COPC files of one point format, an <i>ept.json</i>, or a "
                "folder of them. Each is read once, a million points at a time."
            ),
        )

    def add_reading_parameters(self) -> None:
        """Declare what is taken of the inputs."""
        self.add(
            QgsProcessingParameterNumber("BAND", tr("Band"), WHOLE_NUMBER, 1, minValue=1),
            tr("Of the DEMs: the band with the elevations."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterString("CLASSES", tr("Classes"), optional=True),
            tr(
                "Of the point clouds: only points of these ASPRS classes, separated by commas. "
                "Empty for all points."
            ),
        )
        self.add(
            QgsProcessingParameterString("ATTRIBUTES", tr("Attributes"), optional=True),
            tr(
                "Of the point clouds: names of dimensions that are transformed along with the "
                "elevation, separated by commas, such as intensity. All others come back, too."
            ),
            advanced=True,
        )
        add_kept_parameters(self)
        self.add(
            QgsProcessingParameterCrs("CRS", tr("CRS of the points"), optional=True),
            tr("Instead of the CRS in the files, or where they have none."),
            advanced=True,
        )

    def refusal(self, request: Request) -> str | None:
        """Refuse inputs of both kinds, or none, and classes that are no numbers."""
        if bool(self._raster_layers(request)) == bool(self._clouds(request)):
            return tr("Give DEMs or point clouds, one of the two.")
        try:
            request.whole_numbers("CLASSES")
        except ValueError:
            return tr("Classes are numbers separated by commas, such as 2,9.")
        for path in self._clouds(request):
            if not os.path.exists(path):
                return tr("{}: there is no such file; choose a point cloud.").format(path)
        return super().refusal(request)

    def packages(self, request: Request) -> tuple[dependencies.Package, ...]:
        """Return what reading the files needs."""
        from wavelet_core.errors import WaveletError
        from wavelet_gis.io.names import files_of

        names = self._clouds(request)
        if not names:
            return ()
        with contextlib.suppress(WaveletError):  # reading them says what is wrong
            names = files_of(names)
        is_packed = any(name.lower().endswith((".laz", ".json")) for name in names)
        return dependencies.for_las(".laz" if is_packed else ".las")

    def take_layers(self, request: Request) -> None:
        """Take from the raster layers, in their own thread, what reading their files needs."""
        from ..qgis_io.raster_reader import RasterInput

        self.rasters = []
        for layer in self._raster_layers(request):
            if not isinstance(layer, QgsRasterLayer) or not layer.isValid():
                raise QgsProcessingException(self.invalidRasterError(request.parameters, "RASTERS"))
            raster = RasterInput.from_layer(layer, request.whole("BAND") or 1)
            if raster.path is None or not os.path.isfile(raster.path):
                raise QgsProcessingException(
                    tr(
                        "{}: tiles are made of raster files on this machine, and this layer is "
                        "none; export it as one."
                    ).format(raster.name)
                )
            if raster.hidden or not raster.uses_nodata:
                raise QgsProcessingException(
                    tr(
                        "{}: its properties change which values are nodata, and tiles take the "
                        "file as it is; export the layer, or take that change back."
                    ).format(raster.name)
                )
            self.rasters.append(raster)

    def plan(self, request: Request, work: Work) -> TilePlan:
        """Return how the input is cut into tiles; no more than the headers are read."""
        levels, side = request.whole("LEVELS"), request.size("TILE")
        options: dict[str, Any] = {} if levels is None else {"levels": levels}
        if self.rasters:
            if side is not None and side != int(side):
                raise QgsProcessingException(
                    tr("A tile of a DEM has a whole number of cells along its side.")
                )
            if side is not None:
                options["tile"] = int(side)
            return self._plan_of_rasters(request, work, options)
        from wavelet_gis.tiles.cloud.plan import plan_of_clouds

        crs = request.crs("CRS")
        return plan_of_clouds(
            self._clouds(request),
            tile=side,
            crs=crs.toWkt() if crs.isValid() else None,
            vertical_unit=vertical_unit(request),
            attributes=request.words("ATTRIBUTES"),
            classes=request.whole_numbers("CLASSES") or None,
            keep_noise=request.flag("KEEP_NOISE"),
            keep_withheld=request.flag("KEEP_WITHHELD"),
            duplicates=request.text("DUPLICATES") or None,
            **options,
        )

    def _plan_of_rasters(self, request: Request, work: Work, options: dict[str, Any]) -> TilePlan:
        from wavelet_gis.io.raster import CellWindow
        from wavelet_gis.io.raster.mosaic import require_alike
        from wavelet_gis.tiles.plan import plan_of_grids

        from ..qgis_io.crs_and_progress import coordinate_system
        from ..qgis_io.raster_reader import grid_of, read_window

        first, head = self.rasters[0], None
        grids, paths = [], []
        for raster in self.rasters:
            path = os.path.abspath(str(raster.path))
            cell = read_window(raster, path, CellWindow(0, 0, 1, 1), work)
            head = head or cell
            require_alike(first.name, head, raster.name, cell)
            if raster.crs != first.crs:
                raise QgsProcessingException(
                    tr("{}: its CRS is {}, that of {} is {}; reproject it.").format(
                        raster.name,
                        raster.crs.userFriendlyIdentifier(),
                        first.name,
                        first.crs.userFriendlyIdentifier(),
                    )
                )
            grids.append(grid_of(raster, path))
            paths.append(path)
        return plan_of_grids(
            paths,
            grids,
            coordinate_system(first.crs),
            vertical_unit(request) or first.vertical_unit(),
            {"band": first.band, "nodata": None, "offline": False},
            **options,
        )

    def read(self, work: Work) -> Any:
        """Return a function that reads part of a raster, as `wavelet_gis.io.raster.read_dem`."""
        from wavelet_gis.crs.frame import Georeference
        from wavelet_gis.errors import InputFileError

        from ..qgis_io.raster_reader import read_window

        of_path = {os.path.abspath(str(raster.path)): raster for raster in self.rasters}

        def read(path: str, *, window: CellWindow, **options: Any) -> tuple[Dem, Georeference]:
            try:
                return read_window(of_path[path], path, window, work), Georeference(None, None)
            except QgsProcessingException as error:  # that tile is set aside, the others are made
                raise InputFileError(str(error)) from error

        return read

    def _raster_layers(self, request: Request) -> list[Any]:
        if not request.has("RASTERS"):
            return []
        return self.parameterAsLayerList(request.parameters, "RASTERS", request.context)

    def _clouds(self, request: Request) -> list[str]:
        if not request.has("CLOUDS"):
            return []
        files = self.parameterAsFileList(request.parameters, "CLOUDS", request.context)
        return [file for file in files if file]


def crs_of_plan(plan: TilePlan) -> QgsCoordinateReferenceSystem:
    """Return the CRS of a tile set; an invalid one where it has none."""
    wkt = plan.coordinate_system.wkt
    return QgsCoordinateReferenceSystem.fromWkt(wkt) if wkt else QgsCoordinateReferenceSystem()
