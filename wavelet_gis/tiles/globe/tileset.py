"""A terrain as a set of quantized-mesh tiles for globes: all zooms, with errors that halve."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import OptionError, Progress
from wavelet_core.progress import part_of, report
from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.crs.projection import projected
from wavelet_gis.errors import CrsError, InputFileError, TerrainWarning
from wavelet_gis.io.atomic import new_folder
from wavelet_gis.io.read_back import write_bytes, write_text
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import warn
from wavelet_gis.tiles.globe.edges import TileEdges, tile_edges
from wavelet_gis.tiles.globe.normals import normals_at
from wavelet_gis.tiles.globe.plan import TilesetPlan, plan_tiles
from wavelet_gis.tiles.globe.quantized_mesh import QuantizedTile, encoded_tile
from wavelet_gis.tiles.globe.refinement import refined
from wavelet_gis.tiles.globe.source import GlobePoints, SourceSurface, source_surface
from wavelet_gis.tiles.globe.tile_grid import STEPS, Tile, TileRange, ranges_of, tile_width
from wavelet_gis.tiles.globe.tile_mesh import (
    OnTile,
    TileMesh,
    errors_on,
    finest_mesh,
    joined,
    on_tile,
    simplified,
    with_points,
)
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of, warn_of_error_above

__all__ = ["LAYER", "Tileset", "ZoomFigures", "globe_points", "terrain_tiles"]

#: The file that describes all tiles.
LAYER = "layer.json"

#: Shares of a zoom's error that vertices may be off, tried one after the other until all points of
#: the input keep it; between tries the points that do not are made vertices that stay. On crops of
#: Jacksboro and TM1, 0.4 instead of 0.8 takes 38 to 43 % more bytes and 0.9 takes 4 to 6 % fewer;
#: 0.8 once takes 32 to 67 % more, and ten times what five times do.
_SHARES = (0.8, 0.8, 0.8, 0.8, 0.8, 0.6, 0.4, 0.2, 0.0)

#: Of the finest zoom's error, what the chains along edges may be off. Half of it takes 2 % more
#: bytes on the same crops, twice as much 1 to 2 % fewer.
_SHARE_OF_CHAINS = 0.4

#: Of a zoom's error, what the finer mesh may be off that is handed on to the next coarser zoom. A
#: TIN of a TIN is off by more between vertices than at them, so those need room. From half of it to
#: twice as much nothing changes on the same crops (0.2 %); with four times as much 26 % more bytes.
_SHARE_HANDED_ON = 1 / 16

#: Of the time: the surface that tiles are made of. And of that for a tile: until its error is kept.
_SHARE_OF_SOURCE = 0.03
_PART_OF_TRIES = 0.8

#: More tiles than this are refused rather than tried: as many as 16 billion points have.
_MOST_TILES = 1_000_000


class ZoomFigures(NamedTuple):
    """What a zoom has.

    zoom : int
    n_tiles, n_vertices, n_bytes : int
    promised, max_error : float, metres, at all points of the input
    n_uncovered : int, points of the input that no triangle covers, which have no error
    """

    zoom: int
    n_tiles: int
    n_vertices: int
    n_bytes: int
    promised: float
    max_error: float
    n_uncovered: int


class _Off(NamedTuple):
    """How far tiles are off: at vertices of the input, at all its points, and points beside them.

    Of points that share x and y one is a vertex.
    """

    at_vertices: float = 0.0
    at_all: float = 0.0
    n_uncovered: int = 0

    def with_those(self, other: _Off) -> _Off:
        """Return what holds for the points of both."""
        return _Off(
            max(self.at_vertices, other.at_vertices),
            max(self.at_all, other.at_all),
            self.n_uncovered + other.n_uncovered,
        )


@dataclass(frozen=True, slots=True)
class Tileset:
    """What was written.

    Attributes
    ----------
    bounds : tuple of float
        West, south, east and north of the data in degrees.
    zooms : tuple of ZoomFigures
        From 0 up.
    height_step : float
        What heights are whole multiples of, metres.
    """

    bounds: tuple[float, float, float, float]
    zooms: tuple[ZoomFigures, ...]
    height_step: float

    def figures(self) -> dict[str, Any]:
        """Return it as JSON-able values."""
        return {
            "bounds": list(self.bounds),
            "height_step": self.height_step,
            "n_tiles": sum(zoom.n_tiles for zoom in self.zooms),
            "n_bytes": sum(zoom.n_bytes for zoom in self.zooms),
            "zooms": [zoom._asdict() for zoom in self.zooms],
        }


def terrain_tiles(
    data: Terrain | HoldsPyramid | GeoPyramid,
    folder: str | os.PathLike[str],
    *,
    level: int | None = None,
    zoom: int | None = None,
    max_error: float | None = None,
    fill: float = 0.0,
    normals: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Tileset:
    """Write a terrain as quantized-mesh tiles, for globes such as CesiumJS; return their figures.

    Parameters
    ----------
    data : Terrain, Analysis, Filtered or GeoPyramid
        From `wavelet_gis.open`. Its CRS says where on earth it is; heights are written as they
        are, in metres.
    folder : path
        A folder that does not exist yet, or one of an earlier tile set, to be replaced.
    level : int, optional
        Of a pyramid; by default the finest.
    zoom : int, optional
        The finest; by default the one whose tiles have some 128 points along each side.
    max_error : float, optional
        Largest vertical error at the points, metres, that the finest zoom may have; twice that on
        the next coarser one and so on. By default a tenth of the spacing of the points.
    fill : float
        Height of the ground beyond the data, metres.
    normals : bool
        Whether vertices have normals, for light and shade.
    overwrite : bool
        Whether a tile set that exists may be replaced.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    CrsError
        Without a CRS that gives the place on earth.
    OptionError
        A zoom or an error that the format cannot hold.
    OutputFileError
        A folder that may not be replaced or cannot be written.
    Cancelled
        ``progress`` returned False.
    """
    terrain = data if isinstance(data, Terrain) else pyramid_of(data)
    if level is not None and isinstance(terrain, Terrain):
        raise OptionError("{0} is for pyramids, and this is a terrain; leave it out.", "level")
    globe = globe_points(terrain, level)
    name = terrain.source_name if isinstance(terrain, GeoPyramid) else terrain.name
    with new_folder(folder, LAYER, overwrite=overwrite) as scratch:
        plan = plan_tiles(globe, zoom, max_error, fill)
        return _Writer(globe, plan, scratch, normals, progress).run(Path(name).name)


def globe_points(data: Terrain | GeoPyramid, level: int | None = None) -> GlobePoints:
    """Return the TIN of a terrain, or of a level of a pyramid, on the earth.

    Parameters
    ----------
    data : Terrain or GeoPyramid
    level : int, optional
        Of a pyramid; by default the finest.

    Raises
    ------
    InputFileError
        Without a triangle.
    CrsError
        Without a CRS that gives the place on earth, or where that is on both sides of 180 degrees.
    """
    if isinstance(data, Terrain):
        mesh, name, points = data.mesh, data.name, data.points_for_errors()
    else:
        mesh, name = data.pyramid.synthesise(level), data.source_name
        points = mesh.vertices
        if data.origin.points is not None and level in (None, data.pyramid.n_levels):
            points = data.origin.points.points_for_errors(mesh, data.frame)
    if not mesh.n_faces:
        raise InputFileError(f"{name}: there is no triangle, so there is no surface to tile.")
    if data.system.wkt is None or data.system.kind == "unknown":
        raise CrsError(
            "{name}: nothing says where on earth this is; give its CRS with {0}.",
            "crs",
            name=name,
        )
    n, height = mesh.n_vertices, mesh.vertices[:, 2]
    is_other = np.ones(len(points), dtype=bool)
    is_other[:n] = points[:n, 2] != height  # a vertex at their mean
    x, y, z = _on_earth(data, mesh.vertices)
    if np.ptp(x) > 180.0 or np.abs(x).max(initial=0.0) > 180.0:
        raise CrsError(
            "{name}: the terrain lies on both sides of longitude 180; cut it there, and make tiles "
            "of each part.",
            name=name,
        )
    others = np.column_stack(_on_earth(data, points[is_other]))
    return GlobePoints(x, y, z, mesh.faces, others)


def _on_earth(
    data: Terrain | GeoPyramid, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return longitudes, latitudes and heights in metres of points in the working frame."""
    places = data.frame.to_file(points)
    longitude, latitude = projected(
        data.system, coordinate_system("EPSG:4326"), places[:, 0], places[:, 1]
    )
    return longitude, latitude, points[:, 2] * data.system.working_unit


