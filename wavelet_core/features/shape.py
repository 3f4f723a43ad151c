"""The shape of terrain at each scale: slope, aspect and curvature of the surface of any level.

A landform has a size. One pyramid gives the slope and the curvature of the ground at 5 m and at
500 m, each on the surface that is that smooth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.shape import filter_moments, fit_quadratics
from .._validate import FloatArray, frozen
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..mesh.collapse import even_positions
from ..mesh.connectivity import stars_of
from ..mesh.location import surface_errors
from ..mesh.triangle_mesh import TriangleMesh

__all__ = [
    "SHAPE_NAMES",
    "DetailShape",
    "SurfaceShape",
    "detail_shape",
    "sample_at",
    "surface_shape",
]

#: What can be asked of a shape by name.
SHAPE_NAMES = ("slope", "aspect", "profile", "tangential", "mean", "gaussian")

#: Gradients below this are flat: they have no direction. Rounding of a plane stays below it.
FLAT_GRADIENT = 1e-9

#: A filter whose first moment is below this part of its ring's size carries no gradient.
SMALL_MOMENT = 1e-6


@dataclass(frozen=True, slots=True)
class SurfaceShape:
    """First and second derivatives of a surface at its vertices.

    NaN at vertices without faces.

    Attributes
    ----------
    gradient : ndarray, shape (n_vertices, 2)
        Rise over run to the east (x) and to the north (y).
    hessian : ndarray, shape (n_vertices, 3)
        z_xx, z_xy, z_yy, in one over the unit of length.
    """

    gradient: FloatArray
    hessian: FloatArray

    @property
    def slope(self) -> FloatArray:
        """Steepest slope in degrees, 0 to 90."""
        return np.degrees(np.arctan(np.hypot(*self.gradient.T)))

    @property
    def aspect(self) -> FloatArray:
        """Direction of steepest descent, degrees clockwise from north (y); NaN on the flat."""
        aspect = np.degrees(np.arctan2(-self.gradient[:, 0], -self.gradient[:, 1])) % 360.0
        aspect[~(np.hypot(*self.gradient.T) > FLAT_GRADIENT)] = np.nan
        return aspect

    @property
    def profile(self) -> FloatArray:
        """Normal curvature along the line of steepest descent; 0 on the flat, convex positive."""
        (p, q), (r, s, t), squared = self._parts()
        return self._on_slopes(
            -(p * p * r + 2 * p * q * s + q * q * t) / (squared * (1 + squared) ** 1.5)
        )

    @property
    def tangential(self) -> FloatArray:
        """Normal curvature across the slope; 0 on the flat, convex positive (spurs, not hollows).

        Divide by the sine of the slope for the plan curvature of the contour line, which has no
        bound where the ground is nearly flat.
        """
        (p, q), (r, s, t), squared = self._parts()
        return self._on_slopes(
            -(q * q * r - 2 * p * q * s + p * p * t) / (squared * np.sqrt(1 + squared))
        )

    @property
    def mean(self) -> FloatArray:
        """Mean curvature, convex positive: hilltops and ridges are above 0."""
        p, q = self.gradient.T
        r, s, t = self.hessian.T
        squared = p * p + q * q
        return -((1 + q * q) * r - 2 * p * q * s + (1 + p * p) * t) / (2 * (1 + squared) ** 1.5)

    @property
    def gaussian(self) -> FloatArray:
        """Gaussian curvature: above 0 in bowls and on domes, below 0 on saddles."""
        r, s, t = self.hessian.T
        return (r * t - s * s) / (1 + (self.gradient**2).sum(axis=1)) ** 2

    def named(self, name: str) -> FloatArray:
        """Return one of ``SHAPE_NAMES``.

        Raises
        ------
        OptionError
            Another name.
        """
        if name not in SHAPE_NAMES:
            raise OptionError(
                "there is no shape {given}; choose one of {shapes}.",
                "name",
                given=repr(name),
                shapes=", ".join(SHAPE_NAMES),
            )
        values: FloatArray = getattr(self, name)
        return values

    def _parts(self) -> tuple[NDArray, NDArray, FloatArray]:
        squared = (self.gradient**2).sum(axis=1)
        flat = ~(squared > FLAT_GRADIENT**2)
        return self.gradient.T, self.hessian.T, np.where(flat, 1.0, squared)

    def _on_slopes(self, curvature: FloatArray) -> FloatArray:
        steepness = np.hypot(*self.gradient.T)
        return np.where(steepness <= FLAT_GRADIENT, 0.0, curvature)


@dataclass(frozen=True, slots=True)
class DetailShape:
    """The gradient and the curvature that the detail vectors of one level carry themselves.

    Attributes
    ----------
    vertex_ids : ndarray of int64, shape (n_odd,)
        Ids of the removed vertices in the input mesh.
    positions : ndarray, shape (n_odd, 3)
        x, y, z of the removed vertices on the finer level.
    gradient : ndarray, shape (n_odd, 2)
        The least gradient that explains the detail; NaN where the filter annuls every plane.
    curvature : ndarray, shape (n_odd,)
        Mean curvature (for gentle slopes), convex positive, in one over the unit of length.
    """

    vertex_ids: NDArray[np.int64]
    positions: FloatArray
    gradient: FloatArray
    curvature: FloatArray


def surface_shape(mesh: TriangleMesh) -> SurfaceShape:
    r"""Return slope, aspect and curvatures of a surface at its vertices.

    Parameters
    ----------
    mesh : TriangleMesh
        A level of a pyramid, or any other; x and y (horizontal) and z in one unit of length.

    Returns
    -------
    SurfaceShape

    Notes
    -----
    At each vertex the quadratic :math:`z - z_0 = p u + q v + \tfrac12 r u^2 + s u v + \tfrac12 t
    v^2` is fitted to the neighbours by least squares, weighted by one over the squared distance
    in plan; it passes through the vertex. Quadratic surfaces come out exactly. *Our choice:* the
    second ring joins where the first has fewer than five vertices or hardly determines the
    quadratic (corners, straight outlines, neighbours near a conic); where that does not help, the
    gradient is the area-weighted mean of the faces' and the curvature 0.

    References
    ----------
    I. S. Evans: An integrated system of terrain analysis and slope mapping. Zeitschrift für
    Geomorphologie, Suppl. 36, 1980. J. Krcho: Modelling of georelief. Bratislava, 2001
    (signs and names of the curvatures vary between authors; ours are given with each).

    Examples
    --------
    >>> from wavelet_core import synthetic
    >>> from wavelet_core.features.shape import surface_shape
    >>> shape = surface_shape(synthetic.plane(slope=(0.0, -1.0)))
    >>> float(shape.slope[40].round(6)), float(shape.aspect[40].round(6))
    (45.0, 0.0)
    """
    faces = np.ascontiguousarray(mesh.faces, dtype=np.int32)
    indptr, star = stars_of(faces, mesh.n_vertices)
    centre = mesh.vertices.mean(axis=0) if mesh.n_vertices else np.zeros(3)
    points = mesh.vertices - centre
    coefficients = np.empty((mesh.n_vertices, 5))
    run_in_ranges(fit_quadratics, mesh.n_vertices, points, faces, indptr, star, coefficients)
    return SurfaceShape(frozen(coefficients[:, :2]), frozen(coefficients[:, 2:]))


def detail_shape(pyramid: Pyramid, level: int) -> DetailShape:
    r"""Return the gradient and curvature that the details of one level carry.

    Parameters
    ----------
    pyramid : Pyramid
    level : int
        Of the detail layer, 0 to L - 1.

    Raises
    ------
    PyramidError
        A level without details.

    Notes
    -----
    Let p be the weights by which a vertex is predicted and :math:`d_i` its neighbours' offsets in
    plan. For a surface with gradient g and Hessian H the detail is, to second order,

    .. math::
        w = -g \cdot \delta - \tfrac12 \sum_i p_i \, d_i^T H d_i, \qquad
        \delta = \sum_i p_i d_i, \quad m = \sum_i p_i |d_i|^2 .

    A filter with :math:`\delta \ne 0` (uniform, geometric, on an uneven star) so measures the
    gradient along δ, and one with δ = 0 (plane, barycentric) the curvature. The gradient
    returned is :math:`-w \delta / |\delta|^2`, the shortest that explains the detail. The
    curvature is :math:`2 (w + g \cdot \delta) / m` with g fitted to the finer level by
    :func:`surface_shape`, which is exact for a paraboloid of revolution.

    References
    ----------
    G. Beyer: Terrain inclination and curvature from wavelet coefficients. Journal of Geodesy 76,
    2003, cited in section 1.3 of the paper.
    """
    detail = pyramid.detail(level)
    mesh = pyramid.mesh(level + 1)
    step = pyramid.steps[level]
    even = even_positions(step.odd, mesh.n_vertices)
    plan = mesh.vertices[:, :2] - mesh.vertices[:, :2].mean(axis=0)
    first, second = np.empty((step.n_odd, 2)), np.empty(step.n_odd)
    run_in_ranges(
        filter_moments,
        step.n_odd,
        step.indptr,
        step.indices,
        step.weights,
        plan[even],
        plan[step.odd],
        first,
        second,
    )
    z = step.details[:, pyramid.channels.index("z")]
    squared = (first**2).sum(axis=1)
    carries = squared > SMALL_MOMENT**2 * np.abs(second)
    gradient = np.full((step.n_odd, 2), np.nan)
    gradient[carries] = -(z[carries] / squared[carries])[:, None] * first[carries]
    fitted = surface_shape(mesh).gradient[step.odd]
    curvature = np.full(step.n_odd, np.nan)
    has_size = second > 0
    bent = z + (fitted * first).sum(axis=1)
    curvature[has_size] = 2 * bent[has_size] / second[has_size]
    return DetailShape(detail.vertex_ids, detail.positions, frozen(gradient), frozen(curvature))


def sample_at(mesh: TriangleMesh, values: FloatArray, plan: FloatArray) -> FloatArray:
    """Return values at the vertices of a mesh, interpolated linearly on its faces.

    Parameters
    ----------
    mesh : TriangleMesh
        Whose faces lie over the positions in plan.
    values : ndarray, shape (n_vertices,) or (n_vertices, n_columns)
        What to interpolate.
    plan : ndarray, shape (n_points, 2)
        x and y.

    Returns
    -------
    ndarray, shape (n_points,) or (n_points, n_columns)
        NaN where no face covers the position, or a corner of it has no value.

    Examples
    --------
    >>> import numpy as np
    >>> from wavelet_core import synthetic
    >>> from wavelet_core.features.shape import sample_at
    >>> mesh = synthetic.plane()
    >>> sample_at(mesh, mesh.vertices[:, 0], np.array([[2.25, 3.5], [-1.0, 0.0]])).tolist()
    [2.25, nan]
    """
    columns = values[:, None] if values.ndim == 1 else values
    points = np.column_stack([plan, np.zeros(len(plan))])
    sampled = np.empty((len(plan), columns.shape[1]))
    for k, column in enumerate(columns.T):
        surface = TriangleMesh._trusted(
            np.column_stack([mesh.vertices[:, :2], column]),
            mesh.faces,
            np.empty((mesh.n_vertices, 0)),
            (),
        )
        sampled[:, k] = -surface_errors(surface, points)
    return sampled[:, 0] if values.ndim == 1 else sampled
