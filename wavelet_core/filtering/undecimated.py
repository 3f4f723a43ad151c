"""Details of every vertex at once, by scale and direction: nothing is removed, so all have them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array, csr_array

from .._validate import FloatArray
from ..mesh.triangle_mesh import TriangleMesh

IndexArray = NDArray[np.int64]

#: Width of the smoother's weights, in mean distances of a ring. Half of it leaves 0 to 2.7 % more
#: error on crops of two DEMs, twice as much 0.1 % more or less.
SMOOTHER_WIDTH = 0.7
#: Directions in plan along which curvature is resolved: three numbers make a second derivative.
N_DIRECTIONS = 3
#: Meshes below this many vertices get no directions: they would fit weights to noise.
LEAST_FOR_DIRECTIONS = 3_000
#: Ridges of the local fits, relative to their sums of squares. That of the plane only keeps
#: collinear rings solvable; that of the curvature bounds it where a ring hardly determines it;
#: a tenth of it and ten times as much give the same error to four digits.
PLANE_RIDGE, CURVATURE_RIDGE = 1e-9, 1e-3
#: Rounds of averaging over rings that a variance of noise is pooled over, at the finest scale; 1
#: and 4 give the same error to four digits.
POOL_ROUNDS = 2
#: Least variance of noise at a vertex, relative to the mean of all.
LEAST_VARIANCE = 1e-3
#: Vertices whose local fits are solved between two looks at whether to stop.
FITTED_AT_ONCE = 20_000
#: Each scale but the first smooths twice as often as the one before.
ROUNDS_OF_SCALE = (1, 1, 2, 4, 8, 16, 32, 64, 128)


def _nothing() -> None:
    """Do nothing."""


@dataclass(frozen=True, slots=True)
class UndecimatedBank:
    r"""Filters that split columns on a mesh by scale and direction.

    Attributes
    ----------
    smoother : csr_array, shape (n_vertices, n_vertices)
        Value at each vertex of the plane fitted to it and its ring.
    curvatures : tuple of csr_array, each (n_vertices, n_vertices)
        Second differences along directions equally apart.
    averaging : csr_array, shape (n_vertices, n_vertices)
        Mean over a vertex and its ring.
    strengths : ndarray, shape (n_scales,)
        What the curvatures of a scale are multiplied by to make up most of its details.
    noise : tuple of ndarray of float32, each (n_vertices, n_parts)
        Standard deviation that noise of 1 leaves in the details of each scale.
    tick : callable
        Called after every pass over the mesh; it may raise, to stop.

    Notes
    -----
    The columns are smoothed 1, 2, 4, 8, ... times; the details of a scale are what is lost from
    one to the next, so that all details and the last smooth columns add up to the input. The
    smoother reproduces planes, as ``prediction="plane"`` does: a slope has no details. They are
    then split into parts along directions, which follow ridges and banks, and the rest. It is the
    lifting of all partitions at once, which the average over many random ones tends to, and the
    counterpart on a mesh of the stationary transform of images.

    References
    ----------
    J.-L. Starck, J. Fadili, F. Murtagh: The undecimated wavelet decomposition and its
    reconstruction. IEEE Transactions on Image Processing 16, 2007.
    """

    smoother: csr_array
    curvatures: tuple[csr_array, ...]
    averaging: csr_array
    strengths: FloatArray
    noise: tuple[NDArray[np.float32], ...]
    tick: Callable[[], None] = _nothing

    @classmethod
    def from_mesh(
        cls,
        mesh: TriangleMesh,
        n_scales: int,
        noise: FloatArray,
        locked: ArrayLike | None = None,
        tick: Callable[[], None] = _nothing,
    ) -> UndecimatedBank:
        """Return the bank of a mesh.

        Parameters
        ----------
        mesh : TriangleMesh
            Only x, y and the faces are looked at.
        n_scales : int
        noise : ndarray, shape (n_vertices, k)
            White noise of standard deviation 1, to measure what arrives at each scale.
        locked : array_like of bool, shape (n_vertices,), optional
            Vertices without details.
        tick : callable
            See the attribute.
        """
        tick()
        around = rings(mesh, tick)
        is_locked = np.zeros(mesh.n_vertices, dtype=bool)
        if locked is not None:
            is_locked |= np.asarray(locked, dtype=bool)
        has_directions = mesh.n_vertices >= LEAST_FOR_DIRECTIONS
        smooth, along = _entries(around, mesh.vertices[:, :2], is_locked, has_directions, tick)
        counts = np.diff(around.indptr)
        bank = cls(
            around.matrix(smooth),
            tuple(around.matrix(one) for one in along),
            around.matrix(np.repeat(1.0 / counts, counts)),
            np.ones(min(n_scales, len(ROUNDS_OF_SCALE))),
            (),
            tick,
        )
        return bank._measured(noise)

    def for_noise(self, columns: FloatArray) -> UndecimatedBank:
        """Return the bank for noise of another kind, of which columns are given."""
        return self._measured(columns, keeps_strengths=True)

    @property
    def n_scales(self) -> int:
        """How many scales there are."""
        return len(self.strengths)

    @property
    def n_parts(self) -> int:
        """Into how many parts the details of a scale are split."""
        return len(self.curvatures) + 1

    def details(self, columns: FloatArray) -> Iterator[list[FloatArray]]:
        """Yield the details of each scale from the finest: its parts, each ``(n_vertices, k)``."""
        for scale, strength in enumerate(self.strengths):
            details, along, columns = self._split(columns, scale)
            parts = list(_parts_of(details, along, strength))
            del details, along
            yield parts

    def local_energy(self, energy: FloatArray, rounds: int) -> FloatArray:
        """Return values ``(n_vertices, ...)`` averaged over their neighbourhood."""
        shape = energy.shape
        energy = energy.reshape(shape[0], -1)
        for _ in range(rounds):
            energy = self.averaging @ energy
            self.tick()
        return energy.reshape(shape)

    def _split(
        self, columns: FloatArray, scale: int
    ) -> tuple[FloatArray, list[FloatArray], FloatArray]:
        smooth = columns
        for _ in range(ROUNDS_OF_SCALE[scale]):
            smooth = self.smoother @ smooth
            self.tick()
        along = []
        for one in self.curvatures:
            along.append(one @ columns)
            self.tick()
        return columns - smooth, along, smooth

    def _measured(self, noise: FloatArray, *, keeps_strengths: bool = False) -> UndecimatedBank:
        """Return the bank with the strengths and deviations that noise shows."""
        strengths, deviations, columns = self.strengths.copy(), [], noise
        for scale in range(self.n_scales):
            details, along, columns = self._split(columns, scale)
            if along and not keeps_strengths:
                together = sum(along[1:], start=along[0])
                most = float(np.sum(together**2))
                strengths[scale] = float(np.sum(details * together)) / most if most > 0 else 0.0
            squares = np.empty((len(noise), self.n_parts))
            for part, one in enumerate(_parts_of(details, along, strengths[scale])):
                squares[:, part] = np.mean(one**2, axis=1)
                self.tick()
            del details, along
            variance = self.local_energy(squares, POOL_ROUNDS + scale)
            floor = LEAST_VARIANCE * variance.mean(axis=0)
            variance += np.where(floor > 0, floor, 1.0)
            # An estimate, of far fewer digits than these.
            deviations.append(np.sqrt(variance).astype(np.float32))
        return replace(self, strengths=strengths, noise=tuple(deviations))


def _parts_of(
    details: FloatArray, along: list[FloatArray], strength: float
) -> Iterator[FloatArray]:
    """Yield the details along each direction, and the rest."""
    rest = details
    if along:
        together = strength * along[0]
        for one in along[1:]:
            together = together + strength * one
        rest = details - together
    for one in along:
        yield strength * one
    yield rest


def n_ticks(n_vertices: int, n_scales: int) -> int:
    """Return how often a bank of so many scales ticks while it is made."""
    n_directions = N_DIRECTIONS if n_vertices >= LEAST_FOR_DIRECTIONS else 0
    of_scales = sum(
        ROUNDS_OF_SCALE[scale] + n_directions + (n_directions + 1) + POOL_ROUNDS + scale
        for scale in range(min(n_scales, len(ROUNDS_OF_SCALE)))
    )
    n_blocks = -(-n_vertices // FITTED_AT_ONCE)
    return 4 + n_blocks * (2 if n_directions else 1) + of_scales


class Rings(NamedTuple):
    """Every vertex with its neighbours and itself, in the rows of a sparse matrix.

    indptr : (n_vertices + 1,) int32; indices : (n_entries,) int32
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]

    @property
    def rows(self) -> NDArray[np.int32]:
        """The vertex of each entry."""
        return np.repeat(np.arange(len(self.indptr) - 1, dtype=np.int32), np.diff(self.indptr))

    def matrix(self, entries: FloatArray) -> csr_array:
        """Return the matrix of some entries; all of them share the arrays of their places."""
        n = len(self.indptr) - 1
        return csr_array((entries, self.indices, self.indptr), shape=(n, n))


