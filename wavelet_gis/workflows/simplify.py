"""Terrain to the TIN of a size, or of an accuracy, with the least error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Unpack

import numpy as np

from wavelet_core import Progress, Pyramid, TriangleMesh
from wavelet_core import analyse as core_analyse
from wavelet_core.mesh.location import surface_errors
from wavelet_core.progress import part_of
from wavelet_core.refinement.finish import FinishedTin, finished, finished_within
from wavelet_core.refinement.refine import Round
from wavelet_gis._memory import require_memory
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import collected, warn
from wavelet_gis.progress import Clock
from wavelet_gis.workflows.extract import SurfaceErrors, measured
from wavelet_gis.workflows.lines.errors import measured_along_lines
from wavelet_gis.workflows.options import (
    ROUNDING,
    WaveletOptions,
    note_moved_outline,
    note_unreached_size,
    require_terrain,
    warn_of_error_above,
    working_rules,
)
from wavelet_gis.workflows.simplification.request import Request, request_for
from wavelet_gis.workflows.simplification.simplified import Simplified
from wavelet_gis.workflows.tolerance.by_place import MaxError
from wavelet_gis.workflows.tolerance.zone_errors import ZoneErrors, zone_errors

__all__ = ["Simplified", "simplify"]


def simplify(
    terrain: Terrain,
    *,
    vertices: int | None = None,
    max_error: MaxError | None = None,
    zones: Any = None,
    zone_field: str | None = None,
    max_rms: float | None = None,
    fit: bool = True,
    refine: int | None = None,
    keep_points: bool = False,
    progress: Progress | None = None,
    on_stage: Callable[[str], None] | None = None,
    **options: Unpack[WaveletOptions],
) -> Simplified:
    """Return the TIN of a number of vertices, or of an accuracy, with the least error.

    Parameters
    ----------
    terrain : Terrain
        From `wavelet_gis.open`.
    vertices : int, optional
        Keep so many vertices.
    max_error : float, path, str, array_like or callable, optional
        Instead: keep so many that no input vertex is farther off, vertically; in the input's unit
        of z. One distance, or what gives one by place, see
        `wavelet_gis.workflows.tolerance.by_place.tolerances`; vertices are then input vertices.
    zones : path or GeoDataFrame, optional
        Polygons with a ``max_error`` of their own.
    zone_field : str, optional
        The field of theirs that holds it, by default ``max_error``.
    max_rms : float, optional
        Instead: the same for the root mean square error.
    fit : bool
        Fit the heights to all input vertices by least squares where the root mean square is what
        is kept small; a fit would spoil the largest error. Without it the TIN is the pyramid's
        coarsest level as it is, and is not refined either.
    refine : int, optional
        Rounds of refinement of the TIN, 0 for none; see `wavelet_core.refine`. By default as many
        as pay, where the partition is ``"surface"`` and vertices keep their places.
    keep_points : bool
        Vertices are input vertices, height and all; their heights are not fitted.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    on_stage : callable, optional
        Called with the name of each part of the work as it begins: ``simplify``, ``fit``,
        ``errors``; the refinement belongs to ``fit``.
    **options
        See `wavelet_gis.workflows.options.WaveletOptions`.

    Raises
    ------
    InputFileError
        There is less memory than the analysis takes.
    OptionError
        Not just one of the three rules, or options that contradict each other.
    Cancelled
        ``progress`` returned False.
    """
    require_terrain(terrain)
    require_memory(terrain.mesh.n_vertices, 1 + terrain.mesh.attributes.shape[1])
    asked = request_for(
        terrain,
        vertices=vertices,
        max_error=max_error,
        zones=zones,
        zone_field=zone_field,
        max_rms=max_rms,
        fit=fit,
        refine=refine,
        keep_points=keep_points,
        options=options,
    )
    clock = Clock(on_stage)
    clock.stage("simplify")
    with collected() as notes:
        share = _share_of_analysis(asked)
        pyramid = _analysed(terrain, asked, part_of(progress, 0.0, share))
    clock.stage("fit")
    tin = _finished(pyramid, terrain, asked, asked.rounds, part_of(progress, share, 0.95))
    clock.stage("errors")
    tin, errors = _within_tolerance(tin, pyramid, terrain, asked)
    warn_of_error_above(
        terrain.name,
        errors.max_error,
        errors.rmse,
        max_error=asked.max_error,
        max_rms=asked.max_rms,
    )
    noted = terrain.with_notes([*terrain.notes, *notes])
    return Simplified(
        geo=noted.uncorrected(pyramid),
        mesh=tin.mesh,
        vertex_ids=tin.vertex_ids,
        level=0,
        errors=errors,
        zones=_zones(tin, terrain, asked),
        terrain=noted,
        is_fitted=tin.is_fitted,
        rounds=_in_unit_of_z(tin.rounds, terrain.frame.z_scale),
        seconds=clock.seconds(),
        along_lines=measured_along_lines(terrain, tin.mesh),
        limits=asked.limits_of(terrain.mesh.n_vertices),
    )


def _share_of_analysis(asked: Request) -> float:
    """Return the part of the time that the analysis takes, for the progress."""
    if asked.rounds == 0:
        return 0.85
    return 0.6 if asked.vertices is None else 0.4


def _analysed(terrain: Terrain, asked: Request, progress: Progress | None) -> Pyramid:
    """Return the pyramid down to what is asked for; what it does not reach is noted."""
    rules: dict[str, Any] = working_rules(
        terrain.frame,
        target_vertices=asked.vertices,
        max_error=asked.max_error,
        max_rms=asked.max_rms,
    )
    pyramid = core_analyse(terrain.mesh, progress=progress, **rules, **asked.options)
    note_unreached_size(pyramid, asked.vertices)
    if outline_tolerance := asked.options.get("outline_tolerance"):
        note_moved_outline(terrain.mesh, pyramid.mesh(0), outline_tolerance)
    return pyramid


def _finished(
    pyramid: Pyramid,
    terrain: Terrain,
    asked: Request,
    rounds: int | None,
    progress: Progress | None = None,
) -> FinishedTin:
    """Return the coarsest level after so many rounds of refinement, fitted where that is due."""
    if asked.limits is not None:
        limits = asked.limits * terrain.frame.z_scale
        return finished_within(pyramid, terrain.mesh, limits, rounds=rounds, progress=progress)
    return finished(
        pyramid,
        terrain.mesh,
        fit=asked.fit,
        rounds=rounds,
        keep_points=asked.keep_points,
        progress=progress,
    )


def _within_tolerance(
    tin: FinishedTin, pyramid: Pyramid, terrain: Terrain, asked: Request
) -> tuple[FinishedTin, SurfaceErrors]:
    """Return the TIN, or, where it breaks the tolerance, the one before its refinement; and errors.

    A vertex on the outline may have gone unmeasured in a round; the pyramid's level holds.
    """
    vertices, z_scale = terrain.mesh.vertices, terrain.frame.z_scale
    errors = measured(tin.mesh, vertices, z_scale)
    if _is_too_far(tin.mesh, errors, terrain, asked):
        tin = _finished(pyramid, terrain, asked, rounds=0)
        errors = measured(tin.mesh, vertices, z_scale)
        if n_beyond := _n_beyond(tin.mesh, terrain, asked):
            warn(
                TerrainWarning,
                "tolerance_not_kept",
                "{name}: {n} input points are farther off than {0} allows there",
                "max_error",
                name=terrain.name,
                n=n_beyond,
            )
    # Of a cloud these are all points of the surface: those merged with a vertex count too.
    points = terrain.points_for_errors()
    if len(points) != len(vertices):
        errors = measured(tin.mesh, points, z_scale)
    return tin, errors


def _is_too_far(
    mesh: TriangleMesh, errors: SurfaceErrors, terrain: Terrain, asked: Request
) -> bool:
    if asked.limits is not None:
        return _n_beyond(mesh, terrain, asked) > 0
    return _is_above(errors.max_error, asked.max_error) or _is_above(errors.rmse, asked.max_rms)


def _n_beyond(mesh: TriangleMesh, terrain: Terrain, asked: Request) -> int:
    """Return how many input vertices are farther off than a tolerance by place allows."""
    if asked.limits is None:
        return 0
    errors = np.abs(surface_errors(mesh, terrain.mesh.vertices)) / terrain.frame.z_scale
    slack = ROUNDING * float(np.ptp(terrain.mesh.vertices[:, 2])) / terrain.frame.z_scale
    return int((errors > asked.limits * (1.0 + ROUNDING) + slack).sum())


def _is_above(found: float, asked: float | None) -> bool:
    return asked is not None and found > asked * (1.0 + ROUNDING)


def _zones(tin: FinishedTin, terrain: Terrain, asked: Request) -> tuple[ZoneErrors, ...]:
    """Return the errors by size of a tolerance by place."""
    if asked.limits is None:
        return ()
    return zone_errors(
        tin.mesh, tin.vertex_ids, terrain.mesh.vertices, asked.limits, terrain.frame.z_scale
    )


def _in_unit_of_z(rounds: tuple[Round, ...], z_scale: float) -> tuple[Round, ...]:
    return tuple(
        here._replace(rmse=here.rmse / z_scale, max_error=here.max_error / z_scale)
        for here in rounds
    )
