"""A disk that fills up at any byte: exit 1, one line, the old file whole, nothing left behind.

The limit on a file's size (``ulimit -f``) stands for the disk: it fails at the same calls, at a
byte that the test chooses, and needs no rights. To try every 50 kB of each output, apart from the
suite::

    FULL_DISK_LIMITS=1000000 pytest tests/cli/faults/test_full_disk.py --junitxml=full_disk.xml \\
        -o junit_family=xunit1

The property ``limits`` of each case tells how many.
"""

import contextlib
import os
import pkgutil
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import hills, write_las, write_tif

from wavelet_gis.cli import commands
from wavelet_gis.cli.main import main
from wavelet_gis.io.formats import MESH_SUFFIXES

resource = pytest.importorskip("resource", reason="limits of POSIX")

STEP = 50_000
FIRST = 4_000  # what pytest captures goes into a file, too
#: Limits tried for one output, spread over its size; set the variable to try each.
MOST = int(os.environ.get("FULL_DISK_LIMITS", "2"))

MESHES = [".gpkg", *MESH_SUFFIXES]

#: Command, input, output, and options; what begins with @ stands before the output.
JOBS = [
    *[("reconstruct", "dem", f"x{s}") for s in (".tif", ".img", ".asc")],
    *[("reconstruct", "cloud", f"x{s}") for s in (".las", ".laz")],
    ("extract", "dem", "x.tif"),
    ("extract", "dem", "x.tif", "--cog"),
    *[("extract", "dem", f"x{s}", "--level", "1") for s in MESHES],
    *[("extract", "cloud", f"x{s}", "--level", "1") for s in (".tif", ".gpkg", ".ply")],
    *[("details", "dem", f"x{s}") for s in (".tif", ".gpkg", ".png", ".svg", ".pdf")],
    *[("details", "dem", f"x{s}", "--what", "shape") for s in (".tif", ".gpkg")],
    *[("cluster", "dem", f"x{s}") for s in (".tif", ".gpkg")],
    *[("filter", "dem", f"x{s}", "--gain", "0=0") for s in (".tif", ".gpkg")],
    *[("filter", "cloud", f"x{s}", "--gain", "0=0") for s in (".las", ".laz", ".gpkg")],
    ("report", "dem", "x.html"),
    ("view", "dem", "x.html"),
    *[("profile", "dem", f"x{s}", "@line") for s in (".csv", ".gpkg", ".html", ".svg")],
    ("contours", "dem", "x.gpkg"),
    ("difference", "dem", "x.tif"),
    *[("classify", "points", f"x{s}", "--ground") for s in (".las", ".laz")],
    ("analyse", "input", "x.gpkg", "--levels", "1"),
    ("analyse", "points", "x.gpkg", "--levels", "1"),
    *[("simplify", "input", f"x{s}", "--vertices", "3000") for s in (".tif", *MESHES)],
]

#: Commands whose output is a folder, which tests of their own fill up, or none.
WITHOUT_FILE = {"tile", "terrain", "info"}


def test_every_command_and_format_is_tried():
    names = {row.name for row in pkgutil.iter_modules(commands.__path__) if row.name[0] != "_"}
    assert {command for command, *_ in JOBS} | WITHOUT_FILE == names


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("full")
    dem = write_tif(folder / "dem.tif", hills(110, 120).astype("f4"))
    cloud = write_las(folder / "cloud.las", 4000)
    for source in (dem, cloud):
        pyramid = str(source.with_suffix(".gpkg"))
        assert main(["analyse", str(source), pyramid, "--levels", "2", "--quiet"]) == 0
    line = folder / "line.geojson"
    with rasterio.open(dem) as dataset:
        crs, (west, south, east, north) = dataset.crs, dataset.bounds
    ends = shapely.linestrings([[west + 1, south + 1], [east - 1, north - 1]])
    pyogrio.raw.write(
        line, np.array([shapely.to_wkb(ends)]), [], [], geometry_type="LineString", crs=crs.to_wkt()
    )
    return {
        "line": line,
        "input": dem,
        "points": cloud,
        "dem": dem.with_suffix(".gpkg"),
        "cloud": cloud.with_suffix(".gpkg"),
    }


