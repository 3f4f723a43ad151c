"""Values from a file of unknown origin, each held against what it may be before it is used.

Metadata are parsed by `parse_json`, which lets no number through that 64 bits cannot hold, no
infinity and no nesting beyond reason; `Fields` then gives each value out as the type that is due,
or ends in one line that names it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from wavelet_core.errors import PyramidError, WaveletError

__all__ = ["LARGEST_INTEGER", "Fields", "holds_fields", "parse_json"]

LARGEST_INTEGER = 2**63 - 1

#: Longest text that a field may hold; definitions of CRSs and tags of rasters are shorter.
LONGEST_TEXT = 1 << 20

#: Longest JSON text; expanded, each of its bytes may cost some twenty.
LONGEST_JSON = 4 << 20

#: Objects within objects. Ours go four deep.
DEEPEST_JSON = 16


def parse_json(text: object, where: str) -> Any:
    """Return the value of a JSON text of unknown origin.

    Parameters
    ----------
    text : object
        What should be a str.
    where : str
        What it describes, for the message.

    Raises
    ------
    PyramidError
        When it is no text, too long or no JSON, holds a number that is not finite or beyond 64
        bits, names a field twice, or is nested too deeply.

    Examples
    --------
    >>> parse_json('{"rows": 40}', "the raster")
    {'rows': 40}
    >>> parse_json('{"rows": 1e999}', "the raster")
    Traceback (most recent call last):
    ...
    wavelet_core.errors.PyramidError: the raster: 1e999 is not finite; the file is damaged.
    """
    if not isinstance(text, str):
        raise PyramidError(
            f"{where}: {type(text).__name__} where JSON is due; the file is damaged."
        )
    if len(text) > LONGEST_JSON:
        raise PyramidError(
            f"{where}: {len(text):,} characters of JSON, more than any pyramid file holds; "
            "the file is damaged."
        )

    def integer(digits: str) -> int:
        if len(digits) > 20 or not -LARGEST_INTEGER - 1 <= int(digits) <= LARGEST_INTEGER:
            raise PyramidError(
                f"{where}: the number {_short(digits)} is beyond 64 bits; the file is damaged."
            )
        return int(digits)

    def number(digits: str) -> float:
        if not math.isfinite(value := float(digits)):
            raise PyramidError(f"{where}: {_short(digits)} is not finite; the file is damaged.")
        return value

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        fields = dict(pairs)
        if len(fields) != len(pairs):
            raise PyramidError(f"{where}: a field is named twice; the file is damaged.")
        return fields

    try:
        value = json.loads(
            text, parse_int=integer, parse_float=number, parse_constant=number,
            object_pairs_hook=once,
        )  # fmt: skip
    except RecursionError:
        raise _too_deep(where) from None
    except json.JSONDecodeError as error:
        raise PyramidError(f"{where}: this is no JSON ({error}); the file is damaged.") from error
    layer, depth = [value], 0
    while layer := [inner for outer in layer for inner in _members(outer)]:
        depth += 1
        if depth > DEEPEST_JSON:
            raise _too_deep(where)
    return value


class Fields(dict[str, Any]):
    """A JSON object of unknown origin, whose values are asked for by type.

    Parameters
    ----------
    value : object
        What should be a dict.
    where : str
        What it describes, for the messages.
    error : type of WaveletError
        What is raised.

    Examples
    --------
    >>> fields = Fields({"rows": 40, "unit": "metre"}, "the raster")
    >>> fields.integer("rows", 1, 100), fields.text("unit")
    (40, 'metre')
    >>> fields.integer("rows", 1, 30)
    Traceback (most recent call last):
    ...
    wavelet_core.errors.PyramidError: the description of the raster is damaged (rows is 40 where \
an integer from 1 to 30 is due); analyse the input anew.
    """

    def __init__(self, value: object, where: str, error: type[WaveletError] = PyramidError) -> None:
        self.where, self._error = where, error
        if not isinstance(value, dict):
            raise self.fault(f"{_short(value)} where an object is due")
        super().__init__(value)

    def fault(self, what: str) -> WaveletError:
        """Return the error that says what is wrong."""
        return self._error(
            f"the description of {self.where} is damaged ({what}); analyse the input anew."
        )

    def __missing__(self, name: str) -> Any:
        raise self.fault(f"{name} is missing")

    def integer(self, name: str, low: int = 0, high: int = LARGEST_INTEGER) -> int:
        """Return an integer within bounds; a bool is none."""
        return self._integer(name, self[name], low, high)

    def number(self, name: str) -> float:
        """Return a finite number as a float."""
        return self._number(name, self[name])

    def text(self, name: str, longest: int = LONGEST_TEXT) -> str:
        """Return a text."""
        return self._text(name, self[name], longest)

    def text_or_none(self, name: str, longest: int = LONGEST_TEXT) -> str | None:
        """Return a text, or None where the field is null."""
        return None if self[name] is None else self.text(name, longest)

    def choice(self, name: str, choices: tuple[str, ...]) -> str:
        """Return a text that is one of a few."""
        value = self[name]
        if not isinstance(value, str) or value not in choices:
            raise self._wrong(name, value, f"one of {', '.join(choices)}")
        return value

    def flag(self, name: str) -> bool:
        """Return a bool."""
        value = self[name]
        if not isinstance(value, bool):
            raise self._wrong(name, value, "true or false")
        return value

    def fields(self, name: str) -> Fields:
        """Return an object within this one."""
        return Fields(self[name], f"{self.where}, {name}", self._error)

    def integers(self, name: str, low: int = 0, high: int = LARGEST_INTEGER) -> list[int]:
        """Return a list of integers within bounds."""
        return [self._integer(name, value, low, high) for value in self.items_of(name)]

    def numbers(self, name: str, count: int) -> list[float]:
        """Return a list of so many finite numbers."""
        values = self.items_of(name)
        if len(values) != count:
            raise self._wrong(name, values, f"a list of {count} numbers")
        return [self._number(name, value) for value in values]

    def texts(self, name: str) -> list[str]:
        """Return a list of texts."""
        return [self._text(name, value, LONGEST_TEXT) for value in self.items_of(name)]

    def objects(self, name: str) -> list[Fields]:
        """Return a list of objects."""
        where = f"{self.where}, {name}"
        return [Fields(value, where, self._error) for value in self.items_of(name)]

    def items_of(self, name: str) -> list[Any]:
        """Return a list of whatever is in it."""
        value = self[name]
        if not isinstance(value, list | tuple):
            raise self._wrong(name, value, "a list")
        return list(value)

    def _integer(self, name: str, value: object, low: int, high: int) -> int:
        if type(value) is not int or not low <= value <= high:
            raise self._wrong(name, value, f"an integer from {low} to {high}")
        return value

    def _number(self, name: str, value: object) -> float:
        is_number = type(value) in (int, float) and abs(value) <= 1.7976931348623157e308  # type: ignore[arg-type]
        if not is_number:
            raise self._wrong(name, value, "a finite number")
        return float(value)  # type: ignore[arg-type]

    def _text(self, name: str, value: object, longest: int) -> str:
        if not isinstance(value, str) or len(value) > longest:
            raise self._wrong(name, value, f"a text of at most {longest} characters")
        return value

    def _wrong(self, name: str, value: object, due: str) -> WaveletError:
        return self.fault(f"{name} is {_short(value)} where {due} is due")


def holds_fields(record: Any, fields: Mapping[str, Mapping[str, type]]) -> bool:
    """Return whether a record of unknown origin has a known status, and the fields of that.

    Parameters
    ----------
    record : object
        What should be a dict with ``status``.
    fields : mapping of str to mapping of str to type
        For each status the fields that go with it.
    """
    status = record.get("status") if isinstance(record, dict) else None
    if not isinstance(status, str) or status not in fields:
        return False
    return all(isinstance(record.get(name), kind) for name, kind in fields[status].items())


def _members(value: object) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return value if isinstance(value, list) else []


def _too_deep(where: str) -> PyramidError:
    return PyramidError(f"{where}: nested too deeply for a description; the file is damaged.")


def _short(value: object) -> str:
    """Return a value for a message, never more than a few words of it."""
    if isinstance(value, dict | list | tuple):
        return f"a {'dict' if isinstance(value, dict) else 'list'} of {len(value)}"
    if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        return "an integer beyond 64 bits"
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
