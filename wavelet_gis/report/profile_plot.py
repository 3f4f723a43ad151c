"""The plot of a profile: heights of each level along the line, and how far each is off."""

from __future__ import annotations

import html
from collections.abc import Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.report.pictures import Axis
from wavelet_gis.workflows.read_off.profile import Profile

__all__ = ["PLOT_SUFFIXES", "profile_page", "profile_svg"]

FloatArray = NDArray[np.float64]

#: What a plot is written as.
PLOT_SUFFIXES = (".html", ".svg")

#: Pixels of the whole, of its margins, of the upper and the lower chart of a line, between them.
WIDTH, _LEFT, _RIGHT = 1000, 74, 190
_HEAD, _UPPER, _LOWER, _GAP, _FOOT = 44, 300, 110, 34, 46

#: Points that a curve is drawn with; of more, the lowest and the highest of each stretch stay.
MOST_DRAWN = 2000

#: Levels from the coarsest to the finest: matplotlib's viridis without its palest end.
_COLOURS = np.array(
    [(68, 1, 84), (59, 81, 139), (33, 144, 141), (92, 200, 99), (190, 200, 40)], dtype=np.float64
)
_FINEST = "#3c4146"


def profile_page(profile: Profile) -> str:
    """Return the plot as an HTML page that needs nothing else.

    Parameters
    ----------
    profile : Profile
        What `wavelet_gis.profile` returned.
    """
    title = html.escape(f"Profile of {_name(profile)}")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title><style>body{{margin:0;background:#fff;color:#1d2327;"
        "font:16px/1.5 system-ui,sans-serif}main{max-width:1180px;margin:0 auto;padding:16px}"
        "h1{font-size:1.4rem}svg{width:100%;height:auto}table{border-collapse:collapse;"
        "font-size:.88rem}th,td{padding:4px 9px;text-align:right;border-bottom:1px solid #d9dee2}"
        f"</style></head>\n<body><main><h1>{title}</h1>\n{profile_svg(profile)}\n"
        f"{_table(profile)}</main></body></html>\n"
    )


def profile_svg(profile: Profile) -> str:
    """Return the plot as an SVG picture; each line has a pair of charts.

    Parameters
    ----------
    profile : Profile
        What `wavelet_gis.profile` returned.
    """
    lines = np.unique(profile.line)
    each = _HEAD + _UPPER + _GAP + _LOWER + _FOOT
    height = each * len(lines)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" '
        f'viewBox="0 0 {WIDTH} {height}" font-family="system-ui,sans-serif" font-size="12" '
        f'fill="#1d2327" role="img" aria-label="Profile"><rect width="{WIDTH}" height="{height}" '
        'fill="#fff"/>'
    ]
    for k, line in enumerate(lines):
        parts.append(f'<g transform="translate(0 {k * each})">')
        parts.append(_charts(profile, int(line), len(lines)))
        parts.append("</g>")
    return "".join([*parts, "</svg>"])


def _charts(profile: Profile, line: int, n_lines: int) -> str:
    is_here = profile.line == line
    x, z = profile.distance[is_here], profile.heights[is_here]
    finest = int(np.argmax(profile.levels))
    off = z - z[:, [finest]]
    # The finest is drawn first and grey, so that the coarser ones are seen on it.
    order = sorted(range(len(profile.levels)), key=lambda k: -profile.levels[k])
    bottom = _HEAD + _UPPER
    across = Axis([0.0, float(x[-1])], False, _LEFT, WIDTH - _RIGHT)
    across.low, across.high = 0.0, float(x[-1]) or 1.0
    name = f"Line {line + 1}" if n_lines > 1 else _name(profile)
    parts = [
        f'<text x="{_LEFT}" y="22" font-size="15" font-weight="600">{html.escape(name)}</text>'
    ]
    unit = _unit(profile)
    for top, stop, values, label in (
        (_HEAD, bottom, z, f"elevation, {unit}"),
        (bottom + _GAP, bottom + _GAP + _LOWER, off, "off the finest"),
    ):
        known = values[np.isfinite(values)]
        if not len(known):
            continue
        up = Axis([float(known.min()), float(known.max())], False, stop, top)
        parts.append(_frame(across, up, top, stop, label))
        for k in order:
            if values is off and k == finest:
                continue
            width, colour = (2.6, _FINEST) if k == finest else (1.6, _colour(profile, k))
            parts += _curve(across, up, x, values[:, k], colour, width)
    unit_x = "m" if profile.geo.system.kind == "geographic" else _length_unit(profile)
    parts.append(
        f'<text x="{(_LEFT + WIDTH - _RIGHT) / 2}" y="{bottom + _GAP + _LOWER + 36}" '
        f'text-anchor="middle">distance{unit_x and ", " + unit_x}</text>'
    )
    return "".join([*parts, _legend(profile, finest)])


