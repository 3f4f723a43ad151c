"""Names of Python parameters in the words of the command line.

A command's argument has the parameter's name for its ``dest``, so argparse's own tables tell the
flag: ``max_rms`` is ``--rmse`` of *simplify* and ``--max-rms`` of *analyse*.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

__all__ = ["flag_names"]

#: Parameters of the core that the commands' functions know by another name.
_OF_THE_CORE = {
    "target_vertices": "vertices",
    "n_vertices": "vertices",
    "sigma": "denoise",
    "lengths": "metres",
    "distance": "metres",
}


def flag_names(
    command: argparse.ArgumentParser, others: Sequence[argparse.ArgumentParser] = ()
) -> Callable[[str], str]:
    """Return the function from a parameter to its flag.

    Parameters
    ----------
    command : ArgumentParser
        Whose flags come first.
    others : sequence of ArgumentParser
        Of the other commands, for advice to run one of them otherwise.

    Returns
    -------
    callable
        A parameter that no command has keeps its name.

    Examples
    --------
    >>> parser = argparse.ArgumentParser()
    >>> _ = parser.add_argument("--rmse", dest="max_rms")
    >>> _ = parser.add_argument("--no-fit", dest="fit", action="store_false")
    >>> [flag_names(parser)(name) for name in ("max_rms", "fit", "repair")]
    ['--rmse', 'no --no-fit', 'repair']
    """
    own = _flags_of([command])
    of_others = _flags_of(others)

    def name_of(parameter: str) -> str:
        synonym = _OF_THE_CORE.get(parameter, parameter)
        return own.get(parameter) or own.get(synonym) or of_others.get(parameter, parameter)

    return name_of


def _flags_of(parsers: Sequence[argparse.ArgumentParser]) -> dict[str, str]:
    flags: dict[str, str] = {}
    for parser in parsers:
        for action in parser._actions:
            if action.option_strings:
                flag = action.option_strings[0]
                is_switch_off = isinstance(action, argparse._StoreFalseAction)
                flags.setdefault(action.dest, f"no {flag}" if is_switch_off else flag)
    return flags
