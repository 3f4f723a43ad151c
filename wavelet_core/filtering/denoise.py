"""Denoising: details of many scales and directions, weighted by an estimate of the risk."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from .._validate import FloatArray
from ..errors import OptionError
from ..lifting.analyse import EXPECTED_KEPT, analyse
from ..lifting.linear_map import Transform
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, report
from . import _weighted_sum
from ._weighted_sum import WeightedSum
from .gains import channel_index
from .noise import check_sigma, estimate_noise, noise_columns, noise_gains
from .undecimated import UndecimatedBank

#: Scales of the details of all vertices for a level of a pyramid: they reach as far.
SCALES_PER_LEVEL = 0.5
#: A pyramid for denoising stops where its mesh would be smaller than this.
LEAST_VERTICES = 100
#: Time that the details of all vertices take, in pyramids: for the progress.
TIME_OF_VERTICES = 2


def denoise(
    mesh: TriangleMesh,
    sigma: float | None = None,
    *,
    n_pyramids: int = 8,
    levels: int = 14,
    prediction: str = "plane",
    channels: Sequence[str] = ("z",),
    locked: ArrayLike | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> TriangleMesh:
    r"""Return the mesh with the noise taken out of its elevations or attributes.

    Parameters
    ----------
    mesh : TriangleMesh
        A TIN; its x and y stay as they are. Cells of a grid and scattered points will both do.
    sigma : float, optional
        Standard deviation of the noise, in the unit of the channel; by default estimated.
    n_pyramids : int
        Number of pyramids, each from another random order of removal. More help little on a
        grid, some percent where points are scattered unevenly, and take their time.
    levels : int
        The most levels of a pyramid. A feature that spans many more vertices than
        ``1.15 ** levels`` is left alone.
    prediction : str
        As for :func:`wavelet_core.analyse`; it should look at x and y only.
    channels : sequence of str
        Which columns to change: ``"z"`` and names of attributes.
    locked : array_like of bool, shape (n_vertices,), optional
        Vertices whose values are exact and stay.
    seed : int
        The same seed gives the same result.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    TriangleMesh

    Raises
    ------
    OptionError
        An unknown channel, a negative sigma, no pyramid.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The surface is taken apart in two ways. Pyramids in random order see it through other
    triangles each, so that their average shows none of them; for images this is known as cycle
    spinning. :class:`~wavelet_core.filtering.undecimated.UndecimatedBank` gives each vertex a
    detail at every scale, split by direction, since along a ridge or a bank there is less noise to
    be mistaken for terrain. The details d of either enter as they are and damped in two ways,
    :math:`d \exp(-(E / T)^2)`, where E is the local energy in units of the noise that reaches each
    detail (:func:`wavelet_core.filtering.noise.noise_gains`). The result is the input plus the
    weighted sum of these columns F whose expected squared error, by Stein's unbiased estimate,
    is least: :math:`M b = -\sigma^2 \operatorname{div} F` with :math:`M = F^T F`, within bounds
    that neither turn a detail over nor boost it by more than a half, to be shared by the two ways.
    No clean surface and no threshold is needed, and noise of zero gives back the input. The
    estimate holds for white normal noise; M is taken from the average of all pyramids, which is
    what makes the weights fit the average rather than a single one.

    References
    ----------
    F. Luisier, T. Blu, M. Unser: A new SURE approach to image denoising: interscale orthonormal
    wavelet thresholding. IEEE Transactions on Image Processing 16, 2007.
    R. R. Coifman, D. L. Donoho: Translation-invariant de-noising. Wavelets and Statistics, 1995.
    S. Ramani, T. Blu, M. Unser: Monte-Carlo SURE. IEEE Transactions on Image Processing 17, 2008.

    Examples
    --------
    >>> import numpy as np
    >>> from wavelet_core import TriangleMesh, denoise
    >>> x = np.arange(50.0)
    >>> noise = np.random.default_rng(0).normal(0, 0.2, (50, 50))
    >>> noisy = TriangleMesh.from_grid(np.sin(x / 9) + noise, x=x, y=x)
    >>> clean = denoise(noisy, sigma=0.2, n_pyramids=4)
    >>> truth = np.tile(np.sin(x / 9), 50)
    >>> float(np.std(clean.vertices[:, 2] - truth)) < 0.06
    True
    """
    check_sigma(sigma)
    if n_pyramids < 1:
        raise OptionError("{0} is {given}; give 1 or more.", "n_pyramids", given=n_pyramids)
    if levels < 1:
        raise OptionError("{0} is {given}; give 1 or more.", "levels", given=levels)
    names = ("z", *mesh.attribute_names)
    chosen = [channel_index(names, name) for name in channels]
    columns = np.column_stack([mesh.vertices[:, 2], mesh.attributes])
    deviations = [
        estimate_noise(mesh, columns[:, c]) if sigma is None else float(sigma) for c in chosen
    ]
    changed = [c for c, deviation in zip(chosen, deviations, strict=True) if deviation > 0]
    if changed and len(mesh.faces):
        decompositions = _Decompositions(mesh, n_pyramids, levels, prediction, locked, seed)
        weighted = [
            decompositions.weighted_sum(columns[:, c], deviation)
            for c, deviation in zip(chosen, deviations, strict=True)
            if deviation > 0
        ]
        _run(decompositions, weighted, progress)
        for c, one in zip(changed, weighted, strict=True):
            columns[:, c] = one.result
    _report(progress, 1.0)
    return TriangleMesh._trusted(
        np.column_stack([mesh.vertices[:, :2], columns[:, 0]]),
        mesh.faces,
        columns[:, 1:].copy(),
        mesh.attribute_names,
    )


class _Decompositions:
    """What takes the mesh apart by scale: pyramids in random order, and all vertices at once."""

    def __init__(
        self,
        mesh: TriangleMesh,
        n_pyramids: int,
        levels: int,
        prediction: str,
        locked: ArrayLike | None,
        seed: int,
    ) -> None:
        self._mesh, self._prediction, self._locked, self._seed = mesh, prediction, locked, seed
        self.n_pyramids = n_pyramids
        self.n_vertices = mesh.n_vertices
        self.levels = _depth(mesh.n_vertices, levels)
        noise = noise_columns(mesh.n_vertices, seed)
        n_scales = max(round(SCALES_PER_LEVEL * self.levels), 1)
        self.bank = UndecimatedBank.from_mesh(mesh, n_scales, noise, locked)

    def weighted_sum(self, values: FloatArray, sigma: float) -> WeightedSum:
        """Return the sum of a column's details, whose weights are yet to be fitted."""
        return WeightedSum(values, sigma, self.bank, self.n_pyramids, self.levels, self._seed)

    def pyramids(self) -> Iterator[tuple[Transform, list[FloatArray]]]:
        """Yield the transform of each pyramid and how noise reaches its details."""
        for k in range(self.n_pyramids):
            transform = _transform(
                self._mesh, self.levels, self._prediction, self._locked, self._seed * 1_000_003 + k
            )
            yield transform, noise_gains(transform, seed=self._seed)


