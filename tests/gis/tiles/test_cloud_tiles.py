"""Tiled pyramids of point clouds: seams, integrals, every point back, resuming, lost workers."""

import copy
import json
import os
import random
import shutil
import subprocess
import sys
import time
import warnings
from dataclasses import replace

import laspy
import numpy as np
import pytest
from gis.samples import assert_same_cloud, write_las
from gis.tiles.test_tiles import checksums, seams, whole_levels, workers_of

import wavelet_gis as wg
from wavelet_core.errors import OptionError
from wavelet_core.metrics import surface_errors
from wavelet_gis.errors import CrsWarning, InputFileError, OutputFileError, TerrainWarning
from wavelet_gis.tiles.cloud.cut import CUT, source_record
from wavelet_gis.tiles.cloud.plan import plan_of_clouds
from wavelet_gis.tiles.cloud.restore import _make_room, loose_points, names_of_sources
from wavelet_gis.tiles.index import open_index
from wavelet_gis.tiles.plan import Piece, TilePlan

OPTIONS = {"tile": 33, "levels": 4, "attributes": ("intensity",)}

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.PointCloudWarning")


def split(path, folder):
    """Write a cloud as two files that meet at x = 50 and differ in their offsets."""
    las = laspy.read(path)
    folder.mkdir()
    is_east = np.asarray(las.x) - 500000 > 50
    for name, mask, offset in (("west.las", ~is_east, 0), ("east.laz", is_east, 17)):
        shift = np.array([offset, -offset, offset])
        part = laspy.LasData(copy.deepcopy(las.header), las.points[mask].copy())
        part.change_scaling(offsets=las.header.offsets + shift)
        part.write(folder / name)


@pytest.fixture(scope="module")
def cloud(tmp_path_factory):
    """Ground and trees, some points withheld and some noise, duplicates, a pond at a crossing."""
    folder = tmp_path_factory.mktemp("cloud")
    path = write_las(folder / "raw.las", 12000)
    las = laspy.read(path)
    rng = np.random.default_rng(1)
    las.withheld = rng.random(len(las.x)) < 0.01
    noise = rng.random(len(las.x)) < 0.01
    las.classification = np.where(noise, 7, np.asarray(las.classification)).astype(np.uint8)
    las.z = np.where(noise, 5000.0, np.asarray(las.z))
    dry = np.hypot(np.asarray(las.x) - 500033.3, np.asarray(las.y) - 5100066.7) > 6
    las.points = las.points[dry]
    las.write(folder / "all.las")
    return folder / "all.las"


@pytest.fixture(scope="module")
def parts(cloud):
    split(cloud, cloud.parent / "parts")
    return cloud.parent / "parts"


@pytest.fixture(scope="module")
def tiled(parts):
    return wg.tile_clouds(parts, parts.parent / "tiles", **OPTIONS)


def test_the_plan_is_of_stored_steps(tiled):
    plan = tiled.index.plan
    assert [len(plan.pieces(stage)) for stage in range(3)] == [9, 4, 1]
    assert TilePlan.from_json(plan.to_json(), "a") == plan
    assert tiled.figures()["n_files"] == 2
    assert {row["status"] for row in tiled.index.records.values()} == {"whole"}


@pytest.mark.parametrize("stage", [0, 1])
def test_border_vertices_are_the_same_in_both_tiles_at_every_level(tiled, stage):
    n_seams = n_shared = 0
    for levels, others in seams(tiled.index, stage):
        shared = levels[-1].keys() & others[-1].keys()
        for mine in levels:
            assert shared <= mine.keys()
            for theirs in others:
                assert mine.keys() & theirs.keys() == shared
                assert all(mine[place] == theirs[place] for place in shared)
        n_seams += 1
        n_shared += len(shared)
    assert n_seams >= 4
    assert n_shared > 10 * n_seams


def surface_of(cloud):
    """The lowest used point of each place, and how many places there are."""
    las = laspy.read(cloud)
    used = ~np.asarray(las.withheld).astype(bool) & (np.asarray(las.classification) != 7)
    order = np.argsort(np.asarray(las.Z)[used], kind="stable")
    places = np.column_stack([las.X, las.Y])[used][order]
    _, first = np.unique(places, axis=0, return_index=True)
    return np.asarray(las.z)[used][order][first]


