"""TINs for CAD and 3D viewers: STL, GLB, LandXML and DXF."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterator
from typing import Any
from xml.sax.saxutils import quoteattr  # nosec B406: nothing is parsed, only written

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import MissingDependencyError, TriangleMesh
from wavelet_core.progress import report_share
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.read_back import recorded_stream, write_text

__all__ = ["metres_in_horizontal_unit", "write_dxf", "write_glb", "write_landxml", "write_stl"]

#: glTF's vertical axis is y: x stays, y becomes -z, z becomes y.
_Z_UP_TO_Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)

#: Pieces of text that ezdxf writes for each face, about.
_DXF_WRITES_A_FACE = 10
#: Rows, or pieces of text, between two reports.
_ROWS_BETWEEN_REPORTS = 1 << 13


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
    with recorded_stream(path) as stream:
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
    with recorded_stream(path) as stream:
        stream.write(scene.export(file_type="glb"))


def write_landxml(path: str | os.PathLike[str], mesh: TriangleMesh, wkt: str | None = None) -> None:
    """Write a LandXML 1.2 TIN surface: points as northing, easting, elevation, ids from 1.

    The unit is that in which the CRS counts x and y, in which z must be, too; the metre without a
    CRS.

    Raises
    ------
    OutputFileError
        When LandXML has no name for that unit.
    """
    units = _landxml_unit(wkt or "", path)
    software = quoteattr(f"terrain-wavelets {wavelet_core.__version__}")
    with recorded_stream(path) as stream:
        stream.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        stream.write('<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2">\n')
        stream.write(f"<Units>{units}</Units>\n")
        if wkt:
            stream.write(f"<CoordinateSystem ogcWktCode={quoteattr(wkt)}/>\n")
        stream.write(f"<Application name={software}/>\n")
        stream.write('<Surfaces><Surface name="terrain"><Definition surfType="TIN">\n<Pnts>\n')
        for number, (x, y, z) in _reported(mesh.vertices, 0.0, 0.5):
            stream.write(f'<P id="{number + 1}">{y:.15g} {x:.15g} {z:.15g}</P>\n')
        stream.write("</Pnts>\n<Faces>\n")
        for _, (a, b, c) in _reported(mesh.faces + 1, 0.5, 1.0):
            stream.write(f"<F>{a} {b} {c}</F>\n")
        stream.write("</Faces>\n</Definition></Surface></Surfaces>\n</LandXML>\n")


def _landxml_unit(wkt: str, path: str | os.PathLike[str]) -> str:
    metres = metres_in_horizontal_unit(wkt)
    for unit, length in (("meter", 1.0), ("kilometer", 1000.0)):
        if abs(metres / length - 1) < 1e-9:
            return (
                f'<Metric linearUnit="{unit}" areaUnit="squareMeter" volumeUnit="cubicMeter" '
                'temperatureUnit="celsius" pressureUnit="mmHG"/>'
            )
    # The two feet are 2 parts in a million apart, and definitions are rounded to a tenth of that.
    for unit, length in (("USSurveyFoot", 1200 / 3937), ("foot", 0.3048)):
        if abs(metres / length - 1) < 2e-7:
            return (
                f'<Imperial linearUnit="{unit}" areaUnit="squareFoot" volumeUnit="cubicFeet" '
                'temperatureUnit="fahrenheit" pressureUnit="inHG"/>'
            )
    raise OutputFileError(
        f"{path}: LandXML has no name for a unit of {metres:.10g} m, which is that of the CRS; "
        "reproject the input, or write another format."
    )


def metres_in_horizontal_unit(wkt: str) -> float:
    """Return the length in which a definition counts x and y; 1 where it gives none.

    Of a compound CRS it is the projected part that counts.
    """
    start = re.search(
        r"\b(?:PROJCS|PROJCRS|PROJECTEDCRS|LOCAL_CS|ENGCRS|ENGINEERINGCRS)\[", wkt, re.IGNORECASE
    )
    if start is None:
        return 1.0
    part = _bracketed(wkt[start.start() :])
    # Those have units of their own: the angle, and the lengths of the projection's parameters.
    for other in ("GEOGCS", "BASEGEOGCRS", "BASEGEODCRS", "CONVERSION", "PARAMETER"):
        part = _without(part, other)
    units = re.findall(r'\b(?:LENGTH)?UNIT\["[^"]*",\s*([-+.\deE]+)', part, re.IGNORECASE)
    return float(units[-1]) if units else 1.0


def _without(text: str, keyword: str) -> str:
    """Return a definition without the elements of a keyword."""
    while found := re.search(rf"\b{keyword}\[", text, re.IGNORECASE):
        rest = text[found.start() :]
        text = text[: found.start()] + rest[len(_bracketed(rest)) :]
    return text


def _bracketed(text: str) -> str:
    """Return a text up to the bracket that closes its first one; quoted brackets do not count."""
    depth, is_quoted = 0, False
    for position, character in enumerate(text):
        if character == '"':
            is_quoted = not is_quoted
        elif not is_quoted and character in "[]":
            depth += 1 if character == "[" else -1
            if depth == 0:
                return text[: position + 1]
    return text


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
    options = ezdxf.options  # type: ignore[attr-defined, unused-ignore]
    # The same mesh gives the same bytes: no time, and no identifiers drawn at random.
    is_fixed = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        document = ezdxf.filemanagement.new("R2010")
        document.layers.add("TERRAIN")
        space = document.modelspace()
        for _, (a, b, c) in _reported(mesh.vertices[mesh.faces], 0.0, 0.5):
            space.add_3dface([a, b, c, c], dxfattribs={"layer": "TERRAIN"})
        text = _ReportedText(_DXF_WRITES_A_FACE * mesh.n_faces)
        document.write(text)
    finally:
        options.write_fixed_meta_data_for_testing = is_fixed
    write_text(path, text.getvalue())


def _reported(rows: NDArray[Any], start: float, stop: float) -> Iterator[tuple[int, Any]]:
    """Yield rows with their numbers, from 0, and report from time to time how far it is."""
    for first in range(0, len(rows), _ROWS_BETWEEN_REPORTS):
        report_share(start + (stop - start) * first / len(rows))
        yield from enumerate(rows[first : first + _ROWS_BETWEEN_REPORTS].tolist(), first)


class _ReportedText(io.StringIO):
    """Text that reports, while it is written, how much of its second half is there.

    Parameters
    ----------
    n_writes : int
        That will be made of it, or some.
    """

    def __init__(self, n_writes: int) -> None:
        super().__init__(newline="\n")
        self._n_writes, self._done = max(n_writes, 1), 0

    def write(self, text: str) -> int:
        self._done += 1
        if self._done % _ROWS_BETWEEN_REPORTS == 0:
            report_share(0.5 + 0.5 * min(self._done / self._n_writes, 1.0))
        return super().write(text)


def _local_origin(mesh: TriangleMesh) -> NDArray[np.float64]:
    return np.floor(mesh.vertices.min(axis=0)) if mesh.n_vertices else np.zeros(3)
