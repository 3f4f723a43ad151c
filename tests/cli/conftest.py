"""How the tests run the command: in this process for speed, in one of its own where it matters."""

import json
import subprocess
import sys
from dataclasses import dataclass

import pytest
from gis.samples import hills, write_las, write_tif

from wavelet_gis.cli.main import main


@dataclass(frozen=True)
class Outcome:
    """What a command said and returned."""

    code: int
    out: str
    err: str

    @property
    def figures(self):
        return json.loads(self.out)


@pytest.fixture
def command(capsys):
    """Return a function that runs the command and returns its outcome."""

    def run(*arguments):
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Outcome(code, captured.out, captured.err)

    return run


@pytest.fixture
def done(command):
    """Return a function that runs the command, asserts success and returns the outcome."""

    def run(*arguments):
        outcome = command(*arguments)
        assert outcome.code == 0, outcome.err
        return outcome

    return run


@pytest.fixture
def refused(command, tmp_path):
    """Return a function that asserts a refusal: exit 1, one line, nothing left behind."""

    def run(*arguments):
        before = sorted(tmp_path.rglob("*"))
        outcome = command(*arguments)
        assert outcome.code == 1, outcome
        assert outcome.out == ""
        assert outcome.err.startswith("terrain-wavelets: error: ")
        assert outcome.err.count("\n") == 1, outcome.err
        assert "Traceback" not in outcome.err
        assert ".terrain-wavelets-" not in outcome.err
        assert sorted(tmp_path.rglob("*")) == before
        return outcome.err

    return run


@pytest.fixture
def process():
    """Return a function that runs the command in a process of its own."""

    def run(*arguments, **options):
        return subprocess.run(
            [sys.executable, "-m", "wavelet_gis.cli", *map(str, arguments)],
            capture_output=True,
            text=True,
            **options,
        )

    return run


@pytest.fixture(scope="session")
def tif(tmp_path_factory):
    """Return a float32 DEM in UTM."""
    return write_tif(tmp_path_factory.mktemp("tif") / "hills.tif", hills().astype("f4"))


@pytest.fixture(scope="session")
def las(tmp_path_factory):
    """Return a cloud of ground and trees in UTM."""
    return write_las(tmp_path_factory.mktemp("las") / "trees.laz")


@pytest.fixture(scope="session")
def pyramid(tif, tmp_path_factory):
    """Return the DEM's pyramid file with all layers; do not change it."""
    path = tmp_path_factory.mktemp("pyramid") / "hills.gpkg"
    assert main(["analyse", str(tif), str(path), "--levels", "4", "--quiet"]) == 0
    return path


@pytest.fixture(scope="session")
def cloud_pyramid(las, tmp_path_factory):
    """Return the cloud's pyramid file; do not change it."""
    path = tmp_path_factory.mktemp("pyramid") / "trees.gpkg"
    options = ["--levels", "3", "--attributes", "classification,hag", "--quiet"]
    assert main(["analyse", str(las), str(path), *options]) == 0
    return path
