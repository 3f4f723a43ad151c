"""Any name that the system allows works for every input and output, or is refused at once."""

import os
import shutil
import sqlite3
from contextlib import closing

import numpy as np
import pyogrio
import pytest
import rasterio
from gis.samples import hills, write_las, write_tif
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from wavelet_gis.cli.main import main
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.atomic import check_output
from wavelet_gis.io.names import file_of
from wavelet_gis.io.raster import read_dem

#: All that may be in a name, with what libraries read something into more often than by chance.
NAMES = st.text(
    st.sampled_from("!;%#?:&*'\"\\ .-[]{}()=,@~$<>|\n\té漢") | st.characters(codec="utf-8"),
    min_size=1,
    max_size=20,
).filter(lambda name: "/" not in name and "\0" not in name and name not in (".", ".."))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("names")
    write_tif(folder / "source.tif", hills(12, 13).astype("f4"))
    write_las(folder / "source.las", 100)
    return folder


def run(*arguments):
    assert main([*map(str, arguments), "--quiet"]) == 0


@pytest.mark.skipif(os.name != "posix", reason="Windows forbids many of these names")
@settings(
    max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(folder=NAMES, name=NAMES)
@example(folder="!old work", name="x!y")
@example(folder="a;b", name="x;y")
@example(folder="GPKG:a", name="zip:")
@example(folder="50%", name="a?b#c%20d")
@example(folder=" a ", name="-x ")
@example(folder="/vsimem".strip("/"), name=":memory:")
@example(folder="n\nl", name="\n")
def test_any_name_works_or_is_refused(place, folder, name):
    there = place / folder
    if len(os.fsencode(there / name)) > 400 or len(os.fsencode(name)) > 200:
        return
    there.mkdir()
    here = os.getcwd()
    try:
        shutil.copy(place / "source.tif", there / f"{name}.tif")
        shutil.copy(place / "source.las", there / f"{name}.las")
        os.chdir(there)
        for prefix in ("./", f"{there}/"):
            run("analyse", f"{prefix}{name}.tif", f"{prefix}{name}.gpkg", "--levels", "1")
            run("extract", f"{prefix}{name}.gpkg", f"{prefix}{name} 2.gpkg")
            run("extract", f"{prefix}{name}.gpkg", f"{prefix}{name}.ply")
            run("reconstruct", f"{prefix}{name}.gpkg", f"{prefix}{name} 2.tif")
            run("simplify", f"{prefix}{name}.las", f"{prefix}{name} 3.tif", "--vertices", "30")
            made = {f"{name}{end}" for end in (".tif", ".las", ".gpkg", " 2.gpkg", ".ply")}
            made |= {f"{name} 2.tif", f"{name} 3.tif"}
            assert set(os.listdir(there)) == made
            same = (there / f"{name}.tif").read_bytes(), (there / f"{name} 2.tif").read_bytes()
            assert len(same[1]) > 0
            with closing(sqlite3.connect(f"{there}/{name}.gpkg")) as connection, connection:
                rows = connection.execute("SELECT COUNT(*) FROM coarse_tin").fetchone()
            connection.close()
            assert rows[0] > 0
            for end in (".gpkg", " 2.gpkg", ".ply", " 2.tif", " 3.tif"):
                (there / f"{name}{end}").unlink()
        assert set(os.listdir(place)) == {"source.tif", "source.las", folder}
    finally:
        os.chdir(here)
        shutil.rmtree(there)


def test_a_file_that_is_called_like_a_sub_dataset_is_itself(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_tif(tmp_path / "GPKG:a.gpkg:dem", hills(5, 6))
    assert read_dem("GPKG:a.gpkg:dem")[0].values.shape == (5, 6)


def test_names_that_cannot_be_are_refused_at_once(tmp_path):
    for name in ("x" * 300 + ".tif", "a\0.tif"):
        with pytest.raises(OutputFileError, match="the system refuses this name"):
            check_output(tmp_path / name)
    deep = tmp_path
    for _ in range(6):
        deep = deep / ("d" * 80)
    deep.mkdir(parents=True)
    with pytest.raises(OutputFileError, match="500 bytes"):
        check_output(deep / "a.gpkg")
    check_output(deep / "a.tif")


@pytest.mark.skipif(os.name != "posix", reason="names of POSIX are bytes")
def test_a_name_that_is_no_utf8_is_refused_at_once(tmp_path):
    name = os.fsdecode(os.fsencode(tmp_path) + b"/\xff.tif")
    with pytest.raises(OutputFileError, match="UTF-8"):
        check_output(name)
    write_tif(tmp_path / "a.tif", hills(5, 6))
    os.rename(tmp_path / "a.tif", name)
    with pytest.raises(InputFileError, match="UTF-8"):
        read_dem(name)


@pytest.fixture
def two_tables(tmp_path):
    """Return a GeoPackage of two rasters."""
    path = tmp_path / "two tables.gpkg"
    transform = rasterio.Affine(10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0)
    for k, table in enumerate(("dem1", "dem2")):
        with rasterio.open(
            path,
            "w",
            driver="GPKG",
            width=8,
            height=8,
            count=1,
            dtype="float32",
            crs="EPSG:32632",
            transform=transform,
            RASTER_TABLE=table,
            **({"APPEND_SUBDATASET": "YES"} if k else {}),
        ) as dataset:
            dataset.write(np.full((8, 8), 100.0 + k, "f4"), 1)
    return path


def test_sub_datasets_are_inputs(two_tables, monkeypatch):
    with pytest.raises(InputFileError, match=r"GPKG:.*two tables\.gpkg:dem2"):
        read_dem(two_tables)
    assert read_dem(f"GPKG:{two_tables}:dem2")[0].values[0, 0] == 101.0
    monkeypatch.chdir(two_tables.parent)
    assert read_dem("GPKG:two tables.gpkg:dem1")[0].values[0, 0] == 100.0
    with pytest.raises(InputFileError, match="no such file"):
        read_dem("GPKG:three tables.gpkg:dem1")
    with pytest.raises(OutputFileError, match="input itself"):
        check_output(two_tables, overwrite=True, inputs=(f"GPKG:{two_tables}:dem2",))


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("a.nc", "a.nc"),
        ('NETCDF:"a.nc":z', "a.nc"),
        ('HDF5:"a.nc"://g/z', "a.nc"),
        ("GTIFF_DIR:1:a.nc", "a.nc"),
        ("GPKG:b:c.nc:t", "b:c.nc"),
        ("NETCDF:none.nc:z", None),
        ('NETCDF:"none.nc":z', None),
    ],
)
def test_the_file_in_a_name(tmp_path, monkeypatch, name, file):
    monkeypatch.chdir(tmp_path)
    for made in ("a.nc", "b:c.nc"):
        (tmp_path / made).write_text("")
    assert file_of(name) == file


def test_layers_of_a_folder_with_a_bang_stay_in_it(tmp_path, monkeypatch):
    (tmp_path / "a!b").mkdir()
    monkeypatch.chdir(tmp_path)
    write_tif(tmp_path / "b", hills(8, 9))
    run("analyse", "b", "a!b/x!y.gpkg", "--levels", "1")
    assert sorted(os.listdir(tmp_path)) == ["a!b", "b"]
    assert os.listdir(tmp_path / "a!b") == ["x!y.gpkg"]
    shutil.copy(tmp_path / "a!b" / "x!y.gpkg", tmp_path / "plain.gpkg")
    assert "coarse_tin" in {name for name, _ in pyogrio.list_layers(tmp_path / "plain.gpkg")}
