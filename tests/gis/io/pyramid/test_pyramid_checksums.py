"""A pyramid file with another terrain in it than was written is refused, and says which part is so.

Every array, every piece of metadata and the figures of the levels are changed in turn.
"""

import json
import os
import shutil
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from tools.pyramid_surgery import STRIP, operate

from wavelet_core.errors import PyramidError
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.pyramid import pyramid_file
from wavelet_gis.io.pyramid.array_tables import StoredArrays, read_entries
from wavelet_gis.io.pyramid.codecs.array_codec import encode_array
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, read_summary, write_pyramid


@pytest.fixture
def copy(sound, tmp_path):
    return shutil.copy(sound, tmp_path / "copy.gpkg")


def with_one_bit_changed(path, name):
    """Change the last bit but two of an array's middle number; tell if there was a number."""
    connection = sqlite3.connect(path)
    entry = read_entries(connection, with_checksums=True)[name]
    arrays = StoredArrays(connection, None, {name: entry}, os.path.getsize(path))
    array = arrays.get(name).copy()
    if array.size == 0:
        connection.close()
        return False
    raw = array.reshape(-1).view(np.uint8)
    raw[len(raw) // 2 // array.itemsize * array.itemsize] ^= 4
    with connection:
        for sequence, chunk in enumerate(encode_array(array, header=entry.header)):
            connection.execute(
                "UPDATE wavelet_chunks SET data = ? WHERE array_id = ? AND sequence = ?",
                (chunk, entry.array_id, sequence),
            )
    connection.close()
    return True


def test_one_bit_of_any_array(sound, tmp_path):
    with closing(sqlite3.connect(sound)) as connection, connection:
        names = list(read_entries(connection, with_checksums=True))
    changed = 0
    for name in names:
        path = shutil.copy(sound, tmp_path / "copy.gpkg")
        if with_one_bit_changed(path, name):
            changed += 1
            with pytest.raises(PyramidError, match=f"array {name}: its checksum is wrong"):
                read_pyramid(path)
    assert changed >= 5  # the source, and the record; of format 1 six a level


def numbers_of(value, place=()):
    """Yield the place of every number in JSON, its own included."""
    if isinstance(value, bool | str) or value is None:
        return
    if isinstance(value, int | float):
        yield place
        return
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        yield from numbers_of(inner, (*place, key))


def test_one_number_of_any_metadata(sound, tmp_path):
    with closing(sqlite3.connect(sound)) as connection, connection:
        texts = dict(connection.execute("SELECT name, value FROM wavelet_metadata"))
    changed = set()
    for name, text in texts.items():
        for place in numbers_of(json.loads(text)):
            value = json.loads(text)
            outer = value
            for key in place[:-1]:
                outer = outer[key]
            outer[place[-1]] += 1
            path = shutil.copy(sound, tmp_path / "copy.gpkg")
            operate(
                path,
                (
                    "UPDATE wavelet_metadata SET value = ? WHERE name = ?",
                    json.dumps(value, sort_keys=True),
                    name,
                ),
            )
            for read in (read_pyramid, read_summary):
                with pytest.raises((PyramidError, OSError)) as caught:
                    read(path)
                assert "\n" not in str(caught.value)
            changed.add(name)
    assert changed >= {"crs", "frame", "pyramid", "source"}


@pytest.mark.parametrize(
    "name", ["crs", "frame", "vertical_unit", "pyramid", "source", "source_name", "history"]
)
def test_the_piece_of_metadata_is_named(copy, name):
    operate(copy, ("UPDATE wavelet_metadata SET value = value || ' ' WHERE name = ?", name))
    with pytest.raises(PyramidError, match=f"checksum of the metadata '{name}' is wrong"):
        read_summary(copy)


@pytest.mark.parametrize(
    ("statement", "what"),
    [
        ("UPDATE wavelet_levels SET n_vertices = n_vertices + 1 WHERE id = 2", "levels' figures"),
        ("DELETE FROM wavelet_levels WHERE id = 1", "levels' figures"),
        ("UPDATE wavelet_levels SET level = 3 - level", "levels' figures"),
        ("UPDATE wavelet_arrays SET chunk_rows = chunk_rows + 1 WHERE id = 3", "list of arrays"),
        ("UPDATE wavelet_arrays SET checksum = replace(checksum, 'a', 'b')", "list of arrays"),
        ("UPDATE wavelet_arrays SET name = name || 'x' WHERE id = 4", "list of arrays"),
        ("DELETE FROM wavelet_arrays WHERE id = 4", "list of arrays"),
        ("UPDATE wavelet_arrays SET checksum = NULL WHERE id = 3", "has no checksum"),
        ("ALTER TABLE wavelet_arrays DROP COLUMN checksum", "checksums of the arrays are missing"),
        ("DELETE FROM wavelet_metadata WHERE name = 'checksums'", "checksums is missing"),
        ("DELETE FROM wavelet_metadata WHERE name = 'history'", "'history' was added or removed"),
        (
            "INSERT INTO wavelet_metadata (name, value) VALUES ('more', '1')",
            "'more' was added or removed",
        ),
        (STRIP[1], "checksum of the metadata 'format' is wrong"),
        (
            "UPDATE wavelet_metadata SET value = '{}' WHERE name = 'checksums'",
            "checksums is damaged",
        ),
    ],
)
def test_what_the_checksums_cover(copy, statement, what):
    operate(copy, statement)
    for read in (read_pyramid, read_summary):
        with pytest.raises(PyramidError, match=what):
            read(copy)


@pytest.mark.parametrize("sound", ["raster of format 1", "cloud of format 1"], indirect=True)
def test_chunks_of_two_arrays_exchanged(copy):
    operate(
        copy,
        "CREATE TABLE t AS SELECT id, name FROM wavelet_arrays WHERE name LIKE 'steps/%/weights'",
        "UPDATE wavelet_chunks SET array_id = -array_id WHERE array_id IN (SELECT id FROM t)",
        "UPDATE wavelet_chunks SET array_id = (SELECT MIN(id) + MAX(id) FROM t) + array_id "
        "WHERE -array_id IN (SELECT MIN(id) FROM t UNION SELECT MAX(id) FROM t)",
        "UPDATE wavelet_chunks SET array_id = -array_id WHERE array_id < 0",
    )
    with pytest.raises(PyramidError, match="weights"):
        read_pyramid(copy)


def test_a_file_of_before_there_were_checksums_is_read(copy, sound):
    operate(copy, *STRIP)
    old, new = read_pyramid(copy), read_pyramid(sound)
    assert old.frame == new.frame
    assert old.pyramid.coarse.tobytes() == new.pyramid.coarse.tobytes()
    assert "checksums" not in read_summary(copy)["format"]
    assert read_summary(sound)["format"]["checksums"] == "sha256"


def test_a_pyramid_that_its_reader_refuses_is_not_called_written(raster_record, tmp_path):
    pyramid = raster_record.pyramid
    target = pyramid.steps[1].target.copy()
    target[0] = pyramid.steps[1].odd[0]
    steps = list(pyramid.steps)
    steps[1] = type(steps[1])(**{**{n: getattr(steps[1], n) for n in ("odd", "indptr", "indices",
                                 "weights", "details")}, "target": target})  # fmt: skip
    broken = raster_record.with_pyramid(pyramid.with_parts(steps=tuple(steps)), "broken")
    with pytest.raises(OutputFileError, match=r"does not take it: .*step 1: a target"):
        write_pyramid(tmp_path / "a.gpkg", broken)


def test_what_the_disk_changes_while_writing_is_seen(raster_record, tmp_path, monkeypatch):
    path = tmp_path / "a.gpkg"
    original = pyramid_file._read_back

    def after_damage(*arguments, **others):
        assert with_one_bit_changed(path, "parts/0/going")
        original(*arguments, **others)

    monkeypatch.setattr(pyramid_file, "_read_back", after_damage)
    with pytest.raises(OutputFileError, match="parts/0/going: its checksum is wrong"):
        write_pyramid(path, raster_record)
