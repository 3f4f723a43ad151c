"""Pyramid to labelled vertices: clusters of alike scales, or classes learned from labels."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.errors import OptionError
from wavelet_core.features.signature import energy_signature
from wavelet_core.progress import part_of, report, watched_part
from wavelet_gis.io.atomic import check_output
from wavelet_gis.io.formats import (
    CLOUD_SUFFIXES,
    PYRAMID_SUFFIX,
    RASTER_SUFFIXES,
    suffix_of,
)
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import Note
from wavelet_gis.products.label_layer import label_layer
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.vertex_raster import Bands, label_band
from wavelet_gis.workflows.learning.classification import Validation
from wavelet_gis.workflows.learning.clustering import (
    CLUSTERINGS,
    cluster_summary,
    cluster_vertices,
)
from wavelet_gis.workflows.learning.labels import UNLABELLED, cloud_with_classes, merge_labels
from wavelet_gis.workflows.learning.learn import learn
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of

__all__ = ["Labelled", "check_label_output", "classify", "cluster"]


@dataclass(frozen=True, slots=True)
class Labelled:
    """The vertices of a pyramid's input, each with a label.

    Attributes
    ----------
    geo : GeoPyramid
        The pyramid.
    labels : (n_vertices,) int64
        Below 0: none.
    confidence : (n_vertices,) float64
        How clearly a vertex has its label, 0 to 1.
    name : {"cluster", "class"}
        What a label is.
    found : dict
        How the labels were found, as JSON-able values.
    validation : Validation or None
        Of classes, where it was asked for.
    notes : tuple of Note
        What is to be said of classes: what they were not learned from, and how good they are.
    unlabelled : tuple of int, or None
        Where classes were learned from those of the points: which of these counted as not known.
    merges : tuple of (from, to)
        Classes that were counted as another.
    """

    geo: GeoPyramid
    labels: NDArray[np.int64]
    confidence: NDArray[np.float64]
    name: Literal["cluster", "class"]
    found: dict[str, Any]
    validation: Validation | None = None
    notes: tuple[Note, ...] = ()
    unlabelled: tuple[int, ...] | None = None
    merges: tuple[tuple[int, int], ...] = ()

    def summary(self, progress: Progress | None = None) -> dict[str, Any]:
        """Return size and spectrum of every label; see `cluster_summary`."""
        return cluster_summary(self.geo, self.labels, progress=progress)

    def layer(self) -> Layer:
        """Return the labelled vertices as a layer."""
        return label_layer(self.geo, self.labels, self.confidence, self.name)

    def raster(self, cell_size: float | None = None, progress: Progress | None = None) -> Bands:
        """Return the labels as a raster: each cell has that of the vertex nearest in plan.

        ``progress`` is called with a fraction in [0, 1]; the work stops when it returns False.
        """
        with watched_part(progress, 0.0, 0.5):
            mesh = self.geo.pyramid.synthesise()
        report(progress, 0.5)
        part = part_of(progress, 0.5, 1.0)
        return label_band(self.geo, mesh, self.labels, self.name, cell_size, part)

    def write(self, path: str | os.PathLike[str], *, cell_size: float | None = None) -> None:
        """Write points, a raster or, of classes, a point cloud, by the suffix.

        See `wavelet_gis.workflows.save.save`.
        """
        check_label_output(path, is_learned=self.name == "class", overwrite=True)
        suffix = suffix_of(path)
        if suffix in CLOUD_SUFFIXES:
            from wavelet_gis.io.las import write_cloud

            cloud = cloud_with_classes(self.geo, self.labels, self.unlabelled, self.merges)
            write_cloud(path, cloud)
        elif suffix in RASTER_SUFFIXES:
            from wavelet_gis.io.raster import write_bands

            write_bands(path, self.raster(cell_size), self.geo.system.wkt)
        else:
            from wavelet_gis.io.vector.vector_writer import add_layers

            add_layers(path, [self.layer()], self.geo.system)

    def figures(self) -> dict[str, Any]:
        """Return how the labels were found, their sizes and spectra, as JSON-able values."""
        validation = {} if self.validation is None else {"validation": self.validation.as_dict()}
        return {**self.found, **validation, **self.summary()}


def check_label_output(
    path: str | os.PathLike[str],
    *,
    is_learned: bool,
    overwrite: bool = False,
    inputs: tuple[str | os.PathLike[str], ...] = (),
) -> None:
    """Refuse, before the long work, an output that labels cannot be written to.

    Parameters
    ----------
    path : path
        Where they are wanted.
    is_learned : bool
        Whether they are classes; clusters are no LAS classes.
    overwrite, inputs
        See `wavelet_gis.io.atomic.check_output`.

    Raises
    ------
    OutputFileError
        See `wavelet_gis.io.atomic.check_output`.
    OptionError
        Clusters into a point cloud.
    """
    suffixes = (PYRAMID_SUFFIX, *RASTER_SUFFIXES, *CLOUD_SUFFIXES)
    check_output(path, overwrite=overwrite, suffixes=suffixes, inputs=inputs)
    if suffix_of(path) in CLOUD_SUFFIXES and not is_learned:
        raise OptionError(
            "clusters are no LAS classes; write .gpkg or .tif, or learn classes with {0}.", "learn"
        )


def cluster(
    data: HoldsPyramid | GeoPyramid,
    *,
    count: int | None = None,
    method: str | None = None,
    channels: Sequence[str] = (),
    seed: int = 0,
    progress: Progress | None = None,
) -> Labelled:
    """Return the vertices of a pyramid's input in clusters of alike scales.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    count : int, optional
        Number of clusters; by default found from the data.
    method : str, optional
        A row of `wavelet_gis.workflows.learning.clustering.CLUSTERINGS`, by default its first.
    channels : sequence of str
        Channels whose scales count; by default the geometry.
    seed : int
        Of samples and starts; the same seed gives the same clusters.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    Labelled
        Clusters are numbered from the smooth to the rough.
    """
    geo = pyramid_of(data)
    signature = energy_signature(geo.pyramid, tuple(channels), part_of(progress, 0.0, 0.5))
    clusters = cluster_vertices(signature, count, method, seed, part_of(progress, 0.5, 1.0))
    found = {
        "method": CLUSTERINGS.chosen(method).name,
        "n_clusters": clusters.n_clusters,
        "explained": clusters.explained,
    }
    return Labelled(geo, clusters.labels, clusters.confidence, "cluster", found)


def classify(
    data: HoldsPyramid | GeoPyramid,
    labels: NDArray[np.int64],
    *,
    is_las: bool = False,
    unlabelled: Sequence[int] = UNLABELLED,
    merges: Sequence[tuple[int, int]] = (),
    validate: bool = True,
    seed: int = 0,
    progress: Progress | None = None,
) -> Labelled:
    """Return the class of every vertex, learned from those that have one.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    labels : (n_vertices,) int64
        Below 0: not known; see `wavelet_gis.workflows.learning.labels`. A label that is known
        stays.
    is_las : bool
        Whether the labels are the classes of the points themselves, from `labels_from_las`: what
        holds them too, such as the lifted class, is then not learned from, and points that have
        a class keep it.
    unlabelled : sequence of int
        Classes of the points that counted as not known there.
    merges : sequence of (from, to)
        Classes to be counted as another.
    validate : bool
        Whether blocks of the map are predicted from the others, to say how well that goes.
    seed : int
        Of samples.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    Labelled
        Without a validation where the labels are in too few places for one.

    Raises
    ------
    OptionError
        Fewer than two classes among the labels.
    """
    geo = pyramid_of(data)
    given = merge_labels(labels, merges)
    learned = learn(geo, given, is_las=is_las, validate=validate, seed=seed, progress=progress)
    found = {"n_labelled": learned.n_labelled, "left_out": list(learned.left_out)}
    return Labelled(
        geo,
        learned.labels,
        learned.confidence,
        "class",
        found,
        learned.validation,
        learned.notes,
        tuple(unlabelled) if is_las else None,
        tuple(merges),
    )