def test_the_integral_of_the_whole_is_that_of_the_input_at_every_level(cloud, tiled):
    heights = surface_of(cloud)
    n_levels = 0
    for whole in whole_levels(tiled.index):
        assert whole.integrals @ whole.vertices[:, 2] == pytest.approx(heights.sum(), rel=1e-12)
        assert whole.integrals.sum() == pytest.approx(len(heights), rel=1e-12)
        assert whole.names == ("intensity",)
        n_levels += 1
    assert n_levels > 20


def test_the_whole_is_one_valid_surface_at_every_level(cloud, tiled):
    import shapely

    finest = None
    for level in range(tiled.index.n_levels, -1, -1):
        mesh = wg.extract_region(tiled.index, level=level).surface.mesh
        areas = mesh.plan_areas
        finest = areas.sum() if finest is None else finest
        assert areas.min() > 0
        assert areas.sum() == pytest.approx(finest, rel=1e-9)
        tail, head = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
        directed = tail * mesh.n_vertices + head
        assert len(np.unique(directed)) == len(directed)  # no edge has two faces on one side
        if level % 8 == 0:  # no overlap, and no hole but the pond
            whole = shapely.union_all(shapely.polygons(mesh.vertices[mesh.faces][:, :, :2]))
            assert whole.area == pytest.approx(finest, rel=1e-9)
            assert whole.geom_type == "Polygon"
            assert len(whole.interiors) == 1
    assert (
        len(surface_of(cloud))
        == wg.extract_region(tiled.index, level=tiled.index.n_levels).surface.mesh.n_vertices
    )
    hull = wg.open(cloud).mesh.plan_areas.sum()
    assert 0.98 * hull < finest < hull


def test_tiles_are_those_of_one_file(cloud, tiled, tmp_path):
    one = wg.tile_clouds(cloud, tmp_path / "t", **OPTIONS)
    a = wg.extract_region(one.index, level=3).surface.mesh
    b = wg.extract_region(tiled.index, level=3).surface.mesh
    assert a.n_vertices == pytest.approx(b.n_vertices, rel=0.05)
    wg.restore_source(one.index, 0, tmp_path / "back.las")
    assert (tmp_path / "back.las").read_bytes() == cloud.read_bytes()


def test_every_file_comes_back(parts, tiled, tmp_path):
    east, west = sorted(parts.iterdir())
    assert wg.restore_source(tiled.index, 1, tmp_path / "west.las") > 4000
    assert (tmp_path / "west.las").read_bytes() == west.read_bytes()
    wg.restore_source(tiled.index, 0, tmp_path / "east.laz")
    assert_same_cloud(east, tmp_path / "east.laz")


def test_a_tile_by_itself_gives_its_points(cloud, tiled, tmp_path):
    piece = Piece(0, 1, 1)
    wg.load(tiled.index.path(piece)).restore(tmp_path / "tile.las")
    tile, whole = laspy.read(tmp_path / "tile.las"), laspy.read(cloud)
    records = {
        (x, y, z, time)
        for x, y, z, time in zip(whole.X, whole.Y, whole.Z, whole.gps_time, strict=True)
    }
    offsets = (tile.header.offsets - whole.header.offsets) / whole.header.scales
    moved = np.rint(offsets).astype(int)
    found = zip(tile.X + moved[0], tile.Y + moved[1], tile.Z + moved[2], tile.gps_time, strict=True)
    assert 900 < len(tile.X) < 2000
    assert all(record in records for record in found)


def test_errors_at_seams_are_no_larger_than_inside(cloud, tiled):
    finest = wg.extract_region(tiled.index, level=tiled.index.n_levels).surface.mesh.vertices
    plan = tiled.index.plan
    mesh = wg.extract_region(tiled.index, level=tiled.index.n_levels - 3).surface.mesh
    errors = surface_errors(mesh, finest)
    x, y = plan.local_frame.file_x(finest[:, 0]), plan.local_frame.file_y(finest[:, 1])
    columns, rows = plan.geometry.cells(x, y)
    near = np.min([np.abs(rows - end) for end in plan.rows[1:-1]], axis=0) <= 200
    near |= np.min([np.abs(columns - end) for end in plan.columns[1:-1]], axis=0) <= 200
    rms = [float(np.sqrt(np.nanmean(errors[mask] ** 2))) for mask in (near, ~near)]
    assert 0 < rms[0] <= 1.05 * rms[1]


