"""Notes: collected where the work is run, told in the words of whoever tells them."""

import warnings

import pytest

from wavelet_gis.errors import CrsWarning
from wavelet_gis.notes import Note, collected, note, warn


def test_a_block_inside_another_adds_to_both():
    with collected() as outer:
        note("first", "one")
        with collected() as inner:
            note("second", "two")
        assert [entry.code for entry in inner] == ["second"]
    assert [entry.code for entry in outer] == ["first", "second"]
    note("lost", "nobody collects")
    assert len(outer) == 2


def test_a_warning_is_noted_even_where_python_shows_it_once():
    with collected() as notes, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(2):
            warn(CrsWarning, "crs_missing", "{name}: name it with {0}", "crs", name="{a}.tif")
    assert [entry.text for entry in notes] == ["{a}.tif: name it with crs"] * 2
    assert notes[0].in_words(lambda name: f"--{name}") == "{a}.tif: name it with --crs"
    with pytest.warns(CrsWarning, match="b: name it with crs") as caught:
        warn(CrsWarning, "crs_missing", "{name}: name it with {0}", "crs", name="b")
    assert caught[0].filename == __file__


def test_a_text_out_of_a_file_is_no_template():
    stored = Note("code", "{name} has {n:>3}", (), {"name": "{x}", "n": 2}).to_dict()
    stored["text"] = "{0.__class__} {n:>1000000000}"
    assert Note.from_dict(stored).text == "{0.__class__} {n:>1000000000}"


@pytest.mark.parametrize("key", ["name", "path"])
def test_notes_are_kept_without_folders(key):
    """Those of rasters, which say ``path``, went into pyramid files with it."""
    with collected() as notes:
        note("code", "{" + key + "}: odd", **{key: "/home/somebody/dem.tif"})
    assert notes[0].text == "dem.tif: odd"
