"""Steps come back from their collapses; collapses that no analysis takes are refused."""

import numpy as np
import pytest
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import analyse, synthetic
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.errors import Cancelled, PyramidError
from wavelet_core.partition._mutable_level import CollapseStep
from wavelet_core.partition.plan_record import places_of_steps, steps_at_places

ENGINES = ["arrays", *(["compiled"] if HAS_NUMBA else [])]
ARRAYS = ("odd", "target", "indptr", "indices", "weights", "details")


def finest(pyramid):
    locked = pyramid.locked
    if locked is None:
        locked = np.zeros(len(pyramid.horizontal), dtype=bool)
    return pyramid.horizontal, pyramid.faces, locked, pyramid.parameters["outline_tolerance"]


def collapses(pyramid):
    return [
        CollapseStep(*(getattr(step, name) for name in ARRAYS)) for step in reversed(pyramid.steps)
    ]


def told(pyramid):
    places = places_of_steps(*finest(pyramid), collapses(pyramid))
    return [(step.odd, of_step) for step, of_step in zip(collapses(pyramid), places, strict=True)]


@pytest.mark.parametrize("reader", ENGINES)
@pytest.mark.parametrize("writer", ENGINES)
@pytest.mark.parametrize("name", ["points", "holes", "locked"])
def test_steps_come_back_to_the_bit(name, writer, reader):
    mesh = grid_with_holes(20, 24) if name == "holes" else random_delaunay(300, seed=2, offset=1e6)
    locked = np.random.default_rng(0).random(mesh.n_vertices) < 0.5 if name == "locked" else None
    with engine(writer):
        pyramid = analyse(mesh, locked=locked)
        places = told(pyramid)
    with engine(reader):
        back = list(steps_at_places(*finest(pyramid), places))
    for one, other in zip(back, collapses(pyramid), strict=True):
        for array in ARRAYS[:-1]:
            assert getattr(one, array).tobytes() == getattr(other, array).tobytes()


def test_other_steps_are_not_told():
    mesh = synthetic.hills(12, 12)
    pyramid = analyse(mesh, levels=3)
    steps = collapses(pyramid)
    for broken in (
        steps[0]._replace(weights=steps[0].weights + 1e-9),
        steps[0]._replace(target=steps[0].target[::-1]),
        steps[0]._replace(odd=steps[0].odd[::-1]),
        steps[0]._replace(odd=steps[0].odd[:0]),
    ):
        assert places_of_steps(*finest(pyramid), [broken, *steps[1:]]) is None


@pytest.mark.parametrize("name", ENGINES)
def test_collapses_that_no_analysis_takes_are_refused(name):
    pyramid = analyse(synthetic.hills(12, 12), levels=3)
    (odd, places), *rest = told(pyramid)
    n = len(pyramid.horizontal)
    all_of_them = np.arange(n, dtype=np.int32)
    for broken in (
        (odd, np.full_like(places, 63)),
        (odd, places[:-1]),
        (odd[:0], places[:0]),
        (odd[::-1], places),
        (odd - odd[0] - 1, places),
        (odd + n, places),
        (all_of_them, np.zeros(n, np.uint8)),
        (np.array([40, 41], np.int32), np.zeros(2, np.uint8)),  # neighbours
        (np.array([0], np.int32), np.zeros(1, np.uint8)),  # a corner of the outline
    ):
        with engine(name), pytest.raises(PyramidError, match="no surface allows"):
            list(steps_at_places(*finest(pyramid), [broken, *rest]))


def test_places_of_every_step_are_reported():
    """Half a million points took 6 s without a word, and as many when they were read back.

    The half-edges of the finest level alone still took 1.4 s on whole arrays.
    """
    pyramid = analyse(random_delaunay(300, seed=2))
    seen = []
    with engine("arrays"):
        places_of_steps(*finest(pyramid), collapses(pyramid), seen.append)
    assert len(seen) >= pyramid.n_levels + 5
    assert len([share for share in seen if share < 0.2]) >= 4
    assert seen == sorted(seen)
    with pytest.raises(Cancelled):
        places_of_steps(*finest(pyramid), collapses(pyramid), lambda fraction: fraction < 0.5)
