"""Reversible multiresolution pyramids of terrain TINs by graph-based wavelet lifting."""

from . import coefficients, metrics, synthetic
from .analysis import analyse
from .denoising import denoise
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
from .lifting import FilterPair, Step
from .mesh import TriangleMesh
from .pyramid import Detail, Pyramid

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
    "coefficients",
    "denoise",
    "metrics",
    "synthetic",
]

__version__ = "0.1.0"
