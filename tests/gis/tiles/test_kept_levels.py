"""The levels that pieces leave for their groups: a shorter way to the same numbers."""

import dataclasses
import hashlib
from pathlib import Path

import numpy as np
import pytest
from gis.samples import hills, write_tif

import wavelet_gis as wg
from wavelet_core import analyse, synthetic
from wavelet_gis.tiles import piece as pieces
from wavelet_gis.tiles.kept_levels import KEPT, SHARE_KEPT, drop_levels, keep_levels, kept_levels

SUM = "0a1b"


@pytest.fixture(scope="module", params=["default", "paper", "xyz"])
def pyramid(request):
    options = {
        "default": {},
        "paper": {"partition": "quadric", "prediction": "geometric", "update": "minimum_norm"},
        "xyz": {"partition": "quadric", "signal": "xyz", "update": "one_ring_mean"},
    }
    mesh = synthetic.hills(30, 40)
    locked = np.zeros(mesh.n_vertices, dtype=bool)
    locked[::97] = True
    return analyse(mesh, levels=9, locked=locked, **options[request.param])


def test_each_level_that_is_kept_is_that_of_the_pyramid_to_the_bit(tmp_path, pyramid):
    keep_levels(tmp_path, "0/a", SUM, pyramid)
    n_seen = 0
    for level in range(len(pyramid)):
        kept = kept_levels(tmp_path, "0/a", SUM, level)
        if pyramid.n_vertices(level) > SHARE_KEPT * pyramid.n_vertices(pyramid.n_levels):
            assert kept is None
            continue
        n_seen += 1
        assert kept.mesh(level) == pyramid.mesh(level)
        assert kept.integrals(level).tobytes() == pyramid.integrals(level).tobytes()
        assert kept.vertex_ids(level).tolist() == pyramid.vertex_ids(level).tolist()
    assert n_seen > 2


def test_nothing_is_kept_of_a_piece_whose_coarsest_level_is_too_fine(tmp_path):
    pyramid = analyse(synthetic.hills(5, 5), levels=1)
    keep_levels(tmp_path, "0/a", SUM, pyramid)
    assert not list(tmp_path.rglob("*.npz"))
    assert kept_levels(tmp_path, "0/a", SUM, 0) is None


def test_levels_of_another_file_are_not_those_of_this_one(tmp_path, pyramid):
    keep_levels(tmp_path, "0/a", SUM, pyramid)
    assert kept_levels(tmp_path, "0/a", "0a1c", 0) is None


def damages():
    """Yield names and functions that damage a file of levels."""
    yield "cut off", lambda path: path.write_bytes(path.read_bytes()[:-100])
    yield "empty", lambda path: path.write_bytes(b"")
    yield "no archive", lambda path: path.write_bytes(b"levels" * 1000)
    yield "gone", lambda path: path.unlink()

    def flip(path):
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content)

    yield "a bit", flip

    def change(name, array):
        def written(path):
            with np.load(path) as arrays:
                content = dict(arrays)
            if array is None:
                del content[name]
            else:
                content[name] = array
            np.savez(path, **content)

        return written

    yield "no faces", change("faces", None)
    yield "faces out of range", change("faces", np.array([[0, 1, 10**6]], dtype=np.int32))
    yield "too few ids", change("ids", np.arange(3, dtype=np.int32))
    yield "objects", change("coarse", np.array([{}], dtype=object))

    def alone(path):
        np.save(path.with_suffix(".npy"), np.zeros(3))
        path.with_suffix(".npy").replace(path)

    yield "an array alone", alone
    yield "words", change("coarse", np.array(["a"]))


@pytest.mark.parametrize("damage", [pytest.param(how, id=name) for name, how in damages()])
def test_levels_that_are_damaged_are_read_from_the_file_instead(tmp_path, pyramid, damage):
    keep_levels(tmp_path, "0/a", SUM, pyramid)
    damage(tmp_path / KEPT / "0" / "a.npz")
    assert kept_levels(tmp_path, "0/a", SUM, 0) is None


def test_they_are_gone_at_the_end_and_no_other_stage_goes_with_one(tmp_path, pyramid):
    keep_levels(tmp_path, "0/a", SUM, pyramid)
    keep_levels(tmp_path, "1/a", SUM, pyramid)
    drop_levels(tmp_path, 0)
    assert [path.name for path in tmp_path.rglob("*.npz")] == ["a.npz"]
    drop_levels(tmp_path, 1)
    assert list(tmp_path.iterdir()) == []


def sums(folder: Path):
    """Return the checksums of all files but the records, which hold the time they took."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*.gpkg"))
    }


def test_a_tile_set_has_the_same_bytes_with_and_without_them(tmp_path, monkeypatch):
    raster = write_tif(tmp_path / "a.tif", hills(65, 65).astype("f4"))
    asked = []

    def watched(*arguments):
        found = kept_levels(*arguments)
        asked.append(found is not None)
        return found

    monkeypatch.setattr(pieces, "kept_levels", watched)
    wg.tile_rasters(raster, tmp_path / "with", tile=17, levels=12)
    assert any(asked)
    monkeypatch.setattr(pieces, "keep_levels", lambda *arguments: None)
    asked.clear()
    wg.tile_rasters(raster, tmp_path / "without", tile=17, levels=12)
    assert asked
    assert not any(asked)
    assert sums(tmp_path / "with" / "pieces") == sums(tmp_path / "without" / "pieces")
    assert not (tmp_path / "with" / KEPT).exists()


def test_the_part_keeps_what_the_pyramid_was_made_with(tmp_path, pyramid):
    keep_levels(tmp_path, "0/a", SUM, pyramid)
    kept = kept_levels(tmp_path, "0/a", SUM, 0)
    for field in ("channels", "signal", "update"):
        assert getattr(kept, field) == getattr(pyramid, field)
    assert {field.name for field in dataclasses.fields(kept)} >= {"part", "locked"}
