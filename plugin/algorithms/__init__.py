"""The Processing algorithms, one a module. Their ids, parameters and outputs are public and never renamed."""

from .analyse_dem import AnalyseDem
from .detail_layers import DetailLayers
from .reconstruct import Reconstruct

#: In the order of the toolbox's groups.
ALGORITHMS = (AnalyseDem, Reconstruct, DetailLayers)