def _legend(profile: Profile, finest: int) -> str:
    """Return the levels with their colours and sizes, coarsest first."""
    parts = []
    order = np.argsort(profile.levels, kind="stable")
    for row, k in enumerate(order.tolist()):
        y = _HEAD + 14 + 20 * row
        is_finest = k == finest
        colour = _FINEST if is_finest else _colour(profile, k)
        n_vertices = profile.geo.pyramid.n_vertices(profile.levels[k])
        parts.append(
            f'<line x1="{WIDTH - _RIGHT + 14}" x2="{WIDTH - _RIGHT + 36}" y1="{y - 4}" '
            f'y2="{y - 4}" stroke="{colour}" stroke-width="{3 if is_finest else 2}"/>'
            f'<text x="{WIDTH - _RIGHT + 42}" y="{y}">level {profile.levels[k]}: '
            f"{n_vertices:,}</text>"
        )
    parts.append(
        f'<text x="{WIDTH - _RIGHT + 42}" y="{_HEAD + 14 + 20 * len(order)}" fill="#5b666e">'
        "vertices</text>"
    )
    return "".join(parts)


def _frame(across: Axis, up: Axis, top: float, bottom: float, label: str) -> str:
    parts = []
    for position, text in across.ticks():
        parts.append(
            f'<line x1="{position:.1f}" x2="{position:.1f}" y1="{top}" y2="{bottom}" '
            f'stroke="#e4e8eb"/><text x="{position:.1f}" y="{bottom + 16}" fill="#5b666e" '
            f'text-anchor="middle">{text}</text>'
        )
    for position, text in up.ticks():
        parts.append(
            f'<line x1="{_LEFT}" x2="{WIDTH - _RIGHT}" y1="{position:.1f}" y2="{position:.1f}" '
            f'stroke="#e4e8eb"/><text x="{_LEFT - 6}" y="{position + 4:.1f}" fill="#5b666e" '
            f'text-anchor="end">{text}</text>'
        )
    middle = (top + bottom) / 2
    parts.append(
        f'<text transform="translate(18 {middle}) rotate(-90)" text-anchor="middle">'
        f"{html.escape(label)}</text>"
    )
    return "".join(parts)


def _curve(
    across: Axis, up: Axis, x: FloatArray, z: FloatArray, colour: str, width: float
) -> list[str]:
    """Return the polylines of a curve, which ends and begins anew where there is no height."""
    found = []
    for is_known, group in groupby(_drawn(x, z), key=lambda k: bool(np.isfinite(z[k]))):
        run = list(group)
        if is_known and len(run) > 1:
            path = " ".join(f"{across.at(float(x[k])):.1f},{up.at(float(z[k])):.1f}" for k in run)
            found.append(
                f'<polyline points="{path}" fill="none" stroke="{colour}" '
                f'stroke-width="{width}" stroke-linejoin="round"/>'
            )
    return found


def _drawn(x: FloatArray, z: FloatArray) -> Sequence[int]:
    """Return which points are drawn: of many, the lowest and highest of each stretch."""
    if len(x) <= MOST_DRAWN:
        return range(len(x))
    chosen = {0, len(x) - 1}
    for part in np.array_split(np.arange(len(x)), MOST_DRAWN // 2):
        known = part[np.isfinite(z[part])]
        if len(known) < len(part):
            chosen.update((int(part[0]), int(part[-1])))
        if len(known):
            chosen.update((int(known[np.argmin(z[known])]), int(known[np.argmax(z[known])])))
    return sorted(chosen)


def _table(profile: Profile) -> str:
    rows = profile.figures()["profiles"]
    head = "".join(
        f"<th>{name}</th>"
        for name in ("line", "level", "lowest", "highest", "RMS off the finest", "largest")
    )
    keys = ("lowest", "highest", "rms_difference", "max_difference")
    body = "".join(
        f"<tr><td>{row['line']}</td><td>{row['level']}</td>"
        + "".join(f"<td>{_shown(row[key])}</td>" for key in keys)
        + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>\n"


def _shown(value: float) -> str:
    return f"{value:.4g}" if np.isfinite(value) else "-"


def _colour(profile: Profile, k: int) -> str:
    """Return the colour of a level among those that are shown: dark for coarse ones."""
    coarser = sorted(profile.levels)
    position = coarser.index(profile.levels[k]) / max(len(coarser) - 1, 1) * (len(_COLOURS) - 1)
    channels = [np.interp(position, np.arange(len(_COLOURS)), c) for c in _COLOURS.T]
    return "#" + "".join(f"{round(float(c)):02x}" for c in channels)


def _name(profile: Profile) -> str:
    return profile.geo.source_name.replace("\\", "/").rsplit("/", 1)[-1]


def _unit(profile: Profile) -> str:
    short = {"metre": "m", "foot": "ft", "us_survey_foot": "ft (US)"}
    return short.get(profile.geo.vertical_unit, "units of z")


def _length_unit(profile: Profile) -> str:
    system = profile.geo.system
    if system.kind != "projected":
        return ""
    return {1.0: "m", 0.3048: "ft"}.get(system.horizontal_unit, "")
