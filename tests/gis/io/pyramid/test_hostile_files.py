"""Pyramid files from strangers: whatever they claim, reading ends in one clear error.

Each case copies a sound file and damages it through SQLite, as somebody with bad intent would: once
as a file of before there were checksums, and once with checksums made to fit the damage.
"""

import contextlib
import json
import resource
import shutil
import sqlite3
import zlib
from contextlib import closing

import numpy as np
import pytest
from tools.pyramid_surgery import STRIP, operate, reseal

from wavelet_core.errors import PyramidError, WaveletError
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.pyramid.codecs.array_codec import encode_array, header_of
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, read_summary

listed = pytest.mark.parametrize(
    "sound", ["raster of format 1", "cloud of format 1"], indirect=True
)


@pytest.fixture(params=["before checksums", "resealed"])
def damaged(sound, tmp_path, request):
    """Return a function that runs SQL on a copy and returns its path."""

    def damage(*statements):
        path = tmp_path / "damaged.gpkg"
        shutil.copy(sound, path)
        if request.param == "resealed":
            operate(path, *statements)
            with contextlib.suppress(sqlite3.Error):
                reseal(path)
        else:
            operate(path, *STRIP, *statements)
        return path

    return damage


def replace_array(name, array):
    """Return the statements that put another array, well packed, in the place of one."""
    header = header_of(array)
    return [
        (
            "DELETE FROM wavelet_chunks WHERE array_id = "
            "(SELECT id FROM wavelet_arrays WHERE name = ?)",
            name,
        ),
        (
            "UPDATE wavelet_arrays SET dtype = ?, shape = ?, filter = ?, chunk_rows = ? "
            "WHERE name = ?",
            header.dtype,
            json.dumps(header.shape),
            header.filter,
            header.chunk_rows,
            name,
        ),
        *[
            (
                "INSERT INTO wavelet_chunks (array_id, sequence, data) VALUES "
                "((SELECT id FROM wavelet_arrays WHERE name = ?), ?, ?)",
                name,
                sequence,
                chunk,
            )
            for sequence, chunk in enumerate(encode_array(array))
        ],
    ]


def test_names_that_are_there_twice(damaged):
    path = damaged(
        "DROP INDEX IF EXISTS metadata_names",
        "INSERT INTO wavelet_metadata (name, value) SELECT name, value FROM wavelet_metadata "
        "WHERE name = 'frame'",
    )
    with pytest.raises(PyramidError, match="metadata 'frame' are no text, or are there twice"):
        read_summary(path)
    copied = "name, dtype, shape, filter, chunk_rows"
    path = damaged(
        "DROP INDEX IF EXISTS array_names",
        f"INSERT INTO wavelet_arrays ({copied}) SELECT {copied} FROM wavelet_arrays WHERE id = 2",
    )
    with pytest.raises(PyramidError, match="another's name"):
        read_pyramid(path)


@pytest.mark.parametrize("table", ["metadata", "levels", "arrays", "chunks"])
def test_a_missing_table(damaged, table):
    with pytest.raises(InputFileError, match=f"no table wavelet_{table}"):
        read_pyramid(damaged(f"DROP TABLE wavelet_{table}"))


def test_a_view_that_poses_as_a_table(damaged):
    endless = (
        "CREATE VIEW wavelet_chunks AS WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 "
        "FROM n) SELECT i AS id, 1 AS array_id, i AS sequence, zeroblob(1000) AS data FROM n"
    )
    with pytest.raises(InputFileError, match="no table wavelet_chunks"):
        read_pyramid(damaged("DROP TABLE wavelet_chunks", endless))


