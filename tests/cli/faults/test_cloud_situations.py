"""Point clouds that went wrong without a word, run as a user would, in a copy of their folder.

The inputs are those of the real data beside the repository; the same kinds, made by the tests
themselves, are in tests/gis/io/test_las_header.py and its neighbours.
"""

import shutil
import time

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import write_las

pytestmark = pytest.mark.data


@pytest.fixture
def situation(data_folder, tmp_path, monkeypatch):
    """Return a function that copies a folder of inputs and works in the copy."""

    def enter(name):
        for path in (data_folder / "found" / name).iterdir():
            shutil.copyfile(path, tmp_path / path.name)
        monkeypatch.chdir(tmp_path)
        return tmp_path

    return enter


@pytest.mark.parametrize(
    ("folder", "arguments", "words"),
    [
        (
            "header-billion-vlrs",
            ("analyse", "garbage_nVariableLength.las", "p.gpkg"),
            "announces 1069128089 VLRs",
        ),
        (
            "las-offset-1e308",
            ("simplify", "y_offset_1e308.las", "o.ply", "--vertices", "100"),
            "coordinates that a CRS has",
        ),
        ("laz-allocates-34gb", ("analyse", "laz_abort.laz", "p.gpkg"), "table of chunks"),
        ("laz-decoder-panics", ("analyse", "old_laszip_12r0.laz", "p.gpkg"), "no chunk table"),
    ],
)
def test_hostile_files_are_refused_at_once(situation, refused, folder, arguments, words):
    situation(folder)
    began = time.perf_counter()
    assert words in refused(*arguments)
    assert time.perf_counter() - began < 10


def test_a_decoder_that_panics_says_nothing_itself(situation, process):
    """A process of its own: what Rust prints goes past Python's standard error."""
    situation("laz-decoder-panics")
    outcome = process("analyse", "old_laszip_12r0.laz", "p.gpkg")
    assert outcome.returncode == 1
    assert outcome.stderr.count("\n") == 1
    assert "panicked" not in outcome.stderr


def test_a_vertical_datum_does_not_cost_the_horizontal_crs(situation, done):
    import json

    situation("geotiff-vertical-datum")
    assert done("analyse", "nm_ft.las", "p.gpkg", "--levels", "2").err == ""
    crs = json.dumps(done("info", "p.gpkg", "--json").figures)
    assert "New Mexico Central (ftUS)" in crs
    assert "NAVD88 height (ftUS)" in crs


@pytest.mark.parametrize(
    ("name", "words", "keep"),
    [
        ("withheld.las", "10 with the withheld flag", "--keep-withheld"),
        ("noise.las", "10 of the noise classes", "--keep-noise"),
    ],
)
def test_withheld_points_and_noise_make_no_pits(situation, done, name, words, keep):
    folder = situation("withheld-noise")
    outcome = done("simplify", name, "out.tif", "--vertices", "300")
    assert words in outcome.err
    assert keep in outcome.err
    with rasterio.open("out.tif") as dataset:
        assert np.nanmin(dataset.read(1)) > 0
    kept = done("simplify", name, "pit.tif", "--vertices", "300", keep)
    assert "left out" not in kept.err
    with rasterio.open("pit.tif") as dataset:
        assert np.nanmin(dataset.read(1)) < -100
    done("analyse", name, "p.gpkg", "--levels", "2")
    done("reconstruct", "p.gpkg", "back.las")
    assert (folder / "back.las").read_bytes() == (folder / name).read_bytes()


def test_merged_points_count_in_the_error(situation, done):
    situation("duplicates-max-error")
    outcome = done("simplify", "dup.las", "out.ply", "--max-error", "0.1", "--json")
    assert "200 points share x and y with others; the lowest" in outcome.err
    assert outcome.figures["max_error"] == pytest.approx(12.08, abs=0.02)


def test_what_is_analysed_is_reconstructed(situation, done):
    folder = situation("accepted-then-refused")
    assert "LAS 1.2 has no point format 6" in done("analyse", "las12_format6.las", "q.gpkg").err
    done("reconstruct", "q.gpkg", "back.las")
    assert (folder / "back.las").read_bytes() == (folder / "las12_format6.las").read_bytes()


def test_two_units_of_length_are_kept_apart(situation):
    from wavelet_gis.workflows.open import open_terrain

    situation("landxml-units")
    with pytest.warns(UserWarning, match="us survey foot and is converted"):
        mixed = open_terrain("mft.las")
    assert mixed.system.horizontal_unit == 1.0
    assert mixed.system.vertical_unit == "us_survey_foot"
    assert mixed.frame.z_scale == pytest.approx(1200 / 3937, rel=1e-12)
    esri = open_terrain("esri.las")
    assert esri.system.horizontal_unit == pytest.approx(1200 / 3937, rel=1e-12)
    assert esri.frame.z_scale == 1.0


@pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")
def test_a_fork_after_a_laz_read_is_no_trap(data_folder):
    """The decoder's pool of threads is in a child, so that a fork has none to lose."""
    import os
    import signal

    from wavelet_gis.io.las import read_cloud

    path = data_folder / "clouds" / "reunion_volcanic_60k.laz"
    n_points = read_cloud(path)[0].n_points
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        os._exit(0 if read_cloud(path)[0].n_points == n_points else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_gaps_are_left_out_of_everything(data_folder, tmp_path, done):
    """Delft: canals without a return are a twelfth of the hull."""
    path = data_folder / "clouds" / "ahn3_delft_640k.laz"
    las = laspy.read(path)
    las.points = las.points[np.arange(0, len(las.points), 40)]
    las.write(tmp_path / "a.las")
    done("simplify", tmp_path / "a.las", tmp_path / "a.tif", "--vertices", "3000")
    open_ = done(
        "simplify", tmp_path / "a.las", tmp_path / "b.tif", "--vertices", "3000",
        "--max-edge", "6",
    )  # fmt: skip
    assert "have an edge longer than 6 and are left out" in open_.err
    with rasterio.open(tmp_path / "a.tif") as a, rasterio.open(tmp_path / "b.tif") as b:
        assert a.shape == b.shape
        n_filled, n_open = (np.isfinite(d.read(1)).sum() for d in (a, b))
    assert n_open < 0.97 * n_filled


def test_an_error_above_what_was_asked_at_merged_points_is_told(tmp_path, done):
    """The stop rules look at vertices; 3 was asked for, and points were 18 off in silence."""
    source = write_las(tmp_path / "a.las", 500)
    told = "--max-error 3 holds at the vertices; with the points that share x and y"
    assert told in done("analyse", source, tmp_path / "a.gpkg", "--max-error", 3).err
    done("analyse", source, tmp_path / "b.gpkg")
    for command, given in (("simplify", source), ("extract", tmp_path / "b.gpkg")):
        outcome = done(command, given, tmp_path / f"{command}.ply", "--max-error", 3, "--json")
        assert told in outcome.err
        assert outcome.figures["max_error"] > 10


def test_a_size_between_levels_has_its_errors_at_all_points(tmp_path, done):
    source = write_las(tmp_path / "a.las", 500)
    done("analyse", source, tmp_path / "b.gpkg")
    figures = done(
        "extract", tmp_path / "b.gpkg", tmp_path / "x.ply", "--vertices", 371, "--json"
    ).figures
    assert figures["n_vertices"] == 371
    assert figures["max_error"] > 10  # at the points of one place
