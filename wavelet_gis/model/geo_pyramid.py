"""A pyramid together with where it lies, what it came from and how to go back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from wavelet_core import OptionError, Progress, Pyramid, TriangleMesh
from wavelet_core.metrics import LevelErrors, level_errors
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.model.attributes.categories import Categories, is_category, with_own_values
from wavelet_gis.model.mesh_origin import mesh_in_file
from wavelet_gis.model.origin import Origin, Original
from wavelet_gis.notes import Note

__all__ = ["GeoPyramid"]


@dataclass(frozen=True, slots=True)
class GeoPyramid:
    """What a pyramid file holds.

    Attributes
    ----------
    pyramid : Pyramid
        In the working frame.
    system : CoordinateSystem
        The CRS of the input.
    frame : LocalFrame
        From the input's coordinates to the working frame.
    vertical_unit : str
        Unit of z in the input.
    origin : Origin
        How the finest mesh becomes the input again.
    source_name : str
        The input's file name.
    errors : tuple of LevelErrors, or None
        Size and errors of each level, the coarsest first, in the input's unit of z.
    history : tuple of str
        One line for each change since the analysis (filters).
    notes : tuple of Note
        What was worth saying about the input and its analysis.
    """

    pyramid: Pyramid
    system: CoordinateSystem
    frame: LocalFrame
    vertical_unit: str
    origin: Origin
    source_name: str
    errors: tuple[LevelErrors, ...] | None = None
    history: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()

    def with_errors(
        self,
        progress: Progress | None = None,
        finest: TriangleMesh | None = None,
        points: NDArray[np.float64] | None = None,
    ) -> GeoPyramid:
        """Return the pyramid with the errors of every level computed.

        Parameters
        ----------
        progress : callable, optional
            Called with a fraction in [0, 1]; returning False stops with `Cancelled`.
        finest : TriangleMesh, optional
            The pyramid's finest mesh, where it has been synthesised already.
        points : (n_points, 3) float64, optional
            All input points of the surface in the working frame; by default those that the origin
            knows, among them the ones that are merged with a vertex.
        """
        finest = self.pyramid.synthesise() if finest is None else finest
        if points is None and self.origin.points is not None:
            points = self.origin.points.points_for_errors(finest, self.frame)
        unit = self.frame.z_scale
        levels = (
            level._replace(
                rmse_surface=level.rmse_surface / unit,
                max_error_surface=level.max_error_surface / unit,
            )
            for level in level_errors(self.pyramid, progress, finest, points)
        )
        return replace(self, errors=tuple(levels))

    def errors_at(self, level: int) -> LevelErrors | None:
        """Return the errors of a level; None where they were not measured."""
        return next((errors for errors in self.errors or () if errors.level == level), None)

    def with_pyramid(self, pyramid: Pyramid, change: str) -> GeoPyramid:
        """Return the pyramid of an altered pyramid, which no longer gives the exact input.

        Parameters
        ----------
        pyramid : Pyramid
            Of the same topology.
        change : str
            What was done, for the history.
        """
        return replace(
            self,
            pyramid=pyramid,
            origin=self.origin.altered(),
            errors=None,
            history=(*self.history, change),
        )

    def restore(self, finest: TriangleMesh | None = None) -> Original:
        """Return what the pyramid was made from; of an altered pyramid, its altered form.

        Parameters
        ----------
        finest : TriangleMesh, optional
            The pyramid's finest mesh, where it has been synthesised already.

        Raises
        ------
        PyramidError
            When the exact original was due and did not come out.
        """
        mesh = self.pyramid.synthesise() if finest is None else finest
        return self.origin.restore(mesh, self.frame)

    @property
    def categories(self) -> tuple[str, ...]:
        """Names of the attributes whose numbers are names, such as classes."""
        points = self.origin.points
        if points is not None:
            return tuple(a.name for a in points.cloud.attributes if is_category(a.dimension))
        return tuple(name for name in self.pyramid.attribute_names if is_category(name))

    def own_categories(self, mesh: TriangleMesh) -> TriangleMesh:
        """Return a mesh of the pyramid with the categories of the input's nearest vertices."""
        names = self.categories
        return with_own_values(mesh, self.pyramid.synthesise(), names) if names else mesh

    def file_mesh(self, mesh: TriangleMesh, *, categories: Categories = "nearest") -> TriangleMesh:
        """Return a mesh of the pyramid in the coordinates of the input.

        Parameters
        ----------
        mesh : TriangleMesh
            In the working frame.
        categories : {"nearest", "number"}
            Categories are those of the nearest input vertex, or, as in the paper, the numbers
            that the filters made of them.
        """
        if categories not in get_args(Categories):
            raise OptionError(
                "{0} is {given!r}; give one of {choices}.",
                "categories",
                given=categories,
                choices=", ".join(get_args(Categories)),
            )
        own = self.own_categories(mesh) if categories == "nearest" else mesh
        return mesh_in_file(own, self.frame)

    def file_details(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return detail vectors with their elevations in the input's unit of z.

        Horizontal components stay in working units (metres for a geographic CRS), since a
        vector in degrees has no length.
        """
        if self.frame.z_scale == 1.0:
            return vectors
        scaled = vectors.copy()
        scaled[:, self.pyramid.channels.index("z")] /= self.frame.z_scale
        return scaled
