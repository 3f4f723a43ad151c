"""Terrain to the TIN of a size, or of an accuracy, with the least error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core import analyse as core_analyse
from wavelet_core.errors import OptionError
from wavelet_core.mesh.location import Cover, cover_of, surface_errors
from wavelet_core.progress import report
from wavelet_core.refinement.finish import finished, finished_within
from wavelet_core.refinement.refine import Round
from wavelet_gis._memory import require_memory
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.points.origin import CloudOrigin
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import Note, collected, warn
from wavelet_gis.progress import Clock, part_of
from wavelet_gis.workflows.analyse import Analysis
from wavelet_gis.workflows.extract import Surface, SurfaceErrors, measured
from wavelet_gis.workflows.lines.errors import figures_along_lines, measured_along_lines
from wavelet_gis.workflows.options import (
    ROUNDING,
    WaveletOptions,
    note_moved_outline,
    note_unreached_size,
    options_for,
    require_terrain,
    warn_of_error_above,
    working_rules,
)
from wavelet_gis.workflows.solver.quality import MeshQuality, quality_of
from wavelet_gis.workflows.solver.solver_mesh import SolverRules, solver_mesh
from wavelet_gis.workflows.tolerance.by_place import MaxError, is_by_place, tolerances
from wavelet_gis.workflows.tolerance.zone_errors import zone_errors

__all__ = ["Simplified", "simplify"]


@dataclass(frozen=True, slots=True)
class Simplified(Surface):
    """The TIN of a size, or of an accuracy.

    Attributes
    ----------
    terrain : Terrain
        What was simplified.
    is_fitted : bool
        Whether the heights are fitted to all input vertices by least squares; otherwise they are
        those of the pyramid's coarsest level or, after a refinement, of the input.
    rounds : tuple of Round
        What each round of the refinement led to, in the input's unit of z; the pyramid's coarsest
        level first, empty where nothing was refined.
    seconds : dict of str to float
        What the parts of the work took.
    along_lines : SurfaceErrors or None
        Along breaklines and clip polygon, where there are such lines.
    limits : (n_input_vertices,) float64 or None
        How far each input vertex may be off, where a tolerance was asked for.
    quality : MeshQuality or None
        Angles, edges and areas of a mesh for a solver.
    """

    terrain: Terrain | None = None
    is_fitted: bool = False
    rounds: tuple[Round, ...] = ()
    seconds: dict[str, float] | None = None
    along_lines: SurfaceErrors | None = None
    limits: NDArray[np.float64] | None = None
    quality: MeshQuality | None = None

    @property
    def notes(self) -> tuple[Note, ...]:
        """What is worth telling about the input and its analysis."""
        return self.geo.notes

    def analysis(self, *, measure: bool = True, progress: Progress | None = None) -> Analysis:
        """Return the reversible pyramid whose coarsest level this TIN was made from.

        Parameters
        ----------
        measure : bool
            Whether the errors of every level are measured.
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.
        """
        assert self.terrain is not None
        finest = self.geo.pyramid.synthesise()
        terrain = self.terrain.with_notes(list(self.geo.notes))
        geo = terrain.geo_pyramid(self.geo.pyramid, finest)
        return Analysis(
            geo.with_errors(progress, finest, terrain.points_for_errors()) if measure else geo
        )

    def thinned(
        self,
        max_error: float | NDArray[np.float64] | None = None,
        progress: Progress | None = None,
    ) -> tuple[PointCloud, SurfaceErrors]:
        """Return the points of a cloud that carry its surface, each as it came, and their errors.

        They are the vertices of the TIN. Whoever triangulates them again gets other triangles,
        those of Delaunay, which may be farther off: the errors are measured on these, at all points
        of the surface.

        Parameters
        ----------
        max_error : float or (n_input_vertices,) float64, optional
            Points are added, where the error is largest, until no vertex of the input is farther
            from the Delaunay triangles; in the input's unit of z, one for all or one for each.
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.

        Raises
        ------
        OptionError
            What was simplified is no point cloud.
        Cancelled
            ``progress`` returned False.
        """
        assert self.terrain is not None
        cloud, origin = self.terrain.original, self.terrain.origin
        if self.terrain.segments is not None and isinstance(cloud, PointCloud):
            raise OptionError(
                "{name}: with lines its vertices are no longer those of the cloud; leave {0} and "
                "{1} out.",
                "breaklines",
                "clip",
                name=self.terrain.name,
            )
        if not (isinstance(cloud, PointCloud) and isinstance(origin, CloudOrigin)):
            raise OptionError(
                "{name}: this is no point cloud, so there are no points to thin.",
                name=self.terrain.name,
            )
        if len(origin.shifts):
            raise OptionError(
                "{name}: {0} {rule!r} gives heights that no point has, so no points carry the "
                "surface; choose lowest, highest or first.",
                "duplicates",
                name=self.terrain.name,
                rule=origin.duplicates,
            )
        points, scale = self.terrain.mesh.vertices, self.terrain.frame.z_scale
        ids = self.vertex_ids[self.vertex_ids >= 0]
        limits = None if max_error is None else np.asarray(max_error) * scale
        while True:
            mesh = TriangleMesh.from_points(points[ids])
            cover = cover_of(mesh, points[:, :2])
            report(progress, 1.0 - len(self.vertex_ids) / len(ids))
            worst = _worst_of_faces(mesh, points, cover, limits)
            if len(worst) == 0:
                break
            ids = np.union1d(ids, worst)
        is_all = origin.n_points == len(points)
        every = points if is_all else self.terrain.points_for_errors()
        errors = measured(mesh, every, scale, cover if is_all else None)
        return cloud.subset(origin.vertex_rows()[ids]), errors

    def for_solver(
        self,
        *,
        min_angle: float = 25.0,
        longest_edge: float | None = None,
        shortest_edge: float | None = None,
        max_area: float | None = None,
        progress: Progress | None = None,
    ) -> Simplified:
        """Return it as a mesh whose angles, edges and areas are within bounds; needs CGAL.

        Parameters
        ----------
        min_angle : float
            Degrees, at most 30. Angles that outline and lines have between them stay.
        longest_edge, shortest_edge, max_area : float, optional
            In the unit of x and y, or the metre for a geographic CRS. No two points of the input
            become nodes that are nearer than ``shortest_edge``, but for those of outline and
            lines; the triangulation itself may make an edge shorter where an angle needs it.
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.

        Returns
        -------
        Simplified
            With all errors measured anew. Where a tolerance was asked for, points become nodes
            until it holds again; what it cannot hold is warned of. New nodes lie on the terrain
            and have the vertex id -1.

        Raises
        ------
        OptionError
            Bounds that no mesh can meet, or that take too many nodes.
        MissingDependencyError
            Without CGAL's bindings.
        Cancelled
            ``progress`` returned False.
        """
        assert self.terrain is not None
        terrain, z_scale = self.terrain, self.terrain.frame.z_scale
        made = solver_mesh(
            self.mesh,
            self.vertex_ids,
            terrain.mesh,
            SolverRules(min_angle, longest_edge, shortest_edge, max_area),
            locked=terrain.locked,
            segments=terrain.segments,
            limits=None if self.limits is None else self.limits * z_scale,
            progress=progress,
        )
        if made.n_above and not made.are_too_near:
            warn(
                TerrainWarning,
                "solver_mesh_not_done",
                "{name}: {n} input points are still farther off than they may be; refine the TIN "
                "first, with a smaller {0}",
                "max_error",
                name=terrain.name,
                n=made.n_above,
            )
        elif made.n_above:
            warn(
                TerrainWarning,
                "solver_mesh_beyond_tolerance",
                "{name}: {n} input points are farther off than they may be, since nodes would be "
                "too near; make {0} smaller",
                "shortest_edge",
                name=terrain.name,
                n=made.n_above,
            )
        mesh, vertices = made.mesh, terrain.mesh.vertices
        return replace(
            self,
            mesh=mesh,
            vertex_ids=made.vertex_ids,
            errors=measured(mesh, terrain.points_for_errors(), z_scale),
            zones=zone_errors(mesh, made.vertex_ids, vertices, self.limits, z_scale)
            if self.zones and self.limits is not None
            else (),
            is_fitted=False,
            rounds=(),  # what they tell of is the TIN
            along_lines=measured_along_lines(terrain, mesh),
            quality=quality_of(mesh),
        )

    def figures(self) -> dict[str, Any]:
        """Return sizes and errors as JSON-able values."""
        pyramid = self.geo.pyramid
        return {
            "n_input_vertices": pyramid.n_vertices(pyramid.n_levels),
            **Surface.figures(self),
            **figures_along_lines(self.along_lines),
            **({} if self.quality is None else {"quality": self.quality._asdict()}),
            "n_levels": pyramid.n_levels,
            "stopped_by": None if pyramid.stop is None else pyramid.stop.reason,
            "rounds": [here._asdict() for here in self.rounds],
        }


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
    if zones is not None and (vertices is not None or max_rms is not None):
        raise OptionError("{0} are of {1}; leave them out.", "zones", "max_error")
    has_max_error = max_error is not None or zones is not None
    if (vertices is not None) + has_max_error + (max_rms is not None) != 1:
        raise OptionError("give one of {0}, {1} and {2}.", "vertices", "max_error", "max_rms")
    if refine is not None and refine < 0:
        raise OptionError("{0} is {given}; give 0 or more rounds.", "refine", given=refine)
    if refine and not (fit or keep_points):
        raise OptionError(
            "{0} moves vertices, whose heights cannot stay those of the level; leave out {0} or "
            "{1}, or give {2}.",
            "refine",
            "fit",
            "keep_points",
        )
    keywords = options_for(terrain, options)
    limits, largest = None, None
    if is_by_place(max_error, zones, zone_field):
        limits = tolerances(terrain, terrain.mesh, max_error, zones, zone_field)
        largest = _largest_of(limits, terrain)
        keywords = _by_largest_error(keywords)
    elif max_error is not None:
        largest = float(max_error)  # type: ignore[arg-type]
    if keep_points:
        keywords = _without_update(keywords)
    clock = Clock(on_stage)
    with collected() as notes:
        clock.stage("simplify")
        pyramid = core_analyse(
            terrain.mesh,
            progress=part_of(progress, 0.0, 0.6),
            **working_rules(  # type: ignore[arg-type]
                terrain.frame, target_vertices=vertices, max_error=largest, max_rms=max_rms
            ),
            **keywords,
        )
        note_unreached_size(pyramid, vertices)
        if options.get("outline_tolerance"):
            note_moved_outline(terrain.mesh, pyramid.mesh(0), options["outline_tolerance"])
    clock.stage("fit")
    z_scale = terrain.frame.z_scale
    finishing = part_of(progress, 0.6, 0.95)
    if limits is not None:
        rounds = refine if fit else 0
        tin = finished_within(
            pyramid, terrain.mesh, limits * z_scale, rounds=rounds, progress=finishing
        )
    else:
        tin = finished(
            pyramid,
            terrain.mesh,
            fit=fit,
            rounds=refine,
            keep_points=keep_points,
            progress=finishing,
        )
    clock.stage("errors")
    # Of a cloud these are all points of the surface: those merged with a vertex count too.
    points = terrain.points_for_errors()
    at_vertices = measured(tin.mesh, terrain.mesh.vertices, z_scale)
    if limits is None and (
        _is_above(at_vertices.max_error, largest) or _is_above(at_vertices.rmse, max_rms)
    ):
        # A vertex on the outline may have gone unmeasured in a round; the pyramid's level holds.
        tin = finished(pyramid, terrain.mesh, fit=fit, rounds=0, keep_points=keep_points)
        at_vertices = measured(tin.mesh, terrain.mesh.vertices, z_scale)
    if limits is not None and _n_beyond(tin.mesh, terrain, limits):
        tin = finished_within(pyramid, terrain.mesh, limits * z_scale, rounds=0)
        at_vertices = measured(tin.mesh, terrain.mesh.vertices, z_scale)
        if n_beyond := _n_beyond(tin.mesh, terrain, limits):
            warn(
                TerrainWarning,
                "tolerance_not_kept",
                "{name}: {n} input points are farther off than {0} allows there",
                "max_error",
                name=terrain.name,
                n=n_beyond,
            )
    is_all = len(points) == terrain.mesh.n_vertices
    errors = at_vertices if is_all else measured(tin.mesh, points, z_scale)
    warn_of_error_above(
        terrain.name, errors.max_error, errors.rmse, max_error=largest, max_rms=max_rms
    )
    noted = terrain.with_notes([*terrain.notes, *notes])
    return Simplified(
        geo=noted.uncorrected(pyramid),
        mesh=tin.mesh,
        vertex_ids=tin.vertex_ids,
        level=0,
        errors=errors,
        zones=()
        if limits is None
        else zone_errors(tin.mesh, tin.vertex_ids, terrain.mesh.vertices, limits, z_scale),
        terrain=noted,
        is_fitted=tin.is_fitted,
        rounds=tuple(
            here._replace(rmse=here.rmse / z_scale, max_error=here.max_error / z_scale)
            for here in tin.rounds
        ),
        seconds=clock.seconds(),
        along_lines=measured_along_lines(terrain, tin.mesh),
        limits=np.full(terrain.mesh.n_vertices, largest)
        if limits is None and max_error is not None
        else limits,
    )


def _n_beyond(mesh: TriangleMesh, terrain: Terrain, limits: NDArray[np.float64]) -> int:
    """Return how many input vertices are farther off than they may be."""
    errors = np.abs(surface_errors(mesh, terrain.mesh.vertices)) / terrain.frame.z_scale
    slack = ROUNDING * float(np.ptp(terrain.mesh.vertices[:, 2])) / terrain.frame.z_scale
    return int((errors > limits * (1.0 + ROUNDING) + slack).sum())


def _largest_of(limits: NDArray[np.float64], terrain: Terrain) -> float:
    """Return the largest tolerance, or what no error can be above."""
    relief = float(np.ptp(terrain.mesh.vertices[:, 2])) / terrain.frame.z_scale
    return float(min(limits.max(initial=0.0), relief))


def _by_largest_error(keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the options of an analysis that a tolerance by place can start from."""
    for option, due in (("norm", "max"), ("update", "none")):
        if keywords.get(option, due) != due:
            raise OptionError(
                "{0} {given!r} does not go with a tolerance that varies by place, which needs "
                "{due!r}; leave it out.",
                option,
                given=keywords[option],
                due=due,
            )
    if "prediction" in keywords or keywords.get("signal", "z") != "z":
        raise OptionError(
            "a tolerance that varies by place needs the heights of the input; leave out {0}, {1} "
            "and {2}.",
            "design",
            "prediction",
            "signal",
        )
    return {**keywords, "norm": "max", "update": "none"}


