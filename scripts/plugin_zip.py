"""Make the plugin's zip from the last commit: dist/terrain_wavelets.zip, the same bytes each time.

    python3 scripts/plugin_zip.py [--output FILE] [--without-laspy]

What is committed comes by ``git archive``; beside it go the translations, compiled, the pages of
docs/ as HTML, and a copy of laspy, which is pure Python (BSD-2-Clause, its licence goes with it).
The plugin uses that copy where no laspy is installed, so that LAS files open in a QGIS without
further packages. It is taken from this Python, or fetched by pip, and is never committed.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import io
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from help_pages import page
from translations import compiled, translated

ROOT = Path(__file__).resolve().parent.parent
TOP = "terrain_wavelets"
#: Where the copies of other people's packages are in the plugin; see ``plugin/packages.py``.
VENDORED = "vendored"
LASPY = "2.7.0"
#: Of the wheel that pip fetches.
LASPY_HASH = "sha256:15f5344c62a1023461996bdf5d1ba5fdd813e96694a524fee712931134f3792f"
#: Its command line, which needs other packages, stays away.
LEFT_OUT = ("laspy/cli/",)
#: How compressed, and when all files are said to be made: the bytes depend on the commit alone.
EPOCH = (2020, 1, 1, 0, 0, 0)


def committed() -> dict[str, bytes]:
    """Return the files of the last commit that are part of the plugin, by path."""
    with zipfile.ZipFile(io.BytesIO(_git("archive", "--format=zip", "HEAD"))) as archive:
        return {
            info.filename: archive.read(info) for info in archive.infolist() if not info.is_dir()
        }


def _git(*arguments: str) -> bytes:
    command = ["git", "-c", f"safe.directory={ROOT}", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout


def laspy() -> dict[str, bytes]:
    """Return the modules and the licence of laspy, from this Python or by pip."""
    try:
        distribution = importlib.metadata.distribution("laspy")
    except importlib.metadata.PackageNotFoundError:
        distribution = None
    if distribution is not None and distribution.version == LASPY:
        found = {
            str(path): Path(str(path.locate())).read_bytes()
            for path in distribution.files or ()
            if "__pycache__" not in str(path)
        }
    else:
        found = _fetched()
    return {
        name: content
        for name, content in found.items()
        if name.startswith("laspy") and not name.startswith(LEFT_OUT) and _is_wanted(name)
    }


def _is_wanted(name: str) -> bool:
    """Whether a file is a module, the licence, or what says which version this is."""
    return name.endswith(".py") or Path(name).name in ("LICENSE.txt", "METADATA")


def _fetched() -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as folder:
        wanted = Path(folder) / "requirements.txt"
        wanted.write_text(f"laspy=={LASPY} --hash={LASPY_HASH}\n")
        command = [
            *(sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"),
            *("--disable-pip-version-check", "--only-binary", ":all:"),
            *("--require-hashes", "--requirement", str(wanted), "--dest", folder),
        ]
        if subprocess.run(command, check=False).returncode != 0:
            raise SystemExit(
                f"laspy {LASPY} is not in this Python and pip cannot fetch it; install it, or make "
                "the zip with --without-laspy."
            )
        (wheel,) = Path(folder).glob("*.whl")
        with zipfile.ZipFile(wheel) as archive:
            return {name: archive.read(name) for name in archive.namelist()}


def build(with_laspy: bool = True) -> bytes:
    """Return the zip."""
    files = committed()
    for name, content in files.copy().items():
        path = Path(name)
        if path.suffix == ".ts":
            messages = translated(content.decode("utf-8"))
            if messages:  # the template has none
                files[str(path.with_suffix(".qm"))] = compiled(messages)
    # The folders of docs/ make one: the plugin names its pages without them.
    for name in _git("ls-tree", "-r", "--name-only", "HEAD", "docs/").decode().split():
        if name.endswith(".md") and name.count("/") == 2:  # index.md is the contents of the site
            text = _git("show", f"HEAD:{name}").decode("utf-8")
            files[f"help/{Path(name).stem}.html"] = page(text).encode("utf-8")
    if with_laspy:
        files.update({f"{VENDORED}/{name}": content for name, content in laspy().items()})
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            info = zipfile.ZipInfo(f"{TOP}/{name}", EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, files[name])
    return buffer.getvalue()


def main() -> None:
    """Write the zip."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=ROOT / "dist" / "terrain_wavelets.zip")
    parser.add_argument("--without-laspy", action="store_true")
    options = parser.parse_args()
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_bytes(build(with_laspy=not options.without_laspy))
    print(options.output)


if __name__ == "__main__":
    main()
