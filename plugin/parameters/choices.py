"""What the dialogs offer: the rows of the tables of ``wavelet_core`` and ``wavelet_gis``.

There is no second list here. The core needs NumPy and SciPy; where these are missing, a dialog
offers what needs no list, and running it says how to get them.
"""

from __future__ import annotations

import html
from collections.abc import Iterable
from typing import Any

from qgis.core import QgsProcessingParameterEnum

from ..ui import dependencies
from ..ui.translation import tr
from .request import DEFAULT


def core_table(name: str) -> dict[str, Any]:
    """Return a table of ``wavelet_core``, such as ``PREDICTIONS``; empty where it cannot load."""
    if dependencies.missing(dependencies.ALWAYS):
        return {}
    import wavelet_core

    table: dict[str, Any] = getattr(wavelet_core, name)
    return table


def duplicate_rules() -> tuple[str, ...]:
    """Return the rules for points at one place, the default first."""
    if dependencies.missing(dependencies.ALWAYS):
        return (DEFAULT,)
    from wavelet_gis.model.points.aside import DUPLICATE_RULES

    return tuple(DUPLICATE_RULES)


def clusterings() -> tuple[str, ...]:
    """Return the methods of clustering, the default first."""
    if dependencies.missing(dependencies.ALWAYS):
        return (DEFAULT,)
    from wavelet_gis.workflows.learning.clustering import CLUSTERINGS

    return tuple(CLUSTERINGS)


def choice(
    name: str, description: str, values: Iterable[str], default: str | None = None
) -> QgsProcessingParameterEnum:
    """Return an enum parameter whose values are stored as words, so that lists may grow.

    Parameters
    ----------
    name, description : str
        Of the parameter.
    values : iterable of str
        What it offers.
    default : str, optional
        By default the first.
    """
    words = list(values)
    return QgsProcessingParameterEnum(
        name,
        description,
        options=words,
        defaultValue=words[0] if default is None else default,
        usesStaticStrings=True,
    )


def table_choice(
    name: str, description: str, table: dict[str, Any]
) -> tuple[QgsProcessingParameterEnum, str]:
    """Return an enum parameter that offers the rows of a table, and the help on each row.

    Parameters
    ----------
    name, description : str
        Of the parameter.
    table : dict
        Rows with a ``help``; those of the paper have a ``short`` name or an ``equation`` too.
    """
    parameter = choice(name, description, (DEFAULT, *table))
    return parameter, "".join(f"<br>{_row_help(row)}" for row in table.values())


def _row_help(row: Any) -> str:
    """Return one row of a table as a line: its name, what it does, where the paper has it."""
    names = [getattr(row, "short", ""), getattr(row, "equation", "")]
    paper = ", ".join(name for name in names if name and name != row.name)
    text = html.escape(tr(row.help), quote=False)
    return f"<i>{row.name}</i>: {text}" + (f" ({html.escape(paper, quote=False)})" if paper else "")
