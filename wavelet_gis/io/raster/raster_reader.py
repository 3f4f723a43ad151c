"""DEM rasters in, of any GDAL format, through rasterio."""

from __future__ import annotations

import os
import re
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_gis._memory import BYTES_TO_ANALYSE_A_CELL, BYTES_TO_READ_A_CELL, require_bytes
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.errors import InputFileError, RasterWarning
from wavelet_gis.io.libraries import silent_libraries
from wavelet_gis.io.names import file_of, gdal_path
from wavelet_gis.io.raster.nodata import NO_TAG, implausible_cells, warn_of_doubts
from wavelet_gis.io.raster.remote import NO_NETWORK, remote_reference
from wavelet_gis.model.dem import Dem, GridGeometry, require_sound
from wavelet_gis.notes import warn

if TYPE_CHECKING:
    from rasterio.io import DatasetReader

__all__ = ["NO_TAG", "CellWindow", "read_dem"]


class CellWindow(NamedTuple):
    """Some cells of a raster.

    row, column : int, of the first
    height, width : int, in cells
    """

    row: int
    column: int
    height: int
    width: int


#: Creation options of GeoTIFF that are taken over from the file that was read.
_GTIFF_OPTIONS = ("compress", "predictor", "tiled", "blockxsize", "blockysize")


def read_dem(
    path: str | os.PathLike[str],
    *,
    band: int | None = None,
    nodata: float | str | None = None,
    offline: bool = False,
    window: CellWindow | None = None,
) -> tuple[Dem, Georeference]:
    """Return one band of a raster, and what the file says of its coordinates.

    Parameters
    ----------
    path : path
        Any raster that GDAL opens, or a sub-dataset by GDAL's name (``GPKG:a.gpkg:dem``).
    band : int, optional
        Counted from 1; may be left out where there is only one.
    nodata : float or ``"none"``, optional
        The stored number that stands for nothing, instead of the file's tag.
    offline : bool
        Whether a raster that refers to the network is refused.
    window : CellWindow, optional
        Only these cells.

    Raises
    ------
    InputFileError
        When the file is missing, no raster, damaged, complex-valued, has several bands and none
        is chosen, or needs more memory than there is; see also
        `wavelet_gis.model.dem.require_sound`.

    Warns
    -----
    RasterWarning
        When numbers that can be no elevations are taken as nodata, when others may be meant as
        nodata, when data come over the network, and when GDAL complains of the file.

    Notes
    -----
    Cells are holes where GDAL's mask says so (nodata, mask band, alpha), where the value is NaN or
    infinite, tagged or not, and where it is a float of 1e30 or more.
    """
    import rasterio
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import NotGeoreferencedWarning, RasterioError, RasterioIOError

    _require_file(path)
    remote = remote_reference(path)
    if remote is not None and offline:
        raise InputFileError(
            "{path}: this raster reads {remote} over the network, which {0} forbids; fetch the "
            "data first and name the local file.",
            "offline",
            path=path,
            remote=remote,
        )
    if remote is not None:
        _warn(
            "raster_over_network",
            "{path}: reads {remote} over the network ({0} forbids it)",
            "offline",
            path=os.fspath(path),
            remote=remote,
        )
    try:
        # Of a raster without georeference our own warning speaks, once.
        settings = NO_NETWORK if offline else {}
        with warnings.catch_warnings(), silent_libraries() as said, rasterio.Env(**settings):
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(gdal_path(path)) as dataset:
                dem, place = _read_band(dataset, path, band, nodata, window)
    # Before rasterio 1.4 the error of a file was none of its family.
    except (RasterioError, RasterioIOError, CPLE_BaseError, UnicodeDecodeError) as error:
        if remote is not None:
            raise InputFileError(
                f"{path}: {remote}, which this raster reads over the network, cannot be fetched; "
                "download it first and name the local file."
            ) from error
        raise InputFileError(f"{path}: {_reason(error, path)}") from error
    require_sound(dem, os.fspath(path))
    if said:
        _warn(
            "raster_read_with_complaints",
            "{path}: read, but GDAL reported: {complaint}",
            path=os.fspath(path),
            complaint=said[0],
        )
    warn_of_doubts(dem.values[dem.valid], os.fspath(path))
    return dem, place


def _require_file(path: str | os.PathLike[str]) -> None:
    # GDAL's own virtual paths (/vsizip/..., driver prefixes) are left to GDAL.
    name = os.fspath(path)
    if name.startswith("/vsi"):
        return
    if os.path.isdir(name):
        raise InputFileError(f"{name}: this is a folder; name the raster file in it.")
    if file_of(name) is None or not os.path.exists(str(file_of(name))):
        raise InputFileError(f"{name}: there is no such file; check the path.")


