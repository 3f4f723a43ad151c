"""Classes learned from labelled vertices: from what, how well it works, and what is said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavelet_core import PARTITIONS, Pyramid, TriangleMesh, analyse
from wavelet_core.errors import OptionError
from wavelet_core.features.signature import Signature, plain_features, scale_features
from wavelet_core.progress import Progress, part_of
from wavelet_gis.model.attributes.categories import dimension_of
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import Note, collected, note
from wavelet_gis.workflows.learning.classification import (
    Validation,
    learn_classes,
    spatial_folds,
    validate_classes,
)

__all__ = ["Learned", "answers_among", "features_without", "learn"]

IntArray = NDArray[np.int64]

#: What is computed from the classes of a LAS file: heights above its ground points.
DERIVED_FROM_CLASSES = ("hag", "heightaboveground", "height_above_ground")

#: An attribute of at most so many values of which this share goes with one class each is the
#: label under another name.
MAX_VALUES_OF_COPY, PURITY_OF_COPY = 256, 0.999

#: Options of an analysis that only one partition takes.
_OWN_OPTIONS = {name: row.name for row in PARTITIONS.values() for name in row.options}


@dataclass(frozen=True, slots=True)
class Learned:
    """Classes of all vertices, and what is to be said of them.

    Attributes
    ----------
    labels : (n_vertices,) int64
        The given label where there is one, else the predicted class.
    confidence : (n_vertices,) float64
        1 where the label was given, else the model's probability.
    n_labelled : int
        Vertices that were learned from.
    left_out : tuple of str
        Attributes that hold the answer, and so were not looked at.
    validation : Validation or None
        How well blocks of the map are predicted from the others; None if it was not asked for,
        or the labels are too few places for it.
    notes : tuple of Note
        What is to be said of it.
    """

    labels: IntArray
    confidence: NDArray[np.float64]
    n_labelled: int
    left_out: tuple[str, ...]
    validation: Validation | None
    notes: tuple[Note, ...]


def learn(
    geo: GeoPyramid,
    given: IntArray,
    *,
    is_las: bool,
    validate: bool = True,
    seed: int = 0,
    progress: Progress | None = None,
) -> Learned:
    """Return the class of every vertex, learned from those that have a label.

    Parameters
    ----------
    geo : GeoPyramid
        Whose vertices.
    given : (n_vertices,) int64
        Labels; below 0: not known.
    is_las : bool
        Whether the labels are the classes of the points, which attributes may hold too.
    validate : bool
        Predict blocks of the map from the others, too, and report how well that works.
    seed : int
        Of samples.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        Fewer than two classes among the labels.
    """
    with collected() as notes:
        left_out = answers_among(geo, given) if is_las else ()
        if left_out:
            note(
                "not_learned_from",
                "not learned from {names}, which hold the class itself or come from it",
                names=", ".join(left_out),
            )
        features = features_without(geo.pyramid, left_out, part_of(progress, 0.0, 0.6))
        validation = None
        if validate:
            validation = _validated(geo, features, given, seed, part_of(progress, 0.6, 0.75))
    classes = learn_classes(features, given, seed, part_of(progress, 0.75, 1.0))
    is_given = given >= 0
    return Learned(
        np.where(is_given, given, classes.predicted),
        np.where(is_given, 1.0, classes.confidence),
        int(np.count_nonzero(is_given)),
        left_out,
        validation,
        tuple(notes),
    )


def answers_among(geo: GeoPyramid, given: IntArray) -> tuple[str, ...]:
    """Return the attributes that hold the classes of the points, or were derived from them.

    Parameters
    ----------
    geo : GeoPyramid
        Of a point cloud.
    given : (n_vertices,) int64
        The classes; below 0: not known.

    Notes
    -----
    These are the classification, also as channels, heights above the ground, which are measured
    from the points of class 2, and any attribute of few whole numbers that go with one class each:
    a copy of the classes in an extra dimension.
    """
    points = geo.origin.points
    lifted = () if points is None else points.cloud.attributes
    dimensions = {attribute.name: dimension_of(attribute).lower() for attribute in lifted}
    mesh = geo.pyramid.synthesise()
    found = []
    for name, values in zip(mesh.attribute_names, mesh.attributes.T, strict=True):
        dimension = dimensions.get(name, name.lower())
        is_answer = dimension == "classification" or dimension in DERIVED_FROM_CLASSES
        if is_answer or _is_copy(values, given):
            found.append(name)
    return tuple(found)


def features_without(
    pyramid: Pyramid, left_out: Sequence[str] = (), progress: Progress | None = None
) -> Signature:
    """Return scale and plain features in which some attributes have no part.

    Parameters
    ----------
    pyramid : Pyramid
    left_out : sequence of str
        Attributes. The levels are made anew without them: which vertex goes first, and from what
        it is predicted, may have followed their values.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    start = 0.0
    if left_out:
        pyramid = _analysed_without(pyramid, left_out, part_of(progress, 0.0, 0.3))
        start = 0.3
    scales = scale_features(pyramid, part_of(progress, start, 0.65))
    return scales.joined_to(plain_features(pyramid))


