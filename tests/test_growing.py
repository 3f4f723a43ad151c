"""A filter, a format and a partition are one function and one row: CONTRIBUTING.md, carried out."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
STEP = re.compile(r"<!-- add: (\S+), before: (.+?) -->\n```python\n(.*?)```\n", re.DOTALL)


@pytest.fixture(scope="module")
def grown(tmp_path_factory):
    """Return a copy of the repository to which all examples have been added."""
    copy = tmp_path_factory.mktemp("grown") / "house"
    for name in ("wavelet_core", "wavelet_gis", "plugin", "tests", "scripts", "docs"):
        ignored = shutil.ignore_patterns("__pycache__", "*.png")
        shutil.copytree(ROOT / name, copy / name, ignore=ignored)
    for name in ("pyproject.toml", "metadata.txt", "__init__.py"):
        shutil.copy(ROOT / name, copy / name)
    steps = STEP.findall((ROOT / "CONTRIBUTING.md").read_text("utf-8"))
    assert len(steps) == 6  # a function and a row, three times
    for name, place, text in steps:
        path = copy / name
        old = path.read_text("utf-8")
        assert old.count(place) == 1, f"{name} holds {place!r} {old.count(place)} times"
        start = old.index(place)
        if not text[0].isspace():
            path.write_text(old[:start] + text + old[start:], encoding="utf-8")
        else:  # a row: as a line of its own
            start = old.rindex("\n", 0, start) + 1
            path.write_text(old[:start] + text + old[start:], encoding="utf-8")
    return copy


def run(copy, *arguments):
    """Run Python in the copy; return what it said."""
    environment = {**os.environ, "PYTHONPATH": str(copy), "COLUMNS": "200"}
    said = subprocess.run(
        [sys.executable, *arguments], cwd=copy, env=environment, capture_output=True, text=True
    )
    assert said.returncode == 0, said.stdout + said.stderr
    return said.stdout


def test_they_are_in_the_tables_of_the_docs(grown):
    assert set(run(grown, "scripts/tables.py").split()) == {
        "docs/reference/formats.md",
        "docs/science/notation.md",
    }
    notation = (grown / "docs/science/notation.md").read_text("utf-8")
    assert "| `inverse_square` | `ISQ` | one over the squared distance in plan |" in notation
    assert "| `lowest_first` | the lowest first |" in notation
    assert "| OFF | `.off` |" in (grown / "docs/reference/formats.md").read_text("utf-8")


def test_they_are_in_the_help_of_the_commands(grown):
    help_of_analyse = " ".join(run(grown, "-m", "wavelet_gis.cli", "analyse", "--help").split())
    assert "inverse_square" in help_of_analyse
    assert "lowest_first" in help_of_analyse
    assert ".off" in run(grown, "-m", "wavelet_gis.cli", "extract", "--help")


def test_the_command_takes_them(grown, tmp_path):
    terrain = tmp_path / "points.xyz"
    lines = [f"{x} {y} {(7 * x + 3 * y) % 11}" for x in range(12) for y in range(10)]
    terrain.write_text("\n".join(lines) + "\n")
    pyramid, mesh = tmp_path / "pyramid.gpkg", tmp_path / "coarse.off"
    design = ["--prediction", "isq", "--partition", "lowest_first", "--levels", "3"]
    run(grown, "-W", "ignore", "-m", "wavelet_gis.cli", "analyse", terrain, pyramid, *design)
    run(grown, "-m", "wavelet_gis.cli", "extract", pyramid, mesh, "--level", "0")
    assert mesh.read_text().startswith("OFF\n")


def test_the_tests_that_read_the_tables_run_them(grown):
    chosen = "(inverse_square or lowest_first) and not data"
    files = ("lifting/test_reconstruction.py", "lifting/test_second_opinion.py")
    paths = [f"tests/core/{name}" for name in files]
    options = ("-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", chosen)
    said = run(grown, "-m", "pytest", *options, *paths)
    assert int(re.search(r"(\d+) passed", said)[1]) >= 8


def test_the_plugin_holds_no_list_of_its_own(grown):
    """The dialogs read the tables when they are drawn; a copy would not know the new rows."""
    for path in (grown / "plugin").rglob("*.py"):
        text = path.read_text("utf-8")
        assert '"cotangent"' not in text, path
        assert '".glb"' not in text, path
