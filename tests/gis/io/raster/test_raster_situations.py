"""Rasters as they come: nodata, scale, masks, units and transforms of every kind."""

import functools
import http.server
import threading

import numpy as np
import pytest
import rasterio
from gis.samples import assert_same_raster, hills, write_tif

from wavelet_core import analyse
from wavelet_gis._memory import available_bytes, require_bytes
from wavelet_gis.errors import InputFileError, RasterWarning
from wavelet_gis.io.raster import read_dem, write_dem
from wavelet_gis.io.raster.remote import remote_reference
from wavelet_gis.products.level_raster import surface_dem
from wavelet_gis.workflows.open import open_terrain

NORTH_UP = rasterio.Affine(10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0)
PLACES = {
    "north-up": (NORTH_UP, "EPSG:32632"),
    "south-up": (rasterio.Affine(10.0, 0.0, 5e5, 0.0, 10.0, 5.1e6), None),
    "rotated": (rasterio.Affine(8.0, -6.0, 2.6e6, -6.0, -8.0, 1.2e6), "EPSG:2056"),
    "degrees": (rasterio.Affine(0.001, 0.0, 7.0, 0.0, -0.001, 44.0), "EPSG:4326"),
    "compound": (NORTH_UP, "EPSG:32632+5773"),
}


def pyramid_of(path, levels=2, **options):
    terrain = open_terrain(path, **options)
    return terrain.geo_pyramid(analyse(terrain.mesh, levels=levels))


def set_scale(path, scale, offset):
    with rasterio.open(path, "r+") as dataset:
        dataset.scales, dataset.offsets = (scale,), (offset,)


@pytest.mark.parametrize("scale", [0.1, 2.0, -1.0, 1e-3])
@pytest.mark.parametrize("dtype", ["uint16", "int16", "float32"])
def test_nodata_is_a_stored_number_and_zero_metres_are_data(tmp_path, dtype, scale):
    raw = np.rint(1000 + 500 * np.sin(np.arange(400) / 9)).astype(dtype).reshape(20, 20)
    raw[5:9, 5:9] = 1000  # 0 m with this offset
    raw[15:, 15:] = 0  # nodata
    source = write_tif(tmp_path / "a.tif", raw, nodata=0)
    set_scale(source, scale, -1000 * scale)
    geo = pyramid_of(source)
    dem = surface_dem(geo, geo.pyramid.synthesise())
    write_dem(tmp_path / "b.tif", dem, geo.system.wkt)
    with rasterio.open(tmp_path / "b.tif") as dataset:
        is_data = dataset.read_masks(1) != 0
        np.testing.assert_array_equal(is_data, raw != 0)
        expected = raw.astype(float) * scale - 1000 * scale
        np.testing.assert_allclose(dataset.read(1)[is_data], expected[is_data], atol=1e-4)


def test_a_surface_that_meets_the_nodata_value_stays_data(tmp_path):
    values = np.tile(np.linspace(-10, 10, 21), (21, 1))  # 0 m along the middle
    values[:3, :3] = -9999
    source = write_tif(tmp_path / "a.tif", values, nodata=-9999.0)
    geo = pyramid_of(source)
    altered = geo.pyramid.synthesise()
    assert surface_dem(geo, altered).nodata == -9999.0
    values[values == -9999] = 0
    values[10, 10] = 5
    source = write_tif(tmp_path / "b.tif", np.where(values == 0, 1, values), nodata=0)
    geo = pyramid_of(source, levels=1)
    mesh = geo.pyramid.synthesise()
    vertices = mesh.vertices.copy()
    vertices[200, 2] = 0.0
    dem = surface_dem(geo, type(mesh)(vertices, mesh.faces))
    assert np.isnan(dem.nodata)
    assert dem.valid.all()


@pytest.mark.parametrize("filler", [-3.4028234663852886e38, -3.4e38, 1e30, -1e32, 9.96921e36])
def test_floats_that_are_no_elevations_are_holes_and_told(tmp_path, filler):
    values = hills(12, 12).astype("f4")
    values[3:5, 3:9] = filler
    source = write_tif(tmp_path / "a.tif", values)
    with pytest.warns(RasterWarning, match="12 cells hold .*no elevation"):
        geo = pyramid_of(source)
    assert geo.origin.valid.sum() == 132
    write_dem(tmp_path / "b.tif", geo.restore(), geo.system.wkt)
    assert_same_raster(source, tmp_path / "b.tif")


@pytest.mark.parametrize(
    ("dtype", "filler"),
    [("int16", -9999), ("int16", -32768), ("uint16", 65535), ("float32", 0), ("float32", -1e7)],
)
def test_what_may_be_nodata_is_told_and_may_be_named(tmp_path, dtype, filler):
    values = hills(12, 12).astype(dtype)
    values[3:5, 3:9] = filler
    source = write_tif(tmp_path / "a.tif", values)
    with pytest.warns(RasterWarning, match=r"12 cells hold .*\(nodata "):
        assert read_dem(source)[0].valid.all()
    dem, _ = read_dem(source, nodata=float(filler))
    assert np.count_nonzero(~dem.valid) == 12


