"""An output appears whole or not at all."""

import os
import subprocess
import sys
import tempfile

import pytest

from wavelet_core import Cancelled
from wavelet_gis.errors import CrsWarning, OutputFileError, TerrainWarning
from wavelet_gis.io.atomic import check_output, ensure_folder, new_file, new_folder
from wavelet_gis.io.read_back import read_back, write_text


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def fail_half_way(path, error, **options):
    with new_file(path, **options) as scratch:
        scratch.write_text("half")
        raise error


def finish(path, text, companion=None, meanwhile=lambda: None, **options):
    with new_file(path, **options) as scratch:
        write_text(scratch, text)
        if companion:
            scratch.with_name(scratch.stem + companion).write_text(text)
        meanwhile()


def test_the_file_and_its_companions_appear_at_the_end(tmp_path):
    seen = []
    finish(tmp_path / "a.2dm", "mesh", ".prj", lambda: seen.extend(names_in(tmp_path)))
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
    with pytest.warns(CrsWarning, match=r"a\.prj belongs to another file"):
        finish(tmp_path / "a.2dm", "ours", ".prj")
    assert (tmp_path / "a.2dm").read_text() == "ours"
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
        "from wavelet_gis.errors import CrsWarning, OutputFileError, TerrainWarning\n"
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


def test_a_writer_that_cannot_be_checked_is_told_of(tmp_path):
    with pytest.raises(OutputFileError, match="no way to check"), new_file(tmp_path / "a") as a:
        a.write_text("unchecked")
    assert names_in(tmp_path) == []


@pytest.mark.parametrize("damage", [lambda b: b[:-1], lambda b: b"", lambda b: b[:-1] + b"?"])
def test_what_does_not_read_back_replaces_nothing(tmp_path, damage):
    (tmp_path / "a.txt").write_text("old")

    def write():
        with new_file(tmp_path / "a.txt", overwrite=True) as scratch:
            write_text(scratch, "new and whole")
            scratch.write_bytes(damage(scratch.read_bytes()))

    with pytest.raises(OutputFileError, match="does not read back"):
        write()
    assert (tmp_path / "a.txt").read_text() == "old"
    assert names_in(tmp_path) == ["a.txt"]


def test_errors_name_the_file_and_not_the_scratch(tmp_path):
    def write():
        with new_file(tmp_path / "a!b.txt") as scratch:
            assert scratch.name == "out.txt"
            raise ValueError(f"{scratch}: bad")

    with pytest.raises(ValueError, match=r"a!b\.txt: bad") as caught:
        write()
    assert "out.txt" not in str(caught.value)


def test_a_link_is_written_through_and_stays(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to("there/real.txt")
    finish(tmp_path / "link.txt", "new", overwrite=True)
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "there" / "real.txt").read_text() == "new"
    assert names_in(tmp_path / "there") == ["real.txt"]


def test_a_link_to_nothing_needs_leave(tmp_path):
    (tmp_path / "link.txt").symlink_to("absent.txt")
    with pytest.raises(OutputFileError, match="not there"):
        finish(tmp_path / "link.txt", "new")
    finish(tmp_path / "link.txt", "new", overwrite=True)
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "absent.txt").read_text() == "new"
    (tmp_path / "loop.txt").symlink_to("loop.txt")
    with pytest.raises(OutputFileError):
        finish(tmp_path / "loop.txt", "new", overwrite=True)


