"""DEM rasters and bands out, in any format that GDAL writes, through rasterio."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree  # nosec B405: reads what GDAL has just written

from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.libraries import silent_libraries
from wavelet_gis.io.names import gdal_path
from wavelet_gis.io.raster.raster_check import check_raster
from wavelet_gis.io.read_back import read_back, room_at
from wavelet_gis.model.dem import Dem
from wavelet_gis.products.vertex_raster import Bands

if TYPE_CHECKING:
    from rasterio.io import DatasetWriter

__all__ = ["write_bands", "write_cog", "write_dem"]

#: Lossless compressions; a lossy one would break what is to be kept.
_LOSSLESS = {"lzw", "deflate", "packbits", "zstd", "lzma"}

#: Names of tags that rasterio's ``update_tags`` takes for its own arguments.
_UNTAKEN = {"self", "bidx", "ns"}

#: Drivers by suffix where rasterio's own table is silent or ambiguous.
_DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".asc": "AAIGrid", ".img": "HFA", ".vrt": "VRT"}


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
    is_exact = driver == "GTiff"
    with _complaints_about(path, f"as {driver}", "use a name ending in .tif"):
        profile = _profile_to_write(dem, wkt, driver)
        if not is_exact:
            _write_copy(path, profile, dem)
        elif _UNTAKEN & {*_texts(dem.profile.get("tags")), *_texts(dem.profile.get("band_tags"))}:
            _write_with_any_tags(path, profile, dem)
        else:
            with rasterio.open(gdal_path(path), "w", **profile, **_gtiff_options(dem)) as dataset:
                _fill(dataset, dem)
    read_back(path, partial(_check_dem, dem=dem, is_exact=is_exact))


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
        with rasterio.open(gdal_path(path), "w", **profile, **options) as dataset:
            _fill(dataset, dem)
    read_back(path, partial(_check_dem, dem=dem, is_exact=True))


def write_bands(path: str | os.PathLike[str], bands: Bands, wkt: str | None) -> None:
    """Write bands to a GeoTIFF, each with its name.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    bands : Bands
        What to write.
    wkt : str or None
        The CRS.

    Raises
    ------
    OutputFileError
        When GDAL cannot write them.
    """
    import rasterio

    n_bands, n_rows, n_columns = bands.values.shape
    with (
        _complaints_about(path, "as GTiff", "ask for fewer bands, or larger cells"),
        rasterio.open(
            gdal_path(path),
            "w",
            driver="GTiff",
            count=n_bands,
            height=n_rows,
            width=n_columns,
            dtype=bands.values.dtype.name,
            crs=wkt,
            transform=rasterio.Affine(*bands.geometry.transform),
            nodata=bands.nodata,
            compress="deflate",
            tiled=True,
            predictor=3 if bands.values.dtype.kind == "f" else 1,
            bigtiff="if_safer",
        ) as dataset,
    ):
        for k, (band, name) in enumerate(zip(bands.values, bands.names, strict=True), start=1):
            dataset.write(band, k)
            dataset.set_band_description(k, name)
    read_back(
        path,
        partial(check_raster, bands=bands.values, geometry=bands.geometry, nodata=bands.nodata),
    )


def _check_dem(path: str | os.PathLike[str], dem: Dem, is_exact: bool) -> None:
    has_mask = is_exact and bool(dem.profile.get("has_mask"))
    check_raster(
        path,
        dem.values[None],
        dem.geometry,
        dem.nodata,
        valid=dem.valid if has_mask else None,
        is_exact=is_exact,
    )


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
    from rasterio.errors import NotGeoreferencedWarning, RasterioError, RasterioIOError

    try:
        with warnings.catch_warnings(), silent_libraries():
            # Of a raster without georeference there was a warning when it was read.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            yield
    # GDAL's own errors reach us bare where rasterio only hands a call through.
    # rasterio raises SystemError where GDAL fails without saying why. Before rasterio 1.4 the
    # error of a file was none of its family.
    except (RasterioError, RasterioIOError, CPLE_BaseError, ValueError, SystemError) as error:
        cause = error.__cause__ or error
        room = ""
        if not (isinstance(error, ValueError) or "support" in str(cause)):
            room = f"{room_at(Path(path).parent)}, or "
        raise OutputFileError(
            "{path}: GDAL cannot write this {what} ({cause}); {room}" + remedy + ".",
            *options,
            path=path,
            what=what,
            cause=cause,
            room=room,
        ) from error


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
    dataset.update_tags(**_takeable(dem.profile.get("tags")))
    dataset.update_tags(1, **_takeable(dem.profile.get("band_tags")))
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


def _takeable(tags: object) -> dict[str, str]:
    return {key: value for key, value in _texts(tags).items() if key not in _UNTAKEN}


def _write_copy(path: str | os.PathLike[str], profile: dict[str, Any], dem: Dem) -> None:
    """Write through memory, for the formats that GDAL can only copy to.

    Some of them lose what they cannot hold without a word; reading back shows it.
    """
    from rasterio.io import MemoryFile
    from rasterio.shutil import copy

    driver = profile["driver"]
    with MemoryFile() as memory:
        with memory.open(**{**profile, "driver": "GTiff"}) as dataset:
            _fill(dataset, dem)
        with memory.open() as dataset:
            copy(dataset, str(gdal_path(path)), driver=driver)


def _write_with_any_tags(path: str | os.PathLike[str], profile: dict[str, Any], dem: Dem) -> None:
    """Write a GeoTIFF with tags whose names rasterio takes for arguments of its own.

    By way of a VRT, into whose text they are put.
    """
    import rasterio
    from rasterio.shutil import copy

    options = _gtiff_options(dem)
    with TemporaryDirectory(dir=Path(path).parent) as folder:
        base, described = f"{folder}/base.tif", f"{folder}/base.vrt"
        with rasterio.open(base, "w", **profile) as dataset:
            _fill(dataset, dem)
        with rasterio.open(base) as dataset:
            copy(dataset, described, driver="VRT")
        root = ElementTree.parse(described).getroot()  # nosec B314: GDAL has just written it
        band = root.find("VRTRasterBand")
        for element, tags in ((root, "tags"), (band, "band_tags")):
            untaken = {k: v for k, v in _texts(dem.profile.get(tags)).items() if k in _UNTAKEN}
            if element is None or not untaken:
                continue
            metadata = next((m for m in element.findall("Metadata") if not m.attrib), None)
            if metadata is None:
                metadata = ElementTree.Element("Metadata")
                element.insert(0, metadata)
            for key, value in untaken.items():
                ElementTree.SubElement(metadata, "MDI", key=key).text = value
        ElementTree.ElementTree(root).write(described, encoding="utf-8")
        copy(described, str(gdal_path(path)), driver="GTiff", **options)


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
