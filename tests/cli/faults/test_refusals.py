"""Bad input: exit 1, one line with what, where and how to mend it, and nothing left behind."""

import os
import shutil

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_las, write_tif


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out.gpkg"


@pytest.mark.parametrize("name", ["absent.tif", "absent.las", "absent.laz", "absent"])
def test_a_missing_file(refused, tmp_path, out, name):
    assert "no such file" in refused("analyse", tmp_path / name, out)


@pytest.mark.parametrize("name", ["folder", "folder.tif", "folder.las"])
def test_a_directory(refused, tmp_path, out, name):
    (tmp_path / name).mkdir()
    assert "folder" in refused("analyse", tmp_path / name, out)


@pytest.mark.parametrize("name", ["text.tif", "text.las", "text.laz", "text.txt"])
@pytest.mark.parametrize("content", [b"", b"\n\n", b"x y z\n1 2 3\n4 5 6\n", bytes(10_000)])
def test_a_text_file_by_another_name(refused, tmp_path, out, name, content):
    (tmp_path / name).write_bytes(content)
    line = refused("analyse", tmp_path / name, out)
    assert name in line
    assert "raster" in line or "LAS" in line


def test_an_empty_cloud(refused, tmp_path, out):
    for suffix in ("las", "laz"):
        laspy.LasData(laspy.LasHeader()).write(tmp_path / f"a.{suffix}")
        assert "no points" in refused("analyse", tmp_path / f"a.{suffix}", out)


def cloud(path, x, y, z):
    las = laspy.LasData(laspy.LasHeader())
    las.x, las.y, las.z = np.array(x, float), np.array(y, float), np.array(z, float)
    las.write(path)
    return path


@pytest.mark.parametrize(
    ("x", "y"),
    [
        ([1], [1]),
        ([1, 2], [1, 5]),
        ([1, 1, 1, 1], [2, 2, 2, 2]),  # one place
        ([1, 2, 1, 2], [5, 5, 5, 5]),  # two places
        ([0, 1, 2, 3], [0, 1, 2, 3]),  # a line
        ([5, 5, 5, 5, 5], [0, 7, 3, 1, 2]),
        (np.arange(500) * 0.01, np.arange(500) * 0.03),
        (500000 + np.arange(500) * 0.5, 5100000 + np.arange(500) * 1.5),
    ],
)
def test_points_that_span_no_surface(refused, tmp_path, out, x, y):
    path = cloud(tmp_path / "a.las", x, y, np.arange(len(x)))
    line = refused("analyse", path, out)
    assert "a.las" in line
    assert "three" in line or "line" in line


@pytest.mark.parametrize(
    "values",
    [
        np.full((8, 8), np.nan),
        np.full((8, 8), -9999.0),
        np.where(np.arange(64).reshape(8, 8) == 20, 5.0, -9999.0),  # one cell
        np.where(np.arange(64).reshape(8, 8) < 8, 5.0, -9999.0),  # one row
        np.full((1, 8), 5.0),
        np.full((1, 1), 5.0),
    ],
)
def test_a_raster_without_a_surface(refused, tmp_path, out, values):
    path = write_tif(tmp_path / "a.tif", values, nodata=-9999.0)
    line = refused("analyse", path, out)
    assert "a.tif" in line
    assert "nodata" in line or "three" in line


SCALE, OFFSET = 131, 155  # where the first of each is in the header


@pytest.mark.parametrize(
    ("position", "bad"),
    [
        (SCALE, 0.0),
        (SCALE, float("nan")),
        (SCALE, float("inf")),
        (OFFSET, float("nan")),
        (OFFSET, float("inf")),
    ],
)
def test_coordinates_that_are_no_numbers(refused, tmp_path, out, position, bad):
    path = write_las(tmp_path / "a.las")
    content = bytearray(path.read_bytes())
    content[position : position + 8] = np.float64(bad).tobytes()
    path.write_bytes(content)
    assert "scales" in refused("analyse", path, out)


@pytest.mark.parametrize(
    ("west", "north", "step"), [(-180.0, 90.0, 4.0), (0.0, 60.0, 0.5), (0.0, 20.0, 1.0)]
)
def test_degrees_beyond_a_local_frame(refused, tmp_path, out, west, north, step):
    transform = rasterio.Affine(step, 0.0, west, 0.0, -step, north)
    path = write_tif(tmp_path / "a.tif", hills(45, 60), crs="EPSG:4326", transform=transform)
    line = refused("analyse", path, out)
    assert "reproject" in line
    assert "a.tif" in line


def test_metres_that_pass_for_degrees(refused, tmp_path, out):
    path = write_tif(tmp_path / "a.tif", hills(), crs="EPSG:4326")
    assert "--crs" in refused("analyse", path, out)


def test_an_output_that_exists(refused, tif, pyramid, tmp_path, out):
    out.write_text("precious")
    assert "--overwrite" in refused("analyse", tif, out)
    (tmp_path / "a.tif").write_text("precious")
    assert "--overwrite" in refused("reconstruct", pyramid, tmp_path / "a.tif")
    assert "--overwrite" in refused("extract", pyramid, tmp_path / "a.tif")
    assert out.read_text() == (tmp_path / "a.tif").read_text() == "precious"


def test_outputs_in_places_that_cannot_be_written(refused, tif, pyramid, tmp_path):
    assert "no such folder" in refused("analyse", tif, tmp_path / "none" / "a.gpkg")
    assert "folder" in refused("extract", pyramid, tmp_path)
    if os.path.isdir("/proc"):
        assert "cannot be written" in refused("analyse", tif, "/proc/a.gpkg")
        assert "cannot be written" in refused("reconstruct", pyramid, "/proc/a.tif")


