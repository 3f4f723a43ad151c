"""The command that tiles rasters, and the two that read tile sets."""

import os
import signal
import subprocess
import sys
import time

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import assert_same_raster, hills, write_las, write_tif


def files_below(folder, suffix):
    """Return the files of a folder in which somebody writes: folders may go while it is walked."""
    return [name for _, _, names in os.walk(folder) for name in names if name.endswith(suffix)]


def test_from_a_raster_to_tiles_and_back(done, refused, tmp_path):
    dem = write_tif(tmp_path / "dem.tif", hills(70, 90))
    tiles, index = tmp_path / "tiles", tmp_path / "tiles" / "index.gpkg"
    arguments = ("tile", dem, tiles, "--tile", 40, "--levels", 4, "--workers", 1)
    figures = done(*arguments, "--json").figures
    assert (figures["n_tiles"], figures["n_pieces"], figures["n_stages"]) == (4, 5, 2)
    assert "0 pieces made, 5 found whole" in done(*arguments).out
    done("reconstruct", index, tmp_path / "back.tif")
    assert_same_raster(dem, tmp_path / "back.tif")
    box = "500100,5099700,500300,5099900"
    part = done("extract", index, tmp_path / "a.ply", "--level", 20, "--bbox", box, "--json")
    whole = done("extract", index, tmp_path / "b.ply", "--level", 20, "--json")
    assert part.figures["n_vertices"] < whole.figures["n_vertices"]
    done("extract", index, tmp_path / "c.tif", "--cell-size", 10)
    with rasterio.open(tmp_path / "c.tif") as dataset:
        assert np.abs(np.nanmean(dataset.read(1)) - hills(70, 90).mean()) < 3
    message = refused("extract", index, tmp_path / "d.ply", "--vertices", 9)
    assert "--vertices is for one pyramid" in message
    message = refused("tile", dem, tiles, "--tile", 30)
    assert "--overwrite to replace it" in message
    done("analyse", dem, tmp_path / "dem.gpkg", "--levels", 2)
    message = refused("extract", tmp_path / "dem.gpkg", tmp_path / "d.ply", "--bbox", box)
    assert "--bbox is for tile sets" in message
    message = refused("extract", tmp_path / "dem.gpkg", tmp_path / "d.ply", "--polygon", dem)
    assert "--polygon is for tile sets" in message


def test_from_clouds_to_tiles_and_back(done, refused, tmp_path):
    cloud = write_las(tmp_path / "cloud.las", 6000)
    tiles, index = tmp_path / "tiles", tmp_path / "tiles" / "index.gpkg"
    arguments = ("tile", cloud, tiles, "--tile", "50,100", "--levels", 4, "--workers", 1)
    figures = done(*arguments, "--json").figures
    assert (figures["n_points"], figures["n_files"], figures["n_tiles"]) == (6000, 1, 2)
    assert "6,000 points of 1 file in 2 tiles" in done(*arguments).out
    done("reconstruct", index, tmp_path / "back.las")
    assert (tmp_path / "back.las").read_bytes() == cloud.read_bytes()
    within = done("extract", index, tmp_path / "b.ply", "--max-error", "2", "--json").figures
    assert within["max_error"] > 2  # of points that share x and y with a vertex, which is said
    assert [note["code"] for note in within["notes"]] == ["error_above_what_was_asked"]
    message = refused("extract", index, tmp_path / "d.ply", "--max-error", "2*slope")
    assert "is one number" in message
    box = "500010,5100010,500030,5100030"
    part = done("extract", index, tmp_path / "a.ply", "--level", 20, "--bbox", box, "--json")
    assert part.figures["n_vertices"] > 10
    message = refused("reconstruct", index, tmp_path / "back.tif")
    assert "give an output ending in .las or .laz" in message
    message = refused("tile", cloud, tmp_path / "u", "--band", 1)
    assert "--band is for a raster" in message
    dem = write_tif(tmp_path / "dem.tif", hills(70, 90))
    message = refused("tile", dem, cloud, tmp_path / "u")
    assert "the others are rasters" in message
    message = refused("tile", dem, tmp_path / "u", "--classes", 2)
    assert "--classes is for a point cloud" in message
    message = refused("tile", dem, tmp_path / "u", "--tile", "8.5")
    assert "whole number of cells" in message


def test_several_clouds_come_back_into_a_folder(done, refused, tmp_path):
    (tmp_path / "in").mkdir()
    for name, seed in (("a.las", 1), ("b.las", 2)):
        write_las(tmp_path / "in" / name, 2000, seed=seed)
    index = tmp_path / "tiles" / "index.gpkg"
    done("tile", tmp_path / "in", tmp_path / "tiles", "--levels", 3, "--workers", 1)
    assert "4,000 points in 2 files" in done("reconstruct", index, tmp_path / "out").out
    for name in ("a.las", "b.las"):
        back = tmp_path / "out" / name
        assert back.read_bytes() == (tmp_path / "in" / name).read_bytes()
    assert "--overwrite to replace it" in refused("reconstruct", index, tmp_path / "out")
    message = refused("reconstruct", index, index)
    assert "name a folder" in message


def test_a_file_without_the_chosen_classes_is_passed_over_and_the_rest_not_called_the_original(
    done, tmp_path
):
    (tmp_path / "in").mkdir()
    for name, seed in (("a.las", 1), ("b.las", 2)):
        write_las(tmp_path / "in" / name, 2000, seed=seed)
    bare = laspy.read(tmp_path / "in" / "b.las")
    bare.classification[:] = 5
    bare.write(tmp_path / "in" / "b.las")
    index = tmp_path / "tiles" / "index.gpkg"
    options = ("--classes", 2, "--levels", 3, "--workers", 1)
    done("tile", tmp_path / "in", tmp_path / "tiles", *options)
    said = done("reconstruct", index, tmp_path / "out").out
    assert "points in 1 file, " in said
    assert "of other classes" in said
    assert "original" not in said
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["a.las"]
    figures = done("reconstruct", index, tmp_path / "out", "--overwrite", "--json").figures
    assert figures["is_exact"] is False


def heed_interrupts():
    """Undo in the child what a shell does to its background jobs, such as a run of these tests."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_an_interrupt_keeps_what_is_made(done, tmp_path):
    dem = write_tif(tmp_path / "dem.tif", hills(150, 150))
    arguments = ["tile", dem, tmp_path / "tiles", "--tile", 20, "--workers", 2]
    command = [sys.executable, "-m", "wavelet_gis.cli", *arguments]
    with subprocess.Popen(
        list(map(str, command)),
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed_interrupts,
    ) as program:
        records = tmp_path / "tiles" / "pieces"
        while not files_below(records, ".json"):
            assert program.poll() is None
            time.sleep(0.1)
        program.send_signal(signal.SIGINT)
        _, said = program.communicate(timeout=120)
    assert program.returncode == 130, said
    assert said.count("\n") == 1
    assert "what was made is kept" in said
    n_kept = len(files_below(records, ".gpkg"))
    assert n_kept > 0
    figures = done(*arguments[:-1], 1, "--json").figures
    assert figures["n_found"] >= 1
    assert figures["failed"] == []