class _Writer:
    """The way from the finest zoom up to the first."""

    def __init__(
        self,
        globe: GlobePoints,
        plan: TilesetPlan,
        folder: Path,
        normals: bool,
        progress: Progress | None,
    ) -> None:
        self._globe = globe
        self._plan = plan
        self._folder = folder
        self._has_normals = normals
        self._progress = progress
        self._source = source_surface(globe, plan.zoom, plan.fill_height)
        report(progress, _SHARE_OF_SOURCE)

    def run(self, name: str) -> Tileset:
        """Write all tiles and the file that lists them."""
        plan, source = self._plan, self._source
        low, high = source.extent() * (tile_width(plan.zoom) / STEPS) - [180.0, 90.0]
        ranges = ranges_of((*low.tolist(), *high.tolist()), plan.zoom)
        n_tiles = sum(len(tiles) for tiles in ranges)
        if n_tiles > _MOST_TILES:
            raise OptionError(
                "{name}: with zooms up to {zoom} there are {n_tiles:,} tiles around it, nearly all "
                "of them without a point; give a smaller {0}, or cut the terrain into parts.",
                "zoom",
                name=name,
                zoom=plan.zoom,
                n_tiles=n_tiles,
            )
        edges = tile_edges(
            source, ranges[-1], plan.height_step, _SHARE_OF_CHAINS * plan.max_error, plan.n_parts()
        )
        figures: list[ZoomFigures] = []
        offs: list[_Off] = []
        meshes: dict[Tile, TileMesh] = {}
        ends = _ends_of_zooms(len(ranges))
        for begin, end, tiles in zip([_SHARE_OF_SOURCE, *ends], ends, ranges[::-1], strict=False):
            of_zoom = part_of(self._progress, begin, end)
            n_done, n_all = 0, source.n_points + len(tiles)
            made: dict[Tile, TileMesh] = {}
            drawn: dict[Tile, OnTile] = {}
            worst = _Off()
            for tile in tiles.tiles():
                children = [meshes.pop(child) for child in tile.children() if child in meshes]
                points = source.points_in(tile)
                of_tile = part_of(of_zoom, n_done / n_all, (n_done + len(points) + 1) / n_all)
                made[tile], drawn[tile], off = _best(
                    source, edges, plan, tile, children, points, of_tile
                )
                worst = worst.with_those(off)
                n_done += len(points) + 1
            meshes = made
            n_vertices = sum(len(on.u) for on in drawn.values())
            n_bytes = self._write(drawn)
            figures.append(
                ZoomFigures(
                    tiles.zoom,
                    len(drawn),
                    n_vertices,
                    n_bytes,
                    plan.error_at(tiles.zoom),
                    worst.at_all,
                    worst.n_uncovered,
                )
            )
            offs.append(worst)
        self._warn_of_errors(figures, offs, name)
        longitude, latitude = self._globe.longitude, self._globe.latitude
        west, south, east, north = (
            float(value)
            for value in (longitude.min(), latitude.min(), longitude.max(), latitude.max())
        )
        bounds = (west, south, east, north)
        layer = _layer(ranges, bounds, name, self._has_normals)
        write_text(self._folder / LAYER, json.dumps(layer, indent=1) + "\n")
        return Tileset(bounds, tuple(figures[::-1]), plan.height_step)

    def _warn_of_errors(self, figures: list[ZoomFigures], offs: list[_Off], name: str) -> None:
        """Warn where a zoom has not kept its error, as on points like a field of spikes."""
        if n_uncovered := max(zoom.n_uncovered for zoom in figures):
            warn(
                TerrainWarning,
                "zoom_with_holes",
                "{name}: at some zooms {count} points are over no triangle; their tiles have holes "
                "where their triangles are too thin for the format (a larger {0} helps)",
                "max_error",
                stacklevel=4,
                name=name,
                count=n_uncovered,
            )
        above = [
            zoom._replace(max_error=off.at_vertices)
            for zoom, off in zip(figures, offs, strict=True)
            if off.at_vertices > zoom.promised
        ]
        if not above:
            finest = self._plan.max_error
            warn_of_error_above(name, figures[0].max_error, None, max_error=finest)
        if above:
            worst = max(above, key=lambda zoom: zoom.max_error / zoom.promised)
            warn(
                TerrainWarning,
                "zoom_error_exceeded",
                "{name}: at {count} of {n_zooms} zooms some points are off by more than promised, "
                "at zoom {zoom} by {error:.3g} m instead of {promised:.3g} m; next to steps this "
                "steep the format's own rounding counts (a larger {0} keeps its promise)",
                "max_error",
                stacklevel=4,
                name=name,
                count=len(above),
                n_zooms=len(figures),
                zoom=worst.zoom,
                error=worst.max_error,
                promised=worst.promised,
            )

    def _write(self, drawn: dict[Tile, OnTile]) -> int:
        """Write the tiles of a zoom; return their size in bytes."""
        normals = (
            normals_at(self._source, drawn) if self._has_normals else dict.fromkeys(drawn, None)
        )
        n_bytes = 0
        for tile, on in drawn.items():
            content = encoded_tile(
                QuantizedTile(
                    tile.bounds(),
                    on.u,
                    on.v,
                    on.height,
                    self._plan.height_step,
                    on.faces,
                    normals[tile],
                )
            )
            path = self._folder / str(tile.zoom) / str(tile.x) / f"{tile.y}.terrain"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_bytes(path, content)
            n_bytes += len(content)
        return n_bytes


