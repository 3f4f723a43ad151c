"""Entwine Point Tiles: all nodes as one cloud, a part of them, and sets that are damaged."""

import json
import shutil
import warnings

import laspy
import numpy as np
import pytest
from conftest import DATA
from gis.samples import UTM
from pyproj import CRS

import wavelet_gis as wg
from wavelet_gis.errors import InputFileError, PointCloudWarning
from wavelet_gis.io.las.ept import nodes_within, read_ept
from wavelet_gis.io.names import files_of

SIDE = 64.0
CORNER = (500000.0, 5100000.0)


def write_node(path, xyz):
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.offsets, header.scales = [*CORNER, 100.0], [0.01] * 3
    header.add_crs(CRS.from_user_input(UTM))
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = xyz.T
    cloud.write(path)


def make_set(folder, *, n_levels=2, elsewhere=True, counts=None, **described):
    """Write a set of random points in nodes of two levels; the second has files of its own."""
    rng = np.random.default_rng(3)
    pages = {"0-0-0-0": {}}
    (folder / "ept-data").mkdir(parents=True)
    (folder / "ept-hierarchy").mkdir()
    points = []
    for level in range(n_levels):
        for x in range(1 << level):
            for y in range(1 << level):
                name, side = f"{level}-{x}-{y}-0", SIDE / (1 << level)
                xyz = rng.uniform(0, [side, side, 8], (60, 3)).round(2)
                xyz += [CORNER[0] + x * side, CORNER[1] + y * side, 100.0]
                write_node(folder / "ept-data" / f"{name}.laz", xyz)
                points.append(xyz)
                if elsewhere and level == 1:
                    pages["0-0-0-0"][name] = -1
                    pages[name] = {name: 60}
                else:
                    pages["0-0-0-0"][name] = 60
    pages["0-0-0-0"] |= counts or {}
    for name, page in pages.items():
        (folder / "ept-hierarchy" / f"{name}.json").write_text(json.dumps(page))
    about = {
        "bounds": [*CORNER, 100.0, CORNER[0] + SIDE, CORNER[1] + SIDE, 100.0 + SIDE],
        "dataType": "laszip",
        "span": 8,
        "srs": {"wkt": CRS.from_user_input(UTM).to_wkt()},
        **described,
    }
    (folder / "ept.json").write_text(json.dumps(about))
    return np.concatenate(points)


