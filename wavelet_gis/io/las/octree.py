"""What octrees of points have in common, those of COPC files and of Entwine Point Tiles.

Nodes of level 0 are few points of all; each level beneath halves their side and their spacing.
"""

from __future__ import annotations

__all__ = ["MOST_LEVELS", "Box", "finest_level", "reaches_into"]

#: Smallest x and y, largest x and y.
Box = tuple[float, float, float, float]

#: Levels of a tree, at most; more would be smaller than the steps of any coordinates.
MOST_LEVELS = 32


def finest_level(spacing: float, resolution: float | None) -> int:
    """Return the first level whose points are as near to each other as they are wanted.

    Parameters
    ----------
    spacing : float
        Of the points of level 0, in the unit of x and y.
    resolution : float or None
        Spacing that is enough; None for all levels.

    Examples
    --------
    >>> finest_level(8.0, 3.0), finest_level(8.0, None)
    (2, 32)
    """
    if resolution is None:
        return MOST_LEVELS
    levels = range(MOST_LEVELS)
    return next((level for level in levels if spacing / 2**level <= resolution), MOST_LEVELS)


def reaches_into(west: float, south: float, sides: tuple[float, float], bbox: Box | None) -> bool:
    """Return whether a node has a part, or an edge, in a box; always where there is none.

    Parameters
    ----------
    west, south : float
        Its corner.
    sides : tuple of float
        Its extent in x and y.
    bbox : tuple of float or None
    """
    return bbox is None or (
        west <= bbox[2]
        and south <= bbox[3]
        and west + sides[0] >= bbox[0]
        and south + sides[1] >= bbox[1]
    )
