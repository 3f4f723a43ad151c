"""Landform classes of quadratics, each of which is one form by its signs."""

import numpy as np
import pytest

from wavelet_core import LANDFORMS, OptionError, TriangleMesh, landforms, surface_shape
from wavelet_core.features.shape import SurfaceShape


def shape_of(p=0.0, q=0.0, r=0.0, s=0.0, t=0.0):
    """Return the shape of one vertex with these derivatives."""
    return SurfaceShape(np.array([[p, q]]), np.array([[r, s, t]]))


@pytest.mark.parametrize(
    ("derivatives", "form"),
    [
        ({}, "planar"),
        ({"r": -0.1, "t": -0.1}, "peak"),
        ({"r": 0.1, "t": 0.1}, "pit"),
        ({"r": 0.1, "t": -0.1}, "pass"),
        ({"s": 0.1}, "pass"),
        ({"t": -0.1}, "ridge"),
        ({"t": 0.1}, "channel"),
        ({"p": 0.5, "t": -0.1}, "ridge"),  # a spur down x
        ({"p": 0.5, "t": 0.1}, "channel"),
        ({"p": 0.5, "r": 0.1}, "planar"),  # bent along the slope alone
        ({"p": 0.5, "r": -0.1, "t": -0.1}, "ridge"),  # a dome's flank is no peak
        ({"q": 0.5, "r": -0.1}, "ridge"),
        ({"p": 0.5}, "planar"),
    ],
)
def test_each_form_by_its_derivatives(derivatives, form):
    assert LANDFORMS[landforms(shape_of(**derivatives))[0]] == form


def test_the_bounds_part_flat_from_bent_and_level_from_sloping():
    dome = shape_of(p=0.05, r=-0.01, t=-0.01)  # 2.9 degrees
    assert LANDFORMS[landforms(dome)[0]] == "ridge"
    assert LANDFORMS[landforms(dome, flat_slope=5.0)[0]] == "peak"
    assert LANDFORMS[landforms(dome, flat_slope=5.0, flat_curvature=0.02)[0]] == "planar"
    for wrong in ({"flat_slope": -1.0}, {"flat_curvature": np.nan}):
        with pytest.raises(OptionError, match="give 0 or more"):
            landforms(dome, **wrong)


def test_ridges_and_channels_of_an_egg_box_lie_where_they_should():
    axis = np.arange(0.0, 60.0)
    x, y = np.meshgrid(axis, axis)
    z = 3 * np.cos(2 * np.pi * x / 20) * np.cos(2 * np.pi * y / 20)
    classes = landforms(surface_shape(TriangleMesh.from_grid(z, x=axis, y=axis))).reshape(x.shape)
    assert LANDFORMS[classes[20, 20]] == "peak"
    assert LANDFORMS[classes[20, 30]] == "pit"
    assert LANDFORMS[classes[25, 25]] == "pass"


def test_what_has_no_shape_has_no_form():
    lone = SurfaceShape(np.array([[np.nan, np.nan]]), np.full((1, 3), np.nan))
    assert landforms(lone).tolist() == [-1]
