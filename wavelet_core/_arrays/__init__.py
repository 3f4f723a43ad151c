"""The kernels once more, as whole-array numpy: the engine where numba is absent or still cold.

A module here has the name of its twin in ``_kernels``, and functions of the same names and
arguments, described there. Sums are taken in the same order, so that both engines give the same
bytes.
"""