@pytest.mark.parametrize(
    "statement",
    [
        "DELETE FROM wavelet_metadata",
        "DELETE FROM wavelet_metadata WHERE name = 'format'",
        "UPDATE wavelet_metadata SET value = '{\"name\": \"another\"}' WHERE name = 'format'",
        "UPDATE wavelet_metadata SET value = '[]' WHERE name = 'format'",
        "UPDATE wavelet_metadata SET value = json_set(value, '$.version', 5) WHERE name = 'format'",
        "ALTER TABLE wavelet_arrays RENAME COLUMN shape TO form",
        "ALTER TABLE wavelet_levels RENAME COLUMN n_faces TO faces",
    ],
)
def test_no_pyramid_of_ours(damaged, statement):
    path = damaged(statement)
    for read in (read_pyramid, read_summary):
        if "wavelet_arrays" in statement and read is read_summary:
            continue
        with pytest.raises(InputFileError):
            read(path)


@pytest.mark.parametrize("name", ["pyramid", "crs", "frame", "source", "vertical_unit", "history"])
def test_missing_metadata(damaged, name):
    with pytest.raises(PyramidError, match="damaged"):
        read_pyramid(damaged(("DELETE FROM wavelet_metadata WHERE name = ?", name)))


@pytest.mark.parametrize("value", ["", "{", "[" * 100_000, "nonsense", "7", "[]", '"text"', "null"])
@pytest.mark.parametrize("name", ["pyramid", "crs", "frame", "source"])
def test_metadata_of_another_kind(damaged, name, value):
    with pytest.raises(WaveletError):
        read_pyramid(damaged(("UPDATE wavelet_metadata SET value = ? WHERE name = ?", value, name)))


def with_pyramid_field(**changes):
    return [
        (
            f"UPDATE wavelet_metadata SET value = json_set(value, '$.{key}', json(?)) "
            "WHERE name = 'pyramid'",
            json.dumps(value),
        )
        for key, value in changes.items()
    ]


@pytest.mark.parametrize(
    "change",
    [
        {"n_levels": 5},
        {"n_levels": -1},
        {"n_levels": 10**9},
        {"n_levels": 2.5},
        {"n_levels": "all"},
        {"n_levels": 3},  # the steps of the others are then missing from the coarse end
        {"channels": []},
        {"channels": ["z", "z"]},
        {"channels": ["x"]},
        {"channels": 3},
        {"signal": "xyz"},
        {"signal": "w"},
        {"signal": None},
        {"update": "eval"},
        {"has_locked": True},
        {"parameters": 5},
    ],
)
def test_claims_about_the_pyramid(damaged, change):
    with pytest.raises(PyramidError):
        read_pyramid(damaged(*with_pyramid_field(**change)))


@listed
@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("faces", np.zeros((4, 2), np.int32)),
        ("faces", np.full((4, 3), 10**6, np.int32)),
        ("faces", np.full((4, 3), -1, np.int32)),
        ("faces", np.zeros((4, 3))),
        ("faces", np.zeros(12, np.int32)),
        ("coarse", np.zeros((3, 3))),
        ("coarse", np.full((5, 1), np.nan)),
        ("horizontal", np.zeros((7, 2))),
        ("horizontal", np.zeros(7)),
        ("steps/0002/odd", np.zeros(5, np.int32)),
        ("steps/0002/odd", np.arange(3, dtype=np.int64)),
        ("steps/0002/odd", np.empty(0, np.int32)),
        ("steps/0001/target", np.full(5, 2**31 - 1, np.int32)),
        ("steps/0001/indptr", np.arange(9, dtype=np.int64)[::-1].copy()),
        ("steps/0001/indices", np.full(5, -7, np.int32)),
        ("steps/0001/weights", np.full(5, np.inf)),
        ("steps/0003/details", np.zeros((2, 9))),
        ("steps/0003/details", np.zeros(2)),
    ],
)
def test_arrays_of_another_shape_type_or_range(damaged, name, array):
    with pytest.raises(PyramidError):
        read_pyramid(damaged(*replace_array(name, array)))


