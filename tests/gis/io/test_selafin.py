"""SELAFIN: what is in it, by a reader that shares nothing with the writer."""

import builtins
import itertools

import numpy as np
import pytest
from gis.samples import hills, write_tif

import wavelet_gis as wg
from wavelet_core import MissingDependencyError, TriangleMesh, synthetic
from wavelet_core.mesh.connectivity import edges_of
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.mesh.meshes import write_mesh
from wavelet_gis.io.mesh.selafin import write_selafin


def records(path):
    """Return the records of a Fortran file, big-endian, each with its length on both sides."""
    content, found, at = path.read_bytes(), [], 0
    while at < len(content):
        size = int.from_bytes(content[at : at + 4], "big")
        found.append(content[at + 4 : at + 4 + size])
        assert int.from_bytes(content[at + 4 + size : at + 8 + size], "big") == size
        at += 8 + size
    return found


def read(path):
    """Return what a geometry file of one time holds, by the guide of TELEMAC."""
    title, counts, *rest = records(path)
    assert title[72:] == b"SERAFIND"
    n_variables, n_others = np.frombuffer(counts, ">i4")
    assert n_others == 0
    names = [(r[:16].decode().rstrip(), r[16:].decode().rstrip()) for r in rest[:n_variables]]
    rest = rest[n_variables:]
    parameters = np.frombuffer(rest[0], ">i4")
    assert list(parameters) == [1] + [0] * 9  # no origin, one plane, not a part, no date
    n_faces, n_nodes, n_corners, one = np.frombuffer(rest[1], ">i4")
    assert (n_corners, one) == (3, 1)
    faces = np.frombuffer(rest[2], ">i4").reshape(n_faces, 3)
    outline = np.frombuffer(rest[3], ">i4")
    x, y, time, *values = (np.frombuffer(record, ">f8") for record in rest[4:])
    assert list(time) == [0.0]
    assert {len(column) for column in (outline, x, y, *values)} == {n_nodes}
    return names, faces, outline, np.column_stack([x, y]), np.array(values)


@pytest.fixture
def mesh():
    mesh = synthetic.scattered(60, seed=3, n_attributes=2)
    return TriangleMesh(
        mesh.vertices + np.array([431000.123, 6789000.456, 100.0]), mesh.faces, mesh.attributes,
        ("Reflexion über alles", "Reflexion über nichts"),
    )  # fmt: skip


@pytest.fixture(autouse=True)
def serafin():
    return pytest.importorskip("serafin")


def test_it_is_the_mesh_to_the_last_bit(mesh, tmp_path):
    write_selafin(tmp_path / "a.slf", mesh)
    names, faces, _, plan, values = read(tmp_path / "a.slf")
    np.testing.assert_array_equal(plan, mesh.vertices[:, :2])
    np.testing.assert_array_equal(faces - 1, mesh.faces)
    np.testing.assert_array_equal(values[0], mesh.vertices[:, 2])
    np.testing.assert_array_equal(values[1:], mesh.attributes.T)
    assert names == [("BOTTOM", "M"), ("Reflexion__be", ""), ("Reflexion__be_2", "")]


def test_the_outline_is_numbered_along_itself_and_each_hole_after_it(tmp_path):
    mesh = synthetic.hills(7, 7)
    is_hole = np.linalg.norm(mesh.vertices[mesh.faces].mean(axis=1)[:, :2]
                             - mesh.vertices[:, :2].mean(axis=0), axis=1) < 0.2 * np.ptp(
        mesh.vertices[:, 0])  # fmt: skip
    mesh = TriangleMesh(mesh.vertices, mesh.faces[~is_hole])
    write_selafin(tmp_path / "a.slf", mesh)
    _, faces, outline, plan, _ = read(tmp_path / "a.slf")
    edges, n_faces = edges_of(faces - 1)
    on_outline = np.unique(edges[n_faces == 1])
    np.testing.assert_array_equal(np.flatnonzero(outline), on_outline)
    order = np.argsort(outline[on_outline])
    ring = on_outline[order]
    np.testing.assert_array_equal(outline[ring], np.arange(1, len(ring) + 1))
    sides = {tuple(sorted(edge)) for edge in edges[n_faces == 1].tolist()}
    steps = [tuple(sorted((a, b))) in sides for a, b in itertools.pairwise(ring)]
    assert steps.count(False) == 1, "from the outline to the hole"
    outer = plan[ring[: steps.index(False) + 1]]
    x, y = outer.T
    assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0, "counter-clockwise"
    assert len(outer) == 24


def test_vertices_without_a_face_are_left_out(tmp_path):
    mesh = TriangleMesh([[9, 9, 9], [0, 0, 1], [5, 0, 2], [0, 5, 3], [8, 8, 8]], [[1, 2, 3]])
    write_selafin(tmp_path / "a.slf", mesh)
    _, faces, outline, plan, values = read(tmp_path / "a.slf")
    assert faces.tolist() == [[1, 2, 3]]
    assert sorted(outline) == [1, 2, 3]
    np.testing.assert_array_equal(plan, mesh.vertices[1:4, :2])
    np.testing.assert_array_equal(values[0], [1, 2, 3])


def test_what_it_cannot_hold_is_refused(tmp_path):
    with pytest.raises(OutputFileError, match="no triangles"):
        write_selafin(tmp_path / "a.slf", TriangleMesh(np.zeros((2, 3)), np.empty((0, 3), int)))
    bow = TriangleMesh([[0, 0, 0], [4, 0, 0], [2, 2, 0], [4, 4, 0], [0, 4, 0]],
                       [[0, 1, 2], [2, 3, 4]])  # fmt: skip
    with pytest.raises(OutputFileError, match="meets itself at a node"):
        write_selafin(tmp_path / "a.slf", bow)
    assert not (tmp_path / "a.slf").exists()


def test_a_bed_in_feet_is_not_called_metres(mesh, tmp_path):
    feet = 'PROJCS["x",GEOGCS["y"],UNIT["foot",0.3048]]'
    write_mesh(tmp_path / "a.slf", mesh, feet)
    assert read(tmp_path / "a.slf")[0][0] == ("BOTTOM", "")
    assert (tmp_path / "a.prj").read_text() == feet


def test_without_the_library_the_remedy_is_named(mesh, tmp_path, monkeypatch):
    find = builtins.__import__

    def without(name, *arguments, **others):
        if name == "serafin":
            raise ImportError(name)
        return find(name, *arguments, **others)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingDependencyError, match="pip install python-serafin"):
        write_selafin(tmp_path / "a.slf", mesh)


def test_a_file_whose_numbers_differ_is_found_out(mesh, tmp_path, monkeypatch, serafin):
    plain = serafin.SerafinWriter.write_entire_frame
    monkeypatch.setattr(
        serafin.SerafinWriter,
        "write_entire_frame",
        lambda self, header, time, values: plain(self, header, time, values + 1e-9),
    )
    with pytest.raises(OutputFileError, match="differ"):
        write_selafin(tmp_path / "a.slf", mesh)


def test_simplify_writes_it(tmp_path):
    dem = wg.open(write_tif(tmp_path / "dem.tif", hills()))
    tin = wg.simplify(dem, vertices=120)
    wg.save(tin, tmp_path / "a.slf")
    _, faces, _, plan, values = read(tmp_path / "a.slf")
    np.testing.assert_array_equal(plan, tin.file_mesh.vertices[:, :2])
    np.testing.assert_array_equal(values[0], tin.file_mesh.vertices[:, 2])
    assert len(faces) == tin.mesh.n_faces
    assert "UTM zone 32N" in (tmp_path / "a.prj").read_text()
