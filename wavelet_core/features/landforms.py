"""Landform classes from the shape of a surface: Wood's six features of any level."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._validate import frozen
from ..errors import OptionError
from .shape import SurfaceShape

__all__ = ["LANDFORMS", "landforms"]

#: The classes, in the order of their numbers: 0 is planar, 5 a peak.
LANDFORMS = ("planar", "pit", "channel", "pass", "ridge", "peak")
_PLANAR, _PIT, _CHANNEL, _PASS, _RIDGE, _PEAK = range(len(LANDFORMS))

#: Class of ground that does not slope: rows, the least of the principal curvatures concave, flat
#: or convex; columns, the greatest. The greatest is never below the least.
_LEVEL_GROUND = np.array(
    [
        [_PIT, _CHANNEL, _PASS],
        [_PLANAR, _PLANAR, _RIDGE],
        [_PLANAR, _PLANAR, _PEAK],
    ]
)
#: Class of ground that slopes: concave, flat or convex across the slope.
_SLOPING_GROUND = np.array([_CHANNEL, _PLANAR, _RIDGE])


def landforms(
    shape: SurfaceShape, *, flat_slope: float = 1.0, flat_curvature: float = 1e-4
) -> NDArray[np.int8]:
    r"""Return the landform class of every vertex: planar, pit, channel, pass, ridge or peak.

    Parameters
    ----------
    shape : SurfaceShape
        Of a level of a pyramid: the classes are those of forms of its size.
    flat_slope : float
        Degrees; ground that slopes more can be no pit, pass or peak.
    flat_curvature : float
        In one over the unit of length; what curves less counts as straight.

    Returns
    -------
    ndarray of int8, shape (n_vertices,)
        Places in ``LANDFORMS``; -1 where the shape is NaN.

    Raises
    ------
    OptionError
        A bound that is negative or no number.

    Notes
    -----
    With the gradient (p, q) and the second derivatives r, s, t, sloping ground is classed by its
    curvature across the slope, :math:`-(t p^2 - 2 s p q + r q^2) / (p^2 + q^2)`, other ground by
    its least and greatest curvature, :math:`-(r + t) / 2 \mp \sqrt{(r - t)^2 / 4 + s^2}`, all
    convex positive: the formulas and the bounds of GRASS's ``r.param.scale``, on the surface of a
    level instead of a window's quadratic.

    References
    ----------
    J. Wood: The geomorphological characterisation of digital elevation models. PhD thesis,
    University of Leicester, 1996, table 5.3.

    Examples
    --------
    >>> from wavelet_core import LANDFORMS, landforms, surface_shape, synthetic
    >>> classes = landforms(surface_shape(synthetic.plane(slope=(0.2, 0.0))))
    >>> {LANDFORMS[k] for k in classes.tolist()}
    {'planar'}
    """
    for name, bound in (("flat_slope", flat_slope), ("flat_curvature", flat_curvature)):
        if not (np.isfinite(bound) and bound >= 0):
            raise OptionError("{0} is {bound}; give 0 or more.", name, bound=bound)
    p, q = shape.gradient.T
    r, s, t = shape.hessian.T
    squared = p * p + q * q
    slopes = squared > np.tan(np.radians(flat_slope)) ** 2
    across = -(t * p * p - 2 * s * p * q + r * q * q) / np.where(slopes, squared, 1.0)
    mean, spread = -0.5 * (r + t), np.hypot(0.5 * (r - t), s)
    classes = np.where(
        slopes,
        _SLOPING_GROUND[_bend(across, flat_curvature)],
        _LEVEL_GROUND[_bend(mean - spread, flat_curvature), _bend(mean + spread, flat_curvature)],
    )
    classes[~np.isfinite(squared + mean + spread)] = -1
    return frozen(classes.astype(np.int8))


def _bend(curvature: NDArray[Any], flat: float) -> NDArray[np.intp]:
    """Return 0 where concave, 1 where straight, 2 where convex."""
    return 1 + (curvature > flat).astype(np.intp) - (curvature < -flat)
