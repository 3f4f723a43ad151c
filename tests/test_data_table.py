"""The page of the real data says what becomes of each file, now as when it was written."""

import importlib.util
import os
import sys
import tempfile
from pathlib import Path

import pytest

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
@pytest.mark.parametrize("size", [60_000, pytest.param(None, marks=pytest.mark.large)])
def test_the_page_tells_what_happens(data_folder, size):
    """Small files by default; all that do not take minutes when asked for."""
    n_tried = 0
    for path in data_table.files(data_folder):
        limit = data_table.LARGE_FILE if size is None else size
        if path.stat().st_size < limit:
            row_of(path, data_folder)
            n_tried += 1
    assert n_tried > 60


#: Larger ones come back in tests/gis/io/test_round_trip.py, and here where the variable is set.
HUGE_FILE = 3_000_000
HUGE_VARIABLE = "TERRAIN_WAVELETS_HUGE_FILES"


@pytest.mark.data
@pytest.mark.large
def test_the_page_tells_what_happens_to_large_files(data_folder):
    limit = sys.maxsize if os.environ.get(HUGE_VARIABLE) else HUGE_FILE
    for path in data_table.files(data_folder):
        if data_table.is_large(path) and path.stat().st_size < limit:
            row_of(path, data_folder)
