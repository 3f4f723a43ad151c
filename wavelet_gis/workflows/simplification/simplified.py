"""What a simplification gives: a TIN, its errors, and what can be made of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.refinement.refine import Round
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import Note, warn
from wavelet_gis.workflows.analyse import Analysis
from wavelet_gis.workflows.extract import Surface, SurfaceErrors, measured
from wavelet_gis.workflows.lines.errors import figures_along_lines, measured_along_lines
from wavelet_gis.workflows.simplification.thinning import Thinned, thinned
from wavelet_gis.workflows.solver.quality import MeshQuality, quality_of
from wavelet_gis.workflows.solver.sizes import Sizes, rules_of
from wavelet_gis.workflows.solver.solver_mesh import SolverMesh, solver_mesh
from wavelet_gis.workflows.tolerance.by_place import MaxError
from wavelet_gis.workflows.tolerance.zone_errors import zone_errors

__all__ = ["Simplified"]


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
        What each round of the refinement led to, in the input's unit of z; the level of the pyramid
        that it began with first, empty where nothing was refined.
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
        """What is worth saying about the input and its analysis."""
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
    ) -> Thinned:
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
        return thinned(self.terrain, self.vertex_ids, max_error, progress)

    def for_solver(
        self,
        *,
        min_angle: float = 25.0,
        longest_edge: MaxError | None = None,
        shortest_edge: float | None = None,
        max_area: MaxError | None = None,
        size_zones: Any = None,
        size_field: str | None = None,
        area_field: str | None = None,
        grading: float | None = None,
        progress: Progress | None = None,
    ) -> Simplified:
        """Return it as a mesh whose angles, edges and areas are within bounds; needs CGAL.

        Parameters
        ----------
        min_angle : float
            Degrees, at most 30. Angles that outline and lines have between them stay.
        longest_edge, max_area : float, path, str, array_like or callable, optional
            In the unit of x and y, or the metre for a geographic CRS: one number, or what gives
            one by place as for ``max_error`` of `wavelet_gis.simplify`; NaN for any. By place, no
            triangle has a longer edge than any input vertex in it allows, nor than those nearest
            to its corners do; an area counts as the even triangle of that area.
        shortest_edge : float, optional
            No two points of the input become nodes that are nearer, but for those of outline and
            lines; the triangulation itself may make an edge shorter where an angle needs it.
        size_zones : path or GeoDataFrame, optional
            Polygons with sizes of their own; where several overlap the least counts.
        size_field, area_field : str, optional
            Fields of theirs that hold the longest edge, ``longest_edge`` if neither is named, and
            the largest area.
        grading : float, optional
            By how much edges may grow for each unit of distance: from where the sizes above are
            smaller, and from each vertex of the TIN, where edges may be twice as long as the
            distance to the nearest other one.
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
        sizes = Sizes(longest_edge, max_area, size_zones, size_field, area_field)
        rules = rules_of(min_angle, longest_edge, shortest_edge, max_area, *sizes[2:], grading)
        rules.require_sense()
        made = solver_mesh(
            self.mesh,
            self.vertex_ids,
            terrain.mesh,
            rules,
            locked=terrain.locked,
            segments=terrain.segments,
            limits=None if self.limits is None else self.limits * z_scale,
            sizes=sizes.at_vertices(terrain),
            progress=progress,
        )
        _warn_of_points_off(terrain.name, made)
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
            rounds=(),  # they describe the TIN
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


def _warn_of_points_off(name: str, made: SolverMesh) -> None:
    """Say how many input points a mesh for a solver leaves too far off, and what helps."""
    if made.n_above and not made.are_too_near:
        warn(
            TerrainWarning,
            "solver_mesh_not_done",
            "{name}: {n} input points are still farther off than they may be; refine the TIN "
            "first, with a smaller {0}",
            "max_error",
            name=name,
            n=made.n_above,
        )
    elif made.n_above:
        warn(
            TerrainWarning,
            "solver_mesh_beyond_tolerance",
            "{name}: {n} input points are farther off than they may be, since nodes would be "
            "too near; make {0} smaller",
            "shortest_edge",
            name=name,
            n=made.n_above,
        )
