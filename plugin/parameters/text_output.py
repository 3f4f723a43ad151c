"""A text written to an output that is a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .request import Request


def write_text_output(request: Request, name: str, text_of: Callable[[], str]) -> dict[str, str]:
    """Write a text to the file of an output, whole or not at all; nothing where it is not wanted.

    Parameters
    ----------
    request : Request
        What was asked for.
    name : str
        Of the output.
    text_of : callable
        Makes the text, where it is wanted.

    Returns
    -------
    dict
        The path by the name of the output.
    """
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.read_back import write_text

    path = request.output_file(name)
    if not path:
        return {}
    text = request.computed(lambda work: text_of(), 0.95, 0.97)
    with new_file(path, overwrite=True) as scratch:
        write_text(scratch, text)
    return {name: path}