def test_joined_vertices_are_those_of_the_tiles_to_the_bit(tiled):
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
    from wavelet_gis.tiles.piece import join

    for piece in tiled.index.whole(0):
        mesh = read_pyramid(tiled.index.path(piece)).pyramid.mesh(0)
        joined = join(tiled.index.plan, [mesh], [np.ones(mesh.n_vertices)]).mesh
        here = joined.vertices[np.lexsort(joined.vertices.T)]
        assert np.array_equal(here, mesh.vertices[np.lexsort(mesh.vertices.T)])


def test_a_region_reads_the_tiles_that_it_needs(tiled):
    box = (500080.0, 5100010.0, 500090.0, 5100020.0)
    region = wg.extract_region(tiled.index, level=tiled.index.n_levels, bbox=box)
    assert region.pieces == (Piece(0, 0, 2),)
    assert 80 < region.surface.mesh.n_vertices < 250
    assert region.surface.mesh.attribute_names == ("intensity",)


def test_processes_give_the_bytes_of_one_and_the_cut_is_gone(parts, tiled, tmp_path):
    wg.tile_clouds(parts, tmp_path / "t", workers=2, **OPTIONS)
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)
    assert not (tmp_path / "t" / CUT).exists()


def test_a_second_start_mends_what_is_damaged(parts, tiled, tmp_path):
    shutil.copytree(tiled.index.folder, tmp_path / "t")
    damaged = tmp_path / "t" / "pieces" / "0" / "00001_00001.gpkg"
    damaged.write_bytes(damaged.read_bytes()[:-100] + bytes(100))
    (tmp_path / "t" / "pieces" / "0" / "00002_00002.json").unlink()
    mended = wg.tile_clouds(parts, tmp_path / "t", **OPTIONS)
    assert (mended.n_made, mended.n_found) == (2, 12)
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)


def test_workers_and_program_that_are_killed_at_random_cost_what_is_in_flight(
    parts, tiled, tmp_path
):
    psutil = pytest.importorskip("psutil")
    command = [sys.executable, "-m", "wavelet_gis.cli", "tile", parts, tmp_path / "t"]
    command += ["--tile", 33, "--levels", 4, "--attributes", "intensity"]
    command += ["--workers", 2, "--quiet"]
    chance = random.Random(7)
    n_killed = 0
    for _ in range(3):  # the program itself is killed twice, the third start ends
        program = subprocess.Popen(list(map(str, command)))
        until = time.monotonic() + (chance.uniform(6.0, 9.0) if n_killed < 4 else 1e9)
        next_kill = 0.0
        while program.poll() is None and time.monotonic() < until:
            time.sleep(0.2)
            if time.monotonic() > next_kill and n_killed < 4:
                workers = workers_of(program.pid)
                if workers:
                    chance.choice(workers).kill()
                    n_killed += 1
                    next_kill = time.monotonic() + chance.uniform(2.0, 3.0)
        left = workers_of(program.pid)
        if program.poll() is None:
            program.kill()
        program.wait()
        _, alive = psutil.wait_procs(left, timeout=20)
        assert alive == []  # workers end with the program
    assert n_killed > 0
    ended = wg.tile_clouds(parts, tmp_path / "t", **OPTIONS)
    assert ended.failed == []
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_disk_that_fills_up_costs_what_does_not_fit(tmp_path):
    from cli.faults.test_full_disk import files_limited_to

    (tmp_path / "in").mkdir()
    las = laspy.read(write_las(tmp_path / "raw.las", 6000))
    for k in range(9):  # so many that a file's cut is smaller than a tile
        part = laspy.LasData(copy.deepcopy(las.header), las.points[k::9].copy())
        part.write(tmp_path / "in" / f"{k}.las")
    options = {"tile": 50, "levels": 3}
    good = wg.tile_clouds(tmp_path / "in", tmp_path / "good", **options)
    failed = []
    for n_bytes in (25_000, 45_000):  # no room for a cut; for a tile
        with files_limited_to(n_bytes), pytest.raises(OutputFileError, match="the index cannot be"):
            wg.tile_clouds(tmp_path / "in", tmp_path / "t", **options)
        records = open_index(tmp_path / "t").records
        failed.append(sorted(p.stage for p in records if records[p]["status"] == "failed"))
        assert not list((tmp_path / "t").rglob(".terrain*"))
    with files_limited_to(100_000), pytest.warns(TerrainWarning, match="set aside"):
        broken = wg.tile_clouds(tmp_path / "in", tmp_path / "t", **options)
    failed.append([record["stage"] for record in broken.failed])
    assert failed == [[0] * 4, [0] * 4, [1]]
    ended = wg.tile_clouds(tmp_path / "in", tmp_path / "t", **options)
    assert (ended.failed, ended.n_made) == ([], 1)
    assert checksums(tmp_path / "t") == checksums(good.index.folder)