def _best(
    source: SourceSurface,
    edges: TileEdges,
    plan: TilesetPlan,
    tile: Tile,
    children: list[TileMesh],
    points: NDArray[np.float64],
    progress: Progress | None,
) -> tuple[TileMesh, OnTile, _Off]:
    """Return what a tile hands on, what is drawn of it, and how far that is off at all points."""
    border = edges.border(tile)
    if children:
        mesh = joined(children, border)
    else:
        n_parts = edges.n_parts[tile.zoom]
        around = source.ring_in(tile) if tile.zoom == plan.zoom else points[:0]
        mesh = finest_mesh(
            border, np.concatenate([points, around]), plan.height_step, n_parts, plan.fill
        )
    if not len(points):
        return mesh, on_tile(mesh, tile, plan.zoom), _Off()  # level, and cut as the earth is round
    promised = plan.error_at(tile.zoom)
    kept: NDArray[np.bool_] = np.zeros(len(mesh.x), dtype=bool)
    best: tuple[tuple[int, float, int], OnTile] | None = None
    for n_tried, share in enumerate(_SHARES):
        report(progress, _part_after(n_tried))
        smaller = simplified(mesh, border, tile, plan.height_step, share * promised, kept)
        report(progress, _part_after(n_tried + 0.7))
        drawn = on_tile(smaller, tile, plan.zoom)
        off, errors = _off(drawn, tile, plan, points)
        is_above = ~(errors <= promised)
        tried = *off, int(np.count_nonzero(is_above))
        if best is None or tried < best[0]:
            best = tried, drawn
        if not is_above.any():
            break
        mesh, kept = with_points(mesh, points[is_above], plan.height_step, kept)
    assert best is not None
    if is_above.any():
        last = part_of(progress, _part_after(len(_SHARES)), _PART_OF_TRIES)
        drawn = refined(best[1], tile, plan.zoom, plan.height_step, promised, points, last)
        off, errors = _off(drawn, tile, plan, points)
        tried = *off, int(np.count_nonzero(~(errors <= promised)))
        best = min(best, (tried, drawn), key=lambda one: one[0])
    report(progress, _PART_OF_TRIES)
    stays = np.zeros(len(mesh.x), dtype=bool)
    handed_on = simplified(mesh, border, tile, plan.height_step, _SHARE_HANDED_ON * promised, stays)
    (n_uncovered, worst, _), drawn = best
    n_others, of_others = _off(drawn, tile, plan, source.others_in(tile))[0]
    report(progress, 1.0)
    off_at_all = _Off(worst, max(worst, of_others), n_uncovered + n_others)
    return handed_on, drawn, off_at_all


