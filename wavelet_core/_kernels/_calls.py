"""Compiled code called past numba's look-up of types, where that leaks.

Numba finds the code for a call by a fingerprint of each argument. Before 0.61 the first 40 bytes
of a longer one, as of a tuple of ten arrays, are whatever was in the memory that it was put into:
the call then looks like none before, and numba keeps its fingerprint for good. That is 0.3 to 0.8
kB a call, megabytes for each analysis in a QGIS that runs for days.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

#: The first version of numba without the leak.
MENDED_IN = (0, 61)
#: What of the flags of an array its type in numba says: order, alignment, whether it is writeable.
_FLAGS = 0x1 | 0x2 | 0x100 | 0x400


def called_past_leak(dispatcher: Any, numba: Any) -> Callable[..., Any]:
    """Return what calls a compiled function; itself where numba does not leak.

    Parameters
    ----------
    dispatcher : numba dispatcher
        The compiled function.
    numba : module or None
        None where there is none, and the function is plain Python.
    """
    if numba is None or numba.version_info.short >= MENDED_IN:
        return dispatcher
    if not hasattr(dispatcher, "overloads"):  # compiling is switched off
        return dispatcher
    return PastLeak(dispatcher, numba.typeof)


class PastLeak:
    """A compiled function that is called by what its arguments are.

    Parameters
    ----------
    dispatcher : numba dispatcher
        The compiled function; it compiles what is called for the first time.
    type_of : callable
        Numba's type of a value.
    """

    def __init__(self, dispatcher: Any, type_of: Callable[[Any], Any]) -> None:
        self._dispatcher, self._type_of = dispatcher, type_of
        self._entries: dict[tuple[Any, ...], Callable[..., Any]] = {}

    def __call__(self, *arguments: Any) -> Any:
        """Call it; fingerprints of arrays and numbers by themselves are short, and whole."""
        if not any(isinstance(value, tuple) for value in arguments):
            return self._dispatcher(*arguments)
        kinds = tuple([kind_of(value) for value in arguments])
        entry = self._entries.get(kinds)
        if entry is not None:
            return entry(*arguments)
        result = self._dispatcher(*arguments)
        types = tuple([self._type_of(value) for value in arguments])
        compiled = self._dispatcher.overloads.get(types)
        if compiled is not None:
            self._entries[kinds] = compiled.entry_point
        return result


def kind_of(value: Any) -> Any:
    """Return what tells values apart that numba compiles for separately."""
    if type(value) is np.ndarray:
        return value.dtype, value.ndim, value.flags.num & _FLAGS
    if isinstance(value, tuple):
        return type(value), *[kind_of(part) for part in value]
    return type(value)
