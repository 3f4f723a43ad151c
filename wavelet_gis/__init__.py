"""Terrain in the world: DEM, point cloud and TIN files in and out, the pyramid file, the workflows.

>>> import wavelet_gis as wg
>>> dem = wg.open("dem.tif")  # doctest: +SKIP
>>> wg.save(wg.simplify(dem, vertices=5000), "coarse.ply")  # doctest: +SKIP
>>> wg.save(wg.analyse(dem, levels=12), "dem.gpkg")  # doctest: +SKIP
>>> wg.load("dem.gpkg").restore("same_dem.tif")  # doctest: +SKIP

Names are imported when they are first used, so that a part needs no more than its own packages:
all of `model`, `products` and `workflows`, and of `io` what QGIS uses, run on numpy, scipy and
sqlite3 alone.
"""

# What type checkers take for True; `typing` itself would delay the program's care for interrupts.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from wavelet_gis.report.page import report_page
    from wavelet_gis.report.profile_plot import profile_page
    from wavelet_gis.tiles.cloud.restore import restore_source
    from wavelet_gis.tiles.globe.tileset import Tileset, terrain_tiles
    from wavelet_gis.tiles.read import Region, extract_region, restored_raster
    from wavelet_gis.tiles.tile import Tiled, tile_clouds, tile_rasters
    from wavelet_gis.workflows.analyse import Analysis, analyse
    from wavelet_gis.workflows.details import Details, details
    from wavelet_gis.workflows.extract import Surface, extract
    from wavelet_gis.workflows.filtering import Filtered
    from wavelet_gis.workflows.filtering import filter_pyramid as filter
    from wavelet_gis.workflows.ground import ClassifiedGround, classify_ground
    from wavelet_gis.workflows.learning.cluster import Labelled, classify, cluster
    from wavelet_gis.workflows.learning.labels import labels_from_las, labels_from_layer
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.open import open_data as open
    from wavelet_gis.workflows.read_off.change import ChangeByScale, change_by_scale
    from wavelet_gis.workflows.read_off.contours import Contours, contours
    from wavelet_gis.workflows.read_off.difference import Difference, difference
    from wavelet_gis.workflows.read_off.profile import Profile, profile
    from wavelet_gis.workflows.read_off.quality import LevelQuality, mesh_quality
    from wavelet_gis.workflows.reconstruct import Reconstruction, reconstruct
    from wavelet_gis.workflows.save import save
    from wavelet_gis.workflows.simplify import Simplified, simplify

__all__ = [
    "Analysis",
    "ChangeByScale",
    "ClassifiedGround",
    "Contours",
    "Details",
    "Difference",
    "Filtered",
    "Labelled",
    "LevelQuality",
    "Profile",
    "Reconstruction",
    "Region",
    "Simplified",
    "Surface",
    "Tiled",
    "Tileset",
    "analyse",
    "change_by_scale",
    "classify",
    "classify_ground",
    "cluster",
    "contours",
    "details",
    "difference",
    "extract",
    "extract_region",
    "filter",
    "labels_from_las",
    "labels_from_layer",
    "load",
    "mesh_quality",
    "open",
    "profile",
    "profile_page",
    "reconstruct",
    "report_page",
    "restore_source",
    "restored_raster",
    "save",
    "simplify",
    "terrain_tiles",
    "tile_clouds",
    "tile_rasters",
]

#: Where each public name is, and what it is called there.
_HOMES = {
    "Analysis": "workflows.analyse:Analysis",
    "Details": "workflows.details:Details",
    "Filtered": "workflows.filtering:Filtered",
    "Labelled": "workflows.learning.cluster:Labelled",
    "Reconstruction": "workflows.reconstruct:Reconstruction",
    "Simplified": "workflows.simplify:Simplified",
    "Surface": "workflows.extract:Surface",
    "Region": "tiles.read:Region",
    "Tiled": "tiles.tile:Tiled",
    "Tileset": "tiles.globe.tileset:Tileset",
    "analyse": "workflows.analyse:analyse",
    "ChangeByScale": "workflows.read_off.change:ChangeByScale",
    "change_by_scale": "workflows.read_off.change:change_by_scale",
    "Contours": "workflows.read_off.contours:Contours",
    "Difference": "workflows.read_off.difference:Difference",
    "LevelQuality": "workflows.read_off.quality:LevelQuality",
    "Profile": "workflows.read_off.profile:Profile",
    "contours": "workflows.read_off.contours:contours",
    "difference": "workflows.read_off.difference:difference",
    "mesh_quality": "workflows.read_off.quality:mesh_quality",
    "profile": "workflows.read_off.profile:profile",
    "profile_page": "report.profile_plot:profile_page",
    "ClassifiedGround": "workflows.ground:ClassifiedGround",
    "classify": "workflows.learning.cluster:classify",
    "classify_ground": "workflows.ground:classify_ground",
    "cluster": "workflows.learning.cluster:cluster",
    "details": "workflows.details:details",
    "extract": "workflows.extract:extract",
    "filter": "workflows.filtering:filter_pyramid",
    "labels_from_las": "workflows.learning.labels:labels_from_las",
    "labels_from_layer": "workflows.learning.labels:labels_from_layer",
    "load": "workflows.open:load",
    "open": "workflows.open:open_data",
    "reconstruct": "workflows.reconstruct:reconstruct",
    "report_page": "report.page:report_page",
    "save": "workflows.save:save",
    "simplify": "workflows.simplify:simplify",
    "extract_region": "tiles.read:extract_region",
    "restore_source": "tiles.cloud.restore:restore_source",
    "restored_raster": "tiles.read:restored_raster",
    "terrain_tiles": "tiles.globe.tileset:terrain_tiles",
    "tile_clouds": "tiles.tile:tile_clouds",
    "tile_rasters": "tiles.tile:tile_rasters",
}


def __getattr__(name: str) -> "Any":
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name].split(":")
    return getattr(import_module(f"{__name__}.{module}"), attribute)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
