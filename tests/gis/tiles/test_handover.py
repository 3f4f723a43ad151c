"""Which level of each piece the group above begins with: the error a vertex costs is the same."""

import itertools

import numpy as np
import pytest
from gis.samples import hills, write_tif
from hypothesis import given
from hypothesis import strategies as st

import wavelet_gis as wg
from wavelet_core import analyse
from wavelet_core.metrics import surface_errors
from wavelet_gis.tiles.handover import SHARE_HANDED_ON, handover_levels
from wavelet_gis.tiles.piece import handed_on, level_handed_on
from wavelet_gis.tiles.plan import Piece


def record(sizes, rmse, n_points=100.0):
    """Return what a piece says of its levels, the coarsest first."""
    return {"sizes": list(sizes), "rmse_by_level": list(rmse), "n_points": n_points}


def test_a_rough_piece_hands_on_more_than_a_flat_one():
    flat, rough = Piece(0, 0, 0), Piece(0, 0, 1)
    records = {
        flat: record([10, 25, 50, 100], [0.03, 0.02, 0.01, 0.0]),
        rough: record([10, 25, 50, 100], [30.0, 20.0, 10.0, 0.0]),
    }
    levels = handover_levels([[flat], [rough]], records)
    assert levels == {flat: 0, rough: 1}  # 35 vertices; without the last step of the rough one, 60


def test_pieces_alike_hand_on_alike():
    pieces = [Piece(0, row, column) for row in range(2) for column in range(2)]
    records = {piece: record([10, 20, 40, 80], [3.0, 2.0, 1.0, 0.0]) for piece in pieces}
    levels = handover_levels([pieces], records).values()
    assert max(levels) - min(levels) == 1  # as many vertices as are due, to the step


def test_a_group_begins_with_no_more_than_its_largest_piece_had():
    rough = [Piece(0, 0, column) for column in range(4)]
    flat = [Piece(0, 1, column) for column in range(40)]
    records = {piece: record([10, 40, 60, 100], [30.0, 20.0, 10.0, 0.0]) for piece in rough}
    records |= {piece: record([1, 40, 60, 100], [0.03, 0.02, 0.01, 0.0]) for piece in flat}
    alone = handover_levels([[piece] for piece in rough + flat], records)
    assert [alone[piece] for piece in rough] == [3, 3, 3, 3]  # the flat ones give all that is due
    levels = handover_levels([rough, flat], records)
    assert sum(records[piece]["sizes"][levels[piece]] for piece in rough) <= 100


def test_tile_sets_of_before_hand_on_their_coarsest_level():
    piece = Piece(0, 0, 0)
    assert handover_levels([[piece]], {piece: {"sizes": [10, 50, 100]}}) == {piece: 0}
    assert level_handed_on("0a1b") == 0
    assert level_handed_on(handed_on("0a1b", 7)) == 7


steps = st.lists(st.tuples(st.integers(1, 9), st.floats(0.0, 10.0)), min_size=1, max_size=4).map(
    lambda pairs: sorted(pairs, key=lambda pair: pair[1])
)


@given(st.lists(steps, min_size=1, max_size=4))
def test_nothing_of_its_size_has_less_error(all_steps):
    """Held against all choices of levels; each step costs more a vertex than the one before."""
    pieces, records = [], {}
    for k, pairs in enumerate(all_steps):
        saved = np.array([n for n, _ in pairs])
        squared = np.cumsum(saved * [price for _, price in pairs])
        sizes = [5 + saved.sum(), *(5 + saved.sum() - np.cumsum(saved))]
        rmse = np.sqrt(np.concatenate([[0.0], squared]))
        pieces.append(Piece(0, 0, k))
        records[pieces[-1]] = record(sizes[::-1], rmse[::-1], 1.0)
    levels = handover_levels([[piece] for piece in pieces], records)

    def outcome(chosen):
        size = sum(records[p]["sizes"][chosen[p]] for p in pieces)
        return size, sum(records[p]["rmse_by_level"][chosen[p]] ** 2 for p in pieces)

    size, squared = outcome(levels)
    for choice in itertools.product(*(range(len(records[p]["sizes"])) for p in pieces)):
        other_size, other = outcome(dict(zip(pieces, choice, strict=True)))
        assert other_size > size or other >= squared * (1 - 1e-9)
    finest = sum(records[p]["sizes"][-1] for p in pieces)
    is_last = all(level == 0 for level in levels.values())
    assert size <= SHARE_HANDED_ON * finest or is_last


@pytest.fixture(scope="module")
def half_rough(tmp_path_factory):
    """A smooth half and a rough half: by steps alone the smooth one keeps far too much."""
    values = hills(320, 320).astype("f4")
    noise = np.random.default_rng(8).normal(0, 3.0, (320, 320)).astype("f4")
    values += noise * (np.arange(320) >= 160)
    return write_tif(tmp_path_factory.mktemp("half") / "dem.tif", values)


def test_tiles_are_nearly_as_good_as_the_whole(half_rough, tmp_path):
    tiled = wg.tile_rasters(half_rough, tmp_path / "tiles", tile=80)
    whole = wg.open(half_rough).mesh
    for level in (0, tiled.index.n_levels // 4, tiled.index.n_levels // 2):
        mesh = wg.extract_region(tiled.index, level=level).surface.mesh
        once = analyse(whole, target_vertices=mesh.n_vertices)[0]
        errors = [np.sqrt(np.mean(surface_errors(m, whole.vertices) ** 2)) for m in (mesh, once)]
        assert errors[0] < 1.2 * errors[1], (level, mesh.n_vertices, errors)
