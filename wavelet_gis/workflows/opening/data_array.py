"""The terrain in an xarray DataArray."""

from __future__ import annotations

from typing import Any

import numpy as np

from wavelet_core.errors import OptionError
from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.model.terrain import Terrain, terrain_of_dem

__all__ = ["terrain_of_data_array"]

#: How far cells may be from even spacing, in parts of one; single precision leaves that much.
EVEN_SPACING = 1e-3


def terrain_of_data_array(array: Any, system: CoordinateSystem | None, unit: str | None) -> Terrain:
    """Return the terrain in an xarray DataArray with two evenly spaced coordinates.

    Parameters
    ----------
    array : DataArray
        Its CRS and nodata as rioxarray and CF keep them.
    system, unit
        Instead of what the array says.

    Raises
    ------
    OptionError
        Other dimensions than two, named x and y, or uneven spacing.
    """
    flat = array.squeeze()
    if len(flat.dims) != 2:
        raise OptionError(
            f"the DataArray has the dimensions {', '.join(map(str, array.dims))}; choose two, such "
            "as array.sel(band=1)."
        )
    across = [dim for dim in flat.dims if str(dim).lower() in ("x", "lon", "longitude", "easting")]
    if len(across) != 1:
        raise OptionError(
            f"the DataArray has the dimensions {', '.join(map(str, flat.dims))}; call them y and x."
        )
    x_dim = across[0]
    y_dim = next(dim for dim in flat.dims if dim != x_dim)
    flat = flat.transpose(y_dim, x_dim)
    x0, dx = _even_spacing(str(x_dim), flat.coords[x_dim].values)
    y0, dy = _even_spacing(str(y_dim), flat.coords[y_dim].values)
    values = np.ascontiguousarray(flat.values)
    nodata = _nodata_of(array)
    valid = np.isfinite(values) if values.dtype.kind == "f" else np.ones(values.shape, dtype=bool)
    if nodata is not None:
        valid &= values != nodata
    geometry = GridGeometry(
        (values.shape[0], values.shape[1]), (dx, 0.0, x0 - dx / 2, 0.0, dy, y0 - dy / 2)
    )
    name = str(array.name or "DataArray")
    return terrain_of_dem(
        name, Dem(values, valid, geometry, nodata), system or _system_of_array(array), unit
    )


def _even_spacing(name: str, values: Any) -> tuple[float, float]:
    centres = np.asarray(values, dtype=np.float64)
    if len(centres) < 2:
        raise OptionError(f"the coordinate {name} has {len(centres)} value; a surface needs two.")
    step = (centres[-1] - centres[0]) / (len(centres) - 1)
    if step == 0 or np.abs(np.diff(centres) - step).max() > EVEN_SPACING * abs(step):
        raise OptionError(f"the coordinate {name} is not evenly spaced; interpolate it first.")
    return float(centres[0]), float(step)


def _nodata_of(array: Any) -> Any:
    for holder in (array.attrs, getattr(array, "encoding", {})):
        for key in ("_FillValue", "nodata", "missing_value"):
            if holder.get(key) is not None:
                return np.asarray(holder[key]).item()
    return None


def _system_of_array(array: Any) -> CoordinateSystem:
    """Return the CRS as rioxarray and CF keep it: in the attributes of a coordinate."""
    from wavelet_gis.crs.lookup import coordinate_system

    mapping = array.attrs.get("grid_mapping") or array.encoding.get("grid_mapping", "spatial_ref")
    if mapping in array.coords:
        attributes = array.coords[mapping].attrs
        return coordinate_system(attributes.get("crs_wkt") or attributes.get("spatial_ref"))
    crs = array.attrs.get("crs")
    return coordinate_system(None if crs is None else str(crs))
