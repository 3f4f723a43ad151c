"""What `refine` is asked for, checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .._validate import FloatArray, IntArray
from ..errors import OptionError
from ..lifting.options import as_whole
from ..mesh.triangle_mesh import TriangleMesh


def checked_ids(vertex_ids: ArrayLike, mesh: TriangleMesh, original: TriangleMesh) -> IntArray:
    """Return which vertices of the original those of the mesh lie on."""
    ids = np.asarray(vertex_ids)
    if ids.shape != (mesh.n_vertices,) or ids.dtype.kind not in "iu":
        raise OptionError(
            "{0} has shape {shape} and dtype {dtype}; give one whole number for each of {n} "
            "vertices.",
            "vertex_ids",
            shape=ids.shape,
            dtype=ids.dtype,
            n=mesh.n_vertices,
        )
    ids = ids.astype(np.int64)
    if len(ids) and (ids.min() < 0 or ids.max() >= original.n_vertices):
        raise OptionError(
            "{0} run from {low} to {high}; {1} has {n} vertices.",
            "vertex_ids",
            "original",
            low=int(ids.min()),
            high=int(ids.max()),
            n=original.n_vertices,
        )
    apart = (mesh.vertices[:, :2] != original.vertices[ids, :2]).any(axis=1)
    if apart.any():
        raise OptionError(
            "vertex {vertex} of {0} does not lie on the vertex of {1} that {2} names; give the "
            "ids of that mesh (with signal 'xyz' vertices leave their places).",
            "mesh",
            "original",
            "vertex_ids",
            vertex=int(np.argmax(apart)),
        )
    return ids


def checked_limits(max_error: ArrayLike | None, original: TriangleMesh) -> FloatArray | None:
    """Return the largest legal error at each vertex of the original."""
    if max_error is None:
        return None
    limits = np.asarray(max_error, dtype=np.float64)
    if limits.shape not in ((), (original.n_vertices,)):
        raise OptionError(
            "{0} has the shape {shape}; give one number, or one for each of {n} vertices.",
            "max_error",
            shape=limits.shape,
            n=original.n_vertices,
        )
    return np.broadcast_to(limits, (original.n_vertices,))


def strictness(limits: FloatArray | None, scale: float) -> FloatArray | None:
    """Return by how much squared errors count, where the tolerance is the square of a scale."""
    if limits is None:
        return None
    with np.errstate(divide="ignore"):  # times a squared error, the most is not to overflow
        return np.minimum((scale / limits) ** 2, np.sqrt(np.finfo(np.float64).max))


def require_sense(
    norm: str,
    rounds: int | None,
    max_error: float | None,
    max_rms: float | None,
    target_vertices: int | None,
) -> None:
    """Refuse numbers that make no sense, and rules that go with the other norm or do not agree."""
    n_rounds = 0 if rounds is None else as_whole(rounds)
    if n_rounds is None or n_rounds < 0:
        raise OptionError(
            "{0} is {given}; give a whole number of 0 or more.", "rounds", given=rounds
        )
    rules = {"max_error": max_error, "max_rms": max_rms, "target_vertices": target_vertices}
    given = {name: value for name, value in rules.items() if value is not None}
    if len(given) > 1:
        raise OptionError("{0} and {1} do not go together; give one of them.", *list(given)[:2])
    for name, value in given.items():
        due = "max" if name == "max_error" else "rms"
        if name == "target_vertices" and as_whole(value) is None:
            raise OptionError("{0} is {given}; give a whole number.", name, given=value)
        if not value >= 0:
            raise OptionError("{0} is {given}; give 0 or more.", name, given=value)
        if norm != due:
            raise OptionError(
                "{0} goes with {1} {due!r}, not {given!r}.", name, "norm", due=due, given=norm
            )
