"""What the pages of the documentation show works: snippets, notebooks, commands, links."""

import argparse
import re
import shlex
from pathlib import Path

import nbformat
import numpy as np
import pyogrio
import pytest
import shapely
from gis.samples import hills, write_las, write_tif

from wavelet_gis.cli.main import argument_parser, main

ROOT = Path(__file__).resolve().parent.parent
PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (ROOT / "docs").rglob("*.md")
    if not {"_build", "made"} & set(path.relative_to(ROOT / "docs").parts)
)
#: Pages whose blocks of Python go on from one another.
STORIES = ("docs/start/concepts.md", "docs/howto/python.md")
#: Pages whose commands are run, in their order, beside dem.tif and cloud.laz.
RUN = sorted(page for page in PAGES if page.startswith("docs/howto/"))


def blocks(language, page):
    text = (ROOT / page).read_text("utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def command_lines(page):
    """Return the words of each command of the program on a page."""
    lines = "\n".join(blocks("sh", page)).replace("\\\n", " ").splitlines()
    found = [shlex.split(line, comments=True) for line in lines]
    return [words[1:] for words in found if words and words[0] == "terrain-wavelets"]


@pytest.mark.parametrize("page", STORIES)
def test_snippets_that_go_on_from_one_another_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    assert blocks("python", page)
    for block in blocks("python", page):
        exec(compile(block, page, "exec"), names)


@pytest.mark.parametrize("page", ["README.md", *PAGES])
def test_commands_have_the_options_that_are_shown(page):
    parser = argument_parser()
    for words in command_lines(page):
        if words[0].isupper() or words[0].startswith("--"):  # COMMAND, or what prints and ends
            continue
        parser.parse_args(words)  # ends the program where it does not know a word


#: Flags of pip and of the scripts in benchmarks/ that pages name.
OF_OTHERS = {
    "--autzen-points",
    "--readings-points",
    "--resume",
    "--cold",
    "--large",
    "--moves",
    "--no-deps",
    "--only",
    "--output",
    "--page",
    "--peers",
    "--picture",
    "--plot",
    "--read",
    "--real",
    "--system-site-packages",
    "--table",
    "--tree",
    "--user",
}


def flags_of(parser):
    found = set()
    for action in parser._actions:
        found.update(action.option_strings)
        if isinstance(action, argparse._SubParsersAction):
            found = found.union(*map(flags_of, action.choices.values()))
    return found


@pytest.mark.parametrize("page", ["README.md", *PAGES])
def test_flags_in_the_text_are_those_of_a_command(page):
    """A page named --sigma, which no command has."""
    named = set(re.findall(r"`(?:[^`\n]*\s)?(--[a-z][a-z-]+)", (ROOT / page).read_text("utf-8")))
    assert named <= flags_of(argument_parser()) | OF_OTHERS


def write_breaklines(folder):
    """Write a line, a polygon with a hole, and zones where dem.tif and, the line, cloud.laz are."""
    # dem.tif lies south of the corner, cloud.laz north of it.
    line = shapely.LineString([(500020, 5100090), (500090, 5099990), (500300, 5099700)])
    building = shapely.box(500150, 5099850, 500180, 5099880)
    domain = shapely.box(500010, 5099650, 500450, 5099990).difference(building)
    for name, shape in (("breaklines", line), ("domain", domain)):
        pyogrio.raw.write(
            folder / f"{name}.gpkg",
            shapely.to_wkb(np.array([shape])),
            [],
            [],
            geometry_type=shape.geom_type,
            crs="EPSG:32632",
        )
    pyogrio.raw.write(
        folder / "zones.gpkg",
        shapely.to_wkb(np.array([line.buffer(20.0), domain])),
        [np.array([0.05, 0.5]), np.array([15.0, 40.0])],
        ["max_error", "longest_edge"],
        geometry_type="Polygon",
        crs="EPSG:32632",
    )


@pytest.mark.parametrize("page", RUN)
def test_commands_of_how_to_pages_run(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_tif(tmp_path / "dem.tif", hills(40, 50))
    write_tif(tmp_path / "earlier.tif", hills(40, 50, seed=1))
    write_las(tmp_path / "cloud.laz", 3000)
    write_breaklines(tmp_path)
    made = "analyse dem.tif dem.gpkg --partition random --prediction plane --quiet"
    assert main(made.split()) == 0
    for words in command_lines(page):
        code = main([*words, "--overwrite"])
        assert code == 0, (words, capsys.readouterr().err)


def test_the_first_minutes_run_in_the_shell_and_in_python(tmp_path, monkeypatch, capsys):
    """The two ways make the same TIN."""
    page = "docs/start/first-minutes.md"
    monkeypatch.chdir(tmp_path)
    write_tif(tmp_path / "dem.tif", hills(80, 90))
    (words,) = command_lines(page)
    assert main(words) == 0, capsys.readouterr().err
    said = capsys.readouterr().out
    (tmp_path / "coarse.gpkg").rename(tmp_path / "shell.gpkg")
    (block,) = blocks("python", page)
    exec(compile(block, page, "exec"), {})
    printed = capsys.readouterr().out.split()
    assert printed[0] == "5000"
    assert f"RMSE {float(printed[1]):.4g}," in said
    counts = [
        pyogrio.read_info(file, layer="level_00_tin")["features"]
        for file in ("coarse.gpkg", "shell.gpkg")
    ]
    assert counts[0] == counts[1] > 5000


@pytest.mark.parametrize("page", PAGES)
def test_rows_of_a_table_have_the_cells_of_its_head(page):
    """A row of measured figures had taken the place of one of the list of algorithms."""
    n_cells = None
    for line in (ROOT / page).read_text("utf-8").splitlines():
        if not line.startswith("|"):
            n_cells = None
            continue
        if n_cells is None:  # a screen reader says the head of a column with each of its cells
            assert not re.search(r"\|\s*\|", line), line
        found = len(re.findall(r"(?<!\\)\|", re.sub(r"`[^`]*`", "", line)))
        assert n_cells in (None, found), line
        n_cells = found


@pytest.mark.parametrize("page", ["README.md", *PAGES])
def test_links_lead_to_files_and_headings(page):
    path = ROOT / page
    for target in re.findall(r"\]\((?!https?:)([^)\s]+)\)", path.read_text("utf-8")):
        file, _, heading = target.partition("#")
        linked = path.parent / file if file else path
        if "made" in Path(file).parts:  # by the build of the site
            continue
        assert linked.exists(), target
        if heading:
            titles = re.findall(r"^#+ (.*)$", linked.read_text("utf-8"), flags=re.MULTILINE)
            assert heading in {slug(title) for title in titles}, target


def slug(title):
    """Return the anchor of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-")


@pytest.mark.parametrize("name", sorted(p.stem for p in (ROOT / "docs/notebooks").glob("*.ipynb")))
def test_notebooks_run(name, tmp_path, monkeypatch):
    plt = pytest.importorskip("matplotlib.pyplot")
    plt.switch_backend("Agg")
    notebook = nbformat.read(ROOT / f"docs/notebooks/{name}.ipynb", as_version=4)
    monkeypatch.chdir(tmp_path)
    names = {}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert not cell.outputs, "notebooks are kept without what they print"
            exec(compile(cell.source, name, "exec"), names)
    plt.close("all")
    assert any(isinstance(value, np.ndarray) for value in names.values())


def test_every_page_is_in_the_contents():
    """The site fails to build where one is not."""
    lines = (ROOT / "docs/index.md").read_text("utf-8").splitlines()
    for page in PAGES:
        name = page.removeprefix("docs/").removesuffix(".md")
        assert name == "index" or name in lines, name
