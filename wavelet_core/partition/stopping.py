"""Why an analysis ended where it did."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import counted

#: Reason codes, and what each means.
REASONS = {
    "target": "the number of vertices that was asked for is reached",
    "levels": "the number of levels is reached",
    "tolerance": "the next removal would break the tolerance",
    "nothing_left": "no vertex that is left can be removed",
}


class StopRecord(NamedTuple):
    """Why an analysis ended, and what the vertices are that it left.

    reason : one of REASONS
    n_vertices : vertices of the coarsest level
    n_locked : those of them that are locked
    n_outline : those on an outline, of a hole or of the whole, or without a face; not locked
    n_inner : the others
    target_vertices : the number that was asked for, or None
    """

    reason: str
    n_vertices: int
    n_locked: int
    n_outline: int
    n_inner: int
    target_vertices: int | None = None

    @property
    def misses_target(self) -> bool:
        """Whether more vertices are left than were asked for."""
        return self.target_vertices is not None and self.n_vertices > self.target_vertices

    def __str__(self) -> str:
        """Return one sentence."""
        kinds = (
            (self.n_locked, "locked"),
            (self.n_outline, "on outlines and holes, which keep their place"),
            (self.n_inner, "inside, where no collapse is legal or within the tolerance"),
        )
        left = "; ".join(f"{count:,} {kind}" for count, kind in kinds if count)
        verb = "is" if self.n_vertices == 1 else "are"
        sentence = f"{counted(self.n_vertices, 'vertex', 'vertices')} {verb} left"
        if self.misses_target:
            sentence += f", where {self.target_vertices:,} were asked for"
        sentence += f": {REASONS[self.reason]}"
        return f"{sentence} ({left})." if self.reason == "nothing_left" else f"{sentence}."


def stop_record(
    reason: str,
    faces: NDArray[np.integer],
    locked: NDArray[np.bool_],
    target_vertices: int | None = None,
) -> StopRecord:
    """Return the record of an analysis that ended with these faces.

    Parameters
    ----------
    reason : str
        One of REASONS.
    faces : ndarray of int, shape (n_faces, 3)
        Of the coarsest level.
    locked : ndarray of bool, shape (n_vertices,)
        Of the coarsest level.
    target_vertices : int, optional
        The number that was asked for.
    """
    n_vertices = len(locked)
    on_outline = np.ones(n_vertices, dtype=bool)
    on_outline[faces] = False
    tail, head = faces.ravel().astype(np.int64), faces[:, [1, 2, 0]].ravel().astype(np.int64)
    edges = np.minimum(tail, head) * n_vertices + np.maximum(tail, head)
    edges.sort()  # an edge of one face alone differs from both beside it
    differs = np.ones(len(edges) + 1, dtype=bool)
    differs[1:-1] = edges[1:] != edges[:-1]
    outline = edges[differs[1:] & differs[:-1]]
    on_outline[outline // n_vertices] = on_outline[outline % n_vertices] = True
    n_locked = int(locked.sum())
    n_outline = int((on_outline & ~locked).sum())
    n_inner = n_vertices - n_locked - n_outline
    return StopRecord(reason, n_vertices, n_locked, n_outline, n_inner, target_vertices)
