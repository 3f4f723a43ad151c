"""The exponent of the spectrum, of surfaces made with a known one."""

import numpy as np
import pytest

from wavelet_core import OptionError, TriangleMesh, analyse, spectral_slope, synthetic

#: Cells of the surface that is made for one that is kept: a fractal has forms below any cell.
FINER = 4


def fractal(n, beta, seed):
    """Return a surface with the spectrum k to the power of -beta, made by spectral synthesis."""
    size = 2 * n * FINER  # twice as large as what is kept, which so does not wrap round
    rng = np.random.default_rng(seed)
    k = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size))
    k[0, 0] = np.inf
    spectrum = np.fft.rfft2(rng.normal(size=(size, size))) * k ** (-beta / 2)
    return np.fft.irfft2(spectrum, s=(size, size))[: n * FINER : FINER, : n * FINER : FINER]


def on_a_grid(z):
    axis = np.arange(len(z)) * 1.0
    return TriangleMesh.from_grid(z, x=axis, y=axis)


def at_points(z):
    rows, columns = np.nonzero(np.random.default_rng(5).random(z.shape) < 0.4)
    return TriangleMesh.from_points(np.column_stack([columns, rows, z[rows, columns]]))


@pytest.mark.parametrize("beta", [3.0, 3.5, 4.0])
@pytest.mark.parametrize("mesh_of", [on_a_grid, at_points])
def test_the_slope_of_a_fractal_surface_is_within_five_percent(beta, mesh_of):
    mesh = mesh_of(fractal(160, beta, seed=1))
    pyramid = analyse(mesh, levels=16, partition="random", prediction="plane")
    assert spectral_slope(pyramid) == pytest.approx(beta, rel=0.05)


def test_it_has_no_unit_and_attributes_have_one_too():
    z = fractal(80, 3.0, seed=2)
    mesh = on_a_grid(z)
    other = TriangleMesh(mesh.vertices * (10, 10, 3), mesh.faces, z.reshape(-1, 1), ("a",))
    slopes = [
        spectral_slope(analyse(m, levels=10, partition="random", prediction="plane"), channel)
        for m, channel in ((mesh, "z"), (other, "z"), (other, "a"))
    ]
    assert slopes[1] == pytest.approx(slopes[0], abs=1e-6)
    assert slopes[2] == pytest.approx(slopes[0], abs=1e-6)


def test_too_little_terrain_is_refused():
    pyramid = analyse(synthetic.hills(10, 10), levels=3, partition="random", prediction="plane")
    with pytest.raises(OptionError, match="analyse with more levels"):
        spectral_slope(pyramid)
    with pytest.raises(OptionError, match="no channel 'hag'"):
        spectral_slope(pyramid, "hag")
    plane = analyse(synthetic.plane(), levels=6, partition="random", prediction="plane")
    with pytest.raises(OptionError, match="without error"):
        spectral_slope(plane)
