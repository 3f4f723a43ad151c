"""The parameter by which algorithms take a pyramid, and its reading."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from qgis.core import QgsProcessingParameterFile

from ..base import TerrainWaveletsAlgorithm
from ..parameters.request import Request
from ..ui.file_metadata import file_widget
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid

    from ..qgis_io.background import Work

#: Part of the bar in which a pyramid is read: without numba that is most of the work of many.
READING = 0.3


class PyramidAlgorithm(TerrainWaveletsAlgorithm):
    """Base of the algorithms that read a pyramid file."""

    def add_pyramid_parameter(self, level: str = "") -> None:
        """Declare INPUT.

        Parameters
        ----------
        level : str, optional
            The parameter that takes a level: its dialog shows the levels of the chosen pyramid.
        """
        parameter = QgsProcessingParameterFile(
            "INPUT", tr("Pyramid"), extension="gpkg", fileFilter=tr("Pyramid (*.gpkg)")
        )
        parameter.setMetadata(file_widget("PyramidWrapper", level=level))
        self.add(
            parameter,
            tr(
                "GeoPackage that one of the analyses made. Those of this session, temporary ones "
                "too, and those with a layer in the project are in the list."
            ),
        )

    def refusal(self, request: Request) -> str | None:
        """Refuse a file that is not there, or levels that are no numbers, before the start."""
        path = request.input_file("INPUT")
        if not os.path.isfile(path):
            return tr("{}: there is no such file; choose a pyramid.").format(path)
        if self.parameterDefinition("LEVELS") is not None:
            try:
                request.whole_numbers("LEVELS")
            except ValueError:
                return tr("Levels are numbers separated by commas, such as 0,4,8.")
        return None

    def geo_pyramid(
        self,
        request: Request,
        level: int | None = None,
        *,
        only_input: bool = False,
        reading: float = READING,
    ) -> GeoPyramid:
        """Return the pyramid in the file, or no more of it than has a level, or gives the input.

        It takes the first `reading` of the bar.
        """
        from wavelet_gis.io.pyramid.pyramid_file import read_input
        from wavelet_gis.workflows.open import load

        request.stage(tr("Reading the pyramid"))
        # A layer of the file may have been handed on by a model: 'file.gpkg|layername=coarse_tin'.
        path = request.input_file("INPUT")

        def read(work: Work) -> GeoPyramid:
            if only_input:
                return read_input(path, work.progress)
            return load(path, level=level, progress=work.progress).geo

        geo = request.computed(read, 0.0, reading)
        request.begins_at(0.05)
        for line in geo.history:
            request.say(tr("Changed since its analysis: {}").format(line))
        return geo
