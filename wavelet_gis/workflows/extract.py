"""Pyramid to a surface: one level, or any size or accuracy between two, and its way into a file."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.accuracy.between_levels import mesh_of_accuracy, mesh_of_size
from wavelet_core.accuracy.selective import PartialMesh
from wavelet_core.errors import OptionError
from wavelet_core.mesh.location import Cover, surface_errors
from wavelet_core.progress import part_of, report
from wavelet_core.refinement.finish import finished_within
from wavelet_gis.io.formats import RASTER_SUFFIXES, suffix_of
from wavelet_gis.model.attributes.categories import Categories
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import note
from wavelet_gis.workflows.exchange import InOtherLibraries
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of, warn_of_error_above
from wavelet_gis.workflows.save import check_surface_output, write_surface_raster, write_tin
from wavelet_gis.workflows.tolerance.by_place import MaxError, is_by_place, tolerances
from wavelet_gis.workflows.tolerance.zone_errors import ZoneErrors, zone_errors

#: Of the time that a surface within a tolerance takes: all but the measuring of its errors.
_BEFORE_MEASURING = 0.8

__all__ = ["Surface", "SurfaceErrors", "errors_in_figures", "extract", "measured"]


class SurfaceErrors(NamedTuple):
    """Vertical errors of a surface at all input points, in the input's unit of z.

    rmse, max_error : float
    n_uncovered : int, input points that no triangle covers, which have no error
    """

    rmse: float
    max_error: float
    n_uncovered: int

    def told(self, unit: str) -> str:
        """Return them as part of a sentence.

        Examples
        --------
        >>> SurfaceErrors(0.02, 0.05, 3).told("metre")
        'RMSE 0.02, largest error 0.05 (metre) at all input points but 3 over no triangle'
        """
        beside = f" but {self.n_uncovered:,} over no triangle" if self.n_uncovered else ""
        return (
            f"RMSE {self.rmse:.4g}, largest error {self.max_error:.4g} ({unit}) at all input "
            f"points{beside}"
        )


@dataclass(frozen=True, slots=True)
class Surface(InOtherLibraries):
    """A TIN of a pyramid.

    Attributes
    ----------
    geo : GeoPyramid
        Gives place and CRS.
    mesh : TriangleMesh
        In the working frame.
    vertex_ids : (n_vertices,) int64
        Ids of its vertices in the input; -1 of nodes that a mesh for a solver has besides.
    level : int
        The level that it is, or, of a size between two, the finer one.
    errors : SurfaceErrors or None
        At all input points; None for a level of a pyramid that does not hold them.
    zones : tuple of ZoneErrors
        Where the tolerance was given by place: the errors by its size, the strictest first.
    """

    geo: GeoPyramid
    mesh: TriangleMesh
    vertex_ids: NDArray[np.int64]
    level: int
    errors: SurfaceErrors | None = None
    zones: tuple[ZoneErrors, ...] = ()

    @property
    def file_mesh(self) -> TriangleMesh:
        """The mesh in the coordinates of the input."""
        return self.geo.file_mesh(self.mesh)

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        cell_size: float | None = None,
        attribute: str | None = None,
        cog: bool = False,
        to_crs: str | None = None,
        categories: Categories = "nearest",
    ) -> dict[str, int]:
        """Write it as a TIN or a raster; see `wavelet_gis.workflows.save.save`.

        Parameters
        ----------
        path : path
            A file that does not exist yet.
        cell_size, attribute, cog
            Of a raster; see `wavelet_gis.workflows.save.write_surface_raster`.
        to_crs : str, optional
            Of a mesh file: a projected CRS, or ``"auto"`` for the UTM zone; see
            `wavelet_gis.products.plane_mesh.plane_mesh` for what holds without it.
        categories : {"nearest", "number"}
            See `wavelet_gis.model.geo_pyramid.GeoPyramid.file_mesh`.

        Returns
        -------
        dict of str to int
            Rows, columns and cells without data of a raster; empty for a TIN.
        """
        check_surface_output(
            path,
            overwrite=True,
            cell_size=cell_size,
            attribute=attribute,
            cog=cog,
            to_crs=to_crs,
        )
        if suffix_of(path) in RASTER_SUFFIXES:
            return write_surface_raster(
                path,
                self.geo,
                self.mesh,
                cell_size=cell_size,
                attribute=attribute,
                cog=cog,
                categories=categories,
            )
        name = f"level_{self.level:02d}"
        write_tin(path, self.geo, self.mesh, self.vertex_ids, name, to_crs, categories)
        return {}

    def figures(self) -> dict[str, Any]:
        """Return size and errors as JSON-able values."""
        sizes: dict[str, Any] = {
            "n_vertices": self.mesh.n_vertices,
            "n_triangles": self.mesh.n_faces,
        }
        if self.zones:
            sizes["zones"] = [zone._asdict() for zone in self.zones]
        if self.errors is None:
            return sizes
        return {
            **sizes,
            "rmse": self.errors.rmse,
            "max_error": self.errors.max_error,
            "n_points_uncovered": self.errors.n_uncovered,
        }


def measured(
    mesh: TriangleMesh,
    points: NDArray[np.float64],
    z_scale: float,
    cover: Cover | None = None,
) -> SurfaceErrors:
    """Return the vertical errors of a surface.

    Parameters
    ----------
    mesh : TriangleMesh
        In the working frame.
    points : (n_points, 3) float64
        What was measured, in the working frame.
    z_scale : float
        Working units in one of the input's unit of z.
    cover : Cover, optional
        Of the points on the mesh, where it is known already.
    """
    return errors_in_figures(surface_errors(mesh, points, cover) / z_scale)


def errors_in_figures(errors: NDArray[np.float64]) -> SurfaceErrors:
    """Return vertical errors in figures; NaN are points that no triangle covers."""
    covered = errors[np.isfinite(errors)]
    return SurfaceErrors(
        float(np.sqrt(np.mean(covered**2))) if len(covered) else 0.0,
        float(np.abs(covered).max(initial=0.0)),
        len(errors) - len(covered),
    )


def extract(
    data: HoldsPyramid | GeoPyramid,
    *,
    level: int | None = None,
    vertices: int | None = None,
    max_error: MaxError | None = None,
    zones: Any = None,
    zone_field: str | None = None,
    refine: int | None = 0,
    progress: Progress | None = None,
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
    max_error : float, path, str, array_like or callable, optional
        Instead: the smallest found with no input vertex farther off, vertically, in the input's
        unit of z; one distance, or what gives one by place, see
        `wavelet_gis.workflows.tolerance.by_place.tolerances`. Points that share x and y with a
        vertex are farther off by as much as they are apart, which is warned of.
    zones : path or GeoDataFrame, optional
        Polygons with a ``max_error`` of their own.
    zone_field : str, optional
        The field of theirs that holds it, by default ``max_error``.
    refine : int, optional
        With ``max_error``: rounds that turn edges, move vertices and take out what the tolerance
        allows, see `wavelet_core.refine`; None for as many as pay. Vertices are then input
        vertices, height and all.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    Surface
        With its errors, but for a level whose errors the pyramid's file does not hold.

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
    if zones is not None and (level is not None or vertices is not None):
        raise OptionError("{0} go with {1} only; leave them out.", "zones", "max_error")
    if max_error is not None or zones is not None:
        return _within(geo, max_error, zones, zone_field, refine, progress)
    if zone_field is not None:
        raise OptionError("{0} goes with {1}; give both or neither.", "zone_field", "zones")
    if refine != 0:
        raise OptionError("{0} goes with {1}; give both or neither.", "refine", "max_error")
    if vertices is not None:
        return _between(geo, mesh_of_size(geo.pyramid, vertices))
    chosen = level or 0
    mesh = geo.pyramid.mesh(chosen)
    return Surface(geo, mesh, geo.pyramid.vertex_ids(chosen), chosen, _errors_at(geo, chosen))


def _within(
    geo: GeoPyramid,
    max_error: MaxError | None,
    zones: Any,
    zone_field: str | None,
    refine: int | None,
    progress: Progress | None,
) -> Surface:
    finest, z_scale = geo.pyramid.mesh(geo.pyramid.n_levels), geo.frame.z_scale
    by_place = is_by_place(max_error, zones, zone_field)
    limits = tolerances(geo, finest, max_error, zones, zone_field)
    found_by = part_of(progress, 0.0, _BEFORE_MEASURING)
    if refine == 0:
        limit = limits * z_scale if by_place else limits[0] * z_scale
        part = mesh_of_accuracy(geo.pyramid, limit, found_by)
    else:
        tin = finished_within(
            geo.pyramid, finest, limits * z_scale, rounds=refine, progress=found_by
        )
        part = PartialMesh(tin.mesh, tin.vertex_ids, geo.pyramid.n_levels)
    surface = _between(geo, part)
    report(progress, 1.0)
    if by_place:
        rows = zone_errors(part.mesh, part.vertex_ids, finest.vertices, limits, z_scale)
        return replace(surface, zones=rows)
    found = surface.errors.max_error if surface.errors else None
    warn_of_error_above(geo.source_name, found, None, max_error=float(limits[0]))
    return surface


def _between(geo: GeoPyramid, part: PartialMesh) -> Surface:
    is_level = part.mesh.n_vertices == geo.pyramid.n_vertices(part.level)
    errors = _errors_at(geo, part.level) if is_level else None
    if errors is None:
        finest, origin = geo.pyramid.mesh(geo.pyramid.n_levels), geo.origin
        points = finest.vertices
        if origin.points is not None:
            points = origin.points.points_for_errors(finest, geo.frame)
        elif any(entry.code == "merged_points" for entry in geo.notes):
            note(
                "merged_points_not_kept",
                "{name}: a pyramid of a layer or table does not keep the points that share x and "
                "y with a vertex; the error is the one at the vertices",
                name=geo.source_name,
            )
        errors = measured(part.mesh, points, geo.frame.z_scale)
    return Surface(geo, part.mesh, part.vertex_ids, part.level, errors)


def _errors_at(geo: GeoPyramid, level: int) -> SurfaceErrors | None:
    errors = geo.errors_at(level)
    if errors is None:
        return None
    return SurfaceErrors(errors.rmse_surface, errors.max_error_surface, errors.n_uncovered)
