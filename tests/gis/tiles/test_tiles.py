"""Tiled pyramids of rasters: seams, integrals, exact synthesis, resuming, lost workers."""

import contextlib
import importlib.util
import json
import os
import random
import socket
import subprocess
import sys
import time

import numpy as np
import pytest
import rasterio
from gis.samples import UTM, assert_same_raster, hills, write_tif

import wavelet_gis as wg
from wavelet_core import TriangleMesh
from wavelet_core.errors import MissingDependencyError, OptionError
from wavelet_core.metrics import surface_errors
from wavelet_gis.errors import InputFileError, OutputFileError, TerrainWarning
from wavelet_gis.io.pyramid import pyramid_file
from wavelet_gis.io.pyramid.pyramid_file import read_levels, read_pyramid
from wavelet_gis.io.raster import write_dem
from wavelet_gis.tiles.area import area_of
from wavelet_gis.tiles.index import open_index
from wavelet_gis.tiles.piece import cells_of, join
from wavelet_gis.tiles.plan import Piece, TilePlan
from wavelet_gis.tiles.read import terrain_of_region
from wavelet_gis.tiles.within import TilePoints, _errors_within, pieces_within

SIZE = 32


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    """Hills with a hole across a border line of tiles."""
    values = hills(100, 130).astype("f4")
    values[30:37, 50:60] = -9999.0
    return write_tif(tmp_path_factory.mktemp("dem") / "dem.tif", values, nodata=-9999.0)


@pytest.fixture(scope="module")
def tiled(dem):
    return wg.tile_rasters(dem, dem.parent / "tiles", tile=SIZE, levels=4)


def test_the_plan_covers_all_cells_and_shares_lines(tiled):
    plan = tiled.index.plan
    assert (plan.rows, plan.columns) == ((0, 33, 66, 99), (0, 32, 64, 97, 129))
    assert plan.n_stages == 3
    assert [len(plan.pieces(stage)) for stage in range(3)] == [12, 4, 1]
    assert plan.parts(Piece(2, 0, 0)) == plan.pieces(1)
    assert TilePlan.from_json(plan.to_json(), "a") == plan


def seams(index, stage):
    """Yield cells and heights that two pieces of a stage have in common, by levels of both."""
    pieces = {}
    for piece in index.whole(stage):
        pyramid = read_pyramid(index.path(piece)).pyramid
        pieces[piece] = [
            dict(zip(cells_of(index.plan, mesh).tolist(), mesh.vertices.tolist(), strict=True))
            for mesh in pyramid
        ]
    for piece, levels in pieces.items():
        for other in ((piece.row + 1, piece.column), (piece.row, piece.column + 1)):
            neighbour = Piece(stage, *other)
            if neighbour in pieces:
                yield levels, pieces[neighbour]


@pytest.mark.parametrize("stage", [0, 1])
def test_border_vertices_are_the_same_in_both_tiles_at_every_level(tiled, stage):
    n_seams = 0
    for levels, others in seams(tiled.index, stage):
        shared = levels[-1].keys() & others[-1].keys()
        assert len(shared) > 20
        for mine in levels:
            assert shared <= mine.keys()
            for theirs in others:  # at whatever level each of them is
                assert mine.keys() & theirs.keys() == shared
                assert all(mine[cell] == theirs[cell] for cell in shared)
        n_seams += 1
    assert n_seams >= 4


def whole_levels(index):
    """Yield, finest first, the whole at each level: joined meshes with integrals."""
    for stage in range(index.plan.n_stages):
        pyramids = [read_pyramid(index.path(piece)).pyramid for piece in index.whole(stage)]
        for below in range(index.levels_of(stage) + 1):
            levels = [max(pyramid.n_levels - below, 0) for pyramid in pyramids]
            meshes = [p.mesh(k) for p, k in zip(pyramids, levels, strict=True)]
            integrals = [p.integrals(k) for p, k in zip(pyramids, levels, strict=True)]
            yield join(index.plan, meshes, integrals)


def test_the_integral_of_the_whole_is_that_of_the_input_at_every_level(dem, tiled):
    with rasterio.open(dem) as dataset:
        band = dataset.read(1, masked=True)
    total, n_cells = float(band.astype("f8").sum()), band.count()
    n_levels = 0
    for whole in whole_levels(tiled.index):
        assert whole.integrals @ whole.vertices[:, 2] == pytest.approx(total, rel=1e-12)
        assert whole.integrals.sum() == pytest.approx(n_cells, rel=1e-12)
        n_levels += 1
    assert n_levels > 20