@listed
@pytest.mark.parametrize("part", ["odd", "target", "indices"])
@pytest.mark.parametrize("value", [-1, 2**31 - 1])
def test_one_index_out_of_range(damaged, sound, part, value):
    step = read_pyramid(sound).pyramid.steps[1]
    array = getattr(step, part).copy()
    array[len(array) // 2] = value
    with pytest.raises(PyramidError, match="range"):
        read_pyramid(damaged(*replace_array(f"steps/0001/{part}", array)))


@listed
def test_an_odd_vertex_twice_and_a_target_that_is_odd(damaged, sound):
    step = read_pyramid(sound).pyramid.steps[1]
    twice = step.odd.copy()
    twice[1] = twice[0]
    with pytest.raises(PyramidError, match="twice"):
        read_pyramid(damaged(*replace_array("steps/0001/odd", twice)))
    target = step.target.copy()
    target[0] = step.odd[1]
    with pytest.raises(PyramidError, match="odd itself"):
        read_pyramid(damaged(*replace_array("steps/0001/target", target)))


@listed
@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE wavelet_arrays SET shape = '[1000000000000]' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET shape = '[100000000, 1]' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET shape = '[-4, 1]' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET shape = '{}' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET shape = 'x' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET shape = x'00ff' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET dtype = 'O'",
        "UPDATE wavelet_arrays SET dtype = '<f4' WHERE name = 'coarse'",
        "UPDATE wavelet_arrays SET filter = 'pickle'",
        "UPDATE wavelet_arrays SET chunk_rows = 0",
        "UPDATE wavelet_arrays SET chunk_rows = 1",
        "UPDATE wavelet_arrays SET chunk_rows = 'x'",
        "DELETE FROM wavelet_arrays WHERE name = 'faces'",
        "DELETE FROM wavelet_arrays WHERE name LIKE 'source/%'",
        "DELETE FROM wavelet_chunks",
        "DELETE FROM wavelet_chunks WHERE id % 5 = 0",
        "UPDATE wavelet_chunks SET sequence = sequence + 1",
        "UPDATE wavelet_chunks SET sequence = 'first'",
        "UPDATE wavelet_chunks SET data = 'text'",
        "UPDATE wavelet_chunks SET data = 5",
        "UPDATE wavelet_chunks SET data = zeroblob(100)",
        "UPDATE wavelet_chunks SET data = substr(data, 1, length(data) / 2)",
        "UPDATE wavelet_chunks SET data = data || data",
        "INSERT INTO wavelet_chunks (array_id, sequence, data) SELECT array_id, sequence + 1, data "
        "FROM wavelet_chunks",
    ],
)
def test_damaged_tables(damaged, statement):
    with pytest.raises(WaveletError):
        read_pyramid(damaged(statement))


@listed
@pytest.mark.parametrize(
    ("n_bytes", "message"),
    [(1 << 28, "a chunk of"), (1 << 22, "a chunk does not expand")],
    ids=["large", "small"],
)
def test_a_bomb_costs_no_memory(damaged, n_bytes, message):
    bomb = zlib.compress(bytes(n_bytes))  # a thousandth of it
    path = damaged(
        (
            "UPDATE wavelet_chunks SET data = ? WHERE array_id = "
            "(SELECT id FROM wavelet_arrays WHERE name = 'coarse')",
            bomb,
        )
    )
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(PyramidError, match=f"coarse: {message}"):
        read_pyramid(path)
    grown_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown_kib < 100_000


@listed
@pytest.mark.parametrize("index", ["with an index", "without"])
def test_a_value_beyond_all_bounds(damaged, index):
    path = damaged(
        "DROP INDEX wavelet_chunks_of_array" if index == "without" else "SELECT 1",
        "UPDATE wavelet_chunks SET data = zeroblob(100000000) WHERE array_id = "
        "(SELECT id FROM wavelet_arrays WHERE name = 'coarse')",
    )
    with pytest.raises(PyramidError, match="coarse: a chunk of 100000000 bytes"):
        read_pyramid(path)
    path = damaged("UPDATE wavelet_metadata SET value = hex(zeroblob(9000000)) WHERE name = 'crs'")
    with pytest.raises(InputFileError, match="big"):
        read_pyramid(path)


