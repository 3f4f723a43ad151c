"""TINs as mesh files.

PLY, OBJ, 2DM, STL and LandXML need numpy alone, so that QGIS needs nothing more; GLB and DXF are
written by libraries, see `wavelet_gis.io.mesh.cad`. Which formats there are is the table
`wavelet_gis.io.formats.MESH_FORMATS`.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import TriangleMesh
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.formats import MESH_SUFFIXES, any_of, identifiers, mesh_format
from wavelet_gis.io.read_back import recorded_stream, write_text

__all__ = ["write_2dm", "write_mesh", "write_obj", "write_ply"]

#: Lines that are formatted at once.
_LINES_AT_ONCE = 1 << 16


def write_mesh(path: str | os.PathLike[str], mesh: TriangleMesh, wkt: str | None = None) -> None:
    """Write a TIN in the format that the suffix names.

    Parameters
    ----------
    path : path
        Whose suffix is one of `wavelet_gis.io.formats.MESH_FORMATS`.
    mesh : TriangleMesh
        In the coordinates to be written; see `wavelet_gis.products.plane_mesh`.
    wkt : str, optional
        The CRS, for a ``.prj`` beside a 2DM file and for LandXML; the other formats know none.

    Raises
    ------
    OutputFileError
        When the suffix is none of these.
    MissingDependencyError
        When the library that writes GLB or DXF is absent.
    """
    row = mesh_format(path)
    if row is None:
        raise OutputFileError(
            f"{path}: a mesh is written as {any_of(MESH_SUFFIXES)}; use one of these suffixes."
        )
    writer = row.load_writer()
    if row.takes_crs:
        writer(path, mesh, wkt)
    else:
        writer(path, mesh)
    if wkt and row.has_prj:
        write_text(Path(path).with_suffix(".prj"), wkt)


def write_ply(path: str | os.PathLike[str], mesh: TriangleMesh) -> None:
    """Write a binary PLY: coordinates and attributes as doubles, faces as 32-bit indices."""
    names = identifiers(["x", "y", "z", *mesh.attribute_names])
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment {_software()}",
        f"element vertex {mesh.n_vertices}",
        *(f"property double {name}" for name in names),
        f"element face {mesh.n_faces}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    faces = np.empty(mesh.n_faces, dtype=[("n", "u1"), ("ids", "<i4", (3,))])
    faces["n"], faces["ids"] = 3, mesh.faces
    with recorded_stream(path) as stream:
        stream.write(("\n".join(header) + "\n").encode("ascii"))
        stream.write(np.hstack([mesh.vertices, mesh.attributes]).astype("<f8").tobytes())
        stream.write(faces.tobytes())


def write_obj(path: str | os.PathLike[str], mesh: TriangleMesh) -> None:
    """Write a Wavefront OBJ; it knows no attributes, and counts vertices from 1."""
    with recorded_stream(path) as stream:
        stream.write(f"# {_software()}\n")
        _write_lines(stream, "v %.15g %.15g %.15g\n", mesh.vertices)
        _write_lines(stream, "f %d %d %d\n", mesh.faces + 1)


def write_2dm(path: str | os.PathLike[str], mesh: TriangleMesh) -> None:
    """Write an SMS 2DM mesh, which QGIS and hydraulic models read; ids count from 1."""
    with recorded_stream(path) as stream:
        stream.write("MESH2D\n")
        ids = np.arange(1, mesh.n_faces + 1)
        # The last number is the material.
        elements = np.column_stack([ids, mesh.faces + 1, np.ones(mesh.n_faces, np.int64)])
        _write_lines(stream, "E3T %d %d %d %d %d\n", elements)
        for start in range(0, mesh.n_vertices, _LINES_AT_ONCE):
            block = mesh.vertices[start : start + _LINES_AT_ONCE]
            numbers = range(start + 1, start + 1 + len(block))
            stream.writelines(
                f"ND {k} {x:.15g} {y:.15g} {z:.15g}\n"
                for k, (x, y, z) in zip(numbers, block.tolist(), strict=True)
            )


def _write_lines(stream: IO[str], pattern: str, rows: NDArray[np.generic]) -> None:
    for start in range(0, len(rows), _LINES_AT_ONCE):
        block = rows[start : start + _LINES_AT_ONCE]
        stream.write((pattern * len(block)) % tuple(block.ravel().tolist()))


def _software() -> str:
    return f"terrain-wavelets {wavelet_core.__version__}"
