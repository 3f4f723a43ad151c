"""LAS files in and out: every record byte for byte, attributes, classes, CRS."""

import laspy
import numpy as np
import pytest
from gis.samples import assert_same_cloud, write_las

from wavelet_core import analyse
from wavelet_gis.crs.las import las_crs
from wavelet_gis.errors import CrsWarning, InputFileError, PointCloudWarning
from wavelet_gis.io.las import read_cloud, write_cloud
from wavelet_gis.workflows.open import open_terrain


def through_a_pyramid(path, out, *, signal="z", **options):
    terrain = open_terrain(path, **options)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=3, signal=signal))
    write_cloud(out, geo.restore())
    return geo


FORMATS = [
    ("1.1", 1),
    ("1.2", 0),
    ("1.2", 3),
    ("1.3", 1),
    ("1.4", 1),
    ("1.4", 6),
    ("1.4", 7),
    ("1.4", 8),
]


@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize("suffix", ["las", "laz"])
@pytest.mark.parametrize(("version", "point_format"), FORMATS)
def test_every_record_comes_back(tmp_path, version, point_format, suffix, signal):
    if point_format == 0:  # no GPS time; the writer of samples wants it
        path = write_las(tmp_path / "a.las", version="1.2", point_format=1)
        las = laspy.convert(laspy.read(path), point_format_id=0)
        path = tmp_path / f"b.{suffix}"
        las.write(path)
    else:
        path = write_las(tmp_path / f"a.{suffix}", version=version, point_format=point_format)
    through_a_pyramid(path, tmp_path / f"out.{suffix}", signal=signal)
    assert_same_cloud(path, tmp_path / f"out.{suffix}")


@pytest.mark.parametrize(
    "attributes",
    [
        ["classification"],
        ["intensity", "return_number", "range"],
        ["rgb", "class"],
        ["gps_time", "scan_angle_rank"],
    ],
)
@pytest.mark.parametrize("point_format", [3, 7])
def test_lifted_attributes_come_back(tmp_path, attributes, point_format):
    path = write_las(tmp_path / "a.laz", point_format=point_format)
    if point_format == 7:
        attributes = [a.replace("scan_angle_rank", "scan_angle") for a in attributes]
    through_a_pyramid(path, tmp_path / "out.laz", attributes=attributes)
    assert_same_cloud(path, tmp_path / "out.laz")


def test_attributes_are_physical_values(las):
    terrain = open_terrain(las, attributes=["range", "Classification"])
    expected = laspy.read(las)
    assert terrain.mesh.attribute_names == ("range", "classification")
    found = np.sort(terrain.mesh.attributes[:, 0])
    assert set(found) <= set(np.asarray(expected.range))
    assert set(np.unique(terrain.mesh.attributes[:, 1])) == {2.0, 5.0}


def test_duplicates_are_one_vertex_and_two_points_again(las, tmp_path):
    geo = through_a_pyramid(las, tmp_path / "out.laz", attributes=["intensity"])
    n_points = laspy.read(las).header.point_count
    assert geo.origin.n_points == n_points
    assert len(geo.origin.dropped) == 20
    assert geo.origin.n_vertices == n_points - 20
    assert_same_cloud(las, tmp_path / "out.laz")


def test_the_lowest_of_duplicates_is_the_vertex(las):
    terrain = open_terrain(las)
    cloud, _ = read_cloud(las)
    coordinates = cloud.coordinates()
    for a, b in zip(range(20), range(380, 400), strict=True):
        assert (coordinates[a, :2] == coordinates[b, :2]).all()
        vertex = (terrain.mesh.vertices[:, :2] == coordinates[a, :2]).all(axis=1)
        assert terrain.mesh.vertices[vertex, 2].tolist() == [min(coordinates[[a, b], 2])]


def test_height_above_ground_becomes_a_dimension(las, tmp_path):
    through_a_pyramid(las, tmp_path / "out.laz", attributes=["hag"])
    before, after = laspy.read(las), laspy.read(tmp_path / "out.laz")
    heights = np.asarray(after.hag)
    is_tree = np.asarray(before.classification) == 5
    assert heights[is_tree].min() > 1
    assert np.abs(heights[~is_tree]).max() < 1
    assert (after.X == before.X).all()
    assert (after.Z == before.Z).all()
    assert (after.range == before.range).all()


