"""Pyramid files opened up by tests: their checksums taken out, or made to fit what was changed."""

import itertools
import json
import sqlite3
from contextlib import contextmanager

from wavelet_core.errors import WaveletError
from wavelet_gis.io.pyramid import metadata_tables
from wavelet_gis.io.pyramid.array_tables import read_entries
from wavelet_gis.io.pyramid.codecs.array_codec import array_checksum, decode_array


@contextmanager
def opened(path):
    """Yield a connection, bounded as what it does to a damaged file may have no end."""
    connection = sqlite3.connect(path)
    looks = itertools.count()
    connection.set_progress_handler(lambda: next(looks) > 300, 10_000)
    connection.execute("PRAGMA synchronous = OFF")
    connection.execute("PRAGMA max_page_count = 50000")
    try:
        with connection:
            yield connection
    finally:
        connection.close()


def operate(path, *statements):
    """Run SQL on a file; a statement may be a tuple of SQL and its parameters."""
    with opened(path) as connection:
        for statement in statements:
            sql, *parameters = statement if isinstance(statement, tuple) else (statement,)
            connection.execute(sql, parameters)


#: Make of a file one as it was written before there were checksums.
STRIP = (
    "DELETE FROM wavelet_metadata WHERE name = 'checksums'",
    "UPDATE wavelet_metadata SET value = json_remove(value, '$.checksums') WHERE name = 'format'",
    "ALTER TABLE wavelet_arrays DROP COLUMN checksum",
)


def reseal(path):
    """Write the checksums that fit what is in the file now, as somebody with bad intent would.

    What cannot be read has no checksum, and keeps the one it had.
    """
    with opened(path) as connection:
        _reseal(connection)


def _reseal(connection):
    try:
        metadata_tables.require_tables(connection)  # an endless view would keep us, too
        entries = read_entries(connection, with_checksums=True)
    except (WaveletError, sqlite3.Error):
        return
    for name, entry in list(entries.items()):
        chunks = connection.execute(
            "SELECT data FROM wavelet_chunks WHERE array_id = ? ORDER BY sequence",
            (entry.array_id,),
        ).fetchall()
        try:
            blobs = [data for (data,) in chunks]
            array = decode_array(entry.header, blobs, sum(map(len, blobs)))
        except (WaveletError, TypeError):
            continue
        checksum = array_checksum(entry.header, [array])
        entries[name] = entry._replace(checksum=checksum)
        connection.execute(
            "UPDATE wavelet_arrays SET checksum = ? WHERE id = ?", (checksum, entry.array_id)
        )
    rows = connection.execute("SELECT name, value FROM wavelet_metadata").fetchall()
    texts = {name: value for name, value in rows if name != "checksums"}
    if not all(isinstance(text, str) for item in texts.items() for text in item):
        return
    try:
        levels = metadata_tables.read_level_rows(connection)
    except WaveletError:
        return
    checksums = metadata_tables.checksums_of(texts, levels, entries)
    connection.execute(
        "UPDATE wavelet_metadata SET value = ? WHERE name = 'checksums'", (json.dumps(checksums),)
    )
