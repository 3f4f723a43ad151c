"""Point clouds simplified and thinned, in a real QGIS."""

import numpy as np
import pytest
from qgis_layers import Log, survey, write_las

laspy = pytest.importorskip("laspy")


@pytest.fixture
def cloud(tmp_path):
    """Return a LAS file of a slope whose northern half is trees."""
    xyz = survey(3000)
    is_tree = xyz[:, 1] > 6_600_500
    xyz[is_tree, 2] += 15
    return write_las(
        tmp_path / "points.las",
        xyz,
        classification=np.where(is_tree, 5, 2),
        intensity=np.arange(3000) % 500,
        return_number=np.ones(3000, dtype="u1"),
        number_of_returns=np.ones(3000, dtype="u1"),
    )


def rows(las):
    """Return every stored field of the points, one tuple a point."""
    return {tuple(point.tolist()) for point in las.points.array}


def test_a_first_click_gives_the_tin_of_the_ground(run, cloud):
    log = Log()
    made = run("simplifypointcloud", {"INPUT": cloud, "TIN": "memory:"}, feedback=log)
    n_ground = int((laspy.read(cloud)["classification"] == 2).sum())
    assert made["N_INPUT_VERTICES"] == n_ground
    assert made["N_VERTICES"] == max(round(0.05 * n_ground), 3)
    assert any(f"{n_ground} points of the ground" in line for line in log.lines)
    assert made["TIN"].featureCount() == made["N_FACES"]


def test_a_file_without_classes_is_taken_whole_and_the_log_says_so(run, tmp_path):
    path = write_las(tmp_path / "plain.las", survey(500))
    log = Log()
    made = run("simplifypointcloud", {"INPUT": path, "TIN": "memory:"}, feedback=log)
    assert made["N_INPUT_VERTICES"] == 500
    assert any("all points, since none is classified" in line for line in log.lines)


def test_the_thinned_points_are_those_of_the_file_with_all_their_dimensions(run, cloud, tmp_path):
    thinned = str(tmp_path / "thin.las")
    made = run(
        "thinpointcloud",
        {"INPUT": cloud, "CLASSES": "2,5", "VERTICES": 200, "THINNED": thinned, "TIN": None},
    )
    before, after = laspy.read(cloud), laspy.read(thinned)
    assert len(after.points) == made["N_VERTICES"] == 200
    assert rows(after) <= rows(before)
    assert len(rows(after)) == 200
    assert after.header.parse_crs() == before.header.parse_crs()
    assert np.allclose(after.header.maxs, after.xyz.max(axis=0), atol=1e-9)
    assert not made.get("TIN")


def test_the_surface_through_thinned_points_is_as_accurate_as_was_asked(run, cloud, tmp_path):
    from wavelet_core import TriangleMesh
    from wavelet_core.mesh.location import surface_errors

    thinned = str(tmp_path / "thin.laz" if _has_lazrs() else tmp_path / "thin.las")
    made = run("thinpointcloud", {"INPUT": cloud, "MAX_ERROR": 0.5, "THINNED": thinned})
    before, after = laspy.read(cloud), laspy.read(thinned)
    assert set(after["classification"]) == {2}
    ground = before.xyz[before["classification"] == 2]
    errors = surface_errors(TriangleMesh.from_points(np.array(after.xyz)), ground)
    assert np.nanmax(np.abs(errors)) <= 0.5 + 1e-9
    assert made["MAX_ERROR_THINNED"] == pytest.approx(np.nanmax(np.abs(errors)), abs=1e-6)
    assert made["N_THINNED"] == len(after.points) < 0.5 * len(ground)


def _has_lazrs():
    from importlib.util import find_spec

    return find_spec("lazrs") is not None
