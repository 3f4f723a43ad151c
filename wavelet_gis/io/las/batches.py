"""LAS and LAZ files of any size: all but the points, and the points a batch at a time."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.crs.frame import Georeference
from wavelet_gis.crs.las import las_crs
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.las import laz_decoder
from wavelet_gis.io.las.cloud_reader import (
    decoding,
    laspy_header,
    laz_job,
    projection_records,
    tail_of,
)
from wavelet_gis.io.las.layout import LasLayout, read_layout

__all__ = ["CloudHead", "each_batch", "read_head"]


class CloudHead(NamedTuple):
    """A LAS file but for its points.

    layout : LasLayout
    tail : bytes, what is kept of what follows the points
    tail_at : int or None, the offset that it had; see `wavelet_gis.model.points.cloud.PointCloud`
    place : Georeference
    """

    layout: LasLayout
    tail: bytes
    tail_at: int | None
    place: Georeference


def read_head(path: str | os.PathLike[str]) -> CloudHead:
    """Return all of a LAS or LAZ file but its points.

    Raises
    ------
    InputFileError
        When the file is missing, no LAS file, or holds no points.
    """
    name = os.fspath(path)
    if not os.path.isfile(name):
        raise InputFileError(f"{name}: there is no such file; check the path.")
    with open(name, "rb") as stream:
        layout = read_layout(name, stream)
        if layout.n_points == 0:
            raise InputFileError(f"{name}: the file holds no points; get it again.")
        tail, tail_at = tail_of(name, layout, stream)
    return CloudHead(layout, tail, tail_at, las_crs(projection_records(layout, tail, tail_at)))


def each_batch(
    path: str | os.PathLike[str],
    layout: LasLayout,
    n_points: int,
    take: Callable[[NDArray[Any]], object],
) -> None:
    """Hand the point records of a file on, so many at a time at most.

    Parameters
    ----------
    path : path
    layout : LasLayout
        Of the file.
    n_points : int
        In a batch.
    take : callable
        Given records, a structured array that is of no use once it returns.

    Raises
    ------
    InputFileError
        When the points cannot be read.
    MissingDependencyError
        When laspy, or lazrs for a LAZ file, is not installed.
    """
    name = os.fspath(path)
    dtype = laspy_header(name, layout).point_format.dtype()
    if layout.is_compressed:
        job = laz_job(name, layout)
        with decoding(name):
            laz_decoder.decoded_in_batches(
                job, n_points, lambda batch: take(np.frombuffer(batch, dtype))
            )
        return
    with open(name, "rb") as stream:
        stream.seek(layout.points_start)
        left = layout.n_points
        while left:
            batch = np.fromfile(stream, dtype, min(left, n_points))
            if len(batch) == 0:
                raise InputFileError(
                    f"{name}: the header announces {layout.n_points} points, the file ends after "
                    f"{layout.n_points - left}; get it again."
                )
            take(batch)
            left -= len(batch)
