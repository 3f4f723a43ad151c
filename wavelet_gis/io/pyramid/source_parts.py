"""The arrays of a pyramid's source: a raster's numbers in the file are residuals of a forecast."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.progress import part_of, report
from wavelet_gis._fields import Fields
from wavelet_gis.io.pyramid.array_tables import StoredArrays
from wavelet_gis.io.pyramid.codecs.grid_codec import (
    DIVISORS,
    Residuals,
    decode_grid,
    encode_grid,
    integers_of,
    values_of,
)
from wavelet_gis.model.exact_restore import CORRECTIONS, number_dtype
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["PALETTE", "check_source", "shrink_source", "source_arrays"]

#: What the description of a raster says of its palette: how many values there are.
PALETTE = "palette"

#: A raster's numbers, in memory and in the file.
_GRID_VALUES = f"source/{CORRECTIONS}/values"

_RESIDUALS = "source/residuals"

_BEYOND = "source/beyond"

_PALETTE = "source/palette"


def shrink_source(
    geo: GeoPyramid,
    source: dict[str, Any],
    arrays: dict[str, NDArray[Any]],
    progress: Progress | None = None,
) -> None:
    """Put in the place of a raster's numbers their residuals."""
    grid = geo.origin.grid
    if grid is not None and _GRID_VALUES in arrays:
        numbers = integers_of(arrays.pop(_GRID_VALUES))
        report(progress, 0.1)
        residuals = encode_grid(numbers.integers, grid.valid, part_of(progress, 0.1, 1.0))
        arrays[_RESIDUALS], arrays[_BEYOND] = residuals.numbers, residuals.beyond
        source["divisor"] = numbers.divisor
        source["relief_classes"] = list(residuals.classes)
        if numbers.palette is not None:
            arrays[_PALETTE] = numbers.palette
            source[PALETTE] = len(numbers.palette)


def source_arrays(
    source: Fields,
    arrays: StoredArrays,
    progress: Progress | None = None,
    *,
    with_numbers: bool = True,
) -> dict[str, NDArray[Any]]:
    """Return the arrays of the source, a raster's numbers out of their residuals."""
    if "divisor" not in source:
        return arrays.all_named("source/")
    found = {name: arrays.get(name) for name in ("source/valid", "source/holes")}
    if with_numbers:
        residuals = Residuals(
            arrays.get(_RESIDUALS, n_dimensions=1),
            arrays.get(_BEYOND, "<u8", 1),
            tuple(source.integers("relief_classes")),
        )
        n_rows, n_columns = source.integers("shape", 1)
        packed = arrays.get("source/valid", "|u1", 1)
        if len(packed) != -(-n_rows * n_columns // 8):
            raise source.fault("shape is not that of its mask")
        valid = np.unpackbits(packed, count=n_rows * n_columns).reshape(n_rows, n_columns)
        integers = decode_grid(residuals, valid.astype(bool), progress)
        divisor = source.integer("divisor", 0, max(DIVISORS))
        dtype = number_dtype(source.text("dtype"))
        palette = arrays.get(_PALETTE, dtype.str, 1) if PALETTE in source else None
        with np.errstate(over="ignore"):
            found[_GRID_VALUES] = values_of(integers, dtype, divisor, palette)
    return found


def check_source(fields: Fields) -> None:
    """Check what a summary says of the source; the rest is checked when it is used."""
    kind = fields.choice("kind", ("raster", "points", "tin"))
    if kind == "raster":
        if len(fields.integers("shape", 1)) != 2:
            raise fields.fault("shape is not that of a raster")
        fields.text("dtype")
    elif kind == "points":
        fields.integer("n_points")
        if fields["classes"] is not None:
            fields.integers("classes")
