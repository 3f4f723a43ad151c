"""The parameters by which every analysis is steered, the same in each algorithm that has them."""

from __future__ import annotations

from qgis.core import (
    QgsProcessingException,
    QgsProcessingParameterEnum,
    QgsProcessingParameterMatrix,
    QgsProcessingParameterNumber,
)

from ..ui.translation import tr

# Kept here, and not asked of wavelet_core, so that the toolbox lists them where SciPy is missing;
# a test compares them with the core's.
#: Leaves the choice to the core, whose defaults are those of the command line.
DEFAULT = "default"
PARTITIONS = ("surface", "quadric", "colouring", "random")
NORMS = ("rms", "max")
PREDICTIONS = (
    "geometric",
    "uniform",
    "cotangent",
    "nnls",
    "least_squares",
    "barycentric",
    "plane",
)
UPDATES = ("minimum_norm", "martinez_ortega", "one_ring_mean", "none")
SIGNALS = ("z", "xyz")
DEFAULT_BENDING_WEIGHT = 1.0
VERTICAL_UNITS = ("from the CRS", "metre", "foot", "us_survey_foot")

INTEGER = QgsProcessingParameterNumber.Type.Integer
DOUBLE = QgsProcessingParameterNumber.Type.Double


def choice(name, description, values, default=None):
    """Return an enum parameter whose values are stored as words, so that lists may grow."""
    return QgsProcessingParameterEnum(
        name,
        description,
        options=list(values),
        defaultValue=values[0] if default is None else default,
        usesStaticStrings=True,
    )


def add_rule_parameters(algorithm) -> None:
    """Declare the most levels and the other stop rules."""
    algorithm.add(
        QgsProcessingParameterNumber(
            "LEVELS", tr("Most levels"), INTEGER, None, optional=True, minValue=1, maxValue=1000
        ),
        tr(
            "How many steps of analysis at most (the paper's L). Each removes about a quarter of "
            "the vertices, so 12 levels leave some 2 %. Fewer come out where nothing more can go. "
            "Empty for 12, or, with a rule below, for as many as that takes."
        ),
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "TARGET_VERTICES", tr("Stop at this number of vertices"), INTEGER, None, True, 1
        ),
        tr("The coarsest level has exactly so many vertices, if it can get there."),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "MAX_ERROR", tr("Stop at this largest error"), DOUBLE, None, True, 0.0
        ),
        tr(
            "No input point is farther above or below the coarsest level, in the unit of elevation."
        ),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterNumber("MAX_RMS", tr("Stop at this RMSE"), DOUBLE, None, True, 0.0),
        tr("The same for the root mean square over all input points, in the unit of elevation."),
        advanced=True,
    )


def add_design_parameters(algorithm) -> None:
    """Declare the design of the wavelets and the vertical unit."""
    algorithm.add(
        choice("PARTITION", tr("Partition"), (DEFAULT, *PARTITIONS)),
        tr(
            "Which vertices go at a level (the paper's odd vertices). <i>surface</i>, the default: "
            "those that raise the vertical error at all input points least; <i>quadric</i>: those "
            "of least cost by generalised quadric and bending energy, as in the paper; "
            "<i>colouring</i>: regardless of shape, the paper's baseline; <i>random</i>: in random "
            "order."
        ),
        advanced=True,
    )
    algorithm.add(
        choice("NORM", tr("Error kept small"), (DEFAULT, *NORMS)),
        tr(
            "By what the <i>surface</i> partition judges: the root mean square (<i>rms</i>) or the "
            "largest error (<i>max</i>). By default the largest where that is the stop rule."
        ),
        advanced=True,
    )
    algorithm.add(
        choice("PREDICTION", tr("Prediction filter"), (DEFAULT, *PREDICTIONS)),
        tr(
            "How a removed vertex is estimated from its neighbours; what is left over is its "
            "detail. By default <i>barycentric</i> with the <i>surface</i> partition, else "
            "<i>geometric</i>. In the paper: <i>geometric</i> GL, <i>uniform</i> UG, "
            "<i>cotangent</i> CL, <i>nnls</i> NNLS (non-negative least squares), "
            "<i>least_squares</i> LS (can be unstable); <i>barycentric</i>: from the coarse "
            "triangle that now covers it; <i>plane</i>: from the plane fitted to the neighbours."
        ),
        advanced=True,
    )
    algorithm.add(
        choice("UPDATE", tr("Update filter"), (DEFAULT, *UPDATES)),
        tr(
            "How details are handed on to the vertices that stay. In the paper: "
            "<i>minimum_norm</i> MN (keeps the weighted mean height at every level), "
            "<i>martinez_ortega</i> MO, <i>one_ring_mean</i> ORMP; <i>none</i> keeps heights as "
            "they are (subsampling)."
        ),
        advanced=True,
    )
    algorithm.add(
        choice("SIGNAL", tr("Lifted coordinates"), SIGNALS),
        tr(
            "<i>z</i>: elevation and attributes, so that x and y stay and every level is a valid "
            "TIN; <i>xyz</i>: all coordinates, as in the paper, where some triangles of a coarse "
            "level may be flipped in plan."
        ),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "BENDING_WEIGHT",
            tr("Weight of bending energy"),
            DOUBLE,
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
            DOUBLE,
            None,
            optional=True,
            minValue=0.01,
            maxValue=1.0,
        ),
        tr(
            "The <i>surface</i> partition takes at most this share of a level's vertices, between "
            "0 and 1; empty for 0.25. A smaller share makes more levels and takes longer, and the "
            "errors are a little smaller."
        ),
        advanced=True,
    )
    algorithm.add(
        choice("VERTICAL_UNIT", tr("Unit of elevation"), VERTICAL_UNITS),
        tr(
            "By default the unit that the CRS states; where it states none, metres for a "
            "geographic CRS and the unit of x and y for any other. Results keep the input's unit."
        ),
        advanced=True,
    )


