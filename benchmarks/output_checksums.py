"""Checksums of what the command line writes from real data, to compare two versions by.

    python benchmarks/output_checksums.py [DATA] [--large] [--only GLOB] --output old.json
    python benchmarks/output_checksums.py [DATA] [--large] [--only GLOB] --compare old.json
    python benchmarks/output_checksums.py --results new.json --compare old.json

Runs the commands of CASES over DATA/dems/*.tif and DATA/clouds/*.la[sz], writes the SHA-256 of each
output, exit codes, messages and printed figures as JSON, and compares. The code is that which
``python -c "import wavelet_gis"`` finds in the folder where this is started. Times of writing are
those of SOURCE_DATE_EPOCH, so that files can be compared by their bytes; a GeoPackage has a
checksum for each table as well, which tells what it is that differs. Checksums hold for one set of
libraries: another zlib or GDAL packs the same content otherwise.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from time import perf_counter
from typing import Any

#: The command's function, which was in the package itself before it was in a module of that name.
COMMAND = (
    "import sys; from wavelet_gis.cli import main as found; "
    "sys.exit(getattr(found, 'main', found)(sys.argv[1:]))"
)
WHERE = "import wavelet_gis; print(wavelet_gis.__path__[0])"
LIMIT_SECONDS = 3600

#: Cells of a raster or points of a cloud: above, an input is read with --large only.
LARGE = 1_500_000
ANY, SMALL = sys.maxsize, 300_000
FILTERED = (
    "rmnp_u16_4326.tif",
    "codem_dsm_holes.tif",
    "Topography.laz",
    "reunion_volcanic_60k.laz",
)
SIMPLIFIED = (
    "TM1_564_146_1m_nan.tif",
    "codem_dsm_holes.tif",
    "jacksboro_tn_4326.tif",
    "lidar_dem_400.tif",
    "rmnp_u16_4326.tif",
    "tasmania_33m_f64.tif",
    "Megaplot.laz",
    "Topography.laz",
    "ahn3_delft_640k.laz",
    "autzen_trim.las",
    "ign_semis_2023_0292_6833_289k.laz",
    "ign_tiles_77050_627755.laz",
    "mountain_utm42_38k.las",
    "reunion_volcanic_60k.laz",
)


@dataclass(frozen=True)
class Source:
    """A DEM or a cloud, with its number of cells or points."""

    path: Path
    size: int

    @property
    def folder(self) -> str:
        """The kind of input, dems or clouds."""
        return self.path.parent.name

    @property
    def name(self) -> str:
        """The file and its folder."""
        return f"{self.folder}/{self.path.name}"


@dataclass(frozen=True)
class Case:
    """One command on one input.

    Attributes
    ----------
    name : str
        Of the case, and in the words of later ones of the file that it wrote.
    suffix : str
        Of the output; "same" for the input's.
    words : str
        The command: {input}, {output}, {middle} level of "analyse", or the name of a case before.
    inputs : int or tuple of str
        On all inputs of at most so many cells or points, or on those named.
    folder : str
        On inputs of this folder only.
    """

    name: str
    suffix: str
    words: str
    inputs: int | tuple[str, ...]
    folder: str = "*"

    def is_for(self, source: Source) -> bool:
        """Return whether the case is run on this input."""
        if not fnmatch(source.folder, self.folder):
            return False
        if isinstance(self.inputs, int):
            return source.size <= self.inputs
        return source.path.name in self.inputs


SIX = "--levels 6 --layers none"

#: What is run on what, in this order for each input. What is dear is run on few.
CASES = (
    Case("analyse", ".gpkg", "analyse {input} {output}", ANY),
    Case("reconstruct", "same", "reconstruct {analyse} {output}", ANY),
    Case("extract.gpkg", ".gpkg", "extract {analyse} {output} --level {middle}", ANY),
    Case("extract.ply", ".ply", "extract {analyse} {output} --level {middle}", ANY),
    Case("extract.tif", ".tif", "extract {analyse} {output} --level {middle}", ANY, "dems"),
    Case("extract.2dm", ".2dm", "extract {analyse} {output} --level {middle}", SMALL),
    Case("extract.obj", ".obj", "extract {analyse} {output} --level {middle}", SMALL),
    Case("GLMN", ".gpkg", f"analyse {{input}} {{output}} --design GLMN {SIX}", SMALL),
    Case(
        "NNLSMO",
        ".gpkg",
        f"analyse {{input}} {{output}} --design NNLSMO {SIX}",
        ("jacksboro_tn_4326.tif", "mountain_utm42_38k.las"),
    ),
    Case(
        "UGORMP",
        ".gpkg",
        f"analyse {{input}} {{output}} --design UGORMP {SIX}",
        ("codem_dsm_holes.tif", "reunion_volcanic_60k.laz"),
    ),
    Case(
        "attributes",
        ".gpkg",
        "analyse {input} {output} --design NNLSMN --signal xyz "
        "--attributes classification,intensity,hag --levels 6",
        ("Topography.laz", "autzen_trim.las"),
    ),
    Case("simplify-vertices", ".ply", "simplify {input} {output} --vertices 5000", SIMPLIFIED),
    Case("simplify-max-error", ".gpkg", "simplify {input} {output} --max-error 2", SIMPLIFIED),
    Case(
        "random",
        ".gpkg",
        "analyse {input} {output} --levels 8 --partition random --prediction plane --layers none",
        FILTERED,
    ),
    Case("gains", "same", "filter {random} {output} --gain 7=0 --gain 6=0.5", FILTERED),
    Case("denoise", "same", "filter {random} {output} --denoise", FILTERED),
    Case("denoise-one", ".gpkg", "filter {random} {output} --denoise --pyramids 0", FILTERED),
    Case("details", ".gpkg", "details {random} {output}", FILTERED),
    Case("cluster", ".gpkg", "cluster {random} {output} --count 3", FILTERED),
    Case("learn", "same", "cluster {random} {output} --learn las", ("Topography.laz",)),
)


# -- inputs ---------------------------------------------------------------------------------------


def sources(data: Path) -> list[Source]:
    """Return the DEMs and the clouds of the data folder."""
    dems = sorted((data / "dems").glob("*.tif"))
    clouds = sorted((data / "clouds").glob("*.la[sz]"))
    if not dems and not clouds:
        raise SystemExit(f"{data}: there are no dems/*.tif and no clouds/*.la[sz]")
    return [Source(path, n_cells(path)) for path in dems] + [
        Source(path, n_points(path)) for path in clouds
    ]


def n_cells(path: Path) -> int:
    """Return the cells of a raster."""
    import rasterio

    with rasterio.open(path) as dataset:
        return dataset.width * dataset.height


def n_points(path: Path) -> int:
    """Return the points of a cloud."""
    import laspy

    with laspy.open(path) as reader:
        return reader.header.point_count


# -- running --------------------------------------------------------------------------------------


def environment(threads: int) -> dict[str, str]:
    """Return the environment of the commands: a fixed time and number of threads."""
    variables = (
        "NUMBA_NUM_THREADS",
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "TERRAIN_WAVELETS_THREADS",
    )
    return {**os.environ, "SOURCE_DATE_EPOCH": "0", **dict.fromkeys(variables, str(threads))}


def run_all(chosen: list[Source], variables: dict[str, str]) -> dict[str, Any]:
    """Return the result of each case on each input."""
    results = {}
    for source in chosen:
        with tempfile.TemporaryDirectory() as folder:
            for case, result in run_cases(source, Path(folder), variables):
                results[f"{source.name} {case.name}"] = result
    return results


def run_cases(
    source: Source, folder: Path, variables: dict[str, str]
) -> Iterator[tuple[Case, dict[str, Any]]]:
    """Yield the cases of an input, each with its result."""
    names: dict[str, Any] = {"input": source.path, "middle": 0}
    for case in CASES:
        if not case.is_for(source):
            continue
        suffix = source.path.suffix if case.suffix == "same" else case.suffix
        output = folder / case.name / f"output{suffix}"
        output.parent.mkdir()
        words = [word.format_map({**names, "output": output}) for word in case.words.split()]
        began = perf_counter()
        result = run(words, output, variables)
        result["messages"] = [
            line.replace(str(source.path), source.name).replace(f"{folder}{os.sep}", "")
            for line in result["messages"]
        ]
        seconds = perf_counter() - began
        print(f"{seconds:6.1f} s  {result['exit']}  {source.name} {case.name}", file=sys.stderr)
        yield case, result
        names[case.name] = output
        if case.name == "analyse":
            names["middle"] = result["figures"].get("n_levels", 0) // 2
        if not case.words.startswith("analyse"):
            shutil.rmtree(output.parent)  # nobody reads it again, and large ones need the space


def run(words: list[str], output: Path, variables: dict[str, str]) -> dict[str, Any]:
    """Run a command and return what came out."""
    command = [sys.executable, "-c", COMMAND, *words, "--json"]
    try:
        done = subprocess.run(
            command,
            env=variables,
            capture_output=True,
            text=True,
            timeout=LIMIT_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        why = f"no answer in {LIMIT_SECONDS} s"
        return {"exit": None, "sha256": None, "figures": {}, "messages": [why]}
    lines = done.stderr.splitlines()
    result: dict[str, Any] = {
        "exit": done.returncode,
        "sha256": sha256(output) if output.exists() else None,
        "figures": figures_of(done.stdout),
        "messages": lines[-1:] if done.returncode else lines,
    }
    if output.suffix == ".gpkg" and output.exists():
        result["tables"] = table_checksums(output)
    beside = {file.name: sha256(file) for file in output.parent.iterdir() if file != output}
    return result | ({"beside": beside} if beside else {})


def figures_of(text: str) -> dict[str, float]:
    """Return the numbers in the JSON that a command printed."""
    try:
        return dict(numbers(json.loads(text)))
    except (ValueError, AttributeError):
        return {}


def numbers(figures: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, float]]:
    """Yield names and numbers; of a list the last one, such as the coarsest level."""
    for name, value in figures.items():
        if name in ("seconds", "parameters"):
            continue
        if isinstance(value, list) and value:
            name, value = f"{name}[-1]", value[-1]
        if isinstance(value, dict):
            yield from numbers(value, f"{prefix}{name}.")
        elif isinstance(value, int | float):
            yield f"{prefix}{name}", value


# -- checksums ------------------------------------------------------------------------------------


def sha256(path: Path) -> str:
    """Return the checksum of a file's bytes."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def table_checksums(path: Path) -> dict[str, str]:
    """Return a checksum for each table of a GeoPackage, and one for its schema.

    Indices (R-trees) follow from the tables and are left out, as are times of writing.
    """
    with closing(sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True)) as connection:
        schema = connection.execute(
            "SELECT type, name, tbl_name, sql FROM sqlite_master ORDER BY type, name"
        ).fetchall()
        tables = [name for kind, name, _, _ in schema if kind == "table"]
        checksums = {
            name: rows_checksum(table_rows(connection, name))
            for name in tables
            if not name.startswith("rtree_")
        }
        return {"(schema)": rows_checksum(iter(schema)), **checksums}


