"""An output appears whole or not at all."""

import os
import subprocess
import sys
import tempfile

import pytest

from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.atomic import check_output, new_file


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def fail_half_way(path, error, **options):
    with new_file(path, **options) as scratch:
        scratch.write_text("half")
        raise error


def finish(path, text, companion=None, meanwhile=lambda: None, **options):
    with new_file(path, **options) as scratch:
        scratch.write_text(text)
        if companion:
            scratch.with_name(companion).write_text(text)
        meanwhile()


def test_the_file_and_its_companions_appear_at_the_end(tmp_path):
    seen = []
    finish(tmp_path / "a.2dm", "mesh", "a.prj", lambda: seen.extend(names_in(tmp_path)))
    assert "a.2dm" not in seen
    assert names_in(tmp_path) == ["a.2dm", "a.prj"]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit])
def test_nothing_is_left_of_what_failed(tmp_path, error):
    with pytest.raises(error):
        fail_half_way(tmp_path / "a.txt", error)
    assert names_in(tmp_path) == []


def test_an_old_file_stays_until_the_new_one_is_whole(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(ZeroDivisionError):
        fail_half_way(tmp_path / "a.txt", ZeroDivisionError, overwrite=True)
    assert (tmp_path / "a.txt").read_text() == "old"
    finish(tmp_path / "a.txt", "new", overwrite=True)
    assert (tmp_path / "a.txt").read_text() == "new"
    assert names_in(tmp_path) == ["a.txt"]


def test_what_exists_is_kept(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(OutputFileError, match=r"exists.*overwrite"):
        finish(tmp_path / "a.txt", "new")
    assert (tmp_path / "a.txt").read_text() == "old"


def test_what_appears_meanwhile_is_kept(tmp_path):
    def somebody_else():
        (tmp_path / "a.txt").write_text("theirs")

    with pytest.raises(OutputFileError, match="exists"):
        finish(tmp_path / "a.txt", "ours", meanwhile=somebody_else)
    assert (tmp_path / "a.txt").read_text() == "theirs"


def test_a_companion_of_something_else_is_kept(tmp_path):
    (tmp_path / "a.prj").write_text("theirs")
    with pytest.raises(OutputFileError, match=r"a\.prj"):
        finish(tmp_path / "a.2dm", "ours", "a.prj")
    assert names_in(tmp_path) == ["a.prj"]
    assert (tmp_path / "a.prj").read_text() == "theirs"


def test_a_writer_that_writes_nothing_is_told_of(tmp_path):
    with pytest.raises(OutputFileError, match="no file"), new_file(tmp_path / "a.txt"):
        pass


def test_places_that_no_file_can_have(tmp_path):
    (tmp_path / "a.txt").write_text("input")
    (tmp_path / "link.txt").symlink_to(tmp_path / "a.txt")
    for path, options, what in [
        (tmp_path, {}, "folder"),
        (tmp_path / "none" / "a.txt", {}, "no such folder"),
        (tmp_path / "a.tif", {"suffixes": (".gpkg",)}, r"must end in \.gpkg"),
        (tmp_path / "link.txt", {"overwrite": True, "inputs": [tmp_path / "a.txt"]}, "the input"),
        ("/proc/a.txt", {}, "cannot be written"),
    ]:
        with pytest.raises(OutputFileError, match=what):
            check_output(path, **options)
    assert check_output(tmp_path / "B.GPKG", suffixes=(".gpkg",)).name == "B.GPKG"


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
def test_a_folder_without_permission():
    # For root every folder is open, so the question is asked as nobody.
    code = (
        "import os, sys\n"
        "from wavelet_gis.io.atomic import check_output\n"
        "from wavelet_gis.errors import OutputFileError\n"
        "if os.geteuid() == 0: os.setuid(65534)\n"
        "try: check_output(sys.argv[1])\n"
        "except OutputFileError as error: print(error)\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o555)
        result = subprocess.run(
            [sys.executable, "-c", code, f"{folder}/a.txt"], capture_output=True, text=True
        )
    assert "cannot be written" in result.stdout, result.stderr