def rings(mesh: TriangleMesh, tick: Callable[[], None] = _nothing) -> Rings:
    """Return the neighbours of every vertex, in the order of their numbers, itself among them."""
    n = mesh.n_vertices
    a, b, c = mesh.faces.astype(np.int32, copy=False).T
    own = np.arange(n, dtype=np.int32)
    start = np.concatenate([a, b, c, b, c, a, own])
    end = np.concatenate([b, c, a, a, b, c, own])
    pattern = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(n, n))
    del start, end
    tick()
    found = csr_array(pattern)
    tick()
    found.sort_indices()
    tick()
    return Rings(
        found.indptr.astype(np.int32, copy=False), found.indices.astype(np.int32, copy=False)
    )


def _entries(
    around: Rings,
    plan: FloatArray,
    is_locked: NDArray[np.bool_],
    has_directions: bool,
    tick: Callable[[], None],
) -> tuple[FloatArray, list[FloatArray]]:
    """Return the entries of the smoother, and of the curvatures if they are asked for."""
    smooth = np.empty(len(around.indices))
    along = [np.empty(len(smooth)) for _ in range(N_DIRECTIONS if has_directions else 0)]
    for first in range(0, len(plan), FITTED_AT_ONCE):
        ends = around.indptr[first : first + FITTED_AT_ONCE + 1]
        part, n = slice(int(ends[0]), int(ends[-1])), len(ends) - 1
        columns = around.indices[part]
        rows = np.repeat(np.arange(n), np.diff(ends))
        is_own = columns == rows + first
        # In mean distances of the ring.
        offsets = plan[columns] - plan[first : first + n][rows]
        mean = np.bincount(rows, np.hypot(*offsets.T), n) / np.maximum(np.diff(ends) - 1, 1)
        offsets /= np.where(mean > 0, mean, 1.0)[rows, None]
        held = is_locked[first : first + n][rows]
        smooth[part] = np.where(held, is_own, _of_smoother(rows, offsets, n))
        tick()
        if along:
            found = _of_curvatures(rows, is_own, offsets, n)
            for one, entries in zip(along, found, strict=True):
                one[part] = np.where(held, 0.0, entries)
            tick()
    return smooth, along