def table_rows(connection: sqlite3.Connection, table: str) -> Iterator[tuple]:
    """Return the rows of a table as they are stored, without the columns of times."""
    described = connection.execute(f'PRAGMA table_info("{table}")')
    columns = ", ".join(f'"{name}"' for _, name, kind, *_ in described if kind != "DATETIME")
    return connection.execute(f'SELECT {columns} FROM "{table}" ORDER BY rowid')


def rows_checksum(rows: Iterator[tuple]) -> str:
    """Return the checksum of rows."""
    digest = hashlib.sha256()
    for row in rows:
        digest.update(repr(row).encode())
    return digest.hexdigest()


# -- comparing ------------------------------------------------------------------------------------


def compare(old: dict[str, Any], new: dict[str, Any]) -> bool:
    """Print for each case whether it is equal; return whether all are."""
    counts: Counter[str] = Counter()
    for name in sorted(old.keys() | new.keys()):
        if name not in old:
            verdict = "new"
        elif name not in new:
            verdict = "missing"
        else:
            verdict = "differs" if old[name] != new[name] else "equal"
        counts[verdict] += 1
        what = f": {', '.join(differences(old[name], new[name]))}" if verdict == "differs" else ""
        print(f"{verdict:8s}{name}{what}")
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    return set(counts) <= {"equal"}


