"""Each kind of wrong result, on five inputs made for it; none of them is a file of a report.

What a tool may get wrong without a word: errors that are not measured where they are claimed,
nodata, units, files beside the output, names, clouds, learning, noise, words, hostile files, loss,
and what else is in the process or on the disk.
"""

import os
import sqlite3
import struct
import xml.etree.ElementTree as ElementTree
from contextlib import closing

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import assert_same_raster, hills, write_las, write_tif
from tools.second_opinion import read_ply, second_opinion

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")

PLAN = np.random.default_rng(21).uniform(0, 80, (250, 2))
SMOOTH = np.column_stack([PLAN, 50 + 4 * np.sin(PLAN[:, 0] / 9)])


def write_cloud(path, points, classes=2, version="1.2", point_format=1, **dimensions):
    header = laspy.LasHeader(version=version, point_format=point_format)
    header.scales, header.offsets = [0.001] * 3, [4e5, 5e6, 0.0]
    las = laspy.LasData(header)
    las.x, las.y, las.z = points[:, 0] + 4e5, points[:, 1] + 5e6, points[:, 2]
    las.classification = np.broadcast_to(classes, len(points)).astype(np.uint8)
    for name, values in dimensions.items():
        setattr(las, name, np.broadcast_to(values, len(points)))
    las.write(path)
    return np.column_stack([las.x, las.y, las.z])


# -- 1: what was measured is what is claimed


def stacked(n, height):
    return np.concatenate([SMOOTH, SMOOTH[:n] + np.array([0.0, 0.0, height])])


THREE = np.repeat(SMOOTH, 3, axis=0) + np.tile([[0, 0, 0], [0, 0, 2], [0, 0, 9.0]], (250, 1))
FAR = np.concatenate([SMOOTH, SMOOTH[:1] + np.array([900.0, 900.0, 40.0])])


@pytest.mark.parametrize(
    ("suffix", "points"),
    [
        (".las", stacked(200, 7.0)),
        (".las", THREE),
        (".csv", stacked(30, -11.0)),
        (".xyz", stacked(250, 0.25)),
        (".laz", FAR),
    ],
    ids=["wall", "three at each place", "pits", "all twice", "one far off"],
)  # fmt: skip
def test_an_error_is_that_of_every_point(tmp_path, done, suffix, points):
    source = tmp_path / f"a{suffix}"
    if suffix[:3] == ".la":
        points = write_cloud(source, points)
    else:
        np.savetxt(source, points, delimiter=",", fmt="%.3f")
        points = np.loadtxt(source, delimiter=",")
    for flags in (["--vertices", 90], ["--max-error", 0.3]):
        output = tmp_path / f"{flags[1]}.ply"
        figures = done("simplify", source, output, *flags, "--json").figures
        opinion = second_opinion(*read_ply(output), points)
        assert figures["max_error"] == pytest.approx(opinion.largest, abs=1e-6)
        assert figures["rmse"] == pytest.approx(opinion.rmse, abs=1e-6)
        assert opinion.n_uncovered == 0


# -- 2: nodata and scales of rasters


def high_as(filler, dtype="f8"):
    """Return hills whose tops hold a filler."""
    return np.where(hills(20, 20) > 320, filler, hills(20, 20)).astype(dtype)


@pytest.mark.parametrize(
    ("values", "tag", "scale", "n_holes"),
    [
        (high_as(0, "i2"), None, (0.01, 500.0), 0),
        (high_as(9.96921e36), None, None, "told"),
        (high_as(-1e32), -9999.0, None, "told"),
        (high_as(1000, "u2"), 1000, (0.1, -50.0), "tag"),
        (high_as(-np.inf, "f4"), 0.0, (2.0, 1.0), "tag"),
    ],
    ids=["zero is data", "netCDF's filler", "tag and filler", "scaled tag", "infinite"],
)  # fmt: skip
def test_a_raster_has_the_holes_that_it_has(tmp_path, done, values, tag, scale, n_holes):
    source = write_tif(tmp_path / "a.tif", values, nodata=tag)
    if scale:
        with rasterio.open(source, "r+") as dataset:
            dataset.scales, dataset.offsets = (scale[0],), (scale[1],)
    outcome = done("analyse", source, tmp_path / "p.gpkg", "--levels", 2, "--json")
    expected = int((hills(20, 20) > 320).sum()) if n_holes else 0
    assert outcome.figures["n_vertices"] == 400 - expected
    assert ("which is no elevation" in outcome.err) == (n_holes == "told")
    done("reconstruct", tmp_path / "p.gpkg", tmp_path / "b.tif")
    with rasterio.open(source) as one, rasterio.open(tmp_path / "b.tif") as other:
        assert one.read(1).tobytes() == other.read(1).tobytes()
        assert repr(one.nodata) == repr(other.nodata)


