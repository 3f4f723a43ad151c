"""The exception by which an algorithm tells its user in one line why it stops."""

from __future__ import annotations

from qgis.core import QgsProcessingException  # type: ignore[attr-defined] # not in the stubs

__all__ = ["QgsProcessingException"]
