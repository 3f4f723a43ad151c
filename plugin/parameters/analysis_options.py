"""The parameters by which every analysis is steered, the same in each algorithm that has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

from qgis.core import QgsProcessingParameterMatrix, QgsProcessingParameterNumber

from ..ui.enums import REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .choices import choice, core_table, table_choice

if TYPE_CHECKING:
    from wavelet_gis.workflows.options import WaveletOptions

    from ..base import TerrainWaveletsAlgorithm
    from .request import Request

VERTICAL_UNITS = ("from the CRS", "metre", "foot", "us_survey_foot")
DEFAULT_BENDING_WEIGHT = 1.0


class StopRules(TypedDict):
    """The keywords of ``wavelet_gis.workflows.analyse`` that say when to stop."""

    levels: int | None
    target_vertices: int | None
    max_error: float | None
    max_rms: float | None


def add_rule_parameters(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare the most levels and the other stop rules."""
    algorithm.add(
        QgsProcessingParameterNumber(
            "LEVELS", tr("Most levels"), WHOLE_NUMBER, None, optional=True, minValue=1,
            maxValue=1000,
        ),
        tr(
            "How many steps of analysis at most (the paper's L). Each removes up to a quarter of "
            "the vertices. Fewer come out where nothing more can go. Empty for as many as a rule "
            "below takes; without one for 24, not counting those that thin flat parts alone, or 12 "
            "with another partition than <i>surface</i>."
        ),
    )  # fmt: skip
    algorithm.add(
        QgsProcessingParameterNumber(
            "TARGET_VERTICES", tr("Stop at this number of vertices"), WHOLE_NUMBER, None, True, 3
        ),
        tr(
            "The coarsest level has exactly this many vertices, if it can get there; the log says "
            "why if it cannot."
        ),
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "MAX_ERROR", tr("Stop at this largest error"), REAL_NUMBER, None, True, 0.0
        ),
        tr(
            "No input point is farther above or below the coarsest level, in the unit of elevation."
        ),
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "MAX_RMS", tr("Stop at this RMSE"), REAL_NUMBER, None, True, 0.0
        ),
        tr("The same for the root mean square over all input points, in the unit of elevation."),
    )


def add_design_parameters(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare the design of the wavelets and the vertical unit."""
    _add_choices(algorithm)
    _add_numbers(algorithm)
    add_vertical_unit(algorithm)


def _add_choices(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare what is chosen from the tables of the core."""
    for name, table, description, text in (
        (
            "PARTITION",
            "PARTITIONS",
            tr("Partition"),
            tr(
                "Which vertices are removed at a level (the paper's odd vertices). By default "
                "<i>surface</i>, or <i>quadric</i> with another filter than <i>barycentric</i>."
            ),
        ),
        (
            "NORM",
            "NORMS",
            tr("Error kept small"),
            tr(
                "What the <i>surface</i> partition keeps small. By default <i>rms</i>, or "
                "<i>max</i> where the largest error is the stop rule."
            ),
        ),
        (
            "PREDICTION",
            "PREDICTIONS",
            tr("Prediction filter"),
            tr(
                "How a removed vertex is estimated from its neighbours; what is left over is its "
                "detail. By default <i>barycentric</i> with the <i>surface</i> partition, else "
                "<i>geometric</i>."
            ),
        ),
        (
            "UPDATE",
            "UPDATES",
            tr("Update filter"),
            tr("How details are passed on to the vertices that stay."),
        ),
        (
            "SIGNAL",
            "SIGNALS",
            tr("Lifted coordinates"),
            tr("What the wavelets transform. By default <i>z</i>."),
        ),
        (
            "QUADRICS",
            "QUADRICS",
            tr("Quadrics of the paper's partition"),
            tr(
                "What becomes of the quadrics from level to level, with the <i>quadric</i> "
                "partition. By default as the paper says."
            ),
        ),
        (
            "COST",
            "COSTS",
            tr("Cost of the paper's partition"),
            tr("By what the <i>quadric</i> partition ranks. By default as the paper says."),
        ),
    ):
        parameter, rows = table_choice(name, description, core_table(table))
        algorithm.add(parameter, text + rows, advanced=True)


def _add_numbers(algorithm: TerrainWaveletsAlgorithm) -> None:
    algorithm.add(
        QgsProcessingParameterNumber(
            "BENDING_WEIGHT",
            tr("Weight of bending energy"),
            REAL_NUMBER,
            DEFAULT_BENDING_WEIGHT,
            minValue=0.0,
        ),
        tr("Weight of curvature in the cost of the <i>quadric</i> partition; no unit."),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "REMOVAL_FRACTION",
            tr("Largest share removed at a level"),
            REAL_NUMBER,
            None,
            optional=True,
            minValue=0.01,
            maxValue=1.0,
        ),
        tr(
            "The <i>surface</i> partition removes at most this share of a level's vertices, "
            "between 0 and 1; empty for the default. A smaller share makes more levels and takes "
            "longer, and the errors are a little smaller."
        ),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "OUTLINE_TOLERANCE",
            tr("Tolerance of the outline"),
            REAL_NUMBER,
            None,
            optional=True,
            minValue=0.0,
        ),
        tr(
            "How far the outline, holes included, may move in plan, in the unit of x and y (metres "
            "for a geographic CRS), with the <i>surface</i> partition. Empty for 0: vertices of "
            "the outline are removed only where it runs straight, which limits how coarse a level "
            "can become. The log says how much the area changes."
        ),
        advanced=True,
    )


