"""The Processing algorithms, one a module.

Their ids, parameters and outputs are public: models and scripts store them. None is ever renamed.
"""

from .analyse_dem import AnalyseDem
from .analyse_point_cloud import AnalysePointCloud
from .analyse_tin import AnalyseTin
from .change_by_scale import ChangeByScale
from .classify_ground import ClassifyGround
from .cluster_details import ClusterDetails
from .contours import Contours
from .detail_layers import DetailLayers
from .difference import Difference
from .extract_from_tiles import ExtractFromTiles
from .extract_level import ExtractLevel
from .filter_levels import FilterLevels
from .mesh_quality import MeshQuality
from .profile import Profile
from .quality_report import QualityReport
from .reconstruct import Reconstruct
from .shape_of_level import ShapeOfLevel
from .simplify_dem import SimplifyDem
from .simplify_point_cloud import SimplifyPointCloud
from .thin_point_cloud import ThinPointCloud
from .tile_terrain import TileTerrain
from .web_terrain import WebTerrain

#: In the order of the toolbox's groups.
ALGORITHMS = (
    AnalyseDem,
    AnalysePointCloud,
    AnalyseTin,
    TileTerrain,
    SimplifyDem,
    SimplifyPointCloud,
    ThinPointCloud,
    ClassifyGround,
    ExtractLevel,
    ExtractFromTiles,
    Reconstruct,
    WebTerrain,
    Contours,
    Profile,
    ShapeOfLevel,
    Difference,
    ChangeByScale,
    MeshQuality,
    FilterLevels,
    DetailLayers,
    ClusterDetails,
    QualityReport,
)
