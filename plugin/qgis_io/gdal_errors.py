"""GDAL's two ways of reporting an error, brought to one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any


@contextmanager
def without_exceptions(module: Any, refusal: Callable[[str], Exception]) -> Iterator[None]:
    """Keep ``gdal``, ``osr`` or ``ogr`` from raising in the block: they return None or a code.

    Which of the two GDAL does is a setting of the whole process, which Processing and other plugins
    change, and that must not change for them. Before GDAL 3.7 there is no context that changes it
    for a while; there, what GDAL raises is turned into ``refusal(reason)``.

    Parameters
    ----------
    module : module
        ``osgeo.gdal``, ``osgeo.osr`` or ``osgeo.ogr``.
    refusal : callable
        Takes GDAL's reason and returns the exception for the user.
    """
    manager = getattr(module, "ExceptionMgr", None)
    with manager(useExceptions=False) if manager else nullcontext():
        try:
            yield
        except RuntimeError as error:
            if manager:
                raise
            raise refusal(str(error)) from error


def opened(gdal: Any, path: str) -> Any:
    """Return the dataset at a path, or None where GDAL cannot open it."""
    try:
        return gdal.Open(path)
    except RuntimeError:
        return None