def opened(path, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return wg.open(path, **options)


@pytest.mark.parametrize("elsewhere", [True, False])
def test_all_nodes_are_one_cloud(tmp_path, elsewhere):
    points = make_set(tmp_path / "set", elsewhere=elsewhere)
    for name in (tmp_path / "set" / "ept.json", tmp_path / "set"):
        terrain = opened(name)
        found = terrain.original.coordinates()
        assert np.allclose(np.sort(found, axis=0), np.sort(points, axis=0), atol=1e-6)
    assert terrain.name.endswith("ept.json")


def test_a_resolution_leaves_out_the_finer_nodes(tmp_path):
    make_set(tmp_path / "set")
    ept = read_ept(tmp_path / "set" / "ept.json")
    assert len(nodes_within(ept, resolution=SIDE / 8)) == 1  # that of the root
    assert len(nodes_within(ept, resolution=SIDE / 8 - 0.1)) == 5
    assert opened(tmp_path / "set", resolution=8.0).original.n_points == 60


def test_a_box_takes_the_nodes_that_reach_into_it(tmp_path):
    points = make_set(tmp_path / "set")
    box = (CORNER[0] + 40, CORNER[1] + 40, CORNER[0] + 60, CORNER[1] + 60)
    ept = read_ept(tmp_path / "set" / "ept.json")
    names = [name.rpartition("/")[2] for name in nodes_within(ept, box)]
    assert names == ["0-0-0-0.laz", "1-1-1-0.laz"]
    inside = (points[:, :2] >= box[:2]).all(axis=1) & (points[:, :2] <= box[2:]).all(axis=1)
    assert opened(tmp_path / "set", bbox=box).original.n_points == inside.sum() > 0
    with pytest.raises(InputFileError, match=r"no node of the set reaches into the box; .*500000"):
        opened(tmp_path / "set", bbox=(0.0, 0.0, 1.0, 1.0))


def test_a_file_without_a_point_in_the_box_is_passed_over(tmp_path):
    make_set(tmp_path / "set")
    data = tmp_path / "set" / "ept-data"
    box = (CORNER[0], CORNER[1], CORNER[0] + 20, CORNER[1] + 20)
    part = opened([data / "1-1-1-0.laz", data / "1-0-0-0.laz", data / "0-0-0-0.laz"], bbox=box)
    assert 0 < part.original.n_points < 120
    with pytest.raises(InputFileError, match="no points in the box"):
        opened([data / "1-1-1-0.laz", data / "1-0-1-0.laz"], bbox=box)


def test_tiles_are_made_of_a_set(tmp_path):
    points = make_set(tmp_path / "set")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tiled = wg.tile_clouds(tmp_path / "set" / "ept.json", tmp_path / "tiles", workers=1)
    mesh = wg.extract_region(tiled.index, level=tiled.index.n_levels).surface.file_mesh
    assert mesh.n_vertices == len(np.unique(points[:, :2], axis=0))


def test_the_crs_of_the_set_holds_where_its_files_have_none(tmp_path):
    make_set(tmp_path / "set")
    for path in (tmp_path / "set" / "ept-data").iterdir():
        cloud = laspy.read(path)
        cloud.vlrs = [record for record in cloud.vlrs if record.user_id != "LASF_Projection"]
        cloud.write(path)
    assert opened(tmp_path / "set").system.kind == "projected"


@pytest.mark.parametrize(
    ("described", "counts", "said"),
    [
        ({"dataType": "binary"}, None, "stored as 'binary', which is not read"),
        ({"bounds": [1, 1, 1, 0, 2, 2]}, None, "hold nothing"),
        ({"span": 0}, None, "span is 0"),
        ({"bounds": [1, 2]}, None, "a list of 6 numbers"),
        ({}, {"../../etc": 5}, "is no node"),
        ({}, {"1-2-0-0": 5}, "is no node"),
        ({}, {"40-0-0-0": 5}, "is no node"),
        ({}, {"1-0-0-1": -7}, "is no node"),
        ({}, {"1-0-0-1": "x"}, "is no node"),
        ({}, {"1-0-0-1": 5}, "cannot be read .No such file"),
        ({}, {"1-0-0-1": -1}, "1-0-0-1.json: this file of a point tile set cannot be read"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, described, counts, said):
    make_set(tmp_path / "set", counts=counts, **described)
    with pytest.raises(InputFileError, match=said) as error:
        opened(tmp_path / "set")
    assert "\n" not in str(error.value)


def test_a_node_that_two_pages_list_is_one(tmp_path):
    """Its points came twice."""
    make_set(tmp_path / "set", counts={"1-0-0-0": 60, "1-1-0-0": -1})
    page = tmp_path / "set" / "ept-hierarchy" / "1-1-0-0.json"
    page.write_text(json.dumps({"1-0-0-0": 60, "1-1-0-0": 60}))
    nodes = nodes_within(read_ept(tmp_path / "set" / "ept.json"))
    assert len(nodes) == len(set(nodes)) == 5


def test_a_page_that_lists_itself_is_read_once(tmp_path):
    make_set(tmp_path / "set", counts={"0-0-0-0": 60, "1-0-0-0": -1})
    page = tmp_path / "set" / "ept-hierarchy" / "1-0-0-0.json"
    page.write_text(json.dumps({"1-0-0-0": -1}))
    assert len(nodes_within(read_ept(tmp_path / "set" / "ept.json"))) == 4


@pytest.mark.parametrize("text", ["", "[]", "{", '{"bounds": 1e999}', "\x00\xff"])
def test_a_description_that_is_none(tmp_path, text):
    (tmp_path / "ept.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputFileError):
        read_ept(tmp_path / "ept.json")


def test_counts_that_do_not_fit_the_files_are_said(tmp_path):
    make_set(tmp_path / "set", counts={"0-0-0-0": 50})
    with pytest.warns(PointCloudWarning, match="counts 50 points there, the file has 60"):
        nodes_within(read_ept(tmp_path / "set" / "ept.json"))


def test_a_folder_with_a_set_is_the_set(tmp_path):
    make_set(tmp_path / "set")
    shutil.copy(tmp_path / "set" / "ept-data" / "0-0-0-0.laz", tmp_path / "set" / "other.laz")
    assert files_of(tmp_path / "set") == [str(tmp_path / "set" / "ept.json")]


@pytest.mark.data
def test_a_real_set_has_the_points_of_its_copc_file():
    ept = opened(DATA / "ept" / "lone-star-laszip").original
    copc = opened(DATA / "clouds" / "lone-star.copc.laz").original
    assert ept.n_points == copc.n_points == 518_862
    for axis in range(3):
        ours, theirs = (np.sort(cloud.coordinates()[:, axis]) for cloud in (ept, copc))
        assert np.abs(ours - theirs).max() < 2e-3  # the scales of the two files
