"""The commands do what they say, and their figures are those of the files."""

import numpy as np
import pyogrio
import pytest
import rasterio
from gis.samples import assert_same_cloud, assert_same_raster, hills, write_las, write_tif

from wavelet_core import analyse
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
from wavelet_gis.workflows.open import open_terrain


def test_analyse_and_reconstruct_a_dem(done, tif, tmp_path):
    said = done("analyse", tif, tmp_path / "a.gpkg", "--levels", 3)
    assert "2,000 vertices" in said.out
    assert said.err == ""
    said = done("reconstruct", tmp_path / "a.gpkg", tmp_path / "b.tif")
    assert "checksum verified" in said.out
    assert_same_raster(tif, tmp_path / "b.tif")


@pytest.mark.parametrize("suffix", ["las", "laz"])
def test_analyse_and_reconstruct_a_cloud(done, las, tmp_path, suffix):
    done("analyse", las, tmp_path / "a.gpkg", "--attributes", "classification,intensity")
    done("reconstruct", tmp_path / "a.gpkg", tmp_path / f"b.{suffix}")
    assert_same_cloud(las, tmp_path / f"b.{suffix}")


def test_the_command_agrees_with_the_core(done, tif, tmp_path):
    said = done("analyse", tif, tmp_path / "a.gpkg", "--levels", 3, "--design", "NNLSMO", "--json")
    ours = read_pyramid(tmp_path / "a.gpkg").pyramid
    mesh = open_terrain(tif).mesh
    theirs = analyse(mesh, levels=3, partition="quadric", prediction="NNLS", update="MO")
    assert said.figures["n_levels"] == theirs.n_levels == 3
    assert said.figures["n_coarse_vertices"] == theirs.n_vertices(0)
    assert said.figures["parameters"]["prediction"] == "nnls"
    assert said.figures["parameters"]["update"] == "martinez_ortega"
    assert said.figures["parameters"]["partition"] == "quadric"
    assert ours.coarse.tobytes() == theirs.coarse.tobytes()


def test_stop_rules_are_in_the_unit_of_the_file(done, tmp_path):
    # z in feet over metres: the core works in metres, the user speaks of feet.
    source = write_tif(tmp_path / "a.tif", hills().astype("f4"))
    options = ["--vertical-unit", "foot", "--max-error", 10, "--json"]
    said = done("analyse", source, tmp_path / "a.gpkg", *options)
    errors = [level["max_error_surface"] for level in said.figures["levels"]]
    assert 1 < max(errors) <= 10
    in_metres = read_pyramid(tmp_path / "a.gpkg").pyramid.parameters["max_error"]
    assert in_metres == pytest.approx(3.048)


def test_target_vertices(done, tif, tmp_path):
    said = done("analyse", tif, tmp_path / "a.gpkg", "--target-vertices", 333, "--json")
    assert said.figures["n_coarse_vertices"] == 333


def test_the_layers_that_are_written(done, tif, tmp_path):
    counts = {}
    for layers in ("auto", "all", "coarse", "none"):
        done("analyse", tif, tmp_path / f"{layers}.gpkg", "--levels", 2, "--layers", layers)
        kinds = dict(pyogrio.list_layers(tmp_path / f"{layers}.gpkg"))
        counts[layers] = sum(kind is not None for kind in kinds.values())
        done("reconstruct", tmp_path / f"{layers}.gpkg", tmp_path / f"{layers}.tif")
    assert counts == {"auto": 4, "all": 4, "coarse": 2, "none": 0}


def test_layers_in_proportion_tell_what_they_leave_out(done, tif, tmp_path, monkeypatch):
    monkeypatch.setattr("wavelet_gis.products.layers.MOST_FEATURES", 2000)
    said = done("analyse", tif, tmp_path / "a.gpkg", "--target-vertices", 300)
    kinds = dict(pyogrio.list_layers(tmp_path / "a.gpkg"))
    n_details = sum(name.startswith("detail_level") for name in kinds)
    pyramid = read_pyramid(tmp_path / "a.gpkg").pyramid
    assert 0 < n_details < pyramid.n_levels
    n_features = pyramid.n_vertices(n_details) + pyramid.n_faces(0)
    assert n_features <= 2000 < n_features + pyramid.steps[n_details].n_odd
    left_out = f"details of the finest levels ({pyramid.n_levels - n_details}),"
    assert left_out in said.out
    assert "--layers all" in said.out


@pytest.mark.parametrize("n_details", [2000, 0])
def test_a_large_coarse_tin_is_no_layer_unless_asked_for(
    done, tif, tmp_path, monkeypatch, n_details
):
    monkeypatch.setattr("wavelet_gis.products.layers.MOST_FEATURES", n_details)
    monkeypatch.setattr("wavelet_gis.products.layers.MOST_COARSE_FEATURES", 500)
    said = done("analyse", tif, tmp_path / "a.gpkg", "--target-vertices", 300)
    assert "the coarse TIN" in said.out
    assert "--layers coarse" in said.out
    done("analyse", tif, tmp_path / "b.gpkg", "--target-vertices", 300, "--layers", "coarse")
    kinds = [dict(pyogrio.list_layers(tmp_path / f"{name}.gpkg")) for name in "ab"]
    assert "coarse_tin" not in kinds[0]
    assert ("detail_level_00" in kinds[0]) == (n_details > 0)
    assert "coarse_tin" in kinds[1]
    done("extract", tmp_path / "a.gpkg", tmp_path / "tin.gpkg", "--level", 0)
    done("reconstruct", tmp_path / "a.gpkg", tmp_path / "a.tif")


