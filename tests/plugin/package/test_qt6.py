"""The plugin under Qt 6: every module is imported with PyQt6 and a stub of QGIS; needs no QGIS.

What Qt 6 has no more is a short name of an enumeration (``Qt.AlignRight``) or a class that moved:
both are looked for in the source, in whatever function they are, and in PyQt6 itself.
"""

import ast
import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
MODULES = sorted((ROOT / "plugin").rglob("*.py"))

#: Asked of QGIS before 3.38 only, whose Qt is 5.
OF_OLD_QGIS = {"QVariant.Int", "QVariant.LongLong", "QVariant.Double"}

#: Makes a stand-in for QGIS: any name is a class, any attribute of it another one.
STUB = """
import sys, types, importlib
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec

class Kind(type):
    def __getattr__(cls, name):
        if name.startswith("__"):
            raise AttributeError(name)
        made = Kind(name, (), {"__init__": lambda self, *a, **k: None})
        setattr(cls, name, made)
        return made
    def __or__(cls, other):
        return cls

class Stub(types.ModuleType):
    __path__ = []
    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        made = Kind(name, (), {"__init__": lambda self, *a, **k: None})
        if name.endswith("Exception"):
            made = type(name, (Exception,), {})
        if name == "Qgis":
            made.versionInt = staticmethod(lambda: 40000)
        setattr(self, name, made)
        return made

class Finder(MetaPathFinder, Loader):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("qgis", "processing", "osgeo"):
            return ModuleSpec(name, self, is_package=True)
    def create_module(self, spec):
        if spec.name.startswith("qgis.PyQt."):
            return importlib.import_module("PyQt6." + spec.name.rpartition(".")[2])
        return Stub(spec.name)
    def exec_module(self, module):
        pass

sys.meta_path.insert(0, Finder())
"""


@pytest.fixture(scope="module")
def qt():
    """Return a function from a module of qgis.PyQt to that of PyQt6."""
    pytest.importorskip("PyQt6")
    try:
        importlib.import_module("PyQt6.QtWidgets")
    except ImportError as error:  # the wheel takes OpenGL and GLib from the system
        if os.environ.get("CI"):
            raise
        pytest.skip(f"PyQt6 lacks {error}; QGIS brings it, as does Debian's libqt6widgets6")
    return lambda name: importlib.import_module(f"PyQt6.{name}")


def names_from_qt(tree):
    """Return the module of qgis.PyQt that each imported name is of."""
    return {
        alias.asname or alias.name: (node.module.removeprefix("qgis.PyQt."), alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("qgis.PyQt.")
        for alias in node.names
    }


def chains(tree):
    """Return every dotted name of the source, the longest ones."""
    inner = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    return {
        ast.unparse(node)
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and id(node) not in inner
    }


def absent_in_qt6(source, qt):
    """Return the names of Qt in a source that Qt 6 does not have."""
    tree = ast.parse(source)
    names = names_from_qt(tree)
    faults = [
        name for name, (module, original) in names.items() if not hasattr(qt(module), original)
    ]
    for chain in chains(tree) - OF_OLD_QGIS:
        first, *rest = chain.split(".")
        if first not in names or not all(part.isidentifier() for part in rest):
            continue
        module, original = names[first]
        found = getattr(qt(module), original, None)
        for part in rest:
            if not hasattr(found, part):
                faults.append(chain)
                break
            found = getattr(found, part)
    return sorted(faults)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_qt6_has_every_name(qt, path):
    assert absent_in_qt6(path.read_text("utf-8"), qt) == []


def test_a_short_name_and_a_class_that_moved_are_seen(qt):
    source = (
        "from qgis.PyQt.QtCore import Qt\nfrom qgis.PyQt.QtWidgets import QAction\n"
        "def f():\n    return Qt.AlignRight, Qt.AlignmentFlag.AlignLeft\n"
    )
    assert absent_in_qt6(source, qt) == ["QAction", "Qt.AlignRight"]


def test_every_module_is_imported_under_pyqt6(qt):
    names = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        for path in MODULES
    ]
    script = (
        f"{STUB}\nfor name in {names!r}:\n    importlib.import_module(name)\n"
        "import PyQt6.QtWidgets\nassert 'PyQt5' not in sys.modules\nprint(len(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error::DeprecationWarning:plugin", "-c", script],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]


def test_nothing_of_qt5_is_imported_past_qgis():
    """``qgis.PyQt`` is the Qt that QGIS has; the bindings themselves are one of two."""
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            module = node.module if isinstance(node, ast.ImportFrom) else None
            assert not (module or "").startswith(("PyQt5", "PyQt6")), path
