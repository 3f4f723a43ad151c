"""Bytes and seconds of the compressors that the arrays of pyramid files may be written with.

    python benchmarks/cost/lzma_options.py PYRAMID.gpkg...

The arrays of the files that LZMA has made small are packed anew, at most 24 MB of each file. A row
a way of doing so; bytes and seconds of the processor are shares of those of the way in use.
"""

from __future__ import annotations

import argparse
import json
import lzma
import sqlite3
import time
import zlib
from collections.abc import Callable
from pathlib import Path

from wavelet_gis.io.pyramid.codecs import array_codec
from wavelet_gis.io.pyramid.codecs.array_codec import FILTERS, WRITTEN_LZMA_FILTERS, ArrayHeader

MOST_BYTES = 24 << 20
CHUNKS = """
SELECT dtype, shape, filter, chunk_rows, sequence, data FROM wavelet_arrays AS a
JOIN wavelet_chunks AS c ON c.array_id = a.id ORDER BY a.id, sequence"""
IN_USE = WRITTEN_LZMA_FILTERS[0]


def chunks_of(path: Path) -> list[bytes]:
    """Return what was given to LZMA."""
    chunks: list[bytes] = []
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as connection:
        for dtype, shape, name, chunk_rows, sequence, data in connection.execute(CHUNKS):
            header = ArrayHeader.checked(dtype, json.loads(shape), name, chunk_rows)
            if not FILTERS[name].is_lzma or sum(map(len, chunks)) > MOST_BYTES:
                continue
            n_rows = min(chunk_rows, header.shape[0] - sequence * chunk_rows)
            n_bytes = n_rows * header.n_bytes // header.shape[0]
            chunks.append(array_codec._expand(data, n_bytes, is_lzma=True))
    return chunks


def by_lzma(**options: int) -> Callable[[bytes], int]:
    """Return what gives the size with other options than those in use."""
    filters = [{**IN_USE, **options}]
    return lambda chunk: len(lzma.compress(chunk, lzma.FORMAT_RAW, filters=filters))


WAYS: dict[str, Callable[[bytes], int]] = {
    "in use: 64 KiB, HC3, 1 trial": by_lzma(),
    "16 KiB": by_lzma(dict_size=1 << 14),
    "1 MiB": by_lzma(dict_size=1 << 20),
    "1 MiB, HC4, 4 trials": by_lzma(dict_size=1 << 20, mf=lzma.MF_HC4, depth=4),
    "matches up to 8": by_lzma(nice_len=8),
    "fast mode": by_lzma(mode=lzma.MODE_FAST),
    "preset 6": lambda chunk: len(lzma.compress(chunk, lzma.FORMAT_RAW, filters=[
        {"id": lzma.FILTER_LZMA2, "preset": 6, "lc": 0, "lp": 0, "pb": 0}])),
    "zlib 1": lambda chunk: len(zlib.compress(chunk, 1)),
    "zlib 6": lambda chunk: len(zlib.compress(chunk, 6)),
}  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("pyramids", nargs="+", type=Path)
    chunks = [chunk for path in parser.parse_args().pyramids for chunk in chunks_of(path)]
    found = {}
    for name, size in WAYS.items():
        start = time.process_time()
        found[name] = sum(map(size, chunks)), time.process_time() - start
    n_bytes, seconds = next(iter(found.values()))
    print(f"{sum(map(len, chunks)):,} bytes, {n_bytes:,} when packed, {seconds:.2f} s\n")
    print("| way | bytes | time |\n|---|---|---|")
    for name, (of_way, taken) in found.items():
        print(f"| {name} | {of_way / n_bytes:.4f} | {taken / seconds:.2f} |")


if __name__ == "__main__":
    main()
