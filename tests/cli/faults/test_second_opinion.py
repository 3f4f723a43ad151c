"""Every error that is printed, against a search through all triangles that shares no code.

Clouds with duplicates, gaps and isolated points, DEMs with single cells and strips; a few random
terrains here, a thousand and five hundred apart from the suite (`tests/tools/random_terrain.py`).
"""

import laspy
import numpy as np
import pytest
from gis.samples import hills, write_tif
from tools.random_terrain import NO_SURFACE, FaultError, compare, trials, try_one
from tools.second_opinion import errors_of, read_ply, second_opinion

from wavelet_gis.io.mesh.meshes import write_mesh

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")


@pytest.mark.parametrize(("kind", "count"), [("dem", 8), ("cloud", 6)])
def test_random_terrain_comes_back_and_its_errors_are_true(kind, count):
    outcomes = [(number, str(fault)) for number, _, fault in trials(kind, count, 77) if fault]
    assert outcomes == []


def test_the_second_opinion_is_right_on_a_pyramid_and_can_disagree():
    vertices = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 3], [9, 9, 5.0]])
    faces = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    points = np.array([[1, 0.5, 1.5], [0.5, 1, 2.5], [1, 1, 0], [9, 9, 4], [5, 5, 0.0]])
    np.testing.assert_allclose(errors_of(vertices, faces, points), [0, 1, -3, -1, np.nan])
    opinion = second_opinion(vertices, faces, points)
    assert opinion.n_uncovered == 1
    assert opinion.largest == 3.0
    with pytest.raises(FaultError, match=r"max_error is 2\.9"):
        compare("a", {"max_error": 2.9}, opinion, 10.0)


def test_a_mesh_is_read_by_another_parser(tmp_path):
    from wavelet_core import synthetic

    mesh = synthetic.hills(5, 6)
    write_mesh(tmp_path / "a.ply", mesh)
    vertices, faces = read_ply(tmp_path / "a.ply")
    assert (vertices == mesh.vertices).all()
    assert (faces == mesh.faces).all()


def test_a_command_that_fails_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr("tools.random_terrain.command", lambda line: 1)
    with pytest.raises(FaultError, match="analyse ends with 1"):
        try_one(tmp_path, "dem", np.random.default_rng(0))
    assert all(isinstance(words, str) for words in NO_SURFACE)


def cloud_with_everything(path):
    """Write duplicates 12 m apart, a gap, and three points far from all others."""
    rng = np.random.default_rng(8)
    plan = rng.uniform(0, 60, (900, 2))
    plan[450:, 0] += 140
    plan[:60] = plan[60:120]
    plan[-3:] = [[100, 400], [400, 400], [400, 100]]
    las = laspy.LasData(laspy.LasHeader(version="1.4", point_format=6))
    las.header.scales, las.header.offsets = [0.01] * 3, [5e5, 5.1e6, 0.0]
    las.x, las.y = 5e5 + plan[:, 0], 5.1e6 + plan[:, 1]
    las.z = 100 + 5 * np.sin(plan[:, 0] / 9)
    las.z[:60] += 12.0
    las.write(path)
    return np.column_stack([las.x, las.y, las.z])


@pytest.mark.parametrize("rule", ["lowest", "highest", "mean", "first"])
@pytest.mark.parametrize("gaps", [[], ["--max-edge", "20"], ["--max-edge", "20", "--concave"]])
def test_a_cloud_with_everything(tmp_path, done, rule, gaps):
    points = cloud_with_everything(tmp_path / "a.las")
    options = [*gaps, "--duplicates", rule]
    done("analyse", tmp_path / "a.las", tmp_path / "p.gpkg", "--levels", 3, *options)
    for level in done("info", tmp_path / "p.gpkg", "--json").figures["levels"]:
        output = tmp_path / f"{level['level']}.ply"
        figures = done("extract", tmp_path / "p.gpkg", output, "--level", level["level"], "--json")
        opinion = second_opinion(*read_ply(output), points)
        compare("info", level, opinion, 24.0)
        compare("extract", figures.figures, opinion, 24.0)
    for flags in (["--max-error", 0.5], ["--vertices", 300], ["--rmse", 2.0], ["--max-error", 7]):
        output = tmp_path / f"s{flags[1]}.ply"
        figures = done("simplify", tmp_path / "a.las", output, *flags, *options, "--json").figures
        opinion = second_opinion(*read_ply(output), points)
        compare("simplify", figures, opinion, 24.0)
        # Points of one place are 12 apart, and a surface is between them at best.
        assert opinion.largest >= 6.0 - 0.01


def test_the_raster_of_a_level_is_as_far_off_as_is_printed(tmp_path, done):
    """Cell by cell, single cells and strips among them."""
    import rasterio

    values = np.full((40, 50), -9999.0)
    values[:25, :30] = hills(25, 30)
    values[30, 5:40], values[35, 45], values[5:20, 44] = 310.0, 280.0, np.arange(15) + 290.0
    source = write_tif(tmp_path / "a.tif", values, nodata=-9999.0)
    done("analyse", source, tmp_path / "p.gpkg", "--levels", 4)
    for level in done("info", tmp_path / "p.gpkg", "--json").figures["levels"]:
        output = tmp_path / f"{level['level']}.tif"
        done("extract", tmp_path / "p.gpkg", output, "--level", level["level"])
        with rasterio.open(output) as dataset:
            shown, is_shown = dataset.read(1), dataset.read_masks(1) != 0
        known = values != -9999.0
        assert (is_shown | ~known).all()
        errors = np.abs(shown[known] - values[known])
        assert errors.max() == pytest.approx(level["max_error_surface"], abs=1e-9)
        rmse = float(np.sqrt(np.mean(errors**2)))
        assert rmse == pytest.approx(level["rmse_surface"], abs=1e-9)
        assert level["n_uncovered"] == 0
