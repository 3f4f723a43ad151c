"""TINs for CAD and 3D viewers: STL, GLB, LandXML and DXF."""

from __future__ import annotations

import os
import re
from xml.sax.saxutils import quoteattr  # nosec B406: nothing is parsed, only written

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import MissingDependencyError, TriangleMesh

__all__ = ["write_dxf", "write_glb", "write_landxml", "write_stl"]

#: glTF's vertical axis is y: x stays, y becomes -z, z becomes y.
_Z_UP_TO_Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)


def write_stl(path: str | os.PathLike[str], mesh: TriangleMesh) -> None:
    """Write a binary STL, relative to a local origin that its header names.

    Notes
    -----
    STL holds 32-bit numbers, which resolve a projected northing to half a metre only, so the
    coordinates are taken from whole units below the lower left corner. No library writes the
    header, hence the few lines of numpy.
    """
    origin = _local_origin(mesh)
    triangles = np.zeros(
        mesh.n_faces, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")]
    )
    corners = (mesh.vertices - origin)[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    triangles["normal"] = np.divide(normals, lengths, out=normals, where=lengths > 0)
    triangles["corners"] = corners
    header = "origin " + " ".join(f"{value:.0f}" for value in origin)
    with open(path, "wb") as stream:
        stream.write(header.encode("ascii")[:80].ljust(80))
        stream.write(np.uint32(mesh.n_faces).astype("<u4").tobytes())
        stream.write(triangles.tobytes())


def write_glb(path: str | os.PathLike[str], mesh: TriangleMesh) -> None:
    """Write a binary glTF; the local origin is the translation of its node.

    Raises
    ------
    MissingDependencyError
        trimesh is absent.
    """
    try:
        import trimesh
    except ImportError as error:
        raise MissingDependencyError(
            "GLB is written by trimesh, which is not installed; run 'pip install trimesh'."
        ) from error
    origin = _local_origin(mesh)
    local = trimesh.Trimesh(mesh.vertices - origin, mesh.faces, process=False)
    placed = np.eye(4)
    placed[:3, 3] = origin
    scene = trimesh.Scene()
    scene.add_geometry(local, node_name="terrain", transform=_Z_UP_TO_Y_UP @ placed)
    with open(path, "wb") as stream:
        stream.write(scene.export(file_type="glb"))


def write_landxml(path: str | os.PathLike[str], mesh: TriangleMesh, wkt: str | None = None) -> None:
    """Write a LandXML 1.2 TIN surface: points as northing, easting, elevation, ids from 1.

    The unit is the metre unless the CRS counts in feet.
    """
    software = quoteattr(f"terrain-wavelets {wavelet_core.__version__}")
    with open(path, "w", encoding="utf-8", newline="\n") as stream:
        stream.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        stream.write('<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2">\n')
        stream.write(f"<Units>{_landxml_unit(wkt or '')}</Units>\n")
        if wkt:
            stream.write(f"<CoordinateSystem ogcWktCode={quoteattr(wkt)}/>\n")
        stream.write(f"<Application name={software}/>\n")
        stream.write('<Surfaces><Surface name="terrain"><Definition surfType="TIN">\n<Pnts>\n')
        for number, (x, y, z) in enumerate(mesh.vertices.tolist(), 1):
            stream.write(f'<P id="{number}">{y:.15g} {x:.15g} {z:.15g}</P>\n')
        stream.write("</Pnts>\n<Faces>\n")
        for a, b, c in (mesh.faces + 1).tolist():
            stream.write(f"<F>{a} {b} {c}</F>\n")
        stream.write("</Faces>\n</Definition></Surface></Surfaces>\n</LandXML>\n")


def _landxml_unit(wkt: str) -> str:
    feet = re.search(r'UNIT\["([^"]*(?:foot|feet)[^"]*)"', wkt, re.IGNORECASE)
    if feet is None:
        return (
            '<Metric linearUnit="meter" areaUnit="squareMeter" volumeUnit="cubicMeter" '
            'temperatureUnit="celsius" pressureUnit="mmHG"/>'
        )
    unit = "USSurveyFoot" if "survey" in feet[1].lower() else "foot"
    return (
        f'<Imperial linearUnit="{unit}" areaUnit="squareFoot" volumeUnit="cubicFeet" '
        'temperatureUnit="fahrenheit" pressureUnit="inHG"/>'
    )


def write_dxf(path: str | os.PathLike[str], mesh: TriangleMesh) -> None:
    """Write a DXF R2010 of 3D faces on the layer TERRAIN.

    Raises
    ------
    MissingDependencyError
        ezdxf is absent.
    """
    try:
        import ezdxf
    except ImportError as error:
        raise MissingDependencyError(
            "DXF is written by ezdxf, which is not installed; run 'pip install ezdxf'."
        ) from error
    document = ezdxf.filemanagement.new("R2010")
    document.layers.add("TERRAIN")
    space = document.modelspace()
    for a, b, c in mesh.vertices[mesh.faces].tolist():
        space.add_3dface([a, b, c, c], dxfattribs={"layer": "TERRAIN"})
    document.saveas(path)


def _local_origin(mesh: TriangleMesh) -> NDArray[np.float64]:
    return np.floor(mesh.vertices.min(axis=0)) if mesh.n_vertices else np.zeros(3)
