"""Raster layers to ``Dem`` arrays, through QGIS and GDAL.

Layers of QGIS's GDAL provider are read with GDAL itself: QGIS scales values, warps rotated rasters
and gives the cell size as extent over count, and none of that comes back bit for bit. All other
providers are read block by block through QGIS.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from osgeo import gdal
from qgis.core import Qgis, QgsRasterIterator, QgsRasterRange

from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .gdal_errors import opened, without_exceptions

if TYPE_CHECKING:
    from qgis.core import (
        QgsCoordinateReferenceSystem,
        QgsFeedback,
        QgsRasterDataProvider,
        QgsRasterLayer,
    )

    from wavelet_gis.io.raster import CellWindow
    from wavelet_gis.model.dem import Dem, GridGeometry

    from .background import Work

    Stoppable = QgsFeedback | Work

#: Cells read or written between two looks at the cancel button.
STRIP_CELLS = 1 << 21

GDAL_TYPES = {
    "|u1": gdal.GDT_Byte,
    "<u2": gdal.GDT_UInt16,
    "<i2": gdal.GDT_Int16,
    "<u4": gdal.GDT_UInt32,
    "<i4": gdal.GDT_Int32,
    "<f4": gdal.GDT_Float32,
    "<f8": gdal.GDT_Float64,
    # Newer than GDAL 3.4 and 3.6.
    "|i1": getattr(gdal, "GDT_Int8", None),
    "<i8": getattr(gdal, "GDT_Int64", None),
    "<u8": getattr(gdal, "GDT_UInt64", None),
}
_NUMPY_TYPES = {code: np.dtype(text) for text, code in GDAL_TYPES.items() if code is not None}
_QGIS_TYPES = {
    Qgis.DataType.Byte: "|u1",
    Qgis.DataType.UInt16: "<u2",
    Qgis.DataType.Int16: "<i2",
    Qgis.DataType.UInt32: "<u4",
    Qgis.DataType.Int32: "<i4",
    Qgis.DataType.Float32: "<f4",
    Qgis.DataType.Float64: "<f8",
}
if hasattr(Qgis.DataType, "Int8"):
    _QGIS_TYPES[Qgis.DataType.Int8] = "|i1"

#: Lossless compressions, which the output takes over from the input.
_LOSSLESS = {"LZW", "DEFLATE", "PACKBITS", "ZSTD", "LZMA"}


@dataclass(frozen=True)
class RasterInput:
    """What must be taken from a raster layer in the main thread, to be read in another.

    Attributes
    ----------
    name : str
        Of the layer, for messages.
    band : int
        Counted from 1.
    crs : QgsCoordinateReferenceSystem
    path : str or None
        What GDAL opens, for layers of its provider.
    provider : QgsRasterDataProvider
        A clone that the other thread may use.
    uses_nodata : bool
        Whether the layer's own nodata value counts, as set in the layer's properties.
    hidden : list of (float, float, bool, bool)
        Further ranges that the layer's properties declare nodata: from, to, and whether each end
        belongs to it.
    """

    name: str
    band: int
    crs: QgsCoordinateReferenceSystem
    path: str | None
    provider: QgsRasterDataProvider
    uses_nodata: bool
    hidden: list[tuple[float, float, bool, bool]]

    @classmethod
    def from_layer(cls, layer: QgsRasterLayer, band: int) -> RasterInput:
        """Return the input of a layer; call it in the thread that the layer lives in."""
        provider: Any = layer.dataProvider()  # of a valid layer, there is one
        hidden = [
            (item.min(), item.max(), *_closed_ends(item.bounds()))
            for item in provider.userNoDataValues(band)
        ]
        is_gdal = layer.providerType() == "gdal"
        return cls(
            name=layer.name(),
            band=band,
            crs=layer.crs(),
            path=provider.dataSourceUri() if is_gdal else None,
            provider=provider.clone(),
            uses_nodata=not provider.sourceHasNoDataValue(band)
            or provider.useSourceNoDataValue(band),
            hidden=hidden,
        )

    def vertical_unit(self) -> str | None:
        """Return the unit of elevation that the band names, or None."""
        from .crs_and_progress import known_unit

        if self.path is None:
            return None
        with without_exceptions(gdal, partial(_unreadable, self)):
            dataset = opened(gdal, self.path)
            return known_unit(dataset.GetRasterBand(self.band).GetUnitType()) if dataset else None


def read_dem(raster: RasterInput, feedback: QgsFeedback) -> Dem:
    """Return the layer's band as a ``Dem``.

    Raises
    ------
    QgsProcessingException
        No such band, a band of complex numbers, or a source that cannot be read.
    Cancelled
    """
    dem = None
    _require_band(raster)
    if raster.path is not None:
        with without_exceptions(gdal, partial(_unreadable, raster)):
            dem = _read_with_gdal(raster, raster.path, feedback)
    if dem is None:
        dem = _read_with_qgis(raster, feedback)
    return dem


def grid_of(raster: RasterInput, path: str) -> GridGeometry:
    """Return all cells of a raster file.

    Raises
    ------
    QgsProcessingException
        It cannot be read.
    """
    from wavelet_gis.model.dem import GridGeometry

    with without_exceptions(gdal, partial(_unreadable, raster)):
        dataset = opened(gdal, path)
        if dataset is None:
            raise _unreadable(raster, gdal.GetLastErrorMsg())
        return GridGeometry((dataset.RasterYSize, dataset.RasterXSize), _transform(dataset))


def read_window(raster: RasterInput, path: str, window: CellWindow, feedback: Stoppable) -> Dem:
    """Return some cells of a raster file, as `read_dem` returns all of them.

    Raises
    ------
    QgsProcessingException
        No such band, or a file that cannot be read.
    Cancelled
    """
    _require_band(raster)
    with without_exceptions(gdal, partial(_unreadable, raster)):
        dem = _read_with_gdal(raster, path, feedback, window)
    if dem is None:
        raise _unreadable(raster, gdal.GetLastErrorMsg())
    return dem


def _read_with_gdal(
    raster: RasterInput, path: str, feedback: Stoppable, window: CellWindow | None = None
) -> Dem | None:
    """Return the ``Dem``, or None where GDAL cannot open what its provider opened."""
    from wavelet_gis.model.dem import Dem, GridGeometry

    dataset = opened(gdal, path)
    if dataset is None or dataset.RasterCount < raster.band:
        return None
    band = dataset.GetRasterBand(raster.band)
    dtype = _NUMPY_TYPES.get(band.DataType)
    if dtype is None:
        raise _unusable_type(raster, gdal.GetDataTypeName(band.DataType))
    whole = GridGeometry((dataset.RasterYSize, dataset.RasterXSize), _transform(dataset))
    row, column, n_rows, n_columns = window or (0, 0, *whole.shape)
    mask_band = band.GetMaskBand()
    values = np.empty((n_rows, n_columns), dtype=dtype)
    valid = np.ones((n_rows, n_columns), dtype=bool)
    for start, stop in strips(n_rows, n_columns, feedback):
        strip = (column, row + start, n_columns, stop - start)
        values[start:stop] = _array(band.ReadRaster(*strip), dtype, n_columns, raster)
        if raster.uses_nodata:
            mask = mask_band.ReadRaster(*strip, buf_type=gdal.GDT_Byte)
            valid[start:stop] = _array(mask, np.dtype("u1"), n_columns, raster) != 0
    nodata = band.GetNoDataValue()
    scale, offset = band.GetScale(), band.GetOffset()
    dem = Dem(
        values=values,
        valid=valid,
        geometry=whole.window(row, column, (n_rows, n_columns)),
        nodata=_as_stored(nodata, dtype),
        scale=1.0 if scale is None else float(scale),
        offset=0.0 if offset is None else float(offset),
        profile=_profile(dataset, band),
    )
    return _with_holes(dem, raster)


def _transform(dataset: Any) -> tuple[float, float, float, float, float, float]:
    c, a, b, f, d, e = dataset.GetGeoTransform()
    return a, b, c, d, e, f


def _read_with_qgis(raster: RasterInput, feedback: QgsFeedback) -> Dem:
    from wavelet_core.errors import Cancelled
    from wavelet_gis.model.dem import Dem, GridGeometry

    provider, band = raster.provider, raster.band
    n_rows, n_columns = provider.ySize(), provider.xSize()
    code = _QGIS_TYPES.get(provider.dataType(band))
    if code is None or n_rows == 0 or n_columns == 0:
        raise _unusable_type(raster, str(provider.dataType(band)))
    dtype = np.dtype(code)
    values = np.zeros((n_rows, n_columns), dtype=dtype)
    extent = provider.extent()
    iterator = QgsRasterIterator(provider)
    iterator.startRasterRead(band, n_columns, n_rows, extent)
    while True:
        if feedback.isCanceled():
            raise Cancelled("cancelled while reading the raster")
        is_part, width, height, block, left, top = iterator.readNextRasterPart(band)
        if not is_part or block is None:
            break
        part = np.frombuffer(block.data().data(), dtype=dtype).reshape(height, width)
        values[top : top + height, left : left + width] = part
    has_nodata = provider.sourceHasNoDataValue(band) and raster.uses_nodata
    nodata = _as_stored(provider.sourceNoDataValue(band), dtype) if has_nodata else None
    valid = np.ones(values.shape, dtype=bool)
    if nodata is not None and not math.isnan(nodata):
        valid = values != dtype.type(nodata)
    transform = (
        extent.width() / n_columns,
        0.0,
        extent.xMinimum(),
        0.0,
        -extent.height() / n_rows,
        extent.yMaximum(),
    )
    geometry = GridGeometry((n_rows, n_columns), transform)
    return _with_holes(Dem(values, valid, geometry, nodata), raster)


def _with_holes(dem: Dem, raster: RasterInput) -> Dem:
    """Mark what the layer's properties hide, and whatever can be no elevation, as holes."""
    from wavelet_gis.io.raster.nodata import implausible_cells, warn_of_doubts

    if dem.values.dtype.kind == "f":
        dem.valid[...] &= np.isfinite(dem.values)
    for low, high, has_low, has_high in raster.hidden:
        above = dem.values >= low if has_low else dem.values > low
        below = dem.values <= high if has_high else dem.values < high
        dem.valid[...] &= ~(above & below)
    if raster.uses_nodata:
        dem.valid[...] &= ~implausible_cells(dem.values, dem.valid, raster.name)
    warn_of_doubts(dem.values[dem.valid], raster.name)
    return dem


