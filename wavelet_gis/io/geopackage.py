"""The little of GeoPackage that is written with sqlite3 alone.

Spatial layers are written by GDAL (through pyogrio, or by QGIS) into a file that this module made,
and it adds non-spatial tables and the styles that QGIS looks for.
"""

from __future__ import annotations

import itertools
import os
import re
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.names import MAX_DATABASE_NAME

__all__ = [
    "LayerStyle",
    "check_database",
    "check_rows",
    "compact_schema",
    "create_geopackage",
    "is_system_fault",
    "open_for_writing",
    "open_untrusted",
    "ordinary_columns",
    "register_attributes_table",
    "table_names",
    "widen_pages",
    "write_styles",
]

#: GeoPackage 1.2: what every GDAL since 2.2 and every QGIS that we serve reads without remark.
USER_VERSION = 10200
APPLICATION_ID = 0x47504B47

#: Longest value accepted from a file of unknown origin; ours are smaller.
MAX_VALUE_BYTES = 16 << 20

#: Longest statement in its schema; SQLite's own limit would take a gigabyte.
MAX_SQL_BYTES = 1 << 20

#: Instructions of SQLite's virtual machine for one file, in all. A pyramid of a hundred million
#: points takes some hundred thousand; a statement that never ends is ended.
MAX_INSTRUCTIONS = 50_000_000

#: The same for reading the schema, some eight steps a table; ours have a few hundred. SQLite 3.40
#: takes minutes to read one of 300,000 tables, in a file of 16 MB.
MAX_SCHEMA_INSTRUCTIONS = 200_000

#: Seconds to wait for another program that writes the file just now.
PATIENCE_SECONDS = 2.0

#: What SQLite's error codes mean to a user, by their first word, and how to mend it.
_FAULTS = {
    "BUSY": "another program holds the file locked",
    "LOCKED": "another program holds the file locked",
    "PROTOCOL": "another program holds the file locked",
    "READONLY": "the file, or the folder that it is in, may only be read",
    "PERM": "the system denies access to the file",
    "CANTOPEN": "the system does not open the file, or those of SQLite beside it",
    "IOERR": "the disk, or the network that it is on, failed",
    "FULL": "the disk is full",
    "NOMEM": "there is not enough memory",
}
_REMEDIES = {
    "BUSY": "close it there, or wait until it is done",
    "LOCKED": "close it there, or wait until it is done",
    "PROTOCOL": "close it there, or wait until it is done",
    "READONLY": "change the permissions, or copy it elsewhere",
    "PERM": "change the permissions, or copy it elsewhere",
    "CANTOPEN": "check the permissions of file and folder",
    "IOERR": "check the disk, or copy the file to another",
    "FULL": "make room and try again",
    "NOMEM": "close other programs and try again",
}

_WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,'
    'AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,'
    'AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],'
    'AXIS["Latitude",NORTH],AXIS["Longitude",EAST],AUTHORITY["EPSG","4326"]]'
)

#: With `gpkg_geometry_columns` in every file: the standard asks for it only where there are layers,
#: but GDAL lists no plain table without it, and QGIS opens none. Small files have the fewest pages
#: with the tables in this order.
_SCHEMA = """
CREATE TABLE gpkg_spatial_ref_sys (
  srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
CREATE TABLE gpkg_contents (
  table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
"""

_STYLES_SCHEMA = """
CREATE TABLE layer_styles (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, f_table_catalog TEXT(256),
  f_table_schema TEXT(256), f_table_name TEXT(256), f_geometry_column TEXT(256),
  styleName TEXT(30), styleQML TEXT, styleSLD TEXT, useAsDefault BOOLEAN, description TEXT,
  owner TEXT(30), ui TEXT(30), update_time DATETIME DEFAULT CURRENT_TIMESTAMP);
"""

#: Layer, name of the style, QML, one line about it.
LayerStyle = tuple[str, str, str, str]


#: Bytes in a page of a file with layers, and of a small one of plain tables alone: each table and
#: index takes one page at least, some twenty in all.
PAGE_BYTES = 4096
SMALL_PAGE_BYTES = 512


def create_geopackage(path: str | os.PathLike[str], page_bytes: int = PAGE_BYTES) -> None:
    """Create an empty GeoPackage 1.2.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    page_bytes : int
        A power of two, from 512 on.
    """
    with open_for_writing(path) as connection:
        connection.execute(f"PRAGMA page_size = {int(page_bytes)}")
        connection.executescript(compact_schema(_SCHEMA))
        rows = [
            ("Undefined Cartesian SRS", -1, "NONE", -1, "undefined", "undefined Cartesian"),
            ("Undefined geographic SRS", 0, "NONE", 0, "undefined", "undefined geographic"),
            ("WGS 84 geodetic", 4326, "EPSG", 4326, _WGS84, "in degrees"),
        ]
        connection.executemany("INSERT INTO gpkg_spatial_ref_sys VALUES (?,?,?,?,?,?)", rows)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {USER_VERSION}")


