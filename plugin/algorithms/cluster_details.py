"""Vertices grouped by their scales, or classes learned from labelled places."""

from __future__ import annotations

import json
from functools import partial

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterString,
)

from ..parameters.analysis_options import DOUBLE, INTEGER, choice
from ..ui import dependencies
from ._pyramid_input import PyramidAlgorithm

METHODS = ("kmeans", "mixture")
TEACHERS = ("nobody: find clusters", "training areas", "classes of the LAS file")


class ClusterDetails(PyramidAlgorithm):
    """Pyramid to clusters or classes of vertices."""

    GROUP = "details"
    PACKAGES = (dependencies.SCIKIT_LEARN,)

    def name(self):
        """Return the public id."""
        return "clusterdetails"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Cluster details")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr(
            "cluster,classification,scale signature,spectrum,landform,k-means,machine learning"
        ).split(",")

    def about(self):
        """Return what it does."""
        return self.tr(
            "Groups terrain by its scale signature: how much detail each place has at each level. "
            "Without a teacher, places that are alike form clusters, numbered from smooth to "
            "rough. With training areas, or with the classes that some points of a LAS file have, "
            "the classes are learned and predicted for the rest. Analyse with the partition "
            "<i>random</i> and the prediction <i>plane</i> for levels that mean the same scale "
            "everywhere."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            choice("LEARN_FROM", self.tr("Learn from"), TEACHERS),
            self.tr("Whether clusters are found, or classes learned, and from what."),
        )
        self._add_cluster_parameters()
        self._add_class_parameters()
        self._add_outputs()

    def _add_cluster_parameters(self):
        self.add(
            QgsProcessingParameterNumber(
                "COUNT",
                self.tr("Number of clusters"),
                INTEGER,
                None,
                optional=True,
                minValue=1,
                maxValue=254,
            ),
            self.tr("Empty for a number found from the data (2 to 10)."),
        )
        self.add(
            choice("METHOD", self.tr("Method"), METHODS),
            self.tr("<i>kmeans</i>, or a <i>mixture</i> of Gaussians of different size and shape."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterString("CHANNELS", self.tr("Channels"), optional=True),
            self.tr(
                "Channels whose scales count, separated by commas: z and attributes. Empty for the "
                "geometry."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber("SEED", self.tr("Seed"), INTEGER, 0, minValue=0),
            self.tr("Of samples and starts; the same seed gives the same result."),
            advanced=True,
        )

    def _add_class_parameters(self):
        self.add(
            QgsProcessingParameterFeatureSource(
                "TRAINING",
                self.tr("Training areas"),
                [QgsProcessing.SourceType.TypeVectorPolygon],
                optional=True,
            ),
            self.tr("Polygons inside which the class is known."),
        )
        self.add(
            QgsProcessingParameterField(
                "CLASS_FIELD",
                self.tr("Field with the class"),
                None,
                "TRAINING",
                QgsProcessingParameterField.DataType.Numeric,
                optional=True,
            ),
            self.tr("Whole numbers from 0 to 254."),
        )
        self.add(
            QgsProcessingParameterString(
                "UNLABELLED", self.tr("LAS classes to predict"), "0,1", optional=True
            ),
            self.tr("Classes that stand for 'not known', separated by commas."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean("VALIDATE", self.tr("Tell the accuracy"), True),
            self.tr(
                "Predict blocks of the map from the others, and tell how many of their labels come "
                "out right. Takes several times as long."
            ),
            advanced=True,
        )

    def _add_outputs(self):
        self.add(
            QgsProcessingParameterNumber(
                "CELL_SIZE",
                self.tr("Cell size of the raster"),
                DOUBLE,
                None,
                optional=True,
                minValue=0.0,
            ),
            self.tr(
                "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
                "from, and for points their mean spacing."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", self.tr("Map of clusters"), optional=True, createByDefault=True
            ),
            self.tr("A raster of labels; each cell has that of the nearest vertex."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "OUTPUT",
                self.tr("Clustered vertices"),
                QgsProcessing.SourceType.TypeVectorPoint,
                optional=True,
                createByDefault=False,
            ),
            self.tr("Every input vertex with its label and how clearly it belongs there (0 to 1)."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "SUMMARY",
                self.tr("Summary of the clusters"),
                self.tr("JSON (*.json)"),
                optional=True,
                createByDefault=False,
            ),
            self.tr("Size and spectrum of each cluster."),
            advanced=True,
        )
        self.addOutput(QgsProcessingOutputNumber("N_CLUSTERS", self.tr("Number of clusters")))
        self.addOutput(
            QgsProcessingOutputNumber("ACCURACY", self.tr("Accuracy in blocks left out, 0 to 1"))
        )

    def checkParameterValues(self, parameters, context):
        """Refuse classes to be learned from nothing."""
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return is_fine, message
        if self._teacher(parameters, context) == TEACHERS[1] and not (
            parameters.get("TRAINING") and parameters.get("CLASS_FIELD")
        ):
            return False, self.tr("Choose the layer of training areas and its field of classes.")
        try:
            self._unlabelled(parameters, context)
        except ValueError:
            return False, self.tr("LAS classes are numbers separated by commas, such as 0,1.")
        return True, ""

    def prepare(self, parameters, context, feedback):
        """Take the training areas, in the thread that their layer lives in."""
        self.training = self.parameterAsSource(parameters, "TRAINING", context)

    def work(self, parameters, context, feedback):
        """Find or learn the labels, then write what was asked for."""
        from wavelet_gis.workflows.classify import cluster_summary

        geo = self.geo_pyramid(parameters, context, feedback)
        is_learned = self._teacher(parameters, context) != TEACHERS[0]
        find = self._classes if is_learned else self._clusters
        labels, confidence, results = find(parameters, context, geo, feedback)
        summary = cluster_summary(geo, labels)
        word = self.tr("class") if is_learned else self.tr("cluster")
        for row in summary["clusters"]:
            feedback.pushInfo(
                f"{word} {row['label']}: {row['n_vertices']} ({100 * row['share']:.1f} %)"
            )
        results["N_CLUSTERS"] = len(summary["clusters"])
        name = "class" if is_learned else "cluster"
        results.update(self._written(parameters, context, geo, labels, confidence, name, feedback))
        path = self.parameterAsFileOutput(parameters, "SUMMARY", context)
        if path:
            from wavelet_gis.io.atomic import new_file

            with new_file(path, overwrite=True) as scratch:
                scratch.write_text(json.dumps(summary, indent=1), encoding="utf-8")
            results["SUMMARY"] = path
        return results

    def _clusters(self, parameters, context, geo, feedback):
        from wavelet_core.features.signature import energy_signature
        from wavelet_gis.workflows.classify import cluster_vertices

        from ..qgis_io.crs_and_progress import progress, require_running

        text = self.parameterAsString(parameters, "CHANNELS", context)
        channels = tuple(name.strip() for name in text.split(",") if name.strip())
        feedback.setProgressText(self.tr("Gathering the spectrum of each vertex"))
        signature = energy_signature(geo.pyramid, channels, progress(feedback, 0.05, 0.5))
        feedback.setProgressText(self.tr("Clustering"))
        count = parameters.get("COUNT")
        clusters = cluster_vertices(
            signature,
            None if count is None else self.parameterAsInt(parameters, "COUNT", context),
            self.parameterAsString(parameters, "METHOD", context),
            self.parameterAsInt(parameters, "SEED", context),
            progress(feedback, 0.5, 0.8),
        )
        require_running(feedback)
        return clusters.labels, clusters.confidence, {}

    def _classes(self, parameters, context, geo, feedback):
        from wavelet_gis.workflows.learn import learn

        from ..qgis_io.crs_and_progress import progress, require_running

        given = self._given(parameters, context, geo, feedback)
        feedback.setProgressText(self.tr("Learning the classes"))
        learned = learn(
            geo,
            given,
            is_las=self._teacher(parameters, context) == TEACHERS[2],
            validate=self.parameterAsBool(parameters, "VALIDATE", context),
            seed=self.parameterAsInt(parameters, "SEED", context),
            progress=progress(feedback, 0.05, 0.8),
        )
        require_running(feedback)
        for line in learned.notes:
            feedback.pushInfo(line)
        results = {}
        if learned.validation is not None:
            results["ACCURACY"] = learned.validation.accuracy
        return learned.labels, learned.confidence, results

    def _given(self, parameters, context, geo, feedback):
        if self._teacher(parameters, context) == TEACHERS[2]:
            from wavelet_gis.workflows.labels import labels_from_las

            return labels_from_las(geo, self._unlabelled(parameters, context))
        from ..parameters.pyramid import crs_of
        from ..qgis_io.training import labels_inside

        field = self.parameterAsString(parameters, "CLASS_FIELD", context)
        positions = geo.frame.to_file(geo.pyramid.synthesise().vertices)
        given = labels_inside(
            self.training, field, positions, crs_of(geo), context.transformContext(), feedback
        )
        if (given < 0).all():
            raise QgsProcessingException(
                self.tr("No vertex is inside a training area; check that the layers overlap.")
            )
        return given

    def _written(self, parameters, context, geo, labels, confidence, name, feedback):
        from wavelet_gis.products.label_layer import label_layer
        from wavelet_gis.products.vertex_raster import label_band

        from ..parameters import tin_output
        from ..parameters.pyramid import cell_size, crs_of
        from ..qgis_io.raster_writer import write_bands
        from ..ui import layer_styles as styles

        results = {}
        path = self.parameterAsOutputLayer(parameters, "RASTER", context)
        if path:
            size = cell_size(self, parameters, context)
            bands = label_band(geo, geo.pyramid.synthesise(), labels, name, size)
            write_bands(path, bands, crs_of(geo), feedback)
            styles.style_output(context, path, styles.style_labels)
            results["RASTER"] = path
        if parameters.get("OUTPUT"):
            layer = label_layer(geo, labels, confidence, name)
            destination = tin_output.write_layer(
                self, parameters, "OUTPUT", context, geo, layer, feedback
            )
            styles.style_output(context, destination, partial(styles.apply_qml, qml=layer.style))
            results["OUTPUT"] = destination
        return results

    def _teacher(self, parameters, context):
        return self.parameterAsString(parameters, "LEARN_FROM", context) or TEACHERS[0]

    def _unlabelled(self, parameters, context):
        text = self.parameterAsString(parameters, "UNLABELLED", context)
        return tuple(int(number) for number in text.split(",") if number.strip())