def test_a_damaged_file_costs_its_tiles_until_it_is_mended(parts, tiled, tmp_path):
    shutil.copytree(parts, tmp_path / "parts")
    east = tmp_path / "parts" / "east.laz"
    good, times = east.read_bytes(), east.stat()
    east.write_bytes(good[:-2000] + bytes(2000))
    os.utime(east, ns=(times.st_atime_ns, times.st_mtime_ns))
    with pytest.warns(TerrainWarning, match=r"east\.laz: the compressed points cannot be read"):
        broken = wg.tile_clouds(tmp_path / "parts", tmp_path / "t", **OPTIONS)
    assert 0 < len(broken.failed) < 9
    with pytest.warns(TerrainWarning, match="leave holes"):
        assert wg.extract_region(broken.index, level=2).surface.mesh.n_faces > 0
    with pytest.raises(InputFileError, match=r"east\.laz was not cut; tile again"):
        wg.restore_source(broken.index, 0, tmp_path / "east.laz")
    east.write_bytes(good)
    os.utime(east, ns=(times.st_atime_ns, times.st_mtime_ns))
    mended = wg.tile_clouds(tmp_path / "parts", tmp_path / "t", **OPTIONS)
    assert mended.failed == []
    wg.restore_source(mended.index, 0, tmp_path / "east.laz")
    assert_same_cloud(east, tmp_path / "east.laz")


@pytest.fixture
def with_two_alone(tmp_path):
    """Nine tiles, of which the middle row has two points in one and none in the others."""
    path = write_las(tmp_path / "raw.las", 25000)
    las = laspy.read(path)
    x, y = np.asarray(las.x) - 500000, np.asarray(las.y) - 5100000
    row = (y > 30) & (y < 70)
    keep = ~row
    lone = np.flatnonzero(row & (x < 30))[:2]
    keep[lone] = True
    las.points = las.points[keep]
    las.write(tmp_path / "a.las")
    return las.xyz[np.searchsorted(np.flatnonzero(keep), lone)]


def test_points_without_a_surface_have_the_heights_of_their_own_file(with_two_alone, tmp_path):
    """The steps are those of the first file, and the offset was that of the file they are in."""
    split(tmp_path / "a.las", tmp_path / "parts")
    tiled = wg.tile_clouds(tmp_path / "parts", tmp_path / "t", tile=33, levels=3)
    assert tiled.index.records[Piece(0, 1, 0)]["status"] == "loose"
    places, _ = loose_points(tiled.index, Piece(0, 1, 0))
    heights = tiled.index.plan.local_frame.to_file(places)[:, 2]
    np.testing.assert_allclose(np.sort(heights), np.sort(with_two_alone[:, 2]), atol=1e-9)


def test_points_without_a_surface_come_back_too(with_two_alone, tmp_path):
    tiled = wg.tile_clouds(tmp_path / "a.las", tmp_path / "t", tile=33, levels=3)
    status = {piece: row["status"] for piece, row in tiled.index.records.items()}
    assert status[Piece(0, 1, 0)] == "loose"
    assert status[Piece(0, 1, 1)] == "empty"
    wg.restore_source(tiled.index, 0, tmp_path / "back.las")
    assert (tmp_path / "back.las").read_bytes() == (tmp_path / "a.las").read_bytes()
    again = wg.tile_clouds(tmp_path / "a.las", tmp_path / "t", tile=33, levels=3)
    assert again.n_made == 0


