"""Terrain to pyramid: analysed, made exact, measured; and what can be done with the result."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Unpack

from wavelet_core import Progress, TriangleMesh
from wavelet_core import analyse as core_analyse
from wavelet_core.errors import OptionError
from wavelet_core.progress import part_of
from wavelet_gis._memory import require_memory
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import Original
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import Note, collected, note
from wavelet_gis.progress import Clock
from wavelet_gis.workflows.extract import SurfaceErrors
from wavelet_gis.workflows.lines.errors import figures_along_lines, measured_along_lines
from wavelet_gis.workflows.options import (
    WaveletOptions,
    note_moved_outline,
    note_unreached_size,
    options_for,
    require_terrain,
    warn_of_error_above,
    working_rules,
)
from wavelet_gis.workflows.reconstruct import check_restored_output, reconstruct
from wavelet_gis.workflows.save import Layers, save, write_pyramid_file

__all__ = ["Analysis", "analyse"]


@dataclass(frozen=True, slots=True)
class Analysis:
    """A pyramid with its place on earth and its origin, fresh from an analysis or from a file.

    Attributes
    ----------
    geo : GeoPyramid
        The pyramid, its frame, CRS, origin, errors and history.
    seconds : dict of str to float
        What the parts of the work took.
    along_lines : SurfaceErrors or None
        Of the coarsest level along breaklines and clip polygon, where there are such lines.
    """

    geo: GeoPyramid
    seconds: dict[str, float] = field(default_factory=dict)
    along_lines: SurfaceErrors | None = None

    @property
    def n_levels(self) -> int:
        """Number of steps; levels run from 0, the coarsest, to this, the input."""
        return self.geo.pyramid.n_levels

    @property
    def notes(self) -> tuple[Note, ...]:
        """What is worth saying about the input and its analysis."""
        return self.geo.notes

    def mesh(self, level: int = 0) -> TriangleMesh:
        """Return the mesh of a level in the coordinates of the input."""
        return self.geo.file_mesh(self.geo.pyramid.mesh(level))

    def restore(
        self, path: str | os.PathLike[str] | None = None, *, overwrite: bool = False
    ) -> Original:
        """Return what the pyramid was made from, and write it where a path is given.

        Parameters
        ----------
        path : path, optional
            Of the kind that came in: a raster, a point cloud, a TIN.
        overwrite : bool
            Whether a file that exists there may be replaced.

        Raises
        ------
        PyramidError
            When the exact original was due and did not come out.
        OutputFileError
            A file of another kind, or one that exists.
        """
        if path is not None:
            check_restored_output(path, self.geo.origin.kind, overwrite=overwrite)
        restored = reconstruct(self)
        if path is not None:
            save(restored, path, overwrite=overwrite)
        return restored.original

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        layers: Layers = "auto",
        progress: Progress | None = None,
    ) -> None:
        """Write the pyramid file; see `wavelet_gis.workflows.save.save`."""
        write_pyramid_file(path, self.geo, layers, progress)

    def figures(self) -> dict[str, Any]:
        """Return sizes, errors and parameters as JSON-able values."""
        pyramid = self.geo.pyramid
        return {
            "n_vertices": pyramid.n_vertices(pyramid.n_levels),
            "n_triangles": len(pyramid.faces),
            "n_levels": pyramid.n_levels,
            "n_coarse_vertices": pyramid.n_vertices(0),
            "channels": list(pyramid.channels),
            "parameters": dict(pyramid.parameters),
            "levels": [level._asdict() for level in self.geo.errors or ()],
            **figures_along_lines(self.along_lines),
            "seconds": {name: round(seconds, 3) for name, seconds in self.seconds.items()},
        }


def analyse(
    terrain: Terrain,
    *,
    levels: int | None = None,
    target_vertices: int | None = None,
    max_error: float | None = None,
    max_rms: float | None = None,
    measure: bool = True,
    progress: Progress | None = None,
    on_stage: Callable[[str], None] | None = None,
    **options: Unpack[WaveletOptions],
) -> Analysis:
    """Return the reversible wavelet pyramid of a terrain.

    Parameters
    ----------
    terrain : Terrain
        From `wavelet_gis.open`.
    levels : int, optional
        The most levels to build.
    target_vertices : int, optional
        Stop at so many vertices.
    max_error, max_rms : float, optional
        Stop before the largest, or the root mean square, vertical error at all input vertices is
        above this, in the input's unit of z. Points that share x and y with a vertex are farther
        off by as much as they are apart, which is warned of.
    measure : bool
        Whether the errors of every level are measured.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    on_stage : callable, optional
        Called with the name of each part of the work as it begins: ``analyse``, ``verify``,
        ``errors``.
    **options
        See `wavelet_gis.workflows.options.WaveletOptions`.

    Returns
    -------
    Analysis
        The finest mesh has been synthesised, and its difference from the input is kept.

    Raises
    ------
    InputFileError
        There is less memory than the analysis takes.
    OptionError
        Options that contradict each other or have no meaning, or a raster with lines in it.
    Cancelled
        ``progress`` returned False.
    """
    require_terrain(terrain)
    require_memory(terrain.mesh.n_vertices, 1 + terrain.mesh.attributes.shape[1])
    _require_reversible(terrain)
    clock = Clock(on_stage)
    with collected() as notes:
        if isinstance(terrain.original, PointCloud) and terrain.profile is not None:
            note(
                "pyramid_of_a_tin",
                "{name}: with lines or fixed points in it this is a pyramid of a TIN; it gives the "
                "TIN back, not the point cloud",
                name=terrain.name,
            )
        clock.stage("analyse")
        pyramid = core_analyse(
            terrain.mesh,
            record=True,
            progress=part_of(progress, 0.0, 0.7 if measure else 0.9),
            **working_rules(  # type: ignore[arg-type]
                terrain.frame,
                levels=levels,
                target_vertices=target_vertices,
                max_error=max_error,
                max_rms=max_rms,
            ),
            **options_for(terrain, options),
        )
        note_unreached_size(pyramid, target_vertices)
        if options.get("outline_tolerance"):
            note_moved_outline(terrain.mesh, pyramid.mesh(0), options["outline_tolerance"])
    clock.stage("verify")
    finest = pyramid.finest_on(terrain.mesh)
    geo = terrain.with_notes([*terrain.notes, *notes]).geo_pyramid(pyramid, finest)
    if measure:
        clock.stage("errors")
        geo = geo.with_errors(part_of(progress, 0.7, 1.0), finest, terrain.points_for_errors())
        coarsest = geo.errors_at(0)
        if coarsest is not None:
            warn_of_error_above(
                terrain.name,
                coarsest.max_error_surface,
                coarsest.rmse_surface,
                max_error=max_error,
                max_rms=max_rms,
            )
    along_lines = measured_along_lines(terrain, pyramid.mesh(0))
    return Analysis(geo, clock.seconds(), along_lines)


def _require_reversible(terrain: Terrain) -> None:
    """Refuse a raster with lines in it: its cells could not come back out of the pyramid."""
    if isinstance(terrain.original, Dem) and terrain.profile is not None:
        raise OptionError(
            "{name}: the pyramid of a raster gives the raster back, which it cannot with {0}, {1} "
            "or {2}; leave them out, use 'simplify', or analyse the cells as a table of points.",
            "breaklines",
            "clip",
            "fixed_points",
            name=terrain.name,
        )