@pytest.mark.skipif(os.name != "posix", reason="modes and owners of POSIX")
def test_a_replaced_file_keeps_mode_and_owner(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    path.chmod(0o640)
    if os.geteuid() == 0:
        os.chown(path, 1234, 4321)
    before = path.stat()
    finish(path, "new", overwrite=True)
    after = path.stat()
    assert path.read_text() == "new"
    assert (after.st_mode, after.st_uid, after.st_gid) == (
        before.st_mode,
        before.st_uid,
        before.st_gid,
    )


def test_a_device_is_no_output():
    with pytest.raises(OutputFileError, match="device"):
        check_output(os.devnull, overwrite=True)


@pytest.mark.skipif(os.name != "posix", reason="a lock on a folder is one of POSIX")
def test_what_killed_runs_left_is_swept_after_a_day(tmp_path):
    code = (
        "import os, sys\n"
        "from wavelet_gis.io.atomic import new_file\n"
        "with new_file(sys.argv[1]) as scratch:\n"
        "    scratch.write_text('half')\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    subprocess.run([sys.executable, "-c", code, tmp_path / "a.txt"], check=False)
    (remains,) = tmp_path.iterdir()
    finish(tmp_path / "b.txt", "today")
    assert remains.exists(), "it may belong to a run on another machine"
    long_ago = remains.stat().st_mtime - 200_000
    for path in (*remains.iterdir(), remains):
        os.utime(path, (long_ago, long_ago))
    with pytest.warns(TerrainWarning, match="1 earlier run"):
        finish(tmp_path / "c.txt", "tomorrow")
    with new_file(tmp_path / "held.txt") as scratch:
        write_text(scratch, "in use")
        os.utime(scratch, (long_ago, long_ago))
        os.utime(scratch.parent, (long_ago, long_ago))
        finish(tmp_path / "c.txt", "later", overwrite=True)
        assert scratch.exists()
    assert names_in(tmp_path) == ["b.txt", "c.txt", "held.txt"]


def test_errors_in_the_words_of_a_flag_name_the_file_too(tmp_path):
    def write():
        with new_file(tmp_path / "a.txt") as scratch:
            raise OutputFileError("{path}: refused; leave {0} out", "cog", path=scratch)

    with pytest.raises(OutputFileError) as caught:
        write()
    told = caught.value.in_words(lambda name: f"--{name}")
    assert told == f"{tmp_path / 'a.txt'}: refused; leave --cog out"


def test_a_check_may_be_stopped(tmp_path):
    def stop(path):
        raise Cancelled("stopped")

    def write():
        with new_file(tmp_path / "a.txt") as scratch:
            write_text(scratch, "whole")
            read_back(scratch, stop)

    with pytest.raises(Cancelled):
        write()
    assert names_in(tmp_path) == []


def finish_folder(path, text, **options):
    with new_folder(path, "index.txt", **options) as scratch:
        (scratch / "below").mkdir()
        write_text(scratch / "below" / "a.txt", text)
        write_text(scratch / "index.txt", text)


@pytest.mark.parametrize("damage", [lambda b: b[:-1], lambda b: b"", lambda b: b[:-1] + b"?"])
def test_a_folder_with_a_file_that_does_not_read_back_replaces_nothing(tmp_path, damage):
    """Nothing was read back there, so that a full disk could lose tiles without a word."""
    finish_folder(tmp_path / "out", "old")

    def write():
        with new_folder(tmp_path / "out", "index.txt", overwrite=True) as scratch:
            (scratch / "below").mkdir()
            file = scratch / "below" / "a.txt"
            write_text(file, "new and whole")
            write_text(scratch / "index.txt", "new")
            file.write_bytes(damage(file.read_bytes()))

    with pytest.raises(OutputFileError, match=r"out/below/a\.txt: what was written does not read"):
        write()
    assert (tmp_path / "out" / "below" / "a.txt").read_text() == "old"
    assert names_in(tmp_path) == ["out"]


def test_a_folder_with_a_file_that_cannot_be_checked_is_refused(tmp_path):
    def write():
        with new_folder(tmp_path / "out", "index.txt") as scratch:
            (scratch / "index.txt").write_text("unchecked")

    with pytest.raises(OutputFileError, match=r"index\.txt: the writer gave no way to check"):
        write()
    assert names_in(tmp_path) == []


def test_all_of_a_folder_is_synced_before_it_takes_its_place(tmp_path, monkeypatch):
    synced = []
    sync, replace = os.fsync, os.replace

    def noted(descriptor):
        synced.append(os.fstat(descriptor).st_ino)
        sync(descriptor)

    def moved(source, destination):
        files = [p for p in (source, *source.rglob("*")) if os.path.isfile(p)]
        assert len(files) == 2
        assert {p.stat().st_ino for p in (source, source / "below", *files)} <= set(synced)
        replace(source, destination)

    monkeypatch.setattr(os, "fsync", noted)
    monkeypatch.setattr(os, "replace", moved)
    finish_folder(tmp_path / "out", "new")
    assert tmp_path.stat().st_ino == synced[-1]


def test_a_link_to_a_folder_is_written_through_and_stays(tmp_path):
    """The link itself was replaced by the folder."""
    (tmp_path / "there").mkdir()
    finish_folder(tmp_path / "there" / "real", "old")
    (tmp_path / "link").symlink_to("there/real")
    with pytest.raises(OutputFileError, match="this folder exists"):
        finish_folder(tmp_path / "link", "new")
    finish_folder(tmp_path / "link", "new", overwrite=True)
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "there" / "real" / "index.txt").read_text() == "new"
    assert names_in(tmp_path / "there") == ["real"]
    (tmp_path / "lost").symlink_to("absent")
    with pytest.raises(OutputFileError, match="a link to absent, which is not there"):
        finish_folder(tmp_path / "lost", "new")
    finish_folder(tmp_path / "lost", "new", overwrite=True)
    assert (tmp_path / "lost").is_symlink()
    assert (tmp_path / "absent" / "below" / "a.txt").read_text() == "new"


@pytest.mark.skipif(os.name != "posix", reason="modes and owners of POSIX")
def test_a_replaced_folder_keeps_mode_and_owner(tmp_path):
    path = tmp_path / "out"
    finish_folder(path, "old")
    path.chmod(0o750)
    if os.geteuid() == 0:
        os.chown(path, 1234, 4321)
    before = path.stat()
    finish_folder(path, "new", overwrite=True)
    after = path.stat()
    assert (path / "index.txt").read_text() == "new"
    assert (after.st_mode, after.st_uid, after.st_gid) == (
        before.st_mode,
        before.st_uid,
        before.st_gid,
    )


def test_folders_that_files_are_added_to(tmp_path):
    (tmp_path / "link").symlink_to("absent")
    with pytest.raises(OutputFileError, match="a link to absent, which is not there"):
        ensure_folder(tmp_path / "link")
    (tmp_path / "absent").mkdir()
    assert ensure_folder(tmp_path / "link") == tmp_path / "link"
    (tmp_path / "file").write_text("a")
    with pytest.raises(OutputFileError, match="this is a file"):
        ensure_folder(tmp_path / "file")
    with pytest.raises(OutputFileError, match="no such folder"):
        ensure_folder(tmp_path / "no" / "where")
    assert ensure_folder(tmp_path / "new").is_dir()