def test_errors_may_be_left_out(done, tif, tmp_path):
    done("analyse", tif, tmp_path / "a.gpkg", "--no-errors", "--levels", 2)
    table = done("info", tmp_path / "a.gpkg").out.splitlines()[-3:]
    assert [line.split()[:1] for line in table] == [["2"], ["1"], ["0"]]
    assert all(line.split()[3:] == ["-", "-", "-"] for line in table)


def test_info_tells_source_crs_design_and_levels(done, pyramid, cloud_pyramid):
    out = done("info", pyramid).out
    for text in ("hills.tif", "40 x 50", "UTM zone 32N", "kept to the last bit", "2,000"):
        assert text in out, out
    out = done("info", cloud_pyramid).out
    for text in ("trees.laz", "400 points", "z, classification, hag"):
        assert text in out, out
    figures = done("info", pyramid, "--json").figures
    assert figures["pyramid"]["n_vertices"] == 2000
    assert len(figures["levels"]) == 5


@pytest.mark.parametrize("suffix", ["gpkg", "ply", "2dm", "obj"])
def test_extract_a_tin(done, pyramid, tmp_path, suffix):
    said = done("extract", pyramid, tmp_path / f"a.{suffix}", "--level", 1, "--json")
    mesh = read_pyramid(pyramid).pyramid.mesh(1)
    assert said.figures["n_vertices"] == mesh.n_vertices
    assert said.figures["n_triangles"] == mesh.n_faces
    if suffix == "gpkg":
        info = pyogrio.read_info(tmp_path / "a.gpkg", layer="level_01_tin")
        assert info["features"] == mesh.n_faces
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        assert info["total_bounds"] == pytest.approx((low[0], low[1], high[0], high[1]))
    else:
        assert (tmp_path / f"a.{suffix}").stat().st_size > 1000


def test_extract_a_raster_on_the_grid_of_the_input(done, pyramid, tif, tmp_path):
    done("extract", pyramid, tmp_path / "finest.tif", "--level", 4)
    done("extract", pyramid, tmp_path / "coarse.tif", "--cog")
    with rasterio.open(tif) as expected:
        for name in ("finest", "coarse"):
            with rasterio.open(tmp_path / f"{name}.tif") as actual:
                assert actual.transform == expected.transform
                assert actual.shape == expected.shape
                assert actual.crs == expected.crs
                difference = actual.read(1) - expected.read(1)
                assert np.abs(difference).max() < (1e-4 if name == "finest" else 60)
    with rasterio.open(tmp_path / "coarse.tif") as cog:
        assert cog.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"


def test_extract_a_raster_of_another_cell_size_and_of_points(
    done, pyramid, cloud_pyramid, tmp_path
):
    done("extract", pyramid, tmp_path / "a.tif", "--cell-size", 25)
    with rasterio.open(tmp_path / "a.tif") as dataset:
        assert dataset.res == (25, 25)
    done("extract", cloud_pyramid, tmp_path / "b.tif", "--cell-size", 2, "--attribute", "hag")
    with rasterio.open(tmp_path / "b.tif") as dataset:
        heights = dataset.read(1, masked=True)
        assert dataset.shape[0] in range(45, 52)
        assert -5 < heights.min() < 1
        assert 5 < heights.max() < 30
    said = done("extract", cloud_pyramid, tmp_path / "c.tif", "--json")
    n_cells = said.figures["n_rows"] * said.figures["n_columns"]
    assert 0.7 < n_cells / 380 < 1.4  # the points, whatever the level


def test_classes_crs_and_band(done, las, tmp_path):
    said = done("analyse", las, tmp_path / "a.gpkg", "--classes", "2", "--json", "--levels", 1)
    assert said.figures["n_vertices"] < 300
    two = write_tif(tmp_path / "two.tif", np.stack([hills(seed=1), hills(seed=2)]), crs=None)
    said = done("analyse", two, tmp_path / "b.gpkg", "--band", 2, "--crs", "EPSG:2154")
    assert "warning" not in said.err
    assert "Lambert-93" in done("info", tmp_path / "b.gpkg").out
    done("reconstruct", tmp_path / "b.gpkg", tmp_path / "b.tif")
    with rasterio.open(two) as expected, rasterio.open(tmp_path / "b.tif") as actual:
        assert actual.read(1).tobytes() == expected.read(2).tobytes()


