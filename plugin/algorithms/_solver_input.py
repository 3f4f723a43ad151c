"""The parameters of a mesh for a solver: what its angles and edges have to be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterLayer,
)

from ..parameters.tolerance import ByPlace, LayersByPlace, take_layers_by_place, values_at
from ..ui.dependencies import CGAL, SHAPELY
from ..ui.enums import NUMERIC_FIELD, POLYGONS, REAL_NUMBER
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_gis.workflows.simplify import Simplified

    from ..base import TerrainWaveletsAlgorithm
    from ..parameters.request import Request
    from ..qgis_io.background import Work
    from ..ui.dependencies import Package

#: Degrees, where another bound is given.
DEFAULT_ANGLE = 25.0

#: The keyword of each parameter.
RULES = {
    "MIN_ANGLE": "min_angle",
    "LONGEST_EDGE": "longest_edge",
    "SHORTEST_EDGE": "shortest_edge",
    "MAX_AREA": "max_area",
    "GRADING": "grading",
}


def add_solver_parameters(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare the bounds of angles, edges and areas, and what gives sizes by place."""
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
        (
            "GRADING",
            tr("Growth of edges for a solver"),
            tr(
                "By how much edges may grow for each unit of distance, from where sizes or the TIN "
                "are finer; such as 0.2."
            ),
            None,
        ),
    ):
        parameter = QgsProcessingParameterNumber(name, description, REAL_NUMBER, None, True, 0.0)
        if largest is not None:
            parameter.setMaximum(largest)
        algorithm.add(parameter, text, advanced=True)
    _add_size_layers(algorithm)


def _add_size_layers(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare SIZE_ZONES, SIZE_FIELD, AREA_FIELD and SIZE_RASTER."""
    algorithm.add(
        QgsProcessingParameterFeatureSource(
            "SIZE_ZONES", tr("Zones of other sizes for a solver"), [POLYGONS], optional=True
        ),
        tr(
            "Polygons with a longest edge or a largest area of their own; where several overlap, "
            "the least counts. The sizes above hold outside."
        ),
        advanced=True,
    )
    for name, description in (
        ("SIZE_FIELD", tr("Field with the longest edge")),
        ("AREA_FIELD", tr("Field with the largest area")),
    ):
        algorithm.add(
            QgsProcessingParameterField(
                name, description, None, "SIZE_ZONES", NUMERIC_FIELD, optional=True
            ),
            tr("Of the zones of other sizes."),
            advanced=True,
        )
    algorithm.add(
        QgsProcessingParameterRasterLayer(
            "SIZE_RASTER", tr("Raster of longest edges"), optional=True
        ),
        tr("Instead of one number: the longest edge by place; any where there is no data."),
        advanced=True,
    )


def take_sizes(request: Request) -> LayersByPlace:
    """Take from the layers, in their own thread, what reading them needs."""
    return take_layers_by_place(request, "SIZE_ZONES", "SIZE_RASTER")


def _is_asked_for(request: Request) -> bool:
    return bool(solver_rules(request)) or request.has("SIZE_ZONES") or request.has("SIZE_RASTER")


def solver_rules(request: Request) -> dict[str, float]:
    """Return the bounds that are given, by the names of ``Simplified.for_solver``."""
    given = {keyword: request.number(name) for name, keyword in RULES.items()}
    return {keyword: value for keyword, value in given.items() if value is not None}


def solver_packages(request: Request) -> tuple[Package, ...]:
    """Return what making the mesh needs."""
    return (CGAL, SHAPELY) if _is_asked_for(request) else ()


def solver_refusal(request: Request) -> str | None:
    """Return why no mesh can keep the bounds."""
    has_field = request.has("SIZE_FIELD") or request.has("AREA_FIELD")
    if request.has("SIZE_ZONES") != has_field:
        return tr("Give zones of other sizes and a field with their size, or neither.")
    if request.has("SIZE_RASTER") and request.has("LONGEST_EDGE"):
        return tr("Give a raster of longest edges, or one longest edge, not both.")
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


def before_meshing(request: Request) -> float:
    """Return the part of the bar that the TIN takes, before it becomes a mesh for a solver."""
    return 0.5 if _is_asked_for(request) else 0.65


def for_solver(request: Request, simplified: Simplified, given: LayersByPlace) -> Simplified:
    """Return the TIN with the nodes that the bounds take; itself where none is given."""
    if not _is_asked_for(request):
        return simplified
    rules = solver_rules(request)
    request.stage(tr("Meshing for a solver"))
    sizes = _sizes_by_place(request, simplified, given)

    def compute(work: Work) -> Simplified:
        return simplified.for_solver(
            min_angle=rules.get("min_angle", DEFAULT_ANGLE),
            shortest_edge=rules.get("shortest_edge"),
            longest_edge=sizes.get("longest_edge", rules.get("longest_edge")),
            max_area=sizes.get("max_area", rules.get("max_area")),
            grading=rules.get("grading"),
            progress=work.progress,
        )

    made = request.computed(compute, before_meshing(request), 0.7)
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


def _sizes_by_place(
    request: Request, simplified: Simplified, given: LayersByPlace
) -> dict[str, NDArray[np.float64]]:
    """Return the sizes that layers give, by keyword, for the vertices of the terrain."""
    terrain, found = simplified.terrain, {}
    assert terrain is not None
    for name, field_name, raster in (
        ("LONGEST_EDGE", "SIZE_FIELD", given.raster),
        ("MAX_AREA", "AREA_FIELD", None),
    ):
        zones = given.zones if request.has(field_name) else None
        if zones is not None or raster is not None:
            by_place = ByPlace(request.number(name), raster, zones, request.text(field_name))
            found[RULES[name]] = values_at(request, terrain, terrain.mesh, by_place)
    return found
