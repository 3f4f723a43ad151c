"""The provider through ``qgis_process``, in a process of its own, with and without packages."""

import json
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from qgis_fixtures import COMMAND
from qgis_layers import (
    assert_same_raster,
    hills,
    survey,
    write_las,
    write_points,
    write_raster,
)

ROOT = Path(__file__).resolve().parents[3]

#: Put on the path of another process, this makes modules absent there.
HIDE = "import sys\nfor name in {names!r}:\n    sys.modules[name] = None\n"


@pytest.fixture
def qgis_process(qgis_environment, tmp_path_factory):
    """Return a function that runs an algorithm: ``qgis_process(id, parameters, hidden=())``."""
    assert COMMAND, "QGIS is here, but qgis_process is not"

    def run(algorithm, parameters, hidden=(), fails=False):
        folder = tmp_path_factory.mktemp("site")
        (folder / "sitecustomize.py").write_text(HIDE.format(names=list(hidden)))
        path = [str(folder), sysconfig.get_paths()["purelib"]]
        environment = {**qgis_environment, "PYTHONPATH": ":".join(path)}
        subprocess.run(
            [COMMAND, "plugins", "enable", "terrain_wavelets"],
            env=environment,
            check=False,
            capture_output=True,
        )
        arguments = [f"--{name}={value}" for name, value in parameters.items()]
        done = subprocess.run(
            [COMMAND, "run", "--json", f"terrainwavelets:{algorithm}", *arguments],
            env=environment,
            capture_output=True,
            text=True,
            timeout=900,
        )
        assert "Traceback" not in done.stderr + done.stdout, done.stderr
        if fails:
            assert done.returncode != 0
            return done.stdout + done.stderr
        assert done.returncode == 0, done.stderr[-3000:]
        return {**json.loads(done.stdout)["results"], "log": done.stderr + done.stdout}

    return run


def test_analyse_extract_reconstruct(qgis_process, tmp_path):
    path = write_raster(tmp_path / "le dem.tif", hills().astype("float32"), -9999.0)
    pyramid = str(tmp_path / "la pyramide é.gpkg")
    made = qgis_process("analysedem", {"INPUT": path, "LEVELS": 4, "OUTPUT": pyramid})
    assert made["N_LEVELS"] == 4
    level = qgis_process(
        "extractlevel", {"INPUT": pyramid, "LEVEL": 1, "TIN": str(tmp_path / "tin.gpkg")}
    )
    assert level["N_VERTICES"] < made["N_VERTICES"]
    back = qgis_process("reconstruct", {"INPUT": pyramid, "DEM": str(tmp_path / "back.tif")})
    assert back["EXACT"] == "yes"
    assert_same_raster(path, back["DEM"])


def test_without_numba_the_result_is_the_same_and_the_log_says_how_to_get_it(
    qgis_process, tmp_path
):
    path = write_raster(tmp_path / "dem.tif", hills(30, 30).astype("float32"))
    parameters = {"INPUT": path, "LEVELS": 3}
    slow = qgis_process(
        "analysedem", {**parameters, "OUTPUT": str(tmp_path / "slow.gpkg")}, ["numba"]
    )
    fast = qgis_process("analysedem", {**parameters, "OUTPUT": str(tmp_path / "fast.gpkg")})
    (line,) = {line for line in slow["log"].splitlines() if "numba is missing" in line}
    # The command of this platform, which ends with the package's name there.
    assert re.search(r"(apt install|-m pip install) .*numba", line)
    assert "numba is missing" not in fast["log"]
    assert slow["N_LEVELS"] == 3
    for figure in ("COARSE_VERTICES", "RMSE_SURFACE", "MAX_ERROR_SURFACE"):
        assert slow[figure] == pytest.approx(fast[figure], rel=1e-9), figure


