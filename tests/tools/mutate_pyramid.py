"""Mutate pyramid files, read them, and tell whatever is not refused in one line.

Run from the root of the repository, apart from the suite::

    python tests/tools/mutate_pyramid.py --count 20000 --seed 0 --keep FOLDER

Bytes of the file, values of its tables, numbers of its JSON and arrays are changed, one or several
at once; half of the files get checksums that fit the damage, and some are of the format of before
there were any, so that the checks behind the checksums are tried, too. A file whose checksums were
left alone must be refused or give back what was written, bit for bit: as a whole, as its input
alone, and as the coarse levels that are read from their part of the file.
"""

import argparse
import hashlib
import json
import random
import shutil
import sys
import tempfile
import time
import warnings
import zlib
from collections import Counter
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
if __name__ in ("__main__", "__mp_main__"):
    sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "tools")]

from tools._limits import Trials  # noqa: E402
from tools.format_one import write_format_one, write_former_grid  # noqa: E402
from tools.pyramid_surgery import STRIP, opened, operate, reseal  # noqa: E402

from wavelet_core.errors import WaveletError  # noqa: E402
from wavelet_core.lifting import recorded  # noqa: E402
from wavelet_gis.io.pyramid.codecs.array_codec import encode_array, header_of  # noqa: E402
from wavelet_gis.io.pyramid.metadata_tables import require_tables  # noqa: E402
from wavelet_gis.io.pyramid.pyramid_file import (  # noqa: E402
    read_input,
    read_levels,
    read_pyramid,
    read_summary,
    write_pyramid,
)
from wavelet_gis.io.pyramid.pyramid_parts import pyramid_to_parts  # noqa: E402

NUMBERS = (
    "0", "-1", "1", "2147483647", "2147483648", "-2147483649", "4294967296", "9223372036854775807",
    "9223372036854775808", "1e308", "-1e308", "1e999", "-1e999", "NaN", "Infinity", "-Infinity",
    "1e-320", "0.5", "-0.0", "1" + "0" * 400, "9" * 5000, "true", "null", '"7"', '""', "[]", "{}",
    "[[]]", "[" * 5000 + "]" * 5000, "[" * 200_000, '{"a":' * 50 + "1" + "}" * 50, '"\\ud800"',
)  # fmt: skip
VALUES = (
    None, 0, -1, 1, 2**31, 2**63 - 1, -(2**63), 0.5, 1e308, float("inf"), "", "x", "7", b"", b"\0",
    b"\xff" * 100, "\x00", "x" * 100_000, "[1,", "../../etc",
)  # fmt: skip
TABLES = {
    "wavelet_metadata": ("id", "name", "value"),
    "wavelet_levels": ("id", "level", "n_vertices", "n_faces", "rmse_surface", "n_uncovered"),
    "wavelet_arrays": ("id", "name", "dtype", "shape", "filter", "chunk_rows", "checksum"),
    "wavelet_chunks": ("id", "array_id", "sequence", "data"),
}
CODES = ("u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8")


def mutate(source, path, rng):
    """Write a mutant of a pyramid file; return what was done, and if it may be read as another."""
    shutil.copy(source, path)
    state = rng.choice(("intact", "resealed", "resealed", "before"))
    if state == "before":
        operate(path, *STRIP)
    done = []
    with suppress(Exception):  # a second change to what the first has damaged may fail
        for _ in range(rng.choice((1, 1, 1, 2, 4))):
            change = rng.choice((_bytes, _value, _value, _json, _json, _array, _array, _schema))
            done.append(f"{change.__name__[1:]}: {change(path, rng)}")
    if state == "resealed":
        with suppress(Exception):  # the damage may have left nothing to seal
            reseal(path)
    return state, "; ".join(done)


def _bytes(path, rng):
    content = bytearray(path.read_bytes())
    kind = rng.choice(("flip", "set", "header", "cut", "swap", "zero"))
    if kind == "cut":
        del content[rng.randrange(len(content)) :]
    elif kind == "zero":
        start = rng.randrange(len(content))
        stop = min(start + rng.choice((16, 512, 4096)), len(content))
        content[start:stop] = bytes(stop - start)
    elif kind == "swap":
        pages = len(content) // 4096
        a, b = (4096 * rng.randrange(pages) for _ in range(2))
        content[a : a + 4096], content[b : b + 4096] = (
            content[b : b + 4096],
            content[a : a + 4096],
        )
    else:
        for _ in range(rng.choice((1, 2, 20))):
            k = rng.randrange(100 if kind == "header" else len(content))
            content[k] = (
                content[k] ^ (1 << rng.randrange(8)) if kind == "flip" else rng.randrange(256)
            )
    path.write_bytes(content)
    return kind