def widen_pages(path: str | os.PathLike[str]) -> None:
    """Give a file of small pages large ones, before layers are added to it.

    GDAL from 3.8 on makes spatial indices of which SQLite says, in pages of 512 bytes, that they
    are too small, and reads nothing.

    Parameters
    ----------
    path : path
        A file that nobody else knows yet.
    """
    with open_for_writing(path) as connection:
        (page_bytes,) = connection.execute("PRAGMA page_size").fetchone()
        if page_bytes < PAGE_BYTES:
            connection.execute(f"PRAGMA page_size = {PAGE_BYTES}")
            connection.execute("VACUUM")


def compact_schema(statements: str) -> str:
    """Return CREATE statements without the white space that they can do without.

    A file keeps them as they were written.

    Parameters
    ----------
    statements : str
        With no string of several words, or of brackets and commas with space around them.
    """
    return re.sub(r"(?<=[(,;]) | (?=[()])", "", " ".join(statements.split()))


@contextmanager
def open_for_writing(path: str | os.PathLike[str]) -> Iterator[sqlite3.Connection]:
    """Yield a connection to a file that nobody else knows yet, committed when the block ends.

    There is no journal: a file that fails half-way is a scratch file and is thrown away.

    Raises
    ------
    OutputFileError
        When SQLite cannot write: what hinders it, and how to mend that.
    """
    name = os.path.abspath(path)  # ":memory:" is the name of a file here
    try:
        connection = sqlite3.connect(name)
        try:
            connection.execute("PRAGMA journal_mode = OFF")
            connection.execute("PRAGMA synchronous = OFF")
            yield connection
            connection.commit()
        finally:
            connection.close()
    except sqlite3.Error as error:
        words = (
            _system_fault(error)
            or f"SQLite refuses to write it ({_short(error)}); please report this"
        )
        raise OutputFileError(f"{name}: {words}.") from error


@contextmanager
def open_untrusted(
    path: str | os.PathLike[str], *, max_instructions: int | None = MAX_INSTRUCTIONS
) -> Iterator[sqlite3.Connection]:
    """Yield a read-only connection to a GeoPackage of unknown origin.

    Parameters
    ----------
    path : path
        The file.
    max_instructions : int, optional
        How much SQLite may do for it, in steps of its virtual machine; None for a file that this
        process has written, all of whose rows may be looked at.

    Raises
    ------
    InputFileError
        When the file is missing, held by another program or no SQLite database, or asks for more
        work than any pyramid file needs.
    """
    name = os.fspath(path)
    if os.path.isdir(name):
        raise InputFileError(f"{name}: this is a folder; name the pyramid file in it.")
    if not os.path.exists(name):
        raise InputFileError(f"{name}: there is no such file; check the path.")
    if not os.path.isfile(name):
        raise InputFileError(f"{name}: this is a pipe or a device; give a pyramid file.")
    if len(os.fsencode(os.path.abspath(name))) > MAX_DATABASE_NAME:
        raise InputFileError(
            f"{os.path.basename(name)}: SQLite cannot open a path of more than "
            f"{MAX_DATABASE_NAME} bytes; move it to a folder nearer to the root."
        )
    uri = "file:" + quote(os.fsencode(Path(name).absolute())) + "?mode=ro"
    try:
        connection = sqlite3.connect(uri, uri=True, timeout=PATIENCE_SECONDS)
        try:
            _guard(connection)
            _bound(connection, MAX_SCHEMA_INSTRUCTIONS, looks_every=1000)
            connection.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()
            _bound(connection, max_instructions, looks_every=100_000)
            yield connection
        finally:
            connection.close()
    # A damaged schema may hold text that is none.
    except (sqlite3.Error, UnicodeError) as error:
        raise InputFileError(f"{name}: {_reading_fault(name, error)}.") from error


def _guard(connection: sqlite3.Connection) -> None:
    """Bound what a file of unknown origin can make SQLite do."""
    # Views, triggers and functions in the schema of such a file must not run.
    connection.execute("PRAGMA trusted_schema = OFF")
    connection.execute("PRAGMA query_only = ON")
    connection.execute("PRAGMA cell_size_check = ON")
    connection.execute("PRAGMA mmap_size = 0")  # a file cut short meanwhile would kill the process
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_VALUE_BYTES)
    connection.setlimit(sqlite3.SQLITE_LIMIT_SQL_LENGTH, MAX_SQL_BYTES)
    connection.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, 0)


def _bound(
    connection: sqlite3.Connection, max_instructions: int | None, *, looks_every: int
) -> None:
    """End a statement after so many more steps of SQLite's virtual machine."""
    if max_instructions is None:
        connection.set_progress_handler(None, 0)
        return
    looks, most = itertools.count(1), max_instructions // looks_every
    connection.set_progress_handler(lambda: next(looks) > most, looks_every)


