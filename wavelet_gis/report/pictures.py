"""Pictures of a report without any plotting package: PNG by zlib, charts as SVG."""

from __future__ import annotations

import base64
import html
import math
import struct
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_gis.model.dem import GridGeometry
from wavelet_gis.products.rasterise import rasterise

__all__ = ["difference_png", "hillshade_png", "histogram_chart", "line_chart", "picture_grid"]

FloatArray = NDArray[np.float64]

#: Longer side of the pictures, in pixels.
PICTURE_SIDE = 480

#: Sun of the hillshades: azimuth and height in degrees, as cartographers draw it.
SUN = (315.0, 45.0)

#: Blue over white to red: below and above the level's surface.
_DIVERGING = np.array(
    [(33, 82, 155), (103, 154, 203), (247, 247, 247), (221, 130, 95), (158, 30, 41)]
)

#: Size of a chart in its own units, about those of a phone's screen.
WIDTH, HEIGHT = 360, 250
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 10, 12, 34


def picture_grid(mesh: TriangleMesh) -> GridGeometry:
    """Return a north-up grid over a mesh, in its own coordinates, no longer than the pictures."""
    low, high = mesh.vertices[:, :2].min(axis=0), mesh.vertices[:, :2].max(axis=0)
    size = float(max(high - low)) / PICTURE_SIDE or 1.0
    n_columns, n_rows = (max(round(float(side) / size), 1) for side in high - low)
    return GridGeometry((n_rows, n_columns), (size, 0.0, low[0], 0.0, -size, high[1]))


def hillshade_png(mesh: TriangleMesh, grid: GridGeometry, exaggeration: float = 1.0) -> str:
    """Return the shaded surface as a data URI.

    Parameters
    ----------
    mesh : TriangleMesh
        In the coordinates of the grid.
    grid : GridGeometry
        See `picture_grid`.
    exaggeration : float
        Of the heights; the same for pictures that are to be compared.
    """
    heights = rasterise(mesh, grid) * exaggeration
    size = grid.transform[0]
    if min(heights.shape) < 2:
        return _png_uri(np.ones(heights.shape, np.uint8), _greys())
    down, right = np.gradient(heights, size)
    azimuth, height = np.radians(SUN)
    east, north, up = (
        math.sin(azimuth) * math.cos(height),
        math.cos(azimuth) * math.cos(height),
        math.sin(height),
    )
    light = (up - right * east + down * north) / np.sqrt(1 + right**2 + down**2)
    known = np.isfinite(light)
    shades = np.zeros(light.shape, np.uint8)
    shades[known] = (1 + 254 * np.clip(light[known], 0, 1)).astype(np.uint8)
    return _png_uri(shades, _greys())


def exaggeration_of(mesh: TriangleMesh, grid: GridGeometry) -> float:
    """Return the factor that gives gentle ground and spiky points alike a readable shade."""
    heights = rasterise(mesh, grid)
    if min(heights.shape) < 2:
        return 1.0
    steep = np.hypot(*np.gradient(heights, grid.transform[0]))
    steep = steep[np.isfinite(steep)]
    typical = float(np.quantile(steep, 0.9)) if len(steep) else 0.0
    return float(np.clip(0.6 / typical, 0.1, 20.0)) if typical > 0 else 1.0


def difference_png(mesh: TriangleMesh, errors: FloatArray, grid: GridGeometry, limit: float) -> str:
    """Return signed errors at the vertices of a mesh as a map, blue to red, as a data URI.

    Parameters
    ----------
    mesh : TriangleMesh
        The finest, in the coordinates of the grid.
    errors : (n_vertices,) float64
        NaN where there is none.
    grid : GridGeometry
        See `picture_grid`.
    limit : float
        The size that gets the full colour.
    """
    values = rasterise(mesh, grid, errors)
    known = np.isfinite(values)
    shades = np.zeros(values.shape, np.uint8)
    position = np.clip(values[known] / (limit or 1.0), -1, 1)
    shades[known] = (128 + np.rint(127 * position)).astype(np.uint8)
    return _png_uri(shades, _diverging())