def differences(old: dict[str, Any], new: dict[str, Any]) -> Iterator[str]:
    """Yield what differs between two results, with the names of tables and figures."""
    for part in sorted(old.keys() | new.keys()):
        before, after = old.get(part), new.get(part)
        if before == after:
            continue
        if part == "exit":
            yield f"exit {before} -> {after}"
        elif isinstance(before or after, dict):
            before, after = before or {}, after or {}
            names = sorted(before.keys() | after.keys())
            unequal = (name for name in names if before.get(name) != after.get(name))
            yield f"{part} ({' '.join(unequal)})"
        else:
            yield part


def without_inputs(results: dict[str, Any], left_out: list[Source]) -> dict[str, Any]:
    """Return the results of all but some inputs."""
    names = {source.name for source in left_out}
    return {case: result for case, result in results.items() if case.rsplit(" ", 1)[0] not in names}


# -- the command ----------------------------------------------------------------------------------


def new_results(arguments: argparse.Namespace, left_out: list[Source]) -> dict[str, Any]:
    """Run the cases of the inputs that are asked for; add the other inputs to ``left_out``."""
    variables = environment(arguments.threads)
    chosen = []
    for source in sources(arguments.data.resolve()):
        is_due = fnmatch(source.path.name, arguments.only) and (
            arguments.large or source.size <= LARGE
        )
        (chosen if is_due else left_out).append(source)
    where = subprocess.run(
        [sys.executable, "-c", WHERE], env=variables, capture_output=True, text=True, check=True
    )
    print(f"{len(chosen)} inputs, by {where.stdout.strip()}", file=sys.stderr)
    began = perf_counter()
    results = run_all(chosen, variables)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"{len(results)} cases, {perf_counter() - began:.0f} s, "
        f"{used.ru_utime + used.ru_stime:.0f} s of processor time",
        file=sys.stderr,
    )
    return results


