"""Imports point one way, plugin -> wavelet_gis -> wavelet_core, and no layer imports too much."""

import ast
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

#: Which of our packages each of them may import.
ALLOWED_ARROWS = {
    "wavelet_core": {"wavelet_core"},
    "wavelet_gis": {"wavelet_gis", "wavelet_core"},
    "plugin": {"plugin", "wavelet_gis", "wavelet_core"},
}
#: Which other packages may be imported anywhere, and which inside a function only.
ALLOWED_IN_CORE = {"numpy", "scipy", "numba"}
ALLOWED_LAZILY_IN_CORE = {"pythoncdt"}
#: Only the plugin lives inside QGIS, and there rasters and vectors go through QGIS.
QGIS_PACKAGES = {"qgis", "osgeo", "processing", "PyQt5", "PyQt6", "sip"}
REFUSED_IN_PLUGIN = {"rasterio", "pyogrio", "fiona", "geopandas"}


@dataclass(frozen=True)
class Import:
    """One imported top-level package, and where it is imported."""

    package: str
    line: int
    is_lazy: bool


def imports_of(source: str, module: str) -> list[Import]:
    """Return every import in ``source``, the text of the dotted ``module``."""
    found = []

    def visit(node: ast.AST, is_lazy: bool) -> None:
        if isinstance(node, ast.Import):
            found.extend(Import(a.name.split(".")[0], node.lineno, is_lazy) for a in node.names)
        elif isinstance(node, ast.ImportFrom):
            if node.level == 0:
                found.append(Import((node.module or "").split(".")[0], node.lineno, is_lazy))
            else:
                parent = module.split(".")[: -node.level]
                names = [node.module] if node.module else [a.name for a in node.names]
                found.extend(
                    Import([*parent, *name.split(".")][0], node.lineno, is_lazy) for name in names
                )
        inside_function = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        for child in ast.iter_child_nodes(node):
            visit(child, is_lazy or inside_function)

    visit(ast.parse(source), False)
    return found


def faults_of(source: str, module: str) -> list[str]:
    """Return one line for each import in ``source`` that its layer may not have."""
    layer = module.split(".")[0]
    faults = []
    for imported in imports_of(source, module):
        package = imported.package
        if package in ALLOWED_ARROWS:
            is_allowed = package in ALLOWED_ARROWS[layer]
        elif layer == "wavelet_core":
            is_allowed = (
                package in sys.stdlib_module_names
                or package in ALLOWED_IN_CORE
                or (package in ALLOWED_LAZILY_IN_CORE and imported.is_lazy)
            )
        elif layer == "wavelet_gis":
            is_allowed = package not in QGIS_PACKAGES
        else:
            is_allowed = package not in REFUSED_IN_PLUGIN
        if not is_allowed:
            faults.append(f"{module}:{imported.line} imports {package}")
    return faults


def our_modules() -> list[tuple[str, Path]]:
    """Return the dotted name and the path of every module of the three layers."""
    modules = []
    for layer in ALLOWED_ARROWS:
        for path in sorted((ROOT / layer).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            modules.append((".".join(parts), path))
    return modules


def test_imports_point_one_way():
    modules = our_modules()
    assert modules, f"no module found under {ROOT}"
    faults = [fault for name, path in modules for fault in faults_of(path.read_text("utf-8"), name)]
    assert not faults, "\n".join(faults)


def test_numba_is_imported_behind_the_shim_only():
    offenders = [
        name
        for name, path in our_modules()
        if name != "wavelet_core._kernels._jit"
        and any(found.package == "numba" for found in imports_of(path.read_text("utf-8"), name))
    ]
    assert offenders == []


def test_the_root_holds_the_class_factory_and_nothing_else():
    tree = ast.parse((ROOT / "__init__.py").read_text("utf-8"))
    names = [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert names == ["classFactory"]
    assert [type(node) for node in tree.body] == [ast.Expr, ast.FunctionDef]


@pytest.mark.parametrize(
    ("module", "source", "is_fault"),
    [
        ("wavelet_core.mesh.triangle_mesh", "import wavelet_gis", True),
        ("wavelet_core.mesh.triangle_mesh", "from wavelet_gis.crs.frame import to_metres", True),
        ("wavelet_core.mesh.triangle_mesh", "def f():\n    import plugin", True),
        ("wavelet_core.mesh.triangle_mesh", "import rasterio", True),
        ("wavelet_core.mesh.triangle_mesh", "import pythoncdt", True),
        ("wavelet_core.mesh.triangle_mesh", "def f():\n    import pythoncdt", False),
        (
            "wavelet_core.mesh.triangle_mesh",
            "import numpy.linalg, scipy.sparse as sparse, json",
            False,
        ),
        ("wavelet_core._kernels.mesh", "from ..errors import MeshError", False),
        ("wavelet_core.mesh.triangle_mesh", "from . import errors", False),
        ("wavelet_core.mesh.triangle_mesh", "from ... import wavelet_gis", True),
        (
            "wavelet_core.mesh.triangle_mesh",
            "try:\n    import matplotlib\nexcept ImportError:\n    pass",
            True,
        ),
        ("wavelet_gis.cli.main", "from wavelet_core import analyse\nimport rasterio", False),
        ("wavelet_gis.cli.main", "from plugin import bridge", True),
        ("wavelet_gis.cli.main", "def f():\n    from osgeo import gdal", True),
        ("wavelet_gis.cli.main", "from qgis.core import QgsRasterLayer", True),
        ("plugin.bridge", "from qgis.core import Qgis\nfrom wavelet_gis import crs", False),
        ("plugin.bridge", "def f():\n    import rasterio", True),
        ("plugin.algorithms.analyse", "from ...wavelet_core import analyse", False),
    ],
)
def test_a_wrong_arrow_is_seen(module, source, is_fault):
    assert bool(faults_of(source, module)) == is_fault