def test_chosen_classes_alone_come_back(cloud, tmp_path):
    tiled = wg.tile_clouds(cloud, tmp_path / "t", tile=50, levels=3, classes=(2,))
    n_points = wg.restore_source(tiled.index, 0, tmp_path / "ground.las")
    ground, whole = laspy.read(tmp_path / "ground.las"), laspy.read(cloud)
    chosen = whole.points.array[np.asarray(whole.classification) == 2]
    assert ground.points.array.tobytes() == chosen.tobytes()
    assert ground.header.point_count == n_points == len(chosen)


def test_a_record_of_a_cut_that_lies_is_refused(tiled, tmp_path):
    shutil.copytree(tiled.index.folder, tmp_path / "t")
    path = tmp_path / "t" / "sources" / "00000.json"
    record = json.loads(path.read_text("utf-8"))
    for damaged in ({**record, "n_points": 10**12}, {**record, "shift": ["a", 0, 0]}):
        path.write_text(json.dumps(damaged), "utf-8")
        with pytest.raises(InputFileError, match=r"the cut of .* is damaged"):
            wg.restore_source(open_index(tmp_path / "t"), 0, tmp_path / "back.laz")
    del record["n_points"]
    path.write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputFileError, match="was not cut"):
        wg.restore_source(open_index(tmp_path / "t"), 0, tmp_path / "back.laz")
    assert not (tmp_path / "back.laz").exists()


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="the system promises no room")
def test_the_room_for_points_is_there_before_they_are(tmp_path):
    with open(tmp_path / "room", "w+b") as room:
        _make_room(room, 1 << 20)
        assert os.fstat(room.fileno()).st_blocks * 512 >= 1 << 20


def test_names_that_differ_in_capitals_only_are_told_apart(tiled):
    files = [tiled.index.plan.files[0]._replace(path=p) for p in ("/a/E.las", "/b/e.las")]
    plan = replace(tiled.index.plan, files=tuple(files))
    assert names_of_sources(replace(tiled.index, plan=plan)) == ["E.las", "e_2.las"]


def test_one_tile_is_the_plain_pyramid(cloud, tmp_path):
    tiled = wg.tile_clouds(cloud, tmp_path / "t")
    assert tiled.index.plan.n_stages == 1
    plain = wg.analyse(wg.open(cloud))
    assert tiled.index.n_levels == plain.n_levels
    a = wg.extract_region(tiled.index).surface.mesh
    b = plain.geo.pyramid.mesh(0)
    assert a.n_vertices == b.n_vertices
    assert np.allclose(np.sort(a.vertices, axis=0), np.sort(b.vertices, axis=0), atol=1e-6)


def test_degrees(tmp_path):
    path = write_las(tmp_path / "d.las", 6000, crs="EPSG:4326", degrees=True)
    tiled = wg.tile_clouds(path, tmp_path / "t", tile=(0.0005, 0.0005), levels=3)
    assert len(tiled.index.plan.pieces(0)) == 4
    p, q = tiled.index.plan.points.ratio
    assert p / q == pytest.approx(np.cos(np.radians(46)), rel=0.01)
    mesh = wg.extract_region(tiled.index, level=0).surface.file_mesh
    assert 11.0 <= mesh.vertices[:, 0].min() < mesh.vertices[:, 0].max() <= 11.001
    wg.restore_source(tiled.index, 0, tmp_path / "back.las")
    assert (tmp_path / "back.las").read_bytes() == path.read_bytes()


def test_a_header_with_other_bounds_than_its_points_is_told_of(tmp_path):
    path = write_las(tmp_path / "a.las", 4000)
    content = bytearray(path.read_bytes())
    content[179:187] = np.float64(500050.0).tobytes()  # largest x
    path.write_bytes(content)
    with pytest.warns(TerrainWarning, match="lie outside of the bounds that the header states"):
        tiled = wg.tile_clouds(path, tmp_path / "t", levels=3)
    assert tiled.failed


