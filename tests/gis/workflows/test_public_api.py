"""The public door: `import wavelet_gis as wg`, each function on real files and objects."""

import json
import subprocess
import sys

import numpy as np
import pytest
import rasterio
from gis.samples import assert_same_cloud, assert_same_raster, hills, write_tif

import wavelet_gis as wg
from wavelet_core import OptionError, PyramidError, TriangleMesh
from wavelet_gis.errors import CrsWarning, InputFileError, OutputFileError
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.terrain import Terrain


@pytest.fixture(scope="module")
def analysis(tif):
    return wg.analyse(wg.open(tif), levels=4)


def test_the_example_of_the_package_runs(tif, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    dem = wg.open(tif)
    wg.save(wg.simplify(dem, vertices=100), "coarse.ply")
    wg.save(wg.analyse(dem, levels=3), "dem.gpkg")
    wg.load("dem.gpkg").restore("same_dem.tif")
    assert_same_raster(tif, "same_dem.tif")
    assert wg.open("dem.gpkg").n_levels == 3
    assert (tmp_path / "coarse.ply").stat().st_size > 1000


def test_every_public_name_is_there_and_importing_is_light():
    assert set(wg.__all__) <= set(dir(wg))
    for name in wg.__all__:
        assert getattr(wg, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = wg.nonsense
    code = (
        "import sys, wavelet_gis;"
        "print(sorted({'numpy', 'scipy', 'rasterio', 'wavelet_core'} & set(sys.modules)))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert said.stdout == "[]\n", said.stderr


def test_the_workflows_need_numpy_and_scipy_only():
    code = (
        "import sys\n"
        "import wavelet_gis.workflows.analyse, wavelet_gis.workflows.simplify\n"
        "import wavelet_gis.workflows.extract, wavelet_gis.workflows.filtering\n"
        "import wavelet_gis.workflows.learning.cluster, wavelet_gis.workflows.details\n"
        "import wavelet_gis.workflows.open\n"
        "heavy = {'rasterio', 'pyogrio', 'laspy', 'pyproj', 'shapely', 'sklearn', 'matplotlib'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert said.stdout == "[]\n", said.stderr


def test_figures_are_json(analysis):
    results = [
        analysis,
        wg.extract(analysis, level=1),
        wg.filter(analysis, gains={3: 0.0}),
        wg.details(analysis),
        wg.reconstruct(analysis),
    ]
    for result in results:
        assert json.loads(json.dumps(result.figures()))


@pytest.mark.parametrize(
    ("rules", "said"),
    [
        ({"vertices": 50, "refine": 3}, "refine goes with max_error"),
        ({"vertices": 50, "zone_field": "m"}, "zone_field goes with zones"),
        ({"level": 1, "zone_field": "m"}, "zone_field goes with zones"),
    ],
)
def test_what_extract_would_not_heed_is_refused(analysis, rules, said):
    """It was passed over without a word."""
    with pytest.raises(OptionError, match=said):
        wg.extract(analysis, **rules)


def test_the_shape_has_no_channel(analysis):
    """One was passed over without a word, also one that there is not."""
    with pytest.raises(OptionError, match="channel is not for what shape"):
        wg.details(analysis, what="shape", channel="class")


def test_extract_tells_the_errors_of_its_level(analysis):
    surface = wg.extract(analysis, level=2)
    expected = analysis.geo.errors_at(2)
    assert surface.errors.rmse == expected.rmse_surface
    assert surface.errors.max_error == expected.max_error_surface
    assert wg.extract(analysis).level == 0
    between = (surface.mesh.n_vertices + wg.extract(analysis, level=3).mesh.n_vertices) // 2
    part = wg.extract(analysis, vertices=between)
    assert part.mesh.n_vertices == between
    assert expected.max_error_surface >= part.errors.max_error > 0
    with pytest.raises(OptionError, match="one of level, vertices and max_error"):
        wg.extract(analysis, level=1, vertices=100)
    with pytest.raises(PyramidError, match="0 to 4"):
        wg.extract(analysis, level=9)


def test_simplify_fits_for_the_mean_square_and_not_for_the_largest_error(tif):
    dem = wg.open(tif)
    by_size = wg.simplify(dem, vertices=150)
    plain = wg.simplify(dem, vertices=150, fit=False)
    assert by_size.is_fitted
    assert not plain.is_fitted
    assert by_size.errors.rmse < plain.errors.rmse
    by_error = wg.simplify(dem, max_error=5.0)
    assert not by_error.is_fitted
    assert by_error.errors.max_error <= 5.0
    again = by_size.analysis().restore()
    assert isinstance(again, Dem)
    assert again.values.tobytes() == dem.original.values.tobytes()
    with pytest.raises(OptionError, match="one of vertices, max_error and max_rms"):
        wg.simplify(dem)


def test_a_filtered_pyramid_restores_and_differs(analysis, tif, tmp_path):
    filtered = wg.filter(analysis, gains=[(3, 0.0)])
    rms, largest = filtered.change()
    difference = filtered.difference()
    assert np.nanmax(np.abs(difference.values[difference.valid])) == pytest.approx(largest, 1e-3)
    assert 0 < rms < largest
    wg.save(filtered, tmp_path / "smooth.tif")
    wg.save(filtered, tmp_path / "smooth.gpkg", layers="none")
    wg.load(tmp_path / "smooth.gpkg").restore(tmp_path / "again.tif")
    with (
        rasterio.open(tmp_path / "smooth.tif") as one,
        rasterio.open(tmp_path / "again.tif") as two,
    ):
        np.testing.assert_array_equal(one.read(1), two.read(1))
    with pytest.raises(OptionError, match="nothing to change"):
        wg.filter(analysis)


def test_filtering_synthesises_each_surface_once(analysis, monkeypatch):
    from wavelet_core import Pyramid

    synthesise, calls = Pyramid.synthesise, []

    def counted(pyramid, level=None):
        calls.append(level)
        return synthesise(pyramid, level)

    monkeypatch.setattr(Pyramid, "synthesise", counted)
    filtered = wg.filter(analysis, denoise=0.5, n_pyramids=0)
    filtered.restored()
    filtered.figures()
    filtered.difference()
    assert len(calls) == 3  # the clean surface of the pyramid in random order is another


def test_a_cloud_comes_back(las, tmp_path):
    cloud = wg.analyse(wg.open(las, attributes=["intensity"]), levels=2, measure=False)
    cloud.restore(tmp_path / "same.laz")
    assert_same_cloud(las, tmp_path / "same.laz")
    with pytest.raises(OutputFileError, match="made from a point cloud"):
        cloud.restore(tmp_path / "a.tif")
    with pytest.raises(OutputFileError, match="exists"):
        cloud.restore(tmp_path / "same.laz")


def test_points_of_a_table(tmp_path):
    rng = np.random.default_rng(0)
    xyz = np.column_stack([rng.uniform(0, 100, (200, 2)), rng.normal(50, 5, 200)])
    plain = tmp_path / "points.xyz"
    np.savetxt(plain, xyz)
    named = tmp_path / "points.csv"
    np.savetxt(
        named,
        np.column_stack([np.arange(200), xyz[:, ::-1], rng.uniform(0, 1, 200)]),
        delimiter=";",
        header="id;height;north;east;wet",
        comments="",
    )
    with pytest.warns(CrsWarning, match="no CRS"):
        one = wg.open(plain)
    two = wg.open(named, attributes=["wet"], crs="EPSG:32632")
    assert one.mesh.n_vertices == two.mesh.n_vertices == 200
    np.testing.assert_allclose(one.mesh.vertices, two.mesh.vertices)
    assert two.mesh.attribute_names == ("wet",)
    assert two.system.name == "WGS 84 / UTM zone 32N"
    assert isinstance(wg.analyse(two, levels=1).restore(), TriangleMesh)
    named.write_text("a,b\n1,2\n")
    with pytest.raises(InputFileError, match="no column x"):
        wg.open(named)


def test_points_and_triangles_of_a_vector_layer(analysis, tmp_path):
    wg.save(wg.extract(analysis, level=1), tmp_path / "tin.gpkg")
    mesh = analysis.mesh(1)
    points = wg.open(tmp_path / "tin.gpkg", layer="level_01_vertices")
    assert points.mesh.n_vertices == mesh.n_vertices
    flat = wg.open(tmp_path / "tin.gpkg", layer="level_01_vertices", z_field="elevation")
    np.testing.assert_allclose(flat.mesh.vertices, points.mesh.vertices)
    triangles = wg.open(tmp_path / "tin.gpkg", layer="level_01_tin")
    assert triangles.mesh.n_faces == mesh.n_faces
    assert triangles.system.name == analysis.geo.system.name
    with pytest.raises(InputFileError, match="level_01_vertices; name one with layer"):
        wg.open(tmp_path / "tin.gpkg")


def test_a_rasterio_dataset(tif):
    with rasterio.open(tif) as dataset:
        terrain = wg.open(dataset)
    assert terrain.mesh.n_vertices == wg.open(tif).mesh.n_vertices


class Coordinate:
    def __init__(self, values, attrs=None):
        self.values, self.attrs = np.asarray(values), attrs or {}


class Array:
    """What of an xarray DataArray is asked for, where xarray is not installed."""

    def __init__(self, values, dims, coords, attrs=None):
        self.values, self.dims, self.coords = values, dims, coords
        self.attrs, self.encoding, self.name = attrs or {}, {}, "dem"

    def squeeze(self):
        return self

    def transpose(self, *dims):
        return self if dims == self.dims else Array(self.values.T, dims, self.coords, self.attrs)


def data_array(values, x, y, crs, nodata):
    try:
        import xarray
    except ImportError:
        coords = {"x": Coordinate(x), "y": Coordinate(y)}
        return Array(values, ("y", "x"), coords, {"crs": crs, "_FillValue": nodata})
    coords = {"y": y, "x": x}
    attrs = {"crs": crs, "_FillValue": nodata}
    return xarray.DataArray(values, coords, ("y", "x"), name="dem", attrs=attrs)


def test_an_xarray_data_array(tif):
    with rasterio.open(tif) as dataset:
        values, transform = dataset.read(1), dataset.transform
    x = transform.c + transform.a * (np.arange(values.shape[1]) + 0.5)
    y = transform.f + transform.e * (np.arange(values.shape[0]) + 0.5)
    terrain = wg.open(data_array(values, x, y, "EPSG:32632", -9999.0))
    expected = wg.open(tif)
    np.testing.assert_allclose(terrain.mesh.vertices, expected.mesh.vertices)
    assert (terrain.mesh.faces == expected.mesh.faces).all()
    uneven = x.copy()
    uneven[3] += 4
    with pytest.raises(OptionError, match="not evenly spaced"):
        wg.open(data_array(values, uneven, y, "EPSG:32632", -9999.0))


def test_a_geo_data_frame(tmp_path):
    geopandas = pytest.importorskip("geopandas")
    rng = np.random.default_rng(0)
    x, y, z = rng.uniform(0, 100, (3, 50))
    frame = geopandas.GeoDataFrame(
        {"wet": rng.uniform(0, 1, 50)},
        geometry=geopandas.points_from_xy(x, y, z),
        crs="EPSG:32632",
    )
    terrain = wg.open(frame, attributes=["wet"])
    assert terrain.mesh.n_vertices == 50
    assert terrain.mesh.attribute_names == ("wet",)


def test_meshes_and_dems_in_memory(tif):
    terrain = wg.open(tif)
    assert wg.open(terrain.original, crs="EPSG:32632").mesh.n_faces == terrain.mesh.n_faces
    assert wg.open(terrain.mesh, crs="EPSG:32632").mesh.n_faces == terrain.mesh.n_faces


def test_what_is_no_terrain_is_refused(analysis, tmp_path):
    with pytest.raises(OptionError, match="a list holds no terrain"):
        wg.open([1, 2])
    with pytest.raises(OptionError, match="Analysis is not a terrain that can be analysed"):
        wg.analyse(analysis)
    with pytest.raises(OptionError, match="Terrain is not a pyramid"):
        wg.extract(wg.open(analysis.mesh(0), crs="EPSG:32632"))
    with pytest.raises(OptionError, match="cannot be saved"):
        wg.save(3, tmp_path / "a.tif")


def test_notes_go_with_the_pyramid_and_its_file(tmp_path):
    path = write_tif(tmp_path / "nowhere.tif", hills().astype("f4"), crs=None)
    with pytest.warns(CrsWarning, match="give one with crs"):
        terrain = wg.open(path)
    assert isinstance(terrain, Terrain)
    analysis = wg.analyse(terrain, target_vertices=4, levels=1)
    codes = [note.code for note in analysis.notes]
    assert codes == ["crs_missing", "size_not_reached"]
    assert analysis.notes[1].figures["target_vertices"] == 4
    wg.save(analysis, tmp_path / "a.gpkg", layers="none")
    loaded = wg.load(tmp_path / "a.gpkg")
    assert [note.code for note in loaded.notes] == codes
    assert [note.text for note in loaded.notes] == [note.text for note in analysis.notes]
