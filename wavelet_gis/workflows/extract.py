"""Pyramid to a surface: one level, or any size or accuracy between two."""

from __future__ import annotations

from wavelet_core.accuracy.between_levels import PartialMesh, mesh_of_accuracy, mesh_of_size
from wavelet_core.errors import OptionError
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.workflows.inputs import HoldsPyramid, pyramid_of
from wavelet_gis.workflows.surface import Surface, SurfaceErrors

__all__ = ["extract"]


def extract(
    data: HoldsPyramid | GeoPyramid,
    *,
    level: int | None = None,
    vertices: int | None = None,
    max_error: float | None = None,
) -> Surface:
    """Return a surface of a pyramid; with no rule the coarsest level.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    level : int, optional
        0 is the coarsest, the number of levels the input.
    vertices : int, optional
        Instead: just so many.
    max_error : float, optional
        Instead: the smallest found with no input vertex farther off, vertically, in the input's
        unit of z.

    Returns
    -------
    Surface
        With its errors where the pyramid's file tells them.

    Raises
    ------
    OptionError
        More than one rule, or a size or an accuracy that the pyramid does not have.
    PyramidError
        A level that the pyramid does not have.
    """
    geo = pyramid_of(data)
    if sum(rule is not None for rule in (level, vertices, max_error)) > 1:
        raise OptionError("give one of {0}, {1} and {2}.", "level", "vertices", "max_error")
    if vertices is not None:
        return _between(geo, mesh_of_size(geo.pyramid, vertices))
    if max_error is not None:
        return _between(geo, mesh_of_accuracy(geo.pyramid, max_error * geo.frame.z_scale))
    chosen = level or 0
    mesh = geo.pyramid.mesh(chosen)
    return Surface(geo, mesh, geo.pyramid.vertex_ids(chosen), chosen, _errors_at(geo, chosen))


def _between(geo: GeoPyramid, part: PartialMesh) -> Surface:
    is_level = part.mesh.n_vertices == geo.pyramid.n_vertices(part.level)
    errors = _errors_at(geo, part.level) if is_level else None
    return Surface(geo, part.mesh, part.vertex_ids, part.level, errors)


def _errors_at(geo: GeoPyramid, level: int) -> SurfaceErrors | None:
    errors = geo.errors_at(level)
    if errors is None:
        return None
    return SurfaceErrors(errors.rmse_surface, errors.max_error_surface, errors.n_uncovered)
