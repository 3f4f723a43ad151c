"""The Delaunay TIN of a point cloud: merged points, gaps, and what is said of either."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core._validate import distinct
from wavelet_core.mesh.gaps import PointGaps, faces_within, gaps_of
from wavelet_core.mesh.triangulation import canonical_faces, delaunay_faces
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.errors import InputFileError, PointCloudWarning
from wavelet_gis.model.points.aside import DUPLICATE_RULES, merged_points
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.points.origin import CloudOrigin
from wavelet_gis.notes import warn

__all__ = ["CloudVertices", "cloud_mesh", "cloud_vertices"]

#: Gaps that take more than this share of a cloud's area are reported.
TOLD_GAPS = 0.05


def cloud_mesh(
    cloud: PointCloud,
    frame: LocalFrame,
    *,
    duplicates: str | None = None,
    max_edge: float | Literal["auto"] | None = None,
    concave: bool = False,
    name: str = "the cloud",
) -> tuple[TriangleMesh, CloudOrigin]:
    """Return the Delaunay TIN of the points in the working frame, and how to come back from it.

    Parameters
    ----------
    cloud : PointCloud
        In the file's coordinates.
    frame : LocalFrame
        From `wavelet_gis.crs.frame.working_frame`.
    duplicates : str, optional
        Which height points that share x and y have in common, a row of
        `wavelet_gis.model.points.aside.DUPLICATE_RULES`, by default its first; all of them come
        back.
    max_edge : float or "auto", optional
        Leave faces with a longer edge out, as gaps of the cloud; in the working frame's unit,
        which is that of x and y, or the metre for a geographic CRS. "auto" is
        the length of `wavelet_core.mesh.gaps.gaps_of`. By default the convex hull is filled.
    concave : bool
        Leave out only what such edges open to the outside; with max_edge "auto" if none is given.
    name : str
        Of the cloud, for warnings.

    Raises
    ------
    InputFileError
        When a coordinate or an attribute is not finite.
    MeshError
        When there are fewer than three points, or all lie on one line, or no face is left.

    Warns
    -----
    PointCloudWarning
        How many points were merged and what that costs; gaps, and points without a face.
    """
    vertices, origin, attributes, names = cloud_vertices(cloud, frame, duplicates)
    faces = delaunay_faces(vertices[:, :2])
    gaps = gaps_of(vertices[:, :2], faces)
    origin = replace(origin, spacing=gaps.spacing)
    faces = _without_gaps(name, vertices[:, :2], faces, gaps, max_edge, concave)
    faces = canonical_faces(faces)  # an order that need not be stored
    _tell_of_merging(name, origin)
    return TriangleMesh(vertices, faces, attributes, names), origin


class CloudVertices(NamedTuple):
    """The vertices that a cloud's points give.

    vertices : (n, 3) float64, in the working frame
    origin : CloudOrigin, how to come back from them
    attributes : (n, k) float64
    names : tuple of str, of the attributes
    """

    vertices: NDArray[np.float64]
    origin: CloudOrigin
    attributes: NDArray[np.float64]
    names: tuple[str, ...]


def cloud_vertices(
    cloud: PointCloud, frame: LocalFrame, duplicates: str | None = None
) -> CloudVertices:
    """Return the vertices of the points, those that share x and y merged.

    Parameters
    ----------
    cloud, frame, duplicates
        See `cloud_mesh`.

    Raises
    ------
    InputFileError
        When a coordinate or an attribute is not finite.
    """
    rule = DUPLICATE_RULES.chosen(duplicates)
    used = slice(None) if cloud.aside is None else ~cloud.aside
    vertices = frame.to_local(cloud.coordinates()[used])
    if not np.isfinite(vertices).all():
        raise InputFileError(
            "the cloud has coordinates that are not finite; check the scales and offsets "
            "in its header."
        )
    merged, stored = merged_points(vertices, cloud.integers[used, 2], rule)
    kept = merged.kept
    origin = CloudOrigin.from_cloud(cloud, kept, merged.representative, stored, rule.name)
    attributes = np.empty((len(kept), len(cloud.attributes)))
    for k, attribute in enumerate(cloud.attributes):
        attributes[:, k] = attribute.lifted()[used][kept]
        if not np.isfinite(attributes[:, k]).all():
            raise InputFileError(
                "attribute {attribute} has values that are not finite; leave it out of {0}.",
                "attributes",
                attribute=attribute.name,
            )
    names = tuple(attribute.name for attribute in cloud.attributes)
    vertices = vertices[kept]
    if rule.height is not None:
        vertices[:, 2] = frame.local_z(stored * cloud.scales[2] + cloud.offsets[2])
    return CloudVertices(vertices, origin, attributes, names)


def _without_gaps(
    name: str,
    plan: NDArray[np.float64],
    faces: NDArray[np.int64],
    gaps: PointGaps,
    max_edge: float | Literal["auto"] | None,
    concave: bool,
) -> NDArray[np.int64]:
    if max_edge is None and not concave:
        if gaps.share > TOLD_GAPS:
            _tell(
                "gaps",
                "{name}: gaps between the points take {share:.0%} of the area and are closed by "
                "long triangles; {0} auto (here {length:.4g}) leaves them out",
                "max_edge",
                name=name,
                share=gaps.share,
                length=gaps.length,
            )
        return faces
    length = gaps.length if max_edge is None or max_edge == "auto" else float(max_edge)
    within = faces_within(plan, faces, length, from_outline=concave)
    _tell(
        "gaps_left_out",
        "{name}: {n_gone} of {n_faces} triangles have an edge longer than {length:.4g} and are "
        "left out; {n_alone} points are in no triangle then",
        name=name,
        n_gone=len(faces) - len(within),
        n_faces=len(faces),
        length=length,
        n_alone=len(plan) - len(distinct(within)),
    )
    return within


def _tell_of_merging(name: str, origin: CloudOrigin) -> None:
    merged = origin.merged_heights()
    if merged.n_points:
        _tell(
            "merged_points",
            "{name}: {n_points} points share x and y with others; the {rule} of each place stands "
            "for them, up to {largest:.4g} off (root mean square {rms:.4g}) ({0})",
            "duplicates",
            name=name,
            **merged._asdict(),
        )


def _tell(code: str, template: str, *options: str, **figures: Any) -> None:
    warn(PointCloudWarning, code, template, *options, stacklevel=4, **figures)
