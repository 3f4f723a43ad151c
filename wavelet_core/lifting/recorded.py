"""Pyramids as what their input leaves open, and from that the pyramids again.

An error-guided pyramid follows from its input and from which collapse was taken when: weights,
details, integrals and coarse coefficients are worked out by the operations of the analysis, in its
order, so they come out to the bit. Which collapses those were takes few symbols, see
`wavelet_core.partition.questions`.

So that coarse levels are had without the input, a large pyramid is recorded in parts: each begins
at a level that is stored for itself, with what the steps below need of those above.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._threads import centre_of
from .._validate import FloatArray, frozen
from ..errors import PyramidError
from ..mesh.triangle_mesh import TriangleMesh
from ..partition._mutable_level import HEIGHT_STEP, CollapseStep, SurfaceLevel
from ..partition.questions import Answers, Collapses, Writer, ask
from ..partition.recorded import Manner, RecordedLevel, Start, record, replay, takes
from ..partition.stopping import StopRecord
from ..progress import Progress, report
from ..progress import part_of as part_of_progress
from .pyramid import Pyramid, PyramidPart
from .signal import Normalisation
from .step import Step

__all__ = [
    "Frame",
    "KeptRecord",
    "Record",
    "RecordPart",
    "Recorder",
    "is_error_guided",
    "kept_record_of",
    "part_of",
    "pyramid_of",
    "record_of",
]

#: A part begins at the first level with no more than this share of the vertices that the part
#: before begins with: it takes some 130 bits a vertex of its own, so one or two for each of all.
PART_SHARE = 1 / 64
#: The coarsest level is a part of its own, without steps, with no more than this share: what the
#: default rule leaves of terrain, 2 to 3 %, is had without working through all that lies above.
COARSEST_SHARE = 1 / 32
#: Pyramids of fewer vertices are in one part: they are read in a few seconds.
LEAST_IN_PARTS = 3_000_000
#: No part begins with fewer.
LEAST_IN_PART = 1000


class Frame(NamedTuple):
    """Local origins and weights of the columns, from the input.

    centre : (2,) float64, of x and y
    z_origin : (c,) float64, of the weighted columns
    weights : (c,) float64
    height_step : float, see `wavelet_core.partition.recorded.Manner`
    """

    centre: FloatArray
    z_origin: FloatArray
    weights: FloatArray
    height_step: float


class RecordPart(NamedTuple):
    """The steps from one level down to another, and that level unless it is the input.

    answers : Answers
    ids : (n,) int32, the level's vertices in the input; None for the input
    faces : (m, 3) int32, of the level
    heights, integrals : (n, c), (n,) float64, local and weighted; empty without update
    unchanged : (k, c) float64, the input's columns at the vertices that no update changes
    """

    answers: Answers
    ids: NDArray[np.int32] | None = None
    faces: NDArray[np.int32] | None = None
    heights: FloatArray | None = None
    integrals: FloatArray | None = None
    unchanged: FloatArray | None = None


class Record(NamedTuple):
    """A pyramid without its input: frame, and the parts from the finest on."""

    frame: Frame
    parts: tuple[RecordPart, ...]


class KeptRecord(NamedTuple):
    """A record that was taken during the analysis, and what it was taken of.

    record : Record
    steps, coarse : of the pyramid; it describes no other
    columns : bytes, digest of the input's z and attributes
    """

    record: Record
    steps: tuple[Step, ...]
    coarse: FloatArray
    columns: bytes

    def fits(self, pyramid: Pyramid, mesh: TriangleMesh) -> bool:
        """Whether it describes that pyramid to a reader who has that input."""
        is_of_it = self.steps is pyramid.steps and self.coarse is pyramid.coarse
        return is_of_it and self.columns == _digest(_columns(mesh))


class Recorder:
    """Takes the record of a pyramid during its analysis, while the state of each level is at hand.

    The first part is recorded from what the analysis itself works on; later ones, which begin with
    few vertices, by a level beside it that begins as that of a reader does.

    Parameters
    ----------
    mesh : TriangleMesh
        The input.
    locked : (n,) bool
    update : str
    parameters : mapping
        Of the pyramid that will be.
    """

    def __init__(
        self,
        mesh: TriangleMesh,
        locked: NDArray[np.bool_],
        update: str,
        parameters: Mapping[str, Any],
    ) -> None:
        self._mesh, self._locked = mesh, locked
        self._frame = frame_of(mesh, parameters["attribute_weights"])
        self._manner = _manner_of(update, parameters, self._frame)
        self._parts: list[RecordPart] = []
        self._writer, self._begun = Writer(), dict[str, Any]()
        self._size = mesh.n_vertices
        self._level: RecordedLevel | None = None
        self._next: dict[str, Any] | None = None  # a part that begins at the present level
        self._here: SurfaceLevel | None = None
        self._n_asked = 0
        self._failed = False

    def look(self, level: SurfaceLevel, collapses: Collapses) -> None:
        """Answer the questions about collapses that are about to be taken on a level."""
        if self._failed or self._level is not None or self._next is not None:
            return
        self._n_asked = len(collapses.odd)
        try:
            ask(self._writer, level.sight(), collapses)
        except PyramidError:
            self._failed = True

    def took(self, level: SurfaceLevel, step: CollapseStep) -> None:
        """Keep a step, in input units, that ended at a level."""
        if self._failed:
            return
        if self._next is not None:
            self._begin_part(self._next)
            self._next = None
        if self._level is None:
            self._failed = len(step.odd) != self._n_asked  # the link condition forbade some
        else:
            self._failed = not takes(self._level, self._writer, step, self._frame.weights)
        self._here = level
        if self._begins_part(PART_SHARE):
            self._begin_next(level)

    def _begins_part(self, share: float) -> bool:
        if self._here is None:
            return False
        n_vertices, n_input = self._here.n_vertices, self._mesh.n_vertices
        return _begins_part(n_vertices, self._size, n_input, self._manner, share)

    def _begin_next(self, level: SurfaceLevel) -> None:
        self._next = _begin(level, level.ids, _columns(self._mesh), self._locked, self._manner)

    def _begin_part(self, begun: dict[str, Any]) -> None:
        self._parts.append(RecordPart(self._writer.answers(), **self._begun))
        self._writer, self._begun, self._size = Writer(), begun, len(begun["ids"])
        plan, locked = self._mesh.vertices[begun["ids"], :2], self._locked[begun["ids"]]
        start = _part_start(begun, plan, locked, self._frame, self._manner)
        self._level = RecordedLevel(start, self._manner)

    def kept(self, steps: tuple[Step, ...], coarse: FloatArray) -> KeptRecord | None:
        """Return the record of a pyramid whose steps were kept; None where none describes it."""
        if self._failed or not steps:
            return None
        if self._next is None and self._here is not None and self._begins_part(COARSEST_SHARE):
            self._begin_next(self._here)
        if self._next is not None:
            self._begin_part(self._next)
            self._next = None
        self._here = None
        parts = (*self._parts, RecordPart(self._writer.answers(), **self._begun))
        return KeptRecord(Record(self._frame, parts), steps, coarse, _digest(_columns(self._mesh)))


def frame_of(mesh: TriangleMesh, attribute_weights: Sequence[float]) -> Frame:
    """Return the frame in which the levels of a mesh's pyramid are worked on."""
    plan = mesh.vertices[:, :2]
    weights = Normalisation(mesh, attribute_weights).height_weights()
    heights = _columns(mesh) * weights
    return Frame(
        centre_of(plan)[0],
        centre_of(heights)[0],
        weights,
        HEIGHT_STEP * float(np.abs(heights).max()),
    )


