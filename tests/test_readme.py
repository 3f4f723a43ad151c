"""What the README shows works: its Python blocks run, its commands and files exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text("utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


@pytest.mark.parametrize("block", blocks("python"))
def test_python_blocks_run(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "README.md", "exec"), {})


def test_there_is_a_python_block():
    assert blocks("python")


def test_commands_are_those_of_the_program():
    from wavelet_gis import commands

    folder = Path(commands.__file__).parent
    known = {path.stem for path in folder.glob("[!_]*.py")}
    lines = "\n".join(blocks("sh"))
    used = set(re.findall(r"terrain-wavelets (\w+)", lines))
    assert used
    assert used <= known, f"no such command: {used - known}"


def test_linked_files_exist():
    links = re.findall(r"\]\((?!https?:)([^)#]+)", README)
    assert links
    missing = [link for link in links if not (ROOT / link).exists()]
    assert missing == []
