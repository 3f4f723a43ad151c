"""Pyramid files as terrain-wavelets wrote them before.

They are those of format 1, and those of formats 2 and 3 with the residuals of rasters of then.
"""

import json
import zlib
from dataclasses import replace
from unittest.mock import patch

import numpy as np
from tools.pyramid_surgery import reseal

from wavelet_gis.io.geopackage import (
    create_geopackage,
    open_for_writing,
    register_attributes_table,
)
from wavelet_gis.io.pyramid import array_tables, listed_pyramid, metadata_tables, pyramid_parts
from wavelet_gis.io.pyramid.codecs.array_codec import encode_array, header_of, zigzag
from wavelet_gis.io.pyramid.codecs.former_grids import (
    RELIEF_CLASSES,
    former_relief,
    pass_by_pass,
    with_escapes,
)
from wavelet_gis.io.pyramid.codecs.grid_codec import integers_of
from wavelet_gis.io.pyramid.codecs.grid_walk import walk
from wavelet_gis.io.pyramid.pyramid_file import write_pyramid
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


def write_former_grid(path, geo):
    """Write a pyramid of a raster with the residuals of formats 2 and 3."""
    with patch.object(pyramid_parts, "shrink_source", _shrink_as_before):
        write_pyramid(path, geo)


def _shrink_as_before(geo, source, arrays, progress=None):
    del progress
    numbers = integers_of(arrays.pop("source/ledger/values"))
    residuals = former_residuals(numbers.integers, geo.origin.grid.valid)
    arrays["source/residuals"], arrays["source/beyond"] = residuals.numbers, residuals.beyond
    source["divisor"] = numbers.divisor
    source["relief_classes"] = list(residuals.classes)
    if numbers.palette is not None:
        arrays["source/palette"] = numbers.palette
        source["palette"] = len(numbers.palette)


def former_residuals(integers, valid):
    """Return the residuals of the valid cells in the smaller of two orders."""
    grid = np.zeros(valid.shape, dtype=np.int64)
    grid[valid] = integers
    parts, reliefs = [], []

    def keep(predicted, cells, relief):
        parts.append(zigzag((cells - predicted).view(np.uint64)))
        reliefs.append(relief)
        return cells

    walk(grid, valid, former_relief, keep, with_errors=False)
    first = pass_by_pass(list(zip(parts, reliefs, strict=True)))
    classes = np.searchsorted(RELIEF_CLASSES, np.concatenate(reliefs), side="right")
    counts = np.bincount(classes, minlength=len(RELIEF_CLASSES) + 1)
    order = np.argsort(classes, kind="stable")
    second = with_escapes(np.concatenate(parts)[order], tuple(counts.tolist()))
    n_first, n_second = (len(zlib.compress(one.numbers.tobytes(), 6)) for one in (first, second))
    return first if n_first <= n_second else second
