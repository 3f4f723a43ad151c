"""Maps of a pyramid's scales: strength of details, roughness, deviation, shape and landforms."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, ScaleMaps
from wavelet_core.errors import OptionError
from wavelet_core.features.landforms import LANDFORMS, landforms
from wavelet_core.features.scale_maps import (
    deviation_by_scale,
    level_at_distance,
    roughness_by_scale,
)
from wavelet_core.features.shape import SHAPE_NAMES, SurfaceShape, surface_shape
from wavelet_core.features.spectrum import vertex_details
from wavelet_core.features.window_shape import level_between, window_shape
from wavelet_core.lifting.spacings import level_spacings
from wavelet_core.progress import part_of
from wavelet_gis.errors import OutputFileError, TerrainWarning
from wavelet_gis.io.formats import PYRAMID_SUFFIX, RASTER_SUFFIXES, suffix_of
from wavelet_gis.model.dem import GridGeometry
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import warn
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.vertex_raster import NO_LABEL, Bands, label_band, value_bands
from wavelet_gis.products.vertex_tables import (
    band_names,
    component_columns,
    energy_columns,
    residual_column,
    scale_layer,
    scale_map_columns,
    scale_map_names,
    shape_layer,
    vertex_layer,
)
from wavelet_gis.workflows.options import HoldsPyramid, metre_of, pyramid_of, require_levels

__all__ = ["FITS", "QUANTITIES", "Details", "Fit", "LevelDetails", "Quantity", "details"]

#: What may be asked for: root mean square detail around each vertex, a column per level; what each
#: level adds, signed; the level at which each vertex went; slope, aspect and curvatures of a level;
#: its landform classes; heights above the means of surroundings of its size; by scale, the angle
#: between the surface and the smooth one, and such heights in standard deviations.
Quantity = Literal[
    "energy", "component", "level", "shape", "landforms", "residual", "roughness", "deviation"
]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)

#: Those of one level.
OF_ONE_LEVEL = ("shape", "landforms", "residual")

#: What quadratics of shape and landforms are fitted to: all that lies within windows of the level's
#: distance, or the neighbours of each vertex on the surface of the level.
Fit = Literal["windows", "surface"]
FITS: tuple[Fit, ...] = get_args(Fit)

#: Those of one level that have a fit.
FITTED = ("shape", "landforms")

#: Those that compare scales, with the function that does, and what their values are.
_BY_SCALE = {
    "roughness": (roughness_by_scale, "degrees between the surface and that of the level"),
    "deviation": (deviation_by_scale, "standard deviations above the surroundings"),
}

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
    what : str
        See `Quantity`.
    level : int
        Whose shape or landforms; of whose size the surroundings of residual heights are.
    channel : str or None
        Whose energy or component; None is the geometry.
    flat_slope, flat_curvature : float
        See `wavelet_core.landforms`.
    fit : str
        Of shape and landforms, see `Fit`.
    distance : float
        Of whose size windows are, in the working unit.
    """

    geo: GeoPyramid
    what: Quantity
    level: int
    channel: str | None
    flat_slope: float = 1.0
    flat_curvature: float = 1e-4
    fit: Fit = "windows"
    distance: float = float("nan")

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
        """Return the quantity as a raster.

        One band per level or per measure of shape; for roughness and deviation the strongest of
        all scales, the spacing at which it is found, then a band for each scale. Landforms are
        places in ``wavelet_core.LANDFORMS``.

        Parameters
        ----------
        cell_size : float, optional
            In the input's unit of x and y; by default the grid of the input, and for points their
            mean spacing.
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.
        """
        geo = self.geo
        if self.what in _BY_SCALE:
            maps = self._scale_maps(part_of(progress, 0.0, 0.8))
            names = scale_map_names(geo, maps, self.what)
            finest = geo.pyramid.synthesise()
            columns, part = scale_map_columns(maps), part_of(progress, 0.8, 1.0)
            return value_bands(geo, finest, columns, names, cell_size, part)
        if self.what == "residual":
            column = residual_column(geo, self.level, part_of(progress, 0.0, 0.8))[:, None]
            name = f"height above the mean around, level {self.level}"
            return value_bands(geo, geo.pyramid.synthesise(), column, (name,), cell_size)
        if self.what in FITTED:
            shape, geometry = self._cell_shape(cell_size, progress)
            if self.what == "landforms":
                return self._landforms(shape, geometry)
            return _shape_bands(shape, geometry)
        mesh = geo.pyramid.mesh(self.level)
        if self.what == "level":
            name = "level at which a vertex went"
            levels = vertex_details(geo.pyramid).level
            return label_band(geo, mesh, levels, name, cell_size, progress)
        columns_of, word = _BY_LEVEL[self.what]
        columns = columns_of(geo, self.channel, part_of(progress, 0.0, 0.15))
        names = band_names(geo, word, part_of(progress, 0.15, 0.5))
        return value_bands(geo, mesh, columns, names, cell_size, part_of(progress, 0.5, 1.0))

    def layer(self, progress: Progress | None = None) -> Layer:
        """Return the vertices as a layer.

        With their shape (landforms as one field more), with what else was asked for by scale, or
        with details and spectrum.

        Parameters
        ----------
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.
        """
        geo = self.geo
        if self.what in FITTED:
            shape = self._shape(self.level, progress)
            classes = self._classes(shape) if self.what == "landforms" else None
            return shape_layer(geo, self.level, shape, classes)
        if self.what == "residual":
            column = residual_column(geo, self.level, progress)[:, None]
            meaning = "Height above the mean of the surroundings, in the input's unit of z"
            name = f"residual_level_{self.level:02d}"
            return scale_layer(geo, name, column, ("residual",), meaning)
        if self.what in _BY_SCALE:
            maps = self._scale_maps(progress)
            names = ("strongest", "spacing", *(f"level_{level:02d}" for level in maps.levels))
            meaning = f"By level: {_BY_SCALE[self.what][1]}; the strongest, and its spacing"
            return scale_layer(geo, self.what, scale_map_columns(maps), names, meaning)
        return vertex_layer(geo, self.channel, progress)

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

    def _scale_maps(self, progress: Progress | None) -> ScaleMaps:
        function, _ = _BY_SCALE[self.what]
        return function(self.geo.pyramid, progress)

    def _classes(self, shape: SurfaceShape) -> NDArray[np.int8]:
        return landforms(shape, flat_slope=self.flat_slope, flat_curvature=self.flat_curvature)

    def _shape(self, at: int, progress: Progress | None) -> SurfaceShape:
        """Return the shape at the vertices of a level."""
        if self.fit == "windows":
            return window_shape(self.geo.pyramid, self.distance, at=at, progress=progress)
        return surface_shape(self.geo.pyramid.mesh(at))

    def _cell_shape(
        self, cell_size: float | None, progress: Progress | None
    ) -> tuple[SurfaceShape, GridGeometry]:
        """Return the shape at the cells of a grid, row by row.

        Slopes in x and y, and second derivatives, are what is interpolated between vertices: half
        way between an aspect of 350 and one of 10 degrees is north, not south.
        """
        pyramid, at = self.geo.pyramid, self.level
        if self.fit == "windows":
            at = max(at, level_between(pyramid, self.distance))
        shape = self._shape(at, part_of(progress, 0.0, 0.7))
        columns, names = np.column_stack([shape.gradient, shape.hessian]), ("p", "q", "r", "s", "t")
        part = part_of(progress, 0.7, 1.0)
        parts = value_bands(self.geo, pyramid.mesh(at), columns, names, cell_size, part)
        cells = parts.values.reshape(len(parts.names), -1).T.astype(np.float64)
        return SurfaceShape(cells[:, :2], cells[:, 2:]), parts.geometry

    def _landforms(self, shape: SurfaceShape, geometry: GridGeometry) -> Bands:
        classes = self._classes(shape)
        labels = np.where(classes < 0, NO_LABEL, classes).astype(np.uint8)
        kinds = ", ".join(f"{k} {name}" for k, name in enumerate(LANDFORMS))
        return Bands(labels.reshape(1, *geometry.shape), (f"landform: {kinds}",), geometry)

    def figures(self) -> dict[str, Any]:
        """Return how strong the details of each level are, as JSON-able values."""
        return {"what": self.what, "levels": [row._asdict() for row in self.levels()]}


