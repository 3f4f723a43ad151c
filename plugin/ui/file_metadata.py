"""Which widget a dialog shows for a file, named without an import: that needs a window."""

from __future__ import annotations

from typing import Any


def file_widget(name: str, **options: Any) -> dict[str, Any]:
    """Return the metadata of a parameter that one of ``file_widgets`` is to show.

    Parameters
    ----------
    name : str
        Of the class.
    **options
        That it is made with.
    """
    module = f"{__name__.rpartition('.')[0]}.file_widgets"
    return {"widget_wrapper": {"class": f"{module}.{name}", **options}}
