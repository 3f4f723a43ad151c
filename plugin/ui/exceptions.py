"""QGIS's exceptions, which its stubs do not have.

``QgsProcessingException`` is how an algorithm says in one line why it stops;
``QgsCsException`` is raised where coordinates cannot be transformed.
"""

from __future__ import annotations

from qgis.core import (  # type: ignore[attr-defined]
    QgsCsException,
    QgsProcessingException,
)

__all__ = ["QgsCsException", "QgsProcessingException"]
