"""The exception family: one root, each member also the built-in it specialises.

Every message says what is wrong, where, and how to mend it. It names the parameters of the Python
functions; a command line or a dialog, whose users know them by other names, asks the error for
its text in those (:meth:`WaveletError.in_words`) and never has to look into the text.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Worded(Exception):  # noqa: N818 - what errors and warnings have in common
    """A message that can be put in the words of its reader.

    Parameters
    ----------
    message : str
        The text; with parameters or values, a template of :meth:`str.format`.
    *options : str
        Names of the Python parameters that it is about: ``{0}``, ``{1}`` in the template.
    **values : Any
        What else the template shows, by name.

    Attributes
    ----------
    template : str
    options : tuple of str
    values : dict

    Examples
    --------
    >>> error = WaveletError("{0} is {given}; give 0 or more.", "max_error", given=-1)
    >>> str(error)
    'max_error is -1; give 0 or more.'
    >>> error.in_words(lambda option: "--" + option.replace("_", "-"))
    '--max-error is -1; give 0 or more.'
    """

    def __init__(self, message: str = "", *options: str, **values: Any) -> None:
        self.template = message
        self.options = options
        self.values = values
        super().__init__(self.in_words(str))

    def in_words(self, name_of: Callable[[str], str]) -> str:
        """Return the message with the parameters named as the reader knows them.

        Parameters
        ----------
        name_of : callable
            From the name of a Python parameter to what it is called.
        """
        if not self.options and not self.values:
            return self.template
        return self.template.format(*map(name_of, self.options), **self.values)


class WaveletError(Worded):
    """Root of every error that this project raises on purpose.

    Parameters
    ----------
    message, *options, **values
        See `Worded`.
    """

    @property
    def option(self) -> str | None:
        """The parameter that the error is about, the first if there are several; or None."""
        return self.options[0] if self.options else None


class MeshError(WaveletError, ValueError):
    """A mesh that is no triangulated surface.

    Attributes
    ----------
    index : int or None
        The offending face or vertex, where there is one.
    """

    def __init__(
        self, message: str, index: int | None = None, *options: str, **values: Any
    ) -> None:
        super().__init__(message, *options, **values)
        self.index = index


class OptionError(WaveletError, ValueError):
    """An option whose value is refused, or options that contradict each other: ``options``."""


class PyramidError(WaveletError, ValueError):
    """A pyramid whose parts do not fit together, or a level that it does not have.

    Attributes
    ----------
    level : int or None
        The level that is not there, or whose step is at fault.
    """

    def __init__(
        self, message: str, level: int | None = None, *options: str, **values: Any
    ) -> None:
        super().__init__(message, *options, **values)
        self.level = level


class MissingDependencyError(WaveletError, ImportError):
    """An optional package that is needed here and absent."""


class Cancelled(WaveletError):  # noqa: N818 - a stop asked for is not an error to its reader
    """The caller's progress function asked to stop; nothing was left half done."""


class WaveletWarning(UserWarning):
    """Root of the warnings of the mathematics: the result is there, but mind how it came about."""


class SlowFallbackWarning(WaveletWarning):
    """Numba is absent, so the work takes two to seven times as long, with the same result.

    To refine a TIN within a tolerance takes 6 to 17 times as long.
    """


class UnstableDesignWarning(WaveletWarning):
    """A pair of filters of the paper whose coefficients may grow without bound."""