def test_the_whole_is_one_valid_surface_at_every_level(dem, tiled):
    finest = wg.open(dem).mesh
    for level in range(tiled.index.n_levels + 1):
        mesh = wg.extract_region(tiled.index, level=level).surface.mesh
        areas = mesh.plan_areas
        assert areas.min() > 0
        assert areas.sum() == pytest.approx(finest.plan_areas.sum(), rel=1e-9)
        tail, head = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
        directed = tail * mesh.n_vertices + head
        assert len(np.unique(directed)) == len(directed)  # no edge has two faces on one side
    assert mesh.n_vertices == finest.n_vertices
    assert np.allclose(mesh.vertices, finest.vertices, atol=1e-9)
    assert {tuple(np.sort(face)) for face in mesh.faces} == {
        tuple(np.sort(face)) for face in finest.faces
    }


def test_errors_at_seams_are_no_larger_than_inside(dem, tiled):
    points = wg.open(dem).mesh.vertices
    region = wg.extract_region(tiled.index, level=tiled.index.n_levels - 4)
    from wavelet_core.metrics import surface_errors

    errors = np.abs(surface_errors(region.surface.mesh, points))
    plan = tiled.index.plan
    rows, columns = np.divmod(cells_of(plan, wg.open(dem).mesh), plan.shape[1])
    near = np.min([np.abs(rows - end) for end in plan.rows[1:-1]], axis=0) <= 1
    near |= np.min([np.abs(columns - end) for end in plan.columns[1:-1]], axis=0) <= 1
    rms = [float(np.sqrt(np.mean(errors[mask] ** 2))) for mask in (near, ~near)]
    assert 0 < rms[0] <= rms[1]


def test_the_raster_and_every_tile_come_back_bit_for_bit(dem, tiled, tmp_path):
    from wavelet_gis.io.raster import write_dem

    whole = wg.restored_raster(tiled.index)
    write_dem(tmp_path / "back.tif", whole, tiled.index.plan.system["wkt"])
    assert_same_raster(dem, tmp_path / "back.tif")
    piece = tiled.index.plan.pieces(0)[5]
    wg.load(tiled.index.path(piece)).restore(tmp_path / "tile.tif")
    top, left, bottom, right = tiled.index.plan.cells(piece)
    with rasterio.open(dem) as whole, rasterio.open(tmp_path / "tile.tif") as part:
        expected = whole.read(1)[top : bottom + 1, left : right + 1]
        assert part.read(1).tobytes() == expected.tobytes()


def test_a_region_reads_the_tiles_that_it_needs(tiled):
    index = tiled.index
    box = (500000.0 + 10 * 70, 5100000.0 - 10 * 20, 500000.0 + 10 * 90, 5100000.0 - 10 * 10)
    region = wg.extract_region(index, level=index.n_levels, bbox=box)
    assert region.pieces == (Piece(0, 0, 2),)
    assert region.surface.mesh.n_vertices == 22 * 12
    everything = wg.extract_region(index, level=index.n_levels - 2)
    part = wg.extract_region(index, level=index.n_levels - 2, bbox=box)
    assert part.surface.mesh.n_faces < everything.surface.mesh.n_faces
    assert set(part.surface.vertex_ids) <= set(everything.surface.vertex_ids)


def test_the_index_is_a_layer_of_footprints(tiled):
    import pyogrio

    path = tiled.index.folder / "index.gpkg"
    _, _, geometry, fields = pyogrio.raw.read(path, layer="tiles")
    names = pyogrio.read_info(path)["fields"].tolist()
    column = dict(zip(names, fields, strict=True))
    assert len(geometry) == 17
    assert set(column["status"]) == {"whole"}
    sizes = [record["sizes"][-1] for record in tiled.index.records.values()]
    assert sorted(column["n_fine"]) == sorted(sizes)
    for file, checksum in zip(column["file"], column["sha256"], strict=True):
        from wavelet_gis.tiles.piece import sha256_of

        assert sha256_of(tiled.index.folder / file) == checksum
    assert pyogrio.read_info(path)["crs"] == UTM


def checksums(folder):
    """Return the bytes of all pyramid files of a tile set."""
    return {p.relative_to(folder): p.read_bytes() for p in (folder / "pieces").rglob("*.gpkg")}