def test_a_class_filter_chooses_points_and_not_the_ground(las, tmp_path):
    geo = through_a_pyramid(las, tmp_path / "out.las", attributes=["hag"], classes=[5])
    before, after = laspy.read(las), laspy.read(tmp_path / "out.las")
    trees = before.points[np.asarray(before.classification) == 5]
    assert geo.origin.cloud.classes == (5,)
    assert geo.origin.cloud.n_in_file == len(before)
    assert (after.X == trees.X).all()
    assert (after.gps_time == trees["gps_time"]).all()
    assert np.asarray(after.hag).min() > 1
    with pytest.raises(InputFileError, match=r"classes in the file are 2, 5"):
        read_cloud(las, classes=[9])


def test_dimensions_that_are_not_carried_are_zero(las, tmp_path):
    through_a_pyramid(las, tmp_path / "out.laz", attributes=["classification"], carry=False)
    before, after = laspy.read(las), laspy.read(tmp_path / "out.laz")
    assert (after.X == before.X).all()
    assert (after.classification == before.classification).all()
    assert not np.asarray(after.intensity).any()


def test_array_dimensions_and_clashing_names(tmp_path):
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.add_extra_dims(
        [
            laspy.ExtraBytesParams("Colours", "3u1"),
            laspy.ExtraBytesParams("Intensity", "f8"),
            laspy.ExtraBytesParams("pair", "2i2", scales=[0.5, 2.0], offsets=[1.0, 0.0]),
        ]
    )
    las = laspy.LasData(header)
    rng = np.random.default_rng(3)
    las.x, las.y, las.z = rng.uniform(0, 50, (3, 60))
    las.Colours = rng.integers(0, 255, (60, 3))
    las["Intensity"] = rng.normal(size=60)
    las.intensity = rng.integers(0, 999, 60)
    las.pair = np.column_stack([1 + 0.5 * rng.integers(-9, 9, 60), 2.0 * rng.integers(-9, 9, 60)])
    path = tmp_path / "a.las"
    las.write(path)
    names = ["Colours", "Intensity", "intensity", "pair"]
    with pytest.warns(CrsWarning, match="no CRS"):
        terrain = open_terrain(path, attributes=names)
    assert terrain.mesh.attribute_names == (
        "Colours_0",
        "Colours_1",
        "Colours_2",
        "Intensity",
        "intensity",
        "pair_0",
        "pair_1",
    )
    order = np.lexsort(terrain.mesh.vertices.T[:2])
    expected = np.asarray(las.pair)[np.lexsort((las.x, las.y))]
    np.testing.assert_allclose(terrain.mesh.attributes[order][:, 5:], expected)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=2))
    write_cloud(tmp_path / "out.las", geo.restore())
    assert (tmp_path / "out.las").stat().st_size == path.stat().st_size
    assert laspy.read(path).points.array.tobytes() == (
        laspy.read(tmp_path / "out.las").points.array.tobytes()
    )


def test_unknown_and_repeated_attributes(las):
    with pytest.raises(InputFileError, match=r"no dimension 'colour'; the file has .*gps_time"):
        read_cloud(las, attributes=["colour"])
    with pytest.raises(InputFileError, match="requested twice"):
        read_cloud(las, attributes=["class", "classification"])
    for axis in ("X", "z"):
        with pytest.raises(InputFileError, match="no dimension"):
            read_cloud(las, attributes=[axis])


def test_degrees_with_metres_of_height(tmp_path):
    path = write_las(tmp_path / "a.laz", crs="EPSG:4326", degrees=True)
    terrain = open_terrain(path)
    extent = np.ptp(terrain.mesh.vertices, axis=0)
    assert 60 < extent[0] < 90
    assert 100 < extent[1] < 120
    through_a_pyramid(path, tmp_path / "b.laz")
    assert_same_cloud(path, tmp_path / "b.laz")


def crs_of(path):
    with laspy.open(path) as reader:
        records = [v for v in reader.header.vlrs if v.user_id == "LASF_Projection"]
        return las_crs([(v.record_id, v.record_data_bytes()) for v in records])


def test_the_crs_of_wkt_and_of_geotiff_keys(tmp_path):
    for version, point_format in (("1.4", 6), ("1.2", 1)):
        path = write_las(tmp_path / "a.las", version=version, point_format=point_format)
        assert "UTM zone 32N" in crs_of(path).wkt


