"""Bit-for-bit originals beside a synthesis that is exact only to rounding.

A pyramid gives each value back with an error of some 1e-13 of its column's range. So the column
that came in is kept beside it (`KeptColumn`): in a pyramid file all else is described by it, and
takes no byte more. Synthesis must come as close to it as it did when the pyramid was made.

Files of format 1 keep instead the little that synthesis lacks (`ExactColumn`):

* a quantum q, a power of two some 500 times larger than the error that was seen;
* for each value its remainder ``r = a - q round(a / q)``. It is zero for integers, for nearly all
  float32 values and for most float64 files, and then not stored at all;
* the few values that this does not cover (such as -0.0), one by one.

The original is ``q round((c - r) / q) + r`` for any synthesised c within q / 2 of a. The step is
that wide on purpose: another processor or SciPy may round a sum otherwise, and the original must
still come back.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import PyramidError
from wavelet_gis._fields import Fields

__all__ = [
    "CORRECTIONS",
    "ExactColumn",
    "KeptColumn",
    "checksum",
    "column_from_parts",
    "exact_column",
    "kept_column",
    "nearest_of_dtype",
    "number_dtype",
    "require_checksum",
]

#: What pyramid files call the corrections: a name of before, kept so that those files are read.
CORRECTIONS = "ledger"

#: Integers and floats of up to eight bytes, little-endian.
_NUMBER_CODES = ("|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f2", "<f4", "<f8")

#: The quantum is at least this many times the largest error seen at writing.
SAFETY = 1024.0

#: Errors below this part of the largest value are not counted on, even if none was seen.
LEAST_RELATIVE_ERROR = 2.0**-48


@dataclass(frozen=True, slots=True)
class ExactColumn:
    """What turns approximate values back into one original column.

    Attributes
    ----------
    dtype : numpy dtype
        Of the original.
    quantum : float
        Step of the grid, a power of two.
    remainder : (n,) float64 or None
        Distance of each value from the grid; None when all are on it.
    exception_rows : (k,) int64
        Rows that the rule does not give back.
    exception_values : (k,) of the original's dtype
        Their values.
    """

    dtype: np.dtype[Any]
    quantum: float
    remainder: NDArray[np.float64] | None
    exception_rows: NDArray[np.int64]
    exception_values: NDArray[Any]

    def restore(self, approximate: NDArray[np.float64]) -> NDArray[Any]:
        """Return the original column, given values within half a quantum of it.

        Raises
        ------
        PyramidError
            When the number of values is not that of the column.
        """
        n = len(approximate)
        if self.remainder is not None and len(self.remainder) != n:
            raise PyramidError(
                f"there are {len(self.remainder)} remainders for {n} values; "
                "the file is damaged, write it anew."
            )
        restored = _on_grid(approximate, self.quantum, self.remainder)
        column = nearest_of_dtype(restored, self.dtype)
        if len(self.exception_rows):
            if self.exception_rows.min() < 0 or self.exception_rows.max() >= n:
                raise PyramidError(
                    f"the corrections name a row beyond the {n} there are; "
                    "the file is damaged, write it anew."
                )
            column[self.exception_rows] = self.exception_values
        return column

    def to_parts(self, name: str) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return JSON-able fields, and arrays by names that start with `name`."""
        arrays: dict[str, NDArray[Any]] = {}
        if self.remainder is not None:
            arrays[f"{name}/remainder"] = self.remainder
        if len(self.exception_rows):
            arrays[f"{name}/exception_rows"] = self.exception_rows
            arrays[f"{name}/exception_values"] = self.exception_values
        return {"dtype": self.dtype.str, "quantum": self.quantum}, arrays

    @classmethod
    def from_parts(
        cls, name: str, fields: dict[str, Any], arrays: dict[str, NDArray[Any]]
    ) -> ExactColumn:
        """Return the column that `to_parts` described.

        Raises
        ------
        PyramidError
            When a part is missing or of another type than it must be.
        """
        stored = Fields(fields, f"the correction {name}")
        quantum = stored.number("quantum")
        try:
            dtype = number_dtype(stored.text("dtype"))
        except ValueError as error:
            raise PyramidError(
                f"the correction {name} is damaged ({error}); write the file anew."
            ) from error
        remainder = arrays.get(f"{name}/remainder")
        rows = arrays.get(f"{name}/exception_rows", np.empty(0, np.int64))
        values = arrays.get(f"{name}/exception_values", np.empty(0, dtype))
        sound = (
            quantum > 0
            and (remainder is None or (remainder.ndim == 1 and remainder.dtype == np.float64))
            and rows.ndim == values.ndim == 1
            and rows.dtype == np.int64
            and values.dtype == dtype
            and len(rows) == len(values)
        )
        if not sound:
            raise PyramidError(f"the correction {name} is damaged; write the file anew.")
        return cls(dtype, quantum, remainder, rows, values)