def test_a_second_start_finds_everything_and_mends_what_is_damaged(dem, tmp_path):
    first = wg.tile_rasters(dem, tmp_path / "t", tile=SIZE, levels=4)
    assert (first.n_made, first.n_found) == (17, 0)
    before = checksums(tmp_path / "t")
    again = wg.tile_rasters(dem, tmp_path / "t", tile=SIZE, levels=4)
    assert (again.n_made, again.n_found) == (0, 17)
    damaged = first.index.path(Piece(0, 1, 1))
    damaged.write_bytes(damaged.read_bytes()[:-100] + bytes(100))
    first.index.path(Piece(1, 0, 1)).with_suffix(".json").unlink()
    mended = wg.tile_rasters(dem, tmp_path / "t", tile=SIZE, levels=4)
    assert (mended.n_made, mended.n_found) == (2, 15)
    assert checksums(tmp_path / "t") == before


def test_processes_give_the_bytes_of_one(dem, tiled, tmp_path):
    wg.tile_rasters(dem, tmp_path / "t", tile=SIZE, levels=4, workers=2)
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)


def workers_of(pid):
    """Return the living workers of a program; others may end while one looks."""
    import psutil

    found = []
    with contextlib.suppress(psutil.Error):
        for child in psutil.Process(pid).children(recursive=True):
            with contextlib.suppress(psutil.Error):
                if "spawn_main" in " ".join(child.cmdline()):
                    found.append(child)
    return found


def test_workers_and_program_that_are_killed_at_random_cost_what_is_in_flight(dem, tiled, tmp_path):
    pytest.importorskip("psutil")
    command = [sys.executable, "-m", "wavelet_gis.cli", "tile", dem, tmp_path / "t"]
    command += ["--tile", SIZE, "--levels", 4, "--workers", 2, "--quiet"]
    chance = random.Random(5)
    n_killed = 0
    for _ in range(3):  # the program itself is killed twice, the third start ends
        program = subprocess.Popen(list(map(str, command)))
        until = time.monotonic() + (chance.uniform(6.0, 9.0) if n_killed < 4 else 1e9)
        next_kill = 0.0  # the first worker that is seen
        while program.poll() is None and time.monotonic() < until:
            time.sleep(0.2)
            if time.monotonic() > next_kill and n_killed < 4:
                workers = workers_of(program.pid)
                if workers:
                    chance.choice(workers).kill()
                    n_killed += 1
                    next_kill = time.monotonic() + chance.uniform(2.0, 3.0)
        if program.poll() is None:
            program.kill()
        program.wait()
    assert n_killed > 0
    ended = wg.tile_rasters(dem, tmp_path / "t", tile=SIZE, levels=4)
    assert ended.failed == []
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)


def test_tiles_of_several_files_are_those_of_the_whole(dem, tiled, tmp_path):
    with rasterio.open(dem) as dataset:
        values, place = dataset.read(1), dataset.transform
    (tmp_path / "parts").mkdir()
    for k, (start, stop) in enumerate(((0, 50), (48, 130))):
        write_tif(
            tmp_path / "parts" / f"{k}.tif",
            values[:, start:stop],
            transform=place @ rasterio.Affine.translation(start, 0),
            nodata=-9999.0,
        )
    parts = wg.tile_rasters(tmp_path / "parts", tmp_path / "t", tile=SIZE, levels=4)
    assert wg.restored_raster(parts.index).values.tobytes() == values.tobytes()
    one = wg.extract_region(parts.index, level=3).surface.mesh
    assert one == wg.extract_region(tiled.index, level=3).surface.mesh


@pytest.mark.filterwarnings("ignore:.*which is no elevation")
def test_a_bad_tile_is_set_aside_and_mended_later(dem, tmp_path):
    with rasterio.open(dem) as dataset:
        values, place = dataset.read(1), dataset.transform
    names = []
    for k, (start, stop) in enumerate(((0, 65), (65, 130))):
        names.append(tmp_path / f"{k}.tif")
        write_tif(
            names[-1],
            values[:, start:stop],
            transform=place @ rasterio.Affine.translation(start, 0),
            nodata=-9999.0,
            compress="deflate",
            blockysize=16,
        )
    good = names[1].read_bytes()
    times = names[1].stat().st_mtime_ns
    middle = len(good) // 2
    names[1].write_bytes(good[: middle - 300] + bytes(600) + good[middle + 300 :])

    def same_time():
        import os

        os.utime(names[1], ns=(times, times))

    same_time()
    with pytest.warns(TerrainWarning, match="were set aside, the first at stage 0"):
        tiled = wg.tile_rasters(names, tmp_path / "t", tile=SIZE, levels=4)
    assert 0 < len(tiled.failed) < 8
    assert "cannot be read" in tiled.failed[0]["reason"]
    with pytest.warns(TerrainWarning, match="pieces there could not be made, .* leave holes"):
        assert wg.extract_region(tiled.index, level=2).surface.mesh.n_faces > 0
    with pytest.warns(TerrainWarning, match="leave holes"):
        wg.extract_region(tiled.index, max_error=1.0)
    left = (500010.0, 5099900.0, 500050.0, 5099950.0)  # no bad tile there, so no word
    assert wg.extract_region(tiled.index, level=tiled.index.n_levels, bbox=left).pieces
    with pytest.raises(InputFileError, match="is failed; tile again"):
        wg.restored_raster(tiled.index)
    names[1].write_bytes(good)
    same_time()
    mended = wg.tile_rasters(names, tmp_path / "t", tile=SIZE, levels=4)
    assert mended.failed == []
    assert wg.restored_raster(mended.index).values.tobytes() == values.tobytes()