def _of_smoother(rows: IndexArray, offsets: FloatArray, n: int) -> FloatArray:
    """Return the value at each vertex of a plane fitted to it and its ring, by least squares."""
    weights = np.exp(-0.5 * np.sum(offsets**2, axis=1) / SMOOTHER_WIDTH**2)
    terms = np.column_stack([np.ones(len(rows)), offsets])
    normal = _normal_equations(rows, weights, terms, n)
    normal[:, [1, 2], [1, 2]] += PLANE_RIDGE * normal[:, :1, 0]
    value = np.linalg.inv(normal)[:, 0]
    entries: FloatArray = np.einsum("ek,ek->e", value[rows], terms) * weights
    return entries


def _of_curvatures(
    rows: IndexArray, is_own: NDArray[np.bool_], offsets: FloatArray, n: int
) -> Iterator[FloatArray]:
    """Yield half the second derivatives along directions, of quadratics through each vertex."""
    dx, dy = offsets.T
    weights = np.where(is_own, 0.0, 1.0 / np.maximum(np.hypot(dx, dy), 0.3))
    terms = np.column_stack([dx, dy, dx**2, dx * dy, dy**2])
    normal = _normal_equations(rows, weights, terms, n)
    size = np.maximum(np.trace(normal, axis1=1, axis2=2), 1e-12)[:, None]
    # No ridge to speak of on the slope: a plane must have no curvature, however steep.
    normal[:, [0, 1], [0, 1]] += PLANE_RIDGE * size
    normal[:, [2, 3, 4], [2, 3, 4]] += CURVATURE_RIDGE * size
    inverse = np.linalg.inv(normal)
    second = [np.einsum("ek,ek->e", inverse[rows, k], terms) * weights for k in (2, 3, 4)]
    for angle in np.pi / N_DIRECTIONS * np.arange(N_DIRECTIONS):
        east, north = np.cos(angle), np.sin(angle)
        entries = east**2 * second[0] + east * north * second[1] + north**2 * second[2]
        yield np.where(is_own, -np.bincount(rows, entries, n)[rows], entries)


def _normal_equations(
    rows: IndexArray, weights: FloatArray, terms: FloatArray, n: int
) -> FloatArray:
    """Return the sums over each ring of the products of terms, ``(n, n_terms, n_terms)``."""
    k = terms.shape[1]
    sums = np.empty((n, k, k))
    for a in range(k):
        for b in range(a, k):
            sums[:, a, b] = sums[:, b, a] = np.bincount(
                rows, weights * terms[:, a] * terms[:, b], n
            )
    return sums
