"""Reversible multiresolution pyramids of terrain TINs by graph-based wavelet lifting."""

from . import metrics, synthetic
from .accuracy.between_levels import mesh_of_accuracy, mesh_of_size
from .accuracy.fitted_heights import fitted
from .accuracy.selective import PartialMesh
from .errors import (
    Cancelled,
    MeshError,
    MissingDependencyError,
    OptionError,
    PyramidError,
    SlowFallbackWarning,
    UnstableDesignWarning,
    WaveletError,
    WaveletWarning,
)
from .features.ground import ground_points
from .features.landforms import LANDFORMS, landforms
from .features.scale_maps import (
    ScaleMaps,
    deviation_by_scale,
    heights_above_means,
    level_at_distance,
    local_means,
    roughness_by_scale,
)
from .features.shape import SHAPE_NAMES, DetailShape, SurfaceShape, detail_shape, surface_shape
from .features.signature import (
    Signature,
    energy_signature,
    joined_levels,
    plain_features,
    scale_features,
)
from .features.spectral_slope import spectral_slope
from .features.spectrum import (
    STAYS,
    Components,
    VertexDetails,
    band_components,
    band_energies,
    heights_above_lows,
    vertex_details,
)
from .features.window_shape import window_shape
from .filtering.denoise import denoise
from .filtering.gains import band_gains, relifted
from .filtering.noise.white import channel_noise, estimate_noise
from .lifting.analyse import analyse
from .lifting.prediction import PREDICTIONS
from .lifting.pyramid import Detail, Pyramid
from .lifting.signal import SIGNALS
from .lifting.spacings import level_spacings
from .lifting.step import FilterPair, Step
from .lifting.update import UPDATES
from .mesh.triangle_mesh import TriangleMesh
from .partition.orderings import COSTS, QUADRICS
from .partition.registry import NORMS, PARTITIONS
from .progress import Progress
from .refinement.finish import finished
from .refinement.refine import Refinement, Round, refine

__all__ = [
    "COSTS",
    "LANDFORMS",
    "NORMS",
    "PARTITIONS",
    "PREDICTIONS",
    "QUADRICS",
    "SHAPE_NAMES",
    "SIGNALS",
    "STAYS",
    "UPDATES",
    "Cancelled",
    "Components",
    "Detail",
    "DetailShape",
    "FilterPair",
    "MeshError",
    "MissingDependencyError",
    "OptionError",
    "PartialMesh",
    "Progress",
    "Pyramid",
    "PyramidError",
    "Refinement",
    "Round",
    "ScaleMaps",
    "Signature",
    "SlowFallbackWarning",
    "Step",
    "SurfaceShape",
    "TriangleMesh",
    "UnstableDesignWarning",
    "VertexDetails",
    "WaveletError",
    "WaveletWarning",
    "analyse",
    "band_components",
    "band_energies",
    "band_gains",
    "channel_noise",
    "denoise",
    "detail_shape",
    "deviation_by_scale",
    "energy_signature",
    "estimate_noise",
    "finished",
    "fitted",
    "ground_points",
    "heights_above_lows",
    "heights_above_means",
    "joined_levels",
    "landforms",
    "level_at_distance",
    "level_spacings",
    "local_means",
    "mesh_of_accuracy",
    "mesh_of_size",
    "metrics",
    "plain_features",
    "refine",
    "relifted",
    "roughness_by_scale",
    "scale_features",
    "spectral_slope",
    "surface_shape",
    "synthetic",
    "vertex_details",
    "window_shape",
]

__version__ = "0.1.0"
