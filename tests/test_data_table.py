"""The page of the real data says what becomes of each file, now as when it was written."""

import importlib.util
import os
import sys
import tempfile
from pathlib import Path

import pytest
from conftest import DATA

ROOT = Path(__file__).resolve().parent.parent

spec = importlib.util.spec_from_file_location("data_table", ROOT / "scripts" / "data_table.py")
data_table = importlib.util.module_from_spec(spec)
spec.loader.exec_module(data_table)


def row_of(path, data):
    name, happened, why = data_table.row(path, data)
    assert "CHANGED" not in happened
    assert data_table.known_rows().get(name) == (name, happened, why)


@pytest.mark.data
def test_every_file_has_its_row(data_folder):
    names = [path.relative_to(data_folder).as_posix() for path in data_table.files(data_folder)]
    known = list(data_table.known_rows())
    assert known == [name for name in names if name in known]
    missing = [name for name in names if name not in known]
    assert all(data_table.is_large(data_folder / name) for name in missing)
    assert len(known) > 100


@pytest.mark.data
@pytest.mark.large
def test_every_large_file_has_its_row(data_folder):
    names = [path.relative_to(data_folder).as_posix() for path in data_table.files(data_folder)]
    assert list(data_table.known_rows()) == names, "run scripts/data_table.py --only MISSING"


def test_the_page_names_no_path_of_a_machine():
    text = data_table.PAGE.read_text("utf-8")
    folders = (ROOT.parent, Path.home(), Path(tempfile.gettempdir()))
    assert not [folder for folder in folders if f"{folder}{os.sep}" in text]
    assert text.startswith(data_table.HEAD)
    assert all(why for _, _, why in data_table.known_rows().values())


@pytest.mark.data
@pytest.mark.parametrize(
    ("least", "limit"),
    [(0, 60_000), pytest.param(60_000, data_table.LARGE_FILE, marks=pytest.mark.large)],
)
def test_the_page_tells_what_happens(data_folder, least, limit):
    n_tried = 0
    for path in data_table.files(data_folder):
        if least <= path.stat().st_size < limit:
            row_of(path, data_folder)
            n_tried += 1
    assert n_tried > (60 if least == 0 else 20)


#: Larger ones, and those of most cells, come back in tests/gis/io/test_round_trip.py, and here
#: where the variable is set.
HUGE_FILE = 3_000_000
OF_MOST_CELLS = {"srtm1_N48W125_4326.tif", "srtm1_N48W125_utm10_30m.tif"}
HUGE_VARIABLE = "TERRAIN_WAVELETS_HUGE_FILES"


def large_files():
    """Return the large files that are tried, one for each test."""
    is_whole = bool(os.environ.get(HUGE_VARIABLE))
    limit, left_out = (sys.maxsize, set()) if is_whole else (HUGE_FILE, OF_MOST_CELLS)
    found = data_table.files(DATA) if DATA.is_dir() else []
    return [
        pytest.param(path, id=path.name)
        for path in found
        if data_table.is_large(path) and path.stat().st_size < limit and path.name not in left_out
    ] or [pytest.param(None, id="absent")]


@pytest.mark.data
@pytest.mark.large
@pytest.mark.parametrize("path", large_files())
def test_the_page_tells_what_happens_to_large_files(data_folder, path):
    row_of(path, data_folder)
