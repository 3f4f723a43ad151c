"""TINs as objects of other libraries: the same heights in the same places."""

import numpy as np
import pytest
from gis.samples import hills, write_las, write_tif

import wavelet_gis as wg
from wavelet_core import MissingDependencyError, OptionError
from wavelet_core.mesh.location import surface_errors


@pytest.fixture(scope="module")
def tin(tmp_path_factory):
    path = write_tif(tmp_path_factory.mktemp("in") / "dem.tif", hills(30, 40))
    return wg.simplify(wg.open(path), vertices=200)


@pytest.fixture(scope="module")
def cloud(tmp_path_factory):
    path = write_las(tmp_path_factory.mktemp("in") / "cloud.laz", 300)
    return wg.extract(wg.analyse(wg.open(path, attributes=("intensity",)), levels=3), level=1)


def test_triangles_and_vertices_of_a_geodataframe(tin, cloud):
    pytest.importorskip("geopandas")
    frame = tin.to_geodataframe()
    assert len(frame) == tin.mesh.n_faces
    assert frame.crs.to_epsg() == 32632
    assert frame.geometry.has_z.all()
    assert frame.area.sum() == pytest.approx(29 * 39 * 100)
    points = cloud.to_geodataframe("vertices")
    in_file = cloud.file_mesh
    np.testing.assert_allclose(points.geometry.x, in_file.vertices[:, 0])
    np.testing.assert_allclose(points.geometry.z, in_file.vertices[:, 2])
    np.testing.assert_array_equal(points["intensity"], in_file.attributes[:, 0])
    with pytest.raises(OptionError, match="give triangles or vertices"):
        tin.to_geodataframe("edges")


def test_a_geodataframe_opens_again(cloud):
    pytest.importorskip("geopandas")
    again = wg.open(cloud.to_geodataframe("vertices"))
    assert again.mesh.n_vertices == cloud.mesh.n_vertices
    assert again.system.kind == "projected"


def test_a_data_array_lies_where_the_input_does(tin):
    pytest.importorskip("xarray")
    array = tin.to_dataarray()
    assert array.dims == ("y", "x")
    assert array.shape == (30, 40)
    assert float(array.x[0]) == 500005.0
    assert float(array.y[0]) == 5099995.0
    x, y = np.meshgrid(array.x - 500000.0, array.y - 5100000.0)
    flat = np.column_stack([x.ravel(), y.ravel(), array.values.ravel()])
    corner = tin.file_mesh.vertices - [500000.0, 5100000.0, 0.0]
    from wavelet_core import TriangleMesh

    errors = surface_errors(TriangleMesh(corner, tin.mesh.faces), flat)
    assert np.abs(errors).max() < 1e-6
    coarser = tin.to_dataarray(cell_size=20.0)
    assert float(coarser.x[1] - coarser.x[0]) == 20.0


@pytest.mark.filterwarnings("ignore:Use `@` matmul:PendingDeprecationWarning")
def test_the_crs_is_where_rioxarray_looks(tin):
    pytest.importorskip("rioxarray")
    array = tin.to_dataarray()
    assert array.rio.crs.to_epsg() == 32632
    assert tuple(array.rio.transform())[:6] == (10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0)


def test_a_data_array_opens_again(tin):
    pytest.importorskip("xarray")
    again = wg.open(tin.to_dataarray())
    assert again.mesh.n_vertices == 30 * 40
    assert again.system.kind == "projected"


def test_a_surface_of_trimesh(tin):
    pytest.importorskip("trimesh")
    surface = tin.to_trimesh()
    np.testing.assert_array_equal(surface.vertices, tin.mesh.vertices)
    np.testing.assert_array_equal(surface.faces, tin.mesh.faces)


def test_a_surface_of_pyvista(cloud):
    pytest.importorskip("pyvista")
    surface = cloud.to_pyvista()
    assert surface.n_cells == cloud.mesh.n_faces
    np.testing.assert_array_equal(surface["intensity"], cloud.file_mesh.attributes[:, 0])


@pytest.mark.parametrize("method", ["to_geodataframe", "to_dataarray", "to_pyvista", "to_trimesh"])
def test_a_missing_library_is_named(tin, method, monkeypatch):
    import importlib

    def absent(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(MissingDependencyError, match="pip install"):
        getattr(tin, method)()