def test_degrees_have_one_frame_for_all_tiles(tmp_path):
    transform = rasterio.Affine(1 / 3600, 0, 7.0, 0, -1 / 3600, 44.0)
    path = write_tif(tmp_path / "d.tif", hills(70, 70), crs="EPSG:4326", transform=transform)
    tiled = wg.tile_rasters(path, tmp_path / "t", tile=SIZE, levels=3)
    mesh = wg.extract_region(tiled.index, level=0).surface.file_mesh
    assert 7.0 <= mesh.vertices[:, 0].min() < mesh.vertices[:, 0].max() <= 7.02
    assert wg.restored_raster(tiled.index).values.tobytes() == hills(70, 70).tobytes()


def test_one_tile_is_the_plain_pyramid(tmp_path):
    path = write_tif(tmp_path / "d.tif", hills(40, 30))
    tiled = wg.tile_rasters(path, tmp_path / "t")
    assert tiled.index.plan.n_stages == 1
    plain = wg.analyse(wg.open(path))
    assert tiled.index.n_levels == plain.n_levels
    assert wg.extract_region(tiled.index).surface.mesh == plain.geo.pyramid.mesh(0)


@pytest.fixture(scope="module")
def islands(tmp_path_factory):
    """Tiles that have cells but no three side by side: single ones, and a strip one cell wide."""
    values = np.full((60, 80), -9999.0)
    values[:32, :32] = hills(32, 32)
    values[40, 50], values[50, 10], values[45, 52:60] = 300.0, 222.0, np.arange(8) + 290.0
    path = write_tif(tmp_path_factory.mktemp("islands") / "d.tif", values, nodata=-9999.0)
    return path, wg.tile_rasters(path, path.parent / "t", tile=20, levels=3)


def test_single_cells_come_back_from_tiles_that_have_nothing_else(islands, tmp_path):
    """They came back as nodata, called "the original", since such tiles counted as empty."""
    path, tiled = islands
    write_dem(
        tmp_path / "back.tif",
        wg.restored_raster(tiled.index),
        tiled.index.plan.coordinate_system.wkt,
    )
    assert_same_raster(path, tmp_path / "back.tif")


def test_single_cells_are_vertices_of_every_level_and_region(islands):
    _, tiled = islands
    places = {(500000 + 10 * (c + 0.5), 5100000 - 10 * (r + 0.5)) for r, c in ((40, 50), (50, 10))}
    for rule in ({"level": 0}, {"level": tiled.index.n_levels}, {"max_error": 0.5}):
        mesh = wg.extract_region(tiled.index, **rule).surface.file_mesh
        assert places <= set(map(tuple, mesh.vertices[:, :2].tolist()))
    box = (500090.0, 5099480.0, 500120.0, 5099510.0)
    part = wg.extract_region(tiled.index, level=2, bbox=box).surface.file_mesh
    assert part.vertices.tolist() == [[500105.0, 5099495.0, 222.0]]


