"""The files around the code agree with one another."""

import configparser
import re
import tomllib
from pathlib import Path

import wavelet_core

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def plugin_metadata():
    parser = configparser.ConfigParser(interpolation=None)
    parser.optionxform = str
    parser.read(ROOT / "metadata.txt", encoding="utf-8")
    return dict(parser["general"])


def test_one_version():
    assert wavelet_core.__version__ == PROJECT["version"] == plugin_metadata()["version"]


def test_each_python_of_the_classifiers_has_a_row_of_what_was_tried():
    """A Python is claimed only where a run of `make matrix` is told of, and the other way round."""
    page = (ROOT / "docs/start/install.md").read_text("utf-8")
    tried = re.findall(r"^\| (3\.\d+)\.\d+ \| (oldest|newest) \|", page, re.MULTILINE)
    claimed = [c.rpartition(" ")[2] for c in PROJECT["classifiers"] if ":: Python :: 3." in c]
    assert claimed[0] == PROJECT["requires-python"].removeprefix(">=")
    assert sorted(tried) == sorted((c, p) for c in claimed for p in ("oldest", "newest"))


def test_one_licence():
    assert PROJECT["license"] == plugin_metadata()["license"] == "GPL-2.0-or-later"
    text = (ROOT / "LICENSE").read_text("utf-8")
    assert "GNU GENERAL PUBLIC LICENSE" in text
    assert "Version 2, June 1991" in text


def test_the_plugin_repository_finds_what_it_asks_for():
    metadata = plugin_metadata()
    needed = "name description about version author email qgisMinimumVersion tracker repository"
    assert all(metadata.get(field) for field in needed.split())
    assert metadata["qgisMinimumVersion"] == "3.28"
    assert metadata["qgisMaximumVersion"] == "4.99"
    assert metadata["hasProcessingProvider"] == "yes"
    assert (ROOT / metadata["icon"]).is_file()


def test_the_changelog_tells_of_this_version_or_of_what_comes():
    headings = re.findall(
        r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE
    )
    assert headings[0] in ("Unreleased", PROJECT["version"])


def test_every_chore_is_told_by_make_help():
    makefile = (ROOT / "Makefile").read_text("utf-8")
    chores = set(re.search(r"^\.PHONY: (.+)$", makefile, re.MULTILINE).group(1).split()) - {"help"}
    told = set(re.findall(r'@echo "make ([\w-]+)', makefile))
    assert told == chores