def test_a_broken_crs_is_told_of_as_by_a_single_cloud(tmp_path):
    path = write_las(tmp_path / "a.las", 4000)
    content = path.read_bytes()
    path.write_bytes(content.replace(b"PROJCRS", b"XXXXCRS").replace(b"PROJCS", b"XXXXCS"))
    with pytest.warns(CrsWarning, match="the CRS is broken"):
        wg.open(path)
    with pytest.warns(CrsWarning, match="the CRS is broken"):
        plan_of_clouds(path)


def test_refusals(cloud, parts, tmp_path):
    with pytest.raises(OptionError, match="a tile needs some thousand points"):
        wg.tile_clouds(cloud, tmp_path / "t", tile=10)
    with pytest.raises(OptionError, match="a tile needs some thousand points"):
        wg.tile_clouds(cloud, tmp_path / "t", tile=1e-9)  # of which no list can be made
    with pytest.raises(OptionError, match="give a length above 0"):
        wg.tile_clouds(cloud, tmp_path / "t", tile=-1)
    with pytest.raises(OptionError, match="heights above the ground"):
        wg.tile_clouds(cloud, tmp_path / "t", attributes=("hag",))
    with pytest.raises(OptionError, match="1 to 64 levels"):
        wg.tile_clouds(cloud, tmp_path / "t", levels=0)
    other = write_las(tmp_path / "other.las", 500, point_format=7)
    with pytest.raises(InputFileError, match="other dimensions than those of"):
        wg.tile_clouds([cloud, other], tmp_path / "t")
    near = write_las(tmp_path / "near.las", 500)
    content = bytearray(near.read_bytes())
    content[155:163] = np.float64(500000.003).tobytes()  # offset of x
    near.write_bytes(content)
    with pytest.raises(InputFileError, match="between the steps"):
        wg.tile_clouds([cloud, near], tmp_path / "t")
    tiled = wg.tile_clouds(cloud, tmp_path / "t")
    with pytest.raises(InputFileError, match="not of a raster; use restore_source"):
        wg.restored_raster(tiled.index)
    assert source_record(tmp_path, 0) is None
    assert open_index(tmp_path / "t").plan.points is not None


def test_clouds_too_far_apart_to_count_the_steps_between_are_refused(tmp_path):
    """Each was within 32 bits of the offset; the plan of both was one that no tile could read."""
    paths = [write_las(tmp_path / f"{k}.las", 3000) for k in range(2)]
    for path, x in zip(paths, (-2_000_000_000, 2_000_000_000), strict=True):
        las = laspy.read(path)
        las.X = las.X - las.X.min() + x
        las.write(path)
    with pytest.raises(InputFileError, match="the files lie too far from one another"):
        wg.tile_clouds(paths, tmp_path / "t", tile=100_000)
    assert not (tmp_path / "t").exists()


def test_a_tolerance_is_kept_at_every_vertex_by_pieces_of_all_stages(tiled):
    index = tiled.index
    finest = wg.extract_region(index, level=index.n_levels).surface.mesh
    sizes = []
    for limit in (0.0, 0.2, 3.0, 12.0, 40.0):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TerrainWarning)  # points that share x and y
            region = wg.extract_region(index, max_error=limit)
        mesh = region.surface.mesh
        errors = np.abs(surface_errors(mesh, finest.vertices))
        assert errors.max() <= limit + 1e-9
        assert region.surface.errors.max_error >= errors.max() - 1e-9
        assert region.surface.errors.n_uncovered == 0
        assert mesh.plan_areas.min() > 0
        assert mesh.plan_areas.sum() == pytest.approx(finest.plan_areas.sum(), rel=1e-9)
        tail, head = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
        directed = tail * mesh.n_vertices + head
        assert len(np.unique(directed)) == len(directed)
        sizes.append((mesh.n_vertices, {piece.stage for piece in region.pieces}))
    assert [n for n, _ in sizes] == sorted((n for n, _ in sizes), reverse=True)
    assert sizes[1][1] == {0}
    assert max(sizes[-1][1]) > 0