def _value(path, rng):
    table = rng.choice(list(TABLES))
    column = rng.choice(TABLES[table])
    value = rng.choice(VALUES)
    where = rng.choice(("", f"WHERE rowid % {rng.randint(1, 9)} = 0", "WHERE rowid = 1"))
    statement = rng.choice(
        (
            (f"UPDATE {table} SET {column} = ? {where}", value),
            (f"UPDATE {table} SET {column} = ? {where}", value),
            (f"UPDATE {table} SET {column} = {column} + 1 {where}",),
            (f"UPDATE {table} SET {column} = {column} || {column} {where}",),
            (f"UPDATE {table} SET {column} = CAST({column} AS BLOB) {where}",),
            (f"UPDATE {table} SET {column} = substr({column}, 2) {where}",),
            (f"DELETE FROM {table} {where}",),
            (f"UPDATE OR IGNORE {table} SET {column} = (SELECT {column} FROM {table} LIMIT 1)",),
        )
    )
    operate(path, statement)
    return f"{statement[0]} {str(value)[:20]!r}"


def _json(path, rng):
    """Put another number in the place of one in the metadata or in a shape."""
    table, name, column = rng.choice(
        (("wavelet_metadata", "name", "value"),) * 3 + (("wavelet_arrays", "name", "shape"),)
    )
    with opened(path) as connection:
        require_tables(connection)
        rows = connection.execute(f"SELECT {name}, {column} FROM {table}").fetchall()
    key, text = rng.choice(rows)
    value = json.loads(text)
    places = [place for place in _places(value, ()) if place]
    replacement = rng.choice(NUMBERS)
    place = rng.choice(places) if places else ()
    if place and rng.random() < 0.15:
        _parent(value, place).pop(place[-1])
        text = json.dumps(value)
    elif place:
        _parent(value, place)[place[-1]] = "@here@"
        text = json.dumps(value).replace('"@here@"', replacement)
    else:
        text = replacement
    operate(path, (f"UPDATE {table} SET {column} = ? WHERE {name} = ?", text, key))
    return f"{key} {'.'.join(map(str, place))} {replacement[:20]}"


def _places(value, place):
    yield place
    members = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    for key, member in members:
        yield from _places(member, (*place, key))


def _parent(value, place):
    for key in place[:-1]:
        value = value[key]
    return value


def _array(path, rng):
    """Change numbers of an array, or put another of some shape and type in its place."""
    with opened(path) as connection:
        require_tables(connection)
        return _array_in(connection, rng)


def _array_in(connection, rng):
    rows = connection.execute("SELECT id, name FROM wavelet_arrays").fetchall()
    array_id, name = rng.choice(rows)
    generator = np.random.default_rng(rng.randrange(2**32))
    shape = rng.choice(((0,), (1,), (7,), (5, 1), (3, 3), (0, 3), (400, 2), (2000,), (2000, 1)))
    kind = rng.choice(("zeros", "huge", "random", "bomb", "same"))
    array = np.zeros(shape, rng.choice(CODES))
    if kind == "huge":
        array[...] = np.iinfo(array.dtype).max if array.dtype.kind in "iu" else 1e38
    elif kind == "random":
        raw = generator.integers(0, 256, array.nbytes, dtype=np.uint8)
        array = raw.view(array.dtype).reshape(shape)
    elif kind == "bomb":
        array = np.zeros((rng.choice((10**5,) * 9 + (3 * 10**6,)), rng.choice((1, 3))), array.dtype)
    elif kind == "same":
        array = _changed(connection, array_id, generator)
    header = header_of(array)
    connection.execute("DELETE FROM wavelet_chunks WHERE array_id = ?", (array_id,))
    connection.execute(
        "UPDATE wavelet_arrays SET dtype = ?, shape = ?, filter = ?, chunk_rows = ? WHERE id = ?",
        (header.dtype, json.dumps(header.shape), header.filter, header.chunk_rows, array_id),
    )
    chunks = list(encode_array(array))
    if kind == "bomb" and rng.random() < 0.3:
        chunks = [_much_in_little()]
    connection.executemany(
        "INSERT INTO wavelet_chunks (array_id, sequence, data) VALUES (?,?,?)",
        ((array_id, k, chunk) for k, chunk in enumerate(chunks)),
    )
    return f"{name} {kind} {array.dtype} {array.shape}"


@cache
def _much_in_little():
    return zlib.compress(bytes(50_000_000))


