"""The reversible pyramid: a coarse mesh, and the details of every level above it."""

from __future__ import annotations

import operator
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, IntArray, are_equal, counted, frozen, owned
from ..errors import OptionError, PyramidError
from ..mesh.collapse import even_positions, merge_map, merged_faces
from ..mesh.triangle_mesh import TriangleMesh
from ..partition._level_figures import LevelFigures
from ..partition.stopping import StopRecord
from ..progress import Progress
from ._checks import check_parts
from .signal import SIGNALS
from .step import FilterPair, Step, split_integrals, synthesise_level
from .update import UPDATES, update_filter

if TYPE_CHECKING:
    from ..accuracy.level_errors import LevelErrors
    from .recorded import KeptRecord


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Detail:
    """The detail layer of one step, one row for each vertex that it removed.

    Attributes
    ----------
    vertex_ids : ndarray of int64, shape (n_odd,)
        Ids of the removed vertices in the input mesh.
    positions : ndarray, shape (n_odd, 3)
        x, y, z of the removed vertices on the finer level.
    vectors : ndarray, shape (n_odd, n_channels)
        Detail vectors, in the units of the input.
    magnitude : ndarray, shape (n_odd,)
        Euclidean norm of the vectors.
    """

    vertex_ids: IntArray
    positions: FloatArray
    vectors: FloatArray
    magnitude: FloatArray

    def __eq__(self, other: object) -> bool:
        return are_equal(self, other) if isinstance(other, Detail) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # as for meshes

    def __repr__(self) -> str:
        vertices = counted(len(self.vertex_ids), "vertex", "vertices")
        return f"<Detail {vertices}, {counted(self.vectors.shape[1], 'channel')}>"


