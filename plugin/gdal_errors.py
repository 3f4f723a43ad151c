"""GDAL's two ways of telling an error, brought to one."""

from __future__ import annotations

from contextlib import nullcontext


def without_exceptions(module):
    """Return a context in which ``gdal``, ``osr`` or ``ogr`` returns None rather than raise.

    Which of the two GDAL does is a setting of the whole process that another plugin may have
    changed, and that must not change for others. Before GDAL 3.7 there is no such context, and
    returning None is the default that nearly all plugins count on.
    """
    manager = getattr(module, "ExceptionMgr", None)
    return manager(useExceptions=False) if manager else nullcontext()
