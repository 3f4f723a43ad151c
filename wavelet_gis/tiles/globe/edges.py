"""The edges of tiles: one chain of vertices for each, made once and used by every tile beside it.

A chain is fixed for the finest zoom, by the heights of the surface under it, and the tiles of the
coarser zooms have the very same chain on their edges, with all its vertices. So the tiles on the
two sides of an edge meet without a crack whatever their zooms are. Two facts of the format make
this need care:

- A coarse tile has fewer steps across. The vertices of a chain are therefore put on steps of the
  coarsest zoom that has the edge, or of `DEEPEST` zooms above the finest where that is nearer.
- The corner of a fine tile, half-way along the edge of a coarse one, falls between two steps of
  that (32767 is odd). The chain is level from the step before to the step after it, at the corner's
  own height, so that it runs through the corner though the coarse tile has no vertex there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.tiles.globe.source import SourceSurface
from wavelet_gis.tiles.globe.tile_grid import POINTS_ACROSS, STEPS, Tile, TileRange

__all__ = ["DEEPEST", "Border", "TileEdges", "tile_edges"]

#: Zooms above the finest whose steps vertices of edges are put on, at most: at 5, one of 32 steps.
DEEPEST = 5

#: Places along the edge of a finest tile where the surface is looked up: two a spacing.
SAMPLES = 2 * POINTS_ACROSS

Chain = tuple[NDArray[np.int64], NDArray[np.int64]]


@dataclass(frozen=True, slots=True)
class Border:
    """The vertices around a tile, counter-clockwise from its south-west corner.

    Attributes
    ----------
    x, y : (n,) int64
        In steps of the finest zoom, from the corner of the earth.
    height : (n,) int64
        In steps of height.
    """

    x: NDArray[np.int64]
    y: NDArray[np.int64]
    height: NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class TileEdges:
    """The chains of all edges of the finest tiles, and of the tiles around, which are level.

    Attributes
    ----------
    finest : TileRange
        The tiles whose edges they are.
    chains : dict
        By ``(is_vertical, line, place)``: the line counts tiles from the west, or south, and the
        place tiles along it. Positions count from the beginning of the edge.
    fill : int
        Height of the others, in steps of height.
    n_parts : list of int
        By zoom: the parts that an edge beyond the finest tiles is cut into, so that its chords
        stay near the round earth.
    """

    finest: TileRange
    chains: dict[tuple[bool, int, int], Chain]
    fill: int
    n_parts: list[int]

    def border(self, tile: Tile) -> Border:
        """Return the vertices around a tile of any zoom."""
        k = self.finest.zoom - tile.zoom
        width = STEPS << k
        west, south = tile.x * width, tile.y * width
        bottom = self._chain(False, tile.y << k, tile.x << k, 1 << k, tile.zoom)
        top = self._chain(False, (tile.y + 1) << k, tile.x << k, 1 << k, tile.zoom)
        left = self._chain(True, tile.x << k, tile.y << k, 1 << k, tile.zoom)
        right = self._chain(True, (tile.x + 1) << k, tile.y << k, 1 << k, tile.zoom)
        x = np.concatenate(
            [
                west + bottom[0][:-1],
                np.full(len(right[0]) - 1, west + width),
                west + top[0][:0:-1],
                np.full(len(left[0]) - 1, west),
            ]
        )
        y = np.concatenate(
            [
                np.full(len(bottom[0]) - 1, south),
                south + right[0][:-1],
                np.full(len(top[0]) - 1, south + width),
                south + left[0][:0:-1],
            ]
        )
        height = np.concatenate([bottom[1][:-1], right[1][:-1], top[1][:0:-1], left[1][:0:-1]])
        return Border(x, y, height)

    def _chain(self, vertical: bool, line: int, start: int, n_tiles: int, zoom: int) -> Chain:
        """Return the chain along the edge of a tile that has so many of the finest along it."""
        positions: list[NDArray[np.int64]] = []
        heights: list[NDArray[np.int64]] = []
        period = 1 << _depth(line, self.finest.zoom)
        for place in range(start, start + n_tiles):
            chain = self.chains.get((vertical, line, place))
            if chain is None:
                continue
            at, height = chain
            # A corner of finest tiles is a vertex where it is this tile's own, or on its steps.
            first = 0 if place == start or place % period == 0 else 1
            last = len(at) if place + 1 == start + n_tiles else len(at) - 1
            positions.append((place - start) * STEPS + at[first:last])
            heights.append(height[first:last])
        length, n_parts = n_tiles * STEPS, self.n_parts[zoom]
        parts = np.arange(n_parts + 1, dtype=np.int64) * length // n_parts
        if positions:
            at = np.concatenate(positions)
            known = {(vertical, line, int(p)) in self.chains for p in range(start, start + n_tiles)}
            if known == {True}:
                return at, np.concatenate(heights)
            last_tile = start + n_tiles - 1
            tile_before = np.maximum(start + (parts - 1) // STEPS, start)
            tile_after = np.minimum(start + parts // STEPS, last_tile)
            outside = [
                (vertical, line, int(before)) not in self.chains
                and (vertical, line, int(after)) not in self.chains
                for before, after in zip(tile_before, tile_after, strict=True)
            ]
            parts = parts[outside]
        else:
            at = np.empty(0, np.int64)
        both = np.concatenate([at, parts])
        height = np.concatenate([*heights, np.full(len(parts), self.fill)]).astype(np.int64)
        order = np.argsort(both, kind="stable")
        return both[order], height[order]


def tile_edges(
    source: SourceSurface,
    finest: TileRange,
    height_step: float,
    tolerance: float,
    n_parts: list[int],
) -> TileEdges:
    """Return the chains of the edges of all tiles.

    Parameters
    ----------
    source : SourceSurface
    finest : TileRange
        Of its zoom.
    height_step : float
        Metres.
    tolerance : float
        How far a chain may be above or below the places looked up, in metres.
    n_parts : list of int
        See `TileEdges`.
    """
    keys, positions = [], []
    for vertical in (False, True):
        first, last = (
            (finest.first_x, finest.last_x) if vertical else (finest.first_y, finest.last_y)
        )
        start, stop = (
            (finest.first_y, finest.last_y) if vertical else (finest.first_x, finest.last_x)
        )
        for line in range(first, last + 2):
            for place in range(start, stop + 1):
                keys.append((vertical, line, place))
                positions.append(_positions(line, place, finest.zoom))
    counts = [len(p) for p in positions]
    along = np.concatenate(
        [p + place * STEPS for p, (_, _, place) in zip(positions, keys, strict=True)]
    )
    across = np.repeat([line * STEPS for _, line, _ in keys], counts)
    is_vertical = np.repeat([vertical for vertical, _, _ in keys], counts)
    plan = np.where(
        is_vertical[:, None], np.column_stack([across, along]), np.column_stack([along, across])
    )
    heights = np.rint(source.heights_at(plan.astype(np.float64)) / height_step).astype(np.int64)
    chains = {}
    ends = np.cumsum(counts)
    for key, at, end in zip(keys, positions, ends, strict=True):
        height = heights[end - len(at) : end].copy()
        forced = _level_at_corners(key[1], key[2], finest.zoom, at, height)
        kept = _simplified(at, height, forced, tolerance / height_step)
        chains[key] = (at[kept], height[kept])
    return TileEdges(finest, chains, round(source.fill / height_step), n_parts)


def _depth(line: int, zoom: int) -> int:
    """Return how many zooms above the finest the steps of an edge on a line are."""
    zeros = (line & -line).bit_length() - 1 if line else zoom
    return min(zeros, DEEPEST, zoom)


def _positions(line: int, place: int, zoom: int) -> NDArray[np.int64]:
    """Return where along an edge of a finest tile the surface is looked up, corners included."""
    depth = _depth(line, zoom)
    step, offset = 1 << depth, (place % (1 << depth)) * STEPS
    wanted = offset + np.arange(1, SAMPLES) * (STEPS / SAMPLES)
    on_steps = np.rint(wanted / step).astype(np.int64) * step - offset
    beside_corners = [-(-(offset + 1) // step) * step, (offset + STEPS - 1) // step * step]
    inside = np.unique(np.concatenate([on_steps, np.array(beside_corners) - offset]))
    inside = inside[(inside > 0) & (inside < STEPS)]
    return np.concatenate([[0], inside, [STEPS]])


def _level_at_corners(
    line: int, place: int, zoom: int, at: NDArray[np.int64], height: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Make a chain level next to corners between steps; return which vertices must stay."""
    period = 1 << _depth(line, zoom)
    forced = np.zeros(len(at), dtype=bool)
    forced[[0, -1]] = True
    if place % period:
        height[1], forced[1] = height[0], True
    if (place + 1) % period:
        height[-2], forced[-2] = height[-1], True
    return forced


def _simplified(
    at: NDArray[np.int64],
    height: NDArray[np.int64],
    forced: NDArray[np.bool_],
    tolerance: float,
) -> NDArray[np.bool_]:
    """Return which vertices stay, by the rule of Douglas and Peucker on heights."""
    kept = forced.copy()
    ends = np.flatnonzero(forced)
    spans = list(zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True))
    while spans:
        a, b = spans.pop()
        if b - a < 2:
            continue
        part = at[a + 1 : b]
        share = (part - at[a]) / (at[b] - at[a])
        off = np.abs(height[a + 1 : b] - (height[a] + share * (height[b] - height[a])))
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            middle = a + 1 + worst
            kept[middle] = True
            spans += [(a, middle), (middle, b)]
    return kept
