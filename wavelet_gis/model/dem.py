"""A DEM as arrays, and its mesh.

Nothing here opens a file: `wavelet_gis.io.raster` does so with rasterio, QGIS with its own classes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.errors import InputFileError

__all__ = [
    "SAME_AS_NODATA",
    "Dem",
    "GridGeometry",
    "InputGrid",
    "cell_plan",
    "dem_mesh",
    "grid_bounds",
    "require_sound",
    "taken_for_nodata",
]

#: Elevations beyond this, in any unit, leave no digits for geometry.
LARGEST_ELEVATION = 1e30

#: And no place is farther from the origin of a CRS.
LARGEST_COORDINATE = 1e15

#: Floats that differ from the nodata value by no more than this part of it are nodata to GDAL, four
#: steps of single precision, whatever the precision of the raster.
SAME_AS_NODATA = 5e-7


@dataclass(frozen=True, slots=True)
class GridGeometry:
    """Where the cells of a raster lie.

    Attributes
    ----------
    shape : (n_rows, n_columns)
        Size.
    transform : (a, b, c, d, e, f)
        ``x = a column + b row + c`` and ``y = d column + e row + f``, where (0, 0) is the outer
        corner of the first cell and its centre is at (0.5, 0.5). Any regular affine map:
        north-up, south-up, rotated.
    """

    shape: tuple[int, int]
    transform: tuple[float, float, float, float, float, float]

    @property
    def is_axis_aligned(self) -> bool:
        """Whether rows run along x and columns along y."""
        return self.transform[1] == 0.0 and self.transform[3] == 0.0

    @property
    def fault(self) -> str:
        """What is wrong with the transform; empty when it places every cell apart."""
        a, b, _, d, e, _ = self.transform
        if not all(math.isfinite(value) for value in self.transform):
            return "holds numbers that are not finite"
        # A map of the plane onto a line but for rounding is no better than an exact one.
        if abs(a * e - b * d) <= 1e-12 * (abs(a * e) + abs(b * d)):
            return "maps all cells onto a line"
        x_min, y_min, x_max, y_max = grid_bounds(self)
        step = min(max(abs(a), abs(d)), max(abs(b), abs(e)))
        reach = max(abs(x_min), abs(y_min), abs(x_max), abs(y_max))
        if not math.isfinite(reach) or reach > LARGEST_COORDINATE or step < 1e-12 * reach:
            return "has cells too small or too far away to be told apart"
        return ""

    def window(self, row: int, column: int, shape: tuple[int, int]) -> GridGeometry:
        """Return the grid of so many rows and columns that begins at one of the cells.

        Parameters
        ----------
        row, column : int
            Of its first cell, which may lie outside.
        shape : (n_rows, n_columns)
            Its size.
        """
        a, b, c, d, e, f = self.transform
        x, y = c + a * column + b * row, f + d * column + e * row
        return GridGeometry(shape, (a, b, x, d, e, y))

    def centres(
        self, columns: NDArray[Any], rows: NDArray[Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x and y of the centres of cells."""
        a, b, c, d, e, f = self.transform
        u, v = columns + 0.5, rows + 0.5
        return a * u + b * v + c, d * u + e * v + f

    def cells(
        self, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return fractional columns and rows of positions; whole numbers are cell centres."""
        a, b, c, d, e, f = self.transform
        determinant = a * e - b * d
        east, north = x - c, y - f
        columns = (e * east - b * north) / determinant - 0.5
        rows = (a * north - d * east) / determinant - 0.5
        return columns, rows


@dataclass(frozen=True, slots=True)
class Dem:
    """One band of elevations, as it came.

    Attributes
    ----------
    values : (n_rows, n_columns), any integer or float type
        The stored numbers.
    valid : (n_rows, n_columns) bool
        Which of them are elevations; the others are holes.
    geometry : GridGeometry
        Where the cells are.
    nodata : int, float or None
        The tag, NaN included.
    scale, offset : float
        An elevation is ``value * scale + offset`` (both usually 1 and 0).
    profile : dict
        JSON-able hints for the writer: driver, compression, tiling, tags.
    """

    values: NDArray[Any]
    valid: NDArray[np.bool_]
    geometry: GridGeometry
    nodata: float | int | None = None
    scale: float = 1.0
    offset: float = 0.0
    profile: dict[str, Any] = field(default_factory=dict)

    def elevations(self) -> NDArray[np.float64]:
        """Return the elevations of the valid cells, in row-major order."""
        values = self.values[self.valid].astype(np.float64)
        if self.scale != 1.0 or self.offset != 0.0:
            values = values * self.scale + self.offset
        return values


class InputGrid(NamedTuple):
    """The grid that a pyramid was made from, each of whose cells with data is a vertex.

    geometry : GridGeometry
    valid : (n_rows, n_columns) bool, the cells with data; the i-th of them is vertex i
    dtype : numpy dtype of the stored numbers
    nodata : int, float or None
    is_scaled : bool, whether the stored numbers are no elevations but have a scale and an offset
    """

    geometry: GridGeometry
    valid: NDArray[np.bool_]
    dtype: np.dtype[Any]
    nodata: float | int | None
    is_scaled: bool = False


def require_sound(dem: Dem, name: str) -> None:
    """Refuse a DEM of which no pyramid could be restored.

    Parameters
    ----------
    dem : Dem
        As it came.
    name : str
        Of the file, for messages.

    Raises
    ------
    InputFileError
        A transform that does not place the cells, a scale of 0, a scale or offset that is not
        finite, or elevations beyond all measure.
    """
    fault = dem.geometry.fault
    if fault:
        raise InputFileError(
            f"{name}: the geotransform {dem.geometry.transform} {fault}; georeference the raster "
            "first (gdal_translate -a_ullr)."
        )
    if not (math.isfinite(dem.scale) and math.isfinite(dem.offset)) or dem.scale == 0.0:
        raise InputFileError(
            f"{name}: the band has the scale {dem.scale} and the offset {dem.offset}, which give "
            "no elevations; set them right first (gdal_edit.py -scale 1 -offset 0)."
        )
    if not dem.valid.any():
        return
    values = dem.values[dem.valid]
    for raw in (float(values.min()), float(values.max())):
        elevation = raw * dem.scale + dem.offset
        if not abs(elevation) < LARGEST_ELEVATION:
            raise InputFileError(
                "{name}: an elevation is {elevation:.4g}; name the nodata value ({0} {raw!r}), or "
                "set scale and offset of the band right.",
                "nodata",
                name=name,
                elevation=elevation,
                raw=raw,
            )


def dem_mesh(dem: Dem, frame: LocalFrame) -> TriangleMesh:
    """Return the grid triangulation of a DEM, a vertex at each valid cell centre.

    Parameters
    ----------
    dem : Dem
        In the file's coordinates.
    frame : LocalFrame
        From `wavelet_gis.crs.frame.working_frame`.

    Raises
    ------
    InputFileError
        When there is no cell with data.
    """
    if not dem.valid.any():
        raise InputFileError(
            "every cell of the raster is nodata; check the band and the nodata value."
        )
    n_rows, n_columns = dem.geometry.shape
    elevation = np.zeros(dem.geometry.shape)
    elevation[dem.valid] = frame.local_z(dem.elevations())
    columns = np.arange(n_columns, dtype=np.float64)
    rows = np.arange(n_rows, dtype=np.float64)
    if dem.geometry.is_axis_aligned:
        a, _, c, _, e, f = dem.geometry.transform
        x = frame.local_x(a * (columns + 0.5) + c)
        y = frame.local_y(e * (rows + 0.5) + f)
        return TriangleMesh.from_grid(elevation, x, y, valid=dem.valid)
    # A rotated grid has the triangles of an upright one; only its vertices lie elsewhere.
    upright = TriangleMesh.from_grid(elevation, columns, rows, valid=dem.valid)
    x, y = dem.geometry.centres(upright.vertices[:, 0], upright.vertices[:, 1])
    vertices = np.column_stack([frame.local_x(x), frame.local_y(y), upright.vertices[:, 2]])
    return TriangleMesh.from_triangles(vertices, upright.faces)


def cell_plan(
    geometry: GridGeometry,
    valid: NDArray[np.bool_],
    frame: LocalFrame,
    ids: NDArray[np.integer],
) -> NDArray[np.float64]:
    """Return x and y, in the working frame, of some vertices of the mesh of `dem_mesh`.

    Parameters
    ----------
    geometry : GridGeometry
    valid : (n_rows, n_columns) bool
        The cells with data; the i-th of them is vertex i.
    frame : LocalFrame
    ids : (n,) integers
        Vertices.
    """
    rows, columns = np.divmod(np.flatnonzero(valid)[ids], geometry.shape[1])
    if geometry.is_axis_aligned:
        a, _, c, _, e, f = geometry.transform
        x = a * (columns.astype(np.float64) + 0.5) + c
        y = e * (rows.astype(np.float64) + 0.5) + f
    else:
        x, y = geometry.centres(columns.astype(np.float64), rows.astype(np.float64))
    return np.column_stack([frame.local_x(x), frame.local_y(y)])


def grid_bounds(geometry: GridGeometry) -> tuple[float, float, float, float]:
    """Return x_min, y_min, x_max, y_max of the raster's corners."""
    n_rows, n_columns = geometry.shape
    columns = np.array([0, n_columns, n_columns, 0]) - 0.5
    rows = np.array([0, 0, n_rows, n_rows]) - 0.5
    x, y = geometry.centres(columns, rows)
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def taken_for_nodata(values: NDArray[Any], nodata: float | int) -> NDArray[np.bool_]:
    """Return which numbers GDAL takes for a nodata value: for floats the next few, too."""
    if values.dtype.kind != "f" or not math.isfinite(nodata):
        return np.asarray(values == nodata)
    apart = np.abs(np.subtract(values, nodata, dtype=np.float64))
    return np.asarray(apart <= SAME_AS_NODATA * abs(nodata))