def record_of(
    pyramid: Pyramid, mesh: TriangleMesh, progress: Progress | None = None
) -> Record | None:
    """Return the record of a pyramid for a reader who has its input; None where it is not exact.

    Parameters
    ----------
    pyramid : Pyramid
        Of any design; those that are not error-guided have no record.
    mesh : TriangleMesh
        Its input, to the bit.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    kept = kept_record_of(pyramid, mesh)
    if kept is not None:
        return kept
    if not _may_be_recorded(pyramid, mesh) or not np.array_equal(pyramid.faces, mesh.faces):
        return None
    frame = frame_of(mesh, pyramid.parameters["attribute_weights"])
    manner = _manner(pyramid, frame)
    columns = _columns(mesh)
    locked = _locked(pyramid, mesh.n_vertices)
    ids = np.arange(mesh.n_vertices, dtype=np.int32)
    level = RecordedLevel(_input_start(mesh, frame, locked), manner)
    parts: list[RecordPart] = []
    begun: dict[str, Any] = {}
    bounds = _part_bounds(pyramid, manner)
    for first, last in zip(bounds, (*bounds[1:], 0), strict=True):
        if first < pyramid.n_levels:
            ids = ids[level.ids]
            begun = _begin(level, ids, columns, locked, manner)
            start = _part_start(begun, mesh.vertices[ids, :2], locked[ids], frame, manner)
            level = RecordedLevel(start, manner)
        steps = pyramid.steps[last:first][::-1]
        answers = record(
            level,
            [_collapse_step(step) for step in steps],
            frame.weights,
            part_of_progress(progress, 1 - first / pyramid.n_levels, 1 - last / pyramid.n_levels),
        )
        if answers is None:
            return None
        parts.append(RecordPart(answers, **begun))
        report(progress, 1 - last / pyramid.n_levels, _CANCELLED)
    coarse = _coarse(level, frame, columns[ids[level.ids]], locked[ids[level.ids]], manner)
    return Record(frame, tuple(parts)) if np.array_equal(coarse, pyramid.coarse) else None


def kept_record_of(pyramid: Pyramid, mesh: TriangleMesh) -> Record | None:
    """Return the record that the analysis has kept of a pyramid; None where it has kept none.

    Parameters
    ----------
    pyramid : Pyramid
    mesh : TriangleMesh
        Its input, to the bit; its faces are not looked at.
    """
    kept = pyramid.kept_record
    if kept is None or not _may_be_recorded(pyramid, mesh) or not kept.fits(pyramid, mesh):
        return None
    return kept.record


def _may_be_recorded(pyramid: Pyramid, mesh: TriangleMesh) -> bool:
    if not is_error_guided(pyramid) or pyramid.n_levels == 0 or pyramid.part is not None:
        return False
    horizontal = pyramid.horizontal
    return horizontal is not None and np.array_equal(horizontal, mesh.vertices[:, :2])


def pyramid_of(
    record: Record,
    mesh: TriangleMesh,
    *,
    channels: Sequence[str],
    update: str,
    locked: NDArray[np.bool_] | None,
    parameters: Mapping[str, Any],
    stop: StopRecord | None,
    progress: Progress | None = None,
) -> Pyramid:
    """Return the pyramid that a record describes.

    Parameters
    ----------
    record : Record
        Of any origin; its frame is not looked at.
    mesh : TriangleMesh
        The input.
    channels, update, locked, parameters, stop
        Of the pyramid.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        The record describes no pyramid of this mesh.
    """
    frame = frame_of(mesh, parameters["attribute_weights"])
    manner = _manner_of(update, parameters, frame)
    is_locked = np.zeros(mesh.n_vertices, dtype=bool) if locked is None else locked
    ids = np.arange(mesh.n_vertices, dtype=np.int32)
    level = RecordedLevel(_input_start(mesh, frame, is_locked), manner)
    steps: list[CollapseStep] = []
    columns = _columns(mesh)
    for part in record.parts:
        if part.ids is not None:
            ids = ids[level.ids]
            _require(np.array_equal(ids, part.ids), "a part that begins at no level")
            level = RecordedLevel(_start_of(part, mesh, is_locked, frame, manner), manner)
        done = 1.0 - level.n_vertices / mesh.n_vertices
        steps.extend(replay(level, part.answers, part_of_progress(progress, done, 1.0)))
    ids = ids[level.ids]
    return Pyramid(
        faces=frozen(mesh.faces.astype(np.int32)),
        horizontal=frozen(mesh.vertices[:, :2]),
        coarse=frozen(_coarse(level, frame, columns[ids], is_locked[ids], manner)),
        coarse_faces=frozen(level.faces),
        steps=tuple(_step(step, frame) for step in reversed(steps)),
        channels=tuple(channels),
        signal="z",
        update=update,
        locked=None if locked is None else frozen(locked),
        parameters=dict(parameters),
        stop=stop,
    )


def part_of(
    record: Record,
    index: int,
    plan: FloatArray,
    *,
    channels: Sequence[str],
    update: str,
    locked: NDArray[np.bool_] | None,
    parameters: Mapping[str, Any],
    progress: Progress | None = None,
) -> Pyramid:
    """Return the levels of a pyramid from the beginning of one of its parts down.

    Parameters
    ----------
    record : Record
        With all parts from ``index`` on.
    index : int
        Not 0, for which the input is needed.
    plan : (n, 2) float64
        x and y of the part's vertices.
    channels, update, parameters
        Of the pyramid.
    locked : (n,) bool, or None
        Of the part's vertices.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        The record describes no levels on these vertices.
    """
    part, frame = record.parts[index], record.frame
    assert part.ids is not None
    assert part.faces is not None
    manner = _manner_of(update, parameters, frame)
    is_locked = np.zeros(len(plan), dtype=bool) if locked is None else locked
    begun = part._asdict()
    level = RecordedLevel(_part_start(begun, plan, is_locked, frame, manner), manner)
    integrals = level.integrals
    unchanged = np.zeros((len(plan), len(channels)))
    _require(part.unchanged is not None, "no columns of the vertices that stay as they were")
    unchanged[_unchanged(is_locked, manner)] = part.unchanged
    ids = np.arange(len(plan), dtype=np.int32)
    steps: list[CollapseStep] = []
    for below in record.parts[index:]:
        if below is not part:
            ids = ids[level.ids]
            of_below = below._asdict()
            begins = below.ids if below.ids is not None else np.empty(0, np.int32)
            _require(np.array_equal(part.ids[ids], begins), "a part that begins at no level")
            start = _part_start(of_below, plan[ids], is_locked[ids], frame, manner)
            level = RecordedLevel(start, manner)
        done = 1.0 - level.n_vertices / len(plan)
        steps.extend(replay(level, below.answers, part_of_progress(progress, done, 1.0)))
    ids = ids[level.ids]
    return Pyramid(
        faces=frozen(part.faces),
        horizontal=frozen(plan),
        coarse=frozen(_coarse(level, frame, unchanged[ids], is_locked[ids], manner)),
        coarse_faces=frozen(level.faces),
        steps=tuple(_step(step, frame) for step in reversed(steps)),
        channels=tuple(channels),
        signal="z",
        update=update,
        locked=None if locked is None else frozen(locked),
        parameters=dict(parameters),
        part=PyramidPart(frozen(part.ids), frozen(integrals)),
    )


_CANCELLED = "writing the pyramid was cancelled; nothing was kept."


def is_error_guided(pyramid: Pyramid) -> bool:
    """Whether a pyramid's collapses are those of an error-guided analysis, whatever its heights."""
    parameters = pyramid.parameters
    names = ("partition", "prediction", "signal")
    return (
        tuple(parameters.get(name) for name in names) == ("surface", "barycentric", "z")
        and pyramid.signal == "z"
        and pyramid.update == parameters.get("update")
        and pyramid.update in ("minimum_norm", "none")
        and "attribute_weights" in parameters
        and "outline_tolerance" in parameters
    )


