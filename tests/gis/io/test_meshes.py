"""Mesh files read back by plain readers written from the formats' descriptions."""

import numpy as np
import pytest

from wavelet_core import TriangleMesh
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.formats import MESH_SUFFIXES
from wavelet_gis.io.mesh import meshes as meshfiles
from wavelet_gis.io.mesh.meshes import write_mesh


@pytest.fixture
def mesh(rng):
    points = np.column_stack([rng.uniform(5e6, 5e6 + 100, (40, 2)), rng.normal(size=40)])
    return TriangleMesh.from_points(points, rng.normal(size=(40, 2)), ("hag", "my class"))


def read_ply(path):
    head, body = path.read_bytes().split(b"end_header\n", 1)
    lines = head.decode("ascii").splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    counts = [int(line.split()[2]) for line in lines if line.startswith("element")]
    names = [line.split()[2] for line in lines if line.startswith("property double")]
    n_values = counts[0] * len(names)
    vertices = np.frombuffer(body, "<f8", n_values).reshape(counts[0], len(names))
    faces = np.frombuffer(body, [("n", "u1"), ("ids", "<i4", 3)], offset=8 * n_values)
    assert len(faces) == counts[1]
    assert (faces["n"] == 3).all()
    return names, vertices, faces["ids"]


def read_lines(path, keyword):
    lines = path.read_text("ascii").splitlines()
    return np.array([line.split()[1:] for line in lines if line.split()[0] == keyword], float)


def test_ply_is_exact_and_carries_attributes(mesh, tmp_path):
    write_mesh(tmp_path / "a.ply", mesh)
    names, vertices, faces = read_ply(tmp_path / "a.ply")
    assert names == ["x", "y", "z", "hag", "my_class"]
    assert (vertices == np.hstack([mesh.vertices, mesh.attributes])).all()
    assert (faces == mesh.faces).all()


def test_obj_counts_from_one(mesh, tmp_path):
    write_mesh(tmp_path / "a.obj", mesh)
    np.testing.assert_allclose(read_lines(tmp_path / "a.obj", "v"), mesh.vertices, rtol=1e-14)
    assert (read_lines(tmp_path / "a.obj", "f") == mesh.faces + 1).all()


@pytest.mark.parametrize("block", [1 << 16, 7])
def test_2dm_numbers_its_elements_and_nodes(mesh, tmp_path, monkeypatch, block):
    monkeypatch.setattr(meshfiles, "_LINES_AT_ONCE", block)
    write_mesh(tmp_path / "a.2dm", mesh, wkt='LOCAL_CS["site"]')
    elements, nodes = read_lines(tmp_path / "a.2dm", "E3T"), read_lines(tmp_path / "a.2dm", "ND")
    assert (tmp_path / "a.2dm").read_text().startswith("MESH2D\n")
    assert (elements[:, 0] == np.arange(1, mesh.n_faces + 1)).all()
    assert (elements[:, 1:4] == mesh.faces + 1).all()
    assert (nodes[:, 0] == np.arange(1, mesh.n_vertices + 1)).all()
    np.testing.assert_allclose(nodes[:, 1:], mesh.vertices, rtol=1e-14)
    assert (tmp_path / "a.prj").read_text() == 'LOCAL_CS["site"]'


def test_other_suffixes_are_refused(mesh, tmp_path):
    with pytest.raises(OutputFileError, match=r"\.ply, \.obj, \.2dm"):
        write_mesh(tmp_path / "a.fbx", mesh)
    assert set(MESH_SUFFIXES) >= {".ply", ".obj", ".2dm"}
