"""QGIS's exceptions, which its stubs do not have.

``QgsProcessingException`` is how an algorithm says in one line why it stops;
``QgsCsException`` is raised where coordinates cannot be transformed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from qgis.core import (  # type: ignore[attr-defined]
    QgsCsException,
    QgsProcessingException,
)

__all__ = ["QgsCsException", "QgsProcessingException", "held_by_nobody"]

Result = TypeVar("Result")


def held_by_nobody(method: Callable[..., Result]) -> Callable[..., Result]:
    """Return a method that QGIS calls, from which a refusal comes without its traceback.

    QGIS reads the message of an exception out of Python and never lets go of the exception (3.40).
    Its traceback would hold the frame that raised it, so the algorithm with the layers of a model
    that it reads, and the frames of all callers, with all that is in them, as long as QGIS runs.
    """

    @wraps(method)
    def called(*arguments: object) -> Result:
        try:
            return method(*arguments)
        except QgsProcessingException as error:
            error.__cause__ = error.__context__ = error.__traceback__ = None
            raise  # as it is: without arguments this adds no frame to the traceback

    return called
