"""Scale signatures: the spectra of the vertices as columns that can be clustered and learned from.

Neighbouring levels hold nearly the same, since each removes only about a quarter of the vertices.
They are joined into wider bands (runs of levels) over which the number of vertices halves, so that
the spacing grows by the square root of two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, frozen
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..progress import Progress, part_of
from .shape import surface_shape
from .spectrum import band_components, band_energies, heights_above_lows, vertex_details

__all__ = ["Signature", "energy_signature", "joined_levels", "plain_features", "scale_features"]

#: How much fewer vertices the coarser end of a joined band has.
BAND_RATIO = 2.0

#: Energies count no less than this part of their band's mean square: the log of nothing is -inf.
ENERGY_FLOOR = 1e-4


@dataclass(frozen=True, slots=True)
class Signature:
    """Named columns, one row for each vertex of the input.

    Attributes
    ----------
    names : tuple of str
        Of the columns.
    values : ndarray of float32, shape (n_vertices, n_columns)
    """

    names: tuple[str, ...]
    values: NDArray[np.float32]

    def joined_to(self, other: Signature) -> Signature:
        """Return the columns of both."""
        return Signature(
            (*self.names, *other.names), frozen(np.hstack([self.values, other.values]))
        )


def joined_levels(pyramid: Pyramid) -> list[tuple[int, int]]:
    """Return the levels of each band as ``(first, stop)``, the coarsest band first.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.signature import joined_levels
    >>> pyramid = analyse(synthetic.hills(30, 30), levels=6)
    >>> bands = joined_levels(pyramid)
    >>> bands[0][0], bands[-1][1]
    (0, 6)
    """
    bands: list[tuple[int, int]] = []
    stop = pyramid.n_levels
    for level in range(pyramid.n_levels - 1, -1, -1):
        ratio = pyramid.n_vertices(stop) / max(pyramid.n_vertices(level), 1)
        if ratio >= BAND_RATIO or level == 0:
            bands.append((level, stop))
            stop = level
    return bands[::-1]


def energy_signature(
    pyramid: Pyramid, channels: Sequence[str] = (), progress: Progress | None = None
) -> Signature:
    """Return the logarithm of the root mean square detail in every band: what clusters compare.

    Parameters
    ----------
    pyramid : Pyramid
    channels : sequence of str
        Some of the pyramid's; the geometry alone when empty.
    progress : callable, optional
        See :func:`wavelet_core.band_energies`.

    Returns
    -------
    Signature
        Base 10. *Our choice:* a band's energies count no less than ``ENERGY_FLOOR`` of their
        mean, which is 40 dB below it.

    Raises
    ------
    OptionError
        No level, or a channel that the pyramid does not have.
    """
    _require_levels(pyramid)
    bands = joined_levels(pyramid)
    names: list[str] = []
    blocks: list[NDArray[np.float32]] = []
    wanted: Sequence[str | None] = tuple(channels) or (None,)
    for k, channel in enumerate(wanted):
        part = part_of(progress, k / len(wanted), (k + 1) / len(wanted))
        blocks.append(_log_energies(pyramid, channel, bands, part))
        names += [f"rms {channel or 'geometry'} {first}-{stop - 1}" for first, stop in bands]
    return Signature(tuple(names), frozen(np.hstack(blocks)))


def scale_features(pyramid: Pyramid, progress: Progress | None = None) -> Signature:
    """Return everything that the scales show of each vertex: what classes are learned from.

    Parameters
    ----------
    pyramid : Pyramid
        Attributes that were lifted take part.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    Signature
        For z, by band: the height of the vertex above the band's coarser surface, that above the
        lowest vertex of its neighbourhood, and the log of the root mean square detail; then the
        vertex's own detail and the level at which it went. For each attribute, by band: its
        smooth value on the coarser level and the log of the root mean square detail. Heights are
        differences, so a class learned in the valley holds on the hill.

    Raises
    ------
    OptionError
        A pyramid without levels.
    """
    _require_levels(pyramid)
    bands = joined_levels(pyramid)
    labels = [f"{first}-{stop - 1}" for first, stop in bands]
    share = 1.0 / (3 + 2 * len(pyramid.attribute_names))  # of one walk through the levels
    components = band_components(pyramid, "z", part_of(progress, 0.0, share))
    blocks: list[NDArray] = [
        np.column_stack([components.residual(first) for first, _ in bands]),
        heights_above_lows(
            pyramid,
            [first for first, _ in bands],
            progress=part_of(progress, share, 2 * share),
        ),
        _log_energies(pyramid, None, bands, part_of(progress, 2 * share, 3 * share)),
    ]
    names = [f"height above {first}" for first, _ in bands]
    names += [f"height above lows of {first}" for first, _ in bands]
    names += [f"rms geometry {label}" for label in labels]
    details = vertex_details(pyramid)
    column = pyramid.channels.index("z")
    blocks += [np.nan_to_num(details.vectors[:, [column]]), details.level[:, None]]
    names += ["own detail", "level"]
    for k, attribute in enumerate(pyramid.attribute_names):
        begin = (3 + 2 * k) * share
        components = band_components(pyramid, attribute, part_of(progress, begin, begin + share))
        smooth = [components.base + components.bands[:, :first].sum(axis=1) for first, _ in bands]
        part = part_of(progress, begin + share, begin + 2 * share)
        blocks += [np.column_stack(smooth), _log_energies(pyramid, attribute, bands, part)]
        names += [f"{attribute} at {first}" for first, _ in bands]
        names += [f"rms {attribute} {label}" for label in labels]
    return Signature(
        tuple(names), frozen(np.hstack([block.astype(np.float32) for block in blocks]))
    )


def plain_features(pyramid: Pyramid) -> Signature:
    """Return what a vertex has without the scales: attributes, and the shape of the input TIN.

    Parameters
    ----------
    pyramid : Pyramid

    Returns
    -------
    Signature
        Attributes, then slope, mean and Gaussian curvature of the finest mesh.
    """
    mesh = pyramid.synthesise()
    shape = surface_shape(mesh)
    geometry = np.column_stack([shape.slope, shape.mean, shape.gaussian])
    values = np.hstack([mesh.attributes, np.nan_to_num(geometry)])
    return Signature(
        (*mesh.attribute_names, "slope", "mean curvature", "gaussian curvature"),
        frozen(values.astype(np.float32)),
    )


def _log_energies(
    pyramid: Pyramid,
    channel: str | None,
    bands: Sequence[tuple[int, int]],
    progress: Progress | None,
) -> NDArray[np.float32]:
    energies = band_energies(pyramid, channel, progress)
    joined: FloatArray = np.column_stack([energies[:, a:b].sum(axis=1) for a, b in bands])
    floor = np.maximum(ENERGY_FLOOR * joined.mean(axis=0), np.finfo(np.float64).tiny)
    return (0.5 * np.log10(np.maximum(joined, floor))).astype(np.float32)


def _require_levels(pyramid: Pyramid) -> None:
    if pyramid.n_levels == 0:
        raise OptionError(
            "{0} has no levels, so its vertices have no scales; analyse with more levels.",
            "pyramid",
        )
