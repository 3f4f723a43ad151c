"""The surface of a level less that of another level, or less a DEM."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.crs.frame import VERTICAL_UNITS, Georeference, vertical_unit_name
from wavelet_gis.errors import CrsError, InputFileError
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.lone_vertices import fill_lone_cells
from wavelet_gis.products.rasterise import rasterise
from wavelet_gis.products.vertex_raster import grid_of
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of
from wavelet_gis.workflows.read_off.levels import checked_levels

__all__ = ["Difference", "difference"]

#: Units of height that differ by less than this part of one are taken for the same.
SAME_UNIT = 1e-5


@dataclass(frozen=True, slots=True)
class Difference:
    """A raster of differences in height.

    Attributes
    ----------
    geo : GeoPyramid
        Gives the CRS and the unit of z.
    dem : Dem
        32-bit floats; NaN where one of the two has nothing.
    """

    geo: GeoPyramid
    dem: Dem

    def write(self, path: str | os.PathLike[str]) -> dict[str, Any]:
        """Write a raster; see `wavelet_gis.workflows.save.save`."""
        from wavelet_gis.io.raster import write_dem

        write_dem(path, self.dem, self.geo.system.wkt)
        return {}

    def figures(self) -> dict[str, Any]:
        """Return the figures of all cells, in the input's unit of z."""
        values = self.dem.values[self.dem.valid].astype(np.float64)
        return {
            "n_cells": len(values),
            "mean": float(values.mean()),
            "rms": float(np.sqrt((values**2).mean())),
            "lowest": float(values.min()),
            "highest": float(values.max()),
        }


def difference(
    data: HoldsPyramid | GeoPyramid,
    *,
    level: int = 0,
    less: int | str | os.PathLike[str] | Dem | None = None,
    cell_size: float | None = None,
) -> Difference:
    """Return the surface of a level less another one: above 0 where the level is the higher.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    level : int
        0, the default, is the coarsest.
    less : int, path or Dem, optional
        Another level, or a DEM in the CRS and unit of the input; by default the input itself.
    cell_size : float, optional
        Of a grid, in the input's unit of x and y; by default that of the input, and for points
        their mean spacing. A DEM has its own.

    Raises
    ------
    OptionError
        A level that is not there, or a cell size beside a DEM.
    InputFileError
        A DEM that cannot be read, has another CRS or unit of height, or lies beside the terrain.
    """
    geo = pyramid_of(data)
    checked_levels(geo, [level])
    mesh = geo.pyramid.mesh(level)
    if less is None or isinstance(less, int | np.integer):
        other = checked_levels(geo, [geo.pyramid.n_levels if less is None else less])[0]
        subtrahend = geo.pyramid.mesh(other)
        geometry = grid_of(geo, subtrahend if other > level else mesh, cell_size)
        there = _on_grid(geo, subtrahend, geometry)
    else:
        if cell_size is not None:
            raise OptionError("{0} is not for a DEM, which has its own; leave it out.", "cell_size")
        dem = less if isinstance(less, Dem) else _read(geo, less)
        geometry = dem.geometry
        there = np.full(geometry.shape, np.nan)
        there[dem.valid] = dem.elevations()
    values = (_on_grid(geo, mesh, geometry) - there).astype(np.float32)
    valid = np.isfinite(values)
    if not valid.any():
        raise InputFileError(
            "{name}: no cell has a height of both; check that they overlap.", name=geo.source_name
        )
    profile = {"options": {"compress": "deflate", "predictor": 3, "tiled": True}}
    return Difference(geo, Dem(values, valid, geometry, float("nan"), profile=profile))


def _on_grid(geo: GeoPyramid, mesh: TriangleMesh, geometry: GridGeometry) -> NDArray[np.float64]:
    """Return the heights of a surface at the centres of cells, and of cells by themselves."""
    in_file = geo.file_mesh(mesh)
    return fill_lone_cells(rasterise(in_file, geometry), in_file, geometry)


def _read(geo: GeoPyramid, path: str | os.PathLike[str]) -> Dem:
    from wavelet_gis.crs.agreement import agreed
    from wavelet_gis.io.raster import read_dem

    dem, place = read_dem(path)
    name = os.fspath(path)
    own = Georeference(wkt=geo.system.wkt, vertical_unit=place.vertical_unit)
    agreed([geo.source_name, name], [own, place])
    _require_unit(geo, name, place.vertical_unit)
    return dem


def _require_unit(geo: GeoPyramid, name: str, unit: str | None) -> None:
    """Refuse a DEM that names another length for its heights than the pyramid has."""
    try:
        here = VERTICAL_UNITS.get(vertical_unit_name(unit)) if unit else None
    except CrsError:  # no length that we know, so nothing is claimed
        here = None
    there = VERTICAL_UNITS.get(geo.vertical_unit)
    # Two kinds of foot differ by less than heights are known to.
    if here is not None and there is not None and abs(here / there - 1.0) > SAME_UNIT:
        raise InputFileError(
            f"{name}: its heights are in {unit}, those of {geo.source_name} in "
            f"{geo.vertical_unit}; convert one of them first."
        )