def line_chart(
    title: str,
    x: Sequence[float],
    lines: Sequence[tuple[str, Sequence[float]]],
    x_label: str,
    y_label: str,
    *,
    log_x: bool = False,
    log_y: bool = False,
) -> str:
    """Return lines over a common x as an SVG element.

    Parameters
    ----------
    title : str
        What the chart shows, for those who cannot see it.
    x : sequence of float
        Values of x.
    lines : sequence of (name, values)
        NaN, and on a log axis what is not above 0, is left out.
    x_label, y_label : str
        Of the axes.
    log_x, log_y : bool
        Axes of powers of ten.
    """
    points = [
        [
            (a, b)
            for a, b in zip(x, values, strict=True)
            if math.isfinite(a) and math.isfinite(b) and (a > 0 or not log_x)
            if b > 0 or not log_y
        ]
        for _, values in lines
    ]
    flat = [point for line in points for point in line]
    if not flat:
        return ""
    across = Axis([a for a, _ in flat], log_x, _LEFT, WIDTH - _RIGHT)
    up = Axis([b for _, b in flat], log_y, HEIGHT - _BOTTOM, _TOP, from_zero=not log_y)
    parts = [_frame(across, up, x_label, y_label)]
    for k, ((name, _), line) in enumerate(zip(lines, points, strict=True)):
        path = " ".join(f"{across.at(a):.1f},{up.at(b):.1f}" for a, b in line)
        parts.append(f'<polyline class="line c{k}" points="{path}"/>')
        parts += [
            f'<circle class="dot c{k}" cx="{across.at(a):.1f}" cy="{up.at(b):.1f}" r="2.4">'
            f"<title>{html.escape(name)}: {b:.4g} at {a:.6g}</title></circle>"
            for a, b in line
        ]
    return _chart(title, "".join(parts), _legend([name for name, _ in lines]))


def histogram_chart(
    title: str, edges: Sequence[float], rows: Sequence[tuple[str, Sequence[int]]], x_label: str
) -> str:
    """Return one histogram above the other on a common logarithmic x, as an SVG element.

    Parameters
    ----------
    title : str
        What the chart shows.
    edges : sequence of float
        Of the bins, above 0.
    rows : sequence of (name, counts)
        Each is drawn to its own height.
    x_label : str
        Of the axis.
    """
    if not rows or len(edges) < 2:
        return ""
    strip = 26.0
    height = _TOP + strip * len(rows) + _BOTTOM
    across = Axis([edges[0], edges[-1]], True, _LEFT, WIDTH - _RIGHT)
    parts = []
    for tick, label in across.ticks():
        parts.append(
            f'<line class="grid" x1="{tick:.1f}" x2="{tick:.1f}" y1="{_TOP}" '
            f'y2="{height - _BOTTOM}"/><text x="{tick:.1f}" y="{height - _BOTTOM + 14}" '
            f'text-anchor="middle">{label}</text>'
        )
    for k, (name, counts) in enumerate(rows):
        base = _TOP + strip * (k + 1)
        largest = max(max(counts), 1)
        path = [f"M{across.at(edges[0]):.1f} {base:.1f}"]
        for low, high, count in zip(edges[:-1], edges[1:], counts, strict=True):
            top = base - (strip - 4) * count / largest
            path.append(f"L{across.at(low):.1f} {top:.1f}L{across.at(high):.1f} {top:.1f}")
        path.append(f"L{across.at(edges[-1]):.1f} {base:.1f}Z")
        parts.append(f'<path class="area" d="{"".join(path)}"><title>{html.escape(name)}</title>')
        parts.append(f'</path><text x="{_LEFT - 6}" y="{base - 6:.1f}" text-anchor="end">')
        parts.append(f"{html.escape(name)}</text>")
    parts.append(
        f'<text class="label" x="{(WIDTH + _LEFT) / 2}" y="{height - 4:.0f}" '
        f'text-anchor="middle">{html.escape(x_label)}</text>'
    )
    return _chart(title, "".join(parts), "", height)


class Axis:
    """From values to positions, linear or logarithmic, and round ticks."""

    def __init__(
        self,
        values: Sequence[float],
        is_log: bool,
        start: float,
        stop: float,
        from_zero: bool = False,
    ) -> None:
        self.is_log, self.start, self.stop = is_log, start, stop
        low, high = min(values), max(values)
        if is_log:
            low, high = math.log10(low), math.log10(high)
        elif from_zero:
            low = min(low, 0.0)
        if high - low < 1e-9 * max(abs(high), 1e-30):
            low, high = low - 0.5, high + 0.5
        margin = 0.04 * (high - low)
        self.low = low if from_zero and low == 0 else low - margin
        self.high = high + margin

    def at(self, value: float) -> float:
        """Return the position of a value."""
        value = math.log10(value) if self.is_log else value
        return self.start + (value - self.low) / (self.high - self.low) * (self.stop - self.start)

    def ticks(self) -> list[tuple[float, str]]:
        """Return positions and labels."""
        if not self.is_log:
            step = _round_step((self.high - self.low) / 4)
            first = math.ceil(self.low / step - 1e-9)
            last = math.floor(self.high / step + 1e-9)
            return [(self.at(k * step), _label(k * step)) for k in range(first, last + 1)]
        decades = range(math.floor(self.low), math.ceil(self.high) + 1)
        span = self.high - self.low
        factors: tuple[float, ...] = (1, 2, 5)
        if span > 2.5:
            factors = (1,)
        elif span < 0.7:
            factors = (1, 1.5, 2, 3, 5, 7)
        if span > 6:
            decades = range(decades.start, decades.stop, 2)
        values = [f * 10.0**k for k in decades for f in factors]
        inside = [v for v in values if self.low <= math.log10(v) <= self.high]
        return [(self.at(v), _label(v)) for v in inside]


