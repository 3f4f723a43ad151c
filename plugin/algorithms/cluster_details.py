"""Vertices grouped by their scales, or classes learned from labelled places."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingFeatureSource,
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

from ..base import Values
from ..parameters.choices import choice, clusterings
from ..parameters.pyramid import crs_of
from ..parameters.request import Request
from ..parameters.surface_output import add_cell_size_parameter
from ..parameters.text_output import write_text_output
from ..ui import dependencies
from ..ui.enums import NUMERIC_FIELD, POINTS, POLYGONS, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.workflows.learning.cluster import Labelled

    from ..qgis_io.background import Work

TEACHERS = ("nobody: find clusters", "training areas", "classes of the LAS file")


class ClusterDetails(PyramidAlgorithm):
    """Pyramid to clusters or classes of vertices."""

    GROUP = "details"
    PAGE = "clustering"

    training: QgsProcessingFeatureSource | None

    def name(self) -> str:
        """Return the public id."""
        return "clusterdetails"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Cluster details")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Terrain grouped into clusters, or classes, by its details at each scale")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "cluster,classification,scale signature,spectrum,landform,k-means,machine learning"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Groups terrain by its scale signature: how much detail each place has at each level. "
            "Without a teacher, places that are alike form clusters, numbered from smooth to "
            "rough. With training areas, or with the classes that some points of a LAS file have, "
            "the classes are learned and predicted for the rest. Analyse with the partition "
            "<i>random</i> and the prediction <i>plane</i> for levels that mean the same scale "
            "everywhere."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            choice("LEARN_FROM", tr("Learn from"), TEACHERS),
            tr("Whether clusters are found, or classes learned, and from what."),
        )
        self._add_cluster_parameters()
        self._add_class_parameters()
        self._add_outputs()

    def _add_cluster_parameters(self) -> None:
        self.add(
            QgsProcessingParameterNumber(
                "COUNT",
                tr("Number of clusters"),
                WHOLE_NUMBER,
                None,
                optional=True,
                minValue=1,
                maxValue=254,
            ),
            tr("Empty for a number found from the data (2 to 10)."),
        )
        self.add(
            choice("METHOD", tr("Method"), clusterings()),
            tr("<i>kmeans</i>, or a <i>mixture</i> of Gaussians of different size and shape."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterString("CHANNELS", tr("Channels"), optional=True),
            tr(
                "Channels whose scales count, separated by commas: z and attributes. Empty for the "
                "geometry."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber("SEED", tr("Seed"), WHOLE_NUMBER, 0, minValue=0),
            tr("Of the random samples and starts; the same seed gives the same result."),
            advanced=True,
        )

    def _add_class_parameters(self) -> None:
        self.add(
            QgsProcessingParameterFeatureSource(
                "TRAINING",
                tr("Training areas"),
                [POLYGONS],
                optional=True,
            ),
            tr("Polygons inside which the class is known."),
        )
        self.add(
            QgsProcessingParameterField(
                "CLASS_FIELD",
                tr("Field with the class"),
                None,
                "TRAINING",
                NUMERIC_FIELD,
                optional=True,
            ),
            tr("Whole numbers from 0 to 254."),
        )
        self.add(
            QgsProcessingParameterString(
                "UNLABELLED", tr("LAS classes to predict"), "0,1", optional=True
            ),
            tr("Classes that stand for 'not known', separated by commas."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean("VALIDATE", tr("Report the accuracy"), True),
            tr(
                "Predict blocks of the map from the others, and say how many of their labels come "
                "out right. Takes several times as long."
            ),
            advanced=True,
        )

    def _add_outputs(self) -> None:
        add_cell_size_parameter(self)
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", tr("Map of clusters"), optional=True, createByDefault=True
            ),
            tr("A raster of labels; each cell has that of the nearest vertex."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "OUTPUT",
                tr("Clustered vertices"),
                POINTS,
                optional=True,
                createByDefault=False,
            ),
            tr("Every input vertex with its label and how clearly it belongs there (0 to 1)."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "SUMMARY",
                tr("Summary of the clusters"),
                tr("JSON (*.json)"),
                optional=True,
                createByDefault=False,
            ),
            tr("Size and spectrum of each cluster."),
            advanced=True,
        )
        self.addOutput(QgsProcessingOutputNumber("N_CLUSTERS", tr("Number of clusters")))
        self.addOutput(
            QgsProcessingOutputNumber("ACCURACY", tr("Accuracy in blocks left out, 0 to 1"))
        )

    def refusal(self, request: Request) -> str | None:
        """Refuse classes to be learned from nothing."""
        is_by_areas = _teacher(request) == TEACHERS[1]
        if is_by_areas and not (request.has("TRAINING") and request.has("CLASS_FIELD")):
            return tr("Choose the layer of training areas and its field of classes.")
        try:
            request.whole_numbers("UNLABELLED")
        except ValueError:
            return tr("LAS classes are numbers separated by commas, such as 0,1.")
        return super().refusal(request)

    def packages(self, request: Request) -> tuple[dependencies.Package, ...]:
        """Return scikit-learn where classes are to be learned."""
        return (dependencies.SCIKIT_LEARN,) if _teacher(request) != TEACHERS[0] else ()

    def take_layers(self, request: Request) -> None:
        """Take the training areas, in the thread that their layer lives in."""
        self.training = request.source("TRAINING")

    def work(self, request: Request) -> Values:
        """Find or learn the labels, then write what was asked for."""
        geo = self.geo_pyramid(request)
        is_learned = _teacher(request) != TEACHERS[0]
        labelled = self._classes(request, geo) if is_learned else self._clusters(request, geo)
        summary = request.computed(lambda work: labelled.summary(work.progress), 0.5, 0.62)
        word = tr("class") if is_learned else tr("cluster")
        for row in summary["clusters"]:
            request.say(f"{word} {row['label']}: {row['n_vertices']} ({100 * row['share']:.1f} %)")
        results: Values = {"N_CLUSTERS": len(summary["clusters"])}
        if labelled.validation is not None:
            results["ACCURACY"] = labelled.validation.accuracy
        results.update(_written(request, labelled))
        results.update(write_text_output(request, "SUMMARY", lambda: json.dumps(summary, indent=1)))
        return results

    def _clusters(self, request: Request, geo: GeoPyramid) -> Labelled:
        from wavelet_gis.workflows.learning.cluster import cluster

        request.stage(tr("Gathering the spectrum of each vertex, and clustering"))
        count, seed = request.whole("COUNT"), request.whole("SEED") or 0
        method = request.text("METHOD")
        channels = request.words("CHANNELS")

        def compute(work: Work) -> Labelled:
            return cluster(
                geo,
                count=count,
                method=method,
                channels=channels,
                seed=seed,
                progress=work.progress,
            )

        return request.computed(compute, 0.05, 0.5)

    def _classes(self, request: Request, geo: GeoPyramid) -> Labelled:
        from wavelet_gis.workflows.learning.cluster import classify

        given = self._given(request, geo)
        request.stage(tr("Gathering the spectrum of each vertex, and learning the classes"))
        is_las = _teacher(request) == TEACHERS[2]
        unlabelled, seed = request.whole_numbers("UNLABELLED"), request.whole("SEED") or 0
        validate = request.flag("VALIDATE")

        def compute(work: Work) -> Labelled:
            return classify(
                geo,
                given,
                is_las=is_las,
                unlabelled=unlabelled,
                validate=validate,
                seed=seed,
                progress=work.progress,
            )

        return request.computed(compute, 0.12, 0.5)

    def _given(self, request: Request, geo: GeoPyramid) -> NDArray[np.int64]:
        """Return the classes that are known, below 0 where they are not."""
        if _teacher(request) == TEACHERS[2]:
            from wavelet_gis.workflows.learning.labels import labels_from_las

            return labels_from_las(geo, request.whole_numbers("UNLABELLED"))
        from ..qgis_io.training import labels_inside

        assert self.training is not None
        given = labels_inside(
            self.training,
            request.text("CLASS_FIELD"),
            request.computed(
                lambda work: geo.frame.to_file(geo.pyramid.synthesise().vertices), 0.05, 0.12
            ),
            crs_of(geo),
            request.transforms,
            request.feedback,
        )
        if (given < 0).all():
            raise QgsProcessingException(
                tr("No vertex is inside a training area; check that the layers overlap.")
            )
        return given


def _written(request: Request, labelled: Labelled) -> Values:
    from ..parameters import tin_output
    from ..qgis_io.raster_writer import write_bands
    from ..ui import layer_styles as styles

    results: Values = {}
    path = request.output_layer("RASTER")
    if path:
        cell_size = request.size("CELL_SIZE")
        bands = request.computed(lambda work: labelled.raster(cell_size, work.progress), 0.62, 0.76)
        report = request.progress(0.76, 0.82)
        write_bands(path, bands, crs_of(labelled.geo), request.feedback, report)
        request.finish("RASTER", path, partial(styles.style_labels, name=labelled.name))
        results["RASTER"] = path
    if request.wants("OUTPUT"):
        layer = request.computed(lambda work: labelled.layer(), 0.82, 0.85)
        results["OUTPUT"] = tin_output.write_layer(request, "OUTPUT", labelled.geo, layer)
    return results


def _teacher(request: Request) -> str:
    return request.text("LEARN_FROM") or TEACHERS[0]
