"""Offsets of whole lines, of a scan or of a flight, told from the terrain and taken out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array, diags
from scipy.sparse.linalg import spsolve

from ..._validate import FloatArray, IntArray
from ...errors import OptionError
from ..undecimated import UndecimatedBank
from .white import NORMAL_MAD

#: What stands for no line.
NO_LINE = -1
#: Lines of fewer vertices have no offset.
LEAST_OF_LINE = 8
#: Smoothings that lead from one scale of details to the next. With those of a scale more the errors
#: of the offsets, on nine windows of seven DEMs as for all numbers here, are 2 % larger on the
#: average at the same caution, and take three times as long.
ROUNDS_OF_SCALES = (1, 2, 4)
#: Rounds of averaging over rings by which relief is measured, at the finest scale and for each
#: smoothing more; 1 and 8 at the finest give the same errors to 2 %.
RELIEF_ROUNDS, RELIEF_ROUNDS_MORE = 3, 2
#: Least relief, relative to the median one, by its square.
LEAST_RELIEF = 1e-3
#: Details beyond so many deviations count less and less; 1 leaves 2 % more error, 4 1 % less.
ROBUST_DEVIATIONS = 2.0
#: Tiles of the map along each axis: between them the details of a line are independent. 8 and 16
#: give the same errors to 3 %.
TILES = 12
#: Tiles' worth of belief in the mean of all lines, where the variance of one line is estimated.
TILES_OF_ALL = 12
#: How much less the details count together than if those of neighbouring lines were independent.
#: The error of strong offsets is least at 12 on the average, 7 % above that at 5 and 31 % at 2;
#: that of weak ones grows with it: 5 to 9 % of a deviation at 3, 7 to 10 % at 12.
CAUTION = 6.0
#: Passes of the weights; 3 leave 3 % more error, 8 the same.
PASSES = 5
#: Vertices whose share of the normal equations is summed at once.
ROWS_AT_ONCE = 100_000
#: Looks at whether to stop, roughly.
STEPS_OF_STRIPES = 150
#: Offsets are believed where the squares of their scores are above those of chance by this much,
#: over the root of the number of lines.
LEAST_EXCESS = 12.0
#: Of so many lines and more, those beyond so many deviations of the others are terrain: a ridge, a
#: dyke or a road along the line.
LEAST_LINES_TO_COMPARE, UNLIKE_DEVIATIONS = 20, 4.0
#: Beyond so many of them, offsets are shrunk less.
FREE_DEVIATIONS = 2.5
#: Details below this part of the values are rounding.
ROUNDING = 1e-10


class Stripes(NamedTuple):
    """The offsets of lines in a column.

    Attributes
    ----------
    lines : ndarray of int64, shape (n_lines,)
        Labels of the lines.
    offsets : ndarray, shape (n_lines,)
        What was in the values of each line beside the terrain; 0 for lines that keep theirs.
    deviation : float
        Standard deviation of the offsets; 0 where there are none to be told from chance.
    n_unlike : int
        Lines that differ from their neighbours far more than the others do, and were left.
    """

    lines: IntArray
    offsets: FloatArray
    deviation: float = 0.0
    n_unlike: int = 0

    def of_vertices(self, lines: IntArray) -> FloatArray:
        """Return the offset at each vertex, whose line is given."""
        at = np.minimum(np.searchsorted(self.lines, lines), max(len(self.lines) - 1, 0))
        known = self.lines[at] == lines
        return np.where(known, self.offsets[at], 0.0)

    def in_unit(self, unit: float) -> Stripes:
        """Return them in another unit, given in the present one."""
        return self._replace(offsets=self.offsets / unit, deviation=self.deviation / unit)

    def describe(self) -> str:
        """Return what was found, in words.

        Examples
        --------
        >>> Stripes(np.arange(3), np.array([0.1, -0.2, 0.1]), 0.17).describe()
        'offsets of 0.17 taken out of 3 lines'
        >>> Stripes(np.arange(3), np.zeros(3)).describe()
        'no offsets found in 3 lines'
        """
        n_lines = len(self.lines)
        if self.deviation == 0.0:
            return f"no offsets found in {n_lines:,} lines"
        words = f"offsets of {self.deviation:.3g} taken out of {n_lines - self.n_unlike:,} lines"
        return words + (f", {self.n_unlike:,} unlike them left" if self.n_unlike else "")


def check_lines(lines: ArrayLike, n_vertices: int) -> IntArray:
    """Return labels of lines as an array.

    Raises
    ------
    OptionError
        Not one whole number of -1 or more for each vertex, or fewer than two lines.
    """
    given = np.asarray(lines)
    if given.shape != (n_vertices,):
        raise OptionError(
            "{0} has the shape {shape}; give one number for each of the {n_vertices} vertices.",
            "lines",
            shape=given.shape,
            n_vertices=n_vertices,
        )
    is_whole = given.dtype.kind in "iu" or (
        given.dtype.kind == "f" and bool(np.all(np.isfinite(given) & (given == np.rint(given))))
    )
    if not is_whole or (n_vertices and (given.min() < NO_LINE or given.max() >= 2**62)):
        raise OptionError(
            "{0} has values that are no labels; give whole numbers from 0 up, and {no_line} for "
            "vertices of no line.",
            "lines",
            no_line=NO_LINE,
        )
    labels = given.astype(np.int64)
    n_lines = len(np.unique(labels[labels >= 0]))
    if n_lines < 2:
        raise OptionError(
            "{0} has {n_lines} line{plural}; offsets are those between two lines or more.",
            "lines",
            n_lines=n_lines,
            plural="" if n_lines == 1 else "s",
        )
    return labels


def stripes_of(
    bank: UndecimatedBank, plan: FloatArray, values: FloatArray, lines: IntArray
) -> Stripes:
    r"""Return the offsets of the lines.

    Parameters
    ----------
    bank : UndecimatedBank
        Of the mesh.
    plan : ndarray, shape (n_vertices, 2)
    values : ndarray, shape (n_vertices,)
    lines : ndarray of int64, shape (n_vertices,)
        The line of each vertex, -1 for none.

    Notes
    -----
    The offsets o are those for which the details of the values, less the details :math:`A\,o` that
    the offsets make, are least at several scales, by robust least squares: relief and outliers
    have little weight, and details count the less the more a line differs from one tile of the map
    to the next, since an offset is the same all along it and terrain is not. So the
    variance of each line's equation is measured, terrain included. It gives that of the offsets,
    :math:`\tau^2`, by the squares of the scores that are above what it takes for chance (their
    median, where there are many lines); none above it, no stripes. The offsets are then shrunk by
    :math:`\tau^2` against their own variance. What all lines share, and what changes slowly from
    line to line, has no details and stays with the terrain.

    References
    ----------
    B. K. P. Horn, R. J. Woodham: Destriping Landsat MSS images by histogram modification. Computer
    Graphics and Image Processing 10, 1979 (offsets by line).
    J. C. Gallant, A. M. Read: Enhancing the SRTM data for Australia. Proceedings of
    Geomorphometry, 2009 (stripes of elevations).
    H. White: A heteroskedasticity-consistent covariance matrix estimator. Econometrica 48, 1980
    (variance by what differs, here between tiles).
    """
    labels, counts = np.unique(lines[lines >= 0], return_counts=True)
    labels = labels[counts >= LEAST_OF_LINE]
    nothing = Stripes(labels, np.zeros(len(labels)))
    if len(labels) < 2:
        return nothing
    equations = _Equations.of(bank, plan, values, lines, labels)
    if equations.scales[0].of_nothing(float(np.ptp(values))):
        return nothing
    offsets, deviation = nothing.offsets, 0.0
    for _ in range(PASSES):
        normal, right = equations.normal(offsets)
        deviation = _deviation(normal, right)
        if deviation == 0.0:
            return nothing
        belief = np.ones(len(labels))
        if len(labels) >= LEAST_LINES_TO_COMPARE:
            # A line unlike the others takes what it has, or its neighbours would take some of it.
            limit = FREE_DEVIATIONS * deviation
            belief = (limit / np.maximum(np.abs(offsets), limit)) ** 2
        ridge = diags(belief * (CAUTION / deviation**2))
        offsets = spsolve((normal + ridge).tocsc(), right)
        bank.tick()
    if not (lines == NO_LINE).any():
        offsets = offsets - np.average(offsets, weights=equations.counts)
    is_unlike = np.zeros(len(labels), dtype=bool)
    if len(labels) >= LEAST_LINES_TO_COMPARE:
        is_unlike = np.abs(offsets) > UNLIKE_DEVIATIONS * deviation
    return Stripes(
        labels, np.where(is_unlike, 0.0, offsets), deviation, int(np.count_nonzero(is_unlike))
    )


def _deviation(normal: csr_array, right: FloatArray) -> float:
    """Return the deviation of the offsets, whose scores are ``right``; 0 where it is chance.

    The scores have the covariance ``normal`` without offsets.
    """
    own = normal.diagonal()
    known = own > 0
    if known.sum() < 2:
        return 0.0
    scores = right[known] ** 2 / own[known]
    gain = np.asarray(normal.multiply(normal).sum(axis=1)).ravel()[known] / own[known]
    n_lines = len(scores)
    if n_lines >= LEAST_LINES_TO_COMPARE:
        excess, gain = np.median(scores) / NORMAL_MAD**2 - 1.0, np.median(gain)
    else:
        excess, gain = scores.mean() - 1.0, gain.mean()
    if excess <= LEAST_EXCESS / np.sqrt(n_lines):
        return 0.0
    return float(np.sqrt(excess / gain))


class _Scale(NamedTuple):
    """Details of one scale, and those of each line's offset of 1, a column for each line."""

    details: FloatArray
    of_lines: csr_array
    rounds: int

    def of_nothing(self, spread: float) -> bool:
        """Whether all the details are rounding, as on a plane without noise."""
        return float(np.abs(self.details).max(initial=0.0)) <= ROUNDING * spread


