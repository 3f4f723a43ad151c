"""``Dem`` and ``Bands`` arrays to raster files by GDAL; a file appears whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from osgeo import gdal
from qgis.core import QgsRasterFileWriter

from ..ui.enums import WKT_FOR_GDAL
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .crs_and_progress import require_running
from .gdal_errors import without_exceptions
from .raster_reader import GDAL_TYPES, strips

if TYPE_CHECKING:
    from qgis.core import QgsCoordinateReferenceSystem, QgsFeedback

    from wavelet_gis.model.dem import Dem, GridGeometry
    from wavelet_gis.products.vertex_raster import Bands

#: Of the time in which a raster is written: all but its reading back.
_SHARE_OF_WRITING = 0.7
#: Cells that are written between two looks at the cancel button: GDAL compresses them meanwhile.
_CELLS_AT_ONCE = 1 << 18


def write_dem(
    path: str,
    dem: Dem,
    crs: QgsCoordinateReferenceSystem,
    feedback: QgsFeedback,
    report: Callable[[float], bool],
) -> None:
    """Write a ``Dem`` as a raster; the suffix chooses the format.

    Parameters
    ----------
    path : str
        Where; the file appears whole or not at all.
    dem : Dem
    crs : QgsCoordinateReferenceSystem
    feedback : QgsProcessingFeedback
        Asked for cancel between strips.
    report : callable
        Takes the fraction that is done.

    Raises
    ------
    QgsProcessingException
        A format that GDAL cannot write, or a full disk.
    """
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.read_back import read_back

    driver_name = QgsRasterFileWriter.driverForExtension(os.path.splitext(path)[1].lstrip("."))
    refusal = partial(_unwritten, path)
    with new_file(path, overwrite=True) as scratch, without_exceptions(gdal, refusal):
        options = _creation_options(dem) if driver_name == "GTiff" else []
        first = gdal.GetDriverByName("GTiff" if driver_name == "GTiff" else "MEM")
        last = gdal.GetDriverByName(driver_name) if driver_name else None
        gdal_type = GDAL_TYPES.get(dem.values.dtype.newbyteorder("<").str)
        if last is None or gdal_type is None:
            raise QgsProcessingException(
                tr(
                    "{}: no raster of {} can be written under this name; use one ending in .tif."
                ).format(path, dem.values.dtype)
            )
        n_rows, n_columns = dem.geometry.shape
        name = str(scratch) if first is last or driver_name == "GTiff" else ""
        dataset = first.Create(name, n_columns, n_rows, 1, gdal_type, options)
        is_written = dataset is not None and _fill(dataset, dem, crs, feedback, report)
        if is_written and driver_name != "GTiff":
            copy = last.CreateCopy(str(scratch), dataset)
            is_written = copy is not None
            copy = None
        dataset = None  # closes the file
        if not is_written:
            raise refusal(gdal.GetLastErrorMsg())
        look = partial(_look, feedback, report)
        read_back(scratch, partial(_check, values=dem.values[None], look=look))


def write_bands(
    path: str,
    bands: Bands,
    crs: QgsCoordinateReferenceSystem,
    feedback: QgsFeedback,
    report: Callable[[float], bool],
) -> None:
    """Write ``wavelet_gis.products.vertex_raster.Bands`` as a GeoTIFF, each band with its name.

    ``report`` takes the fraction that is done.

    Raises
    ------
    QgsProcessingException
        When GDAL cannot write.
    Cancelled
    """
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.read_back import read_back

    n_bands, n_rows, n_columns = bands.values.shape
    dtype = bands.values.dtype.newbyteorder("<")
    predictor = 3 if dtype.kind == "f" else 2
    options = ["COMPRESS=DEFLATE", f"PREDICTOR={predictor}", "TILED=YES", "BIGTIFF=IF_SAFER"]
    options.append("INTERLEAVE=BAND")  # or all would be compressed when the file is closed
    refusal = partial(_unwritten, path)
    with new_file(path, overwrite=True) as scratch, without_exceptions(gdal, refusal):
        driver = gdal.GetDriverByName("GTiff")
        dataset = driver.Create(
            str(scratch), n_columns, n_rows, n_bands, GDAL_TYPES[dtype.str], options
        )
        if dataset is None:
            raise refusal(gdal.GetLastErrorMsg())
        _georeference(dataset, bands.geometry, crs)
        is_written = True
        for k in range(n_bands):
            band = dataset.GetRasterBand(k + 1)
            band.SetDescription(bands.names[k])
            band.SetNoDataValue(bands.nodata)
            told = _part_of_writing(report, k / n_bands, (k + 1) / n_bands)
            is_written &= _write_strips(band, bands.values[k], feedback, told)
            band.FlushCache()
        band = dataset = None  # closes the file
        if not is_written:
            raise refusal(gdal.GetLastErrorMsg())
        look = partial(_look, feedback, report)
        read_back(scratch, partial(_check, values=bands.values, look=look))


def _part_of_writing(
    report: Callable[[float], bool], start: float, stop: float
) -> Callable[[float], bool]:
    """Return what reports a part of the writing, of all that the output takes."""
    return lambda share: report(_SHARE_OF_WRITING * (start + (stop - start) * share))


def _look(feedback: QgsFeedback, report: Callable[[float], bool], share: float) -> None:
    require_running(feedback)
    report(_SHARE_OF_WRITING + (1.0 - _SHARE_OF_WRITING) * share)


def _check(
    path: str | os.PathLike[str], values: NDArray[Any], look: Callable[[float], None]
) -> None:
    """Read a raster back: GDAL may fail when it closes a file, and does not say so."""
    from wavelet_gis.errors import OutputFileError

    dataset = gdal.Open(str(path))
    n_bands, n_rows, n_columns = values.shape
    if dataset is None or dataset.RasterCount != n_bands:
        raise OutputFileError(gdal.GetLastErrorMsg() or "it has lost its bands")
    if (dataset.RasterYSize, dataset.RasterXSize) != (n_rows, n_columns):
        raise OutputFileError(f"it has {dataset.RasterYSize} x {dataset.RasterXSize} cells")
    at_once = max((1 << 22) // n_columns, 1)
    for k in range(n_bands):
        band = dataset.GetRasterBand(k + 1)
        for start in range(0, n_rows, at_once):
            look((k + start / n_rows) / n_bands)
            due = values[k, start : start + at_once]
            read = band.ReadRaster(0, start, n_columns, len(due))
            if read is None:
                raise OutputFileError(gdal.GetLastErrorMsg() or f"row {start} cannot be read")
            there = np.frombuffer(read, values.dtype.newbyteorder("=")).reshape(due.shape)
            if not np.array_equal(there, due, equal_nan=due.dtype.kind == "f"):
                raise OutputFileError(f"its values differ from row {start} on")


def _fill(
    dataset: Any,
    dem: Dem,
    crs: QgsCoordinateReferenceSystem,
    feedback: QgsFeedback,
    report: Callable[[float], bool],
) -> bool:
    _georeference(dataset, dem.geometry, crs)
    for key, value in dict(dem.profile.get("tags", {})).items():
        dataset.SetMetadataItem(str(key), str(value))
    band = dataset.GetRasterBand(1)
    if dem.nodata is not None:
        band.SetNoDataValue(dem.nodata)
    if dem.scale != 1.0 or dem.offset != 0.0:
        band.SetScale(dem.scale)
        band.SetOffset(dem.offset)
    if dem.profile.get("unit"):
        band.SetUnitType(str(dem.profile["unit"]))
    told = _part_of_writing(report, 0.0, 1.0)
    is_written = _write_strips(band, dem.values, feedback, told)
    dataset.FlushCache()
    return is_written


def _georeference(dataset: Any, geometry: GridGeometry, crs: QgsCoordinateReferenceSystem) -> None:
    a, b, c, d, e, f = geometry.transform
    dataset.SetGeoTransform((c, a, b, f, d, e))
    if crs.isValid():
        dataset.SetProjection(crs.toWkt(WKT_FOR_GDAL))


def _write_strips(
    band: Any, values: NDArray[Any], feedback: QgsFeedback, report: Callable[[float], bool]
) -> bool:
    n_rows, n_columns = values.shape
    block_rows = band.GetBlockSize()[1]
    for start, stop in strips(n_rows, n_columns, feedback, _CELLS_AT_ONCE, block_rows):
        strip = np.ascontiguousarray(values[start:stop])
        if band.WriteRaster(0, start, n_columns, stop - start, strip.tobytes()) != 0:
            return False
        report(stop / n_rows)
    return True


def _unwritten(path: str, reason: str) -> QgsProcessingException:
    return QgsProcessingException(
        tr("{}: GDAL could not write this raster ({}); check the disk and the name.").format(
            path, reason
        )
    )


def _creation_options(dem: Dem) -> list[str]:
    options = dict(dem.profile.get("options", {}))
    # Lossless, and a third of the size: what a new raster gets.
    options.setdefault("compress", "deflate")
    if options["compress"] in ("lzw", "deflate", "zstd"):
        options.setdefault("predictor", 3 if dem.values.dtype.kind == "f" else 2)
    options.setdefault("bigtiff", "IF_SAFER")
    names = ("compress", "predictor", "tiled", "blockxsize", "blockysize", "bigtiff")
    values = {name: options[name] for name in names if options.get(name) is not None}
    if not values.get("tiled"):
        values.pop("tiled", None)
        values.pop("blockxsize", None)
        values.pop("blockysize", None)
    return [f"{name.upper()}={'YES' if value is True else value}" for name, value in values.items()]
