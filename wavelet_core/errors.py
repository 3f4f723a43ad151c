"""The exception family: one root, each member also the built-in it specialises.

Every message says what is wrong, where, and how to mend it.
"""


class WaveletError(Exception):
    """Root of every error that this project raises on purpose."""


class MeshError(WaveletError, ValueError):
    """A mesh that is no triangulated surface.

    Attributes
    ----------
    index : int or None
        The offending face or vertex, where there is one.
    """

    def __init__(self, message: str, index: int | None = None) -> None:
        super().__init__(message)
        self.index = index


class OptionError(WaveletError, ValueError):
    """An option with a value that is not served, or two that exclude each other."""


class FilterError(WaveletError, ValueError):
    """A prediction or update filter that cannot be built."""


class PyramidError(WaveletError, ValueError):
    """A pyramid whose parts do not fit together, or a level that it does not have."""


class MissingDependencyError(WaveletError, ImportError):
    """An optional package that is needed here and absent."""


class Cancelled(WaveletError):  # noqa: N818 - a stop asked for is not an error to its reader
    """The caller's progress function asked to stop; nothing was left half done."""


class SlowFallbackWarning(UserWarning):
    """Numba is absent, so the kernels run as plain Python."""