def test_overwrite(done, tif, tmp_path):
    (tmp_path / "a.gpkg").write_text("old")
    done("analyse", tif, tmp_path / "a.gpkg", "--overwrite", "--levels", 1)
    assert (tmp_path / "a.gpkg").stat().st_size > 10_000
    assert [path.name for path in tmp_path.iterdir()] == ["a.gpkg"]


def test_a_geographic_dem_says_how_it_is_worked_on(done, tmp_path):
    transform = rasterio.Affine(0.001, 0.0, 7.0, 0.0, -0.001, 44.0)
    source = write_tif(tmp_path / "a.tif", hills(), crs="EPSG:4326", transform=transform)
    said = done("analyse", source, tmp_path / "a.gpkg", "--levels", 2)
    assert said.out.count("local metric frame") == 1
    info = pyogrio.read_info(tmp_path / "a.gpkg", layer="coarse_tin")
    assert info["total_bounds"] == pytest.approx((7.0005, 43.9605, 7.0495, 43.9995), abs=1e-9)


def test_warnings_are_one_line_each(done, tmp_path):
    source = write_las(tmp_path / "a.las", crs=None)
    said = done("analyse", source, tmp_path / "a.gpkg", "--levels", 1)
    assert said.err.count("\n") == 2
    assert "share x and y with others" in said.err
    assert said.err.startswith("terrain-wavelets: warning: ")
    assert "--crs" in said.err
    said = done("analyse", source, tmp_path / "b.gpkg", "--levels", 1, "--quiet")
    assert (said.out, said.err) == ("", "")


def test_quiet_with_json_prints_figures_only(done, tif, tmp_path):
    said = done("analyse", tif, tmp_path / "a.gpkg", "--levels", 1, "--quiet", "--json")
    assert said.figures["n_vertices"] == 2000
    assert said.err == ""


def test_names_with_blanks_and_accents(done, tif, tmp_path):
    import shutil

    folder = tmp_path / "Gelände Süd, 2024 (neu)"
    folder.mkdir()
    shutil.copy(tif, folder / "Höhen #1.tif")
    done("analyse", folder / "Höhen #1.tif", folder / "Pyramide 1.gpkg", "--levels", 2)
    done("reconstruct", folder / "Pyramide 1.gpkg", folder / "zurück.tif")
    done("extract", folder / "Pyramide 1.gpkg", folder / "grob.2dm")
    assert_same_raster(tif, folder / "zurück.tif")
    assert "Höhen #1.tif" in done("info", folder / "Pyramide 1.gpkg").out


def test_a_path_without_a_folder(done, tif, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done("analyse", tif, "a.gpkg", "--levels", 1)
    done("extract", "a.gpkg", "a.ply")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.gpkg", "a.ply"]


def test_notes_are_the_same_in_text_json_info_and_report(done, tmp_path):
    source = write_tif(tmp_path / "a.tif", hills().astype("f4"), crs=None)
    said = done("analyse", source, tmp_path / "a.gpkg", "--target-vertices", 4, "--levels", 2)
    assert "there is no CRS" in said.err
    assert "--crs" in said.err
    assert "4 were asked for" in said.out
    codes = ["crs_missing", "size_not_reached"]
    file = tmp_path / "b.gpkg"
    said = done("analyse", source, file, "--target-vertices", 4, "--levels", 2, "--json")
    assert [note["code"] for note in said.figures["notes"]] == codes
    assert "--crs" in said.figures["notes"][0]["text"]
    told = done("info", file, "--json").figures["notes"]
    assert [note["code"] for note in told] == codes
    assert "4 were asked for" in done("info", file).out
    page = tmp_path / "a.html"
    assert [n["code"] for n in done("report", file, page, "--json").figures["notes"]] == codes
    assert "4 were asked for" in page.read_text("utf-8")


def test_points_and_triangles_are_analysed(done, refused, pyramid, tmp_path):
    done("extract", pyramid, tmp_path / "tin.gpkg", "--level", 2)
    n_vertices = read_pyramid(pyramid).pyramid.n_vertices(2)
    for layer in ("level_02_tin", "level_02_vertices"):
        options = ["--layer", layer, "--levels", 1, "--json"]
        said = done("analyse", tmp_path / "tin.gpkg", tmp_path / f"{layer}.gpkg", *options)
        assert said.figures["n_vertices"] == n_vertices
        done("reconstruct", tmp_path / f"{layer}.gpkg", tmp_path / f"{layer}.ply")
    assert "--layer" in refused("analyse", tmp_path / "tin.gpkg", tmp_path / "a.gpkg")
    assert "a pyramid already" in refused("analyse", pyramid, tmp_path / "a.gpkg")
    table = tmp_path / "points.csv"
    table.write_text("x,y,z\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n0.5,0.4,9\n")
    options = ["--crs", "EPSG:2154", "--levels", 1, "--json"]
    said = done("analyse", table, tmp_path / "points.gpkg", *options)
    assert said.figures["n_vertices"] == 5
    assert "made from a TIN" in refused("reconstruct", tmp_path / "points.gpkg", tmp_path / "a.tif")
