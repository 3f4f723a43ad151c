"""The record of a pyramid as JSON and plain arrays, and the record again.

What `wavelet_core.lifting.recorded` records of a pyramid goes into the arrays
``parts/K/going`` (bits), ``parts/K/targets`` (two to a byte) and, for every part but the first,
``parts/K/ids``, ``faces``, ``heights``, ``integrals`` and ``unchanged``; the faces of points into
``faces/answers``, ``far`` and ``holes``. See docs/reference/format.md.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core._kernels.forecast import NO_FORECAST
from wavelet_core.errors import PyramidError
from wavelet_core.lifting.recorded import Frame, Record, RecordPart
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.partition.questions import (
    N_GOING_CLASSES,
    N_LEAD_CLASSES,
    N_TARGET_CLASSES,
    Answers,
)
from wavelet_gis._fields import Fields
from wavelet_gis.io.pyramid.codecs.face_codec import (
    N_EDGE_CLASSES,
    FaceRecord,
    decode_faces,
    encode_faces,
)

__all__ = [
    "ArraySource",
    "asks_by_odds",
    "codes_per_level",
    "faces_from_parts",
    "faces_to_parts",
    "n_parts",
    "record_from_parts",
    "record_to_parts",
]

#: Places of targets from here on go into an array of their own.
BEYOND = 15

#: Parts of one record: each has at most a 64th of the vertices of the one before.
_MOST_PARTS = 8

_MOST_STEPS = 1000

#: Codes of each level: without and with that of the integrals.
CODES_PER_LEVEL = 2, 3
_WIDTH = "codes_per_level"

#: The arrays of a part that begins at a stored level.
_STORED = {
    "ids": ("<i4", 1),
    "faces": ("<i4", 2),
    "heights": ("<f8", 2),
    "integrals": ("<f8", 1),
    "unchanged": ("<f8", 2),
}


class ArraySource(Protocol):
    """Gives arrays by name, type and number of dimensions."""

    def get(
        self, name: str, dtype: str | None = None, n_dimensions: int | None = None
    ) -> NDArray[Any]:
        """Return an array."""


def record_to_parts(record: Record) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return JSON-able fields, and arrays by name."""
    frame = record.frame
    fields: dict[str, Any] = {
        "centre": frame.centre.tolist(),
        "z_origin": frame.z_origin.tolist(),
        "weights": frame.weights.tolist(),
        "height_step": frame.height_step,
        "parts": [],
    }
    arrays: dict[str, NDArray[Any]] = {}
    for k, part in enumerate(record.parts):
        answers, name = part.answers, f"parts/{k}"
        going, targets = np.concatenate(answers.going), np.concatenate(answers.targets)
        arrays[f"{name}/going"] = np.packbits(going)
        arrays[f"{name}/targets"] = _packed(np.minimum(targets, BEYOND).astype(np.uint8))
        arrays[f"{name}/beyond"] = targets[targets >= BEYOND]
        if part.ids is not None:
            for array in _STORED:
                arrays[f"{name}/{array}"] = getattr(part, array)
        fields["parts"].append(
            {
                "levels": answers.levels.ravel().tolist(),
                _WIDTH: answers.levels.shape[1],
                "going": [len(of_class) for of_class in answers.going],
                "targets": [len(of_class) for of_class in answers.targets],
            }
        )
    return fields, arrays


def asks_by_odds(fields: dict[str, Any]) -> bool:
    """Return whether a record is one that no reader before format 4 knows."""
    return any(part[_WIDTH] != CODES_PER_LEVEL[0] for part in fields["parts"])


