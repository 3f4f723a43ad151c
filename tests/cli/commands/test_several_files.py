"""Several files, or a folder of them, as one input."""

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import UTM, hills, write_las, write_tif

import wavelet_gis as wg
from wavelet_gis.errors import InputFileError, RasterWarning

PLACE = rasterio.Affine(10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0)


def write_part(path, values, row, column, n_rows, n_columns, **options):
    """Write a part of a raster at its place."""
    window = values[row : row + n_rows, column : column + n_columns]
    return write_tif(
        path, window, transform=PLACE @ rasterio.Affine.translation(column, row), **options
    )


@pytest.fixture
def parts(tmp_path):
    """A DEM as a whole, and in four parts that overlap by a cell."""
    values = hills(41, 51).astype("f4")
    folder = tmp_path / "parts"
    folder.mkdir()
    write_tif(tmp_path / "whole.tif", values, nodata=-9999.0)
    for row in (0, 20):
        for column in (0, 25):
            name = f"part_{row}_{column}.tif"
            write_part(folder / name, values, row, column, 21, 26, nodata=-9999.0)
    return tmp_path


def test_parts_of_a_dem_give_the_pyramid_and_the_raster_of_the_whole(done, parts):
    done("analyse", parts / "parts", parts / "parts.gpkg", "--levels", 4)
    done("analyse", parts / "whole.tif", parts / "whole.gpkg", "--levels", 4)
    for name in ("parts", "whole"):
        done("reconstruct", parts / f"{name}.gpkg", parts / f"{name}_back.tif")
        done("extract", parts / f"{name}.gpkg", parts / f"{name}.ply")
    assert (parts / "parts.ply").read_bytes() == (parts / "whole.ply").read_bytes()
    with rasterio.open(parts / "parts_back.tif") as a, rasterio.open(parts / "whole.tif") as b:
        assert a.read(1).tobytes() == b.read(1).tobytes()
        assert tuple(a.transform) == tuple(b.transform)
        assert a.crs == b.crs
        assert a.nodata == b.nodata


def test_files_by_name_in_any_order_are_the_same_terrain(parts):
    files = sorted((parts / "parts").iterdir())
    one, other = wg.open(files), wg.open(files[::-1])
    assert one.mesh == other.mesh
    assert wg.simplify(one, vertices=60).mesh == wg.simplify(other, vertices=60).mesh
    assert one.notes[0].code == "mosaic"


def test_the_first_of_two_that_differ_counts(tmp_path):
    values = hills(20, 30)
    first = write_part(tmp_path / "a.tif", values, 0, 0, 20, 20)
    second = write_part(tmp_path / "b.tif", values + 1, 0, 18, 20, 12)
    with pytest.warns(RasterWarning, match="40 cells that files have in common differ, by up to 1"):
        whole = wg.open([first, second])
    assert (whole.original.values[:, :20] == values[:, :20]).all()
    assert (whole.original.values[:, 20:] == values[:, 20:] + 1).all()


def test_gaps_between_rasters_are_holes(tmp_path):
    values = hills(20, 40)
    a = write_part(tmp_path / "a.tif", values, 0, 0, 20, 10)
    b = write_part(tmp_path / "b.tif", values, 0, 25, 20, 15)
    whole = wg.open([a, b])
    assert whole.original.values.shape == (20, 40)
    assert np.isnan(whole.original.values[:, 10:25]).all()
    counts = [write_part(tmp_path / f"{k}.tif", values.astype("i2"), 0, k, 20, 9) for k in (0, 30)]
    with pytest.raises(InputFileError, match="no number that stands for nodata"):
        wg.open(counts)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"crs": "EPSG:32633"}, r"its CRS is WGS 84 / UTM zone 33N.*--crs"),
        ({"transform": PLACE @ rasterio.Affine.scale(2)}, "not those of the grid"),
        ({"transform": PLACE @ rasterio.Affine.translation(20.5, 0)}, "shifted by up to 0.5"),
        ({"dtype": "float32"}, "numbers of type float32"),
    ],
)
def test_rasters_that_contradict_each_other_are_refused(refused, tmp_path, change, message):
    import re

    a = write_tif(tmp_path / "a.tif", hills(20, 20))
    values = hills(20, 20).astype(change.pop("dtype", "float64"))
    b = write_tif(tmp_path / "b.tif", values, **change)
    assert re.search(message, refused("analyse", a, b, tmp_path / "out.gpkg"))


