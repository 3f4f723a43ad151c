"""What the metadata of a pyramid file say of its steps, checked."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, PyramidError, TriangleMesh
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.partition.stopping import REASONS, StopRecord
from wavelet_core.progress import watched_part
from wavelet_gis._fields import Fields
from wavelet_gis.io.pyramid.array_tables import StoredArrays

__all__ = ["locked_from", "parameters_from", "require_surface", "stop_from"]


def parameters_from(described: Fields) -> dict[str, Any]:
    """Return the parameters; those are checked by which the pyramid is written again."""
    parameters = described.fields("parameters")
    if "outline_tolerance" in parameters and parameters.number("outline_tolerance") < 0:
        raise parameters.fault("a tolerance below 0")
    if "attribute_weights" in parameters:
        weights = parameters["attribute_weights"]
        is_list = isinstance(weights, (list, tuple))
        if not is_list or not all(
            type(weight) in (int, float) and 0 <= weight < 1e300 for weight in weights
        ):
            raise parameters.fault("weights of attributes that are no numbers from 0 up")
    return dict(parameters)


def locked_from(described: Fields, arrays: StoredArrays) -> NDArray[np.bool_] | None:
    """Return which vertices stay at all levels; None where the file names none."""
    if not described.flag("has_locked"):
        return None
    return arrays.get("locked", "|u1", 1).astype(bool)


def stop_from(described: Fields) -> StopRecord | None:
    """Return why the analysis ended; files of before do not say."""
    if described.get("stop") is None:
        return None
    stored = described.fields("stop")
    target = stored["target_vertices"]
    return StopRecord(
        stored.choice("reason", tuple(REASONS)),
        n_vertices=stored.integer("n_vertices"),
        n_locked=stored.integer("n_locked"),
        n_outline=stored.integer("n_outline"),
        n_inner=stored.integer("n_inner"),
        target_vertices=None if target is None else stored.integer("target_vertices"),
    )


def require_surface(mesh: TriangleMesh, progress: Progress | None = None) -> None:
    """Raise unless a mesh of unknown origin is one on which steps can be taken."""
    with watched_part(progress):
        build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    if mesh.n_faces and not mesh.plan_areas.min() > 0:
        raise PyramidError("a face that is flipped or flat in plan; the file is damaged.")
