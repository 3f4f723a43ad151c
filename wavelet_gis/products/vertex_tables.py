"""Vertex-frequency analysis and shape of a pyramid in the units of its input.

Arrays and layers only; files are written by `wavelet_gis.io`, or by QGIS.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wavelet_core import (
    SHAPE_NAMES,
    STAYS,
    Progress,
    ScaleMaps,
    SurfaceShape,
    band_components,
    band_energies,
    heights_above_means,
    level_spacings,
    vertex_details,
)
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.styles import detail_style, vertex_style
from wavelet_gis.products.wkb import points_wkb

__all__ = [
    "band_names",
    "component_columns",
    "energy_columns",
    "residual_column",
    "scale_layer",
    "scale_map_columns",
    "scale_map_names",
    "shape_layer",
    "vertex_layer",
]
FloatArray = NDArray[np.float64]


def energy_columns(
    geo: GeoPyramid, channel: str | None = None, progress: Progress | None = None
) -> FloatArray:
    """Root of the band energies at every vertex of the input, ``(n_vertices, L)``.

    Parameters
    ----------
    geo : GeoPyramid
        What is analysed.
    channel : str, optional
        One of the pyramid's; by default the geometry.
    progress : callable, optional
        See `wavelet_core.features.spectrum.band_energies`.

    Returns
    -------
    ndarray
        Root mean square details, in the input's unit of z or in that of the attribute.
    """
    energies: FloatArray = np.sqrt(band_energies(geo.pyramid, channel, progress))
    return energies / _file_scale(geo, channel)


def component_columns(
    geo: GeoPyramid, channel: str | None = None, progress: Progress | None = None
) -> FloatArray:
    """Return what each level adds to the input at every vertex, ``(n_vertices, L)``, signed.

    Parameters
    ----------
    geo : GeoPyramid
        What is analysed.
    channel : str, optional
        One of the pyramid's; by default z.
    progress : callable, optional
        See `wavelet_core.features.spectrum.band_components`.
    """
    components = band_components(geo.pyramid, channel, progress)
    return components.bands / _file_scale(geo, channel or "z")


def residual_column(geo: GeoPyramid, level: int, progress: Progress | None = None) -> FloatArray:
    """Return how far every vertex is above the mean of its surroundings, ``(n_vertices,)``.

    Parameters
    ----------
    geo : GeoPyramid
        What is analysed.
    level : int
        Whose neighbourhoods the surroundings are.
    progress : callable, optional
        See `wavelet_core.features.scale_maps.heights_above_means`.

    Returns
    -------
    ndarray
        In the input's unit of z.
    """
    above = heights_above_means(geo.pyramid, [level], progress)[:, 0]
    return above / _file_scale(geo, "z")


def scale_map_columns(maps: ScaleMaps) -> FloatArray:
    """Return the strongest value, the spacing where it is found, and the values of each scale.

    Parameters
    ----------
    maps : ScaleMaps
        Of all vertices of the input.
    """
    return np.column_stack([maps.strongest, maps.strongest_distance, maps.values])


def scale_map_names(geo: GeoPyramid, maps: ScaleMaps, what: str) -> tuple[str, ...]:
    """Name of the raster band of each of `scale_map_columns`.

    Parameters
    ----------
    geo : GeoPyramid
        Knows the unit of distances.
    maps : ScaleMaps
        Whose scales are named.
    what : str
        The measure.
    """
    unit = _distance_unit(geo)
    scales = zip(maps.levels, maps.distances, strict=True)
    return (
        f"strongest {what}",
        f"spacing of the strongest, {unit}",
        *(f"{what} of level {level}, spacing {at:.3g} {unit}" for level, at in scales),
    )


def band_names(
    geo: GeoPyramid, what: str = "rms", progress: Progress | None = None
) -> tuple[str, ...]:
    """Name of the raster band of each level, with its spacing; the coarsest level first.

    Parameters
    ----------
    geo : GeoPyramid
        Whose levels are named.
    what : str
        The first word.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    spacings = level_spacings(geo.pyramid, progress)[1:]
    unit = _distance_unit(geo)
    return tuple(
        f"{what} of level {level}, spacing {spacing:.3g} {unit}"
        for level, spacing in enumerate(spacings)
    )