def _manner(pyramid: Pyramid, frame: Frame) -> Manner:
    return _manner_of(pyramid.update, pyramid.parameters, frame)


def _manner_of(update: str, parameters: Mapping[str, Any], frame: Frame) -> Manner:
    return Manner(
        update == "minimum_norm", float(parameters["outline_tolerance"]), frame.height_step
    )


def _columns(mesh: TriangleMesh) -> FloatArray:
    return np.ascontiguousarray(np.hstack([mesh.vertices[:, 2:], mesh.attributes]))


def _locked(pyramid: Pyramid, n_vertices: int) -> NDArray[np.bool_]:
    return np.zeros(n_vertices, dtype=bool) if pyramid.locked is None else pyramid.locked


def _input_start(mesh: TriangleMesh, frame: Frame, locked: NDArray[np.bool_]) -> Start:
    return Start(
        mesh.vertices[:, :2] - frame.centre,
        _columns(mesh) * frame.weights - frame.z_origin,
        np.ones(mesh.n_vertices),
        mesh.faces.astype(np.int32),
        locked,
    )


def _unchanged(locked: NDArray[np.bool_], manner: Manner) -> NDArray[np.bool_]:
    return locked if manner.with_update else np.ones(len(locked), dtype=bool)


def _begin(
    level: SurfaceLevel,
    ids: NDArray[np.int32],
    columns: FloatArray,
    locked: NDArray[np.bool_],
    manner: Manner,
) -> dict[str, Any]:
    """Return what the part that begins at a level must know of it."""
    stored = slice(None) if manner.with_update else slice(0)
    return {
        "ids": ids,
        "faces": level.faces,
        "heights": level.local_heights[stored],
        "integrals": level.integrals[stored],
        "unchanged": columns[ids[_unchanged(locked[ids], manner)]],
    }


