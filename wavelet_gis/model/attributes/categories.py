"""Attributes that are categories, such as classes: numbers that name and do not measure.

The mean of ground (2) and building (6) is no tree (4). A pyramid lifts a category like any other
column, since only so the input comes back from it; but what is shown of a level is the category of
an input vertex, and filters leave it alone. In place of the one number there can be a channel of 0
and 1 for each category, whose smooth values are shares.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.model.points.cloud import PointAttribute, PointCloud

__all__ = [
    "CATEGORIES",
    "MAX_CHANNELS",
    "Categories",
    "category_gains",
    "channel_category",
    "dimension_of",
    "is_category",
    "nearest_vertices",
    "one_channel_per_category",
    "with_own_values",
]

#: What is shown of a category at a coarse level: that of the nearest input vertex, or the number.
Categories = Literal["nearest", "number"]

#: Dimensions of LAS files whose numbers are names, orders or flags.
CATEGORIES = frozenset(
    {
        "classification",
        "return_number",
        "number_of_returns",
        "scan_direction_flag",
        "edge_of_flight_line",
        "synthetic",
        "key_point",
        "withheld",
        "overlap",
        "scanner_channel",
        "user_data",
        "point_source_id",
    }
)
#: Between a dimension and a category in the name of what a channel of 0 and 1 comes from.
_EQUALS = "="
#: More categories than these of one dimension are no channels.
MAX_CHANNELS = 32


def is_category(name: str) -> bool:
    """Return whether a dimension, or an attribute by its name, is a category.

    Examples
    --------
    >>> is_category("classification"), is_category("intensity"), is_category("classification=2")
    (True, False, False)
    """
    return name.lower() in CATEGORIES


def dimension_of(attribute: PointAttribute) -> str:
    """Return the dimension that an attribute comes from, also where it is one channel of it."""
    return attribute.dimension.split(_EQUALS)[0]


def one_channel_per_category(cloud: PointCloud) -> PointCloud:
    """Return the points with a channel of 0 and 1 for each category of the lifted categories.

    Parameters
    ----------
    cloud : PointCloud
        If it carries other dimensions, the categories themselves join them.

    Raises
    ------
    OptionError
        A dimension of more than ``MAX_CHANNELS`` categories.
    """
    attributes: list[PointAttribute] = []
    carried = dict(cloud.carried)
    for attribute in cloud.attributes:
        if not is_category(attribute.dimension):
            attributes.append(attribute)
            continue
        values = np.unique(attribute.values)
        if len(values) > MAX_CHANNELS:
            raise OptionError(
                f"{attribute.name} has {len(values)} values, too many for a channel each; lift "
                "it as one number, or leave it out."
            )
        if carried and attribute.dimension not in carried:
            carried[attribute.dimension] = attribute.values
        attributes += [
            PointAttribute(
                f"{attribute.name}_{value}",
                f"{attribute.dimension}{_EQUALS}{value}",
                (attribute.values == value).astype(np.uint8),
            )
            for value in values.tolist()
        ]
    return replace(cloud, attributes=tuple(attributes), carried=carried)


def channel_category(attribute: PointAttribute) -> tuple[str, int] | None:
    """Return dimension and category of a channel of 0 and 1; None of any other attribute.

    Examples
    --------
    >>> channel_category(PointAttribute("classification_2", "classification=2", np.zeros(1)))
    ('classification', 2)
    """
    dimension, equals, value = attribute.dimension.partition(_EQUALS)
    return (dimension, int(value)) if equals else None


def with_own_values(mesh: TriangleMesh, finest: TriangleMesh, names: Iterable[str]) -> TriangleMesh:
    """Return a mesh whose named attributes are those of the input vertices nearest in plan.

    Parameters
    ----------
    mesh : TriangleMesh
        A level, or a mesh between two.
    finest : TriangleMesh
        The input.
    names : iterable of str
        Attributes of both.
    """
    names = tuple(names)
    if not names or mesh.n_vertices == 0:
        return mesh
    columns = [mesh.attribute_names.index(name) for name in names]
    attributes = mesh.attributes.copy()
    nearest = nearest_vertices(finest, mesh.vertices[:, :2])
    attributes[:, columns] = np.rint(finest.attributes[nearest][:, columns])
    return TriangleMesh(mesh.vertices, mesh.faces, attributes, mesh.attribute_names)


def nearest_vertices(mesh: TriangleMesh, plan: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the vertex of a mesh nearest in plan to each place, ``(n,)``."""
    from scipy.spatial import cKDTree

    nearest: NDArray[np.int64] = cKDTree(mesh.vertices[:, :2]).query(plan)[1]
    return nearest


def category_gains(
    gains: dict[int, float], channels: Sequence[str], names: Sequence[str]
) -> dict[int, float | list[float]]:
    """Return gains by channel that leave categories alone."""
    if not names:
        return dict(gains)
    return {
        level: [1.0 if channel in names else gain for channel in channels]
        for level, gain in gains.items()
    }
