"""Labels for vertices: from the classes of a LAS file, or from a layer of polygons or points."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError
from wavelet_core.lifting.spacings import level_spacings
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.points.cloud import PointCloud

__all__ = [
    "NOT_KNOWN",
    "cloud_with_classes",
    "labels_from_las",
    "labels_from_layer",
    "merge_labels",
    "with_classes",
]

IntArray = NDArray[np.int64]

#: Label of vertices whose class is not known.
NOT_KNOWN = -1

#: Classes that say that nobody has looked: created, never classified; and unclassified.
UNLABELLED = (0, 1)

#: Bits of the class in the byte that it shares with flags, in point formats 0 to 5.
_CLASS_BITS = 0b11111


def labels_from_las(geo: GeoPyramid, unlabelled: Sequence[int] = UNLABELLED) -> IntArray:
    """Return the class of every vertex as the LAS file has it.

    Parameters
    ----------
    geo : GeoPyramid
        Of a point cloud, its other dimensions carried or the classification lifted.
    unlabelled : sequence of int
        Classes that count as not known.

    Raises
    ------
    OptionError
        The pyramid was not made from a point cloud, or its classes were dropped.
    """
    source = geo.origin.points
    if source is None:
        raise OptionError(
            "the pyramid was not made from a point cloud, so it has no LAS classes; learn from a "
            "layer instead."
        )
    of_point = _carried_classes(source.cloud)
    if of_point is not None:
        classes = of_point[source.vertex_rows()].astype(np.int64)
    elif "classification" in geo.pyramid.attribute_names:
        mesh = geo.pyramid.synthesise()
        column = mesh.attribute_names.index("classification")
        classes = np.rint(mesh.attributes[:, column]).astype(np.int64)
    else:
        raise OptionError(
            "the classes of the points were not kept; read the file again, with {0}.", "carry"
        )
    classes[np.isin(classes, list(unlabelled))] = NOT_KNOWN
    return classes


def labels_from_layer(
    geo: GeoPyramid, path: str | os.PathLike[str], field: str, layer: str | None = None
) -> IntArray:
    """Return the class that a layer's features give to the vertices they cover.

    Parameters
    ----------
    geo : GeoPyramid
        Whose vertices are labelled.
    path : path
        Any vector file that GDAL reads, in the CRS of the pyramid's input. Polygons label what is
        inside (the first one that covers a vertex); points label the nearest vertex, if it is no
        farther than twice the median edge, and of several the nearest counts.
    field : str
        Of whole numbers of 0 or more.
    layer : str, optional
        Where the file holds several.

    Raises
    ------
    InputFileError
        The file cannot be read, has no such field, holds lines, or labels no vertex.
    """
    import shapely

    from wavelet_gis.io.vector.vector_reader import read_shapes

    name = os.fspath(path)
    shapes, table, wkt = read_shapes(name, layer, [field])
    if field not in table:
        raise InputFileError(
            "{name}: there is no field {field!r}; name one with {0}.",
            "field",
            name=name,
            field=field,
        )
    _require_same_crs(geo, name, wkt)
    classes = _whole_numbers(name, field, table[field])
    kinds = set(shapely.get_type_id(shapes[~shapely.is_missing(shapes)]).tolist())
    vertices = geo.frame.to_file(geo.pyramid.synthesise().vertices)
    if kinds and kinds <= {0, 4}:
        labels = _near_points(geo, shapes, classes)
    elif kinds and kinds <= {3, 6}:
        labels = _inside_polygons(vertices, shapes, classes)
    else:
        raise InputFileError(f"{name}: labels must be polygons or points; convert the layer.")
    if (labels < 0).all():
        raise InputFileError(
            f"{name}: no vertex lies in or at a labelled feature; check the extent and the CRS."
        )
    return labels


def cloud_with_classes(
    geo: GeoPyramid,
    labels: IntArray,
    unlabelled: Sequence[int] | None = None,
    merges: Sequence[tuple[int, int]] = (),
) -> PointCloud:
    """Return the points that a pyramid was made from with other classes.

    Parameters
    ----------
    geo : GeoPyramid
        Of a point cloud.
    labels : (n_vertices,) int64
        Below 0: the class stays. Points that share x and y with a vertex get its class.
    unlabelled : sequence of int, optional
        Where the labels were learned from the points' own classes: those that count as not known.
        Points of any other class keep it, also where they share x and y with a vertex.
    merges : sequence of (from, to)
        Classes that were counted as another, for the points that keep theirs.

    Raises
    ------
    OptionError
        The pyramid was not made from a point cloud, its classes were dropped, or a label is above
        what the point format holds (31 in formats 0 to 5).
    """
    source = geo.origin.points
    if source is None:
        raise OptionError("the pyramid was not made from a point cloud; write .gpkg or .tif.")
    cloud = cast(PointCloud, geo.restore())
    of_point = np.full(source.n_points, NOT_KNOWN, dtype=np.int64)
    of_point[source.vertex_rows()] = labels
    of_point[source.dropped] = labels[source.representative]
    if unlabelled is not None:
        own = _point_classes(cloud)[source.dropped]
        is_known = ~np.isin(own, list(unlabelled))
        of_point[source.dropped[is_known]] = merge_labels(own, merges)[is_known]
    return with_classes(cloud, of_point)


def with_classes(cloud: PointCloud, of_point: IntArray) -> PointCloud:
    """Return a cloud whose points have other classes.

    Parameters
    ----------
    cloud : PointCloud
        Which holds classes, lifted or carried.
    of_point : (n_points,) int64
        Below 0: the class stays.

    Raises
    ------
    OptionError
        The classes were dropped, or one is above what the point format holds.
    """
    changed = of_point >= 0
    if "raw_classification" in cloud.carried:
        stored = cloud.carried["raw_classification"].copy()
        _require_at_most(of_point, _CLASS_BITS)
        stored[changed] = (stored[changed] & ~np.uint8(_CLASS_BITS)) | of_point[changed].astype(
            np.uint8
        )
        cloud = replace(cloud, carried={**cloud.carried, "raw_classification": stored})
    elif "classification" in cloud.carried:
        stored = cloud.carried["classification"].copy()
        _require_at_most(of_point, 255)
        stored[changed] = of_point[changed]
        cloud = replace(cloud, carried={**cloud.carried, "classification": stored})
    elif not any(a.dimension == "classification" for a in cloud.attributes):
        raise OptionError(
            "the classes of the points were not kept; read the file again, with {0}.", "carry"
        )
    attributes = []
    for attribute in cloud.attributes:
        if attribute.dimension == "classification":
            values = attribute.values.copy()
            _require_at_most(of_point, int(np.iinfo(values.dtype).max))
            values[changed] = of_point[changed]
            attribute = replace(attribute, values=values)
        attributes.append(attribute)
    return replace(cloud, attributes=tuple(attributes))


def _point_classes(cloud: PointCloud) -> IntArray:
    """Return the class of every point, from wherever it is; unclassified if from nowhere."""
    carried = _carried_classes(cloud)
    if carried is not None:
        return carried.astype(np.int64)
    for attribute in cloud.attributes:
        if attribute.dimension == "classification":
            return attribute.values.astype(np.int64)
    return np.ones(cloud.n_points, dtype=np.int64)


def _carried_classes(cloud: PointCloud) -> NDArray[Any] | None:
    if "classification" in cloud.carried:
        return cloud.carried["classification"]
    if "raw_classification" in cloud.carried:
        return cloud.carried["raw_classification"] & _CLASS_BITS
    return None


def _require_at_most(classes: IntArray, largest: int) -> None:
    if classes.max(initial=0) > largest:
        raise OptionError(
            f"class {classes.max()} does not fit the point format, which holds 0 to {largest}."
        )


def _require_same_crs(geo: GeoPyramid, name: str, crs: str | None) -> None:
    if crs is None or geo.system.wkt is None:
        return
    from pyproj import CRS

    ours, theirs = CRS.from_wkt(geo.system.wkt), CRS.from_user_input(crs)
    if not ours.to_2d().equals(theirs.to_2d(), ignore_axis_order=True):
        code = ":".join(ours.to_authority() or (ours.name,))
        raise InputFileError(
            f"{name}: the labels are in {theirs.name}, the pyramid in {ours.name}; reproject the "
            f"labels to that first (ogr2ogr -t_srs {code})."
        )


def _whole_numbers(name: str, field: str, values: NDArray[Any]) -> IntArray:
    if values.dtype.kind == "f":
        rounded = np.where(np.isfinite(values), values, NOT_KNOWN)
        if (rounded == np.rint(rounded)).all():
            return rounded.astype(np.int64)
    if values.dtype.kind in "iu":
        return values.astype(np.int64)
    raise InputFileError(
        f"{name}: field {field!r} does not hold whole numbers; number the classes."
    )


def _inside_polygons(
    vertices: NDArray[np.float64], shapes: NDArray[Any], classes: IntArray
) -> IntArray:
    import shapely

    plan = vertices[:, :2]
    labels = np.full(len(vertices), NOT_KNOWN, dtype=np.int64)
    for shape, label in zip(shapes[::-1], classes[::-1], strict=True):  # the first one wins
        if shape is None or label < 0:
            continue
        low, high = np.reshape(shape.bounds, (2, 2))
        near = np.flatnonzero(((plan >= low) & (plan <= high)).all(axis=1))
        shapely.prepare(shape)
        inside = shapely.intersects_xy(shape, vertices[near, 0], vertices[near, 1])
        labels[near[inside]] = label
    return labels


def _near_points(geo: GeoPyramid, shapes: NDArray[Any], classes: IntArray) -> IntArray:
    import shapely
    from scipy.spatial import cKDTree

    points, owner = shapely.get_coordinates(shapes, return_index=True)
    frame = geo.frame
    local = np.column_stack([frame.local_x(points[:, 0]), frame.local_y(points[:, 1])])
    plan = geo.pyramid.synthesise().vertices[:, :2]
    reach = 2 * float(level_spacings(geo.pyramid)[-1])
    distance, vertex = cKDTree(plan).query(local)
    labels = np.full(len(plan), NOT_KNOWN, dtype=np.int64)
    near = np.flatnonzero((distance <= reach) & (classes[owner] >= 0))
    near = near[np.argsort(-distance[near], kind="stable")]  # the nearest has the last word
    labels[vertex[near]] = classes[owner[near]]
    return labels


def merge_labels(labels: IntArray, merges: Sequence[tuple[int, int]]) -> IntArray:
    """Return labels with some classes counted as another.

    Parameters
    ----------
    labels : (n_vertices,) int64
        Classes.
    merges : sequence of (from, to)
        Each is applied to the labels as they came; to below 0 is not known.

    Examples
    --------
    >>> merge_labels(np.array([2, 3, 4, 5]), [(3, 5), (4, 5)]).tolist()
    [2, 5, 5, 5]
    """
    merged = labels.copy()
    for source, target in merges:
        merged[labels == source] = target
    return merged
