"""Inputs of bug reports that belong to no one kind of file, and that each of them has its test."""

import sqlite3
from pathlib import Path

import pytest
import rasterio

pytestmark = pytest.mark.data

TESTS = Path(__file__).resolve().parents[2]


def test_every_folder_has_a_test_that_names_it(data_folder):
    texts = [path.read_text("utf-8") for path in TESTS.rglob("test_*.py")]
    folders = [path.name for path in (data_folder / "found").iterdir() if path.is_dir()]
    assert len(folders) > 10
    assert [name for name in folders if not any(f'"{name}"' in text for text in texts)] == []


def test_what_analyse_writes_is_read_with_scattered_holes(found, done):
    found("unreadable-own-pyramid")
    done("analyse", "holes15.tif", "p.gpkg")
    assert "kept to the last bit" in done("info", "p.gpkg").out
    done("reconstruct", "p.gpkg", "back.tif")
    with rasterio.open("holes15.tif") as before, rasterio.open("back.tif") as after:
        assert before.read(1).tobytes() == after.read(1).tobytes()
        assert (before.read_masks(1) == after.read_masks(1)).all()


def test_a_locked_file_is_called_locked(found, command, done):
    found("locked-message")
    done("analyse", "iso.tif", "p.gpkg", "--levels", 1, "--layers", "none")
    other = sqlite3.connect("p.gpkg", isolation_level=None)
    other.execute("BEGIN EXCLUSIVE")
    try:
        outcomes = [
            command("info", "p.gpkg"),
            command("analyse", "p.gpkg", "q.gpkg"),
            command("simplify", "p.gpkg", "q.ply", "--vertices", 50),
        ]
    finally:
        other.close()
    for outcome in outcomes:
        assert outcome.code == 1
        assert "another program holds the file locked" in outcome.err
        assert "damaged" not in outcome.err
    done("info", "p.gpkg")
