"""What is lifted: elevation and attributes, or all coordinates."""

from __future__ import annotations

from typing import NamedTuple

from .._table import Table


class Signal(NamedTuple):
    """A choice of lifted coordinates: a row of :data:`SIGNALS`.

    name : str, what `analyse` takes
    coordinates : tuple of str, the lifted ones, which come before the attributes
    help : str, one line for lists
    keeps_plan : bool, whether x and y stay what they are
    """

    name: str
    coordinates: tuple[str, ...]
    help: str
    keeps_plan: bool


#: The signals.
SIGNALS = Table(
    "signal",
    (
        Signal(
            "z", ("z",), "elevation and attributes; every level is a valid TIN", keeps_plan=True
        ),
        Signal(
            "xyz",
            ("x", "y", "z"),
            "all coordinates, as in the paper; coarse faces may be flipped in plan",
            keeps_plan=False,
        ),
    ),
)