def _changed(connection, array_id, generator):
    """Return the array with one number changed a little, or much."""
    from wavelet_gis.io.pyramid.array_tables import read_entries
    from wavelet_gis.io.pyramid.codecs.array_codec import decode_array

    columns = [row[1] for row in connection.execute("PRAGMA table_info(wavelet_arrays)")]
    entries = read_entries(connection, with_checksums="checksum" in columns)
    header = next(entry.header for entry in entries.values() if entry.array_id == array_id)
    blobs = [
        data
        for (data,) in connection.execute(
            "SELECT data FROM wavelet_chunks WHERE array_id = ? ORDER BY sequence", (array_id,)
        )
    ]
    array = decode_array(header, blobs, sum(map(len, blobs)))
    flat = array.reshape(-1)
    if flat.size:
        raw = flat.view(np.uint8)
        raw[generator.integers(raw.size)] ^= 1 << generator.integers(8)
    return array


def _schema(path, rng):
    table = rng.choice(list(TABLES))
    columns = [column for column in TABLES[table] if column != "id"]
    column = rng.choice(columns)
    others = ", ".join(c for c in columns if c != column)
    reckoned = rng.choice(("zeroblob(15000000)", "randomblob(1000)", "abs(1)", "'x'", "NULL"))
    endless = "WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n)"
    statements = rng.choice(
        (
            [f"DROP TABLE {table}"],
            [f"ALTER TABLE {table} RENAME COLUMN {column} TO other"],
            [f"ALTER TABLE {table} DROP COLUMN {column}"],
            [
                f"CREATE TABLE copied AS SELECT id, {others} FROM {table}",
                f"DROP TABLE {table}",
                f"ALTER TABLE copied RENAME TO {table}",
                f"ALTER TABLE {table} ADD COLUMN {column} AS ({reckoned})",
            ],
            [
                f"CREATE TABLE copied AS SELECT id, {others} FROM {table}",
                f"DROP TABLE {table}",
                f"ALTER TABLE copied RENAME TO {table}",
                f"ALTER TABLE {table} ADD COLUMN {column} DEFAULT 'a long text of nothing'",
            ],
            [
                f"ALTER TABLE {table} RENAME TO hidden",
                f"CREATE VIEW {table} AS SELECT * FROM hidden",
            ],
            [
                f"DROP TABLE {table}",
                f"CREATE VIEW {table} AS {endless} SELECT i AS id, i AS {column} FROM n",
            ],
            ["DROP INDEX IF EXISTS wavelet_chunks_of_array"],
            [f"{endless} INSERT INTO {table} ({column}) SELECT i FROM n LIMIT 30000"],
            [f"CREATE INDEX extra ON {table} ({column}, abs({column}))"],
        )
    )  # fmt: skip
    operate(path, *statements)
    return "; ".join(statements)[:90]


