"""Make everything that a release hands out, in dist/, and name what only a person can fill in.

    python3 scripts/release.py [--draft]

The wheel, the source distribution, the plugin's zip, the manual page and the completions of bash,
zsh and tcsh are made from the last commit. Refused: changes that are not committed, versions that
differ between files, a changelog without the version, addresses that are still examples. With
``--draft`` these are told, and the files made all the same.
"""

from __future__ import annotations

import argparse
import configparser
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DIST = ROOT / "dist"
sys.path.insert(0, str(ROOT))
#: Keys of metadata.txt whose addresses only a person knows.
ADDRESSES = ("email", "homepage", "tracker", "repository")


def main() -> None:
    """Check, build, check what was built."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draft", action="store_true", help="make the files whatever is missing")
    arguments = parser.parse_args()
    missing = [*uncommitted(), *other_versions(), *not_in_the_changelog(), *example_addresses()]
    for line in missing:
        print(f"release: {line}", file=sys.stderr)
    if missing and not arguments.draft:
        raise SystemExit(1)
    DIST.mkdir(exist_ok=True)
    for old in DIST.glob("terrain_wavelets-*"):
        old.unlink()
    run(sys.executable, "-m", "build", "--outdir", str(DIST), str(ROOT))
    run(sys.executable, str(ROOT / "scripts" / "plugin_zip.py"))
    manual_page()
    completions()
    packages = sorted(str(path) for path in DIST.glob("terrain_wavelets-*"))
    run(sys.executable, "-m", "twine", "check", "--strict", *packages)
    for path in sorted(DIST.iterdir()):
        print(f"{path.stat().st_size:>10,}  {path.relative_to(ROOT)}")


def run(*command: str) -> None:
    """Run a program; what it says is told where it fails."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"release: {' '.join(command)} failed:\n{done.stdout}{done.stderr}")


def uncommitted() -> list[str]:
    """Return a line where files differ from the last commit."""
    said = subprocess.run(
        ["git", "-c", f"safe.directory={ROOT}", "status", "--porcelain"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    return [f"{len(said.splitlines())} files are not committed; commit them"] if said else []


def version() -> str:
    """Return the version of the project."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]


def metadata() -> configparser.SectionProxy:
    """Return what QGIS shows of the plugin."""
    parser = configparser.ConfigParser(interpolation=None)
    parser.read(ROOT / "metadata.txt", encoding="utf-8")
    return parser["general"]


def other_versions() -> list[str]:
    """Return a line for each file with another version than pyproject.toml."""
    core = (ROOT / "wavelet_core" / "__init__.py").read_text("utf-8")
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    found = {
        "wavelet_core/__init__.py": re.search(r'^__version__ = "(.*)"', core, re.MULTILINE),
        "CITATION.cff": re.search(r"^version: (.*)$", citation, re.MULTILINE),
    }
    versions = {name: match[1] if match else "none" for name, match in found.items()}
    versions["metadata.txt"] = metadata()["version"]
    return [
        f"{name} has version {other}, and pyproject.toml {version()}; make them one"
        for name, other in versions.items()
        if other != version()
    ]


def not_in_the_changelog() -> list[str]:
    """Return a line where the changelog has no heading for the version."""
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    if re.search(rf"^## \[{re.escape(version())}\] - \d{{4}}-\d\d-\d\d$", text, re.MULTILINE):
        return []
    return [
        f"CHANGELOG.md has no '## [{version()}] - YYYY-MM-DD'; name what comes with the version"
    ]


def example_addresses() -> list[str]:
    """Return a line for each address that is still an example."""
    general = metadata()
    return [
        f"metadata.txt: {key} is {general[key]!r}; only you know the real one"
        for key in ADDRESSES
        if ".example" in general[key]
    ]


def manual_page() -> None:
    """Write dist/terrain-wavelets.1."""
    from argparse_manpage.manpage import Manpage

    from wavelet_gis.cli.main import argument_parser

    parser = argument_parser()
    data = {"version": version(), "manual_title": "Terrain Wavelets"}
    page = Manpage(parser, data, format="single-commands-section")
    (DIST / "terrain-wavelets.1").write_text(str(page), encoding="utf-8")


def completions() -> None:
    """Write the completions of the command for each shell."""
    from wavelet_gis.cli.completion import SHELLS, completion
    from wavelet_gis.cli.main import argument_parser

    for shell in SHELLS:
        script = completion(argument_parser(), shell)
        (DIST / f"terrain-wavelets.{shell}").write_text(script, encoding="utf-8")


if __name__ == "__main__":
    main()