def split(path, folder, *, overlap=0.0, **header):
    """Write the points of a cloud west and east of its middle to two files; return their names."""
    las = laspy.read(path)
    x = np.array(las.x)
    middle = (x.min() + x.max()) / 2
    names = []
    for name, chosen in (("west", x < middle + overlap), ("east", x >= middle)):
        part = laspy.LasData(las.header)
        part.points = las.points[chosen]
        for key, value in header.items():
            if name == "east":
                part.change_scaling(**{key: value})
        part.write(folder / f"{name}.laz")
        names.append(folder / f"{name}.laz")
    return names


@pytest.fixture
def halves(tmp_path):
    path = write_las(tmp_path / "whole.laz", 800)
    (tmp_path / "halves").mkdir()
    return path, split(path, tmp_path / "halves", overlap=15.0)


def records(path):
    """Return the point records of a file, sorted."""
    array = laspy.read(path).points.array
    return sorted(record.tobytes() for record in array)


@pytest.mark.filterwarnings("ignore:.* share x and y")
def test_clouds_that_overlap_are_one_cloud(done, halves, tmp_path):
    whole, names = halves
    done("analyse", *names, tmp_path / "two.gpkg", "--levels", 4, "--attributes", "intensity")
    figures = done("analyse", whole, tmp_path / "one.gpkg", "--levels", 4, "--json").figures
    done("reconstruct", tmp_path / "two.gpkg", tmp_path / "back.laz")
    assert figures["n_vertices"] == wg.load(tmp_path / "two.gpkg").figures()["n_vertices"]
    assert records(tmp_path / "back.laz") == records(whole)
    header = laspy.read(tmp_path / "back.laz").header
    assert header.point_count == 800
    assert list(header.mins) == list(laspy.read(whole).header.mins)
    done("simplify", tmp_path / "halves", tmp_path / "tin.ply", "--vertices", 50)


@pytest.mark.filterwarnings("ignore:.* share x and y")
def test_offsets_may_differ_by_whole_steps(tmp_path):
    path = write_las(tmp_path / "whole.laz", 300)
    names = split(path, tmp_path, offsets=[500050.0, 5100000.0, 90.0])
    assert not np.array_equal(*(laspy.read(name).header.offsets for name in names))
    cloud = wg.open(names).original
    assert np.allclose(
        np.sort(cloud.coordinates()[:, 2]), np.sort(np.array(laspy.read(path).z)), atol=1e-9
    )


def test_clouds_that_contradict_each_other_are_refused(refused, tmp_path):
    a = write_las(tmp_path / "a.laz", 300)
    b = write_las(tmp_path / "b.laz", 300, crs="EPSG:32633", seed=1)
    assert "that of" in refused("analyse", a, b, tmp_path / "out.gpkg")
    c = write_las(tmp_path / "c.laz", 300, point_format=7)
    assert "other dimensions" in refused("analyse", a, c, tmp_path / "out.gpkg")
    (tmp_path / "scaled").mkdir()
    _, fine = split(a, tmp_path / "scaled", scales=[0.005, 0.005, 0.001])
    assert "stored in steps of" in refused("analyse", a, fine, tmp_path / "out.gpkg")
    tif = write_tif(tmp_path / "dem.tif", hills(20, 20))
    assert "name files of one kind" in refused("analyse", a, tif, tmp_path / "out.gpkg")
    assert "named twice" in refused("analyse", a, a, tmp_path / "out.gpkg")
    assert wg.open([a, b], crs=UTM).original.n_points == 600


def test_folders_without_one_kind_of_terrain_are_refused(refused, tmp_path):
    (tmp_path / "empty").mkdir()
    message = refused("analyse", tmp_path / "empty", tmp_path / "out.gpkg")
    assert "this folder holds no file ending in .las, .laz, .tif" in message
    (tmp_path / "both").mkdir()
    write_tif(tmp_path / "both" / "a.tif", hills(20, 20))
    write_las(tmp_path / "both" / "a.laz")
    message = refused("analyse", tmp_path / "both", tmp_path / "out.gpkg")
    assert "holds point clouds and rasters" in message
