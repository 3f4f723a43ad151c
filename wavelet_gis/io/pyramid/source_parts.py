"""The arrays of a pyramid's source: a raster's numbers in the file are residuals of a forecast."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.progress import part_of, report
from wavelet_gis._fields import Fields
from wavelet_gis.io.pyramid.array_tables import StoredArrays
from wavelet_gis.io.pyramid.codecs.former_grids import FormerResiduals
from wavelet_gis.io.pyramid.codecs.grid_codec import (
    DIVISORS,
    MOST_LOW_BITS,
    RELIEF_WEIGHTS,
    Residuals,
    decode_grid,
    encode_grid,
    integers_of,
    values_of,
)
from wavelet_gis.model.exact_restore import CORRECTIONS, number_dtype
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["LOW_BITS", "PALETTE", "check_source", "shrink_source", "source_arrays"]

#: What the description of a raster says of its palette: how many values there are.
PALETTE = "palette"

#: What it says of the residuals' low bits: how many those of each class have. Where it says nothing
#: of them, the residuals are in the form of formats 2 and 3.
LOW_BITS = "low_bits"

#: A raster's numbers, in memory and in the file.
_GRID_VALUES = f"source/{CORRECTIONS}/values"

_RESIDUALS = "source/residuals"

_LOW = "source/low"

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
        arrays[_BEYOND] = residuals.beyond
        source["divisor"] = numbers.divisor
        if isinstance(residuals, FormerResiduals):
            arrays[_RESIDUALS] = residuals.numbers
            source["relief_classes"] = list(residuals.classes)
        else:
            arrays[_RESIDUALS], arrays[_LOW] = residuals.pairs, residuals.low
            source[LOW_BITS] = list(residuals.low_bits)
            source["relief_weight"] = residuals.relief_weight
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
        n_rows, n_columns = source.integers("shape", 1)
        packed = arrays.get("source/valid", "|u1", 1)
        if len(packed) != -(-n_rows * n_columns // 8):
            raise source.fault("shape is not that of its mask")
        valid = np.unpackbits(packed, count=n_rows * n_columns).reshape(n_rows, n_columns)
        integers = _integers(source, arrays, valid.astype(bool), progress)
        divisor = source.integer("divisor", 0, max(DIVISORS))
        dtype = number_dtype(source.text("dtype"))
        palette = arrays.get(_PALETTE, dtype.str, 1) if PALETTE in source else None
        with np.errstate(over="ignore"):
            found[_GRID_VALUES] = values_of(integers, dtype, divisor, palette)
    return found


def _integers(
    source: Fields, arrays: StoredArrays, valid: NDArray[np.bool_], progress: Progress | None
) -> NDArray[np.int64]:
    """Return the integers of a raster out of its residuals, in whichever form they are."""
    beyond = arrays.get(_BEYOND, "<u8", 1)
    if LOW_BITS not in source:
        numbers = arrays.get(_RESIDUALS, n_dimensions=1)
        former = FormerResiduals(numbers, beyond, tuple(source.integers("relief_classes")))
        return decode_grid(former, valid, progress)
    residuals = Residuals(
        arrays.get(_RESIDUALS, "|u1", 1),
        arrays.get(_LOW, "|u1", 1),
        beyond,
        tuple(source.integers(LOW_BITS, 0, MOST_LOW_BITS)),
        source.integer("relief_weight", 0, max(RELIEF_WEIGHTS)),
    )
    return decode_grid(residuals, valid, progress)


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