# -- 3: units


@pytest.mark.parametrize(
    ("crs", "place", "cell", "unit_of_x", "unit_name"),
    [
        ("EPSG:2264", (2e6, 7e5), 30.0, 1200 / 3937, "USSurveyFoot"),
        ("EPSG:2992", (8e5, 1e6), 30.0, 0.3048, "foot"),
        ("EPSG:3006", (6e5, 6.6e6), 10.0, 1.0, "meter"),
        ("EPSG:4258", (12.0, 52.0), 1 / 3600, None, "meter"),
        ("EPSG:6318", (-105.0, 40.0), 1 / 3600, None, "meter"),
    ],
)
def test_a_mesh_file_has_one_unit(tmp_path, done, crs, place, cell, unit_of_x, unit_name):
    transform = rasterio.Affine(cell, 0, place[0], 0, -cell, place[1])
    source = write_tif(tmp_path / "a.tif", hills(12, 14).astype("f4"), crs=crs, transform=transform)
    done("simplify", source, tmp_path / "a.xml", "--vertices", 168, "--vertical-unit", "metre")
    root = ElementTree.parse(tmp_path / "a.xml").getroot()
    spaced = {element.tag.split("}")[-1]: element for element in root.iter()}
    units = spaced.get("Metric", spaced.get("Imperial"))
    assert units.get("linearUnit") == unit_name
    texts = [element.text for element in root.iter() if element.tag.endswith("}P")]
    points = np.array([[float(word) for word in text.split()] for text in texts])
    metre = 1.0 if unit_of_x is None else unit_of_x
    relief = float(np.ptp(hills(12, 14).astype("f4")))
    assert np.ptp(points[:, 2]) * metre == pytest.approx(relief, rel=1e-4)
    if unit_of_x is None:  # northing first
        assert np.ptp(points[:, 0]) == pytest.approx(11 * 1852 / 60, rel=0.05)


# -- 4: files beside the output


@pytest.mark.parametrize(
    ("output", "beside", "stays"),
    [
        ("x.2dm", "x.prj", True),
        ("x.tif", "x.tif.aux.xml", False),
        ("x.tif", "x.tif.ovr", False),
        ("x.gpkg", "x.gpkg-journal", False),
        ("x.tif", "x.tfw", True),
    ],
)
def test_an_output_owns_its_companions(tmp_path, done, pyramid, output, beside, stays):
    path, other = tmp_path / output, tmp_path / beside
    if not stays:
        done("extract", pyramid, path)
    other.write_bytes(b"old")
    if output.endswith(".2dm"):
        (tmp_path / "x.shp").write_bytes(b"a shapefile's")
    outcome = done("extract", pyramid, path, "--overwrite")
    assert other.exists() == stays
    if stays:
        assert other.read_bytes() == b"old"
        assert beside in outcome.err
    if output.endswith(".tif"):
        with rasterio.open(path) as dataset:
            assert dataset.crs.to_epsg() == 32632


# -- 5: names


@pytest.mark.parametrize(
    "name", ["a;b!c", "100% #1?", "новый файл", "two\nlines", "-flag 'quoted\" $HOME `x` &"]
)
def test_any_name_works_for_every_output(tmp_path, done, tif, name):
    pyramid = tmp_path / f"{name}.gpkg"
    done("analyse", tif, pyramid, "--levels", 2)
    for suffix in (".tif", ".gpkg", ".ply", ".2dm", ".stl", ".xml"):
        done("extract", pyramid, tmp_path / f"{name} out{suffix}")
    done("reconstruct", pyramid, tmp_path / f"{name} back.tif")
    assert_same_raster(tif, tmp_path / f"{name} back.tif")
    stems = {path.name.rsplit(".", 1)[0] for path in tmp_path.iterdir()}
    assert stems == {name, f"{name} out", f"{name} back"}


# -- 6: point clouds


def spike(kind):
    points = np.concatenate([SMOOTH, [[40.0, 40.0, -900.0]]])
    is_spike = np.arange(251) == 250
    classes = np.where(is_spike & (kind in (7, 18)), kind if kind in (7, 18) else 2, 2)
    return points, classes, is_spike


