"""Bits a vertex of exact pyramids beside the best lossless codecs of the same data.

    python benchmarks/cost/file_size.py [--data ../shared/data] [--most 3000000]
        [--write docs/reference/format.md]

The pyramid is the default one with ``--layers none``, the whole file counted. Rasters are written
as tiled GeoTIFF with a predictor and ZSTD 19 or DEFLATE 9, and as LERC in GeoTIFF, lossless; the
smallest counts. Clouds are compared with LAZ. Every pyramid is read again and gives back its input.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

CLOUDS = (
    "Topography.laz",
    "mountain_utm42_38k.las",
    "autzen_trim.las",
    "bcts_1.laz",
    "ign_tiles_77055_627755.laz",
)


def best_raster(path: Path, folder: str) -> tuple[int, str]:
    """Return the bytes of the smallest lossless raster file, and which it is."""
    import numpy as np
    import rasterio

    sizes = []
    with rasterio.open(path) as dataset:
        band = dataset.read(1)
        profile = {
            "driver": "GTiff", "count": 1, "height": dataset.height, "width": dataset.width,
            "dtype": band.dtype, "crs": dataset.crs, "transform": dataset.transform,
            "nodata": dataset.nodata, "tiled": True, "blockxsize": 256, "blockysize": 256,
        }  # fmt: skip
    predictors = (2, 3) if band.dtype.kind == "f" else (2,)
    if band.dtype == np.float64:
        predictors = (3,)
    kinds = [("ZSTD", {"zstd_level": 19, "predictor": p}) for p in predictors]
    kinds += [("DEFLATE", {"zlevel": 9, "predictor": p}) for p in predictors]
    kinds += [("LERC", {"max_z_error": 0}), ("LERC_ZSTD", {"max_z_error": 0, "zstd_level": 19})]
    for compress, options in kinds:
        target = os.path.join(folder, f"{compress}_{options.get('predictor', '')}.tif")
        try:
            with rasterio.open(target, "w", **profile, compress=compress, **options) as dataset:
                dataset.write(band, 1)
        except rasterio.errors.RasterioError:
            continue  # a GDAL without that codec
        with rasterio.open(target) as dataset:
            if dataset.read(1).tobytes() != band.tobytes():
                continue
        name = f"{compress} {options['predictor']}" if "predictor" in options else compress
        sizes.append((os.path.getsize(target), name))
    return min(sizes)


def laz(path: Path, folder: str) -> tuple[int, str]:
    """Return the bytes of a cloud as LAZ."""
    import laspy

    target = os.path.join(folder, "cloud.laz")
    laspy.read(path).write(target)
    smallest = os.path.getsize(target)
    if path.suffix == ".laz":
        smallest = min(smallest, path.stat().st_size)
    return smallest, "LAZ"


def row_of(path: Path, most: int) -> str | None:
    """Return a row of the table; None for what has more vertices than ``most``."""
    import wavelet_gis as wg

    is_cloud = path.suffix in (".las", ".laz")
    terrain = wg.open(path)
    n = terrain.mesh.n_vertices
    if n > most:
        return None
    with tempfile.TemporaryDirectory() as folder:
        codec, name = (laz if is_cloud else best_raster)(path, folder)
        target = os.path.join(folder, "pyramid.gpkg")
        analysis = wg.analyse(terrain, measure=False)
        wg.save(analysis, target, layers="none")
        assert wg.load(target).restore() is not None
        size = os.path.getsize(target)
    kind = "LAS" if is_cloud else terrain.original.values.dtype.name
    return (
        f"| {path.name} | {kind} | {n:,} | {8 * codec / n:.2f} ({name}) | {8 * size / n:.2f} | "
        f"{size / codec:.2f} |"
    )


def main() -> None:
    """Print the table, and put it in its place."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--most", type=int, default=3_000_000, help="skip larger ones")
    parser.add_argument("--only", nargs="*", help="names of files, instead of all")
    parser.add_argument("--write", type=Path, help="a page with the comments around the table")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    paths = [*sorted((arguments.data / "dems").glob("*.tif"))]
    paths += [arguments.data / "clouds" / name for name in CLOUDS]
    lines = [
        "| data | numbers | vertices | best codec, bits | pyramid, bits | ratio |",
        "|---|---|---|---|---|---|",
    ]
    print("\n".join(lines))
    for path in paths:
        if arguments.only and path.name not in arguments.only:
            continue
        row = row_of(path, arguments.most)
        if row is not None:
            lines.append(row)
            print(row, flush=True)
    if arguments.write:
        text = arguments.write.read_text(encoding="utf-8")
        begin, end = "<!-- sizes -->\n", "<!-- end of sizes -->"
        before, rest = text.split(begin)
        after = rest.split(end)[1]
        arguments.write.write_text(
            before + begin + "\n".join(lines) + "\n" + end + after, encoding="utf-8"
        )


if __name__ == "__main__":
    main()
