"""Imports run one way: between the layers, between the rooms of a layer, and in no circle."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterable
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
#: The rooms of each layer, from the ground up: a room imports itself and those before it.
ROOMS = {
    "wavelet_core": (
        "errors",
        "progress",
        "_threads",
        "_table",
        "_validate",
        "_kernels",
        "_arrays",
        "mesh",
        "partition",
        "lifting",
        "filtering",
        "features",
        "accuracy",
        "refinement",
        "synthetic",
        "metrics",
    ),
    "wavelet_gis": (
        "errors",
        "_fields",
        "_program",
        "_memory",
        "_allocator",
        "progress",
        "notes",
        "crs",
        "model",
        "products",
        "io",
        "workflows",
        "tiles",
        "report",
        "cli",
    ),
    "plugin": (
        "packages",
        "ui",
        "qgis_io",
        "parameters",
        "base",
        "algorithms",
        "provider",
        "plugin",
    ),
}
#: Methods that hand their object over to a later room, imported when they are called: the only
#: imports that may run back up, and only from inside a function.
DOORS = {
    ("wavelet_core.lifting.pyramid", "wavelet_core.filtering.thresholds"),  # Pyramid.denoised
    ("wavelet_core.lifting.pyramid", "wavelet_core.accuracy.level_errors"),  # Pyramid.errors
}
#: Which other packages may be imported anywhere, and which inside a function only.
ALLOWED_IN_CORE = {"numpy", "scipy", "numba"}
ALLOWED_LAZILY_IN_CORE = {"pythoncdt", "shapely"}
#: Only the plugin lives inside QGIS, and there rasters and vectors go through QGIS.
QGIS_PACKAGES = {"qgis", "osgeo", "processing", "PyQt5", "PyQt6", "sip"}
REFUSED_IN_PLUGIN = {"rasterio", "pyogrio", "fiona", "geopandas"}


@dataclass(frozen=True)
class Import:
    """One imported module or name, dotted from the top, and where it is imported."""

    target: str
    line: int
    is_lazy: bool

    @property
    def package(self) -> str:
        """The top-level package."""
        return self.target.split(".")[0]


def imports_of(source: str, module: str, *, is_package: bool = False) -> list[Import]:
    """Return every import in ``source``, the text of the dotted ``module``.

    ``from a import b`` is found as ``a.b``, which may be a module or a name in ``a``. What only a
    type checker imports is left out.
    """
    found = []
    parents = module.split(".") if is_package else module.split(".")[:-1]

    def visit(node: ast.AST, is_lazy: bool) -> None:
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            for child in node.orelse:
                visit(child, is_lazy)
            return
        if isinstance(node, ast.Import):
            found.extend(Import(alias.name, node.lineno, is_lazy) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = parents[: len(parents) + 1 - node.level] if node.level else []
            start = [*start, *(node.module.split(".") if node.module else [])]
            found.extend(
                Import(".".join([*start, alias.name]), node.lineno, is_lazy) for alias in node.names
            )
        inside_function = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        for child in ast.iter_child_nodes(node):
            visit(child, is_lazy or inside_function)

    visit(ast.parse(source), False)
    return found


def room_of(dotted: str) -> str:
    """Return the folder or module of a layer that holds the dotted name; "" for its own door."""
    return [*dotted.split("."), ""][1]


def faults_of(source: str, module: str, *, is_package: bool = False) -> list[str]:
    """Return one line for each import in ``source`` that its layer or its room may not have."""
    layer = module.split(".")[0]
    faults = []
    for imported in imports_of(source, module, is_package=is_package):
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
        if package == layer:
            is_allowed = is_allowed and not runs_back_up(module, imported)
        if not is_allowed:
            faults.append(f"{module}:{imported.line} imports {imported.target}")
    return faults


def runs_back_up(module: str, imported: Import) -> bool:
    """Tell whether an import inside a layer leads to a room above its own."""
    own, theirs = room_of(module), room_of(imported.target)
    order = ROOMS[module.split(".")[0]]
    if own == "" or theirs == own or theirs not in order:  # the layer's own door, or a name in it
        return False
    is_door = imported.is_lazy and any(
        module == source and f"{imported.target}.".startswith(f"{target}.")
        for source, target in DOORS
    )
    return order.index(theirs) > order.index(own) and not is_door


def our_modules() -> dict[str, Path]:
    """Return the path of every module of the three layers by its dotted name."""
    modules = {}
    for layer in ALLOWED_ARROWS:
        for path in sorted((ROOT / layer).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            modules[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return modules


def edges_of(sources: dict[str, str]) -> dict[str, set[str]]:
    """Return, by module, the other modules that it imports; the doors are left out."""
    edges: dict[str, set[str]] = {}
    for name, source in sources.items():
        is_package = any(other.startswith(f"{name}.") for other in sources)
        edges[name] = set()
        for imported in imports_of(source, name, is_package=is_package):
            target = imported.target  # a module, or else a name in one
            if target not in sources:
                target = target.rpartition(".")[0]
            if target in sources and target != name and (name, target) not in DOORS:
                edges[name].add(target)
    return edges


def circles_in(edges: dict[str, set[str]]) -> list[list[str]]:
    """Return the circles that a walk along the imports meets."""
    circles, done = [], set()

    def walk(name: str, path: list[str]) -> None:
        if name in path:
            circles.append([*path[path.index(name) :], name])
        elif name not in done:
            for target in sorted(edges[name]):
                walk(target, [*path, name])
            done.add(name)

    for name in sorted(edges):
        walk(name, [])
    return circles


def test_imports_point_one_way():
    modules = our_modules()
    assert modules, f"no module found under {ROOT}"
    faults = [
        fault
        for name, path in modules.items()
        for fault in faults_of(path.read_text("utf-8"), name, is_package=path.name == "__init__.py")
    ]
    assert not faults, "\n".join(faults)


def test_no_module_is_in_a_circle():
    sources = {name: path.read_text("utf-8") for name, path in our_modules().items()}
    circles = circles_in(edges_of(sources))
    assert not circles, "\n".join(" -> ".join(circle) for circle in circles)


def test_a_circle_is_seen():
    sources = {
        "wavelet_core.mesh": "",
        "wavelet_core.mesh.a": "from .b import x",
        "wavelet_core.mesh.b": "def f():\n    from . import c",
        "wavelet_core.mesh.c": "from wavelet_core.mesh import a",
    }
    assert circles_in(edges_of(sources)) == [
        ["wavelet_core.mesh.a", "wavelet_core.mesh.b", "wavelet_core.mesh.c", "wavelet_core.mesh.a"]
    ]


def test_every_room_has_its_place_in_the_order():
    for layer, order in ROOMS.items():
        rooms = {room_of(name) for name in our_modules() if name.split(".")[0] == layer} - {""}
        assert rooms <= set(order), f"{layer}: {sorted(rooms - set(order))}"


def rooms_on_the_map(text: str, layer: str) -> list[str]:
    """Return the folders and modules that the map of a layer lists, in its order."""
    table = text.partition(f"| `{layer}`, ")[2].partition("\n\n")[0]
    cells = [row.split("|")[1] for row in table.splitlines() if row.startswith("| `")]
    return [name.strip("/") for cell in cells for name in re.findall(r"`(\w+/?)`", cell)]


@pytest.mark.parametrize("layer", ROOMS)
def test_the_map_of_the_house_lists_every_room_in_the_order_of_imports(layer):
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    assert rooms_on_the_map(text, layer) == list(ROOMS[layer])


#: Folders that hold one file for each row of a table, however many there are.
OF_TABLES = {
    "plugin/algorithms",
    "wavelet_gis/cli/commands",
    "wavelet_core/_kernels",
    "wavelet_core/_arrays",
}
MOST_FILES = 12
#: What builds make beside the files that are kept, and what Python does.
MADE = {"_build", "made", "jupyter_execute", "__pycache__", ".ipynb_checkpoints"}


def crowded_in(root: Path, tops: Iterable[str]) -> list[str]:
    """Return the folders below some with more than a dozen files, each with their number."""
    crowded = []
    for top in tops:
        folders = [root / top, *(path for path in (root / top).rglob("*") if path.is_dir())]
        for folder in folders:
            name = folder.relative_to(root).as_posix()
            n_files = sum(path.is_file() and path.suffix != ".pyc" for path in folder.iterdir())
            is_kept = not MADE & set(folder.relative_to(root).parts)
            if is_kept and name not in OF_TABLES and n_files > MOST_FILES:
                crowded.append(f"{name} holds {n_files} files")
    return crowded


def test_no_room_is_crowded():
    crowded = crowded_in(ROOT, [*ALLOWED_ARROWS, "tests", "benchmarks", "docs", "scripts"])
    assert not crowded, "; ".join(crowded)


def test_a_crowded_room_is_seen(tmp_path):
    for folder, n_files in (("docs/full", 12), ("docs/crowded", 13), ("docs/made", 20)):
        (tmp_path / folder).mkdir(parents=True)
        for k in range(n_files):
            (tmp_path / folder / f"{k}.md").touch()
    assert crowded_in(tmp_path, ["docs"]) == ["docs/crowded holds 13 files"]


def test_numba_is_imported_behind_the_shim_only():
    offenders = [
        name
        for name, path in our_modules().items()
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
        ("wavelet_core.errors", "import wavelet_gis", True),
        ("wavelet_core.errors", "from wavelet_gis.crs import to_metres", True),
        ("wavelet_core.errors", "def f():\n    import plugin", True),
        ("wavelet_core.errors", "import rasterio", True),
        ("wavelet_core.errors", "import pythoncdt", True),
        ("wavelet_core.errors", "def f():\n    import pythoncdt", False),
        ("wavelet_core.errors", "import numpy.linalg, scipy.sparse as sparse, json", False),
        ("wavelet_core._kernels.update", "from ..errors import MeshError", False),
        ("wavelet_core.mesh.quadric", "from .. import errors", False),
        ("wavelet_core.mesh.quadric", "from ... import wavelet_gis", True),
        ("wavelet_core.errors", "try:\n    import matplotlib\nexcept ImportError:\n    pass", True),
        ("wavelet_core.mesh.quadric", "from ..lifting.pyramid import Pyramid", True),
        ("wavelet_core.mesh.quadric", "def f():\n    from ..lifting import pyramid", True),
        ("wavelet_core.lifting.pyramid", "from ..mesh.quadric import build_quadrics", False),
        ("wavelet_core.lifting.pyramid", "from ..filtering.thresholds import denoised", True),
        (
            "wavelet_core.lifting.pyramid",
            "def f():\n    from ..filtering.thresholds import denoised",
            False,
        ),
        (
            "wavelet_core.mesh.quadric",
            "if TYPE_CHECKING:\n    from ..lifting.pyramid import Pyramid",
            False,
        ),
        ("wavelet_gis.cli.main", "from wavelet_core import analyse\nimport rasterio", False),
        ("wavelet_gis.cli.main", "from plugin import base", True),
        ("wavelet_gis.cli.main", "def f():\n    from osgeo import gdal", True),
        ("wavelet_gis.cli.main", "from qgis.core import QgsRasterLayer", True),
        ("wavelet_gis.io.atomic", "from wavelet_gis.cli.console import Console", True),
        ("wavelet_gis.workflows.open", "from wavelet_gis.io.raster import read_dem", False),
        ("plugin.base", "from qgis.core import Qgis\nfrom wavelet_gis import crs", False),
        ("plugin.base", "def f():\n    import rasterio", True),
        ("plugin.base", "def f():\n    from .provider import ICON", True),
        ("plugin.algorithms.analyse_dem", "from ...wavelet_core import analyse", False),
    ],
)
def test_a_wrong_arrow_is_seen(module, source, is_fault):
    assert bool(faults_of(source, module)) == is_fault


def test_names_of_the_core_are_imported_when_they_are_first_used():
    code = (
        "import sys, wavelet_core\n"
        "assert not {'scipy', 'numba'} & set(sys.modules)\n"
        "assert set(wavelet_core._HOMES) <= set(wavelet_core.__all__) <= set(dir(wavelet_core))\n"
        "for name in wavelet_core.__all__:\n"
        "    assert getattr(wavelet_core, name) is not None\n"
        "assert wavelet_core.metrics.surface_errors\n"
        "assert wavelet_core.analyse.__name__ == 'analyse'\n"
        "assert not hasattr(wavelet_core, 'no_such_name')\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)
