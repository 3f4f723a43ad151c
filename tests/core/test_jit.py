"""Kernels with numba, and without it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavelet_core
from wavelet_core import OptionError, SlowFallbackWarning
from wavelet_core._kernels import _jit
from wavelet_core._validate import distinct
from wavelet_core.errors import Cancelled
from wavelet_core.progress import watched

PACKAGE = Path(wavelet_core.__file__).parent


def run_python(code, folder, **environment):
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


@pytest.mark.skipif(not _jit.HAS_NUMBA, reason="compiles kernels, and numba is off")
def test_compiled_code_lies_where_no_other_version_of_numba_looks(tmp_path):
    """QGIS brings its own numba: it read code of another one, between its index and its code."""
    package = tmp_path / "wavelet_core"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    code = (
        "import numba, numpy as np\n"
        "from wavelet_core._kernels import _jit\n"
        "from wavelet_core.metrics import surface_errors\n"
        "from wavelet_core import synthetic\n"
        "with _jit.engine('compiled'):\n"
        "    surface_errors(synthetic.hills(9, 9), np.zeros((3, 3)))\n"
        "print(numba.__version__)"
    )
    version = run_python(code, tmp_path)
    made = [path.name for path in package.rglob("*.nb[ic]")]
    assert len(made) > 1
    assert all(f"-numba{version}." in name for name in made), made


@pytest.mark.skipif(not _jit.HAS_NUMBA, reason="compiles kernels, and numba is off")
def test_a_change_in_one_kernel_file_voids_the_compiled_code_of_the_others(tmp_path):
    """Numba looks at the caller's file alone; a stale callee would go on working, wrongly."""
    package = tmp_path / "wavelet_core"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    kernels = package / "_kernels"
    head = "from ._jit import njit\n"
    (kernels / "outer.py").write_text(
        f"{head}from .inner import inner\n@njit\ndef outer(x):\n    return inner(x)\n"
    )
    code = "from wavelet_core._kernels.outer import outer; print(outer(1.0))"
    for factor in (2, 3):
        (kernels / "inner.py").write_text(f"{head}@njit\ndef inner(x):\n    return {factor} * x\n")
        for _ in range(2):  # compiled, then from the cache
            assert run_python(code, tmp_path, NUMBA_CACHE_DIR="") == f"{factor}.0"


@pytest.mark.skipif(not _jit.HAS_NUMBA, reason="compiles kernels, and numba is off")
def test_a_cache_that_names_a_class_that_has_gone_is_void(tmp_path):
    """After an update that renamed a NamedTuple, kernels that took it raised AttributeError."""
    package = tmp_path / "wavelet_core"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Former", "Present"):
        (package / "_kernels" / "renamed.py").write_text(
            f"from typing import NamedTuple\nfrom ._jit import njit\n"
            f"class {name}(NamedTuple):\n    x: float\n"
            f"@njit\ndef read(pair):\n    return pair.x\n"
        )
        code = f"from wavelet_core._kernels.renamed import {name}, read; print(read({name}(2.0)))"
        for _ in range(2):  # compiled, then from the cache
            assert run_python(code, tmp_path, NUMBA_CACHE_DIR="") == "2.0"


def test_without_numba_one_warning_says_so_of_an_input_of_some_size():
    code = (
        "import warnings; from wavelet_core import analyse, synthetic\n"
        "from wavelet_core._kernels import _jit\n"
        "with warnings.catch_warnings(record=True) as caught:\n"
        "    warnings.simplefilter('always')\n"
        "    analyse(synthetic.hills(5, 5), levels=1)\n"
        "    small = len(caught)\n"
        "    _jit.ANNOUNCED_FROM = 20\n"
        "    for _ in range(2): analyse(synthetic.hills(5, 5), levels=1)\n"
        "print(small, [(w.category.__name__, str(w.message)) for w in caught])"
    )
    told = run_python(code, PACKAGE.parent, TERRAIN_WAVELETS_NO_NUMBA="1")
    assert told.startswith("0 ")
    assert told.count("SlowFallbackWarning") == 1
    assert "pip install numba" in told
    assert run_python(code, PACKAGE.parent, TERRAIN_WAVELETS_NO_NUMBA="") == "0 []"


def test_without_numba_no_size_is_refused():
    """Above 50,000 vertices it used to be: a DEM of 224 x 224 cells is no terrain."""
    code = (
        "from wavelet_core import analyse, synthetic\n"
        "print(analyse(synthetic.hills(230, 230), levels=1).n_levels)"
    )
    assert run_python(code, PACKAGE.parent, TERRAIN_WAVELETS_NO_NUMBA="1") == "1"


def test_the_warning_is_a_user_warning():
    assert issubclass(SlowFallbackWarning, UserWarning)


@pytest.mark.parametrize("n", [10, 10_000])
def test_a_kernel_runs_over_ranges_like_over_the_whole(n, monkeypatch):
    monkeypatch.setenv("TERRAIN_WAVELETS_THREADS", "3")
    covered = np.zeros(n, dtype=np.int64)
    _jit.run_in_ranges(counting, n, covered)
    assert (covered == 1).all()


@pytest.mark.parametrize("wish", ["0", "-2", "four", "1.5", "²"])
def test_a_wish_that_is_no_number_of_threads_is_refused(wish, monkeypatch):
    """All cores were taken instead, in silence."""
    monkeypatch.setenv("TERRAIN_WAVELETS_THREADS", wish)
    with pytest.raises(OptionError, match="give a whole number of 1 or more") as caught:
        _jit.n_threads()
    assert "TERRAIN_WAVELETS_THREADS" in str(caught.value)


@pytest.mark.parametrize(("wish", "n"), [("3", 3), (" 2 ", 2), ("", os.cpu_count())])
def test_the_number_of_threads_is_that_of_the_environment_or_of_the_cores(wish, n, monkeypatch):
    monkeypatch.setenv("TERRAIN_WAVELETS_THREADS", wish)
    assert _jit.n_threads() == n


@_jit.kernel
def counting(start, stop, covered):
    for k in range(start, stop):
        covered[k] += 1


@pytest.mark.skipif(not _jit.HAS_NUMBA, reason="is about compiled kernels")
@pytest.mark.parametrize("threads", ["1", "2"])
def test_a_compiled_step_reports_while_it_runs_and_stops_when_it_is_told(monkeypatch, threads):
    """The button was not looked at for 5.6 s while the faces of two million points were written."""
    monkeypatch.setenv("TERRAIN_WAVELETS_THREADS", threads)
    n = 1 << 20
    covered = np.zeros(n, dtype=np.int64)
    shares = []
    with _jit.engine("compiled"), watched(shares.append):
        _jit.run_in_ranges(counting, n, covered)
    assert (covered == 1).all()
    assert len(shares) >= 8
    assert shares == sorted(shares)
    assert shares[-1] == 1.0

    def stop(share):
        if share > 0.2:
            raise Cancelled("told to")

    with _jit.engine("compiled"), watched(stop), pytest.raises(Cancelled, match="told to"):
        _jit.run_in_ranges(counting, n, covered)


@given(st.lists(st.integers(-(2**62), 2**62), max_size=30), st.booleans())
def test_the_different_values_of_an_array_are_those_of_numpy(values, is_table):
    array = np.array(values + values[:3] + [0], dtype=np.int64)
    array = np.stack([array, array]) if is_table else array
    assert distinct(array).tolist() == np.unique(array).tolist()
    assert distinct(array).dtype == array.dtype