def _read_band(
    dataset: DatasetReader,
    path: str | os.PathLike[str],
    band: int | None,
    nodata: float | str | None,
    cells: CellWindow | None,
) -> tuple[Dem, Georeference]:
    if dataset.count == 0:
        names = dataset.subdatasets
        listed = ", ".join(names[:4]) + (", ..." if len(names) > 4 else "")
        raise InputFileError(
            f"{path}: the file holds {len(names)} sub-datasets and no band of its own; name one "
            f"of them as the input{': ' if listed else ''}{listed}."
        )
    if band is None and dataset.count > 1:
        raise InputFileError(
            "{path}: the raster has {n_bands} bands; choose the elevation band with {0}.",
            "band",
            path=path,
            n_bands=dataset.count,
        )
    index = 1 if band is None else band
    if not 1 <= index <= dataset.count:
        raise InputFileError(
            f"{path}: there is no band {index}; the bands are 1 to {dataset.count}."
        )
    dtype = np.dtype(dataset.dtypes[index - 1])
    if dtype.kind not in "iuf":
        raise InputFileError(
            f"{path}: band {index} holds {dtype} values; elevations must be real numbers."
        )
    row, column, height, width = cells or (0, 0, dataset.height, dataset.width)
    name = os.fspath(path)
    require_bytes(height * width * BYTES_TO_READ_A_CELL, name, f"{height} x {width} cells")
    window = ((row, row + height), (column, column + width))
    values = dataset.read(index, window=window)
    whole = GridGeometry((dataset.height, dataset.width), tuple(dataset.transform)[:6])
    valid = _valid_cells(dataset, index, values, nodata, path, window)
    n_valid = int(np.count_nonzero(valid))
    require_bytes(n_valid * BYTES_TO_ANALYSE_A_CELL, name, f"{n_valid:,} cells with data")
    dem = Dem(
        values=values,
        valid=valid,
        geometry=whole.window(row, column, values.shape),
        nodata=_nodata(dataset, index),
        scale=float(dataset.scales[index - 1]),
        offset=float(dataset.offsets[index - 1]),
        profile=_profile(dataset, index),
    )
    wkt = dataset.crs.to_wkt() if dataset.crs else None
    return dem, Georeference(wkt, dataset.units[index - 1] or None)


def _valid_cells(
    dataset: DatasetReader,
    index: int,
    values: NDArray[Any],
    nodata: float | str | None,
    path: str | os.PathLike[str],
    window: tuple[tuple[int, int], tuple[int, int]],
) -> NDArray[np.bool_]:
    """Return which cells are elevations: nodata is compared with the numbers as stored."""
    from rasterio.enums import MaskFlags

    is_tag_alone = MaskFlags.nodata in dataset.mask_flag_enums[index - 1]
    if nodata is None or not is_tag_alone:
        valid: NDArray[np.bool_] = dataset.read_masks(index, window=window) != 0
    else:
        valid = np.ones(values.shape, dtype=bool)
    if values.dtype.kind == "f":
        valid &= np.isfinite(values)
    if nodata is None:
        valid &= ~implausible_cells(values, valid, os.fspath(path))
    elif nodata != NO_TAG:
        number = float(nodata)
        info = np.iinfo(values.dtype) if values.dtype.kind in "iu" else None
        if info and not (number.is_integer() and info.min <= number <= info.max):
            raise InputFileError(
                f"{path}: the raster holds {values.dtype} numbers, so {nodata} cannot be its "
                "nodata value; give one as stored, before scale and offset."
            )
        valid &= values != values.dtype.type(number)
    return valid


def _warn(code: str, template: str, *options: str, **figures: Any) -> None:
    warn(RasterWarning, code, template, *options, stacklevel=4, **figures)


def _nodata(dataset: DatasetReader, index: int) -> float | int | None:
    nodata = dataset.nodatavals[index - 1]
    if nodata is None:
        return None
    is_integer = np.dtype(dataset.dtypes[index - 1]).kind in "iu"
    return int(nodata) if is_integer and float(nodata).is_integer() else float(nodata)


def _profile(dataset: DatasetReader, index: int) -> dict[str, Any]:
    """Return what the writer may take over, as JSON-able values."""
    from rasterio.enums import MaskFlags

    structure = dataset.tags(ns="IMAGE_STRUCTURE")
    options = {key: value for key, value in dataset.profile.items() if key in _GTIFF_OPTIONS}
    if "PREDICTOR" in structure:
        options["predictor"] = int(structure["PREDICTOR"])
    profile: dict[str, Any] = {
        "driver": dataset.driver,
        "options": options,
        "tags": dict(dataset.tags()),
        "band_tags": dict(dataset.tags(index)),
        "band": index,
        "description": dataset.descriptions[index - 1],
        "unit": dataset.units[index - 1],
    }
    if MaskFlags.per_dataset in dataset.mask_flag_enums[index - 1]:
        profile["has_mask"] = True
    return profile


def _reason(error: Exception, path: str | os.PathLike[str]) -> str:
    """Return the first line of GDAL's complaint, as a sentence with a remedy."""
    if _is_text_of_points(path):
        return (
            "this is a text file of points, not a raster that GDAL can open; make a LAS file of "
            "it (pdal translate a.xyz a.las), or a grid (gdal_grid)."
        )
    if isinstance(error, UnicodeDecodeError):  # GDAL's complaint quotes what is no text
        return "this is no raster that GDAL can open; check the file and its suffix."
    cause = error.__cause__ or error
    text = str(cause).splitlines()[0] if str(cause) else type(cause).__name__
    if "not recognized" in text:
        return "this is no raster that GDAL can open; check the file and its suffix."
    return f"the raster cannot be read ({text.rstrip('.')}); the file is damaged, get it again."


def _is_text_of_points(path: str | os.PathLike[str]) -> bool:
    """Return whether a file holds lines of three numbers or more, perhaps under a heading."""
    try:
        with open(path, "rb") as stream:
            lines = stream.read(4096).decode("ascii").splitlines()[:20]
    except (OSError, UnicodeDecodeError):
        return False
    rows = [re.split(r"[\s,;]+", line.strip()) for line in lines[1:-1] or lines]
    return bool(rows) and all(_are_numbers(row[:3]) for row in rows if row != [""])


def _are_numbers(words: list[str]) -> bool:
    try:
        return len([float(word) for word in words]) == 3
    except ValueError:
        return False
