"""The Processing algorithms, one a module. Their ids, parameters and outputs are public and never renamed."""

from .analyse_dem import AnalyseDem

#: In the order of the toolbox's groups.
ALGORITHMS = (AnalyseDem,)
