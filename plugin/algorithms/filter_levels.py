"""Noise taken out of a pyramid, or chosen scales damped, boosted or isolated."""

from __future__ import annotations

from qgis.core import (
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMatrix,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterString,
)

from ..parameters.analysis_options import DOUBLE, INTEGER, matrix_pairs
from ..parameters.restored_output import add_restored_outputs, nothing_written, write_restored
from ..ui import dependencies
from ._pyramid_input import PyramidAlgorithm


class FilterLevels(PyramidAlgorithm):
    """Pyramid to filtered pyramid and terrain."""

    GROUP = "reconstruction"

    def name(self):
        """Return the public id."""
        return "filterlevels"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Filter levels")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("denoise,smooth,sharpen,band,equaliser,filter,gain,wavelet,pyramid").split(
            ","
        )

    def about(self):
        """Return what it does."""
        return self.tr(
            "Changes chosen scales of the terrain: damps or boosts the details of each level by a "
            "gain, keeps a band of levels or of sizes on the ground, or takes out noise while "
            "banks and ridges stay. It gives the filtered pyramid and the filtered DEM, point "
            "cloud or TIN. Noise is taken out first, then gains apply."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self._add_noise_parameters()
        self._add_scale_parameters()
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT",
                self.tr("Filtered pyramid"),
                self.tr("GeoPackage (*.gpkg)"),
                optional=True,
                createByDefault=False,
            ),
            self.tr("A pyramid file like the input, with the changed details."),
        )
        add_restored_outputs(
            self,
            self.tr("Filtered DEM"),
            self.tr("Filtered point cloud"),
            self.tr("Filtered TIN"),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "DIFFERENCE",
                self.tr("Difference of the DEMs"),
                optional=True,
                createByDefault=False,
            ),
            self.tr("Filtered minus original elevation, for a pyramid of a DEM."),
        )
        for name, description in (
            ("SIGMA", self.tr("Standard deviation of the noise, in the unit of elevation")),
            ("RMS_CHANGE", self.tr("Root mean square change of elevation")),
            ("MAX_CHANGE", self.tr("Largest change of elevation")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def _add_noise_parameters(self):
        self.add(
            QgsProcessingParameterBoolean("DENOISE", self.tr("Take out noise"), False),
            self.tr("Such as that of a laser scanner."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "SIGMA_OF_NOISE",
                self.tr("Standard deviation of the noise"),
                DOUBLE,
                None,
                optional=True,
                minValue=0.0,
            ),
            self.tr("In the unit of elevation; empty to have it estimated from the finest level."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "NOISE_RANGE",
                self.tr("Range of the noise"),
                DOUBLE,
                None,
                optional=True,
                minValue=0.0,
            ),
            self.tr(
                "Distance at which the correlation of the noise has fallen to a third, in metres; "
                "empty for noise that is white."
            ),
            advanced=True,
        )
        for name, description, text in (
            (
                "FIND_RANGE",
                self.tr("Estimate the range of the noise"),
                self.tr("From how details fall off over the scales."),
            ),
            (
                "LOCAL_NOISE",
                self.tr("Noise differs by place"),
                self.tr("Measure the noise at each place, as on slopes seen by a laser scanner."),
            ),
            (
                "OUTLIERS",
                self.tr("Replace outliers"),
                self.tr("Values that stand out of their ring are replaced before all else."),
            ),
        ):
            self.add(QgsProcessingParameterBoolean(name, description, False), text, advanced=True)
        self.add(
            QgsProcessingParameterNumber(
                "PYRAMIDS", self.tr("Number of pyramids averaged"), INTEGER, 8, minValue=0
            ),
            self.tr(
                "Pyramids in random order, each denoised, whose average leaves no traces of "
                "triangles. 0 thresholds the details of a single one, which is quick."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterString("CHANNELS", self.tr("Channels"), "z", optional=True),
            self.tr("Which to take noise from, separated by commas: z and attributes."),
            advanced=True,
        )

    def _add_scale_parameters(self):
        self.add(
            QgsProcessingParameterMatrix(
                "GAINS",
                self.tr("Gains"),
                1,
                False,
                [self.tr("Level"), self.tr("Gain")],
                optional=True,
            ),
            self.tr(
                "What the details of a level are multiplied by: 0 drops them, 0.5 halves, 2 "
                "doubles. Levels that are not listed stay. Level 0 is the coarsest."
            ),
        )
        for name, description, text in (
            (
                "FIRST_LEVEL",
                self.tr("Coarsest level kept"),
                self.tr("Drop the details of coarser levels."),
            ),
            (
                "LAST_LEVEL",
                self.tr("Finest level kept"),
                self.tr("Drop the details of finer levels."),
            ),
        ):
            self.add(
                QgsProcessingParameterNumber(
                    name, description, INTEGER, None, optional=True, minValue=0
                ),
                text,
                advanced=True,
            )
        for name, description, text in (
            (
                "SMALLEST_SIZE",
                self.tr("Smallest size kept"),
                self.tr("Drop details that are smaller on the ground, in metres."),
            ),
            (
                "LARGEST_SIZE",
                self.tr("Largest size kept"),
                self.tr("Drop details that are larger on the ground, in metres."),
            ),
        ):
            self.add(
                QgsProcessingParameterNumber(
                    name, description, DOUBLE, None, optional=True, minValue=0.0
                ),
                text,
            )
        self.add(
            QgsProcessingParameterBoolean(
                "DROP_COARSE", self.tr("Leave out the coarsest surface"), False
            ),
            self.tr("So that the kept details remain by themselves, around zero."),
            advanced=True,
        )

    def checkParameterValues(self, parameters, context):
        """Refuse when there is nothing to do, or gains that are no numbers."""
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return is_fine, message
        try:
            gains = self._gains(parameters, context)
        except ValueError:
            return False, self.tr("Gains are pairs of a level and a number, such as 5 and 0.5.")
        asks = gains or self._levels(parameters, context) or self._sizes(parameters, context)
        flags = [self.parameterAsBool(parameters, n, context) for n in ("DENOISE", "DROP_COARSE")]
        if not asks and not any(flags):
            return False, self.tr(
                "Nothing would change: take out noise, list gains, or choose levels or sizes."
            )
        if self._levels(parameters, context) and self._sizes(parameters, context):
            return False, self.tr("Choose levels or sizes to keep, not both.")
        return True, ""

    def packages(self, parameters, context):
        """Return laspy where a point cloud is asked for."""
        if parameters.get("POINT_CLOUD"):
            return dependencies.for_las(str(parameters["POINT_CLOUD"]))
        return ()

    def work(self, parameters, context, feedback):
        """Filter, then write what was asked for."""
        from wavelet_gis.workflows.filtering import (
            change_between,
            chosen_gains,
            denoised_record,
            scaled_record,
        )

        from ..parameters import pyramid as pyramids
        from ..qgis_io.crs_and_progress import progress, require_running

        before = self.geo_pyramid(parameters, context, feedback)
        geo, results = before, {}
        if self.parameterAsBool(parameters, "DENOISE", context):
            feedback.setProgressText(self.tr("Taking out the noise"))
            geo, sigmas = denoised_record(
                geo,
                self._number(parameters, "SIGMA_OF_NOISE", self.parameterAsDouble, context),
                channels=self._channels(parameters, context),
                n_pyramids=self.parameterAsInt(parameters, "PYRAMIDS", context),
                noise_range=self._range(parameters, context),
                local_noise=self.parameterAsBool(parameters, "LOCAL_NOISE", context),
                outliers=self.parameterAsBool(parameters, "OUTLIERS", context),
                progress=progress(feedback, 0.05, 0.7),
            )
            results["SIGMA"] = next(iter(sigmas.values()))
        gains = chosen_gains(
            geo,
            self._gains(parameters, context),
            levels=self._level_bounds(parameters, context, geo),
            metres=self._sizes(parameters, context),
        )
        drops_coarse = self.parameterAsBool(parameters, "DROP_COARSE", context)
        if gains or drops_coarse:
            geo = scaled_record(geo, gains, drops_coarse=drops_coarse)
        require_running(feedback)
        for line in geo.history[len(before.history) :]:
            feedback.pushInfo(line)
        results["RMS_CHANGE"], results["MAX_CHANGE"] = change_between(before, geo)
        n_figures = len(results)
        finest = geo.pyramid.synthesise()
        path = self.parameterAsFileOutput(parameters, "OUTPUT", context)
        if path:
            geo = geo.with_errors(progress(feedback, 0.7, 0.75))
            pyramids.save(geo, path, feedback, 0.75, 0.85)
            results["OUTPUT"] = path
        results.update(write_restored(self, parameters, context, geo, finest, feedback))
        results.update(self._difference(parameters, context, before, geo, feedback))
        if len(results) == n_figures:
            raise nothing_written(geo.source.kind)
        return results

    def _difference(self, parameters, context, before, after, feedback):
        from wavelet_gis.products.level_raster import surface_difference

        from ..parameters.pyramid import crs_of
        from ..qgis_io.raster_writer import write_dem

        path = self.parameterAsOutputLayer(parameters, "DIFFERENCE", context)
        if not path:
            return {}
        if before.source.kind != "raster":
            raise QgsProcessingException(
                self.tr("A difference of DEMs needs a pyramid that was made from a DEM.")
            )
        write_dem(path, surface_difference(before, after), crs_of(before), feedback)
        return {"DIFFERENCE": path}

    def _gains(self, parameters, context):
        pairs = matrix_pairs(self, parameters, "GAINS", context)
        return [(int(level), float(gain)) for level, gain in pairs]

    def _levels(self, parameters, context):
        return [n for n in ("FIRST_LEVEL", "LAST_LEVEL") if parameters.get(n) is not None]

    def _level_bounds(self, parameters, context, geo):
        if not self._levels(parameters, context):
            return None
        first = self._number(parameters, "FIRST_LEVEL", self.parameterAsInt, context)
        last = self._number(parameters, "LAST_LEVEL", self.parameterAsInt, context)
        return first or 0, geo.pyramid.n_levels - 1 if last is None else last

    def _sizes(self, parameters, context):
        smallest = self._number(parameters, "SMALLEST_SIZE", self.parameterAsDouble, context)
        largest = self._number(parameters, "LARGEST_SIZE", self.parameterAsDouble, context)
        if smallest is None and largest is None:
            return None
        return smallest or 0.0, float("inf") if largest is None else largest

    def _range(self, parameters, context):
        if self.parameterAsBool(parameters, "FIND_RANGE", context):
            return "estimate"
        return self._number(parameters, "NOISE_RANGE", self.parameterAsDouble, context) or 0.0

    def _channels(self, parameters, context):
        text = self.parameterAsString(parameters, "CHANNELS", context)
        return [name.strip() for name in text.split(",") if name.strip()] or ["z"]

    def _number(self, parameters, name, read, context):
        return None if parameters.get(name) is None else read(parameters, name, context)