def add_vertical_unit(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare the unit of elevation."""
    algorithm.add(
        choice("VERTICAL_UNIT", tr("Unit of elevation"), VERTICAL_UNITS),
        tr(
            "By default the unit that the CRS states; where it states none, metres for a "
            "geographic CRS and the unit of x and y for any other. Results keep the input's unit."
        ),
        advanced=True,
    )


def add_weights_parameter(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare the weights of attributes, for the analyses that have any."""
    algorithm.add(
        QgsProcessingParameterMatrix(
            "ATTRIBUTE_WEIGHTS",
            tr("Weights of attributes"),
            1,
            False,
            [tr("Attribute"), tr("Weight")],
            optional=True,
        ),
        tr(
            "How much an attribute counts, compared with the elevation, in which vertices are "
            "removed and how they are predicted; each is scaled by its range first. 1 where it is "
            "not listed, 0 for one that is only carried along."
        ),
        advanced=True,
    )


def vertical_unit(request: Request) -> str | None:
    """Return the chosen vertical unit, or None for the CRS's."""
    unit = request.text("VERTICAL_UNIT")
    return None if unit in ("", VERTICAL_UNITS[0]) else unit


def stop_rules(request: Request) -> StopRules:
    """Return the stop rules that the parameters say, in the input's units."""
    return {
        "levels": request.whole("LEVELS"),
        "target_vertices": request.whole("TARGET_VERTICES"),
        "max_error": request.number("MAX_ERROR"),
        "max_rms": request.number("MAX_RMS"),
    }


def design_options(request: Request) -> WaveletOptions:
    """Return the design of the wavelets that the parameters say."""
    # The dialog, and models that were saved, always say a weight; only another than its default is
    # a wish, which the core refuses beside a partition that has no such weight.
    weight = request.number("BENDING_WEIGHT")
    return {
        "partition": request.choice("PARTITION"),
        "norm": request.choice("NORM"),
        "prediction": request.choice("PREDICTION"),
        "update": request.choice("UPDATE"),
        "signal": request.choice("SIGNAL"),
        "quadrics": request.choice("QUADRICS"),
        "cost": request.choice("COST"),
        "bending_weight": None if weight == DEFAULT_BENDING_WEIGHT else weight,
        "removal_fraction": request.number("REMOVAL_FRACTION"),
        "outline_tolerance": request.number("OUTLINE_TOLERANCE"),
    }


def weights_refusal(request: Request) -> str | None:
    """Return why the weights of attributes cannot be read, or None when they can."""
    try:
        weights = list(_listed_weights(request).values())
    except ValueError:
        weights = [-1.0]
    if all(0 <= weight < float("inf") for weight in weights):
        return None
    return tr(
        "Weights are pairs of an attribute and a number of 0 or more, such as intensity and 0.5."
    )


def weight_options(
    request: Request,
    attribute_names: Sequence[str],
    groups: Mapping[str, Sequence[str]] | None = None,
) -> list[float] | None:
    """Return the weight of each attribute; None where none is listed.

    Parameters
    ----------
    request : Request
        What was asked for.
    attribute_names : sequence of str
        Those that are analysed, in their order.
    groups : mapping of str to sequence of str, optional
        Names that stand for several attributes, such as ``rgb``.
    """
    listed = _listed_weights(request)
    if not listed:
        return None
    weights = dict.fromkeys(attribute_names, 1.0)
    for name, weight in listed.items():
        members = [member for member in (groups or {}).get(name, [name]) if member in weights]
        if not members:
            raise QgsProcessingException(
                tr("There is no attribute {} to be weighted; {}.").format(
                    name,
                    tr("those analysed are: {}").format(", ".join(attribute_names))
                    if attribute_names
                    else tr("choose the attributes first"),
                )
            )
        weights.update(dict.fromkeys(members, weight))
    return list(weights.values())


def _listed_weights(request: Request) -> dict[str, float]:
    pairs: list[tuple[Any, Any]] = request.pairs("ATTRIBUTE_WEIGHTS")
    return {str(name).strip(): float(weight) for name, weight in pairs}