def test_thousands_of_arrays_and_keys_are_refused(damaged):
    path = damaged(
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 20000) "
        "INSERT INTO wavelet_arrays (name, dtype, shape, filter, chunk_rows) "
        "SELECT 'extra' || i, '<f8', '[5]', 'shuffle', 5 FROM n",
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 20000) "
        "INSERT INTO wavelet_levels (level, n_vertices, n_faces) SELECT i, 1, 1 FROM n",
    )
    with pytest.raises(PyramidError, match="more than"):
        read_pyramid(path)
    with pytest.raises(PyramidError, match="more than"):
        read_summary(path)


def test_figures_that_are_none(damaged):
    path = damaged(
        "UPDATE wavelet_levels SET rmse_surface = 'low', n_vertices = x'00', n_faces = 9e999"
    )
    assert read_pyramid(path).errors is None
    level = read_summary(path)["levels"][0]
    assert np.isnan([level["rmse_surface"], level["n_vertices"], level["n_faces"]]).all()


@listed
def test_changed_details_are_not_passed_off_as_the_original(damaged, sound):
    details = read_pyramid(sound).pyramid.steps[3].details.copy()
    details[0, 0] += 3.0
    path = damaged(*replace_array("steps/0003/details", details))
    with pytest.raises(PyramidError, match="checksum"):
        read_pyramid(path).restore()


def test_a_source_of_another_size(damaged):
    path = damaged(
        "UPDATE wavelet_metadata SET value = json_set(value, '$.n_points', 1 << 40, '$.shape', "
        "json('[41, 50]')) WHERE name = 'source'"
    )
    with pytest.raises(PyramidError):
        read_pyramid(path)


@pytest.mark.parametrize("seed", range(25))
def test_bytes_changed_at_random(sound, tmp_path, seed):
    rng = np.random.default_rng(seed)
    content = bytearray(sound.read_bytes())
    for position in rng.integers(100, len(content), 20):
        content[position] = rng.integers(0, 256)
    path = tmp_path / "random.gpkg"
    path.write_bytes(content)
    with contextlib.suppress(WaveletError):  # refused; else it is the original, by its checksum
        read_pyramid(path).restore()


@pytest.mark.parametrize("size", [60_000_000, 15_000_000, 100])
def test_columns_that_are_reckoned_as_they_are_read(damaged, size):
    path = damaged(
        "CREATE TABLE copied AS SELECT id, array_id, sequence FROM wavelet_chunks",
        "DROP TABLE wavelet_chunks",
        "ALTER TABLE copied RENAME TO wavelet_chunks",
        f"ALTER TABLE wavelet_chunks ADD COLUMN data BLOB AS (zeroblob({size}))",
    )
    for read in (read_pyramid, read_summary):
        with pytest.raises(InputFileError, match="no column data in wavelet_chunks"):
            read(path)


def test_a_long_default_that_is_stored_once(damaged):
    path = damaged(
        "CREATE TABLE copied AS SELECT id, array_id, sequence FROM wavelet_chunks",
        "DROP TABLE wavelet_chunks",
        "ALTER TABLE copied RENAME TO wavelet_chunks",
        f"ALTER TABLE wavelet_chunks ADD COLUMN data BLOB DEFAULT x'{'00' * 400_000}'",
    )
    with pytest.raises(PyramidError, match="the chunks claim"):
        read_pyramid(path)


def test_arrays_that_share_their_chunks(damaged):
    path = damaged(
        "CREATE TABLE copied AS SELECT * FROM wavelet_arrays",
        "DROP TABLE wavelet_arrays",
        "ALTER TABLE copied RENAME TO wavelet_arrays",
        "UPDATE wavelet_arrays SET id = 1",
    )
    with pytest.raises(PyramidError, match="the same number"):
        read_pyramid(path)


