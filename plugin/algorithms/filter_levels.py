"""Noise removed from a pyramid, or chosen scales damped, boosted or isolated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMatrix,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterString,
)

from ..base import Values
from ..parameters.choices import choice
from ..parameters.pyramid import add_map_parameter, crs_of, save
from ..parameters.request import Request
from ..parameters.restored_output import (
    add_restored_outputs,
    nothing_written,
    restored_packages,
    write_restored,
)
from ..ui.enums import REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import READING, PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.workflows.filtering import Filtered

    from ..qgis_io.background import Work
    from ..ui.dependencies import Package

#: Part of the bar in which a pyramid is read before its noise is removed, which takes far longer.
READING_BEFORE_DENOISING = 0.1
#: Where filtering ends on the bar, its figures, and measuring and writing the pyramid where one is
#: wanted. Noise takes so long that little is left for the rest.
FILTERED, AND_WRITTEN = (0.72, 0.85, 0.85, 0.85), (0.6, 0.7, 0.75, 0.85)
DENOISED, DENOISED_AND_WRITTEN = (0.92, 0.93, 0.93, 0.93), (0.84, 0.85, 0.88, 0.94)


class FilterLevels(PyramidAlgorithm):
    """Pyramid to filtered pyramid and terrain."""

    GROUP = "reconstruction"
    PAGE = "filtering"

    def name(self) -> str:
        """Return the public id."""
        return "filterlevels"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Filter levels")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Noise removed from a pyramid, or chosen scales damped, boosted or isolated")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "denoise,smooth,sharpen,generalise,generalize,band,equaliser,filter,gain,wavelet,pyramid"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Changes chosen scales of the terrain: damps or boosts the details of each level by a "
            "gain, keeps a band of levels or of sizes on the ground, or removes noise while "
            "banks and ridges stay. It gives the filtered pyramid and the filtered DEM, point "
            "cloud or TIN. Noise is removed first, then gains apply."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self._add_noise_parameters()
        self._add_scale_parameters()
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT",
                tr("Filtered pyramid"),
                tr("GeoPackage (*.gpkg)"),
                optional=True,
                createByDefault=False,
            ),
            tr("A pyramid file like the input, with the changed details."),
        )
        add_map_parameter(self)
        self.add(
            choice("LOOK", tr("The DEM opens as"), ("hillshade", "difference")),
            tr(
                "<i>difference</i> for a pyramid that was made from a difference of DEMs: red is "
                "above zero, blue below."
            ),
            advanced=True,
        )
        add_restored_outputs(
            self,
            tr("Filtered DEM"),
            tr("Filtered point cloud"),
            tr("Filtered TIN"),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "DIFFERENCE",
                tr("Difference of the DEMs"),
                optional=True,
                createByDefault=False,
            ),
            tr("Filtered minus original elevation, for a pyramid of a DEM."),
        )
        for name, description in (
            ("SIGMA", tr("Standard deviation of the noise, in the unit of elevation")),
            ("RMS_CHANGE", tr("Root mean square change of elevation")),
            ("MAX_CHANGE", tr("Largest change of elevation")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def _add_noise_parameters(self) -> None:
        self.add(
            QgsProcessingParameterBoolean("DENOISE", tr("Remove noise"), False),
            tr("Such as that of a laser scanner. Done too where nothing else is chosen below."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "SIGMA_OF_NOISE",
                tr("Standard deviation of the noise"),
                REAL_NUMBER,
                None,
                optional=True,
                minValue=0.0,
            ),
            tr("In the unit of elevation; empty to have it estimated from the finest level."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "NOISE_RANGE",
                tr("Range of the noise"),
                REAL_NUMBER,
                None,
                optional=True,
                minValue=0.0,
            ),
            tr(
                "Distance at which the correlation of the noise has fallen to a third, in metres; "
                "empty for noise that is white."
            ),
            advanced=True,
        )
        for name, description, text in (
            (
                "FIND_RANGE",
                tr("Estimate the range of the noise"),
                tr("From how details fall off over the scales."),
            ),
            (
                "LOCAL_NOISE",
                tr("Noise differs by place"),
                tr("Measure the noise at each place, as on slopes seen by a laser scanner."),
            ),
            (
                "OUTLIERS",
                tr("Replace outliers"),
                tr("Values that stand out of their ring are replaced before all else."),
            ),
        ):
            self.add(QgsProcessingParameterBoolean(name, description, False), text, advanced=True)
        self.add(
            choice("STRIPES", tr("Stripes along"), ("none", "rows", "columns", "point_source_id")),
            tr(
                "Take out an offset for each row or column of a DEM, or for each flight line "
                "(<i>point_source_id</i>) of a point cloud."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber(
                "PYRAMIDS", tr("Number of pyramids averaged"), WHOLE_NUMBER, 4, minValue=0
            ),
            tr(
                "Pyramids in random order, each denoised, whose average leaves no traces of "
                "triangles. 0 thresholds the details of a single one, which is quick."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterString("CHANNELS", tr("Channels"), "z", optional=True),
            tr("Channels to remove noise from, separated by commas: z and attributes."),
            advanced=True,
        )

    def _add_scale_parameters(self) -> None:
        self.add(
            QgsProcessingParameterMatrix(
                "GAINS",
                tr("Gains"),
                1,
                False,
                [tr("Level"), tr("Gain")],
                optional=True,
            ),
            tr(
                "What the details of a level are multiplied by: 0 drops them, 0.5 halves, 2 "
                "doubles. Levels that are not listed stay. Level 0 is the coarsest."
            ),
        )
        for name, description, text in (
            (
                "FIRST_LEVEL",
                tr("Coarsest level kept"),
                tr("Drop the details of coarser levels."),
            ),
            (
                "LAST_LEVEL",
                tr("Finest level kept"),
                tr("Drop the details of finer levels."),
            ),
        ):
            self.add(
                QgsProcessingParameterNumber(
                    name, description, WHOLE_NUMBER, None, optional=True, minValue=0
                ),
                text,
                advanced=True,
            )
        for name, description, text in (
            (
                "SMALLEST_SIZE",
                tr("Smallest size kept"),
                tr(
                    "Drop details that are smaller on the ground, in the unit of x and y, or "
                    "metres for a geographic CRS. The pyramid may be of any kind."
                ),
            ),
            (
                "LARGEST_SIZE",
                tr("Largest size kept"),
                tr("Drop details that are larger on the ground, in the same unit."),
            ),
        ):
            self.add(
                QgsProcessingParameterNumber(
                    name, description, REAL_NUMBER, None, optional=True, minValue=0.0
                ),
                text,
            )
        self.add(
            QgsProcessingParameterBoolean(
                "DROP_COARSE", tr("Leave out the coarsest surface"), False
            ),
            tr("So that the kept details remain by themselves, around zero."),
            advanced=True,
        )

    def refusal(self, request: Request) -> str | None:
        """Refuse gains that are no numbers, and levels beside sizes."""
        missing = super().refusal(request)
        if missing:
            return missing
        try:
            _gains(request)
        except ValueError:
            return tr("Gains are pairs of a level and a number, such as 5 and 0.5.")
        levels = request.has("FIRST_LEVEL") or request.has("LAST_LEVEL")
        if levels and _sizes(request):
            return tr("Choose levels or sizes to keep, not both.")
        return None

    def packages(self, request: Request) -> tuple[Package, ...]:
        """Return laspy where a point cloud is asked for."""
        return restored_packages(request)

    def work(self, request: Request) -> Values:
        """Filter, then write what was asked for."""
        from wavelet_gis.workflows.filtering import filter_pyramid

        reading = READING_BEFORE_DENOISING if request.flag("DENOISE") else READING
        before = self.geo_pyramid(request, reading=reading)
        sigma = request.number("SIGMA_OF_NOISE")
        request.stage(tr("Filtering"))
        gains, levels = _gains(request), _levels(request, before)
        sizes, metre = _sizes(request), before.system.horizontal_unit
        if before.system.kind == "geographic":
            metre = 1.0
        metres = None if sizes is None else (sizes[0] * metre, sizes[1] * metre)
        drop_coarse, denoise = request.flag("DROP_COARSE"), request.flag("DENOISE")
        if not (gains or levels or metres or drop_coarse or denoise):
            denoise = True
            request.say(tr("Nothing is chosen to be changed, so noise is removed."))
        n_pyramids = (request.whole("PYRAMIDS") or 0) if denoise else None
        channels = (request.words("CHANNELS") or ["z"]) if denoise else None
        noise_range = _range(request)
        local_noise, outliers = request.flag("LOCAL_NOISE"), request.flag("OUTLIERS")
        stripes = request.text("STRIPES")

        def compute(work: Work) -> Filtered:
            return filter_pyramid(
                before,
                gains=gains,
                levels=levels,
                metres=metres,
                drop_coarse=drop_coarse,
                denoise=denoise and (True if sigma is None else sigma),
                n_pyramids=n_pyramids,
                channels=channels,
                noise_range=noise_range,
                local_noise=local_noise,
                outliers=outliers,
                stripes=None if stripes == "none" else stripes,
                progress=work.progress,
            )

        path = request.output_file("OUTPUT")
        parts = (DENOISED, DENOISED_AND_WRITTEN) if n_pyramids else (FILTERED, AND_WRITTEN)
        end, told, measured, written = parts[bool(path)]
        filtered = request.computed(compute, 0.05, end)
        for line in filtered.changes:
            request.say(line)
        request.figures = request.computed(lambda work: _figures(filtered), end, told)
        results: Values = {}
        if path:
            request.stage(tr("Measuring the errors of every level"))
            geo = request.computed(
                lambda work: filtered.geo.with_errors(work.progress, filtered.finest),
                told,
                measured,
            )
            save(request, geo, path, measured, written)
            results["OUTPUT"] = path
        restored = request.computed(lambda work: filtered.restored(), 0.85, 0.9)
        results.update(write_restored(request, restored))
        results.update(self._difference(request, filtered))
        if not results:
            raise nothing_written(before)
        return {**request.figures, **results}

    def _difference(self, request: Request, filtered: Filtered) -> Values:
        from ..qgis_io.raster_writer import write_dem
        from ..ui import layer_styles as styles

        path = request.output_layer("DIFFERENCE")
        if not path:
            return {}
        if filtered.before.origin.grid is None:
            raise QgsProcessingException(
                tr("A difference of DEMs needs a pyramid that was made from a DEM.")
            )
        difference = request.computed(lambda work: filtered.difference(), 0.95, 0.98)
        crs, report = crs_of(filtered.before), request.progress(0.98)
        write_dem(path, difference, crs, request.feedback, report)
        request.finish("DIFFERENCE", path, styles.style_difference)
        return {"DIFFERENCE": path}


def _figures(filtered: Filtered) -> Values:
    """Return how much changed, and the noise that was taken out of the first channel."""
    rms, largest = filtered.change()
    sigma = next(iter(filtered.sigmas.values()), None)
    return {
        **({} if sigma is None else {"SIGMA": sigma}),
        "RMS_CHANGE": rms,
        "MAX_CHANGE": largest,
    }


def _gains(request: Request) -> list[tuple[int, float]]:
    return [(int(level), float(gain)) for level, gain in request.pairs("GAINS")]


def _range(request: Request) -> float | Literal["estimate"]:
    """Return the range of the noise in metres, or that it is to be estimated; 0 for white noise."""
    return "estimate" if request.flag("FIND_RANGE") else request.number("NOISE_RANGE") or 0.0


def _levels(request: Request, geo: GeoPyramid) -> tuple[int, int] | None:
    """Return the coarsest and the finest level whose details are kept; None for all."""
    first, last = request.whole("FIRST_LEVEL"), request.whole("LAST_LEVEL")
    if first is None and last is None:
        return None
    return first or 0, geo.pyramid.n_levels - 1 if last is None else last


def _sizes(request: Request) -> tuple[float, float] | None:
    """Return the smallest and the largest size that is kept; None for all."""
    smallest, largest = request.number("SMALLEST_SIZE"), request.number("LARGEST_SIZE")
    if smallest is None and largest is None:
        return None
    return smallest or 0.0, float("inf") if largest is None else largest
