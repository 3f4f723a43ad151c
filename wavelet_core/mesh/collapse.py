"""Half-edge collapses: the rules they obey, and the mesh they leave.

Which kind of vertex may collapse onto which neighbour::

    removed v    onto any neighbour    onto an outline neighbour, along the outline
    interior     yes                   yes
    outline      no                    yes: always with signal "xyz"; with signal "z" only
                                       where the outline runs straight through v
    corner       no                    no (a vertex with a single face)
    pinch        no                    no
    isolated     no                    no
    locked       no                    no

and only if no new face is flipped or flat, no neighbour loses its last face or, within the
surface, is left with two of them back to back, and the link condition holds, also against edges
that earlier collapses of the same pass made (Fig. 3).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._threads import run_in_blocks


def even_positions(odd: NDArray[np.int32], n_vertices: int) -> NDArray[np.int32]:
    """Return the ids of the vertices that stay, ascending: the complement of ``odd``."""
    stays = np.ones(n_vertices, dtype=bool)
    stays[odd] = False
    return np.flatnonzero(stays).astype(np.int32)


def merge_map(
    odd: NDArray[np.int32], target: NDArray[np.int32], n_vertices: int
) -> NDArray[np.int32]:
    """Return for every vertex of a level its id in the coarser one, odd ones at their target."""
    stays = np.ones(n_vertices, dtype=bool)
    stays[odd] = False
    position = np.cumsum(stays, dtype=np.int32) - np.int32(1)
    position[odd] = position[target]
    return position


def merged_faces(faces: NDArray[np.integer], position: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the faces after the collapses; those that lost their area have dropped out."""

    def merge(start: int, stop: int) -> NDArray[np.int32]:
        moved = position[faces[start:stop]]
        a, b, c = moved.T
        return moved[(a != b) & (b != c) & (c != a)]

    return np.concatenate([np.empty((0, 3), np.int32), *run_in_blocks(merge, len(faces))])