def vertex_layer(
    geo: GeoPyramid, channel: str | None = None, progress: Progress | None = None
) -> Layer:
    """Every vertex of the input with the level at which it went, its details and its spectrum.

    Parameters
    ----------
    geo : GeoPyramid
        What is analysed.
    channel : str, optional
        Of the spectrum; by default the geometry.
    progress : callable, optional
        See `wavelet_core.features.spectrum.band_energies`.

    Returns
    -------
    Layer
        ``vertex_spectra``: ``vertex_id``, ``level`` (-1 of the coarsest mesh's vertices, which
        have no details: NULL), ``w_<channel>``, ``magnitude``, and ``rms_00`` and on, the root
        of the band energies.
    """
    pyramid = geo.pyramid
    finest = pyramid.synthesise()
    details = vertex_details(pyramid)
    vectors = geo.file_details(details.vectors)
    magnitude = np.linalg.norm(vectors, axis=1)
    energies = energy_columns(geo, channel, progress)
    fields: dict[str, NDArray] = {
        "vertex_id": np.arange(finest.n_vertices, dtype=np.int64),
        "level": details.level,
    }
    for k, name in enumerate(pyramid.channels):
        fields[f"w_{name}"] = vectors[:, k]
    fields["magnitude"] = magnitude
    for level in range(pyramid.n_levels):
        fields[f"rms_{level:02d}"] = energies[:, level]
    known = magnitude[details.level != STAYS]
    return Layer(
        "vertex_spectra",
        "Point Z",
        points_wkb(geo.frame.to_file(finest.vertices)),
        fields,
        detail_style(max(pyramid.n_levels - 1, 0), pyramid.n_levels, known),
        "Spectra of the vertices",
        "One input vertex a row: level at which it went, detail vector, root mean square detail "
        "around it in the band of each level",
    )


def scale_layer(
    geo: GeoPyramid, what: str, columns: FloatArray, names: Sequence[str], meaning: str
) -> Layer:
    """Return every vertex of the input with values of scales.

    Parameters
    ----------
    geo : GeoPyramid
        What is analysed.
    what : str
        Name of the layer.
    columns : (n_vertices, n_columns) float64
        The values.
    names : sequence of str
        Of the fields.
    meaning : str
        What the values are, for people.
    """
    vertices = geo.frame.to_file(geo.pyramid.synthesise().vertices)
    fields: dict[str, NDArray] = {"vertex_id": np.arange(len(vertices), dtype=np.int64)}
    fields.update(zip(names, columns.T, strict=True))
    title = f"{what.replace('_', ' ').capitalize()} of the vertices"
    return Layer(what, "Point Z", points_wkb(vertices), fields, vertex_style(), title, meaning)


def shape_layer(
    geo: GeoPyramid, level: int, shape: SurfaceShape, classes: NDArray[np.int8] | None = None
) -> Layer:
    """Return the vertices of a level with slope, aspect and curvatures.

    Parameters
    ----------
    geo : GeoPyramid
        What is analysed.
    level : int
        Whose vertices.
    shape : SurfaceShape
        There, in the working frame.
    classes : (n_vertices,) int8, optional
        Its landforms, as one field more: ``landform``.
    """
    mesh = geo.pyramid.mesh(level)
    vertices = geo.frame.to_file(mesh.vertices)
    fields: dict[str, NDArray] = {
        "vertex_id": geo.pyramid.vertex_ids(level),
        "elevation": vertices[:, 2],
    }
    fields.update({name: shape.named(name) for name in SHAPE_NAMES})
    if classes is not None:
        fields["landform"] = classes.astype(np.int32)
    return Layer(
        f"shape_level_{level:02d}",
        "Point Z",
        points_wkb(vertices),
        fields,
        vertex_style(),
        f"Shape of level {level}",
        "Slope and aspect (of descent, from north) in degrees; curvatures in one over the unit of "
        "the working frame, convex positive",
    )


def _distance_unit(geo: GeoPyramid) -> str:
    is_metre = geo.system.kind == "projected" and geo.system.horizontal_unit == 1.0
    return "m" if is_metre or geo.system.kind == "geographic" else "units"


def _file_scale(geo: GeoPyramid, channel: str | None) -> float:
    """Working units in one of the file's, for a channel."""
    is_height = channel == "z" or (channel is None and geo.pyramid.coordinates == ("z",))
    return geo.frame.z_scale if is_height else 1.0
