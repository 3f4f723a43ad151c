"""Several point clouds of one kind as one, as if it had been read from one file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import InputFileError
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.notes import note

__all__ = ["merged_cloud"]

_LARGEST = np.iinfo(np.int32).max


def merged_cloud(names: Sequence[str], clouds: Sequence[PointCloud]) -> PointCloud:
    """Return the points of several clouds as one, in the order of the files.

    Parameters
    ----------
    names : sequence of str
        Of the files, for messages.
    clouds : sequence of PointCloud
        Read with the same options. Points of which another file has the very same record, as files
        that overlap do, are there once.

    Raises
    ------
    InputFileError
        Records of another kind, scales that differ, or coordinates that do not fit one file.
    """
    first = clouds[0]
    for name, cloud in zip(names[1:], clouds[1:], strict=True):
        _require_alike(names[0], first, name, cloud)
    offsets = first.offsets
    integers = [
        _moved(names[0], first, name, cloud) for name, cloud in zip(names, clouds, strict=True)
    ]
    attributes = tuple(
        replace(attribute, values=np.concatenate([c.attributes[k].values for c in clouds]))
        for k, attribute in enumerate(first.attributes)
    )
    carried = {
        name: np.concatenate([cloud.carried[name] for cloud in clouds]) for name in first.carried
    }
    aside = None
    if any(cloud.aside is not None for cloud in clouds):
        aside = np.concatenate(
            [
                np.zeros(cloud.n_points, dtype=bool) if cloud.aside is None else cloud.aside
                for cloud in clouds
            ]
        )
    whole = replace(
        first,
        integers=np.concatenate(integers),
        offsets=offsets,
        attributes=attributes,
        carried=carried,
        aside=aside,
        n_in_file=sum(cloud.n_in_file for cloud in clouds),
        is_altered=True,  # the header is the first file's, its counts and bounds are not
    )
    file_of_point = np.repeat(np.arange(len(clouds)), [cloud.n_points for cloud in clouds])
    again = _in_an_earlier_file(whole, file_of_point)
    n_again = int(np.count_nonzero(again))
    note(
        "merged_cloud",
        "{name} and {n_others} more: {n_points} points as one cloud{repeated}",
        name=names[0],
        n_others=len(names) - 1,
        n_points=f"{whole.n_points - n_again:,}",
        repeated=f"; {n_again:,} that two files have were taken once" if n_again else "",
    )
    if not n_again:
        return whole
    kept = whole.subset(np.flatnonzero(~again))
    return replace(
        kept,
        aside=None if aside is None else aside[~again],
        n_in_file=whole.n_in_file - n_again,
    )


def _require_alike(name: str, first: PointCloud, other_name: str, other: PointCloud) -> None:
    def fields(cloud: PointCloud) -> list[tuple[str, str, tuple[int, ...]]]:
        lifted = [(a.name, a.values.dtype.str, (), a.scale, a.offset) for a in cloud.attributes]
        carried = [(k, v.dtype.str, v.shape[1:], 1.0, 0.0) for k, v in cloud.carried.items()]
        return [*lifted, *carried]  # type: ignore[list-item]

    if fields(first) != fields(other):
        raise InputFileError(
            f"{other_name}: its points have other dimensions than those of {name}; bring them to "
            "one point format first (pdal translate)."
        )
    if not np.array_equal(first.scales, other.scales):
        raise InputFileError(
            f"{other_name}: its coordinates are stored in steps of "
            f"{', '.join(f'{s:g}' for s in other.scales)}, those of {name} in "
            f"{', '.join(f'{s:g}' for s in first.scales)}; bring them to one scale first "
            "(pdal translate --writers.las.scale_x and so on)."
        )


def _moved(name: str, first: PointCloud, other_name: str, cloud: PointCloud) -> NDArray[np.int32]:
    """Return the stored coordinates of a cloud with the offsets of the first."""
    shift = (cloud.offsets - first.offsets) / first.scales
    whole = np.rint(shift)
    if np.abs(shift - whole).max() > 1e-4:
        raise InputFileError(
            f"{other_name}: its coordinates lie between the steps of those of {name} (the offsets "
            "in the headers differ by parts of a step); bring them to one offset first "
            "(pdal translate --writers.las.offset_x and so on)."
        )
    moved = cloud.integers.astype(np.int64) + whole.astype(np.int64)
    if np.abs(moved).max() > _LARGEST:
        raise InputFileError(
            f"{other_name}: it lies too far from {name} for one file in steps of "
            f"{first.scales.max():g}; give files that are nearer to one another."
        )
    return moved.astype(np.int32)


def _in_an_earlier_file(cloud: PointCloud, file_of_point: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which points have the very record of a point of an earlier file."""
    place = [cloud.integers[:, k] for k in (2, 1, 0)]
    order = np.lexsort(place)
    sorted_places = cloud.integers[order]
    same = (sorted_places[1:] == sorted_places[:-1]).all(axis=1)
    again = np.zeros(cloud.n_points, dtype=bool)
    if not same.any():
        return again
    starts = np.flatnonzero(np.concatenate([[True], ~same]))
    ends = np.append(starts[1:], len(order))
    several = ends - starts > 1
    columns: list[NDArray[Any]] = [*(a.values for a in cloud.attributes), *cloud.carried.values()]
    for start, end in zip(starts[several], ends[several], strict=True):
        rows = order[start:end]  # ascending: the sort is stable
        if file_of_point[rows[0]] == file_of_point[rows[-1]]:
            continue
        seen: dict[bytes, dict[int, int]] = {}
        for row in rows:
            record = b"".join(np.ascontiguousarray(column[row]).tobytes() for column in columns)
            counts = seen.setdefault(record, {})
            file = int(file_of_point[row])
            counts[file] = counts.get(file, 0) + 1
            again[row] = counts[file] <= max(
                (count for other, count in counts.items() if other < file), default=0
            )
    return again
