"""A mesh that is itself a level of a pyramid: its scaling functions have integrals of their own."""

import numpy as np
import pytest

from wavelet_core import OptionError, analyse, synthetic

MESH = synthetic.hills(20, 30)
WEIGHTS = np.random.default_rng(4).uniform(0.5, 3.0, MESH.n_vertices)


@pytest.mark.parametrize("partition", ["surface", "quadric"])
def test_their_sum_with_the_heights_stays_what_it_was(partition):
    pyramid = analyse(MESH, levels=4, partition=partition, integrals=WEIGHTS)
    for level, mesh in enumerate(pyramid):
        integrals = pyramid.integrals(level)
        assert integrals @ mesh.vertices[:, 2] == pytest.approx(WEIGHTS @ MESH.vertices[:, 2])
        assert integrals.sum() == pytest.approx(WEIGHTS.sum())
    assert np.allclose(pyramid[-1].vertices, MESH.vertices, atol=1e-12)


def test_two_analyses_one_after_the_other_are_one_as_to_their_integrals():
    fine = analyse(MESH, levels=3)
    coarse = analyse(fine[0], levels=3, integrals=fine.integrals(0))
    sums = [p.integrals(k) @ p[k].vertices[:, 2] for p in (fine, coarse) for k in range(len(p))]
    assert np.allclose(sums, MESH.vertices[:, 2].sum())


def test_ones_are_the_default():
    plain = analyse(MESH, levels=3)
    assert analyse(MESH, levels=3, integrals=np.ones(MESH.n_vertices)) == plain


@pytest.mark.parametrize("integrals", [np.ones(3), np.full(MESH.n_vertices, np.nan)])
def test_others_are_refused(integrals):
    with pytest.raises(OptionError, match="integrals has shape"):
        analyse(MESH, integrals=integrals)