class PyramidPart(NamedTuple):
    """What a pyramid that is only the coarse levels of another has from those above it.

    ids : (n,) int32, of its finest level's vertices in the input
    integrals : (n,) float64, of the scaling functions there
    """

    ids: NDArray[np.int32]
    integrals: FloatArray


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Pyramid:
    """A wavelet decomposition of a mesh: level 0 is the coarsest, level ``n_levels`` the input.

    It is a sequence of meshes, the coarsest first: ``pyramid[0]`` is the coarsest,
    ``pyramid[-1]`` the input, and iteration synthesises all of them in one pass.

    Attributes
    ----------
    faces : ndarray of int32, shape (n_faces, 3)
        Faces of the input. Those of all other levels follow from the collapses.
    horizontal : ndarray, shape (n_vertices, 2), or None
        x and y of the input with signal "z", where they do not change; None with "xyz".
    coarse : ndarray, shape (n_coarse, n_channels)
        Scaling coefficients of level 0.
    steps : tuple of Step
        ``steps[level]`` leads from level + 1 to level.
    channels : tuple of str
        Names of the lifted columns.
    signal : {"z", "xyz"}
    update : str
        Update filter.
    locked : ndarray of bool, shape (n_vertices,), or None
    parameters : dict
        Every option of the analysis, resolved.
    stop : StopRecord or None
        Why the analysis ended; None for a pyramid that comes from elsewhere.
    part : PyramidPart or None
        Where its finest level is not the input but a level of a larger pyramid.
    measured : tuple of LevelFigures or None
        Sizes and errors of every level, the coarsest first, where the analysis has measured them.
    kept_record : KeptRecord or None
        The record by which a file describes it to a reader who has its input, where the analysis
        was asked to keep one.
    coarse_faces : ndarray of int32, shape (n_faces, 3), or None
        Faces of level 0 where they are known without following the collapses.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> pyramid = analyse(synthetic.hills(20, 30), levels=3, partition="quadric")
    >>> pyramid
    <Pyramid 3 levels, 600 → 234 vertices, z>
    >>> len(pyramid), pyramid[-1] == pyramid.mesh(3)
    (4, True)
    """

    faces: NDArray[np.int32]
    horizontal: FloatArray | None
    coarse: FloatArray
    steps: tuple[Step, ...]
    channels: tuple[str, ...]
    signal: Literal["z", "xyz"]
    update: str
    locked: NDArray[np.bool_] | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)
    stop: StopRecord | None = field(default=None, compare=False)
    part: PyramidPart | None = field(default=None, compare=False)
    measured: tuple[LevelFigures, ...] | None = field(default=None, compare=False)
    kept_record: KeptRecord | None = field(default=None, compare=False)
    coarse_faces: NDArray[np.int32] | None = field(default=None, compare=False)

    @classmethod
    def from_parts(
        cls,
        *,
        faces: NDArray,
        horizontal: FloatArray | None,
        coarse: FloatArray,
        steps: Sequence[Step],
        channels: Sequence[str],
        signal: str,
        update: str,
        locked: NDArray | None = None,
        parameters: Mapping[str, Any] | None = None,
        stop: StopRecord | None = None,
    ) -> Pyramid:
        """Return the pyramid of parts that nobody has checked yet, such as those of a file.

        Raises
        ------
        PyramidError
            Shapes, index ranges or values that no pyramid can have.
        """
        check_parts(faces, horizontal, coarse, steps, channels, signal, update, locked)
        return cls(
            faces=owned(faces, np.int32),
            horizontal=None if horizontal is None else owned(horizontal, np.float64),
            coarse=owned(coarse, np.float64),
            steps=tuple(step.owned() for step in steps),
            channels=tuple(channels),
            signal=signal,  # type: ignore[arg-type]
            update=update,
            locked=None if locked is None else owned(locked, np.bool_),
            parameters=dict(parameters or {}),
            stop=stop,
        )

    # -- a sequence of meshes ----------------------------------------------------------------------

    def __len__(self) -> int:
        return self.n_levels + 1

    def __getitem__(self, level: SupportsIndex) -> TriangleMesh:
        index = operator.index(level)
        return self.mesh(index + len(self) if -len(self) <= index < 0 else index)

    def __iter__(self) -> Iterator[TriangleMesh]:
        ids = self._ids_by_level(0)
        faces = list(self._faces_downwards())
        for level, coefficients in self._coefficients(ids):
            yield self._assemble(coefficients, ids[level], faces.pop())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Pyramid):
            return NotImplemented
        ours, theirs = self._origin, other._origin
        return (
            are_equal(self, other)
            and np.array_equal(ours.ids, theirs.ids)
            and np.array_equal(ours.integrals, theirs.integrals)
        )

    __hash__ = None  # type: ignore[assignment]  # as for meshes

    def __repr__(self) -> str:
        finest = counted(self.n_vertices(self.n_levels), "vertex", "vertices")
        sizes = f"{self.n_vertices(self.n_levels):,} → {self.n_vertices(0):,} vertices"
        return (
            f"<Pyramid {counted(self.n_levels, 'level')}, {sizes if self.steps else finest}, "
            f"{' + '.join(self.channels)}>"
        )

    @property
    def n_levels(self) -> int:
        """Number of steps L; the levels run from 0 to L."""
        return len(self.steps)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates among the channels, which come first."""
        return SIGNALS[self.signal].coordinates

    @property
    def attribute_names(self) -> tuple[str, ...]:
        """Names of the attributes among the channels."""
        return self.channels[len(self.coordinates) :]

    def columns_of(self, mesh: TriangleMesh) -> FloatArray:
        """Return the values of the channels at the vertices of a mesh, ``(n_vertices, k)``."""
        lifted = mesh.vertices[:, 3 - len(self.coordinates) :]
        return np.hstack([lifted, mesh.attributes])

    def n_vertices(self, level: int) -> int:
        """Return the number of vertices of a level."""
        self._require_level(level)
        return len(self.coarse) + sum(step.n_odd for step in self.steps[:level])

    def n_faces(self, level: int) -> int:
        """Return the number of faces of a level."""
        self._require_level(level)
        return len(self._faces_of(level))

    def vertex_ids(self, level: int) -> IntArray:
        """Return the ids, in the input, of the vertices of a level; ascending."""
        self._require_level(level)
        return self._in_input(self._ids_by_level(level)[level])

    def mesh(self, level: int) -> TriangleMesh:
        """Return the mesh of a level, synthesised from the coarsest one.

        Raises
        ------
        PyramidError
            A level that the pyramid does not have.
        """
        self._require_level(level)
        ids = self._ids_by_level(0)
        by_level = (c for k, c in self._coefficients(ids) if k == level)
        return self._assemble(next(by_level), ids[level], self._faces_of(level))

    def synthesise(self, level: int | None = None) -> TriangleMesh:
        """Return the mesh of a level; by default of the finest, which equals the input."""
        return self.mesh(self.n_levels if level is None else level)

    def finest_on(self, mesh: TriangleMesh) -> TriangleMesh:
        """Return the finest mesh, with the faces of the input, which are not copied.

        Parameters
        ----------
        mesh : TriangleMesh
            The input.
        """
        ids = {} if self.locked is None else self._ids_by_level(0)
        ((_, coefficients),) = deque(self._coefficients(ids), maxlen=1)  # the last one
        return self._assemble(coefficients, slice(None), mesh.faces)

    def detail(self, level: int) -> Detail:
        """Return the detail layer of the step from ``level + 1`` to ``level``."""
        self._require_step(level)
        return next(detail for k, detail in self.details() if k == level)

    def details(self) -> Iterator[tuple[int, Detail]]:
        """Yield ``(level, detail layer)`` from level 0 up, in one synthesis pass."""
        ids = self._ids_by_level(0)
        for finer, coefficients in self._coefficients(ids):
            if finer > 0:
                step = self.steps[finer - 1]
                yield finer - 1, self._detail_layer(step, ids[finer], coefficients)

    def _detail_layer(self, step: Step, ids: NDArray[np.int32], coefficients: FloatArray) -> Detail:
        if self.horizontal is None:
            positions = coefficients[step.odd, :3]
        else:
            plan = self.horizontal[ids[step.odd]]
            positions = np.column_stack([plan, coefficients[step.odd, 0]])
        magnitude = np.linalg.norm(step.details, axis=1)
        return Detail(
            frozen(self._in_input(ids[step.odd])),
            frozen(positions),
            frozen(step.details),
            frozen(magnitude),
        )

    def filters(self, level: int) -> FilterPair:
        """Return the prediction and update filters of the step from ``level + 1`` to ``level``."""
        self._require_step(level)
        integrals = self._integrals_by_level(level + 1)[level + 1]
        return self._filter_pair(level, self._ids_by_level(level), integrals)

    def all_filters(self) -> Iterator[FilterPair]:
        """Yield the filters of every step, that onto level 0 first, in one pass."""
        ids, integrals = self._ids_by_level(0), self._integrals_by_level(0)
        for level in range(self.n_levels):
            yield self._filter_pair(level, ids, integrals[level + 1])

    def _filter_pair(
        self, level: int, ids: dict[int, NDArray[np.int32]], integrals: FloatArray
    ) -> FilterPair:
        step = self.steps[level]
        even = even_positions(step.odd, len(ids[level + 1]))
        prediction = step.prediction(len(even))
        odd_integrals, coarser = split_integrals(integrals, step.odd, even, prediction)
        update = update_filter(
            self.update, prediction, odd_integrals, coarser, self._locked(ids[level])
        )
        return FilterPair(prediction, update, step.odd, even)

    def integrals(self, level: int) -> FloatArray:
        """Return the integrals ζ of the scaling functions of a level (Eq. 47; 1 on the input)."""
        self._require_level(level)
        return self._integrals_by_level(level)[level]

    def with_gains(
        self,
        gains: Mapping[int, float | Sequence[float]],
        coarse: float | Sequence[float] = 1.0,
    ) -> Pyramid:
        """Return the pyramid with the details of each level multiplied.

        Parameters
        ----------
        gains : mapping of int to float or sequence of float
            By level, one number or one for each channel; levels not named keep 1.
        coarse : float or sequence of float
            Gain of the coarsest level's coefficients.

        Raises
        ------
        OptionError
            A level that has no details, or gains that do not fit the channels.

        See Also
        --------
        wavelet_core.band_gains : the gains that keep a band of details.

        Notes
        -----
        Gains of 1 return the same coefficients to the bit. With all gains from level k up at 0
        the result is the mesh of level k interpolated up by the prediction filters (for updates
        other than the one-ring mean, which has a term in the even coefficients).
        """
        for level in gains:
            self.require_details(level)
        factors = {level: self._as_gain(gain, level) for level, gain in gains.items()}
        steps = tuple(
            replace(step, details=frozen(step.details * factors[level]))
            if level in factors
            else step
            for level, step in enumerate(self.steps)
        )
        factor = self._as_gain(coarse, "coarse")
        return self.with_parts(steps=steps, coarse=frozen(self.coarse * factor))

    def require_details(self, level: int, option: str = "gains") -> None:
        """Raise :class:`OptionError` unless there are details at a level.

        Parameters
        ----------
        level : int
        option : str
            The parameter that names it, for the error.
        """
        if level not in range(self.n_levels):
            raise OptionError(
                "there are no details at level {level}; {where}.",
                option,
                level=level,
                where=self._where_details_are(),
            )

    def _as_gain(self, gain: float | Sequence[float], level: int | str) -> FloatArray:
        array = np.asarray(gain, dtype=np.float64)
        if array.shape not in ((), (len(self.channels),)) or not np.isfinite(array).all():
            raise OptionError(
                "the gain of level {level} is {gain}; give a number or one for each of "
                "{n_channels} channels.",
                "coarse" if level == "coarse" else "gains",
                level=level,
                gain=gain,
                n_channels=len(self.channels),
            )
        return array

    # For the user's convenience, two methods that lead on to later packages. Those are built on
    # pyramids, so they are imported when they are called.

    def errors(self, progress: Progress | None = None) -> list[LevelErrors]:
        """Return size and errors of every level, the coarsest first.

        Parameters
        ----------
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.

        See Also
        --------
        wavelet_core.metrics.level_errors : what the figures mean.
        """
        from ..accuracy.level_errors import level_errors

        return level_errors(self, progress)

    def denoised(self, sigma: float | None = None, **options: Any) -> Pyramid:
        """Return the pyramid with thresholded details.

        Parameters
        ----------
        sigma : float, optional
            Standard deviation of the noise; by default estimated from the finest level.
        **options
            ``method``, ``strength``, ``local``, ``by_level``, ``channels``, ``finest`` and
            ``progress`` of
            :func:`wavelet_core.filtering.thresholds.denoised`, which says what they mean.
        """
        from ..filtering.thresholds import denoised

        return denoised(self, sigma, **options)

    def with_parts(self, **changes: Any) -> Pyramid:
        """Return a pyramid of the same topology with other coarse coefficients or steps."""
        return replace(self, **{"measured": None, "kept_record": None, **changes})

    # -- walks through the levels ----------------------------------------------------------------

    def _require_level(self, level: int) -> None:
        if level not in range(self.n_levels + 1):
            raise PyramidError(
                f"there is no level {level}; the levels are 0 to {self.n_levels}.", level
            )

    def _require_step(self, level: int) -> None:
        if level not in range(self.n_levels):
            raise PyramidError(
                f"there are no details at level {level}; {self._where_details_are()}.", level
            )

    def _where_details_are(self) -> str:
        if self.n_levels == 0:
            return "this pyramid has none, since nothing was removed"
        return f"they are at 0 to {self.n_levels - 1}"

    @property
    def _origin(self) -> PyramidPart:
        """Ids and integrals of the finest level; those of an input where it is no part."""
        if self.part is not None:
            return self.part
        n_vertices = self.n_vertices(self.n_levels)
        return PyramidPart(np.arange(n_vertices, dtype=np.int32), np.ones(n_vertices))

    def _in_input(self, ids: NDArray[np.int32]) -> IntArray:
        """Return ids of the input from those of the finest level."""
        return (ids if self.part is None else self.part.ids[ids]).astype(np.int64)

    def _locked(self, ids: NDArray) -> NDArray[np.bool_]:
        if self.locked is None:
            return np.zeros(len(ids), dtype=bool)
        return self.locked[ids]

    def _ids_by_level(self, lowest: int) -> dict[int, NDArray[np.int32]]:
        """Ids in the input of the vertices of each level from the finest down to ``lowest``."""
        current = np.arange(self.n_vertices(self.n_levels), dtype=np.int32)
        ids = {self.n_levels: current}
        for level in range(self.n_levels - 1, lowest - 1, -1):
            current = current[even_positions(self.steps[level].odd, len(current))]
            ids[level] = current
        return ids

    def _faces_downwards(self, lowest: int = 0) -> Iterator[NDArray[np.int32]]:
        """Yield the faces of each level, finest first, down to ``lowest``."""
        faces, n_vertices = self.faces, self.n_vertices(self.n_levels)
        yield faces
        for level in range(self.n_levels - 1, lowest - 1, -1):
            step = self.steps[level]
            faces = merged_faces(faces, merge_map(step.odd, step.target, n_vertices))
            n_vertices -= step.n_odd
            yield faces

    def _faces_of(self, level: int) -> NDArray[np.int32]:
        """Faces of one level, without those between."""
        if level == self.n_levels:
            return self.faces
        if level == 0 and self.coarse_faces is not None:
            return self.coarse_faces
        n_vertices = self.n_vertices(level)
        position = np.arange(n_vertices, dtype=np.int32)
        for step in self.steps[level:]:
            n_vertices += step.n_odd
            position = position[merge_map(step.odd, step.target, n_vertices)]
        return merged_faces(self.faces, position)

    def _integrals_by_level(self, lowest: int) -> dict[int, FloatArray]:
        n_finest = self.n_vertices(self.n_levels)
        integrals = np.ones(n_finest) if self.part is None else self.part.integrals
        by_level = {self.n_levels: integrals}
        for level in range(self.n_levels - 1, lowest - 1, -1):
            step = self.steps[level]
            even = even_positions(step.odd, len(integrals))
            prediction = step.prediction(len(even))
            integrals = split_integrals(integrals, step.odd, even, prediction)[1]
            by_level[level] = integrals
        return by_level

    def _coefficients(
        self, ids: dict[int, NDArray[np.int32]], channels: slice = slice(None)
    ) -> Iterator[tuple[int, FloatArray]]:
        """Scaling coefficients from level 0 up; ids are looked at where vertices are locked."""
        coefficients = self.coarse[:, channels]
        yield 0, coefficients
        integrals = self._integrals_by_level(0) if UPDATES[self.update].uses_integrals else {}
        for level, step in enumerate(self.steps):
            n_fine = len(coefficients) + step.n_odd
            even = even_positions(step.odd, n_fine)
            coefficients = synthesise_level(
                coefficients,
                step.details[:, channels],
                step.odd,
                even,
                step.prediction(len(even)),
                self.update,
                integrals[level + 1] if integrals else np.ones(n_fine),
                np.zeros(n_fine, bool) if self.locked is None else self.locked[ids[level + 1]],
                integrals.pop(level, None),
            )
            yield level + 1, coefficients

    def _assemble(
        self, coefficients: FloatArray, ids: NDArray[np.int32] | slice, faces: NDArray[np.integer]
    ) -> TriangleMesh:
        if self.horizontal is None:
            vertices, attributes = coefficients[:, :3].copy(), coefficients[:, 3:].copy()
        else:
            vertices = np.column_stack([self.horizontal[ids], coefficients[:, 0]])
            attributes = coefficients[:, 1:].copy()
        return TriangleMesh._trusted(vertices, faces, attributes, self.attribute_names)