class _Equations(NamedTuple):
    """What the details of all scales say of the offsets."""

    bank: UndecimatedBank
    scales: list[_Scale]
    tiles: list[IntArray]
    counts: IntArray
    line: IntArray

    @classmethod
    def of(
        cls,
        bank: UndecimatedBank,
        plan: FloatArray,
        values: FloatArray,
        lines: IntArray,
        labels: IntArray,
    ) -> _Equations:
        n = len(values)
        line = np.minimum(np.searchsorted(labels, lines), len(labels) - 1)
        line = np.where(labels[line] == lines, line, NO_LINE)
        on_line = np.flatnonzero(line >= 0)
        of_lines = csr_array(
            (np.ones(len(on_line)), (on_line, line[on_line])), shape=(n, len(labels))
        )
        column = values - values.mean()
        scales = []
        for rounds in ROUNDS_OF_SCALES:
            smooth, smooth_lines = column, of_lines
            for _ in range(rounds):
                smooth, smooth_lines = bank.smoother @ smooth, bank.smoother @ smooth_lines
                bank.tick()
            # Of far fewer digits than these.
            lost = csr_array(of_lines - smooth_lines).astype(np.float32)
            scales.append(_Scale(column - smooth, lost, rounds))
            column, of_lines = smooth, smooth_lines
        extent = np.maximum(np.ptp(plan, axis=0), 1e-300)
        across = np.minimum(((plan - plan.min(axis=0)) / extent * TILES).astype(int), TILES - 1)
        tile = across[:, 0] * TILES + across[:, 1]
        order = np.argsort(tile, kind="stable")
        ends = np.searchsorted(tile[order], np.arange(TILES**2 + 1))
        counts = np.bincount(line[on_line], minlength=len(labels))
        return cls(bank, scales, [order, ends], counts, line)

    def normal(self, offsets: FloatArray) -> tuple[csr_array, FloatArray]:
        """Return the normal equations, by weights from what these offsets leave.

        They are scaled so that the matrix is the covariance of the right side without offsets.
        """
        n_lines = len(offsets)
        normal, right = csr_array((n_lines, n_lines)), np.zeros(n_lines)
        together = csr_array((TILES**2, n_lines))
        for scale in self.scales:
            rest = scale.details - scale.of_lines @ offsets
            weights = self._weights(rest, scale.rounds)
            by_tile = self._by_tile(weights * rest, scale.of_lines)
            own = _weighted(scale.of_lines, weights).diagonal()
            variance = _variance_of_lines(by_tile, own)
            typical = np.median(variance)
            weights /= np.where(self.line >= 0, variance[self.line], typical)
            normal = normal + _weighted(scale.of_lines, weights)
            right += scale.of_lines.T @ (weights * scale.details)
            together = together + self._by_tile(weights * rest, scale.of_lines)
        own = normal.diagonal()
        overlap = _total_variance(together).sum() / max(own.sum(), 1e-300)
        overlap = max(float(overlap), 1e-300)
        return normal / overlap, right / overlap

    def _weights(self, rest: FloatArray, rounds: int) -> FloatArray:
        squares = rest**2
        relief = self.bank.local_energy(squares, RELIEF_ROUNDS + RELIEF_ROUNDS_MORE * rounds)
        relief += max(LEAST_RELIEF * float(np.median(relief)), 1e-300)
        robust = 1.0 + squares / (ROBUST_DEVIATIONS**2 * relief)
        return 1.0 / (robust * relief)

    def _by_tile(self, weighted: FloatArray, of_lines: csr_array) -> csr_array:
        """Return the scores of each line from each tile, ``(n_tiles, n_lines)``."""
        order, ends = self.tiles
        shape = (TILES**2, len(order))
        return csr_array((weighted[order], order, ends), shape=shape) @ of_lines


