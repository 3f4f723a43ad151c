"""Which line of a scan each vertex of a pyramid is on: its row or column, or its flight line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import OptionError, TriangleMesh

if TYPE_CHECKING:
    from wavelet_gis.model.origin import Origin

__all__ = ["line_labels"]

#: The axis of a raster by the name of its lines.
_AXES = {"rows": 0, "columns": 1}


def line_labels(origin: Origin, finest: TriangleMesh, stripes: str) -> NDArray[np.int64]:
    """Return the label of the line that each vertex of the finest mesh is on, ``(n_vertices,)``.

    Parameters
    ----------
    origin : Origin
        What the pyramid was made from.
    finest : TriangleMesh
        Its finest mesh.
    stripes : str
        ``"rows"`` or ``"columns"`` of a raster; else a dimension of the points, such as
        ``"point_source_id"``, or an attribute, whose whole numbers from 0 up are the labels.

    Raises
    ------
    OptionError
        Rows or columns without a raster; no such dimension, or numbers that are no labels.
    """
    if stripes in _AXES:
        if origin.grid is None:
            raise OptionError(
                "{0} is {stripes}, which a {noun} has not; name a dimension of whole numbers, "
                "such as point_source_id.",
                "stripes",
                stripes=stripes,
                noun=origin.noun,
            )
        return np.nonzero(origin.grid.valid)[_AXES[stripes]].astype(np.int64)
    values = _of_points(origin, stripes)
    if values is None and stripes in finest.attribute_names:
        values = finest.attributes[:, finest.attribute_names.index(stripes)]
    if values is None:
        raise OptionError(
            "{0} is {stripes!r}, which the {noun} has not; give {ways}.",
            "stripes",
            stripes=stripes,
            noun=origin.noun,
            ways="rows or columns" if origin.grid else "a dimension such as point_source_id",
        )
    labels = np.rint(values) if values.ndim == 1 and values.dtype.kind in "iuf" else None
    if labels is None or not np.all(np.isfinite(labels) & (np.abs(values - labels) < 1e-6)):
        raise OptionError(
            "{0} is {stripes}, whose values are no whole numbers; name a dimension of labels, such "
            "as point_source_id.",
            "stripes",
            stripes=stripes,
        )
    return labels.astype(np.int64)


def _of_points(origin: Origin, name: str) -> NDArray[Any] | None:
    """Return a dimension of the points that are vertices, carried along beside the surface."""
    if origin.points is None or name not in origin.points.cloud.carried:
        return None
    values: NDArray[Any] = origin.points.cloud.carried[name][origin.points.vertex_rows()]
    return values