@pytest.mark.parametrize(
    ("hidden", "algorithm", "file_name"),
    [
        ("scipy", "analysedem", "dem.tif"),
        ("laspy", "analysepointcloud", "points.las"),
        ("lazrs", "analysepointcloud", "points.laz"),
    ],
)
def test_a_missing_package_is_named_with_its_remedy(
    qgis_process, tmp_path, hidden, algorithm, file_name
):
    path = tmp_path / file_name
    if file_name == "dem.tif":
        write_raster(path, hills(20, 20).astype("float32"))
    else:
        path.write_bytes(b"LASF")
    parameters = {"INPUT": str(path), "OUTPUT": str(tmp_path / "o.gpkg")}
    text = qgis_process(algorithm, parameters, [hidden], fails=True)
    assert f"missing Python package: {hidden}" in text
    assert "install" in text
    assert not (tmp_path / "o.gpkg").exists()


def test_without_pythoncdt_a_cloud_is_triangulated_by_scipy(qgis_process, tmp_path):
    pytest.importorskip("laspy")
    path = write_las(tmp_path / "points.las", survey(300))
    parameters = {"INPUT": path, "LEVELS": 3, "OUTPUT": str(tmp_path / "o.gpkg")}
    assert qgis_process("analysepointcloud", parameters, ["pythoncdt"])["N_VERTICES"] == 300


def test_without_pythoncdt_breaklines_are_edges_all_the_same(qgis_process, tmp_path):
    points = write_points(tmp_path / "points.gpkg", survey(400))
    lines = tmp_path / "lines.geojson"
    line = [[700100.0, 6600200.0], [700500.0, 6600520.0], [700900.0, 6600480.0]]
    geometry = {"type": "LineString", "coordinates": line}
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::2154"}}
    feature = {"type": "Feature", "properties": {}, "geometry": geometry}
    lines.write_text(json.dumps({"type": "FeatureCollection", "crs": crs, "features": [feature]}))
    parameters = {"INPUT": points, "BREAKLINES": str(lines), "LEVELS": 2}
    made = [
        qgis_process("analysetin", {**parameters, "OUTPUT": str(tmp_path / f"{k}.gpkg")}, hidden)
        for k, hidden in enumerate([(), ("pythoncdt", "shapely")])
    ]
    for figure in ("N_VERTICES", "N_FACES", "COARSE_VERTICES", "MAX_ERROR_LINES"):
        assert made[0][figure] == pytest.approx(made[1][figure]), figure


@pytest.mark.parametrize(
    ("hidden", "package", "suffix"),
    [
        ("trimesh", "trimesh", ".glb"),
        ("ezdxf", "ezdxf", ".dxf"),
        ("serafin", "python-serafin", ".slf"),
    ],
)
def test_a_mesh_format_without_its_library(qgis_process, tmp_path, hidden, package, suffix):
    dem = write_raster(tmp_path / "dem.tif", hills(20, 20).astype("float32"))
    mesh = tmp_path / f"mesh{suffix}"
    parameters = {"INPUT": dem, "VERTICES": 50, "MESH": str(mesh)}
    text = qgis_process("simplifydem", parameters, [hidden], fails=True)
    assert f"missing Python package: {package}" in text
    assert "install" in text
    assert not mesh.exists()


def test_a_text_file_as_las_is_refused_in_one_sentence(qgis_process, tmp_path):
    path = tmp_path / "text.las"
    path.write_text("these are no points")
    parameters = {"INPUT": str(path), "OUTPUT": str(tmp_path / "o.gpkg")}
    assert "LAS" in qgis_process("analysepointcloud", parameters, fails=True)


@pytest.fixture(scope="module")
def command_line():
    """Return the path of the installed command, which lives in an environment of its own."""
    path = ROOT / ".venv" / "bin" / "terrain-wavelets"
    try:
        works = subprocess.run([path, "--help"], capture_output=True, check=False).returncode == 0
    except OSError:  # not there, or made for another machine
        works = False
    if not works:
        pytest.skip("the command terrain-wavelets is not installed in .venv here")
    return path


