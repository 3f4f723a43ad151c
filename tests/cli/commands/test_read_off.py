"""The commands profile, contours and difference, and info --triangles."""

import json

import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import hills, write_tif

from wavelet_gis.cli.main import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("read_off")
    write_tif(path / "dem.tif", hills().astype("f4"))
    assert main(["analyse", str(path / "dem.tif"), str(path / "p.gpkg"), "--levels", "4"]) == 0
    line = shapely.LineString([(500010, 5099990), (500490, 5099610)])
    pyogrio.raw.write(
        path / "line.gpkg",
        np.array([shapely.to_wkb(line)], dtype=object),
        [],
        [],
        geometry_type="LineString",
        crs="EPSG:32632",
        driver="GPKG",
    )
    return path


@pytest.fixture
def told(capsys):
    def run(*arguments):
        capsys.readouterr()
        code = main([*map(str, arguments), "--json"])
        captured = capsys.readouterr()
        assert code == 0, captured.err
        return json.loads(captured.out)

    return run


@pytest.mark.parametrize(
    ("suffix", "begin"),
    [("csv", "line,distance,x,y,z_04,z_00"), ("html", "<!DOCTYPE"), ("svg", "<svg")],
)
def test_profile(folder, told, tmp_path, suffix, begin):
    path = tmp_path / f"p.{suffix}"
    figures = told("profile", folder / "p.gpkg", folder / "line.gpkg", path, "--levels", "4,0")
    assert path.read_text("utf-8").startswith(begin)
    assert figures["levels"] == [4, 0]
    assert figures["profiles"][0]["rms_difference"] == 0
    assert figures["profiles"][1]["length"] == pytest.approx(np.hypot(480, 380))


def test_contours(folder, told, tmp_path):
    figures = told("contours", folder / "p.gpkg", tmp_path / "c.gpkg", "--interval", "10")
    assert (
        pyogrio.read_info(tmp_path / "c.gpkg", layer="contours")["features"]
        == figures["n_contours"]
        > 5
    )


def test_difference(folder, told, tmp_path):
    dem = folder / "dem.tif"
    figures = told("difference", folder / "p.gpkg", tmp_path / "a.tif", "--less-dem", dem)
    other = told("difference", folder / "p.gpkg", tmp_path / "b.tif", "--less-level", "4")
    assert figures["rms"] == pytest.approx(other["rms"], rel=1e-4)
    with rasterio.open(tmp_path / "a.tif") as a, rasterio.open(tmp_path / "b.tif") as b:
        np.testing.assert_allclose(a.read(1), b.read(1), atol=1e-4)


def test_change_since_an_earlier_survey(folder, told, tmp_path):
    with rasterio.open(folder / "dem.tif") as dataset:
        z, profile = dataset.read(1), dataset.profile
    earlier = (0.9 * z - 3).astype(z.dtype)
    with rasterio.open(tmp_path / "earlier.tif", "w", **profile) as dataset:
        dataset.write(earlier, 1)
    figures = told(
        "difference", folder / "p.gpkg", tmp_path / "c.tif", "--since", tmp_path / "earlier.tif"
    )
    with rasterio.open(tmp_path / "c.tif") as raster:
        change, *bands = raster.read().astype(float)
        assert raster.descriptions == tuple(figures["band_names"])
    assert len(bands) == len(figures["bands"]) >= 2
    np.testing.assert_allclose(change, z.astype(float) - earlier, atol=1e-3)
    np.testing.assert_allclose(np.sum(bands, axis=0), change, atol=1e-3)
    for told_of, values in zip([figures, *figures["bands"]], [change, *bands], strict=True):
        assert told_of["rms"] == pytest.approx(np.sqrt((values**2).mean()), abs=1e-4) != 0
        assert told_of["lowest"] == pytest.approx(values.min(), abs=1e-4)
        assert told_of["highest"] == pytest.approx(values.max(), abs=1e-4)


def test_info_tells_of_triangles_when_asked(folder, told):
    assert "triangles" not in told("info", folder / "p.gpkg")
    rows = told("info", folder / "p.gpkg", "--triangles")["triangles"]
    assert [row["level"] for row in rows] == [0, 1, 2, 3, 4]
    assert rows[4]["median_angle"] == pytest.approx(45)


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["profile", "p.gpkg", "dem.tif", "out.csv"], "dem.tif"),
        (["profile", "p.gpkg", "line.gpkg", "out.txt"], ".csv"),
        (["contours", "p.gpkg", "out.shp"], ".gpkg"),
        (["difference", "p.gpkg", "out.tif", "--level", "8"], "no level 8"),
        (["difference", "p.gpkg", "out.tif", "--level", "0", "--since", "dem.tif"], "--level"),
        (["difference", "p.gpkg", "out.tif", "--since", "p.gpkg"], "is a pyramid"),
    ],
)
def test_refusals_are_one_line_and_write_nothing(folder, capsys, arguments, why, monkeypatch):
    monkeypatch.chdir(folder)
    assert main(arguments) == 1
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert why in error
    assert not list(folder.glob("out.*"))
