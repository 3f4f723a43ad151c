"""Run the tests against the installed wheel, by Python and age of packages.

    python3 scripts/matrix.py [PYTHON ...] [--packages oldest newest] [-- PYTEST_ARG ...]

Without PYTHON: each python3.11 and later on PATH. The wheel is built once, from the tracked files
as they are. Each run has a virtual environment of its own, with the extra ``test`` and the oldest
packages that pyproject.toml allows, or the newest, of those that have a wheel for that Python; uv
resolves them. The tests run in a copy of the repository that lacks the two packages, so that only
the installed ones can be imported. At the end one table tells of all runs; the exit code is 1
where one of them failed.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parent.parent
INSTALLED = ("wavelet_core", "wavelet_gis")
RESOLUTIONS = {"oldest": "lowest-direct", "newest": "highest"}
SHOWN = ["numpy", "scipy", "numba", "PythonCDT", "rasterio", "shapely", "pyproj", "laspy"]
#: Old packages use what newer ones, of which they need any, deprecate.
WARNINGS = {"oldest": ["-W", "ignore::DeprecationWarning"], "newest": []}
#: Tests of the sources rather than of what is installed.
OF_SOURCES = ["tests/test_imports.py", "tests/test_growing.py"]
#: As ``make test-compiled``: what needs QGIS has commands of its own.
TESTS = [
    "--ignore=tests/plugin/algorithms",
    "--ignore=tests/plugin/dialogs",
    "--ignore=tests/models",
    "--ignore-glob=*/test_qgis_*",
    "--numprocesses=auto",
    "--dist=worksteal",
    "-m",
    "not exhaustive",
]
#: What an environment answers: where the packages lie, and the versions of the others.
ASK = """
import importlib.metadata, json, platform, sys, wavelet_core, wavelet_gis
print(json.dumps({
    "places": [wavelet_core.__file__, wavelet_gis.__file__],
    "python": platform.python_version(),
    "versions": [importlib.metadata.version(name) for name in sys.argv[1:]],
}))
"""


class Row(NamedTuple):
    """A run, as the table tells of it."""

    python: str
    packages: str
    versions: list[str]
    outcome: str
    passed: bool


class CommandError(RuntimeError):
    """A program that failed, and what it said."""


def main() -> None:
    """Build, run each combination, print the table."""
    end = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pythons", nargs="*", metavar="PYTHON", help="default: those on PATH")
    parser.add_argument("--packages", nargs="+", choices=RESOLUTIONS, default=list(RESOLUTIONS))
    arguments = parser.parse_args(sys.argv[1:end])
    pythons = arguments.pythons or pythons_on_path()
    if not pythons:
        raise SystemExit("matrix: no python3.11 or later on PATH; name one")
    # Nothing that this process was given may be imported instead of what is installed.
    for name in ("PYTHONPATH", "VIRTUAL_ENV"):
        os.environ.pop(name, None)
    with tempfile.TemporaryDirectory(prefix="terrain-wavelets-matrix-") as name:
        folder = Path(name).resolve()
        uv = find_uv(folder)
        copy, wheel = copy_and_wheel(uv, folder)
        rows = [
            run(uv, python, packages, copy, wheel, sys.argv[end + 1 :] or TESTS)
            for python in pythons
            for packages in arguments.packages
        ]
    print(table(rows))
    if not all(row.passed for row in rows):
        raise SystemExit(1)


def call(command: list[str | Path], cwd: Path = ROOT) -> str:
    """Return what a program printed."""
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode:
        raise CommandError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def pythons_on_path() -> list[str]:
    """Return those that are new enough and start; of pyenv's names not all do."""
    names = [f"python3.{minor}" for minor in range(11, 30)]
    starts = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "check": False}
    return [
        name
        for name in names
        if shutil.which(name) and subprocess.run([name, "--version"], **starts).returncode == 0
    ]


def find_uv(folder: Path) -> str | Path:
    """Return the uv on PATH, or one in an environment of its own."""
    found = shutil.which("uv")
    if found:
        return found
    call(["bash", ROOT / "scripts" / "setup-venv.sh", folder / "tools", sys.executable])
    call([folder / "tools" / "bin" / "python", "-m", "pip", "install", "--quiet", "uv"])
    return folder / "tools" / "bin" / "uv"


def copy_and_wheel(uv: str | Path, folder: Path) -> tuple[Path, Path]:
    """Return a copy of the tracked files without the packages, and the wheel built of it."""
    copy = folder / "checkout"
    git = ["git", "-c", f"safe.directory={ROOT}", "ls-files", "-z"]
    for name in filter(None, call(git).split("\0")):
        if (ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, copy / name)
    call([uv, "build", "--quiet", "--wheel", "--out-dir", folder / "dist", copy])
    for name in [*INSTALLED, "build", "terrain_wavelets.egg-info"]:
        shutil.rmtree(copy / name)
    (wheel,) = (folder / "dist").glob("*.whl")
    return copy, wheel


def run(
    uv: str | Path, python: str, packages: str, copy: Path, wheel: Path, tests: list[str]
) -> Row:
    """Return the row of one Python and one set of packages; show the tests as they run."""
    environment = copy.parent / "environment"
    print(f"matrix: {python}, {packages} packages", flush=True)
    into = ["pip", "install", "--quiet", "--python", environment]
    try:
        call([uv, "venv", "--quiet", "--clear", "--python", python, environment])
        # The requirements of the file are direct ones, those of the wheel would not be.
        resolve = ["--no-build", "--resolution", RESOLUTIONS[packages], "--extra", "test"]
        call([uv, *into, *resolve, "--requirements", "pyproject.toml"], copy)
        call([uv, *into, "--no-deps", wheel])
        call([uv, "pip", "check", "--python", environment])
        told = json.loads(call([environment / "bin" / "python", "-c", ASK, *SHOWN], copy))
    except CommandError as failure:
        print(failure, file=sys.stderr)
        return Row(python, packages, ["" for _ in SHOWN], "not installed", passed=False)
    for place in told["places"]:
        if not Path(place).is_relative_to(environment):
            raise SystemExit(f"matrix: {place} was imported, not the wheel")
    report = copy.parent / "report.xml"
    report.unlink(missing_ok=True)
    out = [f"--ignore={name}" for name in OF_SOURCES]
    command = [environment / "bin" / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    command += [f"--junit-xml={report}", *WARNINGS[packages], *out, *tests]
    code = subprocess.run(command, cwd=copy).returncode
    return Row(told["python"], packages, told["versions"], outcome(report, code), code == 0)


def outcome(report: Path, code: int) -> str:
    """Return the counts of pytest's report; codes above 1 say that it was not completed."""
    if code > 1:
        return f"pytest ended with {code}"
    suite = ElementTree.parse(report).getroot().find("testsuite").attrib
    bad, skipped = int(suite["failures"]) + int(suite["errors"]), int(suite["skipped"])
    return f"{int(suite['tests']) - bad - skipped} passed, {bad} failed, {skipped} skipped"


def table(rows: list[Row]) -> str:
    """Return the rows in Markdown."""
    lines = [["Python", "packages", *SHOWN, "tests"], ["---"] * (len(SHOWN) + 3)]
    lines += [[row.python, row.packages, *row.versions, row.outcome] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


if __name__ == "__main__":
    try:
        main()
    except CommandError as failure:
        raise SystemExit(f"matrix: failed: {failure}") from None
