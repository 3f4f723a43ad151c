"""Details of a pyramid: their strength by level, what each level adds, shape by level."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from wavelet_core import Progress, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.features.shape import SHAPE_NAMES, SurfaceShape, surface_shape
from wavelet_core.features.spectrum import vertex_details
from wavelet_core.lifting.spacings import level_spacings
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.formats import PYRAMID_SUFFIX, RASTER_SUFFIXES, suffix_of
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.vertex_raster import Bands, label_band, value_bands
from wavelet_gis.products.vertex_tables import (
    band_names,
    component_columns,
    energy_columns,
    shape_layer,
    vertex_layer,
)
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of, require_levels

__all__ = ["QUANTITIES", "Details", "LevelDetails", "Quantity", "details"]

#: What may be asked for: root mean square detail around each vertex, a column per level; what each
#: level adds, signed; the level at which each vertex went; slope, aspect and curvatures.
Quantity = Literal["energy", "component", "level", "shape"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)


#: Those with a column a level: what gives the columns, and the first word of their names.
_BY_LEVEL = {"energy": (energy_columns, "rms"), "component": (component_columns, "component")}


class LevelDetails(NamedTuple):
    """The details of one level.

    level : int
    spacing : float, median edge length of the mesh that they belong to, in the working unit
    n_details : int
    rms, largest : float, of their magnitudes, in the input's unit of z
    """

    level: int
    spacing: float
    n_details: int
    rms: float
    largest: float


@dataclass(frozen=True, slots=True)
class Details:
    """The details of a pyramid, to be shown as a raster, a layer or figures.

    Attributes
    ----------
    geo : GeoPyramid
        The pyramid.
    what : {"energy", "component", "level", "shape"}
        See `Quantity`.
    level : int
        Whose shape.
    channel : str or None
        Whose energy or component; None is the geometry.
    """

    geo: GeoPyramid
    what: Quantity
    level: int
    channel: str | None

    def levels(self) -> list[LevelDetails]:
        """Return how strong the details of each level are, the coarsest first."""
        spacings = level_spacings(self.geo.pyramid)[1:]
        rows = []
        for level, step in enumerate(self.geo.pyramid.steps):
            magnitude = np.linalg.norm(self.geo.file_details(step.details), axis=1)
            rms = float(np.sqrt((magnitude**2).mean())) if len(magnitude) else 0.0
            largest = float(magnitude.max(initial=0.0))
            rows.append(LevelDetails(level, float(spacings[level]), step.n_odd, rms, largest))
        return rows

    def raster(self, cell_size: float | None = None, progress: Progress | None = None) -> Bands:
        """Return the quantity as a raster, one band per level or per measure of shape.

        Parameters
        ----------
        cell_size : float, optional
            In the input's unit of x and y; by default the grid of the input, and for points their
            mean spacing.
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.
        """
        geo = self.geo
        mesh = geo.pyramid.mesh(self.level)
        if self.what == "level":
            name = "level at which a vertex went"
            return label_band(geo, mesh, vertex_details(geo.pyramid).level, name, cell_size)
        if self.what == "shape":
            return _shape_bands(geo, mesh, cell_size)
        columns_of, word = _BY_LEVEL[self.what]
        columns = columns_of(geo, self.channel, progress)
        return value_bands(geo, mesh, columns, band_names(geo, word), cell_size)

    def layer(self, progress: Progress | None = None) -> Layer:
        """Return the vertices as a layer: with their shape, or with details and spectrum.

        Parameters
        ----------
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.
        """
        if self.what == "shape":
            return shape_layer(self.geo, self.level)
        return vertex_layer(self.geo, self.channel, progress)

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        cell_size: float | None = None,
        progress: Progress | None = None,
    ) -> dict[str, Any]:
        """Write points or a raster, by the suffix; see `wavelet_gis.workflows.save.save`.

        Returns
        -------
        dict
            Bands and shape of the raster, or the layer's name and number of points.
        """
        suffix = suffix_of(path)
        if suffix in RASTER_SUFFIXES:
            from wavelet_gis.io.raster import write_bands

            bands = self.raster(cell_size, progress)
            write_bands(path, bands, self.geo.system.wkt)
            return {"bands": list(bands.names), "shape": list(bands.geometry.shape)}
        if suffix == PYRAMID_SUFFIX:
            from wavelet_gis.io.vector.vector_writer import add_layers

            layer = self.layer(progress)
            add_layers(path, [layer], self.geo.system)
            return {"layer": layer.name, "n_points": len(layer.geometry)}
        raise OutputFileError(f"{path}: details are written as {PYRAMID_SUFFIX} or .tif.")

    def figures(self) -> dict[str, Any]:
        """Return how strong the details of each level are, as JSON-able values."""
        return {"what": self.what, "levels": [row._asdict() for row in self.levels()]}


def _shape_bands(geo: GeoPyramid, mesh: TriangleMesh, cell_size: float | None) -> Bands:
    """Return the shape of a surface by cell.

    Slopes in x and y, and second derivatives, are what is interpolated between vertices: half way
    between an aspect of 350 and one of 10 degrees is north, not south.
    """
    at_vertices = surface_shape(mesh)
    columns = np.column_stack([at_vertices.gradient, at_vertices.hessian])
    parts = value_bands(geo, mesh, columns, ("p", "q", "r", "s", "t"), cell_size)
    cells = parts.values.reshape(len(parts.names), -1).T.astype(np.float64)
    shape = SurfaceShape(cells[:, :2], cells[:, 2:])
    values = np.stack([shape.named(name).astype(np.float32) for name in SHAPE_NAMES])
    return Bands(values.reshape(-1, *parts.geometry.shape), SHAPE_NAMES, parts.geometry)


def details(
    data: HoldsPyramid | GeoPyramid,
    *,
    what: Quantity = "energy",
    level: int | None = None,
    channel: str | None = None,
) -> Details:
    """Return the details of a pyramid, to be shown as a raster, a layer or figures.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    what : {"energy", "component", "level", "shape"}
        See `Quantity`.
    level : int, optional
        Of the shape; by default the input itself.
    channel : str, optional
        Of energy and component; by default the geometry.

    Raises
    ------
    OptionError
        Another quantity, a level for anything but the shape, a channel for that, or details of a
        pyramid without levels.
    """
    geo = pyramid_of(data)
    if what not in QUANTITIES:
        raise OptionError(
            "{0} is {what!r}; give one of {known}.",
            "what",
            what=what,
            known=", ".join(QUANTITIES),
        )
    check_level_of(what, level)
    if channel is not None and what == "shape":
        raise OptionError(
            "{0} is not for {1} shape, which is of z; leave it out.", "channel", "what"
        )
    if what not in ("shape", "level"):
        require_levels(geo)
    chosen = geo.pyramid.n_levels if level is None else level
    return Details(geo, what, chosen, channel)


def check_level_of(what: str, level: int | None) -> None:
    """Raise `OptionError` if a level was given for anything but the shape."""
    if level is not None and what != "shape":
        raise OptionError("{0} is for {1} shape; leave it out, or ask for it.", "level", "what")