def test_terrain_by_the_sea_raises_no_doubt(tmp_path):
    values = np.maximum(hills(20, 20) - 300, 0).astype("f4")  # sea at 0 m
    read_dem(write_tif(tmp_path / "a.tif", values))
    read_dem(write_tif(tmp_path / "b.tif", np.full((5, 5), 0.0)))


def test_a_nodata_value_instead_of_the_tag(tmp_path):
    values = hills(12, 12).astype("i2")
    values[0, :5] = -1
    values[1, :5] = -2
    source = write_tif(tmp_path / "a.tif", values, nodata=-1)
    assert np.count_nonzero(~read_dem(source)[0].valid) == 5
    named = read_dem(source, nodata=-2)[0]
    assert not named.valid[1, :5].any()
    assert named.valid[0].all()
    assert read_dem(source, nodata="none")[0].valid.all()
    for value in (0.5, 1e9, float("nan")):
        with pytest.raises(InputFileError, match="int16"):
            read_dem(source, nodata=value)


@pytest.mark.parametrize("scale", [0.0, float("nan"), float("inf"), 1e300])
def test_scales_that_give_no_elevations(tmp_path, scale):
    source = write_tif(tmp_path / "a.tif", hills(8, 8).astype("i2"))
    set_scale(source, scale, 5.0)
    with pytest.raises(InputFileError, match=r"a\.tif: (the band has the scale|an elevation is)"):
        open_terrain(source)


@pytest.mark.parametrize(
    "transform",
    [
        (0.0, 0.0, 5e5, 0.0, 0.0, 5e6),
        (10.0, 0.0, 5e5, 0.0, 0.0, 5e6),
        (10.0, 10.0, 5e5, -10.0, -10.0, 5e6),
        (1.0, 0.1, 0.0, 3.0, 0.3, 0.0),  # singular but for rounding
        (float("nan"), 0.0, 5e5, 0.0, -10.0, 5e6),
        (10.0, 0.0, float("inf"), 0.0, -10.0, 5e6),
        (1e-12, 0.0, 5e5, 0.0, -1e-12, 5e6),
        (1e300, 0.0, 0.0, 0.0, -1e300, 0.0),
        (1e-320, 0.0, 0.0, 0.0, -1e-320, 0.0),
    ],
)
def test_absurd_transforms(tmp_path, transform):
    path = tmp_path / "a.vrt"
    write_tif(tmp_path / "a.tif", hills(8, 8))
    a, b, c, d, e, f = transform
    path.write_text(
        '<VRTDataset rasterXSize="8" rasterYSize="8">'
        f"<GeoTransform>{c}, {a}, {b}, {f}, {d}, {e}</GeoTransform>"
        '<VRTRasterBand dataType="Float64" band="1"><SimpleSource>'
        '<SourceFilename relativeToVRT="1">a.tif</SourceFilename><SourceBand>1</SourceBand>'
        "</SimpleSource></VRTRasterBand></VRTDataset>"
    )
    with pytest.raises(InputFileError, match="geotransform"):
        open_terrain(path)


@pytest.mark.parametrize("name", ["bidx", "ns", "self", "NS", "Bidx", "kwargs"])
def test_tags_of_any_name_come_back(tmp_path, name):
    source = tmp_path / "a.tif"
    dem, place = read_dem(write_tif(tmp_path / "plain.tif", hills(8, 8).astype("f4")))
    dem.profile["tags"][name] = "of the file"
    dem.profile["band_tags"][name] = "of the band"
    dem.profile["tags"]["other"] = "too"
    write_dem(source, dem, place.wkt)
    geo = pyramid_of(source, levels=1)
    write_dem(tmp_path / "b.tif", geo.restore(), geo.system.wkt)
    assert_same_raster(source, tmp_path / "b.tif")
    with rasterio.open(tmp_path / "b.tif") as dataset:
        assert dataset.tags()[name] == "of the file"
        assert dataset.tags(1)[name] == "of the band"
        assert dataset.tags()["other"] == "too"


def test_lone_cells_and_strips_are_in_the_raster(tmp_path):
    values = np.full((30, 30), -1.0)
    values[:12, :12] = hills(12, 12)
    values[20, 3:23] = np.arange(20) + 300.0
    values[3:13, 25] = 250.0
    values[27, 27] = 777.0
    for name in ("north-up", "rotated"):
        transform, crs = PLACES[name]
        source = tmp_path / f"{name}.tif"
        write_tif(source, values, nodata=-1.0, transform=transform, crs=crs)
        geo = pyramid_of(source, levels=3)
        for level in range(4):
            dem = surface_dem(geo, geo.pyramid.mesh(level))
            np.testing.assert_array_equal(dem.valid, values != -1.0)
            assert dem.values[27, 27] == 777.0
            assert (dem.values[20, 3:23] == values[20, 3:23]).all()


