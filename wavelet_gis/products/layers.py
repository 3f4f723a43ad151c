"""The layers of a pyramid as arrays: what QGIS shows of it.

``coarse_tin`` (Polygon Z), ``coarse_vertices`` (Point Z) and ``detail_level_00`` and on (Point Z at
each removed vertex). Who writes them, pyogrio or QGIS, is another module's matter.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from wavelet_core import OptionError, TriangleMesh
from wavelet_gis.model.attributes.categories import Categories
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import note
from wavelet_gis.products.styles import detail_style, tin_style, vertex_style
from wavelet_gis.products.wkb import points_wkb, triangles_wkb

__all__ = [
    "Layer",
    "Layers",
    "check_layers",
    "coarse_layers",
    "detail_layer_name",
    "detail_layers",
    "n_features",
    "pyramid_layers",
    "tin_layers",
]

#: Vector layers of a pyramid file: in proportion, the coarse TIN unless it is large and the details
#: of the coarser levels; coarse TIN and all details; the coarse TIN alone; or none.
Layers = Literal["auto", "all", "coarse", "none"]

#: Features that "auto" may write: what QGIS shows at once, in some 10 MB where all are points.
MOST_FEATURES = 80_000
#: The coarse TIN and its vertices are layers in "auto" as long as they have at most so many
#: features, whatever is left for details: those of 50,000 vertices, in some 35 MB.
MOST_COARSE_FEATURES = 150_000


@dataclass(frozen=True, slots=True)
class Layer:
    """A vector layer in the coordinates of the input.

    Attributes
    ----------
    name : str
        Of the layer.
    geometry_type : {"Point Z", "LineString Z", "Polygon Z"}
        Of all its features.
    geometry : (n,) array of bytes
        Well-known binary.
    fields : dict of str to (n,) array
        Integers and floats.
    style : str
        QML.
    title, description : str
        For people.
    """

    name: str
    geometry_type: Literal["Point Z", "LineString Z", "Polygon Z"]
    geometry: NDArray[Any]
    fields: dict[str, NDArray[Any]]
    style: str
    title: str
    description: str


def pyramid_layers(geo: GeoPyramid, layers: str = "auto") -> Iterator[Layer]:
    """Yield the layers that a pyramid file is to have, and note what is left out.

    Parameters
    ----------
    geo : GeoPyramid
        Where they are taken from.
    layers : {"auto", "all", "coarse", "none"}
        Which.

    Raises
    ------
    OptionError
        Another name.
    """
    check_layers(layers)
    if layers == "none":
        return
    if _has_coarse(geo, layers):
        yield from coarse_layers(geo)
    else:
        note(
            "coarse_layers_left_out",
            "the coarse TIN, {n_features:,} triangles, is no layer, to keep the file small; "
            "extract takes it out of the pyramid, and {0} coarse writes it into the file",
            "layers",
            n_features=geo.pyramid.n_faces(0),
        )
    n_levels = _n_details(geo, layers)
    if n_levels:
        yield from islice(detail_layers(geo), n_levels)
    n_left_out = geo.pyramid.n_levels - n_levels
    if layers == "auto" and n_left_out:
        finer = geo.pyramid.steps[n_levels:]
        note(
            "layers_left_out",
            "the details of the finest levels ({n_levels}), {n_features:,} points, are no layers, "
            "to keep the file small; they are in the pyramid, and {0} all writes them too",
            "layers",
            n_levels=n_left_out,
            n_features=sum(step.n_odd for step in finer),
        )


def n_features(geo: GeoPyramid, layers: str) -> int:
    """Return how many features those layers have that `pyramid_layers` yields."""
    if layers == "none":
        return 0
    n_details = sum(step.n_odd for step in geo.pyramid.steps[: _n_details(geo, layers)])
    return n_details + (_n_coarse(geo) if _has_coarse(geo, layers) else 0)


def _n_coarse(geo: GeoPyramid) -> int:
    return geo.pyramid.n_vertices(0) + geo.pyramid.n_faces(0)


def _has_coarse(geo: GeoPyramid, layers: str) -> bool:
    return layers != "auto" or _n_coarse(geo) <= MOST_COARSE_FEATURES


def _n_details(geo: GeoPyramid, layers: str) -> int:
    """Return of how many levels, from the coarsest on, the details are layers."""
    if layers == "auto":
        return shown_details(geo)
    return geo.pyramid.n_levels if layers == "all" else 0


def check_layers(layers: str) -> None:
    """Raise `OptionError` unless a choice of layers is one of `Layers`."""
    if layers not in get_args(Layers):
        raise OptionError(
            "{0} is {given!r}; give one of {choices}.",
            "layers",
            given=layers,
            choices=", ".join(get_args(Layers)),
        )


def shown_details(geo: GeoPyramid) -> int:
    """Return of how many levels, from the coarsest on, the details are layers by themselves."""
    pyramid = geo.pyramid
    n_features = _n_coarse(geo) if _has_coarse(geo, "auto") else 0
    for level, step in enumerate(pyramid.steps):
        n_features += step.n_odd
        if n_features > MOST_FEATURES:
            return level
    return pyramid.n_levels


def coarse_layers(geo: GeoPyramid, level: int = 0) -> Iterator[Layer]:
    """Yield the TIN and the vertices of a level, by default the coarsest.

    Parameters
    ----------
    geo : GeoPyramid
        Where they are taken from.
    level : int
        Which level.
    """
    mesh = geo.pyramid.mesh(level)
    name = "coarse" if level == 0 else f"level_{level:02d}"
    yield from tin_layers(geo, mesh, geo.pyramid.vertex_ids(level), name)


def tin_layers(
    geo: GeoPyramid,
    mesh: TriangleMesh,
    vertex_ids: NDArray[np.int64],
    name: str = "tin",
    categories: Categories = "nearest",
) -> Iterator[Layer]:
    """Yield the layers of a TIN: ``<name>_tin`` and ``<name>_vertices``.

    Parameters
    ----------
    geo : GeoPyramid
        Gives the frame of the mesh.
    mesh : TriangleMesh
        In the working frame, where slopes are measured.
    vertex_ids : (n_vertices,) int64
        Ids of the vertices in the input.
    name : str
        What the layers' names begin with.
    categories : {"nearest", "number"}
        See `GeoPyramid.file_mesh`.
    """
    if categories == "nearest":
        mesh = geo.own_categories(mesh)
    vertices = geo.frame.to_file(mesh.vertices)
    corners = vertices[mesh.faces]
    elevation = corners[:, :, 2].mean(axis=1)
    slope = slopes(mesh)
    yield Layer(
        f"{name}_tin",
        "Polygon Z",
        triangles_wkb(vertices, mesh.faces),
        {
            "triangle_id": np.arange(mesh.n_faces, dtype=np.int64),
            "vertex_a": vertex_ids[mesh.faces[:, 0]],
            "vertex_b": vertex_ids[mesh.faces[:, 1]],
            "vertex_c": vertex_ids[mesh.faces[:, 2]],
            "elevation": elevation,
            "slope": slope,
        },
        tin_style(elevation),
        "Coarse TIN by elevation" if name == "coarse" else "TIN by elevation",
        "One triangle a row: mean elevation, and slope in degrees",
    )
    fields: dict[str, NDArray[Any]] = {"vertex_id": vertex_ids, "elevation": vertices[:, 2]}
    for k, attribute in enumerate(mesh.attribute_names):
        fields[_free_name(attribute, [*fields, *_RESERVED])] = mesh.attributes[:, k]
    yield Layer(
        f"{name}_vertices",
        "Point Z",
        points_wkb(vertices),
        fields,
        vertex_style(),
        "Coarse vertices" if name == "coarse" else "Vertices",
        "One vertex a row: id in the input, elevation and attributes",
    )


def detail_layers(geo: GeoPyramid) -> Iterator[Layer]:
    """Yield a layer of details for each step, coarsest first, made one at a time.

    Parameters
    ----------
    geo : GeoPyramid
        Where they are taken from.
    """
    pyramid = geo.pyramid
    names: list[str] = []
    for channel in pyramid.channels:
        names.append(_free_name(f"w_{channel}", [*names, *_RESERVED, *_DETAIL_FIELDS]))
    for level, detail in pyramid.details():
        vectors = geo.file_details(detail.vectors)
        magnitude = np.linalg.norm(vectors, axis=1)
        yield Layer(
            detail_layer_name(level),
            "Point Z",
            points_wkb(geo.frame.to_file(detail.positions)),
            {
                "vertex_id": detail.vertex_ids,
                "level": np.full(len(vectors), level, dtype=np.int32),
                **{name: vectors[:, k] for k, name in enumerate(names)},
                "magnitude": magnitude,
            },
            detail_style(level, pyramid.n_levels, magnitude),
            f"Details of level {level}",
            f"Vertices that the step from level {level + 1} to {level} removed, with their "
            "detail vectors",
        )


def detail_layer_name(level: int) -> str:
    """Name of the layer of a step's details."""
    return f"detail_level_{level:02d}"


def slopes(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Slope of each face in degrees; 90 for an upright one.

    Examples
    --------
    >>> from wavelet_core import OptionError, TriangleMesh
    >>> mesh = TriangleMesh([[0, 0, 0], [1, 0, 1], [0, 1, 0]], [[0, 1, 2]])
    >>> slopes(mesh).round(6).tolist()
    [45.0]
    """
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    run = np.hypot(normals[:, 0], normals[:, 1])
    return np.degrees(np.arctan2(run, np.abs(normals[:, 2])))


_RESERVED = ("fid", "geom")
_DETAIL_FIELDS = ("vertex_id", "level", "magnitude")


def _free_name(wanted: str, taken: Sequence[str]) -> str:
    """Return a column name that differs from others in more than case, as SQLite needs."""
    used = {name.lower() for name in taken}
    name, k = wanted, 2
    while name.lower() in used:
        name, k = f"{wanted}_{k}", k + 1
    return name