def is_system_fault(error: BaseException) -> bool:
    """Whether a file could not be read for no fault of its own: it is locked, or out of reach.

    Parameters
    ----------
    error : exception
        That opening or reading it raised.
    """
    return error.__cause__ is not None and _system_fault(error.__cause__) is not None


def _system_fault(error: BaseException) -> str | None:
    """Return what hinders the system, and the remedy; None where the file itself is at fault."""
    code = getattr(error, "sqlite_errorname", "SQLITE_")
    if code in ("SQLITE_IOERR_SHORT_READ", "SQLITE_IOERR_CORRUPTFS"):
        return None
    word = code.split("_")[1]
    return f"{_FAULTS[word]} ({_short(error)}); {_REMEDIES[word]}" if word in _FAULTS else None


def _short(error: BaseException) -> str:
    """Return SQLite's words in one line; it may quote a damaged schema at length."""
    words = " ".join(str(error).split())
    return words if len(words) <= 120 else f"{words[:117]}..."


def _reading_fault(name: str, error: Exception) -> str:
    if fault := _system_fault(error):
        return fault
    if getattr(error, "sqlite_errorname", "") == "SQLITE_INTERRUPT":
        return (
            "reading it asks for more work than any pyramid file needs; give one that "
            "an analysis made"
        )
    if os.path.exists(f"{name}-wal"):
        return (
            f"this is no GeoPackage, or a damaged one ({_short(error)}); {name}-wal lies beside "
            "it, and if that is left over from an older file of this name, remove it"
        )
    return (
        f"this is no GeoPackage, or a damaged one ({_short(error)}); give a pyramid file that "
        "an analysis made"
    )


def check_database(path: str | os.PathLike[str]) -> None:
    """Read a GeoPackage back by SQLite's own check.

    Raises
    ------
    InputFileError, OutputFileError
        With what is wrong.
    """
    with open_untrusted(path, max_instructions=None) as connection:
        verdict = str(connection.execute("PRAGMA quick_check(1)").fetchone()[0])
    if verdict != "ok":
        raise OutputFileError(f"SQLite finds {verdict}")


def check_rows(path: str | os.PathLike[str], n_rows: Mapping[str, int]) -> None:
    """Read a GeoPackage back by the number of rows that its tables must have.

    Raises
    ------
    InputFileError, OutputFileError
        With what is wrong.
    """
    with open_untrusted(path, max_instructions=None) as connection:
        for table, n in n_rows.items():
            quoted = '"' + table.replace('"', '""') + '"'
            (there,) = connection.execute(f"SELECT COUNT(*) FROM {quoted}").fetchone()  # nosec B608
            if there != n:
                raise OutputFileError(f"table {table} holds {there} rows of {n}")


def table_names(connection: sqlite3.Connection) -> set[str]:
    """Names of the ordinary tables, not of views or virtual tables that pose as such."""
    rows = connection.execute(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage > 0"
    )
    return {str(name) for (name,) in rows}


def ordinary_columns(connection: sqlite3.Connection, table: str) -> set[str]:
    """Names of the columns whose values are stored, not reckoned as they are read.

    Parameters
    ----------
    connection : sqlite3.Connection
    table : str
        Of this package's own naming, never of the file's.
    """
    rows = connection.execute(f"PRAGMA table_xinfo({table})")
    return {str(name) for _, name, _, _, _, _, hidden in rows if not hidden}


def register_attributes_table(connection: sqlite3.Connection, table: str, description: str) -> None:
    """List a non-spatial table in the GeoPackage's contents."""
    connection.execute(
        "INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change, "
        "srs_id) VALUES (?, 'attributes', ?, ?, ?, 0)",
        (table, table, description, now()),
    )


def write_styles(path: str | os.PathLike[str], styles: Iterable[LayerStyle]) -> None:
    """Store the default style of layers, where QGIS looks for it when it opens them.

    This is the last step in writing a file; all its contents are dated from it.
    """
    rows = [
        ("", "", layer, "geom", name, qml, None, 1, description, "", None, now())
        for layer, name, qml, description in styles
    ]
    with open_for_writing(path) as connection:
        if "layer_styles" not in table_names(connection):
            connection.executescript(_STYLES_SCHEMA)
            register_attributes_table(connection, "layer_styles", "Styles of the layers for QGIS")
        connection.executemany(
            "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, "
            "f_geometry_column, styleName, styleQML, styleSLD, useAsDefault, description, owner, "
            "ui, update_time) VALUES (?,?,?,?,?,?,?,?,?,?,?,?)",
            rows,
        )
        # GDAL stamps its own time on the layers that it writes. Its option against that holds for
        # the whole process, and so for other threads.
        connection.execute("UPDATE gpkg_contents SET last_change = ?", (now(),))


def now() -> str:
    """Return the time in GeoPackage's form; that of SOURCE_DATE_EPOCH where it is set.

    With that variable, two runs on the same input write the same bytes.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    seconds = float(epoch) if epoch else time.time()
    return time.strftime("%Y-%m-%dT%H:%M:%S.000Z", time.gmtime(seconds))
