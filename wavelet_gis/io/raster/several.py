"""Several rasters as one DEM."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wavelet_gis.crs.agreement import agreed
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.io.raster.mosaic import mosaic
from wavelet_gis.io.raster.raster_reader import read_dem
from wavelet_gis.model.dem import Dem

__all__ = ["read_dems"]


def read_dems(
    paths: Sequence[str], *, any_crs: bool = False, any_unit: bool = False, **options: Any
) -> tuple[Dem, Georeference]:
    """Return the DEM that several rasters are parts of, and its georeference.

    Parameters
    ----------
    paths : sequence of str
        Two or more. Where they overlap the first with data counts; it also gives the profile.
    any_crs, any_unit : bool
        Whether the CRS, or the unit of z, is given otherwise and need not agree.
    **options
        See `wavelet_gis.io.raster.read_dem`.

    Raises
    ------
    InputFileError
        A file that cannot be read or is of another grid than the first.
    """
    read = [read_dem(path, **options) for path in paths]
    dem = mosaic(paths, [dem for dem, _ in read])
    places = [place for _, place in read]
    return dem, agreed(paths, places, any_crs=any_crs, any_unit=any_unit)