def test_a_vertex_of_the_input_without_a_face_is_beyond_any_tolerance(tiled):
    """It had no error, so a group with a hole passed as one that keeps the tolerance."""
    index = tiled.index
    top = index.plan.pieces(index.plan.n_stages - 1)[0]
    pyramid = read_levels(index.path(top), 0).pyramid
    mesh, area = pyramid.mesh(pyramid.n_levels), area_of(index.plan, None, None)
    assert _errors_within(TilePoints(index), area, top, mesh, 1e9) is not None
    assert _errors_within(TilePoints(index), area, top, mesh, 0.01) is None
    # Narrower by rounding alone: what is beside it then is measured at its border.
    middle = mesh.vertices.mean(axis=0)
    shrunk = middle + (mesh.vertices - middle) * [1 - 1e-9, 1 - 1e-9, 1.0]
    narrower = TriangleMesh(shrunk, mesh.faces)
    assert np.isnan(surface_errors(narrower, mesh.vertices)).any()
    found = _errors_within(TilePoints(index), area, top, narrower, 1e9)
    assert found is not None
    assert all(np.isfinite(part.errors).all() for part in found)
    off = np.abs(mesh.vertices[mesh.faces].mean(axis=1) - middle)[:, :2].max(axis=1)
    holed = TriangleMesh(mesh.vertices, mesh.faces[off > 40.0])
    assert _errors_within(TilePoints(index), area, top, holed, 1e9) is None


@pytest.mark.parametrize("room", [0, 1 << 28])
def test_the_points_of_a_tile_are_read_once_whatever_levels_are_tried(tiled, monkeypatch, room):
    """They were read again for each level of each group."""
    read = []
    plain = pyramid_file.read_input
    monkeypatch.setattr(pyramid_file, "read_input", lambda path: read.append(path) or plain(path))
    monkeypatch.setattr(TilePoints.__init__, "__defaults__", (room,))
    area = area_of(tiled.index.plan, None, None)
    chosen = list(pieces_within(tiled.index, area, 25.0))
    assert any(one.piece.stage > 0 for one in chosen)
    assert (len(read) == len(set(read))) == (room > 0)


def test_a_tolerance_counts_the_input_of_pyramids_without_a_record(dem, tmp_path):
    """Of such pieces the vertices of the coarsest level were taken for those of the input."""
    tiled = wg.tile_rasters(
        dem, tmp_path / "t", tile=SIZE, levels=3, wavelets={"partition": "random"}
    )
    values = wg.restored_raster(tiled.index)
    rows, columns = np.nonzero(values.valid)
    x, y = values.geometry.centres(columns, rows)
    points = np.column_stack([x, y, values.values[rows, columns]]).astype(float)
    for limit in (1.0, 5.0, 20.0):
        surface = wg.extract_region(tiled.index, max_error=limit).surface
        errors = np.abs(surface_errors(surface.file_mesh, points))
        assert errors.max() <= limit * (1 + 1e-6)
        assert surface.errors.max_error == pytest.approx(errors.max(), rel=1e-6)


def test_a_set_of_single_cells_is_no_terrain_for_a_globe(tmp_path):
    """It ended in a division by zero."""
    values = np.full((30, 30), -9999.0)
    values[::7, ::9] = 300.0
    path = write_tif(tmp_path / "d.tif", values, nodata=-9999.0)
    tiled = wg.tile_rasters(path, tmp_path / "t", tile=16)
    with pytest.raises(InputFileError, match="there is no triangle"):
        wg.terrain_tiles(terrain_of_region(tiled.index), tmp_path / "out")


def test_refusals(dem, tmp_path):
    with pytest.raises(OptionError, match="at least 8 cells"):
        wg.tile_rasters(dem, tmp_path / "t", tile=2)
    with pytest.raises(OptionError, match="signal is no option of tiles"):
        wg.tile_rasters(dem, tmp_path / "t", wavelets={"signal": "xyz"})
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "a.txt").write_text("a", "utf-8")
    with pytest.raises(OutputFileError, match=r"no folder with a plan\.json"):
        wg.tile_rasters(dem, tmp_path / "mine", overwrite=True)
    wg.tile_rasters(dem, tmp_path / "t", tile=100)
    with pytest.raises(OutputFileError, match="of another input or of other options"):
        wg.tile_rasters(dem, tmp_path / "t", tile=50)
    wg.tile_rasters(dem, tmp_path / "t", tile=50, overwrite=True)
    with pytest.raises(InputFileError, match="there is no tile set here"):
        wg.extract_region(tmp_path / "mine")
    index = open_index(tmp_path / "t")
    with pytest.raises(InputFileError, match="there is no level 99"):
        wg.extract_region(index, level=99)
    with pytest.raises(InputFileError, match="no tile reaches into the region"):
        wg.extract_region(index, bbox=(0, 0, 1, 1))
    plan = json.loads(index.plan.to_json())
    for name, ends in (("rows", []), ("rows", [0, 50, 50, 99]), ("columns", [0, 65, 5000])):
        (tmp_path / "t" / "plan.json").write_text(json.dumps({**plan, name: ends}), "utf-8")
        with pytest.raises(InputFileError, match=rf"{name} (do not ascend|is 5000 where)"):
            open_index(tmp_path / "t")
    (tmp_path / "t" / "plan.json").write_text("{}", "utf-8")
    with pytest.raises(InputFileError, match="format is missing"):
        open_index(tmp_path / "t")