def with_wkt(path, text, geotiff=False):
    las = laspy.read(path)
    las.header.vlrs[:] = [v for v in las.header.vlrs if v.record_id != 2112]
    las.header.vlrs.append(laspy.VLR("LASF_Projection", 2112, "", text))
    if geotiff:
        other = laspy.LasHeader(version="1.2", point_format=1)
        from pyproj import CRS

        other.add_crs(CRS.from_epsg(25832))
        las.header.vlrs.extend(other.vlrs)
    las.write(path)


@pytest.mark.parametrize("text", [b"", b"\0", b"''", b"PROJCS[", b"\xff\xfe\0"])
def test_a_broken_wkt_is_told_of_and_can_be_overridden(tmp_path, text):
    path = write_las(tmp_path / "a.las")
    with_wkt(path, text)
    with pytest.warns(CrsWarning, match=r"broken .* with crs"):
        terrain = open_terrain(path)
    assert terrain.system.wkt is None
    assert open_terrain(path, crs="EPSG:25832").system.kind == "projected"


def test_keys_stand_in_for_a_broken_wkt(tmp_path):
    path = write_las(tmp_path / "a.las")
    with_wkt(path, b"PROJCS[", geotiff=True)
    assert "25832" in crs_of(path).wkt


def test_a_projection_of_its_own_is_not_taken_for_degrees(tmp_path):
    path = write_las(tmp_path / "a.las", version="1.2", point_format=1)
    las = laspy.read(path)
    directory = las.header.vlrs.get("GeoKeyDirectoryVlr")[0]
    for key in directory.geo_keys:
        if key.id == 3072:
            key.value_offset = 32767
        if key.id == 2048:
            key.value_offset = 4326
    las.write(path)
    place = crs_of(path)
    assert place.wkt is None
    assert "projection of their own" in place.fault


def test_a_missing_date_stays_missing(tmp_path):
    path = write_las(tmp_path / "a.las")
    content = bytearray(path.read_bytes())
    content[90:94] = bytes(4)
    path.write_bytes(content)
    through_a_pyramid(path, tmp_path / "b.las")
    assert (tmp_path / "b.las").read_bytes()[90:94] == bytes(4)


def test_a_file_that_ends_early(tmp_path):
    path = write_las(tmp_path / "a.las")
    size = laspy.read(path).header.point_format.size
    content = path.read_bytes()
    path.write_bytes(content[: -10 * size])
    with pytest.warns(PointCloudWarning, match="announces 400 points, the file ends after 390"):
        cloud, _ = read_cloud(path)
    assert cloud.n_points == 390
    laz = write_las(tmp_path / "a.laz")
    laz.write_bytes(laz.read_bytes()[:3000])
    with pytest.raises(InputFileError, match="damaged"):
        read_cloud(laz)


def header_with(path, position, content):
    data = bytearray(path.read_bytes())
    data[position : position + len(content)] = content
    path.write_bytes(data)


@pytest.mark.parametrize("suffix", ["las", "laz"])
def test_more_points_than_memory(tmp_path, suffix):
    path = write_las(tmp_path / f"a.{suffix}")
    header_with(path, 247, (1 << 60).to_bytes(8, "little"))
    with pytest.raises(InputFileError, match=r"memory|damaged"):
        read_cloud(path)


@pytest.mark.parametrize("scale", [0.0, float("nan"), float("inf")])
def test_scales_that_give_no_coordinates(tmp_path, scale):
    path = write_las(tmp_path / "a.las")
    header_with(path, 131, np.float64(scale).tobytes())
    with pytest.raises(InputFileError, match="scales"):
        read_cloud(path)


def test_no_las_file_at_all(tmp_path):
    (tmp_path / "text.las").write_text("x y z\n1 2 3\n")
    (tmp_path / "empty.las").write_bytes(b"")
    no_points = tmp_path / "none.las"
    laspy.LasData(laspy.LasHeader()).write(no_points)
    for path, what in [
        (tmp_path / "absent.las", "no such file"),
        (tmp_path, "folder"),
        (tmp_path / "text.las", "cannot be read as LAS"),
        (tmp_path / "empty.las", "cannot be read as LAS"),
        (no_points, "no points"),
    ]:
        with pytest.raises(InputFileError, match=what):
            read_cloud(path)
