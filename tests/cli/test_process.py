"""The command as a process: exit codes, signals, pipes, terminals, and how fast it starts."""

import ctypes
import os
import signal
import subprocess
import sys
import time

import pytest
from gis.samples import hills, write_tif

from wavelet_gis.cli import interrupts

START = [sys.executable, "-m", "wavelet_gis.cli"]


def test_help_and_usage(process):
    said = process("--help")
    assert said.returncode == 0
    for name in ("analyse", "info", "extract", "reconstruct"):
        assert name in said.stdout
        said_by_it = process(name, "--help")
        assert said_by_it.returncode == 0
        assert "--quiet" in said_by_it.stdout
        assert "--json" in said_by_it.stdout
    assert process("--version").stdout.startswith("terrain-wavelets ")
    for usage in ([], ["dance"], ["analyse"], ["analyse", "a", "b", "--levels", "x"]):
        said = process(*usage)
        assert said.returncode == 2
        assert "usage:" in said.stderr


def test_help_imports_nothing_heavy(process):
    code = (
        "import sys; from wavelet_gis.cli.main import main; main(['--help']);"
        "heavy = {'numpy', 'scipy', 'numba', 'rasterio', 'pyogrio', 'laspy', 'tqdm'};"
        "print('HEAVY', sorted(heavy & set(sys.modules)))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "HEAVY []" in said.stdout


def test_a_refusal_in_a_process_of_its_own(process, tmp_path):
    said = process("analyse", tmp_path / "none.tif", tmp_path / "a.gpkg")
    assert said.returncode == 1
    assert said.stdout == ""
    assert said.stderr.count("\n") == 1


def test_no_progress_bar_in_a_pipe(process, tif, tmp_path):
    said = process("analyse", tif, tmp_path / "a.gpkg", "--levels", 2)
    assert said.returncode == 0
    assert said.stderr == ""


@pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals of POSIX")
@pytest.mark.parametrize("quiet", [False, True])
def test_a_progress_bar_on_a_terminal(tif, tmp_path, quiet):
    import fcntl
    import pty
    import struct
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    options = ["--quiet"] if quiet else []
    command = [*START, "analyse", str(tif), str(tmp_path / "a.gpkg"), *options]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    shown = b""
    while True:
        try:
            block = os.read(ours, 4096)
        except OSError:  # the other side is closed
            break
        shown += block
        if not block:
            break
    os.close(ours)
    assert process.wait(timeout=60) == 0
    assert (b"%|" in shown) != quiet


def heed_interrupts():
    """Undo in the child what a shell does to its background jobs, such as a run of these tests."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def ignore_interrupts():
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def start(*arguments, in_child=heed_interrupts):
    return subprocess.Popen(
        [*START, *map(str, arguments)],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=in_child,
    )


def start_long_work(tmp_path):
    """Start an analysis that takes long enough to be stopped, and wait until it is at it."""
    source = write_tif(tmp_path / "large.tif", hills(700, 700).astype("f4"))
    output = tmp_path / "a.gpkg"
    return start("analyse", source, output, "--design", "NNLSMN"), output


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("number", "code", "what"),
    [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")],
)
def test_a_signal_stops_it_and_leaves_nothing(tmp_path, number, code, what):
    process, output = start_long_work(tmp_path)
    time.sleep(4)
    assert process.poll() is None, "the work was done too soon to be stopped"
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == code
    assert what in err
    assert err.count("\n") == 1
    assert not output.exists()
    assert [path.name for path in tmp_path.iterdir()] == ["large.tif"]


#: The program, which tells when it has come to its first line: how long Python takes to get there
#: is not ours.
TOLD_START = """
import sys
from wavelet_gis.cli import interrupts
interrupts.quit_at_once()
print("started", flush=True)
from wavelet_gis.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("after", [0.0, 0.01, 0.03, 0.06, 0.1, 0.3, 1.0])
def test_an_interrupt_at_the_start_is_one_line(tmp_path, after):
    source = write_tif(tmp_path / "large.tif", hills(700, 700).astype("f4"))
    arguments = ["analyse", str(source), str(tmp_path / "a.gpkg"), "--design", "NNLSMN"]
    process = subprocess.Popen(
        [sys.executable, "-c", TOLD_START, *arguments],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=heed_interrupts,
    )
    assert process.stdout.readline() == "started\n"
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err == "terrain-wavelets: error: interrupted; nothing was written\n"
    assert list(tmp_path.iterdir()) == [source]


IN_A_CALLBACK = """
import ctypes, os, signal, time
from wavelet_gis.cli.interrupts import {raised}, Raised
callback = ctypes.CFUNCTYPE(None)(lambda: os.kill(os.getpid(), signal.{sent}))
try:
    with Raised():
        callback()
        print("ignored", flush=True)
        time.sleep(30)
except {raised}:
    print("raised")
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize(("sent", "raised"), [("SIGINT", "Interrupted"), ("SIGTERM", "Terminated")])
def test_a_signal_in_a_callback_of_the_compiler_is_not_lost(sent, raised):
    """Python ignores what is raised there; the first run compiles for half a minute."""
    said = subprocess.run(
        [sys.executable, "-c", IN_A_CALLBACK.format(sent=sent, raised=raised)],
        capture_output=True,
        text=True,
        timeout=20,
        check=True,
        preexec_fn=heed_interrupts,
    )
    assert (said.stdout, said.stderr) == ("ignored\nraised\n", "")


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_what_else_is_ignored_is_told_as_ever(monkeypatch):
    heard = []
    monkeypatch.setattr(sys, "unraisablehook", heard.append)
    before = sys.unraisablehook
    with interrupts.Raised():
        ctypes.CFUNCTYPE(None)(lambda: 1 // 0)()
    assert sys.unraisablehook is before
    assert [type(one.exc_value) for one in heard] == [ZeroDivisionError]


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupt_while_modules_load_is_one_line():
    code = (
        "import os, signal, sys\n"
        "from wavelet_gis.cli import interrupts\n"
        "interrupts.quit_at_once()\n"
        "os.kill(os.getpid(), signal.SIGINT)\n"
        "print('still here')"
    )
    said = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, preexec_fn=heed_interrupts
    )
    assert (said.returncode, said.stdout) == (130, "")
    assert said.stderr == "terrain-wavelets: error: interrupted; nothing was written\n"


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupt_that_the_shell_has_ignored_stays_ignored(tif, tmp_path):
    process = start("analyse", tif, tmp_path / "a.gpkg", in_child=ignore_interrupts)
    for _ in range(20):
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    assert (tmp_path / "a.gpkg").exists()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupt_when_the_output_is_in_place_comes_too_late(tif, tmp_path):
    output = tmp_path / "a.gpkg"
    process = start("analyse", tif, output, "--levels", 2)
    while not output.exists():
        assert process.poll() is None
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert "Traceback" not in err
    assert err in ("", f"terrain-wavelets: interrupted after {output} was written\n")
    assert [path.name for path in tmp_path.iterdir()] == ["a.gpkg"]


def test_a_reader_that_goes_away(pyramid):
    command = f"{sys.executable} -m wavelet_gis.cli info '{pyramid}' | head -1"
    said = subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True)
    assert said.stderr == ""
    assert "hills.tif" in said.stdout


def test_an_unforeseen_error_is_one_line_and_a_traceback_on_request(pyramid, monkeypatch, capsys):
    from wavelet_gis.cli.main import main

    def fail(path):
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr("wavelet_gis.io.pyramid.pyramid_file.read_summary", fail)
    assert main(["info", str(pyramid)]) == 1
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "please report" in err
    monkeypatch.setenv("TERRAIN_WAVELETS_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        main(["info", str(pyramid)])


def test_memory_that_runs_out_is_one_line(pyramid, monkeypatch, capsys):
    from wavelet_gis.cli.main import main

    def fail(path):
        raise MemoryError

    monkeypatch.setattr("wavelet_gis.io.pyramid.pyramid_file.read_summary", fail)
    assert main(["info", str(pyramid)]) == 1
    assert "not enough memory" in capsys.readouterr().err


def test_completion_of_commands_options_and_files(process):
    pytest.importorskip("shtab")
    said = process("--print-completion", "bash")
    assert said.returncode == 0
    for word in ("analyse", "--max-error", "_shtab_compgen_files", "--print-completion"):
        assert word in said.stdout
    assert process("--print-completion", "dos").returncode == 2
