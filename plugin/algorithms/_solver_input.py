"""The parameters of a mesh for a solver: what its angles and edges have to be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsProcessingParameterNumber

from ..ui.dependencies import CGAL, SHAPELY
from ..ui.enums import REAL_NUMBER
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_gis.workflows.simplify import Simplified

    from ..base import TerrainWaveletsAlgorithm
    from ..parameters.request import Request
    from ..qgis_io.background import Work
    from ..ui.dependencies import Package

#: The keyword of each parameter.
RULES = {
    "MIN_ANGLE": "min_angle",
    "LONGEST_EDGE": "longest_edge",
    "SHORTEST_EDGE": "shortest_edge",
    "MAX_AREA": "max_area",
}


def add_solver_parameters(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare MIN_ANGLE, LONGEST_EDGE, SHORTEST_EDGE and MAX_AREA."""
    for name, description, text, largest in (
        (
            "MIN_ANGLE",
            tr("Smallest angle for a solver"),
            tr(
                "In degrees, at most 30; 25 where another of these bounds is given. Nodes are "
                "added to the TIN until all bounds hold. Needs the Python packages cgal and "
                "shapely."
            ),
            30.0,
        ),
        (
            "LONGEST_EDGE",
            tr("Longest edge for a solver"),
            tr("In the unit of the CRS, metres for degrees: no edge is longer."),
            None,
        ),
        (
            "SHORTEST_EDGE",
            tr("Shortest edge for a solver"),
            tr("No two vertices of the TIN are nearer, but for those of outline and lines."),
            None,
        ),
        (
            "MAX_AREA",
            tr("Largest triangle for a solver"),
            tr("Its area, in the squared unit of the CRS."),
            None,
        ),
    ):
        parameter = QgsProcessingParameterNumber(name, description, REAL_NUMBER, None, True, 0.0)
        if largest is not None:
            parameter.setMaximum(largest)
        algorithm.add(parameter, text, advanced=True)


def solver_rules(request: Request) -> dict[str, float]:
    """Return the bounds that are given, by the names of ``Simplified.for_solver``."""
    given = {keyword: request.number(name) for name, keyword in RULES.items()}
    return {keyword: value for keyword, value in given.items() if value is not None}


def solver_packages(request: Request) -> tuple[Package, ...]:
    """Return what making the mesh needs."""
    return (CGAL, SHAPELY) if solver_rules(request) else ()


def solver_refusal(request: Request) -> str | None:
    """Return why no mesh can keep the bounds."""
    rules = solver_rules(request)
    if not rules:
        return None
    from wavelet_core.errors import OptionError
    from wavelet_gis.workflows.solver.solver_mesh import SolverRules

    try:
        SolverRules(**rules).require_sense()
    except OptionError as error:
        from ..ui.wording import in_words, labels_of

        return in_words(error, labels_of(request.algorithm))
    return None


def for_solver(request: Request, simplified: Simplified) -> Simplified:
    """Return the TIN with the nodes that the bounds take; itself where none is given."""
    rules = solver_rules(request)
    if not rules:
        return simplified
    request.stage(tr("Meshing for a solver"))

    def compute(work: Work) -> Simplified:
        return simplified.for_solver(progress=work.progress, **rules)

    made = request.computed(compute, 0.65, 0.7)
    quality = made.quality
    if quality is not None:
        request.say(
            tr("Angles {:.3g} to {:.3g} degrees, edges {:.4g} to {:.4g}, areas to {:.4g}").format(
                quality.smallest_angle,
                quality.largest_angle,
                quality.shortest_edge,
                quality.longest_edge,
                quality.largest_area,
            )
        )
    return made