def test_the_input_is_not_overwritten(refused, pyramid, tmp_path):
    copy = tmp_path / "a.gpkg"
    shutil.copy(pyramid, copy)
    assert "input itself" in refused("extract", copy, copy, "--overwrite")


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["a.tif"], ".gpkg"),
        (["a"], ".gpkg"),
        (["a.gpkg", "--band", "4"], "no band 4"),
        (["a.gpkg", "--attributes", "intensity"], "--attributes is for a point cloud"),
        (["a.gpkg", "--classes", "2"], "--classes is for a point cloud"),
        (["a.gpkg", "--crs", "Atlantis"], "EPSG:2154"),
        (["a.gpkg", "--vertical-unit", "cubit"], "metre, foot"),
        (["a.gpkg", "--design", "XYZ"], "XYZ"),
        (["a.gpkg", "--design", "GLMN", "--update", "MO"], "--design"),
        (["a.gpkg", "--partition", "dice"], "dice"),
        (["a.gpkg", "--prediction", "dice"], "dice"),
        (["a.gpkg", "--update", "dice"], "dice"),
        (["a.gpkg", "--signal", "dice"], "dice"),
        (["a.gpkg", "--levels", "-1"], "levels"),
        (["a.gpkg", "--target-vertices", "1"], "--target-vertices is 1"),
        (["a.gpkg", "--max-error", "nan"], "--max-error is nan"),
        (["a.gpkg", "--attribute-weights", "1,2"], "--attribute-weights are"),
    ],
)
def test_options_that_do_not_fit_a_raster(refused, tif, tmp_path, arguments, what):
    name, *options = arguments
    assert what in refused("analyse", tif, tmp_path / name, *options)


def test_a_parameter_has_the_name_of_its_command_s_flag(refused, tif, pyramid, tmp_path):
    assert "--vertices is 1;" in refused("simplify", tif, tmp_path / "a.ply", "--vertices", "1")
    assert "more than --vertices 9;" in refused(
        "extract", pyramid, tmp_path / "a.ply", "--vertices", "9"
    )
    assert "--target-vertices is 1;" in refused(
        "analyse", tif, tmp_path / "a.gpkg", "--target-vertices", "1"
    )


def test_options_that_do_not_fit_a_cloud(refused, las, out):
    assert "classes in the file are 2, 5" in refused("analyse", las, out, "--classes", "9")
    assert "no dimension 'colour'" in refused("analyse", las, out, "--attributes", "colour")
    assert "--band is for a raster" in refused("analyse", las, out, "--band", "1")


def test_height_above_ground_without_ground(refused, tmp_path, out):
    x, y, z = np.random.default_rng(0).uniform(0, 9, (3, 50))
    path = cloud(tmp_path / "a.las", x, y, z)
    assert "class 2" in refused("analyse", path, out, "--attributes", "hag")


@pytest.mark.parametrize("verb", [["info"], ["extract", "o.ply"], ["reconstruct", "o.tif"]])
def test_what_is_no_pyramid(refused, tif, pyramid, tmp_path, done, verb):
    command, *output = verb
    output = [tmp_path / name for name in output]
    (tmp_path / "text.gpkg").write_text("nothing")
    done("extract", pyramid, tmp_path / "layers.gpkg")
    for path in (tif, tmp_path / "text.gpkg", tmp_path / "layers.gpkg", tmp_path, "absent.gpkg"):
        line = refused(command, path, *output)
        assert "pyramid" in line or "no such file" in line


def test_a_level_that_is_not_there(refused, pyramid, tmp_path):
    for level in (5, -1):
        assert "0 to 4" in refused("extract", pyramid, tmp_path / "a.ply", "--level", level)


@pytest.mark.parametrize(
    ("output", "options", "what"),
    [
        ("a.shp", [], ".gpkg"),
        ("a", [], ".gpkg"),
        ("a.ply", ["--cog"], "raster"),
        ("a.ply", ["--cell-size", "3"], "raster"),
        ("a.tif", ["--attribute", "hag"], "no attribute 'hag'"),
        ("a.tif", ["--cell-size", "1e-9"], "larger"),
    ],
)
def test_extracts_that_cannot_be(refused, pyramid, tmp_path, output, options, what):
    assert what in refused("extract", pyramid, tmp_path / output, *options)


def test_reconstructions_in_the_wrong_format(refused, pyramid, cloud_pyramid, tmp_path):
    for name in ("a.las", "a.gpkg", "a.ply", "a"):
        assert "made from a raster" in refused("reconstruct", pyramid, tmp_path / name)
    for name in ("a.tif", "a.gpkg", "a"):
        assert "made from a point cloud" in refused("reconstruct", cloud_pyramid, tmp_path / name)
    assert "suffix" in refused("reconstruct", pyramid, tmp_path / "a.nonsense")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full to stand for a full disk")
def test_a_full_disk_while_writing(command, pyramid, tmp_path, monkeypatch):
    import wavelet_gis.cli.commands.extract as module

    def full(path, mesh, wkt):
        with open("/dev/full", "w") as stream:
            stream.write("x" * 100_000)

    monkeypatch.setattr("wavelet_gis.io.mesh.meshes.write_mesh", full)
    outcome = command("extract", pyramid, tmp_path / "a.ply")
    assert module.HELP
    assert outcome.code == 1
    assert "disk full" in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_dropping_dimensions_of_a_raster_is_refused(tif, refused, tmp_path):
    said = refused("analyse", tif, tmp_path / "x.gpkg", "--drop-other-dimensions")
    assert "--drop-other-dimensions is for a point cloud" in said
