"""Pages and pictures made when the site is built, so that they cannot fall behind the code.

`made/commands.md` is the reference of the command line, out of its parsers; `made/*.svg` are the
drawings of the five-vertex example, out of what the core computes; `made/levels.html` is the viewer
of levels on the DEM that comes with matplotlib.
"""

from __future__ import annotations

import argparse
import runpy
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent.parent


def setup(app: Any) -> dict[str, bool]:
    """Make the pages before Sphinx looks for sources."""
    app.connect("config-inited", make_all)
    return {"parallel_read_safe": True}


def make_all(app: Any, config: Any) -> None:
    """Write everything into docs/made."""
    folder = HERE / "made"
    folder.mkdir(exist_ok=True)
    write(folder / "commands.md", commands_page())
    figures = runpy.run_path(str(HERE / "figures" / "five_vertices.py"))
    for name, svg in figures["drawings"]().items():
        write(folder / f"{name}.svg", svg)
    viewer = HERE / "_static" / "levels.html"
    if not viewer.exists():
        runpy.run_path(str(HERE / "figures" / "levels.py"))["write_viewer"](viewer)


def write(path: Path, text: str) -> None:
    """Write a file where its text is another: Sphinx then reads anew what has changed only."""
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, encoding="utf-8")


def commands_page() -> str:
    """Return the reference of the command line in Markdown."""
    from wavelet_gis.cli.main import argument_parser

    parser = argument_parser()
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    parts = [
        "# Commands\n",
        "Every command prints its figures as JSON with `--json`, and nothing but errors with "
        "`--quiet`. It ends with 0 when all is done, 1 when it refuses (one line says why), 2 when "
        "it is called wrongly, 130 when it is interrupted.\n",
    ]
    parts += [command_section(name, command) for name, command in commands.choices.items()]
    return "\n".join(parts)


def command_section(name: str, parser: argparse.ArgumentParser) -> str:
    """Return what a command does, its arguments and its options."""
    formatter = parser._get_formatter()
    lines = [
        f"## {name}\n",
        f"{parser.description}\n",
        f"`terrain-wavelets {usage_of(name, parser)}`\n",
    ]
    for group in parser._action_groups:
        actions = [a for a in group._group_actions if a.help != argparse.SUPPRESS]
        if not actions:
            continue
        title = {"positional arguments": "Arguments", "options": "Options"}.get(
            group.title or "", (group.title or "").capitalize()
        )
        lines += [f"**{title}**\n"]
        for action in actions:
            text = formatter._expand_help(action) if action.help else ""
            lines += [f"`{name_of(action)}`", f": {text}\n"]
    return "\n".join(lines)


def usage_of(name: str, parser: argparse.ArgumentParser) -> str:
    """Return the command with its positional arguments."""
    words = [a.dest.upper() for a in parser._actions if not a.option_strings]
    return " ".join([name, *words, "[options]"])


def name_of(action: argparse.Action) -> str:
    """Return an argument or option with what it takes."""
    if not action.option_strings:
        return action.dest.upper()
    flags = ", ".join(action.option_strings)
    if action.nargs == 0:
        return flags
    value = action.metavar or "|".join(map(str, action.choices or [action.dest.upper()]))
    return f"{flags} {value}"
