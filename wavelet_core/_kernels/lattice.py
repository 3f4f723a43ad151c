"""Rounding that makes equal what differs by rounding."""

import math

import numpy as np

from ._jit import inlined


# The value on a lattice of the next power of two above `step`: nearly always equal for two values
# that lie much closer than that, and always for those about a multiple of it, such as 0
@inlined
def on_lattice(value, step):
    if step <= 0.0:
        return value
    width = math.ldexp(1.0, math.frexp(step)[1])
    return np.rint(value / width) * width
