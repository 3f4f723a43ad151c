"""What the README shows works: its Python blocks run, its commands and files exist.

The same for the page on sizes and errors; the other pages' examples are run beside what they show.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PAGES = ("README.md", "docs/topics/surface.md")


def blocks(language, page="README.md"):
    text = (ROOT / page).read_text("utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


@pytest.mark.parametrize("block", [block for page in PAGES for block in blocks("python", page)])
def test_python_blocks_run(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "README.md", "exec"), {})


@pytest.mark.parametrize("page", ["docs/topics/filtering.md", "docs/topics/details.md"])
def test_examples_that_go_on_from_one_another_run(page):
    """The page of filters imported what had moved; later blocks read files."""
    names = {}
    for block in blocks("python", page)[:2]:
        exec(compile(block, page, "exec"), names)


@pytest.mark.parametrize("page", PAGES)
def test_there_is_a_python_block(page):
    assert blocks("python", page)


@pytest.mark.parametrize("page", PAGES)
def test_commands_are_those_of_the_program(page):
    from wavelet_gis.cli import commands

    folder = Path(commands.__file__).parent
    known = {path.stem for path in folder.glob("[!_]*.py")}
    lines = "\n".join(blocks("sh", page))
    used = set(re.findall(r"terrain-wavelets (\w+)", lines))
    assert used
    assert used <= known, f"no such command: {used - known}"


@pytest.mark.parametrize("page", PAGES)
def test_linked_files_exist(page):
    path = ROOT / page
    links = re.findall(r"\]\((?!https?:)([^)#]+)", path.read_text("utf-8"))
    assert links
    missing = [link for link in links if not (path.parent / link).exists()]
    assert missing == []
