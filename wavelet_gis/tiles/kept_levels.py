"""The coarser levels of a piece as plain arrays, until the group that begins with one is made.

A pyramid file is small because most of it follows from its input: a reader makes the steps again,
which takes as long as an analysis. A group needs one level of each of its parts and nobody else
does at that time, so each piece leaves the levels that may be wanted beside its file, and they go
when the stage above is made. They are a shorter way to the same numbers: where they are missing or
damaged, the level is read from the file.
"""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from wavelet_core import Pyramid
from wavelet_core.errors import PyramidError
from wavelet_core.lifting.pyramid import PyramidPart
from wavelet_core.lifting.step import Step
from wavelet_gis.io.atomic import ensure_folder
from wavelet_gis.io.scratch import scratch_folder
from wavelet_gis.tiles.handover import SHARE_HANDED_ON

__all__ = ["KEPT", "drop_levels", "keep_levels", "kept_levels"]

#: Folder of the levels.
KEPT = "levels"

#: Part of the vertices of a piece that the finest level that is kept may have. Rough pieces hand on
#: more than `SHARE_HANDED_ON`, which is what all pieces do together.
SHARE_KEPT = 2.5 * SHARE_HANDED_ON

#: What reading a damaged file raises; an array by itself is no context.
_DAMAGE = (OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, PyramidError)

#: Arrays of a step.
_OF_STEP = tuple(field.name for field in fields(Step))


def keep_levels(folder: str | os.PathLike[str], name: str, checksum: str, pyramid: Pyramid) -> None:
    """Write the levels of a piece that have no more than `SHARE_KEPT` of its vertices.

    Parameters
    ----------
    folder : path
        Of the tile set.
    name : str
        Of the piece.
    checksum : str
        Of its pyramid file.
    pyramid : Pyramid

    Raises
    ------
    OutputFileError, OSError
        They cannot be written.
    """
    sizes = [pyramid.n_vertices(level) for level in range(len(pyramid))]
    finest = int(np.searchsorted(sizes, SHARE_KEPT * sizes[-1], side="right")) - 1
    if finest < 0:
        return
    mesh, ids = pyramid.mesh(finest), pyramid.vertex_ids(finest)
    arrays: dict[str, Any] = {
        "checksum": np.array(checksum),
        "faces": mesh.faces,
        "coarse": pyramid.coarse,
        "channels": np.array(pyramid.channels),
        "signal": np.array(pyramid.signal),
        "update": np.array(pyramid.update),
        "ids": ids.astype(np.int32),
        "integrals": pyramid.integrals(finest),
    }
    if pyramid.horizontal is not None:
        arrays["horizontal"] = mesh.vertices[:, :2]
    if pyramid.locked is not None:
        arrays["locked"] = pyramid.locked[ids]
    for level, step in enumerate(pyramid.steps[:finest]):
        arrays |= {f"{field}_{level}": getattr(step, field) for field in _OF_STEP}
    place = _place(folder, name)
    ensure_folder(place.parent.parent)
    ensure_folder(place.parent)
    with scratch_folder(
        place
    ) as aside:  # neither synced nor read back: what is damaged is not used
        np.savez(aside / place.name, **arrays)
        os.replace(aside / place.name, place)


def kept_levels(
    folder: str | os.PathLike[str], name: str, checksum: str, level: int
) -> Pyramid | None:
    """Return the levels of a piece up to one, or to a finer one; None where they are not kept.

    Parameters
    ----------
    folder, name, checksum
        See `keep_levels`.
    level : int
        The finest that is wanted.
    """
    try:
        with (
            open(_place(folder, name), "rb") as stream,
            np.load(stream, allow_pickle=False) as arrays,
        ):
            if str(arrays["checksum"]) != checksum or (level and f"odd_{level - 1}" not in arrays):
                return None
            n_levels = sum(key.startswith("odd_") for key in arrays)
            steps = [
                Step(*(arrays[f"{field}_{level}"] for field in _OF_STEP))
                for level in range(n_levels)
            ]
            pyramid = Pyramid.from_parts(
                faces=arrays["faces"],
                horizontal=arrays.get("horizontal"),
                coarse=arrays["coarse"],
                steps=steps,
                channels=arrays["channels"].tolist(),
                signal=str(arrays["signal"]),
                update=str(arrays["update"]),
                locked=arrays.get("locked"),
            )
            part = PyramidPart(arrays["ids"], arrays["integrals"])
    except _DAMAGE:
        return None
    n_finest = pyramid.n_vertices(pyramid.n_levels)
    if part.ids.shape != (n_finest,) or part.integrals.shape != (n_finest,):
        return None
    return replace(pyramid, part=part)


def drop_levels(folder: str | os.PathLike[str], stage: int) -> None:
    """Remove the levels of all pieces of a stage, and the folder with those of the last."""
    shutil.rmtree(Path(folder) / KEPT / str(stage), ignore_errors=True)
    with suppress(OSError):
        (Path(folder) / KEPT).rmdir()


def _place(folder: str | os.PathLike[str], name: str) -> Path:
    return Path(folder) / KEPT / f"{name}.npz"
