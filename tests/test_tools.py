"""The tools that are run apart from the suite: that they run, and that they can find a fault."""

import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).parent / "tools"


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc, limits its own memory")
@pytest.mark.parametrize("kind", ["las", "tif", "mesh"])
def test_mutated_files_are_survived(kind):
    command = [sys.executable, TOOLS / "mutate.py", kind, "--count", "30", "--seed", "7"]
    outcome = subprocess.run(command, capture_output=True, text=True)
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert outcome.stdout.startswith("30 files of seed 7: ")


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc, limits its own memory")
@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ("os.abort()", "crash"),
        ("raise ValueError('two\\nlines')", "traceback"),
        ("os.write(2, b'panicked')", "chatter"),
        ("return np.zeros((1, 3))", "silent"),
    ],
)
def test_a_reader_with_a_fault_is_found(tmp_path, body, fault):
    """A copy of the tool whose reader fails on every damaged file."""
    text = (TOOLS / "mutate.py").read_text()
    text = text.replace("parents[2]", f"parents[0] / {str(TOOLS.parents[1])!r}")
    reader = f"def read_las(path):\n    if path.name.startswith('case'):\n        {body}\n"
    reader += "    return np.ones((1, 3))\n\n\n"
    reader += "KINDS = {'las': KINDS['las']._replace(read=read_las)}\n\n\ndef mutated("
    (tmp_path / "mutate.py").write_text(text.replace("def mutated(", reader, 1))
    command = [sys.executable, tmp_path / "mutate.py", "las", "--count", "3", "--seed", "4"]
    outcome = subprocess.run(command, capture_output=True, text=True)
    assert outcome.returncode == 1, outcome.stdout + outcome.stderr
    assert f": {fault} " in outcome.stdout