@dataclass(frozen=True, slots=True)
class KeptColumn:
    """One original column, as it came.

    Attributes
    ----------
    values : (n,) integers or floats, little-endian
    quantum : float
        Twice what the values of the synthesis may differ by.
    """

    values: NDArray[Any]
    quantum: float

    @property
    def dtype(self) -> np.dtype[Any]:
        """Data type of the original."""
        return self.values.dtype

    def restore(self, approximate: NDArray[np.float64]) -> NDArray[Any]:
        """Return the original column, given the values that synthesis makes of it.

        Raises
        ------
        PyramidError
            When the number of values is not that of the column, or one of them is another.
        """
        n = len(approximate)
        if len(self.values) != n:
            raise PyramidError(
                f"there are {len(self.values)} original numbers for {n} values; "
                "the file is damaged, write it anew."
            )
        with np.errstate(invalid="ignore", over="ignore"):
            is_near = np.abs(approximate - self.values.astype(np.float64)) <= self.quantum / 2
        if not is_near.all():
            raise PyramidError(
                "the reconstruction is not bit for bit the original (levels and details lead to "
                "other numbers); the file is damaged, analyse the input anew."
            )
        return self.values.copy()

    def to_parts(self, name: str) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return JSON-able fields, and arrays by names that start with `name`."""
        fields = {"dtype": self.dtype.str, "quantum": self.quantum, "is_kept": True}
        return fields, {f"{name}/values": self.values}


def kept_column(original: NDArray[Any], approximate: NDArray[np.float64]) -> KeptColumn:
    """Return what keeps `original` beside a synthesis that gives `approximate` for it.

    Parameters
    ----------
    original : (n,) integers or floats
        Finite values as they came.
    approximate : (n,) float64
        What synthesis gives for them, in the same unit.
    """
    dtype = original.dtype.newbyteorder("<")
    values = np.ascontiguousarray(original, dtype=dtype)
    as_floats = values.astype(np.float64)
    return KeptColumn(values, _quantum(as_floats, approximate, is_integer=dtype.kind in "iu"))


def column_from_parts(
    name: str, fields: dict[str, Any], arrays: dict[str, NDArray[Any]]
) -> KeptColumn | ExactColumn:
    """Return the column that the `to_parts` of either kind described.

    Raises
    ------
    PyramidError
        When a part is missing or of another type than it must be.
    """
    if "is_kept" not in fields:
        return ExactColumn.from_parts(name, fields, arrays)
    stored = Fields(fields, f"the column {name}")
    quantum, values = stored.number("quantum"), arrays.get(f"{name}/values")
    if values is None or values.ndim != 1 or values.dtype.str != stored.text("dtype"):
        raise PyramidError(f"the column {name} is damaged; write the file anew.")
    return KeptColumn(values, quantum)


def exact_column(original: NDArray[Any], approximate: NDArray[np.float64]) -> ExactColumn:
    """Return what `approximate` needs to become `original` again.

    Parameters
    ----------
    original : (n,) integers or floats
        Finite values as they came.
    approximate : (n,) float64
        What synthesis gives for them, in the same unit.

    Examples
    --------
    >>> import numpy as np
    >>> original = np.array([0.1, 0.2, -0.0, 1e-300])
    >>> column = exact_column(original, original + 1e-14)
    >>> column.restore(original - 1e-14).tobytes() == original.tobytes()
    True
    """
    dtype = original.dtype.newbyteorder("<")
    original = original.astype(dtype, copy=False)
    values = original.astype(np.float64)
    quantum = _quantum(values, approximate, is_integer=dtype.kind in "iu")
    remainder: NDArray[np.float64] | None = values - quantum * np.rint(values / quantum)
    if remainder is not None and not remainder.any():
        remainder = None
    trial = nearest_of_dtype(_on_grid(approximate, quantum, remainder), dtype)
    rows = np.flatnonzero(_bits(trial) != _bits(original))
    return ExactColumn(dtype, quantum, remainder, rows, original[rows])


def nearest_of_dtype(values: NDArray[np.float64], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return the values in another type: integers rounded and kept within its range.

    Examples
    --------
    >>> import numpy as np
    >>> nearest_of_dtype(np.array([-3.0, 41.6, 999.0]), np.dtype("u1")).tolist()
    [0, 42, 255]
    """
    if dtype.kind == "f":
        with np.errstate(over="ignore"):
            return values.astype(dtype)
    limits = np.iinfo(dtype)
    rounded = np.rint(values)
    inside = np.clip(rounded, float(limits.min), float(limits.max))
    # The largest 64-bit integers are no floats; clipping rounds them out of their range.
    at_top = inside >= float(limits.max)
    converted = np.where(at_top, 0.0, inside).astype(dtype)
    converted[at_top] = limits.max
    return converted


