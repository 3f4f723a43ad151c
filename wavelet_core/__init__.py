"""Reversible multiresolution pyramids of terrain TINs by graph-based wavelet lifting.

Names are imported when they are first used: who analyses need not wait for filters and features.
"""

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
from .progress import Progress

TYPE_CHECKING = False  # what type checkers take for True
if TYPE_CHECKING:
    from . import metrics, synthetic
    from .accuracy.between_levels import mesh_of_accuracy, mesh_of_size
    from .accuracy.fitted_heights import fitted
    from .accuracy.selective import PartialMesh
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

#: The module of each public name that is not here yet.
_HOMES = {
    "COSTS": "partition.orderings",
    "Components": "features.spectrum",
    "Detail": "lifting.pyramid",
    "DetailShape": "features.shape",
    "FilterPair": "lifting.step",
    "LANDFORMS": "features.landforms",
    "NORMS": "partition.registry",
    "PARTITIONS": "partition.registry",
    "PREDICTIONS": "lifting.prediction",
    "PartialMesh": "accuracy.selective",
    "Pyramid": "lifting.pyramid",
    "QUADRICS": "partition.orderings",
    "Refinement": "refinement.refine",
    "Round": "refinement.refine",
    "SHAPE_NAMES": "features.shape",
    "SIGNALS": "lifting.signal",
    "STAYS": "features.spectrum",
    "ScaleMaps": "features.scale_maps",
    "Signature": "features.signature",
    "Step": "lifting.step",
    "SurfaceShape": "features.shape",
    "TriangleMesh": "mesh.triangle_mesh",
    "UPDATES": "lifting.update",
    "VertexDetails": "features.spectrum",
    "analyse": "lifting.analyse",
    "band_components": "features.spectrum",
    "band_energies": "features.spectrum",
    "band_gains": "filtering.gains",
    "channel_noise": "filtering.noise.white",
    "denoise": "filtering.denoise",
    "detail_shape": "features.shape",
    "deviation_by_scale": "features.scale_maps",
    "energy_signature": "features.signature",
    "estimate_noise": "filtering.noise.white",
    "finished": "refinement.finish",
    "fitted": "accuracy.fitted_heights",
    "ground_points": "features.ground",
    "heights_above_lows": "features.spectrum",
    "heights_above_means": "features.scale_maps",
    "joined_levels": "features.signature",
    "landforms": "features.landforms",
    "level_at_distance": "features.scale_maps",
    "level_spacings": "lifting.spacings",
    "local_means": "features.scale_maps",
    "mesh_of_accuracy": "accuracy.between_levels",
    "mesh_of_size": "accuracy.between_levels",
    "plain_features": "features.signature",
    "refine": "refinement.refine",
    "relifted": "filtering.gains",
    "roughness_by_scale": "features.scale_maps",
    "scale_features": "features.signature",
    "spectral_slope": "features.spectral_slope",
    "surface_shape": "features.shape",
    "vertex_details": "features.spectrum",
    "window_shape": "features.window_shape",
}


if not TYPE_CHECKING:  # who would take every name for one that is here

    def __getattr__(name: str) -> object:
        from importlib import import_module

        if name in _HOMES:
            value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
        elif name in __all__:
            value = import_module(f".{name}", __name__)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
