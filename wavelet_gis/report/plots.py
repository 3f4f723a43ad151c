"""Pictures of a pyramid's details, with matplotlib where it is installed."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import numpy as np

from wavelet_core.errors import MissingDependencyError
from wavelet_core.features.spectrum import STAYS, vertex_details
from wavelet_core.lifting.spacings import level_spacings
from wavelet_gis.io.read_back import write_bytes
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["plot_details"]

#: Markers beyond this number would only cover each other; the largest are drawn.
MAX_MARKERS = 8_000

#: Area in square points of the largest marker.
LARGEST_MARKER = 50.0


def plot_details(path: str | os.PathLike[str], geo: GeoPyramid) -> None:
    """Draw the terrain, and beside it every detail as a marker: size by strength, colour by band.

    Parameters
    ----------
    path : path
        Any format that matplotlib writes, by its suffix.
    geo : GeoPyramid
        What is drawn.

    Raises
    ------
    MissingDependencyError
        Without matplotlib.

    Notes
    -----
    The right panel is Fig. 10b of the paper, for all levels of the pyramid. Areas are
    proportional to the magnitude, the 99.5th percentile and above being largest.
    """
    figure_class = _matplotlib_figure()
    pyramid = geo.pyramid
    finest = pyramid.synthesise()
    x, y, z = geo.frame.to_file(finest.vertices).T
    details = vertex_details(pyramid)
    magnitude = np.linalg.norm(geo.file_details(details.vectors), axis=1)
    figure = figure_class(figsize=(12, 5.4), layout="constrained")
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    _draw_terrain(figure, left, x, y, z, finest.faces)
    removed = np.flatnonzero(details.level != STAYS)
    order = removed[np.argsort(magnitude[removed], kind="stable")][-MAX_MARKERS:]
    largest = float(np.quantile(magnitude[removed], 0.995)) if len(removed) else 1.0
    spacings = level_spacings(pyramid)
    for level in range(pyramid.n_levels - 1, -1, -1):
        chosen = order[details.level[order] == level]
        area = LARGEST_MARKER * np.clip(magnitude[chosen] / (largest or 1.0), 0.004, 1.0)
        colour = _colour(1 - level / max(pyramid.n_levels - 1, 1))
        right.scatter(
            x[chosen],
            y[chosen],
            s=area,
            color=[colour],
            alpha=0.7,
            linewidths=0,
            label=f"{level}: {spacings[level + 1]:.3g}",
            rasterized=True,
        )
    right.set_title(f"Details, by strength (full size from {largest:.3g}) and by level")
    legend = right.legend(
        title="level: spacing", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False
    )
    for handle in legend.legend_handles:
        handle.set_sizes([30.0])
    for axes in (left, right):
        axes.set_aspect("equal" if geo.system.kind != "geographic" else _aspect(geo))
        axes.ticklabel_format(useOffset=False, style="plain")
        axes.tick_params(labelsize=7)
        axes.tick_params(axis="x", labelrotation=30)
    picture = io.BytesIO()
    figure.savefig(picture, format=Path(path).suffix[1:].lower(), dpi=150)
    write_bytes(path, picture.getvalue())


def _draw_terrain(figure: Any, axes: Any, x: Any, y: Any, z: Any, faces: Any) -> None:
    step = max(len(faces) // 400_000, 1)
    if step == 1 and len(faces):
        drawn = axes.tripcolor(x, y, faces, z, shading="gouraud", cmap="gist_earth")
    else:
        chosen = np.linspace(0, len(x) - 1, min(len(x), 200_000)).astype(int)
        drawn = axes.scatter(x[chosen], y[chosen], c=z[chosen], s=0.6, lw=0, cmap="gist_earth")
    drawn.set_rasterized(True)
    figure.colorbar(drawn, ax=axes, shrink=0.8, label="elevation")
    axes.set_title("Terrain")


def _aspect(geo: GeoPyramid) -> float:
    return geo.frame.y_scale / geo.frame.x_scale


def _colour(position: float) -> tuple[float, float, float, float]:
    import matplotlib

    colour: tuple[float, float, float, float] = matplotlib.colormaps["plasma_r"](
        0.08 + 0.9 * position
    )
    return colour


def _matplotlib_figure() -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingDependencyError(
            "pictures need matplotlib; install it with 'pip install matplotlib'."
        ) from error
    return Figure
