"""The GeoPackage itself: valid without layers, styles added, strangers opened with care."""

import os
import shutil
import sqlite3
import time
from contextlib import closing

import pytest

from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.geopackage import (
    create_geopackage,
    open_for_writing,
    open_untrusted,
    table_names,
    write_styles,
)
from wavelet_gis.io.pyramid.metadata_tables import TABLES
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, read_summary, write_pyramid


def test_an_empty_one_is_valid(tmp_path, validate_gpkg):
    create_geopackage(tmp_path / "a.gpkg")
    validate_gpkg(tmp_path / "a.gpkg")


@pytest.fixture
def alone(raster_record, tmp_path):
    """Return a small pyramid file to which no layers are to be added."""
    write_pyramid(tmp_path / "alone.gpkg", raster_record, is_alone=True)
    return tmp_path / "alone.gpkg"


def test_without_layers_little_is_beside_the_chunks(alone):
    with closing(sqlite3.connect(alone)) as connection:
        connection.execute("DELETE FROM wavelet_chunks")
        connection.commit()
        connection.execute("VACUUM")
    assert alone.stat().st_size <= 14_848  # 18,944 before; a page is 512


def test_without_layers_programs_list_the_tables(alone, validate_gpkg):
    import pyogrio

    validate_gpkg(alone)
    # GDAL shows none where there is no gpkg_geometry_columns, which the standard would allow.
    assert pyogrio.list_layers(alone).tolist() == [[name, None] for name in TABLES]
    for name in TABLES:
        assert pyogrio.read_info(alone, layer=name, force_feature_count=True)["features"] > 0


def test_layers_added_to_a_pyramid_without(alone, raster_record, validate_gpkg):
    import pyogrio

    from wavelet_gis.io.vector.vector_writer import add_layers
    from wavelet_gis.products.layers import coarse_layers

    before = read_summary(alone)
    layers = list(coarse_layers(raster_record))
    add_layers(alone, layers, raster_record.system)
    validate_gpkg(alone)
    name, box = layers[0].name, pyogrio.read_info(alone, layer=layers[0].name)["total_bounds"]
    found = pyogrio.raw.read(alone, layer=name, bbox=tuple(box))[2]
    assert len(found) == len(layers[0].geometry)  # by the index, which SQLite must be able to read
    with closing(sqlite3.connect(alone)) as connection, connection:
        styled = connection.execute("SELECT f_table_name FROM layer_styles").fetchall()
    assert styled == [(layer.name,) for layer in layers]
    assert read_summary(alone) == before
    assert read_pyramid(alone).pyramid.faces.tobytes() == raster_record.pyramid.faces.tobytes()


def test_styles_are_added_to_those_there(tmp_path, validate_gpkg):
    create_geopackage(tmp_path / "a.gpkg")
    write_styles(tmp_path / "a.gpkg", [("one", "One", "<qgis/>", "first")])
    write_styles(tmp_path / "a.gpkg", [("two", "Two", "<qgis/>", "second")])
    with closing(sqlite3.connect(tmp_path / "a.gpkg")) as connection, connection:
        rows = connection.execute("SELECT f_table_name, styleName FROM layer_styles").fetchall()
    assert rows == [("one", "One"), ("two", "Two")]
    validate_gpkg(tmp_path / "a.gpkg")


def test_a_stranger_is_opened_for_reading_only(raster_pyramid):
    with (
        pytest.raises(InputFileError, match="readonly"),
        open_untrusted(raster_pyramid) as connection,
    ):
        connection.execute("DELETE FROM wavelet_metadata")


def test_names_with_signs_that_urls_give_a_meaning(tmp_path):
    for name in ("a b.gpkg", "a%20b.gpkg", "ä?mode=rwc.gpkg", "c#d.gpkg"):
        create_geopackage(tmp_path / name)
        with open_untrusted(tmp_path / name) as connection:
            assert "gpkg_contents" in table_names(connection)
    assert len(list(tmp_path.iterdir())) == 4


def test_what_is_no_database(tmp_path):
    (tmp_path / "text.gpkg").write_text("nothing like it")
    (tmp_path / "cut.gpkg").write_bytes(b"SQLite format 3\0" + bytes(50))
    for path, what in [
        (tmp_path / "absent.gpkg", "no such file"),
        (tmp_path, "folder"),
        (tmp_path / "text.gpkg", "no GeoPackage"),
        (tmp_path / "cut.gpkg", "no GeoPackage"),
    ]:
        with pytest.raises(InputFileError, match=what), open_untrusted(path):
            pytest.fail("the block must not begin")


@pytest.fixture
def copy(raster_pyramid, tmp_path):
    return shutil.copy(raster_pyramid, tmp_path / "p.gpkg")