def checksum(columns: Iterable[NDArray[Any]]) -> str:
    """Return the SHA-256 of the columns' bytes, little-endian, one after the other."""
    digest = hashlib.sha256()
    for column in columns:
        little = np.ascontiguousarray(column, dtype=column.dtype.newbyteorder("<"))
        digest.update(little.reshape(-1).view(np.uint8).data)
    return digest.hexdigest()


def require_checksum(columns: Iterable[NDArray[Any]], due: str) -> None:
    """Refuse columns that are not those of which a checksum was kept.

    Parameters
    ----------
    columns : iterable of ndarray
        As reconstructed.
    due : str
        The `checksum` of the original ones.

    Raises
    ------
    PyramidError
        When theirs is another.
    """
    if checksum(columns) != due:
        raise PyramidError(
            "the reconstruction is not bit for bit the original (its checksum differs); the file "
            "is damaged, analyse the input anew."
        )


def _quantum(
    values: NDArray[np.float64], approximate: NDArray[np.float64], *, is_integer: bool
) -> float:
    if len(values) == 0:
        return 1.0
    largest = float(np.abs(values).max())
    error = max(float(np.abs(values - approximate).max()), largest * LEAST_RELATIVE_ERROR)
    step = math.ldexp(1.0, math.ceil(math.log2(error * SAFETY))) if error > 0 else 1.0
    return max(step, 1.0) if is_integer else max(step, 2.0**-1000)


def _on_grid(
    values: NDArray[np.float64], quantum: float, remainder: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    # Adding zero turns -0.0 into 0.0, so that the sign of a zero does not hang on that of an error.
    if remainder is None:
        return quantum * np.rint(values / quantum) + 0.0
    return quantum * np.rint((values - remainder) / quantum) + remainder


def _bits(column: NDArray[Any]) -> NDArray[Any]:
    return np.ascontiguousarray(column).view(f"u{column.dtype.itemsize}")


def number_dtype(text: str) -> np.dtype[Any]:
    """Return the data type of a code such as ``<f4``, of those that a pyramid file may name.

    Raises
    ------
    ValueError
        Any other text, of which numpy would make something.
    """
    if text not in _NUMBER_CODES:
        raise ValueError(f"data type {text[:20]!r}")
    return np.dtype(text)
