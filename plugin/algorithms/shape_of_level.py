"""Slope, aspect, curvatures and landforms of a level of a pyramid, and heights above it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from qgis.core import QgsProcessingParameterNumber, QgsProcessingParameterRasterDestination

from ..base import Values
from ..parameters.choices import choice
from ..parameters.pyramid import checked_level, crs_of
from ..parameters.request import Request
from ..parameters.surface_output import add_cell_size_parameter
from ..ui.enums import REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.products.vertex_raster import Bands
    from wavelet_gis.workflows.details import Details, Fit, Quantity

    from ..qgis_io.background import Work

#: The band of `wavelet_gis.details` that each output is.
BANDS = {
    "SLOPE": "slope",
    "ASPECT": "aspect",
    "PROFILE_CURVATURE": "profile",
    "TANGENTIAL_CURVATURE": "tangential",
    "MEAN_CURVATURE": "mean",
}
#: What quadratics are fitted to, those of `wavelet_gis.workflows.details`.
FITS = ("windows", "surface")
#: What each of the other outputs is.
OTHERS: dict[str, Quantity] = {"LANDFORMS": "landforms", "RESIDUAL": "residual"}


class ShapeOfLevel(PyramidAlgorithm):
    """Pyramid to slope, aspect and curvature."""

    GROUP = "readoff"
    PAGE = "details"

    def name(self) -> str:
        """Return the public id."""
        return "shapeoflevel"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Slope, aspect and curvature of level")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("The shape of the terrain at the scale of one level of a pyramid, as rasters")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "slope,aspect,curvature,profile curvature,plan curvature,tangential,geomorphometry,"
            "landform,ridge,channel,peak,pit,pass,residual topography,topographic position,"
            "terrain analysis,derivatives,scale,level,pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "A landform has a size: the slope of a hill is not that of its furrows. This gives "
            "slope, aspect, curvature and landforms of one level, each as smooth as "
            "the level, and how high places are above their surroundings. For levels that are of "
            "one size on the ground analyse with the partition <i>random</i> and the prediction "
            "<i>plane</i>."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVEL")
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, None, True, 0),
            tr(
                "0 is the coarsest. Empty for the input itself, and for residual topography the "
                "coarsest."
            ),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LEVEL_METRES", tr("Or distance on the ground"), REAL_NUMBER, None, True, 0.0
            ),
            tr(
                "Instead of a level: that whose vertices are so far apart, or the nearest, in "
                "metres where the CRS states its unit."
            ),
        )
        self.add(
            choice("FIT", tr("Shape fitted to"), FITS),
            tr(
                "<i>windows</i>: to all that lies within windows two and a half spacings of the "
                "level wide, as raster programs do it; <i>surface</i>: to the surface of the "
                "level at its vertices, as <i>Extract level</i> writes it."
            ),
        )
        add_cell_size_parameter(self)
        for name, description, text, is_made in (
            ("SLOPE", tr("Slope"), tr("Steepest, in degrees."), True),
            (
                "ASPECT",
                tr("Aspect"),
                tr("Direction of descent, degrees clockwise from north; nothing on the flat."),
                False,
            ),
            (
                "PROFILE_CURVATURE",
                tr("Profile curvature"),
                tr("Along the descent, in one over the unit of length; convex is above 0."),
                False,
            ),
            (
                "TANGENTIAL_CURVATURE",
                tr("Tangential curvature"),
                tr("Across the descent; spurs are above 0, hollows below."),
                False,
            ),
            (
                "MEAN_CURVATURE",
                tr("Mean curvature"),
                tr("Ridges and hilltops are above 0, channels and pits below."),
                False,
            ),
            (
                "LANDFORMS",
                tr("Landforms"),
                tr(
                    "0 planar, 1 pit, 2 channel, 3 pass, 4 ridge, 5 peak, of the size of the level."
                ),
                False,
            ),
            (
                "RESIDUAL",
                tr("Residual topography"),
                tr("Height above the mean of surroundings of the size of the level."),
                False,
            ),
        ):
            self.add(
                QgsProcessingParameterRasterDestination(
                    name, description, optional=True, createByDefault=is_made
                ),
                text,
            )

    def work(self, request: Request) -> Values:
        """Measure what was asked for, write its rasters."""
        from wavelet_gis.workflows.details import details

        wanted = [name for name in (*BANDS, *OTHERS) if request.wants(name)]
        if not wanted:
            raise QgsProcessingException(tr("No output is chosen; choose a raster."))
        geo = self.geo_pyramid(request)
        level, metres = request.whole("LEVEL"), request.number("LEVEL_METRES")
        if level is not None:
            checked_level(geo, level)
        kinds: list[Quantity] = list(dict.fromkeys(OTHERS.get(name, "shape") for name in wanted))
        results: Values = {}
        for k, what in enumerate(kinds):
            start, stop = 0.05 + 0.95 * k / len(kinds), 0.05 + 0.95 * (k + 1) / len(kinds)
            begin, middle = start + 0.1 * (stop - start), start + 0.7 * (stop - start)
            chosen = None if what == "residual" else request.choice("FIT")
            fit: Fit | None = "surface" if chosen == "surface" else None
            request.stage(tr("Measuring the shape of the surface"))
            of_kind = partial(details, geo, what=what, level=level, metres=metres, fit=fit)
            found = request.computed(partial(_unwatched, of_kind), start, begin)
            if what != "residual" or len(kinds) == 1:
                request.figures = {"LEVEL": found.level}
            bands = request.computed(
                partial(_raster, found, request.size("CELL_SIZE")), begin, middle
            )
            names = [name for name in wanted if OTHERS.get(name, "shape") == what]
            for n, name in enumerate(names):
                share = (stop - middle) / len(names)
                report = request.progress(middle + n * share, middle + (n + 1) * share)
                results[name] = _write(request, geo, name, bands, report)
        return results


def _unwatched(function: Callable[[], Details], work: Work) -> Details:
    """Return what a function does that has no progress: the spacings of all levels, above all."""
    return function()


def _raster(found: Details, cell_size: float | None, work: Work) -> Bands:
    return found.raster(cell_size, work.progress)


def _write(
    request: Request, geo: GeoPyramid, name: str, bands: Bands, report: Callable[[float], bool]
) -> str:
    """Write one of the rasters; return where it is."""
    from wavelet_gis.products.vertex_raster import Bands

    from ..qgis_io.raster_writer import write_bands
    from ..ui import layer_styles as styles

    style: Callable[[Any], None] = styles.style_difference
    if name == "LANDFORMS":
        style = styles.style_landforms
    if name in BANDS:
        band = bands.names.index(BANDS[name])
        bands = Bands(bands.values[band : band + 1], (BANDS[name],), bands.geometry)
        style = partial(styles.style_shape, name=BANDS[name])
    path = request.output_layer(name)
    write_bands(path, bands, crs_of(geo), request.feedback, report)
    request.finish(name, path, style)
    return path