@listed
def test_arrays_that_claim_more_than_the_file_can_hold(damaged):
    statements = replace_array("coarse", np.zeros((300_000, 9)))
    claim = "UPDATE wavelet_arrays SET shape = '[8000000, 9]' WHERE name = 'coarse'"
    path = damaged(*statements, claim)
    with pytest.raises(PyramidError, match="arrays claim"):
        read_pyramid(path)


def test_a_virtual_table(damaged):
    path = damaged(
        "DROP TABLE wavelet_levels",
        "CREATE VIRTUAL TABLE wavelet_levels USING rtree(id, level, n_vertices)",
    )
    with pytest.raises(InputFileError, match="no table wavelet_levels"):
        read_pyramid(path)


def assert_read_or_refused_in_a_line(read, path):
    text = ""
    try:
        read(path)
    except WaveletError as error:
        text = str(error)
    assert "\n" not in text
    assert len(text) < 500


NUMBERS = [
    "1" + "0" * 400,
    "9" * 5000,
    "1e999",
    "NaN",
    "2147483648",
    "-1",
    "null",
    '"7"',
    "[" * 50 + "]" * 50,
    '{"a":' * 100_000,
]


@pytest.mark.parametrize("number", NUMBERS, ids=lambda text: text[:12])
@pytest.mark.parametrize("name", ["pyramid", "crs", "frame", "source", "format", "history"])
def test_any_number_anywhere_in_the_metadata(damaged, sound, name, number):
    """Whatever stands where a value stood, all is read or one line tells of it."""
    with closing(sqlite3.connect(sound)) as connection, connection:
        (text,) = connection.execute(
            "SELECT value FROM wavelet_metadata WHERE name = ?", (name,)
        ).fetchone()
    fields = json.loads(text)
    keys = list(fields) if isinstance(fields, dict) else [None]
    for key in keys:
        if key is None:
            replaced = f"[{number}]"
        else:
            replaced = json.dumps(fields | {key: "@here@"}).replace('"@here@"', number)
        path = damaged(("UPDATE wavelet_metadata SET value = ? WHERE name = ?", replaced, name))
        for read in (read_summary, lambda path: read_pyramid(path).restore()):
            assert_read_or_refused_in_a_line(read, path)


@listed
@pytest.mark.parametrize(
    "shape", ["[[1]]", "[1e9]", "[2147483648, 3]", "[-1]", "[1" + "0" * 400 + "]", "[" * 9000, "7"]
)
def test_any_shape(damaged, shape):
    path = damaged(("UPDATE wavelet_arrays SET shape = ? WHERE name = 'faces'", shape))
    with pytest.raises(PyramidError, match="damaged"):
        read_pyramid(path)


@listed
@pytest.mark.parametrize("name", ["indices", "weights", "odd", "indptr", "details"])
def test_arrays_of_another_dimension(damaged, sound, name):
    array = getattr(read_pyramid(sound).pyramid.steps[1], name)
    other = array.reshape(-1) if array.ndim == 2 else array[:, None]
    with pytest.raises(PyramidError, match=r"dimensions are due|no more than one"):
        read_pyramid(damaged(*replace_array(f"steps/0001/{name}", other)))


# --- records ----------------------------------------------------------------------------------

recorded = pytest.mark.parametrize("sound", ["raster", "cloud"], indirect=True)


@recorded
@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("parts/0/going", np.zeros(3, np.uint8)),
        ("parts/0/going", np.zeros(3)),
        ("parts/0/targets", np.zeros(10**5, np.uint8)),
        ("parts/0/targets", np.zeros((4, 4), np.uint8)),
        ("parts/0/beyond", np.zeros(7, np.uint8)),
    ],
)
def test_answers_of_another_number_or_type(damaged, name, array):
    with pytest.raises(PyramidError):
        read_pyramid(damaged(*replace_array(name, array)))


