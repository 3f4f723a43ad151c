"""Write docs/reference/data-table.md: what became of every file of the real test data.

    python3 scripts/data_table.py [--only SMALL|LARGE|MISSING] [--data FOLDER]

Each file goes through ``analyse`` and ``reconstruct`` and what comes back is compared with it: a
raster bit for bit, with its mask; a LAS file byte for byte; a LAZ file by all bytes of its points.
Rows of files that are not tried stay as they are in the page. A fact without a reason in this
script is an error: whoever adds one says why it is right.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import re
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "reference" / "data-table.md"
FOLDERS = ("dems", "clouds", "nasty", "ept", "found")

#: Files from here on, in bytes, take long: rasters are compressed, clouds hold 10 bytes a point.
LARGE_FILE = 600_000

#: Why it is right that something is noted.
WHY_NOTED = {
    "companion_of_old_output": "a file beside may describe the output that was replaced",
    "crs_missing": "without a CRS nothing says where x and y are or in what unit",
    "crs_of_unknown_kind": "a local CRS may be in any unit",
    "doubtful_elevations": "the number may be meant as nodata, and only the user knows",
    "ept_counts": "the hierarchy of the set contradicts its files",
    "gaps": "long triangles across gaps are no terrain; `--max-edge` leaves them out",
    "header_extent": "the extent in the header is not that of the points",
    "impossible_elevations": "no terrain is that high, so these cells are holes",
    "las_crs": "two records, or coordinates and CRS, contradict each other",
    "las_header": "the header contradicts the file, or itself, where the points can still be read",
    "local_metric_frame": "slopes and areas need metres on both axes",
    "merged_cloud": "the nodes of a set are one cloud",
    "merged_points": "a surface has one height at a place; the others count in every error",
    "plane_not_true_to_scale": "lengths on this plane are not those on the ground",
    "points_aside": "noise and withheld points are no ground; they come back all the same",
    "points_missing": "the file ends before the points that its header announces",
    "raster_read_with_complaints": "what GDAL found odd may matter",
    "vertical_unit_assumed": "nothing gives the unit of z",
    "vertical_unit_converted": "heights and lengths must have one unit while working",
    "waveforms": "the waveforms are in another file, which is not copied",
}

#: Why it is right to refuse, by what the refusal says.
WHY_REFUSED = (
    ("every cell of the raster is nodata", "there is no elevation"),
    (
        "choose the elevation band",
        "which band holds elevations is not for a program to guess",
    ),
    ("the raster cannot be read", "half of a raster is no result"),
    ("holds no points", "there is nothing to read"),
    ("a surface needs at least three", "a point is no surface"),
    (
        "the compressed points cannot be read",
        "the points cannot be had, and the decoder must not take the program with it",
    ),
    ("give no elevations", "a scale of 0 makes one number of all elevations"),
    ("corners; a TIN is made of triangles", "the clip polygon of a case, no terrain"),
    ("holds neither points nor triangles", "the breakline of a case, no terrain"),
    ("the header announces", "such counts do not fit the size of the file"),
    ("give no coordinates that a CRS has", "such offsets are beyond any place on the earth"),
    ("sub-datasets", "which one holds the terrain is not for a program to guess; each is an input"),
    (
        "there are the layers",
        "which one holds the terrain is not for a program to guess; each is an input",
    ),
)

#: Why a file is no input.
BESIDE = {
    ".md": "text about the data",
    ".txt": "text about the case",
    ".sh": "the commands of the case",
    ".prj": "part of a shapefile that must be left alone",
    ".shp": "a shapefile that must be left alone",
    ".dbf": "part of a shapefile that must be left alone",
    ".shx": "part of a shapefile that must be left alone",
    ".cpg": "part of a shapefile that must be left alone",
}

HEAD = """# Every file of the test data

What `analyse` and `reconstruct` make of each file of the data folder that the tests use (it is
not part of the repository). Written by `scripts/data_table.py`; a test holds this page against
what it finds.

