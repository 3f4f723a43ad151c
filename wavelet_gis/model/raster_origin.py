"""The origin of a pyramid made from a raster: the way back to the very bits that came in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import PyramidError
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.model.dem import (
    SAME_AS_NODATA,
    Dem,
    GridGeometry,
    InputGrid,
    cell_plan,
    dem_mesh,
    taken_for_nodata,
)
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

__all__ = ["RasterOrigin"]

#: Rows or columns; GDAL knows no larger rasters.
_LARGEST_SIDE = 2**31 - 1


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


def _avoiding_nodata(values: NDArray[Any], nodata: float | int | None) -> NDArray[Any]:
    """Move elevations that fell on the nodata value away from it, so that they stay data."""
    if nodata is None or (isinstance(nodata, float) and math.isnan(nodata)):
        return values
    clash = taken_for_nodata(values, nodata)
    if not clash.any():
        return values
    tag = values.dtype.type(nodata)
    if values.dtype.kind != "f":
        values[clash] = tag + 1 if tag < np.iinfo(values.dtype).max else tag - 1
    elif nodata == 0:
        values[clash] = np.finfo(values.dtype).smallest_subnormal
    else:
        values[clash] = nodata * (1.0 - 2 * SAME_AS_NODATA)
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