def main() -> int:
    """Run the cases or read their results, write and compare them; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    beside = Path(__file__).resolve().parents[2]
    parser.add_argument("data", nargs="?", type=Path, default=beside / "shared" / "data")
    parser.add_argument("--large", action="store_true", help=f"inputs above {LARGE:,} as well")
    parser.add_argument("--only", default="*", metavar="GLOB", help="inputs of these names")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="of each command")
    parser.add_argument("--output", type=Path, metavar="NEW.json", help="write the results")
    parser.add_argument("--compare", type=Path, metavar="OLD.json", help="exits 1 unless all equal")
    parser.add_argument("--results", type=Path, help="take these results instead of a run")
    arguments = parser.parse_args()
    if arguments.output is None and arguments.compare is None:
        parser.error("give --output, --compare or both")
    left_out: list[Source] = []
    if arguments.results is not None:
        results = json.loads(arguments.results.read_text(encoding="utf-8"))
    else:
        results = new_results(arguments, left_out)
    if arguments.output is not None:
        text = json.dumps(results, indent=1, sort_keys=True)
        arguments.output.write_text(text + "\n", encoding="utf-8")
    if arguments.compare is None:
        return 0
    old = json.loads(arguments.compare.read_text(encoding="utf-8"))
    return 0 if compare(without_inputs(old, left_out), results) else 1


if __name__ == "__main__":
    sys.exit(main())