def _round_step(step: float) -> float:
    power = 10.0 ** math.floor(math.log10(step))
    return next(power * f for f in (1, 2, 5, 10) if step <= power * f * 1.0001)


def _label(value: float) -> str:
    if value == 0:
        return "0"
    if abs(value) >= 1e6:
        return f"{value / 1e6:g}M"
    if abs(value) >= 1e3:
        return f"{value / 1e3:g}k"
    return f"{value:.3g}"


def _frame(across: Axis, up: Axis, x_label: str, y_label: str) -> str:
    bottom, parts = HEIGHT - _BOTTOM, []
    for position, label in across.ticks():
        parts.append(
            f'<line class="grid" x1="{position:.1f}" x2="{position:.1f}" y1="{_TOP}" '
            f'y2="{bottom}"/><text x="{position:.1f}" y="{bottom + 14}" text-anchor="middle">'
            f"{label}</text>"
        )
    for position, label in up.ticks():
        parts.append(
            f'<line class="grid" x1="{_LEFT}" x2="{WIDTH - _RIGHT}" y1="{position:.1f}" '
            f'y2="{position:.1f}"/><text x="{_LEFT - 5}" y="{position + 4:.1f}" '
            f'text-anchor="end">{label}</text>'
        )
    middle = (_LEFT + WIDTH - _RIGHT) / 2
    parts.append(
        f'<text class="label" x="{middle}" y="{HEIGHT - 4}" text-anchor="middle">'
        f"{html.escape(x_label)}</text>"
        f'<text class="label" transform="translate(10 {(_TOP + bottom) / 2}) rotate(-90)" '
        f'text-anchor="middle">{html.escape(y_label)}</text>'
    )
    return "".join(parts)


def _legend(names: Sequence[str]) -> str:
    if len(names) < 2:
        return ""
    keys = "".join(
        f'<span class="key"><i class="c{k}"></i>{html.escape(name)}</span>'
        for k, name in enumerate(names)
    )
    return f'<div class="legend">{keys}</div>'


def _chart(title: str, inner: str, legend: str, height: float = HEIGHT) -> str:
    text = html.escape(title)
    return (
        f'<figure class="chart"><figcaption>{text}</figcaption>{legend}'
        f'<svg viewBox="0 0 {WIDTH} {height:.0f}" role="img" aria-label="{text}">{inner}</svg>'
        "</figure>"
    )


def _greys() -> NDArray[np.uint8]:
    ramp = np.linspace(0, 255, 255).round().astype(np.uint8)
    return np.vstack([np.zeros((1, 3), np.uint8), np.repeat(ramp[:, None], 3, axis=1)])


def _diverging() -> NDArray[np.uint8]:
    positions = np.linspace(0, len(_DIVERGING) - 1, 255)
    ramp = np.column_stack(
        [np.interp(positions, np.arange(len(_DIVERGING)), c) for c in _DIVERGING.T]
    )
    return np.vstack([np.zeros((1, 3), np.uint8), ramp.round().astype(np.uint8)])


def _png_uri(pixels: NDArray[np.uint8], palette: NDArray[np.uint8]) -> str:
    """Return a palette PNG, whose first colour is transparent, as a data URI."""
    n_rows, n_columns = pixels.shape
    scanlines = np.zeros((n_rows, n_columns + 1), np.uint8)  # each begins with filter 0: none
    scanlines[:, 1:] = pixels

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", n_columns, n_rows, 8, 3, 0, 0, 0)
    png: Any = b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            chunk(b"IHDR", header),
            chunk(b"PLTE", palette.tobytes()),
            chunk(b"tRNS", b"\0"),
            chunk(b"IDAT", zlib.compress(scanlines.tobytes(), 9)),
            chunk(b"IEND", b""),
        ]
    )
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")