def _part_start(
    begun: Mapping[str, Any],
    plan: FloatArray,
    locked: NDArray[np.bool_],
    frame: Frame,
    manner: Manner,
) -> Start:
    n, n_channels = len(plan), len(frame.weights)
    heights, integrals = begun["heights"], begun["integrals"]
    if not manner.with_update:
        _require(begun["unchanged"].shape == (n, n_channels), "columns of another length")
        heights = begun["unchanged"] * frame.weights - frame.z_origin
        integrals = np.ones(n)
    is_sound = heights.shape == (n, n_channels) and integrals.shape == (n,)
    _require(is_sound, "heights or integrals of another length")
    return Start(plan - frame.centre, heights, integrals, begun["faces"], locked)


def _start_of(
    part: RecordPart,
    mesh: TriangleMesh,
    locked: NDArray[np.bool_],
    frame: Frame,
    manner: Manner,
) -> Start:
    assert part.ids is not None
    plan = mesh.vertices[part.ids, :2]
    return _part_start(part._asdict(), plan, locked[part.ids], frame, manner)


def _part_bounds(pyramid: Pyramid, manner: Manner) -> tuple[int, ...]:
    """Return the levels at which parts begin, the finest first."""
    bounds = [pyramid.n_levels]
    n_input = size = pyramid.n_vertices(pyramid.n_levels)
    for level in range(pyramid.n_levels - 1, -1, -1):
        n_vertices = pyramid.n_vertices(level)
        share = PART_SHARE if level > 0 else COARSEST_SHARE
        if _begins_part(n_vertices, size, n_input, manner, share):
            bounds.append(level)
            size = n_vertices
    return tuple(bounds)


