"""Clouds by a box, and of COPC files by a resolution: the points that laspy finds, no others."""

import laspy
import numpy as np
import pytest
from gis.samples import write_las
from laspy.copc import Bounds, CopcReader

import wavelet_gis as wg
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.las import read_cloud

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


def test_a_box_of_a_cloud(tmp_path):
    path = write_las(tmp_path / "a.laz", 3000)
    box = (500020.0, 5100030.0, 500070.0, 5100050.0)
    cloud, _ = read_cloud(path, bbox=box)
    las = laspy.read(path)
    inside = (las.x >= box[0]) & (las.x <= box[2]) & (las.y >= box[1]) & (las.y <= box[3])
    assert cloud.n_points == np.count_nonzero(inside) > 200
    assert np.array_equal(cloud.integers[:, 0], las.X[inside])
    wg.analyse(wg.open(path, bbox=box), levels=2).restore(tmp_path / "part.las")
    assert laspy.read(tmp_path / "part.las").header.point_count == cloud.n_points
    with pytest.raises(InputFileError, match="there are no points in the box"):
        read_cloud(path, bbox=(0, 0, 1, 1))
    with pytest.raises(InputFileError, match="this is no COPC file, and resolution is for"):
        read_cloud(path, resolution=1.0)


@pytest.fixture
def two_clouds(tmp_path):
    """Return two clouds beside each other; the second has no ground."""
    paths = [write_las(tmp_path / f"{k}.laz", 3000, seed=k) for k in range(2)]
    las = laspy.read(paths[1])
    las.x = np.array(las.x) + 100.0
    las.classification[las.classification == 2] = 9
    las.write(paths[1])
    return paths


def test_files_beside_the_box_are_passed_over(two_clouds):
    """Of several files all had to have points in it, or the work was refused."""
    box = (500020.0, 5100030.0, 500070.0, 5100050.0)
    alone = wg.open(two_clouds[0], bbox=box)
    together = wg.open(two_clouds, bbox=box)
    assert together.mesh == alone.mesh
    told = [note.text for note in together.notes if note.code == "files_without_points"]
    assert told == [
        "1 of 2 files have no point of the chosen classes or in the box and are passed over, the "
        "first is 1.laz"
    ]
    with pytest.raises(InputFileError, match=r"0.laz: there are no points in the box"):
        wg.open(two_clouds, bbox=(0, 0, 1, 1))


def test_files_without_the_class_are_passed_over(two_clouds):
    assert wg.open(two_clouds, classes=[2]).mesh == wg.open(two_clouds[0], classes=[2]).mesh
    assert wg.open(two_clouds, classes=[2, 9]).mesh.n_vertices > 1000


def records(points):
    """Rows of X, Y, Z in an order of their own."""
    rows = np.column_stack([points["X"], points["Y"], points["Z"]])
    return rows[np.lexsort(rows.T)]


@pytest.mark.data
@pytest.mark.parametrize("name", ["clouds/lone-star.copc.laz", "nasty/simple_with_page.copc.laz"])
@pytest.mark.parametrize("part", ["box", "resolution", "both"])
def test_a_part_of_a_copc_file_is_what_laspy_finds(data_folder, name, part):
    path = data_folder / name
    with CopcReader.open(path) as reader:
        low, high = reader.header.mins, reader.header.maxs
        middle, size = (low + high) / 2, high - low
        box = np.concatenate([(middle - 0.2 * size)[:2], (middle + 0.1 * size)[:2]])
        # On stored coordinates: laspy rounds a box to them.
        scales, offsets = (
            np.tile(reader.header.scales[:2], 2),
            np.tile(reader.header.offsets[:2], 2),
        )
        box = np.rint((box - offsets) / scales) * scales + offsets
        spacing = reader.copc_info.spacing / 3
        bounds = Bounds(np.array(box[:2]), np.array(box[2:])) if part != "resolution" else None
        due = reader.query(bounds=bounds, resolution=spacing if part != "box" else None)
    cloud, _ = read_cloud(
        path,
        bbox=None if part == "resolution" else tuple(map(float, box)),
        resolution=None if part == "box" else spacing,
    )
    rows = cloud.integers[np.lexsort(cloud.integers.T)]
    assert len(rows) > 20
    assert np.array_equal(rows, records(due.array))


@pytest.mark.data
def test_a_damaged_tree_is_refused(data_folder, tmp_path):
    content = bytearray((data_folder / "clouds/lone-star.copc.laz").read_bytes())
    start = 375 + 54
    root = int.from_bytes(content[start + 40 : start + 48], "little")
    for at, value in ((start + 40, 1 << 50), (root + 16, 1 << 40), (root + 28, 1 << 30)):
        n_bytes = 4 if at == root + 28 else 8
        damaged = bytearray(content)
        damaged[at : at + n_bytes] = value.to_bytes(n_bytes, "little")
        (tmp_path / "a.copc.laz").write_bytes(damaged)
        with pytest.raises(InputFileError, match="the tree of this COPC file is damaged"):
            read_cloud(tmp_path / "a.copc.laz", resolution=0.5)
