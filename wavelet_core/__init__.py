"""Reversible multiresolution pyramids of terrain TINs by graph-based wavelet lifting."""

from . import metrics, synthetic
from .errors import (
    Cancelled,
    FilterError,
    MeshError,
    MissingDependencyError,
    OptionError,
    PyramidError,
    SlowFallbackWarning,
    WaveletError,
)
from .filtering.denoise import denoise
from .lifting.analyse import analyse
from .lifting.pyramid import Detail, Pyramid
from .lifting.spacings import level_spacings
from .lifting.step import FilterPair, Step
from .mesh.triangle_mesh import TriangleMesh

__all__ = [
    "Cancelled",
    "Detail",
    "FilterError",
    "FilterPair",
    "MeshError",
    "MissingDependencyError",
    "OptionError",
    "Pyramid",
    "PyramidError",
    "SlowFallbackWarning",
    "Step",
    "TriangleMesh",
    "WaveletError",
    "analyse",
    "denoise",
    "level_spacings",
    "metrics",
    "synthetic",
]

__version__ = "0.1.0"