def faces_to_parts(
    places: NDArray[np.int64] | None,
    faces: NDArray[np.integer],
    progress: Progress | None = None,
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return fields and arrays that hold the faces of points; see `face_codec`.

    Parameters
    ----------
    places : (n, 2) int64, or None
        Of the points, as stored.
    faces : (m, 3) integers
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    record = None if places is None else encode_faces(places, faces, progress)
    if record is None:
        return {}, {"faces": faces}
    arrays: dict[str, NDArray[Any]] = {
        "faces/answers": np.packbits(np.concatenate(record.answers)),
        "faces/far": record.far,
        "faces/holes": record.holes,
    }
    return {"faces": [len(answers) for answers in record.answers]}, arrays


def faces_from_parts(
    fields: Fields,
    arrays: ArraySource,
    places: NDArray[np.int64] | None,
    progress: Progress | None = None,
) -> NDArray[Any]:
    """Return the faces that `faces_to_parts` stored, ``(m, 3)``.

    Parameters
    ----------
    fields : Fields
        Of unknown origin.
    arrays : ArraySource
    places : (n, 2) int64, or None
        Of the points, as stored.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        When a part is missing or does not fit the rest.
    """
    if "faces" not in fields:
        faces = arrays.get("faces", "<i4", 2)
        if faces.shape[1] != 3:
            raise PyramidError(f"faces of shape {faces.shape}; the file is damaged.")
        return faces
    counts = fields.integers("faces")
    packed, far = arrays.get("faces/answers", "|u1", 1), arrays.get("faces/far", "<i4", 2)
    is_sound = (
        len(counts) == N_EDGE_CLASSES
        and len(packed) == -(-sum(counts) // 8)
        and far.shape[1] == 2
        and places is not None
    )
    if not is_sound or places is None:
        raise fields.fault("faces that do not fit the points")
    bits = np.unpackbits(packed, count=sum(counts))
    answers = tuple(np.split(bits, np.cumsum(counts)[:-1]))
    record = FaceRecord(answers, far, arrays.get("faces/holes", "<i8", 1))
    return decode_faces(places, record, progress)


def n_parts(fields: Fields) -> int:
    """Return in how many parts a record is.

    Raises
    ------
    PyramidError
        More than any has, or none.
    """
    count = len(fields.objects("parts"))
    if not 1 <= count <= _MOST_PARTS:
        raise fields.fault(f"{count} parts")
    return count


def codes_per_level(described: Fields) -> int:
    """Return how many codes the levels of a part have; files before format 4 do not say.

    Raises
    ------
    PyramidError
        A number of which no record is.
    """
    fewest, most = CODES_PER_LEVEL
    if _WIDTH not in described:
        return fewest
    return described.integer(_WIDTH, fewest, most)


def record_from_parts(
    fields: Fields, arrays: ArraySource, n_channels: int, first: int = 0
) -> Record:
    """Return the record that `record_to_parts` described, every claim checked.

    Parameters
    ----------
    fields : Fields
        Of unknown origin.
    arrays : ArraySource
    n_channels : int
        Of the pyramid.
    first : int
        The first part that is wanted; those before are empty.

    Raises
    ------
    PyramidError
        When a part is missing or does not fit the rest.
    """
    parts = []
    n_parts(fields)
    for k, described in enumerate(fields.objects("parts")):
        if k < first:
            parts.append(RecordPart(_NO_ANSWERS))
            continue
        answers = _answers(described, arrays, f"parts/{k}")
        stored = {}
        if k > 0:
            stored = {
                name: arrays.get(f"parts/{k}/{name}", *kind) for name, kind in _STORED.items()
            }
            _check_level(stored, k)
        parts.append(RecordPart(answers, **stored))
    weights = np.array(fields.numbers("weights", n_channels))
    if not (weights > 0).all():
        raise fields.fault("a weight that is not above 0")
    return Record(
        Frame(
            np.array(fields.numbers("centre", 2)),
            np.array(fields.numbers("z_origin", n_channels)),
            weights,
            fields.number("height_step"),
        ),
        tuple(parts),
    )


_NO_ANSWERS = Answers(np.empty((0, 2), dtype=np.uint16), (), ())


def _answers(described: Fields, arrays: ArraySource, name: str) -> Answers:
    codes = described.integers("levels", 0, NO_FORECAST)
    n_codes = codes_per_level(described)
    n_going = described.integers("going")
    n_targets = described.integers("targets")
    if len(codes) % n_codes or len(codes) > n_codes * _MOST_STEPS:
        raise described.fault("levels of no pyramid")
    n_classes = N_TARGET_CLASSES if n_codes == CODES_PER_LEVEL[1] else N_LEAD_CLASSES
    if len(n_going) != N_GOING_CLASSES or len(n_targets) != n_classes:
        raise described.fault("classes of no pyramid")
    going = arrays.get(f"{name}/going", "|u1", 1)
    targets = arrays.get(f"{name}/targets", "|u1", 1)
    if len(going) != -(-sum(n_going) // 8) or len(targets) != -(-sum(n_targets) // 2):
        raise described.fault("numbers of answers that are others than there are")
    bits = np.unpackbits(going, count=sum(n_going))
    places = _unpacked(targets, sum(n_targets))
    is_beyond = places == BEYOND
    beyond = arrays.get(f"{name}/beyond", "|u1", 1)
    if len(beyond) != np.count_nonzero(is_beyond):
        raise described.fault("targets beyond the others that do not fit")
    places[is_beyond] = beyond
    return Answers(
        np.array(codes, dtype=np.uint16).reshape(-1, n_codes),
        tuple(np.split(bits, np.cumsum(n_going)[:-1])),
        tuple(np.split(places, np.cumsum(n_targets)[:-1])),
    )


def _check_level(stored: dict[str, NDArray[Any]], k: int) -> None:
    """Raise unless a stored level is a surface on vertices of the input."""
    ids, faces = stored["ids"], stored["faces"]
    n = len(ids)
    is_sound = (
        n > 0
        and ids[0] >= 0
        and bool((np.diff(ids) > 0).all())
        and faces.shape[1] == 3
        and (faces.size == 0 or bool(faces.min() >= 0 and faces.max() < n))
        and all(
            bool(np.isfinite(stored[name]).all()) for name in ("heights", "integrals", "unchanged")
        )
    )
    if not is_sound:
        raise PyramidError(f"the level at which part {k} begins is none; the file is damaged.")
    build_connectivity(faces, n)  # refuses what is no manifold


def _packed(nibbles: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return numbers below 16 two to a byte, the first in the upper half."""
    padded = np.append(nibbles, np.zeros(len(nibbles) % 2, dtype=np.uint8))
    return (padded[::2] << np.uint8(4)) | padded[1::2]


def _unpacked(packed: NDArray[np.uint8], count: int) -> NDArray[np.uint8]:
    nibbles = np.column_stack([packed >> np.uint8(4), packed & np.uint8(15)]).ravel()
    return nibbles[:count].copy()