def test_the_own_cell_size_gives_the_own_grid(tmp_path):
    source = write_tif(tmp_path / "a.tif", hills(20, 25).astype("f4"))
    geo = pyramid_of(source)
    mesh = geo.pyramid.synthesise()
    own = surface_dem(geo, mesh)
    same = surface_dem(geo, mesh, cell_size=10.0)
    assert same.geometry == own.geometry
    assert same.values.tobytes() == own.values.tobytes()
    coarse = surface_dem(geo, mesh, cell_size=20.0)
    assert coarse.geometry.shape == (10, 13)
    assert coarse.geometry.transform == (20.0, 0.0, 500000.0, 0.0, -20.0, 5100000.0)


def test_memory_is_estimated_before_the_work(tmp_path):
    with pytest.raises(InputFileError, match=r"a: 9 cells need about 2\.0 GB.*1\.0 GB are free"):
        require_bytes(2 * 10**9, "a", "9 cells", available=10**9)
    require_bytes(10**9, "a", "9 cells", available=10**9)
    assert available_bytes() is None or available_bytes() > 0


def test_a_raster_beyond_memory_is_refused_unread(tmp_path):
    with rasterio.open(
        tmp_path / "huge.tif",
        "w",
        driver="GTiff",
        width=2_000_000,
        height=2_000_000,
        count=1,
        dtype="uint8",
        compress="deflate",
        tiled=True,
        blockxsize=4096,
        blockysize=4096,
        sparse_ok=True,
        bigtiff=True,
        crs="EPSG:32632",
        transform=NORTH_UP,
    ):
        pass
    with pytest.raises(InputFileError, match="GB of memory"):
        read_dem(tmp_path / "huge.tif")


@pytest.fixture
def server(tmp_path):
    """Yield the address of a folder that is served, and the names asked for."""
    (tmp_path / "www").mkdir()
    write_tif(tmp_path / "www" / "a.tif", hills(8, 8).astype("f4"))
    asked = []

    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *arguments):
            asked.append(self.path)

    handler = functools.partial(Handler, directory=str(tmp_path / "www"))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as running:
        thread = threading.Thread(target=running.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{running.server_port}", asked
        running.shutdown()
        thread.join()


def vrt(path, source, relative=0):
    path.write_text(
        '<VRTDataset rasterXSize="8" rasterYSize="8"><GeoTransform>0, 10, 0, 0, 0, -10'
        '</GeoTransform><VRTRasterBand dataType="Float32" band="1"><SimpleSource>'
        f'<SourceFilename relativeToVRT="{relative}">{source}</SourceFilename>'
        "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>"
    )
    return path


@pytest.mark.parametrize("name", ["a.vrt", "a.tif", "nested.vrt"])
def test_a_raster_that_reads_from_the_network(tmp_path, server, name, monkeypatch):
    monkeypatch.setenv("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR")
    address, asked = server
    path = vrt(tmp_path / name, f"/vsicurl/{address}/a.tif")
    if name == "nested.vrt":
        vrt(tmp_path / "inner.tif", f"/vsicurl/{address}/a.tif")
        path = vrt(tmp_path / name, "inner.tif", relative=1)
    with pytest.raises(InputFileError, match="offline forbids"):
        read_dem(path, offline=True)
    assert asked == []
    with pytest.warns(RasterWarning, match="over the network"):
        dem, _ = read_dem(path)
    assert dem.values.shape == (8, 8)
    assert asked


def test_local_rasters_refer_to_nothing(tmp_path):
    local = write_tif(tmp_path / "a.tif", hills(8, 8))
    assert remote_reference(local) is None
    assert remote_reference(vrt(tmp_path / "b.vrt", "a.tif", relative=1)) is None
    assert remote_reference(vrt(tmp_path / "c.vrt", "c.vrt", relative=1)) is None  # itself
    assert remote_reference("/vsis3/bucket/a.tif") == "/vsis3/bucket/a.tif"


@pytest.mark.parametrize("name", ["a.xyz", "a.csv", "a.txt"])
def test_points_as_text_are_named(tmp_path, name):
    between = "," if name == "a.csv" else " "
    rows = [between.join(map(str, (k * 1.7, (k * k) % 11, k))) for k in range(30)]
    (tmp_path / name).write_text("\n".join(["x,y,z"] * (name == "a.csv") + rows))
    with pytest.raises(InputFileError, match=r"text file of points.*pdal"):
        read_dem(tmp_path / name)
