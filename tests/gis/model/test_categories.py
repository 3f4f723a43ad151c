"""A class is a category: what is written of it exists in the input."""

import numpy as np
import pytest
from gis.samples import hills, write_las, write_tif

from wavelet_core import OptionError, analyse
from wavelet_gis.cli.main import main
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.las import write_cloud
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, write_pyramid
from wavelet_gis.model.attributes.categories import one_channel_per_category
from wavelet_gis.products.layers import coarse_layers
from wavelet_gis.products.level_raster import surface_dem
from wavelet_gis.workflows.filtering import denoised, with_level_gains
from wavelet_gis.workflows.open import open_terrain

DESIGN = {"partition": "quadric", "prediction": "nnls", "levels": 4}


@pytest.fixture(scope="module")
def cloud(tmp_path_factory):
    return write_las(tmp_path_factory.mktemp("cloud") / "a.las", n_points=900)


@pytest.fixture(scope="module")
def geo(cloud):
    terrain = open_terrain(cloud, attributes=["classification", "intensity"])
    return terrain.geo_pyramid(analyse(terrain.mesh, **DESIGN))


def test_a_coarse_level_has_only_classes_that_exist(geo):
    # As a number 61 to 83 % of the vertices of a coarse level rounded to another class.
    lifted = geo.pyramid.mesh(0)
    column = lifted.attribute_names.index("classification")
    assert not np.isin(lifted.attributes[:, column], [2, 5]).all()
    for level in range(geo.pyramid.n_levels + 1):
        mesh = geo.pyramid.mesh(level)
        written = geo.file_mesh(mesh)
        assert set(np.unique(written.attributes[:, column])) <= {2.0, 5.0}
        own = geo.pyramid.synthesise().attributes[geo.pyramid.vertex_ids(level), column]
        np.testing.assert_allclose(written.attributes[:, column], own, atol=1e-9)
        other = 1 - column
        np.testing.assert_array_equal(written.attributes[:, other], mesh.attributes[:, other])
    _, vertices = coarse_layers(geo)
    assert set(np.unique(vertices.fields["classification"])) <= {2.0, 5.0}


def test_a_raster_of_classes_has_only_classes_that_exist(geo):
    for level in (0, geo.pyramid.n_levels):
        dem = surface_dem(geo, geo.pyramid.mesh(level), attribute="classification", cell_size=2.0)
        assert set(np.unique(dem.values[dem.valid])) == {2.0, 5.0}
    plain = surface_dem(geo, geo.pyramid.mesh(0), attribute="intensity", cell_size=2.0)
    assert len(np.unique(plain.values[plain.valid])) > 100


def test_the_number_of_the_paper_is_there_when_asked_for(geo, tmp_path):
    mesh = geo.pyramid.mesh(0)
    as_number = geo.file_mesh(mesh, categories="number")
    np.testing.assert_array_equal(as_number.attributes, mesh.attributes)
    dem = surface_dem(geo, mesh, attribute="classification", cell_size=2.0, categories="number")
    assert len(np.unique(dem.values[dem.valid])) > 10
    write_pyramid(tmp_path / "p.gpkg", geo)
    for choice, exist in (("nearest", True), ("number", False)):
        out = tmp_path / f"{choice}.ply"
        options = ["--level", "0", "--categories", choice, "--quiet"]
        assert main(["extract", str(tmp_path / "p.gpkg"), str(out), *options]) == 0
        expected = geo.file_mesh(mesh, categories=choice)
        assert np.hstack([expected.vertices, expected.attributes]).astype("<f8").tobytes() in (
            out.read_bytes()
        )
        assert np.isin(expected.attributes[:, 0], [2, 5]).all() == exist


@pytest.mark.parametrize(("version", "point_format"), [("1.2", 3), ("1.4", 6)])
def test_filters_leave_classes_alone(tmp_path, version, point_format):
    import laspy

    path = write_las(tmp_path / "a.las", 900, version=version, point_format=point_format)
    terrain = open_terrain(path, attributes=["classification", "intensity"])
    geo = terrain.geo_pyramid(analyse(terrain.mesh, **DESIGN))
    flat = with_level_gains(geo, dict.fromkeys(range(4), 0.0), drop_coarse=True)
    write_cloud(tmp_path / "b.las", flat.restore())
    before, after = laspy.read(path), laspy.read(tmp_path / "b.las")
    np.testing.assert_array_equal(before.classification, after.classification)
    assert (np.array(after.intensity) != np.array(before.intensity)).mean() > 0.9
    with pytest.raises(OptionError, match="classification is a category"):
        denoised(geo, 0.1, channels=["classification"])


@pytest.mark.parametrize(("version", "point_format"), [("1.2", 3), ("1.4", 6)])
@pytest.mark.parametrize("carry", [True, False])
def test_one_channel_for_each_class_gives_shares_and_the_file_back(
    tmp_path, version, point_format, carry
):
    import laspy

    path = write_las(tmp_path / "a.las", 900, version=version, point_format=point_format)
    terrain = open_terrain(
        path, attributes=["classification", "return_number"], class_channels=True, carry=carry
    )
    names = ["classification_2", "classification_5"] + [f"return_number_{k}" for k in (1, 2, 3)]
    assert list(terrain.mesh.attribute_names) == names
    np.testing.assert_array_equal(terrain.mesh.attributes[:, :2].sum(axis=1), 1)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, **DESIGN))
    assert geo.categories == ()
    shares = geo.pyramid.mesh(0).attributes[:, :2]
    np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-6)
    write_pyramid(tmp_path / "p.gpkg", geo)
    write_cloud(tmp_path / "b.las", read_pyramid(tmp_path / "p.gpkg").restore())
    before, after = laspy.read(path), laspy.read(tmp_path / "b.las")
    for name in ("X", "Y", "Z", "classification", "return_number"):
        np.testing.assert_array_equal(before[name], after[name])


def test_too_many_categories_are_no_channels(cloud):
    from dataclasses import replace

    points = open_terrain(cloud, attributes=["user_data"]).original
    many = replace(points.attributes[0], values=np.arange(900, dtype=np.uint16) % 200)
    with pytest.raises(OptionError, match="200 values"):
        one_channel_per_category(replace(points, attributes=(many,)))


def test_channels_of_classes_are_refused_for_a_raster(tmp_path):
    with pytest.raises(InputFileError, match="class_channels is for a point cloud"):
        open_terrain(write_tif(tmp_path / "a.tif", hills().astype("f4")), class_channels=True)