@pytest.mark.parametrize(
    ("kind", "version", "point_format"),
    [(7, "1.2", 0), (18, "1.4", 6), ("withheld", "1.4", 7), ("withheld", "1.1", 1), (7, "1.3", 3)],
)
def test_noise_makes_no_pit_and_comes_back(tmp_path, done, kind, version, point_format):
    points, classes, is_spike = spike(kind)
    extra = {"withheld": is_spike} if kind == "withheld" else {}
    write_cloud(tmp_path / "a.las", points, classes, version, point_format, **extra)
    outcome = done("analyse", tmp_path / "a.las", tmp_path / "p.gpkg", "--levels", 2, "--json")
    assert outcome.figures["n_vertices"] == 250
    assert "1 point" in outcome.err
    done("extract", tmp_path / "p.gpkg", tmp_path / "x.tif")
    with rasterio.open(tmp_path / "x.tif") as dataset:
        assert dataset.read(1, masked=True).min() > 40
    done("reconstruct", tmp_path / "p.gpkg", tmp_path / "b.las")
    assert (tmp_path / "b.las").read_bytes() == (tmp_path / "a.las").read_bytes()


# -- 7: learning


@pytest.mark.parametrize("seed", range(5))
def test_a_label_that_says_nothing_is_not_learned(tmp_path, done, seed):
    """Classes drawn at random: whatever is told of held-out blocks must be near chance."""
    pytest.importorskip("sklearn")
    rng = np.random.default_rng(seed)
    plan = rng.uniform(0, 200, (1500, 2))
    z = 50 + 4 * np.sin(plan[:, 0] / 19) + 0.2 * rng.standard_normal(1500)
    classes = rng.choice([2, 5], 1500)
    write_cloud(tmp_path / "a.las", np.column_stack([plan, z]), classes, "1.4", 6)
    lifted = ["--attributes", "classification"] + (["--class-channels"] if seed % 2 else [])
    done("analyse", tmp_path / "a.las", tmp_path / "p.gpkg", "--levels", 4, *lifted)
    figures = done(
        "cluster", tmp_path / "p.gpkg", tmp_path / "c.gpkg", "--learn", "las", "--json"
    ).figures
    confusion = np.array(figures["validation"]["confusion"])
    share = np.trace(confusion) / confusion.sum()
    assert 0.4 < share < 0.6
    with closing(sqlite3.connect(tmp_path / "c.gpkg")) as database, database:
        (table,) = database.execute("SELECT table_name FROM gpkg_contents").fetchone()
        found = {row[0] for row in database.execute(f'SELECT DISTINCT class FROM "{table}"')}
    assert found <= {2, 5}


# -- 8: noise


@pytest.mark.parametrize(
    ("surface", "noise", "options"),
    [
        (np.add.outer(np.arange(60.0), np.arange(60.0)), 0.5, ["--denoise"]),
        (np.full((60, 60), 100.0), 0.2, ["--denoise", "50"]),
        (hills(60, 60), 0.0, ["--denoise", "3"]),
        (hills(60, 60), 3.0, ["--denoise", "--noise-range", "auto"]),
        (hills(60, 60), 2.0, ["--denoise", "--local-noise", "--outliers"]),
    ],
    ids=["a plane", "far too strong", "clean", "white, range unknown", "everything on"],
)
def test_denoising_ends_and_does_not_make_it_worse(tmp_path, done, surface, noise, options):
    added = noise * np.random.default_rng(2).standard_normal(surface.shape)
    source = write_tif(tmp_path / "a.tif", surface + added)
    done("analyse", source, tmp_path / "p.gpkg", "--levels", 3, "--layers", "none")
    done("filter", tmp_path / "p.gpkg", tmp_path / "b.tif", *options, "--pyramids", 2)
    with rasterio.open(tmp_path / "b.tif") as dataset:
        rmse = float(np.sqrt(np.mean((dataset.read(1) - surface) ** 2)))
    assert rmse < max(0.8 * noise, 1.2)


