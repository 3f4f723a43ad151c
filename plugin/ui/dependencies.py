"""Which packages are missing, and how to get them on this machine; nothing installs itself."""

from __future__ import annotations

import importlib.util
import shlex
import sys
import sysconfig
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from .translation import tr

#: The oldest Python that the algorithms run under.
MINIMUM_PYTHON = (3, 11)


@dataclass(frozen=True)
class Package:
    """A Python package.

    Attributes
    ----------
    module : str
        By which it is imported.
    pip : str
        By which pip knows it.
    debian : str or None
        Its Debian package, where there is one.
    """

    module: str
    pip: str
    debian: str | None = None


NUMPY = Package("numpy", "numpy", "python3-numpy")
SCIPY = Package("scipy", "scipy", "python3-scipy")
NUMBA = Package("numba", "numba", "python3-numba")
LASPY = Package("laspy", "laspy[lazrs]")
LAZRS = Package("lazrs", "lazrs")
PYPROJ = Package("pyproj", "pyproj", "python3-pyproj")
SCIKIT_LEARN = Package("sklearn", "scikit-learn", "python3-sklearn")
TRIMESH = Package("trimesh", "trimesh")
EZDXF = Package("ezdxf", "ezdxf")
SERAFIN = Package("serafin", "python-serafin")
CGAL = Package("CGAL", "cgal")
SHAPELY = Package("shapely", "shapely", "python3-shapely")

PYTHONCDT = Package("pythoncdt", "PythonCDT")

#: What every algorithm needs.
ALWAYS = (NUMPY, SCIPY)


def optional_packages() -> list[tuple[Package, str]]:
    """Return what works better, or at all, with a package: the options page shows it."""
    return [
        (NUMBA, tr("two to seven times as fast, within a tolerance up to 17 times")),
        (PYTHONCDT, tr("points and breaklines are triangulated four times as fast")),
        (LASPY, tr("LAS files; the zip of the plugin brings a copy")),
        (LAZRS, tr("LAZ and COPC files")),
        (SCIKIT_LEARN, tr("classes learned in Cluster details")),
        (TRIMESH, tr("meshes as GLB")),
        (EZDXF, tr("meshes as DXF")),
        (SERAFIN, tr("meshes as SELAFIN, for TELEMAC")),
        (CGAL, tr("meshes for solvers: bounds of angles and edges")),
    ]


def named(pip: str) -> Package:
    """Return the package that pip knows by a name."""
    return next((p for p in (TRIMESH, EZDXF, SERAFIN) if p.pip == pip), Package(pip, pip))


def for_las(path: str) -> tuple[Package, ...]:
    """Return what a LAS file needs, and a compressed one more."""
    return (LASPY, LAZRS, PYPROJ) if path.lower().endswith(".laz") else (LASPY, PYPROJ)


def missing(packages: Iterable[Package]) -> list[Package]:
    """Return those of ``packages`` that cannot be found, without importing them."""
    return [package for package in packages if importlib.util.find_spec(package.module) is None]


def remedy(packages: Sequence[Package]) -> str:
    """Return how ``packages`` are installed for the Python that QGIS runs here: where, and what."""
    return "{}: {}".format(*place_and_command(packages))


def place_and_command(packages: Sequence[Package]) -> tuple[str, str]:
    """Return where the exact command is given that installs ``packages`` here, and the command."""
    names = _quoted(package.pip for package in packages)
    if Path("/.flatpak-info").exists():
        command = f"flatpak run --command=pip3 org.qgis.qgis install --user {names}"
        return tr("in a terminal"), command
    if sys.platform == "win32":
        return tr("in the OSGeo4W Shell (Start menu, QGIS)"), f"python -m pip install {names}"
    if sys.platform == "darwin":
        interpreter = Path(sys.prefix) / "bin" / "python3"
        return tr("in Terminal"), f'"{interpreter}" -m pip install --user {names}'
    return tr("in a terminal"), _linux_command(packages)


def _linux_command(packages: Sequence[Package]) -> str:
    commands = []
    from_debian = [p.debian for p in packages if p.debian] if _is_debian() else []
    from_pip = [p.pip for p in packages if not (p.debian and from_debian)]
    if from_debian:
        commands.append(f"sudo apt install {' '.join(from_debian)}")
    if from_pip:
        # Debian 12 and later, Fedora and others refuse pip into the system's Python without this.
        marker = Path(sysconfig.get_path("stdlib")) / "EXTERNALLY-MANAGED"
        allow = "--break-system-packages " if marker.exists() else ""
        commands.append(f"/usr/bin/python3 -m pip install --user {allow}{_quoted(from_pip)}")
    return " && ".join(commands)


def _quoted(names: Iterable[str]) -> str:
    """Return names as a shell takes them: zsh would look for files called ``laspy[lazrs]``."""
    if sys.platform == "win32":  # cmd knows double quotes only
        return " ".join(f'"{name}"' if "[" in name else name for name in names)
    return " ".join(map(shlex.quote, names))


def _is_debian() -> bool:
    return Path("/etc/debian_version").exists()


def refusal(packages: Sequence[Package] = ()) -> str | None:
    """Return why nothing can run here, with the remedy, or None when all is there.

    Parameters
    ----------
    packages : sequence of Package
        What is needed beyond numpy and scipy.
    """
    if sys.version_info < MINIMUM_PYTHON:
        return tr(
            "Terrain Wavelets needs Python {} or later, and this QGIS runs Python {}; "
            "install a newer QGIS."
        ).format(_dotted(MINIMUM_PYTHON), _dotted(sys.version_info[:2]))
    absent = missing((*ALWAYS, *packages))
    if not absent:
        return None
    names = ", ".join(package.pip.partition("[")[0] for package in absent)
    return tr("missing Python package: {names}. Install it {remedy} and start QGIS again.").format(
        names=names, remedy=remedy(absent)
    )


def slow_without_numba() -> str | None:
    """Return what to say to a user whose Python has no numba, or None when it is there."""
    if not missing([NUMBA]):
        return None
    return tr(
        "The Python package numba is missing: the work takes two to seven times as long, to refine "
        "a TIN within a tolerance 6 to 17 times, with the same result. Install it {} and start "
        "QGIS again."
    ).format(remedy([NUMBA]))


def with_remedy(text: str) -> str:
    """Return a message with the command of this platform where it asks for a package by name."""
    asked = [
        package
        for package, _ in optional_packages()
        if f"install {package.module}" in text or f"'pip install {package.module}" in text
    ]
    absent = missing(asked)
    return f"{text} ({remedy(absent)})" if absent else text


def _dotted(version: Iterable[int]) -> str:
    return ".".join(str(part) for part in version)