@contextlib.contextmanager
def files_limited_to(n_bytes):
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("job", JOBS, ids=lambda job: "-".join(job[::2]))
def test_a_file_that_does_not_fit(job, sources, tmp_path, capfd, record_property):
    command, source, name, *options = job
    pictures = dict.fromkeys(("png", "svg", "pdf"), "matplotlib")
    package = {"glb": "trimesh", "dxf": "ezdxf", "slf": "serafin", **pictures}.get(name[-3:])
    if package:
        pytest.importorskip(package)
    output = tmp_path / name
    before = [str(sources[option[1:]]) for option in options if option.startswith("@")]
    options = [option for option in options if not option.startswith("@")]
    inputs = [str(sources[source]), *before]
    line = [command, *inputs, str(output), *options, "--overwrite", "--quiet"]
    assert main(line) == 0
    old = {path: path.read_bytes() for path in tmp_path.iterdir()}
    size = len(old[output])
    limits = {*range(FIRST, size - STEP // 10, max(STEP, size // MOST)), int(0.98 * size)}
    record_property("limits", len(limits))
    capfd.readouterr()
    for limit in sorted(limits):
        with files_limited_to(limit):
            code = main(line)
        err = capfd.readouterr().err
        assert code == 1, limit
        assert err.startswith("terrain-wavelets: error: ")
        assert err.count("\n") == 1, err
        assert "unforeseen" not in err
        assert ".terrain-wavelets-" not in err
        assert {path: path.read_bytes() for path in tmp_path.iterdir()} == old, limit


@pytest.fixture
def tiny_disk(tmp_path):
    """Yield a function that mounts a disk of some kilobytes."""
    if os.name != "posix" or os.geteuid() != 0 or shutil.which("mount") is None:
        pytest.skip("only root may mount a small disk")
    folder = tmp_path / "disk"
    folder.mkdir()

    def mounted(kilobytes):
        made = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)],
            capture_output=True,
            check=False,
        )
        if made.returncode:
            pytest.skip("this machine mounts no small disk")
        return folder

    yield mounted
    subprocess.run(["umount", str(folder)], capture_output=True, check=False)


@pytest.mark.parametrize(
    ("command", "name", "options"),
    [
        ("reconstruct", "x.tif", []),
        ("extract", "x.tif", []),
        ("extract", "x.tif", ["--cog"]),
        ("extract", "x.gpkg", []),
        ("extract", "x.ply", ["--level", "2"]),
        ("details", "x.tif", []),
    ],
)
def test_a_disk_that_is_full(command, name, options, sources, tiny_disk, tmp_path, capfd):
    line = [command, str(sources["dem"]), None, *options, "--overwrite", "--quiet"]
    line[2] = str(tmp_path / name)
    assert main(line) == 0
    size = (tmp_path / name).stat().st_size
    folder = tiny_disk(max(int(0.9 * size / 1000), 8))
    (folder / name).write_bytes(b"old")
    line[2] = str(folder / name)
    capfd.readouterr()
    assert main(line) == 1
    err = capfd.readouterr().err
    assert err.count("\n") == 1, err
    assert "free there" in err or "disk full" in err, err
    assert (folder / name).read_bytes() == b"old"
    assert [path.name for path in folder.iterdir()] == [name]


def contents(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_tile_set_for_globes_that_does_not_fit(sources, tmp_path, capfd):
    line = ["terrain", str(sources["dem"]), str(tmp_path / "x"), "--overwrite", "--quiet"]
    assert main(line) == 0
    old = contents(tmp_path)
    sizes = sorted({len(content) for content in old.values()})
    capfd.readouterr()
    for limit in sorted({FIRST, sizes[-2] - 1, sizes[-1] - 1}):
        with files_limited_to(limit):
            code = main(line)
        err = capfd.readouterr().err
        assert code == 1, limit
        assert err.startswith("terrain-wavelets: error: ")
        assert err.count("\n") == 1, err
        assert "unforeseen" not in err
        assert ".terrain-wavelets-" not in err, err
        assert contents(tmp_path) == old, limit


def test_a_tile_set_for_globes_on_a_full_disk(sources, tiny_disk, tmp_path, capfd):
    line = ["terrain", str(sources["dem"]), str(tmp_path / "x"), "--overwrite", "--quiet"]
    assert main(line) == 0
    files = contents(tmp_path / "x").values()
    pages = sum(-(-len(content) // 4096) * 4096 for content in files)
    folder = tiny_disk(int(0.9 * pages / 1024))
    (folder / "x").mkdir()
    (folder / "x" / "layer.json").write_bytes(b"old")
    line[2] = str(folder / "x")
    capfd.readouterr()
    assert main(line) == 1
    err = capfd.readouterr().err
    assert err.count("\n") == 1, err
    assert "No space left" in err or "free there" in err or "disk full" in err, err
    assert contents(folder) == {Path("x", "layer.json"): b"old"}