def add_weights_parameter(algorithm) -> None:
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
            "How much an attribute counts, against the elevation, in which vertices go and how "
            "they are predicted; each is scaled by its range first. 1 where it is not listed, 0 "
            "for one that is only carried along."
        ),
        advanced=True,
    )


def vertical_unit(algorithm, parameters, context):
    """Return the chosen vertical unit, or None for the CRS's."""
    unit = algorithm.parameterAsString(parameters, "VERTICAL_UNIT", context)
    return None if unit in ("", VERTICAL_UNITS[0]) else unit


def rule_options(algorithm, parameters, context, z_scale: float) -> dict:
    """Return the stop rules of ``wavelet_core.analyse`` that the parameters say.

    Parameters
    ----------
    algorithm : QgsProcessingAlgorithm
    parameters : dict
    context : QgsProcessingContext
    z_scale : float
        Working units in one unit of elevation.
    """

    def number(name, read, factor=1):
        is_given = parameters.get(name) is not None
        return read(parameters, name, context) * factor if is_given else None

    return {
        "levels": number("LEVELS", algorithm.parameterAsInt),
        "target_vertices": number("TARGET_VERTICES", algorithm.parameterAsInt),
        "max_error": number("MAX_ERROR", algorithm.parameterAsDouble, z_scale),
        "max_rms": number("MAX_RMS", algorithm.parameterAsDouble, z_scale),
    }


def design_options(algorithm, parameters, context) -> dict:
    """Return the design of ``wavelet_core.analyse`` that the parameters say."""
    chosen = {
        name.lower(): algorithm.parameterAsString(parameters, name, context)
        for name in ("PARTITION", "NORM", "PREDICTION", "UPDATE")
    }
    options = {
        **{name: value for name, value in chosen.items() if value not in ("", DEFAULT)},
        "signal": algorithm.parameterAsString(parameters, "SIGNAL", context),
    }
    # The dialog, and models that were saved, always say one; only another than its default is a
    # wish, which the core refuses beside a partition that has no such weight.
    weight = algorithm.parameterAsDouble(parameters, "BENDING_WEIGHT", context)
    if weight != DEFAULT_BENDING_WEIGHT:
        options["bending_weight"] = weight
    if parameters.get("REMOVAL_FRACTION") is not None:
        options["removal_fraction"] = algorithm.parameterAsDouble(
            parameters, "REMOVAL_FRACTION", context
        )
    return options


def matrix_pairs(algorithm, parameters, name, context) -> list[tuple]:
    """Return the rows of a matrix of two columns; cells left empty do not count.

    Raises
    ------
    ValueError
        When there is a cell without its partner.
    """
    cells = algorithm.parameterAsMatrix(parameters, name, context)
    cells = [cell for cell in cells if cell not in (None, "")]
    return list(zip(cells[::2], cells[1::2], strict=True))


def weights_refusal(algorithm, parameters, context) -> str | None:
    """Return why the weights of attributes cannot be read, or None when they can."""
    try:
        weights = _listed_weights(algorithm, parameters, context).values()
    except ValueError:
        weights = [-1.0]
    if all(0 <= weight < float("inf") for weight in weights):
        return None
    return tr(
        "Weights are pairs of an attribute and a number of 0 or more, such as intensity and 0.5."
    )


def weight_options(algorithm, parameters, context, attribute_names, groups=None) -> dict:
    """Return the weights as options of ``wavelet_core.analyse``; none where none are listed.

    Parameters
    ----------
    algorithm : QgsProcessingAlgorithm
    parameters : dict
    context : QgsProcessingContext
    attribute_names : sequence of str
        Those that are analysed, in their order.
    groups : dict of str to sequence of str, optional
        Names that stand for several attributes, such as ``rgb``.
    """
    listed = _listed_weights(algorithm, parameters, context)
    if not listed:
        return {}
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
    return {"attribute_weights": list(weights.values())}


def _listed_weights(algorithm, parameters, context) -> dict[str, float]:
    pairs = matrix_pairs(algorithm, parameters, "ATTRIBUTE_WEIGHTS", context)
    return {str(name).strip(): float(weight) for name, weight in pairs}
