"""TINs for CAD and 3D viewers, read back by libraries that know the formats."""

import builtins
import time
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from wavelet_core import MissingDependencyError, TriangleMesh, synthetic
from wavelet_core.errors import Cancelled
from wavelet_core.progress import watched
from wavelet_gis.io.mesh.meshes import write_mesh

FOOT_WKT = 'PROJCS["site",UNIT["US survey foot",0.3048006096012192]]'


@pytest.fixture
def mesh():
    """Hills far from the origin, where 32-bit numbers resolve half a metre only."""
    local = synthetic.hills(8, 9, cell=1.0)
    return TriangleMesh(local.vertices + np.array([429252.25, 5150485.5, 0]), local.faces)


def corners(mesh):
    return mesh.vertices[mesh.faces]


def test_stl_keeps_centimetres_far_from_the_origin(mesh, tmp_path):
    write_mesh(tmp_path / "a.stl", mesh)
    content = (tmp_path / "a.stl").read_bytes()
    words = content[:80].split()
    assert words[0] == b"origin"
    origin = np.array([float(word) for word in words[1:4]])
    assert int(np.frombuffer(content, "<u4", 1, offset=80)[0]) == mesh.n_faces
    fields = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")]
    triangles = np.frombuffer(content, fields, offset=84)
    np.testing.assert_allclose(triangles["corners"] + origin, corners(mesh), rtol=0, atol=1e-4)
    assert (triangles["normal"][:, 2] > 0).all()


def test_glb_places_the_terrain_and_turns_z_up(mesh, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    write_mesh(tmp_path / "a.glb", mesh)
    scene = trimesh.load(tmp_path / "a.glb")
    x, y, z = mesh.vertices.T
    expected = [[x.min(), z.min(), -y.max()], [x.max(), z.max(), -y.min()]]
    np.testing.assert_allclose(scene.bounds, expected, atol=1e-3)


@pytest.mark.parametrize(
    ("wkt", "unit"),
    [(None, "meter"), (FOOT_WKT, "USSurveyFoot"), ('LOCAL_CS["x",UNIT["foot",0.3048]]', "foot")],
)
def test_landxml_is_northing_first_and_names_its_unit(mesh, tmp_path, wkt, unit):
    write_mesh(tmp_path / "a.xml", mesh, wkt)
    space = "{http://www.landxml.org/schema/LandXML-1.2}"
    root = ElementTree.parse(tmp_path / "a.xml").getroot()
    points = [[float(v) for v in p.text.split()] for p in root.iter(f"{space}P")]
    np.testing.assert_allclose(np.array(points)[:, [1, 0, 2]], mesh.vertices, rtol=1e-14)
    faces = [[int(v) for v in f.text.split()] for f in root.iter(f"{space}F")]
    np.testing.assert_array_equal(np.array(faces) - 1, mesh.faces)
    assert root.find(f"{space}Units")[0].get("linearUnit") == unit


def test_dxf_has_a_3d_face_for_each_triangle(mesh, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_mesh(tmp_path / "a.dxf", mesh)
    faces = ezdxf.readfile(tmp_path / "a.dxf").modelspace().query("3DFACE")
    found = np.array([[face.dxf.vtx0, face.dxf.vtx1, face.dxf.vtx2] for face in faces])
    np.testing.assert_allclose(found, corners(mesh), rtol=1e-12)


@pytest.mark.parametrize(("suffix", "package"), [("glb", "trimesh"), ("dxf", "ezdxf")])
def test_a_missing_library_is_named(mesh, tmp_path, monkeypatch, suffix, package):
    real = builtins.__import__

    def without(name, *arguments, **options):
        if name == package:
            raise ImportError(name)
        return real(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingDependencyError, match=f"pip install {package}"):
        write_mesh(tmp_path / f"a.{suffix}", mesh)


def test_a_dxf_of_the_same_mesh_has_the_same_bytes(tmp_path):
    """Its header held the time, and two identifiers drawn at random."""
    pytest.importorskip("ezdxf")
    mesh = synthetic.hills(5, 5)
    for name in ("a.dxf", "b.dxf"):
        write_mesh(tmp_path / name, mesh)
        time.sleep(1.1)
    assert (tmp_path / "a.dxf").read_bytes() == (tmp_path / "b.dxf").read_bytes()


@pytest.mark.parametrize("suffix", ["dxf", "xml"])
def test_long_texts_report_while_they_are_written_and_stop_when_they_are_told(tmp_path, suffix):
    """A DXF of a level of four million cells did not look at the cancel button for 6.8 s."""
    mesh, shares = synthetic.hills(120, 120), []
    with watched(shares.append):
        write_mesh(tmp_path / f"whole.{suffix}", mesh)
    assert len(shares) > 4
    assert shares == sorted(shares)

    def stop(share):
        if share > 0.4:
            raise Cancelled("told to")

    with watched(stop), pytest.raises(Cancelled, match="told to"):
        write_mesh(tmp_path / f"half.{suffix}", mesh)
    write_mesh(tmp_path / f"again.{suffix}", mesh)
    whole, again = (tmp_path / f"{name}.{suffix}" for name in ("whole", "again"))
    assert whole.read_bytes() == again.read_bytes()
