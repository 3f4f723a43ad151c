"""Ground of files: metres whatever the unit, and nothing changed but the classes."""

import laspy
import numpy as np
import pytest
from gis.samples import records_of, write_las

import wavelet_gis as wg
from wavelet_core import OptionError
from wavelet_gis.errors import InputFileError

FOOT = 0.3048


@pytest.fixture
def made(tmp_path):
    """Return a function that writes ground with a house on it, in a unit, and its truth."""

    def write(name, unit=1.0, crs="EPSG:32632", point_format=6):
        rng = np.random.default_rng(0)
        plan = rng.uniform(0, 80, (8_000, 2))
        is_house = (abs(plan - 40) < 9).all(axis=1)
        z = 100 + 0.1 * plan[:, 0] + 5.0 * is_house
        path = write_las(tmp_path / name, len(plan), crs=crs, point_format=point_format)
        las = laspy.read(path)
        las.x = 500_000 + plan[:, 0] / unit
        las.y = 5_100_000 + plan[:, 1] / unit
        las.z = z / unit
        las.write(path)
        return path, ~is_house

    return write


@pytest.mark.parametrize(
    ("unit", "crs"), [(1.0, "EPSG:32632"), (FOOT, "EPSG:2992")], ids=["metres", "feet"]
)
def test_lengths_are_metres_whatever_the_unit(made, unit, crs):
    path, is_ground = made("house.las", unit, crs)
    np.testing.assert_array_equal(wg.classify_ground(path).is_ground, is_ground)


@pytest.mark.parametrize("point_format", [1, 6])
@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_only_the_class_of_points_is_changed(made, tmp_path, point_format, suffix):
    path, is_ground = made("house.las", point_format=point_format)
    before = laspy.read(path)
    # flags share a byte with the class in format 1, and stay
    before.synthetic = np.arange(len(is_ground)) % 2
    before.write(path)
    wg.save(wg.classify_ground(path), tmp_path / f"out{suffix}")
    after = laspy.read(tmp_path / f"out{suffix}")
    np.testing.assert_array_equal(after.classification, np.where(is_ground, 2, 1))
    before.classification[:] = after.classification
    assert after.points.array.tobytes() == before.points.array.tobytes()
    assert records_of(after) == records_of(before)
    assert after.header.parse_crs() == before.header.parse_crs()


def test_noise_and_withheld_points_keep_their_class(made, tmp_path):
    path, is_ground = made("house.las")
    las = laspy.read(path)
    las.classification[:5], las.z[:5] = 7, 0.0
    las.withheld[5:8] = 1
    before = np.array(las.classification)
    las.write(path)
    with pytest.warns(UserWarning, match="left out of the surface"):
        found = wg.classify_ground(path)
    assert found.figures()["n_aside"] == 8
    wg.save(found, tmp_path / "out.las")
    after = np.array(laspy.read(tmp_path / "out.las").classification)
    np.testing.assert_array_equal(after[:8], before[:8])
    np.testing.assert_array_equal(after[8:], np.where(is_ground, 2, 1)[8:])


def test_an_open_cloud_and_several_files_do_as_well(made):
    path, is_ground = made("house.las")
    np.testing.assert_array_equal(wg.classify_ground(wg.open(path)).is_ground, is_ground)
    other, _ = made("other.las")
    both = laspy.read(other)
    both.x += 200
    both.write(other)
    found = wg.classify_ground([path, other])
    assert found.figures() == {
        "n_points": 2 * len(is_ground),
        "n_ground": 2 * int(is_ground.sum()),
        "n_other": 2 * int((~is_ground).sum()),
        "n_aside": 0,
    }


def test_what_cannot_be_classified_is_refused(made, tif, tmp_path):
    path, _ = made("house.las")
    with pytest.raises(InputFileError, match="no point cloud"):
        wg.classify_ground(tif)
    with pytest.raises(InputFileError, match="no point cloud"):
        wg.classify_ground(wg.open(tif))
    with pytest.raises(OptionError, match="when opening"):
        wg.classify_ground(wg.open(path), crs="EPSG:32632")
    with pytest.raises(OptionError, match="height_tolerance is -1"):
        wg.classify_ground(path, height_tolerance=-1)
    with pytest.raises(OptionError, match=r"\.las or \.laz"):
        wg.save(wg.classify_ground(path), tmp_path / "out.tif")
    assert not (tmp_path / "out.tif").exists()
    with pytest.raises(OptionError, match="were not kept"):
        wg.classify_ground(wg.open(path, carry=False)).classified()


def test_too_few_points_are_told_of(tmp_path):
    path = write_las(tmp_path / "few.las", 40)
    las = laspy.read(path)
    las.classification[:], las.withheld[2:] = 1, 1
    las.write(path)
    with (
        pytest.warns(UserWarning, match="left out"),
        pytest.raises(InputFileError, match="has 2 points that are neither"),
    ):
        wg.classify_ground(path)