def strips(
    n_rows: int,
    n_columns: int,
    feedback: Stoppable,
    cells: int = STRIP_CELLS,
    block_rows: int = 1,
) -> Iterator[tuple[int, int]]:
    """Yield ``(start, stop)`` rows of whole blocks, with a look at the cancel button before each.

    Each is of about so many cells.
    """
    from wavelet_core.errors import Cancelled

    height = max(cells // max(n_columns * block_rows, 1), 1) * block_rows
    for start in range(0, n_rows, height):
        if feedback.isCanceled():
            raise Cancelled("cancelled between two strips of the raster")
        yield start, min(start + height, n_rows)


def _array(raw: Any, dtype: np.dtype[Any], n_columns: int, raster: RasterInput) -> NDArray[Any]:
    if raw is None:
        raise _unreadable(raster, gdal.GetLastErrorMsg())
    return np.frombuffer(raw, dtype=dtype).reshape(-1, n_columns)


def _as_stored(nodata: float | None, dtype: np.dtype[Any]) -> float | int | None:
    """Return the nodata value as the band's own type holds it, or None where it cannot."""
    if nodata is None:
        return None
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        return int(nodata) if nodata == int(nodata) and limits.min <= nodata <= limits.max else None
    return float(nodata)


def _profile(dataset: Any, band: Any) -> dict[str, Any]:
    """Return what the writer may take over, JSON-able, named as in ``wavelet_gis.io.raster``."""
    structure = dataset.GetMetadata("IMAGE_STRUCTURE")
    options: dict[str, Any] = {}
    compression = structure.get("COMPRESSION", "")
    if compression in _LOSSLESS:
        options["compress"] = compression.lower()
        if "PREDICTOR" in structure:
            options["predictor"] = int(structure["PREDICTOR"])
    width, height = band.GetBlockSize()
    if width != dataset.RasterXSize and width % 16 == 0 and height % 16 == 0:
        options.update(tiled=True, blockxsize=width, blockysize=height)
    return {
        "driver": dataset.GetDriver().ShortName,
        "options": options,
        "tags": dict(dataset.GetMetadata()),
        "band": band.GetBand(),
        "unit": band.GetUnitType(),
    }


def _closed_ends(bounds: QgsRasterRange.BoundsType) -> tuple[bool, bool]:
    """Return whether the lower and the upper end belong to a range of values."""
    kinds = QgsRasterRange.BoundsType
    has_low = bounds in (kinds.IncludeMinAndMax, kinds.IncludeMin)
    return has_low, bounds in (kinds.IncludeMinAndMax, kinds.IncludeMax)


def _require_band(raster: RasterInput) -> None:
    n_bands = raster.provider.bandCount()
    if not 1 <= raster.band <= n_bands:
        raise QgsProcessingException(
            tr("{}: there is no band {}; the raster has {}.").format(
                raster.name, raster.band, n_bands
            )
        )


def _unreadable(raster: RasterInput, reason: str) -> QgsProcessingException:
    return QgsProcessingException(
        tr("{}: the raster cannot be read ({}); the file is damaged, get it again.").format(
            raster.name, reason
        )
    )


def _unusable_type(raster: RasterInput, type_name: str) -> QgsProcessingException:
    return QgsProcessingException(
        tr("{}: band {} holds values of type {}; elevations must be real numbers.").format(
            raster.name, raster.band, type_name
        )
    )
