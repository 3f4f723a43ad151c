"""DEM rasters in and out of any GDAL format, through rasterio."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavelet_gis.crs.frame import Georeference
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.model.dem import Dem, GridGeometry

if TYPE_CHECKING:
    from rasterio.io import DatasetReader, DatasetWriter

__all__ = ["read_dem", "write_cog", "write_dem"]

#: Creation options of GeoTIFF that are taken over from the file that was read.
_GTIFF_OPTIONS = ("compress", "predictor", "tiled", "blockxsize", "blockysize")

#: Lossless compressions; a lossy one would break what it is told to keep.
_LOSSLESS = {"lzw", "deflate", "packbits", "zstd", "lzma"}

#: Drivers by suffix where rasterio's own table is silent or ambiguous.
_DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".asc": "AAIGrid", ".img": "HFA", ".vrt": "VRT"}


def read_dem(path: str | os.PathLike[str], *, band: int | None = None) -> tuple[Dem, Georeference]:
    """Return one band of a raster, and what the file tells of its coordinates.

    Parameters
    ----------
    path : path
        Any raster that GDAL opens.
    band : int, optional
        Counted from 1; may be left out where there is only one.

    Raises
    ------
    InputFileError
        When the file is missing, no raster, damaged, complex-valued, or has several bands and
        none is chosen.

    Notes
    -----
    Cells are holes where GDAL's mask says so (nodata, mask band, alpha) and where the value is
    NaN or infinite, tagged or not.
    """
    import rasterio
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    _require_file(path)
    try:
        # A raster without georeference is told of by our own warning, once.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                return _read_band(dataset, Path(path), band)
    except (RasterioError, CPLE_BaseError) as error:
        raise InputFileError(f"{path}: {_reason(error)}") from error


def write_dem(path: str | os.PathLike[str], dem: Dem, wkt: str | None) -> None:
    """Write a DEM with its CRS, transform, nodata, data type and tags.

    Parameters
    ----------
    path : path
        The suffix chooses the format; GeoTIFF takes over compression and tiling.
    dem : Dem
        What to write.
    wkt : str or None
        Its CRS.

    Raises
    ------
    OutputFileError
        When GDAL cannot write this format or type of data.
    """
    import rasterio

    driver = _driver_of(path)
    with _complaints_about(path, f"as {driver}", "use a name ending in .tif"):
        profile = _profile_to_write(dem, wkt, driver)
        if driver == "GTiff":
            with rasterio.open(path, "w", **profile, **_gtiff_options(dem)) as dataset:
                _fill(dataset, dem)
        else:
            _write_copy(path, profile, dem)


def write_cog(path: str | os.PathLike[str], dem: Dem, wkt: str | None) -> None:
    """Write a DEM as a cloud-optimised GeoTIFF: tiled, deflate, with overviews.

    Parameters are those of `write_dem`.

    Raises
    ------
    OutputFileError
        When GDAL cannot write it.
    """
    import rasterio

    with _complaints_about(path, "as a cloud-optimised GeoTIFF", "leave {0} out", "cog"):
        profile = _profile_to_write(dem, wkt, "COG")
        options = {"compress": "deflate", "predictor": "yes"}
        with rasterio.open(path, "w", **profile, **options) as dataset:
            _fill(dataset, dem)


def _profile_to_write(dem: Dem, wkt: str | None, driver: str) -> dict[str, Any]:
    import rasterio
    from rasterio.crs import CRS

    n_rows, n_columns = dem.geometry.shape
    return {
        "driver": driver,
        "width": n_columns,
        "height": n_rows,
        "count": 1,
        "dtype": dem.values.dtype.newbyteorder("=").name,
        "nodata": dem.nodata,
        "transform": rasterio.Affine(*dem.geometry.transform),
        "crs": CRS.from_wkt(wkt) if wkt else None,
    }


@contextmanager
def _complaints_about(
    path: str | os.PathLike[str], what: str, remedy: str, *options: str
) -> Iterator[None]:
    """Turn what GDAL and rasterio raise in the block into one error of ours."""
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    try:
        with warnings.catch_warnings():
            # A raster without georeference was told of when it was read.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            yield
    # GDAL's own errors reach us bare where rasterio only hands a call through.
    except (RasterioError, CPLE_BaseError, ValueError) as error:
        raise OutputFileError(
            "{path}: GDAL cannot write this {what} ({error}); " + remedy + ".",
            *options,
            path=path,
            what=what,
            error=error,
        ) from error


def _require_file(path: str | os.PathLike[str]) -> None:
    # GDAL's own virtual paths (/vsizip/..., driver prefixes) are left to GDAL.
    name = os.fspath(path)
    if name.startswith("/vsi"):
        return
    if os.path.isdir(name):
        raise InputFileError(f"{name}: this is a folder; name the raster file in it.")
    if not os.path.exists(name):
        raise InputFileError(f"{name}: there is no such file; check the path.")


def _read_band(dataset: DatasetReader, path: Path, band: int | None) -> tuple[Dem, Georeference]:
    if dataset.count == 0:
        raise InputFileError(
            f"{path}: the file holds {len(dataset.subdatasets)} sub-datasets and no band of its "
            "own; name one of them, as gdalinfo lists them."
        )
    if band is None and dataset.count > 1:
        raise InputFileError(
            "{path}: the raster has {n_bands} bands; choose the one with the elevations by {0}.",
            "band",
            path=path,
            n_bands=dataset.count,
        )
    index = 1 if band is None else band
    if not 1 <= index <= dataset.count:
        raise InputFileError(
            f"{path}: there is no band {index}; the bands are 1 to {dataset.count}."
        )
    values = dataset.read(index)
    if values.dtype.kind not in "iuf":
        raise InputFileError(
            f"{path}: band {index} holds {values.dtype} values; elevations must be real numbers."
        )
    transform = tuple(dataset.transform)[:6]
    if transform[0] * transform[4] == transform[1] * transform[3]:
        raise InputFileError(
            f"{path}: the geotransform {transform} maps all cells onto a line; georeference the "
            "raster first (gdal_translate -a_ullr)."
        )
    valid = dataset.read_masks(index) != 0
    if values.dtype.kind == "f":
        valid &= np.isfinite(values)
    dem = Dem(
        values=values,
        valid=valid,
        geometry=GridGeometry(values.shape, transform),
        nodata=_nodata(dataset, index),
        scale=float(dataset.scales[index - 1]),
        offset=float(dataset.offsets[index - 1]),
        profile=_profile(dataset, index),
    )
    wkt = dataset.crs.to_wkt() if dataset.crs else None
    return dem, Georeference(wkt, dataset.units[index - 1] or None)


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


def _gtiff_options(dem: Dem) -> dict[str, Any]:
    """Return the creation options that the profile hints at and that GeoTIFF takes.

    The hints may come from another format, or from a file of unknown origin.
    """
    hints = dem.profile.get("options")
    hints = hints if isinstance(hints, dict) else {}
    options: dict[str, Any] = {}
    if str(hints.get("compress")).lower() in _LOSSLESS:
        options["compress"] = str(hints["compress"])
        if hints.get("predictor") in ([1, 2, 3] if dem.values.dtype.kind == "f" else [1, 2]):
            options["predictor"] = hints["predictor"]
    if hints.get("tiled") is True:
        options["tiled"] = True
        sizes = [hints.get("blockxsize"), hints.get("blockysize")]
        if all(type(size) is int and 16 <= size <= 8192 and size % 16 == 0 for size in sizes):
            options["blockxsize"], options["blockysize"] = sizes
    if dem.values.nbytes > 3 << 30:
        options["bigtiff"] = "IF_SAFER"
    return options


def _fill(dataset: DatasetWriter, dem: Dem) -> None:
    dataset.write(dem.values, 1)
    if dem.scale != 1.0 or dem.offset != 0.0:
        dataset.scales, dataset.offsets = (dem.scale,), (dem.offset,)
    dataset.update_tags(**_texts(dem.profile.get("tags")))
    dataset.update_tags(1, **_texts(dem.profile.get("band_tags")))
    if dem.profile.get("description"):
        dataset.set_band_description(1, str(dem.profile["description"]))
    if dem.profile.get("unit"):
        dataset.units = (str(dem.profile["unit"]),)
    if dem.profile.get("has_mask"):
        dataset.write_mask(dem.valid)


def _texts(tags: object) -> dict[str, str]:
    """Return tags as GDAL takes them, without statistics, which may hold no longer."""
    if not isinstance(tags, dict):
        return {}
    return {str(key): str(value) for key, value in tags.items() if "STATISTICS_" not in str(key)}


def _write_copy(path: str | os.PathLike[str], profile: dict[str, Any], dem: Dem) -> None:
    """Write through memory, for the formats that GDAL can only copy to.

    Some of them lose what they cannot hold without a word, so the result is read again.
    """
    import rasterio
    from rasterio.io import MemoryFile
    from rasterio.shutil import copy

    driver = profile["driver"]
    with MemoryFile() as memory:
        with memory.open(**{**profile, "driver": "GTiff"}) as dataset:
            _fill(dataset, dem)
        with memory.open() as dataset:
            copy(dataset, os.fspath(path), driver=driver)
    with rasterio.open(path) as dataset:
        if not np.array_equal(dataset.read(1), dem.values, equal_nan=dem.values.dtype.kind == "f"):
            raise ValueError("the format changes the values")


def _driver_of(path: str | os.PathLike[str]) -> str:
    suffix = Path(path).suffix.lower()
    if suffix in _DRIVERS:
        return _DRIVERS[suffix]
    from rasterio.drivers import driver_from_extension

    try:
        return str(driver_from_extension(os.fspath(path)))
    except ValueError as error:
        raise OutputFileError(
            f"{path}: no raster format is known by this suffix; use a name ending in .tif."
        ) from error


def _reason(error: Exception) -> str:
    """Return the first line of GDAL's complaint, as a sentence with a remedy."""
    cause = error.__cause__ or error
    text = str(cause).splitlines()[0] if str(cause) else type(cause).__name__
    if "not recognized" in text:
        return "this is no raster that GDAL can open; check the file and its suffix."
    return f"the raster cannot be read ({text.rstrip('.')}); the file is damaged, get it again."