"""


def files(data: Path) -> Iterator[Path]:
    """Yield the files of the data, in order; not what programs leave beside rasters they opened."""
    for folder in FOLDERS:
        found = (path for path in (data / folder).rglob("*") if path.is_file())
        yield from sorted(path for path in found if not path.name.endswith(".aux.xml"))


def is_large(path: Path) -> bool:
    """Return whether a file is tried on request only."""
    return path.stat().st_size >= LARGE_FILE


def row(path: Path, data: Path) -> tuple[str, str, str]:
    """Return what a file is called, what happened, and why that is right."""
    name = path.relative_to(data).as_posix()
    if path.suffix in BESIDE:
        return name, "not an input", BESIDE[path.suffix]
    if path.suffix == ".json" and path.name != "ept.json":
        return name, "not an input", "an index that its set of tiles refers to"
    with tempfile.TemporaryDirectory() as scratch, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what is to be said of the file, the program says
        happened, reasons = _tried(path, Path(scratch))
    return name, "; ".join(happened), "; ".join(dict.fromkeys(reasons))


def _tried(path: Path, scratch: Path) -> tuple[list[str], list[str]]:
    pyramid, options = scratch / "p.gpkg", ["--levels", "1", "--no-errors", "--layers", "none"]
    if path.suffix == ".tif" and _n_bands(path) > 1:
        refusal = _run("analyse", path, pyramid, *options)[2]
        options += ["--band", "1"]
        happened, reasons = [_refusal(refusal, path)], [_why_refused(refusal)]
        happened.append("with `--band 1`")
    else:
        happened, reasons = [], []
    code, out, err = _run("analyse", path, pyramid, *options, "--json")
    if code != 0:
        return [*happened, _refusal(err, path)], [*reasons, _why_refused(err)]
    figures = json.loads(out)
    notes = json.loads(_run("info", pyramid, "--json")[1])["notes"]
    happened.append(f"{figures['n_vertices']:,} vertices")
    back = scratch / ("back.laz" if path.name == "ept.json" else f"back{path.suffix}")
    code, _, err = _run("reconstruct", pyramid, back)
    if code != 0:
        happened.append(_refusal(err, path))
        reasons.append(_why_refused(err))
    else:
        happened.append(_comparison(path, back))
        reasons.append("nothing was asked to change")
    for code in dict.fromkeys(note["code"] for note in notes):
        happened.append(f"noted: {code.replace('_', ' ')}")
        reasons.append(WHY_NOTED[code])
    return happened, reasons


def _run(*arguments: Any) -> tuple[int, str, str]:
    from wavelet_gis.cli.main import main

    out, err = io.StringIO(), io.StringIO()
    both = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
    with both[0], both[1]:
        code = main([str(argument) for argument in arguments])
    lines = [line for line in err.getvalue().splitlines() if " error: " in line]
    return code, out.getvalue(), lines[-1] if lines else ""


def _refusal(line: str, path: Path) -> str:
    text = line.partition(" error: ")[2].replace(str(path), path.name)
    text = text.removeprefix(f"{path.name}: ")
    return "refused: " + re.sub(r"/\S*/", "", text).replace("|", "/").rstrip(".")


def _why_refused(line: str) -> str:
    for words, why in WHY_REFUSED:
        if words in line:
            return why
    raise KeyError(f"no reason is given for: {line}")


def _n_bands(path: Path) -> int:
    import rasterio

    with rasterio.Env(), rasterio.open(path) as dataset:
        return int(dataset.count)


def _comparison(path: Path, back: Path) -> str:
    if path.suffix == ".tif":
        import rasterio

        with rasterio.Env(), rasterio.open(path) as one, rasterio.open(back) as other:
            same = one.read(1).tobytes() == other.read(1).tobytes()
            same &= (one.read_masks(1) == other.read_masks(1)).all()
            same &= tuple(one.transform) == tuple(other.transform)
        return "comes back bit for bit" if same else "COMES BACK CHANGED"
    import laspy
    import numpy as np

    if path.name == "ept.json":
        nodes = [laspy.read(node).xyz for node in sorted(path.parent.glob("ept-data/*.laz"))]
        due, found = np.concatenate(nodes), laspy.read(back).xyz
        same = due.shape == found.shape and np.allclose(
            np.sort(due, 0), np.sort(found, 0), atol=1e-6
        )
        return "the points of all nodes come back" if same else "COMES BACK CHANGED"
    if path.read_bytes() == back.read_bytes():
        return "comes back byte for byte"

    one, other = laspy.read(path), laspy.read(back)
    same = one.points.array.tobytes() == other.points.array.tobytes()
    return "every byte of every point comes back" if same else "COMES BACK CHANGED"


def known_rows() -> dict[str, tuple[str, str, str]]:
    """Return the rows of the page as it is, by file."""
    if not PAGE.is_file():
        return {}
    rows = re.findall(r"^\| `(.+?)` \| (.*?) \| (.*?) \|$", PAGE.read_text("utf-8"), re.MULTILINE)
    return {name: (name, happened, why) for name, happened, why in rows}


def page(rows: list[tuple[str, str, str]]) -> str:
    """Return the page."""
    lines = ["| file | what happened | why that is right |", "| --- | --- | --- |"]
    lines += [f"| `{name}` | {happened} | {why} |" for name, happened, why in rows]
    return HEAD + "\n".join(lines) + "\n"


def main() -> int:
    """Write the page; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", choices=("SMALL", "LARGE", "MISSING"))
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data")
    arguments = parser.parse_args()
    rows = known_rows()
    names = [path.relative_to(arguments.data).as_posix() for path in files(arguments.data)]
    for name in names:
        path = arguments.data / name
        states = {"LARGE" if is_large(path) else "SMALL", "LISTED" if name in rows else "MISSING"}
        if arguments.only is None or arguments.only in states:
            rows[name] = row(path, arguments.data)
            print(f"{name}: {rows[name][1]}", flush=True)
            PAGE.write_text(page([rows[one] for one in names if one in rows]), "utf-8")
    return 0


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    sys.exit(main())
