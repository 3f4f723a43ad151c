"""Pyramid files of format 1, as terrain-wavelets wrote them before there was a second."""

import json
from dataclasses import replace

import numpy as np
from tools.pyramid_surgery import reseal

from wavelet_gis.io.geopackage import (
    create_geopackage,
    open_for_writing,
    register_attributes_table,
)
from wavelet_gis.io.pyramid import array_tables, listed_pyramid, metadata_tables, pyramid_parts
from wavelet_gis.io.pyramid.codecs.array_codec import encode_array, header_of
from wavelet_gis.model.exact_restore import exact_column

#: Every file had them.
_INDICES = f"""
{array_tables.INDEX}
CREATE UNIQUE INDEX metadata_names ON wavelet_metadata (name);
CREATE UNIQUE INDEX array_names ON wavelet_arrays (name);
"""


def write_format_one(path, geo):
    """Write a pyramid with lists of its steps, and with what rounding loses."""
    geo = replace(geo, origin=_with_ledger(geo))
    source, arrays = geo.origin.to_parts()
    arrays |= listed_pyramid.listed_arrays(geo.pyramid)
    if geo.pyramid.locked is not None:
        arrays["locked"] = geo.pyramid.locked
    metadata, _ = pyramid_parts.pyramid_to_parts(geo)
    metadata["source"] = source
    metadata["format"]["version"] = 1
    metadata.pop("record", None)
    for name in ("steps", "plan"):
        metadata["pyramid"].pop(name, None)
    create_geopackage(path)
    with open_for_writing(path) as connection:
        connection.executescript(metadata_tables.SCHEMA + _INDICES)
        for table, description in metadata_tables.TABLES.items():
            register_attributes_table(connection, table, description)
        metadata_tables.write_level_rows(connection, geo)
        for name, array in arrays.items():
            _write_array(connection, name, array)
        connection.executemany(
            "INSERT INTO wavelet_metadata (name, value) VALUES (?, ?)",
            [(name, json.dumps(value)) for name, value in metadata.items()],
        )
        connection.execute("INSERT INTO wavelet_metadata (name, value) VALUES ('checksums', '{}')")
    reseal(path)


def _write_array(connection, name, array):
    header = header_of(array)
    cursor = connection.execute(
        "INSERT INTO wavelet_arrays (name, dtype, shape, filter, chunk_rows, checksum) "
        "VALUES (?,?,?,?,?,'')",
        (name, header.dtype, json.dumps(header.shape), header.filter, header.chunk_rows),
    )
    connection.executemany(
        "INSERT INTO wavelet_chunks (array_id, sequence, data) VALUES (?,?,?)",
        [(cursor.lastrowid, k, chunk) for k, chunk in enumerate(encode_array(array))],
    )


def _with_ledger(geo):
    """Return the origin with remainders and exceptions where the input's numbers are kept."""
    origin, mesh = geo.origin, geo.pyramid.synthesise()
    kept = getattr(origin, "corrections", None)
    if kept is None:
        return origin
    if origin.grid is not None:
        corrections = exact_column(kept.values, origin._values(mesh, geo.frame))
    else:
        approximate = origin._approximate(mesh, geo.frame)
        corrections = tuple(
            exact_column(column.values, np.asarray(seen))
            for column, seen in zip(kept, approximate, strict=True)
        )
    return replace(origin, corrections=corrections)
