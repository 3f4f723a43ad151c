"""What is lifted, elevation and attributes or all coordinates, and by what it is measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .._table import Table
from .._threads import centre_of
from .._validate import FloatArray
from ..mesh.triangle_mesh import TriangleMesh

#: Attributes of weight 0 still count this little, so that they can be lifted beside z.
LEAST_WEIGHT = 1e-9


class Signal(NamedTuple):
    """A choice of lifted coordinates: a row of :data:`SIGNALS`.

    name : str, what `analyse` takes
    coordinates : tuple of str, the lifted ones, which come before the attributes
    help : str, one line for lists
    keeps_plan : bool, whether x and y stay what they are
    """

    name: str
    coordinates: tuple[str, ...]
    help: str
    keeps_plan: bool


#: The signals.
SIGNALS = Table(
    "signal",
    (
        Signal(
            "z", ("z",), "elevation and attributes; every level is a valid TIN", keeps_plan=True
        ),
        Signal(
            "xyz",
            ("x", "y", "z"),
            "all coordinates, as in the paper; coarse faces may be flipped in plan",
            keeps_plan=False,
        ),
    ),
)


def height_weights(extent: FloatArray, attribute_weights: Sequence[float]) -> FloatArray:
    """Return what errors of z and of each attribute count for against errors of z.

    Parameters
    ----------
    extent : (1 + n_attributes,) float64
        Range of z and of the attributes.
    attribute_weights : sequence of float
        What a change across the range of each attribute counts for against one across that of z.
    """
    weights = np.array((1.0, *attribute_weights)) / np.where(extent > 0, extent, 1.0)
    height = extent[0] if extent[0] > 0 else 1.0
    weights = np.maximum(weights, LEAST_WEIGHT) * height
    weights[0] = 1.0
    return weights


class Normalisation:
    """Centre and range of the input's columns, by which cost and prediction measure."""

    def __init__(self, mesh: TriangleMesh, attribute_weights: Sequence[float]) -> None:
        middles, extents = zip(centre_of(mesh.vertices), centre_of(mesh.attributes), strict=True)
        self._centre, extent = np.concatenate(middles), np.concatenate(extents)
        weights = np.array((1.0, 1.0, 1.0, *attribute_weights))
        self._factor = weights / np.where(extent > 0, extent, 1.0)
        self._height_weights = height_weights(extent[2:], attribute_weights)

    def height_weights(self) -> FloatArray:
        """Return what errors of z and of each attribute count for against errors of z."""
        return self._height_weights

    def points(
        self, coefficients: FloatArray, horizontal: FloatArray | None
    ) -> tuple[FloatArray, FloatArray]:
        """Return normalised x, y, z and attributes; and x, y centred only."""
        if horizontal is not None:
            coefficients = np.hstack([horizontal, coefficients])
        points = coefficients - self._centre
        plan = points[:, :2].copy()
        points *= self._factor
        return points, plan