@recorded
@pytest.mark.parametrize("name", ["going", "targets"])
@pytest.mark.parametrize("fill", [0x00, 0xFF, 0x55])
def test_answers_that_tell_no_pyramid(damaged, sound, name, fill):
    """Whatever is answered, it ends; and what comes out is the input all the same, or nothing."""
    with closing(sqlite3.connect(sound)) as connection, connection:
        (shape,) = connection.execute(
            "SELECT shape FROM wavelet_arrays WHERE name = ?", (f"parts/0/{name}",)
        ).fetchone()
    array = np.full(json.loads(shape), fill, dtype=np.uint8)
    path = damaged(*replace_array(f"parts/0/{name}", array))
    with contextlib.suppress(PyramidError):
        read_pyramid(path).restore()


@recorded
@pytest.mark.parametrize(
    "change",
    [
        {"levels": []},
        {"levels": [1]},
        {"levels": [70000, 5]},
        {"levels": [0, 0, 0] * 2000},
        {"codes_per_level": 1},
        {"codes_per_level": 2},
        {"codes_per_level": 4},
        {"codes_per_level": "3"},
        {"going": [1] * 31},
        {"going": [2**40] * 32},
        {"targets": [-1] * 29},
        {"targets": [0] * 8},
    ],
)
def test_records_that_are_none(damaged, sound, change):
    with closing(sqlite3.connect(sound)) as connection, connection:
        (text,) = connection.execute(
            "SELECT value FROM wavelet_metadata WHERE name = 'record'"
        ).fetchone()
    record = json.loads(text)
    record["parts"][0] |= change
    statement = "UPDATE wavelet_metadata SET value = ? WHERE name = 'record'"
    with pytest.raises(PyramidError):
        read_pyramid(damaged((statement, json.dumps(record))))


@pytest.mark.parametrize("sound", ["cloud of format 1"], indirect=True)
@pytest.mark.parametrize(
    "faces",
    [
        np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], np.int32),  # three faces on one edge
        np.array([[0, 1, 1]], np.int32),
        np.array([[0, 1, 10**6]], np.int32),
        np.array([[0, 1, -1]], np.int32),
        np.zeros((3, 2), np.int32),
        np.zeros(3, np.int32),
    ],
)
def test_faces_that_are_no_surface(damaged, faces):
    with pytest.raises(WaveletError):
        read_pyramid(damaged(*replace_array("faces", faces)))


@pytest.mark.parametrize("sound", ["raster"], indirect=True)
@pytest.mark.parametrize(
    "array",
    [
        np.zeros(7, np.uint16),
        np.zeros(1952, np.int16),
        np.full(1952, np.iinfo(np.uint64).max, np.uint64),
        np.zeros((976, 2), np.uint8),
    ],
)
def test_residuals_of_another_raster(damaged, array):
    with pytest.raises(PyramidError):
        read_pyramid(damaged(*replace_array("source/residuals", array))).restore()


@listed
@pytest.mark.parametrize(
    ("name", "value"),
    [("outline_tolerance", '""'), ("outline_tolerance", "-1"), ("attribute_weights", '"7"'),
     ("attribute_weights", "[null]")],
)  # fmt: skip
def test_a_parameter_by_which_a_pyramid_is_written_again_is_a_number(damaged, name, value):
    """Such a file was read, and a traceback came when what was read was written again."""
    path = damaged(
        f"UPDATE wavelet_metadata SET value = json_set(value, '$.parameters.{name}', "
        f"json('{value}')) WHERE name = 'pyramid'"
    )
    with pytest.raises(
        PyramidError, match="tolerance" if "tolerance" in name else "weights"
    ) as caught:
        read_pyramid(path)
    assert "\n" not in str(caught.value)
