"""Errors between surfaces, by their public names."""

from .accuracy.level_errors import LevelErrors, level_errors
from .mesh.location import surface_errors

__all__ = ["LevelErrors", "level_errors", "surface_errors"]