def test_pieces_of_different_stages_fit(tiled):
    """Any pieces that cover the whole once are one surface, at whatever levels."""
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
    from wavelet_gis.tiles.piece import join

    index = tiled.index
    pieces = [Piece(1, 0, 0), *index.plan.parts(Piece(1, 1, 0)), Piece(1, 0, 1), Piece(1, 1, 1)]
    meshes = []
    for k, piece in enumerate(pieces):
        pyramid = read_pyramid(index.path(piece)).pyramid
        meshes.append(pyramid.mesh((3 * k) % (pyramid.n_levels + 1)))
    mesh = join(index.plan, meshes, [np.ones(m.n_vertices) for m in meshes]).mesh
    area = wg.extract_region(index).surface.mesh.plan_areas.sum()
    assert mesh.plan_areas.sum() == pytest.approx(area, rel=1e-9)
    tail, head = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    forward, back = (np.unique(a * mesh.n_vertices + b) for a, b in ((tail, head), (head, tail)))
    n_outline = len(np.setdiff1d(forward, back))
    root = wg.extract_region(index).surface.mesh
    assert len(forward) == len(tail)
    # The outline is that of the whole: no edge inside is without a face on its other side.
    outline = np.unique(np.setdiff1d(forward, back) // mesh.n_vertices)
    import shapely

    edge = shapely.union_all(shapely.polygons(root.vertices[root.faces][:, :, :2])).boundary
    distance = shapely.distance(shapely.points(mesh.vertices[outline, :2]), edge)
    assert n_outline == len(outline)
    assert distance.max() < 1e-6


def test_a_polygon_is_what_reaches_into_it(tiled, tmp_path):
    import geopandas
    import shapely

    triangle = shapely.Polygon([(500040, 5100040), (500060, 5100040), (500050, 5100060)])
    frame = geopandas.GeoDataFrame(geometry=[triangle], crs="EPSG:32632").to_crs("EPSG:4326")
    frame.to_file(tmp_path / "a.gpkg")
    level = tiled.index.n_levels
    region = wg.extract_region(tiled.index, level=level, polygon=tmp_path / "a.gpkg")
    mesh = region.surface.file_mesh
    faces = shapely.polygons(mesh.vertices[mesh.faces][:, :, :2])
    assert shapely.distance(faces, triangle).max() < 1e-3
    assert shapely.union_all(faces).buffer(1e-3).contains(triangle)
    box = wg.extract_region(tiled.index, level=level, bbox=triangle.bounds)
    assert region.surface.mesh.n_faces < box.surface.mesh.n_faces
    square = geopandas.GeoDataFrame(geometry=[shapely.box(*triangle.bounds)], crs="EPSG:32632")
    same = wg.extract_region(tiled.index, level=level, polygon=square)
    assert same.surface.mesh == box.surface.mesh  # there was another rule for boxes
    with pytest.raises(OptionError, match="give one of bbox and polygon"):
        wg.extract_region(tiled.index, bbox=(0, 0, 1, 1), polygon=frame)
    with pytest.raises(OptionError, match="give one of level and max_error"):
        wg.extract_region(tiled.index, level=0, max_error=1)
    with pytest.raises(OptionError, match="a distance of 0 or more"):
        wg.extract_region(tiled.index, max_error=-1)
    far = frame.set_geometry(frame.geometry.translate(1, 1))
    with pytest.raises(InputFileError, match="give another polygon"):
        wg.extract_region(tiled.index, polygon=far)


def test_a_dask_cluster_gives_the_bytes_of_one_process(parts, tiled, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None
    ) as cluster:
        address = cluster.scheduler_address
        wg.tile_clouds(parts, tmp_path / "t", scheduler=address, **OPTIONS)
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)


def test_groups_are_no_larger_than_tiles(tmp_path):
    path = write_las(tmp_path / "a.las", 25000)
    tiled = wg.tile_clouds(path, tmp_path / "t", tile=50)
    largest = [
        max(tiled.index.records[piece]["sizes"][-1] for piece in tiled.index.whole(stage))
        for stage in range(tiled.index.plan.n_stages)
    ]
    assert len(largest) == 2
    assert largest[1] <= 1.1 * largest[0]