def test_a_plan_that_is_no_text_is_replaced_like_another(dem, tmp_path):
    wg.tile_rasters(dem, tmp_path / "t", tile=100)
    (tmp_path / "t" / "plan.json").write_bytes(b"\xff\xfe")
    with pytest.raises(OutputFileError, match="of another input or of other options"):
        wg.tile_rasters(dem, tmp_path / "t", tile=100)
    assert wg.tile_rasters(dem, tmp_path / "t", tile=100, overwrite=True).failed == []


def test_a_record_that_lacks_something_counts_as_none(dem, tmp_path):
    wg.tile_rasters(dem, tmp_path / "t", tile=100)
    path = next((tmp_path / "t" / "pieces" / "0").glob("*.json"))
    record = json.loads(path.read_text("utf-8"))
    for damaged in ({**record, "status": []}, {**record, "n_levels": None}, [], {"status": "new"}):
        path.write_text(json.dumps(damaged), "utf-8")
        assert open_index(tmp_path / "t").records == {}
    assert wg.tile_rasters(dem, tmp_path / "t", tile=100).n_made == 1


def test_a_scheduler_needs_dask(dem, tmp_path):
    if importlib.util.find_spec("distributed") is not None:
        pytest.skip("dask.distributed is here")
    with pytest.raises(MissingDependencyError, match="pip install distributed"):
        wg.tile_rasters(dem, tmp_path / "t", scheduler="tcp://127.0.0.1:8786")


def test_a_dask_cluster_gives_the_bytes_of_one_process(dem, tiled, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None
    ) as cluster:
        wg.tile_rasters(
            dem, tmp_path / "t", tile=SIZE, levels=4, scheduler=cluster.scheduler_address
        )
    assert checksums(tmp_path / "t") == checksums(tiled.index.folder)


@contextlib.contextmanager
def dask_at(port, folder):
    """Run a scheduler and two workers as processes of their own; yield the scheduler's."""
    address = f"tcp://127.0.0.1:{port}"
    options = ("--no-dashboard",)
    commands = [["dask_scheduler", "--host", "127.0.0.1", "--port", str(port), *options]]
    worker = ["dask_worker", address, "--nthreads", "1", "--no-nanny", "--local-directory", folder]
    commands += [[*worker, *options]] * 2
    with contextlib.ExitStack() as stack:
        processes = []
        for name, *arguments in commands:
            command = [sys.executable, "-m", f"distributed.cli.{name}", *map(str, arguments)]
            process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
            stack.callback(process.wait)
            stack.callback(process.kill)
            processes.append(process)
        yield processes[0]


def test_a_scheduler_that_is_killed_costs_what_is_in_flight(tmp_path):
    pytest.importorskip("distributed")
    dem = write_tif(tmp_path / "dem.tif", hills(120, 120))
    once = wg.tile_rasters(dem, tmp_path / "once", tile=20, levels=4)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address, out = f"tcp://127.0.0.1:{port}", tmp_path / "t"
    command = [sys.executable, "-m", "wavelet_gis.cli", "tile", dem, out, "--tile", 20]
    command = [*map(str, command), "--levels", "4", "--quiet", "--scheduler", address]

    def n_made():
        return sum(name.endswith(".json") for _, _, names in os.walk(out) for name in names)

    with dask_at(port, tmp_path) as scheduler:
        program = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        while n_made() < 3:
            assert program.poll() is None
            time.sleep(0.02)
        scheduler.kill()
        _, said = program.communicate(timeout=120)
    assert program.returncode == 1
    assert said.count("\n") == 1
    assert "the Dask scheduler is gone; what was made is kept" in said
    with dask_at(port, tmp_path):
        subprocess.run(command, check=True, timeout=300)
    assert checksums(out) == checksums(once.index.folder)


def test_records_are_plain_json(tiled):
    record = json.loads(
        (tiled.index.folder / "pieces" / "0" / "00000_00000.json").read_text("utf-8")
    )
    assert record["status"] == "whole"
    assert (
        read_levels(tiled.index.path(Piece(0, 0, 0)), 0).pyramid.n_vertices(0)
        == (record["sizes"][0])
    )