def _run(
    decompositions: _Decompositions, weighted: Sequence[WeightedSum], progress: Progress | None
) -> None:
    """Fit the weights of every column, then sum; meshes too large to keep are gone over twice."""
    fits_in_one = decompositions.n_vertices <= _weighted_sum.MAX_FITTED
    n_parts = (decompositions.n_pyramids + TIME_OF_VERTICES) * (1 if fits_in_one else 2)
    n_done = 0
    for is_fit in (True,) if fits_in_one else (True, False):
        for one in weighted:
            (one.fit_vertices if is_fit else one.add_vertices)(
                partial(_report, progress, n_done / n_parts)
            )
        n_done += TIME_OF_VERTICES
        if is_fit or any(one.uses_pyramids for one in weighted):
            for transform, gains in decompositions.pyramids():
                _report(progress, n_done / n_parts)
                for one in weighted:
                    (one.fit if is_fit else one.add)(transform, gains)
                n_done += 1
        if is_fit:
            for one in weighted:
                one.solve(fits_in_one)


def _depth(n_vertices: int, levels: int) -> int:
    """Return how many levels leave enough vertices."""
    most = int(np.log(max(n_vertices / LEAST_VERTICES, 1.0)) / -np.log(EXPECTED_KEPT))
    return max(min(levels, most), 1)


def _transform(
    mesh: TriangleMesh, levels: int, prediction: str, locked: ArrayLike | None, seed: int
) -> Transform:
    """Return the transform of a random pyramid that knows x and y only."""
    flat = np.column_stack([mesh.vertices[:, :2], np.zeros(mesh.n_vertices)])
    plan = TriangleMesh._trusted(flat, mesh.faces, np.empty((mesh.n_vertices, 0)), ())
    pyramid = analyse(
        plan,
        levels=levels,
        partition="random",
        prediction=prediction,
        update="minimum_norm",
        locked=locked,
        seed=seed,
    )
    return Transform.from_pyramid(pyramid)


def _report(progress: Progress | None, fraction: float) -> None:
    report(progress, fraction, "denoising was cancelled; nothing was kept.")
