"""Numba kernels: arrays and scalars in, arrays filled; one file for each kind of step."""
