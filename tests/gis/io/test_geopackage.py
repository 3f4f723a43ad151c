"""The GeoPackage itself: valid without layers, styles added, strangers opened with care."""

import sqlite3

import pytest

from wavelet_gis.errors import InputFileError
from wavelet_gis.io.geopackage import create_geopackage, open_stranger, table_names, write_styles


def test_an_empty_one_is_valid(tmp_path, validate_gpkg):
    create_geopackage(tmp_path / "a.gpkg")
    validate_gpkg(tmp_path / "a.gpkg")


def test_styles_are_added_to_those_there(tmp_path, validate_gpkg):
    create_geopackage(tmp_path / "a.gpkg")
    write_styles(tmp_path / "a.gpkg", [("one", "One", "<qgis/>", "first")])
    write_styles(tmp_path / "a.gpkg", [("two", "Two", "<qgis/>", "second")])
    with sqlite3.connect(tmp_path / "a.gpkg") as connection:
        rows = connection.execute("SELECT f_table_name, styleName FROM layer_styles").fetchall()
    assert rows == [("one", "One"), ("two", "Two")]
    validate_gpkg(tmp_path / "a.gpkg")


def test_a_stranger_is_opened_for_reading_only(raster_pyramid):
    with (
        pytest.raises(InputFileError, match="readonly"),
        open_stranger(raster_pyramid) as connection,
    ):
        connection.execute("DELETE FROM wavelet_metadata")


def test_names_with_signs_that_urls_give_a_meaning(tmp_path):
    for name in ("a b.gpkg", "a%20b.gpkg", "ä?mode=rwc.gpkg", "c#d.gpkg"):
        create_geopackage(tmp_path / name)
        with open_stranger(tmp_path / name) as connection:
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
        with pytest.raises(InputFileError, match=what), open_stranger(path):
            pytest.fail("the block must not begin")