@pytest.mark.parametrize("mode", ["EXCLUSIVE", "WAL and EXCLUSIVE"])
def test_a_file_that_another_program_holds(copy, mode):
    other = sqlite3.connect(copy, isolation_level=None)
    if mode.startswith("WAL"):
        other.execute("PRAGMA journal_mode = WAL")
        other.execute("PRAGMA locking_mode = EXCLUSIVE")
    other.execute("BEGIN EXCLUSIVE")
    other.execute("UPDATE gpkg_contents SET description = ''")
    started = time.monotonic()
    for read in (read_summary, read_pyramid):
        with pytest.raises(InputFileError, match="another program holds the file locked") as caught:
            read(copy)
        assert "damaged" not in str(caught.value)
    assert time.monotonic() - started < 10
    other.rollback()
    other.close()
    read_summary(copy)


def test_a_file_that_another_program_holds_is_not_written(tmp_path):
    create_geopackage(tmp_path / "a.gpkg")
    other = sqlite3.connect(tmp_path / "a.gpkg", isolation_level=None)
    other.execute("BEGIN EXCLUSIVE")
    with pytest.raises(OutputFileError, match="another program holds the file locked"):
        write_styles(tmp_path / "a.gpkg", [("one", "One", "<qgis/>", "first")])
    other.close()


def test_a_disk_without_room_is_called_full(tmp_path):
    create_geopackage(tmp_path / "a.gpkg")
    with (
        pytest.raises(OutputFileError, match=r"the disk is full .*make room"),
        open_for_writing(tmp_path / "a.gpkg") as connection,
    ):
        connection.executescript(
            "PRAGMA max_page_count = 30; CREATE TABLE big AS SELECT zeroblob(1000000)"
        )


def test_a_folder_that_is_none(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputFileError, match="the system does not open the file"):
        create_geopackage(tmp_path / "file" / "a.gpkg")


def test_a_pipe_does_not_keep_us_waiting(tmp_path):
    os.mkfifo(tmp_path / "a.gpkg")
    with pytest.raises(InputFileError, match="a pipe"):
        read_summary(tmp_path / "a.gpkg")


def test_what_lies_beside_a_damaged_file_is_named(copy, cloud_pyramid):
    other = sqlite3.connect(copy)
    other.execute("PRAGMA journal_mode = WAL")
    other.execute("UPDATE wavelet_levels SET n_faces = n_faces + 1")
    other.commit()
    frames = copy.with_name("p.gpkg-wal").read_bytes()
    other.close()
    shutil.copy(cloud_pyramid, copy)
    with closing(sqlite3.connect(copy)) as connection, connection:
        connection.execute("PRAGMA journal_mode = WAL")
    copy.with_name("p.gpkg-wal").write_bytes(frames)
    with pytest.raises(OSError, match=r"p\.gpkg-wal lies beside it"):
        read_pyramid(copy)


def test_what_never_ends_is_ended(tmp_path):
    create_geopackage(tmp_path / "a.gpkg")
    started = time.monotonic()
    with (
        pytest.raises(InputFileError, match="more work than any pyramid file needs"),
        open_untrusted(tmp_path / "a.gpkg") as connection,
    ):
        connection.execute(
            "WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n) SELECT MAX(i) FROM n"
        ).fetchone()
    assert time.monotonic() - started < 20


def test_layers_are_dated_alike_whatever_else_the_process_writes(
    raster_record, tmp_path, monkeypatch
):
    from wavelet_gis.io.vector.vector_writer import add_layers
    from wavelet_gis.products.layers import coarse_layers

    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")

    def with_another_between():
        for k, layer in enumerate(coarse_layers(raster_record)):
            add_layers(tmp_path / f"b{k}.gpkg", coarse_layers(raster_record), raster_record.system)
            yield layer

    add_layers(tmp_path / "a.gpkg", with_another_between(), raster_record.system)
    for name in ("a.gpkg", "b0.gpkg", "b1.gpkg"):
        with closing(sqlite3.connect(tmp_path / name)) as connection, connection:
            dates = set(connection.execute("SELECT last_change FROM gpkg_contents"))
        assert dates == {("2023-11-14T22:13:20.000Z",)}
    assert (tmp_path / "a.gpkg").read_bytes() == (tmp_path / "b1.gpkg").read_bytes()


def test_a_schema_of_very_many_tables(tmp_path):
    create_geopackage(tmp_path / "a.gpkg")
    connection = sqlite3.connect(tmp_path / "a.gpkg")
    connection.execute("PRAGMA writable_schema = ON")
    connection.execute(
        "INSERT INTO sqlite_master SELECT 'table', 't' || i, 't' || i, 2, "
        "'CREATE TABLE t' || i || '(a)' FROM (WITH RECURSIVE n(i) AS "
        "(SELECT 0 UNION ALL SELECT i + 1 FROM n LIMIT 300000) SELECT i FROM n)"
    )
    connection.commit()
    connection.close()
    started = time.monotonic()
    with pytest.raises(InputFileError, match="more work than any pyramid file needs"):
        read_summary(tmp_path / "a.gpkg")
    assert time.monotonic() - started < 10