def _shape_bands(shape: SurfaceShape, geometry: GridGeometry) -> Bands:
    """Return the shape at the cells of a grid as one band a measure."""
    values = np.stack([shape.named(name).astype(np.float32) for name in SHAPE_NAMES])
    return Bands(values.reshape(-1, *geometry.shape), SHAPE_NAMES, geometry)


def details(
    data: HoldsPyramid | GeoPyramid,
    *,
    what: Quantity = "energy",
    level: int | None = None,
    metres: float | None = None,
    channel: str | None = None,
    flat_slope: float | None = None,
    flat_curvature: float | None = None,
    fit: Fit | None = None,
) -> Details:
    """Return what the scales of a pyramid hold, to be shown as a raster, a layer or figures.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    what : str
        See `Quantity`.
    level : int, optional
        Of shape and landforms, by default the input itself; of whose size the surroundings of
        residual heights are, by default the coarsest.
    metres : float, optional
        Instead: the level of this spacing on the ground (median edge in plan), or the nearest, in
        metres where the CRS names its unit, else in its own.
    channel : str, optional
        Of energy and component; by default the geometry.
    flat_slope, flat_curvature : float, optional
        Of landforms, see `wavelet_core.landforms`; 1 degree and 1e-4 by default.
    fit : str, optional
        Of shape and landforms, see `Fit`: windows of the distance (or of the spacing of the level)
        by default.

    Raises
    ------
    OptionError
        Another quantity, an option that is not of it, a distance that no level has, or details of
        a pyramid without levels.
    """
    geo = pyramid_of(data)
    if what not in QUANTITIES:
        raise OptionError(
            "{0} is {what!r}; give one of {known}.",
            "what",
            what=what,
            known=", ".join(QUANTITIES),
        )
    check_options_of(what, level=level, metres=metres)
    check_options_of(what, flat_slope=flat_slope, flat_curvature=flat_curvature)
    check_options_of(what, fit=fit)
    if fit is not None and fit not in FITS:
        raise OptionError(
            "{0} is {fit!r}; give one of {known}.", "fit", fit=fit, known=", ".join(FITS)
        )
    if channel is not None and what not in ("energy", "component", "level"):
        raise OptionError(
            "{0} is not for {1} {what}, which is of z; leave it out.", "channel", "what", what=what
        )
    if what not in ("shape", "landforms", "level"):
        require_levels(geo)
    if what in _BY_SCALE or metres is not None:
        _warn_of_partition(geo, what)
    chosen = 0 if what == "residual" else geo.pyramid.n_levels
    if metres is not None:
        chosen = level_at_distance(geo.pyramid, metres * metre_of(geo))
    elif level is not None:
        chosen = level
    geo.pyramid.n_vertices(chosen)  # refuses a level that is not there
    bounds = {"flat_slope": flat_slope, "flat_curvature": flat_curvature}
    given: dict[str, Any] = {name: bound for name, bound in bounds.items() if bound is not None}
    if what in FITTED:
        spacing = float(level_spacings(geo.pyramid)[chosen])
        given["distance"] = spacing if metres is None else metres * metre_of(geo)
        # a level without faces has no spacing, and no shape by either fit
        given["fit"] = "surface" if np.isnan(spacing) else fit or "windows"
    return Details(geo, what, chosen, channel, **given)


