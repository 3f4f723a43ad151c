"""TINs as UGRID netCDF, the layout that QGIS (MDAL), xugrid and D-Flow FM read."""

from __future__ import annotations

import io
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import TriangleMesh
from wavelet_core.mesh.connectivity import edges_of
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.formats import identifiers
from wavelet_gis.io.read_back import recorded_stream

__all__ = ["write_ugrid"]

#: Ids in the file count from 1, as Fortran does and the readers expect by default.
_FIRST_ID = 1

#: A variable of the classic format has at most so many bytes.
_LARGEST_VARIABLE = 2**31 - 4


def write_ugrid(path: str | os.PathLike[str], mesh: TriangleMesh, wkt: str | None = None) -> None:
    """Write a netCDF file by the UGRID conventions, attributes as variables of the nodes.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    mesh : TriangleMesh
        In the coordinates to be written.
    wkt : str, optional
        The CRS.

    Raises
    ------
    OutputFileError
        More triangles than the classic netCDF format holds.

    Notes
    -----
    netCDF 3 with 64-bit offsets, which scipy writes and every netCDF library reads. Conventions:
    UGRID 1.0, with the names of Deltares' files.
    """
    from scipy.io import netcdf_file

    if 12 * mesh.n_faces > _LARGEST_VARIABLE or 8 * mesh.n_vertices > _LARGEST_VARIABLE:
        raise OutputFileError(
            f"{path}: {mesh.n_faces:,} triangles are more than a classic netCDF file holds; write "
            "a PLY."
        )
    buffer = io.BytesIO()
    with netcdf_file(buffer, "w", version=2) as file:
        file.Conventions = "CF-1.8 UGRID-1.0 Deltares-0.10"
        file.source = f"terrain-wavelets {wavelet_core.__version__}"
        edges = edges_of(mesh.faces)[0]
        _add_dimensions(file, mesh, len(edges))
        _add_topology(file)
        on_map = {"mesh": "mesh2d", "location": "node"}
        if wkt:
            _add_crs(file, wkt)
            on_map["grid_mapping"] = "projected_coordinate_system"
        _add_nodes(file, mesh, on_map)
        _add_connectivity(file, edges, mesh)
        _add_attributes(file, mesh, on_map)
        file.flush()
        content = buffer.getvalue()
    with recorded_stream(path) as stream:
        stream.write(content)


def _add_dimensions(file: Any, mesh: TriangleMesh, n_edges: int) -> None:
    for name, size in (
        ("mesh2d_nNodes", mesh.n_vertices),
        ("mesh2d_nEdges", n_edges),
        ("mesh2d_nFaces", mesh.n_faces),
        ("mesh2d_nMax_face_nodes", 3),
        ("two", 2),
    ):
        file.createDimension(name, size)


def _add_topology(file: Any) -> None:
    """Add the variable without values that says which variables are the mesh."""
    _add(
        file, "mesh2d", np.array(0, "i4"), (),
        cf_role="mesh_topology",
        long_name="Topology of the terrain mesh",
        topology_dimension=np.int32(2),
        node_coordinates="mesh2d_node_x mesh2d_node_y",
        node_dimension="mesh2d_nNodes",
        edge_node_connectivity="mesh2d_edge_nodes",
        edge_dimension="mesh2d_nEdges",
        face_node_connectivity="mesh2d_face_nodes",
        face_dimension="mesh2d_nFaces",
        max_face_nodes_dimension="mesh2d_nMax_face_nodes",
    )  # fmt: skip


def _add_crs(file: Any, wkt: str) -> None:
    _add(
        file, "projected_coordinate_system", np.array(0, "i4"), (), wkt=wkt, crs_wkt=wkt,
        long_name="CRS of the mesh",
    )  # fmt: skip


def _add_nodes(file: Any, mesh: TriangleMesh, on_map: dict[str, str]) -> None:
    for axis, column in zip("xy", mesh.vertices.T, strict=False):
        _add(
            file, f"mesh2d_node_{axis}", column.astype("f8"), ("mesh2d_nNodes",),
            standard_name=f"projection_{axis}_coordinate", long_name=f"{axis} of the nodes",
            mesh="mesh2d", location="node",
        )  # fmt: skip
    _add(
        file, "mesh2d_node_z", mesh.vertices[:, 2].astype("f8"), ("mesh2d_nNodes",),
        standard_name="altitude", long_name="Bed level at the nodes", **on_map,
    )  # fmt: skip


def _add_connectivity(file: Any, edges: NDArray[Any], mesh: TriangleMesh) -> None:
    """Add the nodes of each edge and of each face, counted from `_FIRST_ID`."""
    connectivity = {"start_index": np.int32(_FIRST_ID)}
    _add(
        file, "mesh2d_edge_nodes", (edges + _FIRST_ID).astype("i4"), ("mesh2d_nEdges", "two"),
        cf_role="edge_node_connectivity", long_name="Nodes of the edges", **connectivity,
    )  # fmt: skip
    _add(
        file, "mesh2d_face_nodes", (mesh.faces + _FIRST_ID).astype("i4"),
        ("mesh2d_nFaces", "mesh2d_nMax_face_nodes"),
        cf_role="face_node_connectivity", long_name="Nodes of the faces",
        _FillValue=np.int32(-999), **connectivity,
    )  # fmt: skip


def _add_attributes(file: Any, mesh: TriangleMesh, on_map: dict[str, str]) -> None:
    variables = identifiers(mesh.attribute_names, "mesh2d_attribute_")
    for variable, name, values in zip(
        variables, mesh.attribute_names, mesh.attributes.T, strict=True
    ):
        _add(file, variable, values.astype("f8"), ("mesh2d_nNodes",), long_name=name, **on_map)


def _add(
    file: Any, name: str, values: NDArray[Any], dimensions: tuple[str, ...], **attributes: Any
) -> None:
    variable = file.createVariable(name, values.dtype.str[1:], dimensions)
    variable.data[...] = values  # scipy's own assignment knows no scalars
    for key, value in attributes.items():
        setattr(variable, key, value.encode("utf-8") if isinstance(value, str) else value)
