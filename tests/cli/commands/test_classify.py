"""The command ``classify``."""

import laspy
import numpy as np


def test_ground_is_classified_and_counted(done, las, tmp_path):
    out = tmp_path / "ground.laz"
    figures = done("classify", las, out, "--ground", "--json").figures
    classes = np.array(laspy.read(out).classification)
    assert set(classes) == {1, 2}
    assert figures["n_ground"] == np.count_nonzero(classes == 2) > 0
    assert figures["n_points"] == len(classes) == len(laspy.read(las).points)


def test_its_options_count(done, las, tmp_path):
    counts = []
    for k, tolerance in enumerate(("0.05", "5")):
        out = tmp_path / f"{k}.las"
        told = done("classify", las, out, "--ground", "--height-tolerance", tolerance)
        assert "points are ground" in told.out
        counts.append(np.count_nonzero(laspy.read(out).classification == 2))
    assert counts[0] < counts[1]


def test_what_to_classify_has_to_be_said(command, las, tmp_path):
    outcome = command("classify", las, tmp_path / "out.las")
    assert outcome.code == 2
    assert "--ground" in outcome.err


def test_a_raster_and_its_own_input_are_refused(refused, tif, las, tmp_path):
    assert "no point cloud" in refused("classify", tif, tmp_path / "out.las", "--ground")
    assert "out.gpkg" in refused("classify", las, tmp_path / "out.gpkg", "--ground")
    assert str(las) in refused("classify", las, las, "--ground", "--overwrite")
