"""The command simplify: a TIN of a size or an accuracy, and any size out of a stored pyramid."""

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_las, write_tif
from scipy.interpolate import LinearNDInterpolator

import wavelet_gis
from wavelet_gis.io.formats import MESH_SUFFIXES


@pytest.fixture
def dem(tmp_path):
    """Return a DEM of hills, 40 x 50 cells."""
    return write_tif(tmp_path / "dem.tif", hills())


@pytest.mark.parametrize("suffix", [".gpkg", *MESH_SUFFIXES, ".tif"])
def test_each_format_holds_the_asked_number(done, dem, tmp_path, suffix):
    output = tmp_path / f"out{suffix}"
    figures = done("simplify", dem, output, "--vertices", 300, "--json").figures
    assert figures["n_vertices"] == 300
    assert figures["n_input_vertices"] == 2000
    assert output.stat().st_size > 0


def test_the_largest_error_is_kept_at_every_cell_of_the_raster(done, dem, tmp_path):
    output = tmp_path / "out.tif"
    figures = done("simplify", dem, output, "--max-error", 0.5, "--json").figures
    with rasterio.open(dem) as original, rasterio.open(output) as simplified:
        error = simplified.read(1).astype(float) - original.read(1).astype(float)
    assert np.abs(error).max() <= 0.5 * (1 + 1e-5)  # the raster is of 32-bit numbers
    assert figures["max_error"] <= 0.5
    assert figures["n_vertices"] < 1000


def test_the_root_mean_square_is_kept_and_used_up(done, dem, tmp_path):
    figures = done("simplify", dem, tmp_path / "out.ply", "--rmse", 0.3, "--json").figures
    assert 0.27 <= figures["rmse"] <= 0.3


def test_fitted_heights_have_the_smaller_mean_square(done, dem, tmp_path):
    arguments = ("simplify", dem, tmp_path / "out.ply", "--vertices", 150, "--json", "--overwrite")
    as_fitted, as_lifted = done(*arguments).figures, done(*arguments, "--no-fit").figures
    assert as_fitted["rmse"] < 0.97 * as_lifted["rmse"]
    assert as_fitted["n_vertices"] == as_lifted["n_vertices"] == 150


def test_smaller_levels_have_the_smaller_error(done, dem, tmp_path):
    arguments = ("simplify", dem, tmp_path / "out.ply", "--vertices", 150, "--json", "--overwrite")
    small, large = (done(*arguments, "--removal-fraction", f).figures for f in (0.05, 1))
    assert small["n_levels"] > large["n_levels"]
    assert small["rmse"] < large["rmse"]


def test_max_norm_has_the_smaller_largest_error(done, dem, tmp_path):
    by_norm = {
        norm: done(
            "simplify", dem, tmp_path / f"{norm}.ply", "--vertices", 150, "--norm", norm, "--json"
        ).figures
        for norm in ("rms", "max")
    }
    assert by_norm["max"]["max_error"] < by_norm["rms"]["max_error"]
    assert by_norm["rms"]["rmse"] < by_norm["max"]["rmse"]


def test_a_point_cloud_is_simplified_with_its_attributes(done, tmp_path):
    cloud = write_las(tmp_path / "cloud.las")
    output = tmp_path / "out.ply"
    done("simplify", cloud, output, "--vertices", 50, "--attributes", "intensity")
    header = output.read_bytes().split(b"end_header")[0]
    assert b"property double intensity" in header


def test_one_rule_is_needed(command, dem, tmp_path):
    assert command("simplify", dem, tmp_path / "out.ply").code == 2
    both = ("--vertices", 9, "--max-error", 1)
    assert command("simplify", dem, tmp_path / "out.ply", *both).code == 2


def test_two_vertices_are_refused(refused, dem, tmp_path):
    refused("simplify", dem, tmp_path / "out.ply", "--vertices", 2)


def test_raster_options_are_refused_for_a_tin(refused, dem, tmp_path):
    refused("simplify", dem, tmp_path / "out.ply", "--vertices", 99, "--cog")


def test_extract_gives_any_size_and_any_accuracy(done, refused, dem, tmp_path):
    pyramid = tmp_path / "pyramid.gpkg"
    done("analyse", dem, pyramid, "--target-vertices", 100)
    sized = done("extract", pyramid, tmp_path / "a.ply", "--vertices", 777, "--json").figures
    assert sized["n_vertices"] == 777
    output = tmp_path / "b.tif"
    done("extract", pyramid, output, "--max-error", 2.0)
    with rasterio.open(dem) as original, rasterio.open(output) as simplified:
        error = simplified.read(1).astype(float) - original.read(1).astype(float)
    assert np.abs(error).max() <= 2.0 * (1 + 1e-5)
    refused("extract", pyramid, tmp_path / "c.ply", "--vertices", 50)