def summary_of(geo):
    """Return a digest of all that a pyramid holds."""
    metadata, arrays = pyramid_to_parts(geo)
    digest = hashlib.sha256(json.dumps(metadata, sort_keys=True, default=str).encode())
    for name, array in arrays.items():
        digest.update(f"{name} {array.shape} {array.dtype}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def whole(path):
    """Return a digest of all that a file holds, its input restored on the way."""
    read_summary(path)
    geo = read_pyramid(path)
    geo.restore()
    return summary_of(geo)


def input_of(path):
    """Return a digest of the input, which is read without the levels."""
    restored = read_input(path).restore()
    numbers = {name: getattr(restored, name, None) for name in ("values", "valid", "vertices")}
    digest = hashlib.sha256(type(restored).__name__.encode())
    if hasattr(restored, "coordinates"):
        numbers["coordinates"] = restored.coordinates()
    for name, array in numbers.items():
        if array is not None:
            digest.update(f"{name} {array.shape}".encode() + np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def level_of(path):
    """Return a digest of the coarsest level but one, from as little of the file as may be."""
    pyramid = read_levels(path, 1).pyramid
    mesh = pyramid.mesh(min(1, pyramid.n_levels))
    parts = (mesh.vertices, mesh.faces, mesh.attributes)
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()


#: The ways in which files are read, each of which must refuse what is damaged.
WAYS = (whole, input_of, level_of)


def read(path):
    """Read a pyramid file in every way; the verdict's text tells what came of each."""
    words, refusals = [], []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for way in WAYS:
            try:
                words.append(way(path))
            except WaveletError as error:
                if "\n" in str(error) or not str(error).strip():
                    raise RuntimeError(f"no one line: {error!r}") from error
                words.append("refused")
                # Not the error: a cursor in a frame of its traceback would keep the file locked.
                refusals.append(str(error))
    if len(refusals) == len(WAYS):
        raise WaveletError(refusals[0])
    return " ".join(words)


def is_original(text, expected):
    """Return whether whatever was read is that of the sound file."""
    pairs = zip(text.split(), expected.split(), strict=True)
    return all(word in ("refused", wanted) for word, wanted in pairs)


def samples(folder):
    """Write the files that are mutated: of DEMs, one in parts, one of before, a cloud, TINs."""
    from gis.samples import hills, write_las, write_tif

    from wavelet_core import analyse
    from wavelet_core.synthetic import hills as mesh_of_hills
    from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.model.mesh_origin import MeshOrigin
    from wavelet_gis.workflows.open import open_terrain

    values = hills(20, 25).astype("f4")
    values[5:9, 7:12] = -9999
    terrains = [
        open_terrain(write_tif(folder / "hills.tif", values, nodata=-9999)),
        open_terrain(write_las(folder / "trees.laz", 200), attributes=["intensity"]),
    ]
    geos = [t.geo_pyramid(analyse(t.mesh, levels=3)).with_errors() for t in terrains]
    tin = analyse(mesh_of_hills(12, 12), levels=2, signal="xyz")
    system, frame = CoordinateSystem(), LocalFrame()
    geos.append(GeoPyramid(tin, system, frame, "metre", MeshOrigin(), "tin"))
    smooth = analyse(mesh_of_hills(14, 12), levels=3)
    geos.append(GeoPyramid(smooth, system, frame, "metre", MeshOrigin(), "placed"))
    geos.append(geos[0].with_pyramid(geos[0].pyramid.with_gains({1: 0.5}), "halved"))
    for name, geo in zip(("raster", "cloud", "tin", "placed", "altered"), geos, strict=True):
        path = folder / f"{name}.gpkg"
        write_pyramid(path, geo)
        yield path, read(path)
        listed = path.with_name(f"{path.stem}_1.gpkg")
        write_format_one(listed, geo)
        yield listed, read(listed)
    path = folder / "former.gpkg"
    write_former_grid(path, geos[0])
    yield path, read(path)
    usual = recorded.LEAST_IN_PARTS, recorded.PART_SHARE, recorded.LEAST_IN_PART
    recorded.LEAST_IN_PARTS, recorded.PART_SHARE, recorded.LEAST_IN_PART = 100, 1 / 3, 20
    path = folder / "parts.gpkg"
    deep = terrains[0].geo_pyramid(analyse(terrains[0].mesh, levels=12)).with_errors()
    write_pyramid(path, deep)
    recorded.LEAST_IN_PARTS, recorded.PART_SHARE, recorded.LEAST_IN_PART = usual
    assert read_levels(path, 1).pyramid.part is not None
    yield path, read(path)


def main():
    """Run the trials and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="folder for the files that were not refused well")
    arguments = parser.parse_args()
    counts, worst, started = Counter(), 0.0, time.monotonic()
    memory = "/dev/shm" if Path("/dev/shm").is_dir() else None  # many small files
    with tempfile.TemporaryDirectory(dir=memory) as name, Trials(read, WaveletError) as trials:
        folder = Path(name)
        sources = list(samples(folder))
        for k in range(arguments.seed, arguments.seed + arguments.count):
            rng = random.Random(k)
            source, digest = rng.choice(sources)
            path = folder / "mutant.gpkg"
            state, done = mutate(source, path, rng)
            verdict = trials.run(path)
            worst = max(worst, verdict.seconds)
            outcome = verdict.outcome
            if outcome == "read":
                same = is_original(verdict.text, digest)
                outcome = "read, the original" if same else "read, another"
            counts[state, outcome] += 1
            is_fault = verdict.outcome not in ("read", "refused")
            if is_fault or (state, outcome) == ("intact", "read, another"):
                print(f"{k} {source.name} {state} {outcome}: {done}\n{verdict.text[-900:]}")
                if arguments.keep:
                    arguments.keep.mkdir(parents=True, exist_ok=True)
                    shutil.copy(path, arguments.keep / f"{k}.gpkg")
            if (k + 1) % 1000 == 0:
                print(f"{k + 1}: {time.monotonic() - started:.0f} s, {dict(counts)}", flush=True)
            for extra in folder.glob("mutant.gpkg*"):
                extra.unlink()
    for (state, outcome), count in sorted(counts.items()):
        print(f"{state:10} {outcome:20} {count:8}")
    print(f"slowest {worst:.2f} s; {time.monotonic() - started:.0f} s in all")


if __name__ == "__main__":
    main()