def _is_above(found: float, asked: float | None) -> bool:
    return asked is not None and found > asked * (1.0 + ROUNDING)


def _without_update(keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the options of an analysis whose levels keep the heights of the input."""
    if "prediction" in keywords or keywords.get("update", "none") != "none":
        raise OptionError(
            "{0} keeps the heights of the input; leave out {1}, {2} and {3}, which would not.",
            "keep_points",
            "design",
            "prediction",
            "update",
        )
    return {**keywords, "update": "none"}


def _worst_of_faces(
    mesh: TriangleMesh,
    points: NDArray[np.float64],
    cover: Cover,
    limits: NDArray[np.float64] | None,
) -> NDArray[np.int64]:
    """Return the point of each face that is farthest off, where that is more than a tolerance."""
    if limits is None:
        return np.empty(0, dtype=np.int64)
    off = np.abs(surface_errors(mesh, points, cover)[cover.point])
    # Rounding of a vertex's own height must not add it again.
    of_each = np.broadcast_to(limits, (len(points),))[cover.point]
    is_off = off > np.maximum(of_each, 1e-9 * float(np.ptp(points[:, 2])))
    face, point, off = cover.face[is_off], cover.point[is_off], off[is_off]
    order = np.lexsort((point, -off, face))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = face[order[1:]] != face[order[:-1]]
    worst: NDArray[np.int64] = point[order[is_first]]
    return worst
