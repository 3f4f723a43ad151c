"""Which levels of a pyramid are shown where nobody names them."""

from __future__ import annotations

import numpy as np

from wavelet_core.errors import OptionError
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["checked_levels", "default_levels"]

#: Shares of the input's vertices at which a level is shown.
SHOWN_SHARES = (0.25, 0.05)


def default_levels(geo: GeoPyramid) -> list[int]:
    """Return the levels nearest to a quarter and a twentieth of the vertices, and the coarsest.

    Parameters
    ----------
    geo : GeoPyramid
        Whose levels.
    """
    pyramid = geo.pyramid
    counts = np.array([pyramid.n_vertices(level) for level in range(pyramid.n_levels + 1)])
    shares = np.log(counts / counts[-1])
    nearest = [int(np.argmin(np.abs(shares - np.log(share)))) for share in SHOWN_SHARES]
    wanted = [level for level in nearest if level < pyramid.n_levels]
    return list(dict.fromkeys([*wanted, 0]))


def checked_levels(geo: GeoPyramid, levels: list[int]) -> list[int]:
    """Return levels, each once, in the order that they are named.

    Raises
    ------
    OptionError
        One that the pyramid does not have, or none.
    """
    n_levels = geo.pyramid.n_levels
    for level in levels:
        if not 0 <= level <= n_levels:
            raise OptionError(f"there is no level {level}; they are 0 (coarsest) to {n_levels}.")
    if not levels:
        raise OptionError("{0} names no level; name some, or leave it out.", "levels")
    return list(dict.fromkeys(levels))
