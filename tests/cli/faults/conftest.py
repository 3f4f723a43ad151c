"""Inputs of bug reports, each in a folder of its own."""

import shutil

import pytest


@pytest.fixture
def found(data_folder, tmp_path, monkeypatch):
    """Return a function that goes into a copy of a folder of inputs."""

    def enter(name):
        folder = tmp_path / "found"
        shutil.copytree(data_folder / "found" / name, folder)
        monkeypatch.chdir(folder)
        return folder

    return enter
