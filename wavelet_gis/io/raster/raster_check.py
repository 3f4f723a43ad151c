"""A raster that was written, held against the arrays that it was to hold."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.names import gdal_path
from wavelet_gis.model.dem import GridGeometry

__all__ = ["check_raster"]

_CELLS_AT_ONCE = 1 << 22


def check_raster(
    path: str | os.PathLike[str],
    bands: NDArray[Any],
    geometry: GridGeometry,
    nodata: float | int | None,
    *,
    valid: NDArray[np.bool_] | None = None,
    is_exact: bool = True,
) -> None:
    """Read a raster back.

    Parameters
    ----------
    path : path
        A closed file.
    bands : (n_bands, n_rows, n_columns)
        What every block must hold.
    geometry : GridGeometry
        Its size and place.
    nodata : float, int or None
        Its tag.
    valid : (n_rows, n_columns) bool, optional
        Its mask, where it has one of its own.
    is_exact : bool
        Whether type, place, tag and every bit must be the same, as GeoTIFF keeps them; other
        formats must hold the same numbers.

    Raises
    ------
    OutputFileError
        With what differs, and nothing else, in the message.
    """
    import rasterio

    n_bands, n_rows, n_columns = bands.shape
    with rasterio.open(gdal_path(path)) as dataset:
        if (dataset.count, dataset.height, dataset.width) != bands.shape:
            raise OutputFileError(
                f"it holds {dataset.count} bands of {dataset.height} x {dataset.width} cells"
            )
        if is_exact:
            dtype = bands.dtype.newbyteorder("=").name
            if set(dataset.dtypes) != {dtype}:
                raise OutputFileError(f"it holds {dataset.dtypes[0]} for {dtype}")
            # GDAL writes a transform that says nothing as none.
            if tuple(dataset.transform)[:6] != tuple(geometry.transform):
                raise OutputFileError("its geotransform differs")
            if repr(_plain(dataset.nodata)) != repr(_plain(nodata)):
                raise OutputFileError(f"its nodata value is {dataset.nodata} for {nodata}")
        at_once = max(_CELLS_AT_ONCE // max(n_columns, 1), 1)
        for index in range(n_bands):
            for start in range(0, n_rows, at_once):
                due = bands[index, start : start + at_once]
                window = ((start, start + len(due)), (0, n_columns))
                read = dataset.read(index + 1, window=window)
                if is_exact:
                    is_same = read.tobytes() == due.astype(read.dtype, copy=False).tobytes()
                else:
                    is_same = np.array_equal(read, due, equal_nan=due.dtype.kind == "f")
                if not is_same:
                    fault = "its values differ" if is_exact else "the format changes the values"
                    raise OutputFileError(f"{fault} from row {start} on")
        if valid is not None and not np.array_equal(dataset.read_masks(1) != 0, valid):
            raise OutputFileError("its mask differs")


def _plain(value: float | int | None) -> float | None:
    return None if value is None else float(value)
