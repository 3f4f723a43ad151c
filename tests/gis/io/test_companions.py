"""Files beside an output: its own go with it, somebody else's stay as they are."""

import os
import sqlite3
import subprocess
import sys

import pytest
import rasterio
from gis.samples import hills, write_tif

from wavelet_core import synthetic
from wavelet_gis.errors import CrsWarning, OutputFileError, TerrainWarning
from wavelet_gis.io.atomic import check_output, new_file
from wavelet_gis.io.geopackage import create_geopackage
from wavelet_gis.io.mesh.meshes import write_mesh
from wavelet_gis.io.raster import read_dem, write_dem
from wavelet_gis.io.read_back import read_back

MESH = synthetic.hills(6, 7)
UTM_33 = 'PROJCS["WGS 84 / UTM zone 33N",AUTHORITY["EPSG","32633"]]'


def write_new_mesh(path, wkt):
    with new_file(path, overwrite=True) as scratch:
        write_mesh(scratch, MESH, wkt)


def write_new_database(path):
    with new_file(path, overwrite=True) as scratch:
        create_geopackage(scratch)
        read_back(scratch, lambda path: None)


def n_tables(path):
    connection = sqlite3.connect(path)
    try:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        return connection.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()[0]
    finally:
        connection.close()


@pytest.mark.parametrize("ending", ["-wal", "-shm", "-journal"])
def test_what_is_left_of_an_old_database_goes(tmp_path, ending):
    path = tmp_path / "p.gpkg"
    write_new_database(path)
    stale = tmp_path / f"p.gpkg{ending}"
    stale.write_bytes(b"\0" * 4096)
    write_new_database(path)
    assert not stale.exists()
    assert n_tables(path) > 0


def test_committed_frames_of_a_killed_program_do_not_reach_the_new_file(tmp_path):
    path = tmp_path / "p.gpkg"
    write_new_database(path)
    before = n_tables(path)
    code = (
        "import os, sqlite3, sys\n"
        "c = sqlite3.connect(sys.argv[1])\n"
        "c.execute('PRAGMA journal_mode = WAL')\n"
        "c.execute('CREATE TABLE mine (a)')\n"
        "c.commit()\n"
        "os._exit(9)\n"
    )
    subprocess.run([sys.executable, "-c", code, path], check=False)
    assert (tmp_path / "p.gpkg-wal").stat().st_size > 0
    write_new_database(path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["p.gpkg"]
    assert n_tables(path) == before


@pytest.mark.skipif(not os.path.exists("/proc/locks"), reason="Linux's table of locks")
def test_a_database_that_a_program_holds_is_refused_at_once(tmp_path):
    path = tmp_path / "p.gpkg"
    write_new_database(path)
    connection = sqlite3.connect(path)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("CREATE TABLE mine (a)")
    connection.commit()
    try:
        with pytest.raises(OutputFileError, match=f"process {os.getpid()}"):
            check_output(path, overwrite=True)
    finally:
        connection.close()
    check_output(path, overwrite=True)


def test_companions_of_a_file_that_is_not_there_need_leave(tmp_path):
    (tmp_path / "p.gpkg-wal").write_bytes(b"\0" * 100)
    (tmp_path / "a.tif.aux.xml").write_text("<PAMDataset/>")
    for name in ("p.gpkg", "a.tif"):
        with pytest.raises(OutputFileError, match="overwrite to remove"):
            check_output(tmp_path / name)
        check_output(tmp_path / name, overwrite=True)


def test_overviews_statistics_and_masks_of_the_raster_before_go(tmp_path):
    path = write_tif(tmp_path / "a.tif", hills(64, 64).astype("f4"))
    with rasterio.open(path) as dataset:
        old = dataset.read(1)
    for ending in (".ovr", ".msk", ".aux.xml"):
        (tmp_path / f"a.tif{ending}").write_bytes(b"stale")
    (tmp_path / "a.tfw").write_text("10\n0\n0\n-10\n0\n0\n")
    new = write_tif(tmp_path / "b.tif", (old + 100).astype("f4"))
    dem, place = read_dem(new)
    with (
        pytest.warns(TerrainWarning, match=r"a\.tfw"),
        new_file(path, overwrite=True) as scratch,
    ):
        write_dem(scratch, dem, place.wkt)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.tfw", "a.tif", "b.tif"]
    with rasterio.open(path) as dataset:
        assert (dataset.read(1) == old + 100).all()


def test_an_output_that_fails_keeps_the_companions_of_the_old_one(tmp_path):
    path = write_tif(tmp_path / "a.tif", hills(64, 64).astype("f4"))
    (tmp_path / "a.tif.aux.xml").write_text("<PAMDataset/>")
    with pytest.raises(KeyError), new_file(path, overwrite=True):
        raise KeyError
    assert (tmp_path / "a.tif.aux.xml").exists()


@pytest.mark.parametrize("owner", ["m.shp", "m.SHP", "m.dbf", "m.asc", "m.bil", None])
def test_the_prj_of_something_else_stays(tmp_path, owner):
    theirs = tmp_path / "m.prj"
    theirs.write_text('GEOGCS["theirs"]')
    if owner:
        (tmp_path / owner).write_text("theirs")
    write = pytest.warns(CrsWarning, match=r"m\.prj belongs to another.*UTM.*EPSG:32633")
    with write:
        write_new_mesh(tmp_path / "m.2dm", UTM_33)
    assert theirs.read_text() == 'GEOGCS["theirs"]'
    # Nor is it taken for the mesh's own afterwards, with the same time of change or not.
    if owner:
        changed = (tmp_path / "m.2dm").stat().st_mtime_ns
        os.utime(theirs, ns=(changed, changed))
    write_new_mesh(tmp_path / "m.2dm", None)
    assert theirs.read_text() == 'GEOGCS["theirs"]'


def test_our_own_prj_is_replaced_and_goes_with_its_crs(tmp_path):
    path = tmp_path / "m.2dm"
    write_new_mesh(path, UTM_33)
    assert (tmp_path / "m.prj").read_text() == UTM_33
    write_new_mesh(path, UTM_33.replace("33", "32"))
    assert "zone 32N" in (tmp_path / "m.prj").read_text()
    write_new_mesh(path, None)
    assert [p.name for p in tmp_path.iterdir()] == ["m.2dm"]


def test_a_header_that_the_format_needs_is_asked_for_before_the_work(tmp_path):
    (tmp_path / "a.hdr").write_text("theirs")
    with pytest.raises(OutputFileError, match=r"a\.hdr"):
        check_output(tmp_path / "a.bil", overwrite=True)


def test_no_copc_is_promised(tmp_path):
    with pytest.raises(OutputFileError, match="COPC is not written"):
        check_output(tmp_path / "a.copc.laz")
