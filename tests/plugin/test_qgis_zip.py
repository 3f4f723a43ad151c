"""The zip that users install: what is in it, and that it runs from a bare profile."""

import io
import subprocess
import zipfile
from pathlib import Path

import pytest
from qgis_fixtures import COMMAND
from qgis_layers import assert_same_raster, hills, write_raster

ROOT = Path(__file__).resolve().parent.parent.parent
TOP = "terrain_wavelets/"
#: Suffixes of what the plugin repository takes as source.
ALLOWED = {".py", ".svg", ".model3", ".ts", ".qm", ".md", ".txt", ".typed", ""}


@pytest.fixture(scope="module")
def archive():
    """Return the bytes of the zip of the last commit, made as ``make plugin`` makes it."""
    command = ["git", "-c", f"safe.directory={ROOT}", "archive", "--format=zip", f"--prefix={TOP}"]
    done = subprocess.run([*command, "HEAD"], cwd=ROOT, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def test_the_zip_holds_the_plugin_and_no_more(archive):
    names = zipfile.ZipFile(io.BytesIO(archive)).namelist()
    files = [name for name in names if not name.endswith("/")]
    assert all(name.startswith(TOP) for name in files)
    inside = {name.removeprefix(TOP) for name in files}
    assert {"metadata.txt", "__init__.py", "LICENSE", "plugin/provider.py"} <= inside
    assert {"wavelet_core/__init__.py", "wavelet_gis/io/pyramid/pyramid_file.py"} <= inside
    assert any(name.startswith("processing_models/") for name in inside)
    assert {Path(name).suffix for name in inside} <= ALLOWED
    for part in ("test", "benchmark", ".ci", "__pycache__"):
        assert not [name for name in inside if part in name]
    assert len(archive) < 2 << 20


def test_the_zip_runs_from_a_bare_profile(archive, qgis_environment, tmp_path):
    plugins = tmp_path / "profile" / "python" / "plugins"
    zipfile.ZipFile(io.BytesIO(archive)).extractall(plugins)
    environment = {
        **qgis_environment,
        "QGIS_CUSTOM_CONFIG_PATH": str(tmp_path / "profile"),
        "QGIS_PLUGINPATH": str(plugins),
    }
    path = write_raster(tmp_path / "dem.tif", hills(40, 40).astype("float32"))
    pyramid, back = str(tmp_path / "p.gpkg"), str(tmp_path / "back.tif")
    for arguments in (
        ["plugins", "enable", "terrain_wavelets"],
        ["run", "terrainwavelets:analysedem", f"--INPUT={path}", f"--OUTPUT={pyramid}"],
        ["run", "terrainwavelets:reconstruct", f"--INPUT={pyramid}", f"--DEM={back}"],
    ):
        done = subprocess.run(
            [COMMAND, *arguments], env=environment, capture_output=True, text=True, timeout=600
        )
        assert done.returncode == 0, done.stdout + done.stderr
    assert_same_raster(path, back)