def test_results_equal_the_command_lines(run, command_line, tmp_path):
    values = hills(120, 90).astype("float32")
    path = write_raster(tmp_path / "dem.tif", values, epsg=4326, origin=(7.0, 44.0), cell=1 / 3600)
    of_command, of_qgis = str(tmp_path / "command.gpkg"), str(tmp_path / "qgis.gpkg")
    arguments = [
        *("--partition", "quadric", "--design", "GLMN", "--levels", "6"),
    ]
    subprocess.run([command_line, "analyse", path, of_command, "--quiet", *arguments], check=True)
    run(
        "analysedem",
        {
            "INPUT": path,
            "OUTPUT": of_qgis,
            "LEVELS": 6,
            "PARTITION": "quadric",
            "PREDICTION": "geometric",
            "UPDATE": "minimum_norm",
        },
    )
    assert "wavelet_gis" in sys.modules
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    left, right = read_pyramid(of_command), read_pyramid(of_qgis)
    assert left.frame == pytest.approx(right.frame) or left.frame == right.frame
    assert left.vertical_unit == right.vertical_unit
    assert left.pyramid.n_levels == right.pyramid.n_levels == 6
    for one, other in zip(left.pyramid.steps, right.pyramid.steps, strict=True):
        assert np.array_equal(one.odd, other.odd)
        assert np.array_equal(one.target, other.target)
        assert np.allclose(one.details, other.details, rtol=0, atol=1e-9)
    assert np.allclose(left.pyramid.coarse, right.pyramid.coarse, rtol=0, atol=1e-9)
    back = run("reconstruct", {"INPUT": of_command, "DEM": str(tmp_path / "back.tif")})
    assert_same_raster(path, back["DEM"])


@pytest.mark.data
@pytest.mark.large
def test_a_lidar_dem_through_qgis_process(qgis_process, data_folder, tmp_path):
    path = data_folder / "dems" / "TM1_564_146_1m.tif"
    pyramid = str(tmp_path / "p.gpkg")
    made = qgis_process("analysedem", {"INPUT": str(path), "LEVELS": 8, "OUTPUT": pyramid})
    assert made["N_VERTICES"] == 1_000_000
    back = qgis_process("reconstruct", {"INPUT": pyramid, "DEM": str(tmp_path / "back.tif")})
    assert_same_raster(path, back["DEM"])


@pytest.mark.data
@pytest.mark.large
@pytest.mark.parametrize("name", ["Topography.laz", "mountain_utm42_38k.las"])
def test_a_point_cloud_through_qgis_process(qgis_process, data_folder, tmp_path, name):
    laspy = pytest.importorskip("laspy")
    path = data_folder / "clouds" / name
    pyramid = str(tmp_path / "p.gpkg")
    qgis_process(
        "analysepointcloud",
        {"INPUT": str(path), "ATTRIBUTES": "classification,hag", "OUTPUT": pyramid},
    )
    back = qgis_process(
        "reconstruct", {"INPUT": pyramid, "POINT_CLOUD": str(tmp_path / f"back{path.suffix}")}
    )
    before, after = laspy.read(path), laspy.read(back["POINT_CLOUD"])
    for dimension in ("X", "Y", "Z", "classification", "intensity", "gps_time"):
        if dimension in before.point_format.dimension_names:
            assert np.array_equal(before[dimension], after[dimension]), dimension


@pytest.mark.parametrize(
    ("model", "inputs", "output", "suffix"),
    [
        ("dem_to_simplified_cog", ("INPUT",), "simplified_dem", ".tif"),
        ("dems_to_change_by_scale", ("BEFORE", "AFTER"), "change", ".tif"),
        ("dem_to_landform_clusters", ("INPUT",), "landforms", ".tif"),
    ],
)
def test_a_model_from_the_command_line_on_its_defaults(
    qgis_process, tmp_path, model, inputs, output, suffix
):
    parameters = {
        name: write_raster(
            tmp_path / f"{name}.tif", hills(50, 50, 40.0 + 5 * k).astype("float32"), cell=8.0
        )
        for k, name in enumerate(inputs)
    }
    path = tmp_path / f"result{suffix}"
    qgis_process(model, {**parameters, output: str(path)})
    assert path.stat().st_size > 0
