"""A pyramid together with where it lies, what it came from and how to go back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Pyramid, TriangleMesh
from wavelet_core.accuracy.level_errors import LevelErrors, level_errors
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.model.categories import is_category, with_own_values
from wavelet_gis.model.cloud import PointCloud
from wavelet_gis.model.cloud_origin import PointSource
from wavelet_gis.model.dem import Dem, RasterSource

__all__ = ["GeoPyramid", "MeshSource", "Source"]


@dataclass(frozen=True, slots=True)
class MeshSource:
    """The source of a pyramid that was made from a TIN: its finest mesh is all there is."""

    kind = "tin"
    is_exact = False

    def altered(self) -> MeshSource:
        """Return the source for a pyramid whose coefficients have been changed."""
        return self


Source = RasterSource | PointSource | MeshSource


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
    source : RasterSource, PointSource or MeshSource
        How the finest mesh becomes the input again.
    source_name : str
        The input's file name.
    errors : tuple of LevelErrors, or None
        Size and errors of each level, the finest first, in the input's unit of z.
    history : tuple of str
        One line for each change since the analysis (filters).
    """

    pyramid: Pyramid
    system: CoordinateSystem
    frame: LocalFrame
    vertical_unit: str
    source: Source
    source_name: str
    errors: tuple[LevelErrors, ...] | None = None
    history: tuple[str, ...] = ()

    def with_errors(self, progress: Callable[[float], bool | None] | None = None) -> GeoPyramid:
        """Return the pyramid with the errors of every level computed.

        Parameters
        ----------
        progress : callable, optional
            Called with a fraction in [0, 1]; returning False stops with `Cancelled`.
        """
        unit = self.frame.z_scale
        levels = (
            level._replace(
                rmse_surface=level.rmse_surface / unit,
                max_error_surface=level.max_error_surface / unit,
            )
            for level in level_errors(self.pyramid, progress)
        )
        return replace(self, errors=tuple(levels))

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
            source=self.source.altered(),
            errors=None,
            history=(*self.history, change),
        )

    def restore(self) -> Dem | PointCloud | TriangleMesh:
        """Return what the pyramid was made from; of an altered pyramid, its altered form.

        Raises
        ------
        PyramidError
            When the exact original was due and did not come out.
        """
        finest = self.pyramid.synthesise()
        if isinstance(self.source, MeshSource):
            return self.file_mesh(finest)
        return self.source.restore(finest, self.frame)

    @property
    def categories(self) -> tuple[str, ...]:
        """Names of the attributes that are categories; see `wavelet_gis.model.categories`."""
        if isinstance(self.source, PointSource):
            return tuple(a.name for a in self.source.cloud.attributes if is_category(a.dimension))
        return tuple(name for name in self.pyramid.attribute_names if is_category(name))

    def own_categories(self, mesh: TriangleMesh) -> TriangleMesh:
        """Return a mesh of the pyramid with the categories of the input's nearest vertices."""
        names = self.categories
        return with_own_values(mesh, self.pyramid.synthesise(), names) if names else mesh

    def file_mesh(
        self, mesh: TriangleMesh, *, categories: Literal["nearest", "number"] = "nearest"
    ) -> TriangleMesh:
        """Return a mesh of the pyramid in the coordinates of the input.

        Parameters
        ----------
        mesh : TriangleMesh
            In the working frame.
        categories : {"nearest", "number"}
            Categories are those of the nearest input vertex, or, as in the paper, the numbers
            that the filters made of them.
        """
        if categories == "nearest":
            mesh = self.own_categories(mesh)
        if self.frame.is_identity:
            return mesh
        return TriangleMesh(
            self.frame.to_file(mesh.vertices), mesh.faces, mesh.attributes, mesh.attribute_names
        )

    def file_details(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return detail vectors with their elevations in the input's unit of z.

        Horizontal components stay in working units (metres for a geographic CRS), since a
        vector in degrees has no length.
        """
        if self.frame.z_scale == 1.0:
            return vectors
        scaled = vectors.copy()
        scaled[:, 0 if self.pyramid.signal == "z" else 2] /= self.frame.z_scale
        return scaled
