"""Formulas of the terrain, read without running anything but arithmetic."""

from __future__ import annotations

import ast
import os
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError

__all__ = ["parsed", "value_of"]

FloatArray = NDArray[np.float64]

#: What a formula may call; by functions of ours, since numpy's write into a second argument.
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": lambda value: np.abs(value),
    "clip": lambda value, least, most: np.clip(value, least, most),
    "exp": lambda value: np.exp(value),
    "log": lambda value: np.log(value),
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "sqrt": lambda value: np.sqrt(value),
    "where": lambda condition, then, otherwise: np.where(condition, then, otherwise),
}
_OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.USub: np.negative,
    ast.UAdd: np.positive,
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}


def parsed(text: str) -> ast.expr | None:
    """Return a formula, or None of what is to be a file."""
    if os.path.exists(text):
        return None
    try:
        formula = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    if isinstance(formula, ast.Attribute):  # a file's name, as Python reads it
        return None
    return formula


def value_of(
    part: ast.expr,
    variables: Mapping[str, Callable[[], FloatArray]],
    text: str,
    option: str = "max_error",
) -> Any:
    """Return what a part of a formula comes to; only numbers, names and calls that are known."""

    def of(node: ast.expr) -> Any:
        return value_of(node, variables, text, option)

    if isinstance(part, ast.Constant) and isinstance(part.value, int | float):
        try:
            return float(part.value)
        except OverflowError:
            return np.inf  # as a float of so many digits is read
    if isinstance(part, ast.Name) and part.id in variables:
        return variables[part.id]()
    with np.errstate(all="ignore"):
        if isinstance(part, ast.BinOp) and type(part.op) in _OPERATORS:
            return _OPERATORS[type(part.op)](of(part.left), of(part.right))
        if isinstance(part, ast.UnaryOp) and type(part.op) in _OPERATORS:
            return _OPERATORS[type(part.op)](of(part.operand))
        if isinstance(part, ast.Compare) and len(part.ops) == 1 and type(part.ops[0]) in _OPERATORS:
            return _OPERATORS[type(part.ops[0])](of(part.left), of(part.comparators[0]))
        if (
            isinstance(part, ast.Call)
            and isinstance(part.func, ast.Name)
            and part.func.id in _FUNCTIONS
            and not part.keywords
        ):
            try:
                return _FUNCTIONS[part.func.id](*(of(argument) for argument in part.args))
            except (TypeError, ValueError) as error:
                raise OptionError(
                    "{0} {text!r}: {call} takes other arguments ({reason}).",
                    option,
                    text=text,
                    call=part.func.id,
                    reason=str(error).split("\n")[0],
                ) from error
    raise OptionError(
        "{0} {text!r} is not an existing raster, and as a formula {part!r} is not understood; "
        "formulas have numbers, {names}, + - * / **, comparisons and {calls}.",
        option,
        text=text,
        part=ast.unparse(part),
        names=" and ".join(variables),
        calls=", ".join(_FUNCTIONS),
    )
