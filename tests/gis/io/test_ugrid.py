"""UGRID netCDF: what is in it, by a reader that shares nothing with the writer."""

import numpy as np
import pytest
from gis.samples import hills, write_tif

import wavelet_gis as wg
from wavelet_core import TriangleMesh, synthetic
from wavelet_gis.io.mesh.meshes import write_mesh
from wavelet_gis.io.mesh.ugrid import write_ugrid


@pytest.fixture
def mesh():
    return synthetic.scattered(60, seed=3, n_attributes=2)


def test_it_is_the_mesh_by_the_conventions(mesh, tmp_path):
    xarray = pytest.importorskip("xarray")
    path = tmp_path / "a.nc"
    write_ugrid(path, mesh, 'LOCAL_CS["here"]')
    with xarray.open_dataset(path, engine="scipy", decode_cf=False) as file:
        topology = file["mesh2d"].attrs
        assert topology["cf_role"] == "mesh_topology"
        assert topology["topology_dimension"] == 2
        x, y = (file[name].values for name in topology["node_coordinates"].split())
        np.testing.assert_array_equal(np.column_stack([x, y]), mesh.vertices[:, :2])
        faces = file[topology["face_node_connectivity"]]
        assert faces.dims == (topology["face_dimension"], topology["max_face_nodes_dimension"])
        np.testing.assert_array_equal(faces.values - faces.attrs["start_index"], mesh.faces)
        edges = file[topology["edge_node_connectivity"]].values - 1
        n_edges = mesh.n_vertices + mesh.n_faces - 1  # Euler, of a disc
        assert len(edges) == len(np.unique(np.sort(edges, axis=1), axis=0)) == n_edges
        z = file["mesh2d_node_z"]
        np.testing.assert_array_equal(z.values, mesh.vertices[:, 2])
        assert (z.attrs["mesh"], z.attrs["location"]) == ("mesh2d", "node")
        crs = file[z.attrs["grid_mapping"]].attrs
        assert crs["crs_wkt"] == 'LOCAL_CS["here"]'
        for name, column in zip(mesh.attribute_names, mesh.attributes.T, strict=True):
            np.testing.assert_array_equal(file[f"mesh2d_attribute_{name}"].values, column)


def test_the_same_mesh_gives_the_same_bytes(mesh, tmp_path):
    for name in "ab":
        write_ugrid(tmp_path / f"{name}.nc", mesh)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_a_mesh_without_faces_or_crs(tmp_path):
    bare = TriangleMesh(np.zeros((2, 3)), np.empty((0, 3), dtype=np.int32))
    write_ugrid(tmp_path / "a.nc", bare)
    assert b"crs_wkt" not in (tmp_path / "a.nc").read_bytes()


def test_simplify_writes_it(tmp_path):
    dem = wg.open(write_tif(tmp_path / "dem.tif", hills()))
    wg.save(wg.simplify(dem, vertices=120), tmp_path / "a.nc")
    content = (tmp_path / "a.nc").read_bytes()
    assert content.startswith(b"CDF\x02")
    assert b"WGS 84 / UTM zone 32N" in content


@pytest.mark.parametrize("suffix", [".nc", ".ply"])
def test_attributes_whose_names_are_alike_are_both_there(suffix, tmp_path):
    """Both became ``depth__m_``, and the second took the place of the first."""
    mesh = synthetic.plane()
    names = ("depth (m)", "depth [m]", "depth (m)_2")
    attributes = np.random.default_rng(0).random((mesh.n_vertices, 3))
    path = tmp_path / f"a{suffix}"
    write_mesh(path, TriangleMesh(mesh.vertices, mesh.faces, attributes, names))
    content = path.read_bytes()
    order = ">f8" if suffix == ".nc" else "<f8"
    for column in attributes.T:
        assert column[3:4].astype(order).tobytes() in content
    assert content.count(b"depth__m_") >= 3