def test_refinement_lowers_the_error_round_by_round(done, dem, tmp_path):
    arguments = ("simplify", dem, tmp_path / "out.ply", "--vertices", 150, "--json", "--overwrite")
    refined, plain = done(*arguments).figures, done(*arguments, "--no-refine").figures
    assert refined["rmse"] < 0.95 * plain["rmse"]
    assert plain["rounds"] == []
    rmse = [row["rmse"] for row in refined["rounds"]]
    assert rmse == sorted(rmse, reverse=True)
    np.testing.assert_allclose(rmse[-1], refined["rmse"], rtol=1e-9)
    assert len(done(*arguments, "--refine", 1).figures["rounds"]) == 3


def test_the_rounds_are_printed(done, dem, tmp_path):
    said = done("simplify", dem, tmp_path / "out.ply", "--vertices", 150, "--refine", 2).out
    assert "as analysed" in said
    assert "round 2" in said
    assert "heights fitted" in said


def test_a_tolerance_takes_fewer_vertices_with_refinement(done, dem, tmp_path):
    arguments = ("simplify", dem, tmp_path / "out.ply", "--max-error", 0.5, "--json", "--overwrite")
    refined, plain = done(*arguments).figures, done(*arguments, "--no-refine").figures
    assert refined["n_vertices"] < plain["n_vertices"]
    assert refined["max_error"] <= 0.5


def test_kept_points_have_the_heights_of_the_input(done, dem, tmp_path):
    output = tmp_path / "out.gpkg"
    figures = done("simplify", dem, output, "--vertices", 150, "--keep-points", "--json").figures
    assert figures["n_vertices"] == 150
    tin = wavelet_gis.open(output, layer="level_00_tin").mesh
    with rasterio.open(dem) as dataset:
        cells = dataset.read(1)
        rows, columns = rasterio.transform.rowcol(dataset.transform, *tin.vertices[:, :2].T)
    np.testing.assert_allclose(tin.vertices[:, 2], cells[rows, columns], rtol=1e-6)


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (("--refine", -1), "--refine is -1"),
        (("--refine", 2, "--no-fit"), "no --no-fit"),
        (("--keep-points", "--design", "GLMN"), "--keep-points"),
    ],
)
def test_options_that_contradict_each_other_are_refused(refused, dem, tmp_path, flags, message):
    assert message in refused("simplify", dem, tmp_path / "out.ply", "--vertices", 150, *flags)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_points_that_stay_are_those_of_the_cloud(done, tmp_path, suffix):
    cloud, thin = write_las(tmp_path / "cloud.las", 1500), tmp_path / f"thin{suffix}"
    figures = done("simplify", cloud, thin, "--vertices", 120, "--json").figures
    before, after = laspy.read(cloud).points.array, laspy.read(thin).points.array
    assert len(after) == 120 == figures["thinned"]["n_points"]
    assert set(map(bytes, after)) <= set(map(bytes, before))
    tin = wavelet_gis.simplify(wavelet_gis.open(cloud), vertices=120, refine=0)
    assert figures["thinned"] == tin.thinned().figures()
    assert figures["rounds"] == []  # none unasked
    more = done("simplify", cloud, thin, "--vertices", 120, "--refine", 1, "--overwrite", "--json")
    assert more.figures["rounds"][1]["n_moved"] > 0


def test_points_that_stay_keep_the_tolerance_between_them(done, tmp_path):
    cloud, thin = write_las(tmp_path / "cloud.las", 1500), tmp_path / "thin.las"
    run = done("simplify", cloud, thin, "--max-error", 1, "--classes", 2)
    again = wavelet_gis.open(thin, classes=(2,))
    every = wavelet_gis.open(cloud, classes=(2,))
    x, y, z = every.original.coordinates()[every.origin.vertex_rows()].T
    a, b, c = again.original.coordinates()[again.origin.vertex_rows()].T
    surface = LinearNDInterpolator(np.column_stack([a, b]), c)  # another triangulation
    errors = np.abs(surface(x, y) - z)
    assert np.nanmax(errors) <= 1 + 1e-6
    assert len(a) < len(x) / 2
    assert f"{len(laspy.read(thin).points):,} points stay" in run.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--cell-size", 2), "--cell-size is for a TIN or a raster"),
        (("--cog",), "--cog is for a TIN or a raster"),
        (("--min-angle", 20), "--min-angle is for a TIN or a raster"),
        (("--duplicates", "mean"), "no points carry the surface"),
    ],
)
def test_what_points_cannot_have_is_refused(refused, tmp_path, arguments, said):
    cloud, thin = write_las(tmp_path / "cloud.las", 1500), tmp_path / "thin.las"
    assert said in refused("simplify", cloud, thin, "--vertices", 120, *arguments)
    assert not thin.exists()


def test_a_raster_has_no_points_that_could_stay(refused, dem, tmp_path):
    said = refused("simplify", dem, tmp_path / "thin.laz", "--vertices", 120)
    assert "this is no point cloud" in said
