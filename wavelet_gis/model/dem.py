"""A DEM as arrays: raster to mesh, and back to the very bits that came in.

Nothing here opens a file: `wavelet_gis.io.raster` does so with rasterio, QGIS with its own classes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import PyramidError
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.exact_restore import (
    CORRECTIONS,
    ExactColumn,
    KeptColumn,
    checksum,
    column_from_parts,
    kept_column,
    nearest_of_dtype,
    number_dtype,
    require_checksum,
)

__all__ = [
    "Dem",
    "GridGeometry",
    "InputGrid",
    "RasterOrigin",
    "cell_plan",
    "dem_mesh",
    "grid_bounds",
    "require_sound",
]

#: Elevations beyond this, in any unit, leave no digits for geometry.
LARGEST_ELEVATION = 1e30

#: And no place is further from the origin of a CRS.
LARGEST_COORDINATE = 1e15

#: Rows or columns; GDAL knows no larger rasters.
_LARGEST_SIDE = 2**31 - 1


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


@dataclass(frozen=True, slots=True)
class RasterOrigin:
    """How a pyramid's finest mesh becomes the DEM it was made from.

    Attributes
    ----------
    geometry, nodata, scale, offset, profile
        Of the DEM; see `Dem`.
    valid : (n_rows, n_columns) bool
        Its cells with data; the i-th of them is vertex i.
    holes : (n_holes,) of the DEM's type
        The numbers that were stored in the other cells.
    corrections : KeptColumn, ExactColumn or None
        What gives the numbers of the valid cells back to the bit; None once the pyramid has been
        altered (filtered).
    checksum : str
        SHA-256 of the DEM's numbers.
    """

    geometry: GridGeometry
    nodata: float | int | None
    scale: float
    offset: float
    profile: dict[str, Any]
    dtype: np.dtype[Any]
    valid: NDArray[np.bool_]
    holes: NDArray[Any]
    corrections: KeptColumn | ExactColumn | None
    checksum: str

    kind = "raster"
    noun = "raster"
    points = None

    @classmethod
    def from_dem(cls, dem: Dem) -> RasterOrigin:
        """Return the origin of a DEM, before there is a pyramid (and so without corrections)."""
        return cls(
            geometry=dem.geometry,
            nodata=dem.nodata,
            scale=dem.scale,
            offset=dem.offset,
            profile=dem.profile,
            dtype=dem.values.dtype.newbyteorder("<"),
            valid=dem.valid,
            holes=dem.values[~dem.valid],
            corrections=None,
            checksum=checksum([dem.values]),
        )

    def with_corrections(self, dem: Dem, mesh: TriangleMesh, frame: LocalFrame) -> RasterOrigin:
        """Return the origin that gives `dem` back exactly from the synthesised `mesh`."""
        approximate = self._values(mesh, frame)
        return replace(self, corrections=kept_column(dem.values[dem.valid], approximate))

    def altered(self) -> RasterOrigin:
        """Return the origin for a pyramid whose coefficients have been changed."""
        return replace(self, corrections=None)

    @property
    def is_exact(self) -> bool:
        """Whether the original comes back bit for bit."""
        return self.corrections is not None

    @property
    def n_vertices(self) -> int:
        """Number of valid cells."""
        return int(np.count_nonzero(self.valid))

    @property
    def grid(self) -> InputGrid:
        """The grid that came in."""
        is_scaled = (self.scale, self.offset) != (1.0, 0.0)
        return InputGrid(self.geometry, self.valid, self.dtype, self.nodata, is_scaled)

    def kept_mesh(
        self, frame: LocalFrame, faces: NDArray[np.int32] | None = None
    ) -> TriangleMesh | None:
        """Return the mesh that was analysed, to the bit; None where it is not kept.

        Parameters
        ----------
        frame : LocalFrame
        faces : (n_faces, 3) int32, optional
            Instead of those of the grid.
        """
        if not isinstance(self.corrections, KeptColumn):
            return None
        n_vertices = self.n_vertices
        if len(self.corrections.values) != n_vertices:
            raise PyramidError(
                "the raster's mask does not match its numbers; analyse the input anew."
            )
        dem = self._dem(self.corrections.values)
        if faces is None:
            return dem_mesh(dem, frame)
        plan = cell_plan(self.geometry, self.valid, frame, np.arange(n_vertices))
        return TriangleMesh(np.column_stack([plan, frame.local_z(dem.elevations())]), faces)

    def restore(self, mesh: TriangleMesh, frame: LocalFrame) -> Dem:
        """Return the DEM of the finest mesh of a pyramid.

        Raises
        ------
        PyramidError
            When the mesh has not one vertex for each valid cell, or the exact original was due
            and the result's checksum is another.
        """
        if mesh.n_vertices != self.n_vertices:
            raise PyramidError(
                f"the mesh has {mesh.n_vertices} vertices for {self.n_vertices} cells with data; "
                "only the finest level can be turned back into the raster."
            )
        approximate = self._values(mesh, frame)
        if self.corrections is None:
            return self._dem(
                _avoiding_nodata(nearest_of_dtype(approximate, self.dtype), self.nodata)
            )
        dem = self._dem(self.corrections.restore(approximate))
        require_checksum([dem.values], self.checksum)
        return dem

    def _dem(self, of_valid: NDArray[Any]) -> Dem:
        values = np.empty(self.geometry.shape, dtype=self.dtype)
        values[~self.valid] = self.holes
        values[self.valid] = of_valid
        return Dem(
            values, self.valid, self.geometry, self.nodata, self.scale, self.offset, self.profile
        )

    def _values(self, mesh: TriangleMesh, frame: LocalFrame) -> NDArray[np.float64]:
        elevations = frame.file_z(mesh.vertices[:, 2])
        if self.scale == 1.0 and self.offset == 0.0:
            return elevations
        return (elevations - self.offset) / self.scale

    def to_parts(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return JSON-able fields, and arrays by name."""
        fields: dict[str, Any] = {
            "kind": self.kind,
            "shape": list(self.geometry.shape),
            "transform": list(self.geometry.transform),
            "nodata": None if self.nodata is None else repr(self.nodata),
            "scale": self.scale,
            "offset": self.offset,
            "profile": self.profile,
            "dtype": self.dtype.str,
            "checksum": self.checksum,
        }
        arrays: dict[str, NDArray[Any]] = {
            "source/valid": np.packbits(self.valid.reshape(-1)),
            "source/holes": self.holes,
        }
        if self.corrections is not None:
            described, correction_arrays = self.corrections.to_parts(f"source/{CORRECTIONS}")
            fields[CORRECTIONS] = described
            arrays.update(correction_arrays)
        return fields, arrays

    @classmethod
    def from_parts(cls, fields: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> RasterOrigin:
        """Return the origin that `to_parts` described, every claim checked.

        Raises
        ------
        PyramidError
            When a part is missing, of another type, or does not fit the rest.
        """
        stored = Fields(fields, "the raster")
        try:
            n_rows, n_columns = stored.integers("shape", 1, _LARGEST_SIDE)
            transform = tuple(stored.numbers("transform", 6))
            dtype = number_dtype(stored.text("dtype"))
            packed, holes = arrays["source/valid"], arrays["source/holes"]
            nodata = _number(stored.text_or_none("nodata", 40))
            scale, offset = stored.number("scale"), stored.number("offset")
            profile, digest = dict(stored.fields("profile")), stored.text("checksum", 200)
        except (KeyError, TypeError, ValueError) as error:
            raise PyramidError(
                f"the description of the raster is damaged ({error}); analyse the input anew."
            ) from error
        n_cells = n_rows * n_columns
        sound = (
            packed.ndim == holes.ndim == 1
            and packed.dtype == np.uint8
            and len(packed) == -(-n_cells // 8)
            and transform[0] * transform[4] != transform[1] * transform[3]
            and scale != 0.0
        )
        if not sound:
            raise PyramidError("the description of the raster is damaged; analyse the input anew.")
        valid = np.unpackbits(packed, count=n_cells).astype(bool).reshape(n_rows, n_columns)
        if len(holes) != n_cells - np.count_nonzero(valid) or holes.dtype != dtype:
            raise PyramidError("the holes of the raster do not fit its mask; analyse it anew.")
        corrections = None
        if CORRECTIONS in fields:
            described = fields[CORRECTIONS]
            corrections = column_from_parts(f"source/{CORRECTIONS}", described, arrays)
            if corrections.dtype != dtype:
                raise PyramidError(
                    "the raster's corrections have another data type; analyse it anew."
                )
        geometry = GridGeometry((n_rows, n_columns), transform)  # type: ignore[arg-type]
        return cls(
            geometry, nodata, scale, offset, profile, dtype, valid, holes, corrections, digest
        )


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


def _avoiding_nodata(values: NDArray[Any], nodata: float | int | None) -> NDArray[Any]:
    """Move elevations that fell on the nodata value to its neighbour, so they stay data."""
    if nodata is None or (isinstance(nodata, float) and math.isnan(nodata)):
        return values
    clash = values == nodata
    if clash.any():
        tag = values.dtype.type(nodata)
        if values.dtype.kind == "f":
            values[clash] = np.nextafter(tag, values.dtype.type(0))
        else:
            values[clash] = tag + 1 if tag < np.iinfo(values.dtype).max else tag - 1
    return values


def _number(text: str | None) -> float | int | None:
    if text is None:
        return None
    try:
        number = int(text)
    except ValueError:
        return float(text)
    if not -(2**63) <= number < 2**64:
        raise ValueError(f"a nodata value of {text}")
    return number