def _begins_part(n_vertices: int, size: int, n_input: int, manner: Manner, share: float) -> bool:
    """Whether a part begins at a level, the one before having begun with ``size`` vertices."""
    if n_input < LEAST_IN_PARTS or manner.outline_tolerance:
        return False  # a tolerance is measured from the outline of the input
    return LEAST_IN_PART <= n_vertices <= size * share


def _digest(columns: FloatArray) -> bytes:
    return hashlib.sha256((columns + 0.0).data).digest()  # 0 and -0 alike


def _collapse_step(step: Step) -> CollapseStep:
    return CollapseStep(
        step.odd, step.target, step.indptr, step.indices, step.weights, step.details
    )


def _step(step: CollapseStep, frame: Frame) -> Step:
    return Step(*step._replace(details=frozen(step.details / frame.weights)))


def _coarse(
    level: RecordedLevel,
    frame: Frame,
    columns: FloatArray,
    locked: NDArray[np.bool_],
    manner: Manner,
) -> FloatArray:
    """Return the coefficients of the coarsest level, in input units."""
    coarse = (level.local_heights + frame.z_origin) / frame.weights
    unchanged = _unchanged(locked, manner)
    coarse[unchanged] = columns[unchanged]
    return coarse


def _require(holds: bool, fault: str) -> None:
    if not holds:
        raise PyramidError(f"the pyramid has {fault}; the file is damaged, analyse the input anew.")