def check_options_of(what: str, **options: float | str | None) -> None:
    """Raise `OptionError` for options that are given for what they are not, or exclude each other.

    Parameters
    ----------
    what : str
        See `Quantity`.
    **options : float, optional
        ``level`` and ``metres``, the bounds of flat ground, or ``fit``.
    """
    given = [name for name, value in options.items() if value is not None]
    for name in given:
        if name in ("level", "metres") and what not in OF_ONE_LEVEL:
            raise OptionError(
                "{0} is for {1} shape, landforms or residual; leave it out, or ask for one.",
                name,
                "what",
            )
        if name == "fit" and what not in FITTED:
            raise OptionError(
                "{0} is for {1} shape or landforms; leave it out, or ask for one.", name, "what"
            )
        if name.startswith("flat") and what != "landforms":
            raise OptionError(
                "{0} is for {1} landforms; leave it out, or ask for them.", name, "what"
            )
    if {"level", "metres"} <= set(given):
        raise OptionError("{0} and {1} exclude each other; give one.", "level", "metres")


def _warn_of_partition(geo: GeoPyramid, what: str) -> None:
    partition = geo.pyramid.parameters.get("partition")
    if partition != "random":
        warn(
            TerrainWarning,
            "levels_are_no_sizes",
            "the levels of partition {partition} are not of one size on the ground everywhere, as "
            "{what} takes them to be; analyse with {0} random and {1} plane.",
            "partition",
            "prediction",
            partition=partition,
            what=what,
        )
