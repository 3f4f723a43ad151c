"""The little of GeoPackage that is written with sqlite3 alone.

Spatial layers are written by GDAL (through pyogrio, or by QGIS) into a file that this module made,
and it adds non-spatial tables and the styles that QGIS looks for.
"""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from wavelet_gis.errors import InputFileError

__all__ = [
    "LayerStyle",
    "create_geopackage",
    "open_for_writing",
    "open_stranger",
    "register_attributes_table",
    "table_names",
    "write_styles",
]

#: GeoPackage 1.2: what every GDAL since 2.2 and every QGIS that we serve reads without remark.
USER_VERSION = 10200
APPLICATION_ID = 0x47504B47

#: Longest value accepted from a file of unknown origin; ours are smaller.
MAX_VALUE_BYTES = 64 << 20

_WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,'
    'AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,'
    'AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],'
    'AXIS["Latitude",NORTH],AXIS["Longitude",EAST],AUTHORITY["EPSG","4326"]]'
)

_SCHEMA = """
CREATE TABLE gpkg_spatial_ref_sys (
  srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (
  table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
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


def create_geopackage(path: str | os.PathLike[str]) -> None:
    """Create an empty GeoPackage 1.2."""
    with open_for_writing(path) as connection:
        connection.executescript(_SCHEMA)
        rows = [
            ("Undefined Cartesian SRS", -1, "NONE", -1, "undefined", "undefined Cartesian"),
            ("Undefined geographic SRS", 0, "NONE", 0, "undefined", "undefined geographic"),
            ("WGS 84 geodetic", 4326, "EPSG", 4326, _WGS84, "longitude and latitude in degrees"),
        ]
        connection.executemany("INSERT INTO gpkg_spatial_ref_sys VALUES (?,?,?,?,?,?)", rows)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {USER_VERSION}")


@contextmanager
def open_for_writing(path: str | os.PathLike[str]) -> Iterator[sqlite3.Connection]:
    """Yield a connection to a file that nobody else knows yet, committed when the block ends.

    There is no journal: a file that fails half-way is a scratch file and is thrown away.
    """
    connection = sqlite3.connect(os.fspath(path))
    try:
        connection.execute("PRAGMA journal_mode = OFF")
        connection.execute("PRAGMA synchronous = OFF")
        yield connection
        connection.commit()
    finally:
        connection.close()


@contextmanager
def open_stranger(path: str | os.PathLike[str]) -> Iterator[sqlite3.Connection]:
    """Yield a read-only connection to a GeoPackage of unknown origin.

    Raises
    ------
    InputFileError
        When the file is missing or no SQLite database.
    """
    name = os.fspath(path)
    if os.path.isdir(name):
        raise InputFileError(f"{name}: this is a folder; name the pyramid file in it.")
    if not os.path.exists(name):
        raise InputFileError(f"{name}: there is no such file; check the path.")
    uri = "file:" + quote(str(Path(name).absolute())) + "?mode=ro"
    connection = sqlite3.connect(uri, uri=True)
    try:
        # Views, triggers and functions in the schema of a stranger must not run.
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_VALUE_BYTES)
        connection.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()
        yield connection
    # A damaged schema may hold text that is none.
    except (sqlite3.Error, UnicodeError) as error:
        raise InputFileError(
            f"{name}: this is no GeoPackage, or a damaged one ({error}); give a pyramid file that "
            "an analysis made."
        ) from error
    finally:
        connection.close()


def table_names(connection: sqlite3.Connection) -> set[str]:
    """Names of the tables, not of views that pose as tables."""
    rows = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
    return {str(name) for (name,) in rows}


def register_attributes_table(connection: sqlite3.Connection, table: str, description: str) -> None:
    """List a non-spatial table in the GeoPackage's contents."""
    connection.execute(
        "INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change, "
        "srs_id) VALUES (?, 'attributes', ?, ?, ?, 0)",
        (table, table, description, now()),
    )


def write_styles(path: str | os.PathLike[str], styles: Iterable[LayerStyle]) -> None:
    """Store the default style of layers, where QGIS looks for it when it opens them."""
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


def now() -> str:
    """Return the time in GeoPackage's form; that of SOURCE_DATE_EPOCH where it is set.

    With that variable, two runs on the same input write the same bytes.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    seconds = float(epoch) if epoch else time.time()
    return time.strftime("%Y-%m-%dT%H:%M:%S.000Z", time.gmtime(seconds))
