"""Work that will not fit is refused before it begins, with the figures."""

import subprocess
import sys

import numpy as np
import pytest

from wavelet_gis import _memory
from wavelet_gis.errors import InputFileError


def test_what_does_not_fit_is_refused_with_the_figures():
    with pytest.raises(
        InputFileError, match=r"100,000,000 .* 40\.0 GB .* 8\.0 GB are free; .*tiles"
    ):
        _memory.require_memory(100_000_000, 1, available=8_000_000_000)


def test_what_fits_and_what_is_small_is_not():
    _memory.require_memory(10_000_000, 1, available=8_000_000_000)
    _memory.require_memory(500_000, 30, available=1000)


def test_channels_take_memory():
    assert _memory.analysis_bytes(10, 4) > _memory.analysis_bytes(10, 1)


def test_this_system_says_what_there_is():
    free = _memory.available_bytes()
    assert free is None or 10**6 < free < 10**14


def test_an_analysis_asks_first(monkeypatch, tif):
    import wavelet_gis as wg

    terrain = wg.open(tif)
    monkeypatch.setattr(_memory, "SMALL_INPUT", 10)
    monkeypatch.setattr(_memory, "available_bytes", lambda: 1000)
    for work in (lambda: wg.analyse(terrain), lambda: wg.simplify(terrain, vertices=100)):
        with pytest.raises(InputFileError, match="takes some"):
            work()
    assert np.isfinite(terrain.mesh.vertices).all()


def group(folder, limit, used, cached=0):
    """Write what the system says of a control group."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "memory.max").write_text(f"{limit}\n")
    (folder / "memory.current").write_text(f"{used}\n")
    (folder / "memory.stat").write_text(f"anon 7\ninactive_file {cached}\nactive_file 5\n")


def test_files_that_are_cached_are_no_memory_in_use(tmp_path):
    """A container that had read large files had no memory left, and refused every large input."""
    group(tmp_path, 8_000, 7_900, cached=6_000)
    assert _memory._of_group(tmp_path, "/") == 6_100
    (tmp_path / "memory.stat").unlink()
    assert _memory._of_group(tmp_path, "/") == 100


def test_a_group_has_no_more_than_those_around_it(tmp_path):
    """Only its own limit counted, and that of the root."""
    group(tmp_path / "user" / "job", "max", 300)
    group(tmp_path / "user", 5_000, 1_000)
    assert _memory._of_group(tmp_path, "/user/job") == 4_000
    group(tmp_path / "user" / "job", 900, 300)
    assert _memory._of_group(tmp_path, "/user/job") == 600
    assert _memory._of_group(tmp_path / "none", "/user/job") is None


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_addresses_in_use_are_not_free():
    """The limit of ``ulimit -v`` was taken for what is left of it."""
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30));"
        "taken = bytearray(3 << 30); from wavelet_gis import _memory; print(_memory._of_process())"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert 1 << 30 < int(said.stdout) < 5 << 30


def old_group(folder, limit, used, cached=0):
    """Write what the system says of a control group of version 1."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "memory.limit_in_bytes").write_text(f"{limit}\n")
    (folder / "memory.usage_in_bytes").write_text(f"{used}\n")
    (folder / "memory.stat").write_text(f"cache 9\ninactive_file 1\ntotal_inactive_file {cached}\n")


def test_groups_of_the_first_version_have_limits_too(tmp_path):
    """They were not read: a container under such a system was killed instead of refusing."""
    old_group(tmp_path, 9_223_372_036_854_771_712, 10**9)
    old_group(tmp_path / "docker" / "one", 8_000, 7_900, cached=6_000)
    assert _memory._of_old_group(tmp_path, "/docker/one") == 6_100
    assert _memory._of_old_group(tmp_path, "/docker") > 10**18
    assert _memory._of_old_group(tmp_path / "none", "/docker") is None


def test_the_group_of_a_process_is_that_of_the_version(tmp_path):
    listed = tmp_path / "cgroup"
    listed.write_text("12:cpu,cpuacct:/a\n9:memory:/docker/one\n1:name=systemd:/b\n0::/user/x:y\n")
    assert _memory._own_group("memory", listed) == "/docker/one"
    assert _memory._own_group("", listed) == "/user/x:y"
    listed.write_text("0::/user\n")
    assert _memory._own_group("memory", listed) == ""
    assert _memory._own_group("memory", tmp_path / "none") == ""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="is about the GNU C library")
def test_freed_memory_is_kept_until_it_is_given_back():
    program = """
import ctypes, numpy as np, psutil
from wavelet_gis import _allocator

def resident():
    return psutil.Process().memory_info().rss / 1e6

def freed():
    np.ones(100_000_000, np.uint8).fill(1)
    return resident()

assert _allocator._c_library() is not None
resting = freed()
_allocator.give_memory_back()
_allocator.keep_freed_memory()
kept = freed()
_allocator.give_memory_back()
print(kept - resting, resident() - resting)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    kept, left = map(float, done.stdout.split())
    assert kept > 80
    assert left < 20