def _ends_of_zooms(n_zooms: int) -> list[float]:
    """Return at which part of the time each zoom is done, the finest first.

    The finest three take about as long, each coarser one half as long as the one before, since it
    has half the vertices, and all of them some time to measure it at all points; on 500 x 500 cells
    of hills the zooms end at 16, 43, 70, 81 and 88 % (24, 46, 67, 79 and 86 % here).
    """
    k = np.arange(n_zooms)
    weights = np.minimum(1.0, 0.5 ** (k - 2.0)) + 0.08
    ends = np.cumsum(weights) / weights.sum()
    return [float(end) for end in _SHARE_OF_SOURCE + (1.0 - _SHARE_OF_SOURCE) * ends]


def _part_after(n_tried: float) -> float:
    """Return how much of a tile is done after so many tries, of which most tiles need few."""
    return float(_PART_OF_TRIES * (1.0 - 0.5**n_tried))


def _off(
    drawn: OnTile, tile: Tile, plan: TilesetPlan, points: NDArray[np.float64]
) -> tuple[tuple[int, float], NDArray[np.float64]]:
    """Return how many points a tile does not cover, and the largest error; and all of them."""
    errors = np.abs(errors_on(drawn, tile, plan.zoom, plan.height_step, points))
    is_covered = ~np.isnan(errors)
    largest = float(errors.max(initial=0.0, where=is_covered))
    return (int(np.count_nonzero(~is_covered)), largest), errors


def _layer(
    ranges: list[TileRange], bounds: tuple[float, float, float, float], name: str, normals: bool
) -> dict[str, Any]:
    layer: dict[str, Any] = {
        "tilejson": "2.1.0",
        "name": name,
        "version": "1.0.0",
        "format": "quantized-mesh-1.0",
        "scheme": "tms",
        "projection": "EPSG:4326",
        "tiles": ["{z}/{x}/{y}.terrain"],
        "minzoom": 0,
        "maxzoom": len(ranges) - 1,
        "bounds": list(bounds),
        "available": [
            [{"startX": r.first_x, "startY": r.first_y, "endX": r.last_x, "endY": r.last_y}]
            for r in ranges
        ],
    }
    if normals:
        layer["extensions"] = ["octvertexnormals"]
    return layer
