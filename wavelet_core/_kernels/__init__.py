"""Numba kernels: arrays and scalars in, arrays filled. One file per caller module."""