# -- 9: words


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.xyz", b"one two three\nfour five six\n", "no column x"),
        ("a.csv", b"x,y,z\n1,2\n3,4\n", "not a table of numbers"),
        ("a.tif", b"no raster at all", "no raster that GDAL can open"),
        ("a.las", b"LASF", "damaged"),
        ("a.gpkg", b"SQLite format 3\0" + bytes(50), "neither a raster nor a layer"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_refusal_says_what_is_wrong(tmp_path, refused, name, content, told):
    (tmp_path / name).write_bytes(content)
    line = refused("analyse", tmp_path / name, tmp_path / "p.gpkg")
    assert told in line
    assert "disk" not in line
    assert name in line


# -- 10: hostile files


def changed(pyramid, path, sql):
    path.write_bytes(pyramid.read_bytes())
    with closing(sqlite3.connect(path)) as database, database:
        database.execute(sql)
    return path


@pytest.mark.parametrize(
    "sql",
    [
        "UPDATE wavelet_levels SET n_vertices = 9e18 WHERE level = 0",
        "UPDATE wavelet_metadata SET value = '[' || value || ']' WHERE name = 'crs'",
        "UPDATE wavelet_metadata SET value = replace(value, '1.0', '1e400') WHERE name = 'frame'",
        "UPDATE wavelet_arrays SET shape = '[4294967296, 4294967296]' WHERE id = 1",
        "UPDATE wavelet_chunks SET data = zeroblob(length(data)) WHERE id = 2",
    ],
)
def test_a_pyramid_that_was_tampered_with_is_refused(tmp_path, refused, pyramid, sql):
    path = changed(pyramid, tmp_path / "p.gpkg", sql)
    for command, output in (("extract", "x.tif"), ("reconstruct", "y.tif"), ("report", "z.html")):
        assert "unforeseen" not in refused(command, path, tmp_path / output)


# -- 11: loss


@pytest.mark.parametrize("seed", range(5))
def test_what_analyse_writes_of_a_dem_full_of_holes_comes_back(tmp_path, done, seed):
    rng = np.random.default_rng([11, seed])
    values = hills(45, 50, seed).astype("f4")
    values[rng.random(values.shape) < rng.uniform(0.15, 0.45)] = np.nan
    source = write_tif(tmp_path / "a.tif", values)
    done("analyse", source, tmp_path / "p.gpkg")
    assert "kept to the last bit" in done("info", tmp_path / "p.gpkg").out
    done("reconstruct", tmp_path / "p.gpkg", tmp_path / "b.tif")
    assert_same_raster(source, tmp_path / "b.tif")


# -- 12: neighbours in the process and on the disk


def test_a_link_is_written_through(tmp_path, done, pyramid):
    (tmp_path / "there").mkdir()
    done("extract", pyramid, tmp_path / "there" / "x.ply")
    (tmp_path / "x.ply").symlink_to(tmp_path / "there" / "x.ply")
    (tmp_path / "there" / "x.ply").write_bytes(b"old")
    done("extract", pyramid, tmp_path / "x.ply", "--overwrite")
    assert (tmp_path / "x.ply").is_symlink()
    assert (tmp_path / "there" / "x.ply").read_bytes().startswith(b"ply")


def test_mode_and_bytes_stay(tmp_path, done, tif, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")  # else the second they are written in
    for name in ("a.gpkg", "b.gpkg"):
        done("analyse", tif, tmp_path / name, "--levels", 2)
    assert (tmp_path / "a.gpkg").read_bytes() == (tmp_path / "b.gpkg").read_bytes()
    os.chmod(tmp_path / "a.gpkg", 0o640)
    done("analyse", tif, tmp_path / "a.gpkg", "--levels", 2, "--overwrite")
    assert (tmp_path / "a.gpkg").stat().st_mode & 0o777 == 0o640


def test_a_raster_of_the_network_by_a_plain_suffix(tmp_path, refused):
    (tmp_path / "a.tif").write_text(
        '<VRTDataset rasterXSize="9" rasterYSize="9"><VRTRasterBand dataType="Float32" band="1">'
        "<SimpleSource><SourceFilename>/vsicurl/http://127.0.0.1:9/x.tif</SourceFilename>"
        "</SimpleSource></VRTRasterBand></VRTDataset>"
    )
    line = refused("analyse", tmp_path / "a.tif", tmp_path / "p.gpkg", "--offline")
    assert "--offline forbids" in line


def test_a_raster_that_claims_more_than_there_is_memory(tmp_path, refused):
    source = tmp_path / "a.tif"
    profile = {"driver": "GTiff", "dtype": "float32", "count": 1, "width": 300_000}
    profile |= {"height": 300_000, "sparse_ok": True, "tiled": True, "bigtiff": "YES"}
    with rasterio.open(source, "w", crs="EPSG:32632",
                       transform=rasterio.Affine(1, 0, 9, 0, -1, 9), **profile):  # fmt: skip
        pass
    assert "GB of memory" in refused("analyse", source, tmp_path / "p.gpkg")


def test_a_laz_whose_chunks_claim_too_much(tmp_path, refused):
    path = write_las(tmp_path / "a.laz", 500)
    content = bytearray(path.read_bytes())
    (start,) = struct.unpack_from("<I", content, 96)
    (table,) = struct.unpack_from("<q", content, start)
    struct.pack_into("<I", content, table + 4, 0x7FFFFFFF)
    path.write_bytes(content)
    assert "table of chunks" in refused("analyse", path, tmp_path / "p.gpkg")