def _analysed_without(
    pyramid: Pyramid, left_out: Sequence[str], progress: Progress | None
) -> Pyramid:
    mesh = pyramid.synthesise()
    kept = [k for k, name in enumerate(mesh.attribute_names) if name not in left_out]
    bare = TriangleMesh(
        mesh.vertices,
        mesh.faces,
        mesh.attributes[:, kept],
        tuple(mesh.attribute_names[k] for k in kept),
    )
    options = {
        name: value
        for name, value in pyramid.parameters.items()
        if value is not None
        and _OWN_OPTIONS.get(name) in (None, pyramid.parameters.get("partition"))
        and name not in ("target_vertices", "max_error", "max_rms")
    }
    weights = options.pop("attribute_weights", None)
    if weights:
        options["attribute_weights"] = [weights[k] for k in kept]
    options["levels"] = pyramid.n_levels
    return analyse(bare, locked=pyramid.locked, progress=progress, **options)


def _is_copy(values: NDArray[np.float64], given: IntArray) -> bool:
    known = given >= 0
    numbers = np.rint(values[known])
    if not np.allclose(numbers, values[known], rtol=0.0, atol=1e-6):
        return False
    names, value_of = np.unique(numbers, return_inverse=True)
    if not 2 <= len(names) <= MAX_VALUES_OF_COPY:
        return False
    classes, class_of = np.unique(given[known], return_inverse=True)
    counts = np.zeros((len(names), len(classes)), dtype=np.int64)
    np.add.at(counts, (value_of, class_of), 1)
    names_two_classes = len(np.unique(counts.argmax(axis=1))) > 1
    return names_two_classes and counts.max(axis=1).sum() >= PURITY_OF_COPY * known.sum()


def _validated(
    geo: GeoPyramid,
    features: Signature,
    given: IntArray,
    seed: int,
    progress: Progress | None,
) -> Validation | None:
    """Return the validation and note what it found, or why there is none."""
    plan = geo.pyramid.synthesise().vertices[:, :2]
    try:
        validation = validate_classes(features, given, spatial_folds(plan), seed, progress)
    except OptionError as error:
        if len(np.unique(given[given >= 0])) >= 2:  # else learning refuses them, which says it all
            note(
                "not_validated",
                "not checked on blocks left out: {reason}",
                reason=str(error).rstrip("."),
            )
        return None
    note(
        "validation",
        "accuracy in blocks of the map left out: {accuracy:.1%}",
        accuracy=validation.accuracy,
    )
    f1, recall = validation.f1, validation.recall
    for name in validation.classes:
        note(
            "class_validation",
            "class {name}: F1 {f1:.3f}, {recall:.1%} of it found",
            name=name,
            f1=f1[name],
            recall=recall[name],
        )
    return validation
