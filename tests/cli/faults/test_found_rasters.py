"""Situations of rasters, meshes and files that once gave a wrong result, through the command."""

import re
import shutil
import sqlite3
import subprocess
import sys

import pytest
import rasterio
from gis.samples import hills, write_tif

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")


@pytest.mark.data
def test_isolated_cells_are_written_and_counted(found, done):
    found("isolated-cells-lost")
    done("simplify", "iso.tif", "out.tif", "--max-error", 0.1)
    with rasterio.open("out.tif") as dataset:
        assert (dataset.read_masks(1) != 0).sum() == 441


@pytest.mark.data
def test_zero_metres_are_no_nodata(found, done):
    found("scale-offset-nodata0")
    done("simplify", "so0.tif", "out.tif", "--max-error", 0.5)
    with rasterio.open("out.tif") as dataset:
        assert (dataset.read_masks(1) != 0).sum() == 3575


@pytest.mark.data
def test_a_sub_dataset_by_its_name(found, command, done):
    found("subdataset-name")
    assert "dem2" in command("simplify", "sub.gpkg", "x.2dm", "--vertices", 100).err
    done("simplify", "GPKG:sub.gpkg:dem2", "x.2dm", "--vertices", 100)


@pytest.mark.data
def test_the_prj_of_a_shapefile_stays(found, done):
    folder = found("prj-clobbered")
    before = (folder / "dem.prj").read_bytes()
    for options in ([], ["--overwrite"]):
        said = done("simplify", "dem.tif", "dem.2dm", "--vertices", 100, *options)
        assert "dem.prj belongs to another file" in said.err
        assert "EPSG:32633" in said.err
        assert (folder / "dem.prj").read_bytes() == before


@pytest.mark.data
def test_bangs_in_paths(found, done):
    folder = found("bang-in-path")
    done("simplify", "x!y.tif", "x!y.gpkg", "--vertices", 100)
    done("analyse", "x!y.tif", "x;y.gpkg", "--levels", 1)
    done("simplify", "!old work/dem.tif", "!old work/t.gpkg", "--vertices", 100)
    assert not (folder / "y.gpkg").exists()
    for name in ("x!y.gpkg", "!old work/t.gpkg"):
        connection = sqlite3.connect(folder / name)
        assert connection.execute("SELECT COUNT(*) FROM level_00_tin").fetchone()[0] > 100
        connection.close()


@pytest.mark.data
def test_a_stale_wal_does_not_reach_the_new_pyramid(found, done):
    folder = found("stale-wal")
    done("analyse", "a.tif", "p.gpkg", "--levels", 2)
    code = (
        "import sqlite3, os; c = sqlite3.connect('p.gpkg'); c.execute('pragma journal_mode=wal'); "
        "c.execute(\"update layer_styles set description='mine'\"); c.commit(); os._exit(9)"
    )
    subprocess.run([sys.executable, "-c", code], check=False)
    assert (folder / "p.gpkg-wal").exists()
    done("analyse", "b.tif", "p.gpkg", "--levels", 2, "--overwrite")
    assert not list(folder.glob("p.gpkg-*"))
    assert "b.tif" in done("info", "p.gpkg").out


@pytest.mark.data
def test_kilometres(found, process):
    found("km-units")
    said = process("analyse", "kmr.tif", "k.gpkg", "--levels", 1)
    assert said.stderr.count("\n") == 1, said.stderr
    assert "metres are assumed" in said.stderr
    connection = sqlite3.connect("k.gpkg")
    slopes = sorted(s for (s,) in connection.execute("SELECT slope FROM coarse_tin"))
    connection.close()
    assert slopes[len(slopes) // 2] < 60


@pytest.mark.data
def test_landxml_of_mixed_and_survey_feet(found, done):
    folder = found("landxml-units")
    for name, unit in (("mft", "meter"), ("esri", "USSurveyFoot")):
        done("simplify", f"{name}.las", f"{name}.xml", "--vertices", 200)
        text = (folder / f"{name}.xml").read_text("utf-8")
        assert re.search(r'linearUnit="(\w+)"', text)[1] == unit


@pytest.mark.data
def test_what_reconstruct_would_refuse_is_refused_at_once(found, command):
    folder = found("accepted-then-refused")
    outcome = command("analyse", "scale0.tif", "p.gpkg")
    assert outcome.code == 1
    assert "scale 0" in outcome.err
    assert not (folder / "p.gpkg").exists()


def test_two_by_two_cells_work_or_say_why_not(done, refused, tmp_path):
    source = write_tif(tmp_path / "two.tif", hills(2, 2))
    pyramid = tmp_path / "two.gpkg"
    done("analyse", source, pyramid)
    done("extract", pyramid, tmp_path / "a.ply")
    done("reconstruct", pyramid, tmp_path / "a.tif")
    done("report", pyramid, tmp_path / "a.html")
    for verb in (["details"], ["filter", "--gain", "0=0"]):
        line = refused(verb[0], pyramid, tmp_path / "b.tif", *verb[1:])
        assert "no levels" in line
        assert "disk" not in line


def test_degrees_become_metres_in_a_mesh_and_are_told(done, refused, tmp_path):
    transform = rasterio.Affine(0.0003, 0.0, 7.0, 0.0, -0.0003, 44.0)
    source = write_tif(tmp_path / "a.tif", hills(), crs="EPSG:4326", transform=transform)
    said = done("simplify", source, tmp_path / "a.2dm", "--vertices", 100)
    assert "UTM zone 32N" in said.out
    assert "UTM zone 32N" in (tmp_path / "a.prj").read_text("utf-8")
    said = done("simplify", source, tmp_path / "b.ply", "--vertices", 100, "--to-crs", "EPSG:2154")
    assert "Lambert-93" in said.out
    line = refused(
        "simplify", source, tmp_path / "c.tif", "--vertices", 100, "--to-crs", "EPSG:2154"
    )
    assert "--to-crs is for mesh files" in line


def test_closed_streams_and_a_plain_locale(tif, tmp_path):
    start = f'"{sys.executable}" -m wavelet_gis.cli'
    folder = tmp_path / "né\nx"
    folder.mkdir()
    shutil.copy(tif, folder / "é.tif")
    plain = "LC_ALL=C PYTHONCOERCECLOCALE=0 PYTHONUTF8=0"
    for line in (
        f"{start} analyse é.tif closed.gpkg --levels 2 >&- 2>&-",
        f"{start} analyse é.tif é.gpkg --levels 2 <&-",
        f"{plain} {start} info é.gpkg",
        f"{plain} {start} report é.gpkg é.html",
        f"{plain} {start} extract é.gpkg é2.gpkg",
        f"{plain} {start} reconstruct é.gpkg é2.tif",
    ):
        said = subprocess.run(["bash", "-c", line], cwd=folder, capture_output=True, check=False)
        assert said.returncode == 0, (line, said.stderr)
        assert said.stderr == b"", (line, said.stderr)
    made = {"closed.gpkg", "é.gpkg", "é.html", "é.tif", "é2.gpkg", "é2.tif"}
    assert {path.name for path in folder.iterdir()} == made
    assert (folder / "closed.gpkg").read_bytes()[:15] == b"SQLite format 3"