def _weighted(of_lines: csr_array, weights: FloatArray) -> csr_array:
    """Return the normal matrix of the details of lines, by weights of the vertices."""
    n_lines = of_lines.shape[1]
    normal = csr_array((n_lines, n_lines))
    for first in range(0, len(weights), ROWS_AT_ONCE):
        part = of_lines[first : first + ROWS_AT_ONCE]
        rows = np.repeat(weights[first : first + ROWS_AT_ONCE], np.diff(part.indptr))
        weighted = csr_array((part.data * rows, part.indices, part.indptr), part.shape)
        normal = normal + part.T @ weighted
    return csr_array(normal)


def _total_variance(by_tile: csr_array) -> FloatArray:
    """Return the variance of each line's score, from what its tiles differ by."""
    scores = by_tile.tocoo()
    n_lines = by_tile.shape[1]
    counts = np.bincount(scores.col, minlength=n_lines)
    total = np.bincount(scores.col, scores.data, n_lines)
    squares = np.bincount(scores.col, scores.data**2, n_lines)
    apart = squares - total**2 / np.maximum(counts, 1)
    return np.maximum(apart, 0.0) * counts / np.maximum(counts - 1, 1)


def _variance_of_lines(by_tile: csr_array, own: FloatArray) -> FloatArray:
    """Return by how much the variance of each line's score is above that of its weights alone."""
    variance = _total_variance(by_tile)
    of_all = variance.sum() / max(own.sum(), 1e-300)
    counts = np.bincount(by_tile.tocoo().col, minlength=len(own))
    degrees = np.maximum(counts - 1, 0)
    of_line = variance / np.maximum(own, 1e-300)
    shrunk = (degrees * of_line + TILES_OF_ALL * of_all) / (degrees + TILES_OF_ALL)
    return np.maximum(np.where(own > 0, shrunk, of_all), 1e-300)
