"""The zip that users install: what is in it, and that it runs from a bare profile."""

import io
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from qgis_fixtures import COMMAND
from qgis_layers import assert_same_raster, hills, survey, write_las, write_raster

ROOT = Path(__file__).resolve().parents[3]
#: Packages that a QGIS as it comes does not have.
HIDDEN = (
    "numba",
    "pythoncdt",
    "laspy",
    "lazrs",
    "sklearn",
    "trimesh",
    "ezdxf",
    "serafin",
    "shapely",
)
TOP = "terrain_wavelets/"
#: Suffixes of what the plugin repository takes as source.
ALLOWED = {".html", ".py", ".svg", ".model3", ".ts", ".qm", ".md", ".txt", ".typed", ""}


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """Return the bytes of the zip of the last commit, made as ``make plugin`` makes it."""
    pytest.importorskip("laspy")
    path = tmp_path_factory.mktemp("dist") / "plugin.zip"
    command = [sys.executable, ROOT / "scripts" / "plugin_zip.py", "--output", path]
    done = subprocess.run(command, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return path.read_bytes()


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
    assert not [name for name in inside if name.startswith("vendored/laspy/cli")]
    licences = [name for name in inside if name.endswith("licenses/LICENSE.txt")]
    assert len(licences) == 1, "a copy goes with its licence"


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


def test_a_las_file_opens_in_a_qgis_without_laspy(archive, qgis_environment, tmp_path):
    plugins = tmp_path / "profile" / "python" / "plugins"
    zipfile.ZipFile(io.BytesIO(archive)).extractall(plugins)
    site = tmp_path / "site"
    site.mkdir()
    # Installed packages are not found; those of the plugin are, by its own finder.
    (site / "sitecustomize.py").write_text(
        "import sys\n"
        "from importlib.machinery import PathFinder\n"
        "plain = PathFinder.find_spec\n"
        "def find_spec(name, path=None, target=None):\n"
        f"    hidden = name in {HIDDEN!r} and 'vendored' not in str(path)\n"
        "    return None if hidden else plain(name, path, target)\n"
        "PathFinder.find_spec = find_spec\n"
    )
    environment = {
        **qgis_environment,
        "QGIS_CUSTOM_CONFIG_PATH": str(tmp_path / "profile"),
        "QGIS_PLUGINPATH": str(plugins),
        "PYTHONPATH": str(site),
    }
    path = write_las(tmp_path / "points.las", survey(400))
    pyramid, back = str(tmp_path / "p.gpkg"), tmp_path / "back.las"
    texts = []
    for arguments in (
        ["plugins", "enable", "terrain_wavelets"],
        ["run", "terrainwavelets:analysepointcloud", f"--INPUT={path}", f"--OUTPUT={pyramid}"],
        ["run", "terrainwavelets:reconstruct", f"--INPUT={pyramid}", f"--POINT_CLOUD={back}"],
        ["run", "terrainwavelets:reconstruct", f"--INPUT={pyramid}", f"--POINT_CLOUD={back}.laz"],
    ):
        done = subprocess.run(
            [COMMAND, *arguments], env=environment, capture_output=True, text=True, timeout=600
        )
        texts.append(done.stdout + done.stderr)
    assert back.read_bytes() == Path(path).read_bytes()
    assert "missing Python package: lazrs" in texts[-1]
    assert not Path(f"{back}.laz").exists()


def test_the_translation_in_the_zip_is_that_of_its_source(archive, qgis, tmp_path):
    from qgis.PyQt.QtCore import QCoreApplication, QTranslator

    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        path = tmp_path / "de.qm"
        path.write_bytes(files.read(f"{TOP}plugin/i18n/terrain_wavelets_de.qm"))
        source = ElementTree.fromstring(files.read(f"{TOP}plugin/i18n/terrain_wavelets_de.ts"))
    translator = QTranslator()
    assert translator.load(str(path))
    wanted = {
        message.findtext("source"): message.findtext("translation")
        for message in source.iter("message")
        if message.findtext("translation")
    }
    QCoreApplication.installTranslator(translator)
    try:
        found = {text: QCoreApplication.translate("TerrainWavelets", text) for text in wanted}
        unknown = QCoreApplication.translate("TerrainWavelets", "no such text")
    finally:
        QCoreApplication.removeTranslator(translator)
    assert found == wanted
    assert found["Simplify DEM to TIN"] == "DGM zum TIN vereinfachen"
    assert len(wanted) > 300
    assert unknown == "no such text"


def test_the_help_of_every_algorithm_is_a_page_of_the_zip_whose_links_lead_somewhere(
    archive, provider
):
    from xml.dom import minidom

    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        pages = {
            name.removeprefix(f"{TOP}help/"): files.read(name).decode("utf-8")
            for name in files.namelist()
            if name.startswith(f"{TOP}help/")
        }
    ours = [a for a in provider.algorithms() if hasattr(a, "PAGE")]
    assert len(ours) >= 12
    assert {f"{algorithm.PAGE}.html" for algorithm in ours} <= set(pages)
    for name, text in pages.items():
        body = text.partition("<body>")[2].partition("</body>")[0]
        document = minidom.parseString(f"<body>{body}</body>".encode())
        assert document.getElementsByTagName("h1"), name
        for link in document.getElementsByTagName("a"):
            target = link.getAttribute("href").partition("#")[0]
            assert not target or target.startswith("http") or target in pages, (name, target)
    assert "<table>" in pages["qgis.html"]
    assert "<pre>" in pages["qgis.html"]
