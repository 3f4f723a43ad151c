"""``--print-completion SHELL``: what a shell needs to complete the command, by shtab."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

__all__ = ["SHELLS", "PrintCompletion", "completion"]

SHELLS = ("bash", "zsh", "tcsh")


def completion(parser: argparse.ArgumentParser, shell: str) -> str:
    """Return the script that completes commands, options and file names.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Of all commands.
    shell : str
        One of `SHELLS`.

    Raises
    ------
    MissingDependencyError
        Without shtab.
    """
    try:
        import shtab
    except ImportError as error:
        from wavelet_core.errors import MissingDependencyError

        raise MissingDependencyError(
            "completion needs the Python package shtab; install it: pip install shtab"
        ) from error
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                for argument in command._actions:
                    if not argument.option_strings:
                        argument.complete = shtab.FILE
    script: str = shtab.complete(parser, shell)
    return script


class PrintCompletion(argparse.Action):
    """Prints the script and ends, as ``--version`` does."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        """Print the script for the shell that was named."""
        from wavelet_core.errors import MissingDependencyError

        try:
            print(completion(parser, str(values)))
        except MissingDependencyError as error:
            parser.exit(1, f"{parser.prog}: error: {error}\n")
        parser.exit(0)
