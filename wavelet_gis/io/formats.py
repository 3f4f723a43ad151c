"""The file formats, one row each; everything that lists or checks formats reads these tables.

Another mesh format is a function ``write(path, mesh)``, which writes by
`wavelet_gis.io.read_back.recorded_stream`, and one row here: the commands' help, their checks, the
dialogs in QGIS, the documentation's table and its test have it from there. Nothing is imported
here, so that help and dialogs can list formats where no package is installed; a writer is therefore
named, and loaded when it writes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from importlib import import_module
from itertools import chain, count
from typing import NamedTuple

__all__ = [
    "CLOUD_SUFFIXES",
    "FOLDER_RASTER_SUFFIXES",
    "MESH_FORMATS",
    "MESH_SUFFIXES",
    "PICTURE_SUFFIXES",
    "POINT_TABLE_SUFFIXES",
    "PYRAMID_SUFFIX",
    "RASTER_FORMATS",
    "RASTER_SUFFIXES",
    "VECTOR_SUFFIXES",
    "MeshFormat",
    "RasterFormat",
    "any_of",
    "identifiers",
    "mesh_format",
    "suffix_of",
]


class MeshFormat(NamedTuple):
    """A file format of TINs.

    suffix : str, lower case with the dot
    name : str, as people call it
    writer : str, ``module:function`` of the function that takes path and mesh
    used_by : str, what opens it
    package : str or None, the package that the writer needs beyond numpy, as pip names it
    keeps_attributes : bool
    takes_crs : bool, whether the writer takes the CRS as WKT for its third argument
    has_prj : bool, whether the CRS goes into a ``.prj`` file beside it
    has_local_origin : bool, whether coordinates count from an origin that the file names
    """

    suffix: str
    name: str
    writer: str
    used_by: str
    package: str | None = None
    keeps_attributes: bool = False
    takes_crs: bool = False
    has_prj: bool = False
    has_local_origin: bool = False

    def load_writer(self) -> Callable[..., None]:
        """Return the function that writes it."""
        module, function = self.writer.split(":")
        return getattr(import_module(module), function)


class RasterFormat(NamedTuple):
    """A file format of rasters of surfaces and of values at vertices.

    suffix : str, lower case with the dot
    name : str, as people call it
    """

    suffix: str
    name: str


#: TINs as mesh files.
MESH_FORMATS = (
    MeshFormat(
        ".ply", "PLY", "wavelet_gis.io.mesh.meshes:write_ply", "3D software", keeps_attributes=True
    ),
    MeshFormat(".obj", "OBJ", "wavelet_gis.io.mesh.meshes:write_obj", "3D software"),
    MeshFormat(
        ".2dm",
        "2DM",
        "wavelet_gis.io.mesh.meshes:write_2dm",
        "QGIS (as a mesh layer), hydraulic models",
        has_prj=True,
    ),
    MeshFormat(
        ".nc",
        "UGRID",
        "wavelet_gis.io.mesh.ugrid:write_ugrid",
        "QGIS (as a mesh layer), D-Flow FM, xugrid",
        keeps_attributes=True,
        takes_crs=True,
    ),
    MeshFormat(
        ".slf",
        "SELAFIN",
        "wavelet_gis.io.mesh.selafin:write_selafin",
        "TELEMAC, QGIS (as a mesh layer)",
        package="python-serafin",
        keeps_attributes=True,
        takes_crs=True,
        has_prj=True,
    ),
    MeshFormat(
        ".stl", "STL", "wavelet_gis.io.mesh.cad:write_stl", "3D printers", has_local_origin=True
    ),
    MeshFormat(
        ".glb",
        "GLB",
        "wavelet_gis.io.mesh.cad:write_glb",
        "3D viewers, web pages",
        package="trimesh",
        has_local_origin=True,
    ),
    MeshFormat(
        ".xml",
        "LandXML",
        "wavelet_gis.io.mesh.cad:write_landxml",
        "CAD, machine control",
        takes_crs=True,
    ),
    MeshFormat(".dxf", "DXF", "wavelet_gis.io.mesh.cad:write_dxf", "CAD", package="ezdxf"),
)

MESH_SUFFIXES = tuple(row.suffix for row in MESH_FORMATS)

#: Rasters of surfaces and of values at vertices. A DEM that is restored may be any format that
#: GDAL writes.
RASTER_FORMATS = (RasterFormat(".tif", "GeoTIFF"), RasterFormat(".tiff", "GeoTIFF"))

RASTER_SUFFIXES = tuple(row.suffix for row in RASTER_FORMATS)

#: What is read and written with laspy.
CLOUD_SUFFIXES = (".las", ".laz")

#: The file by which a set of Entwine Point Tiles is named; its nodes are LAZ files.
EPT = "ept.json"

#: By these, rasters are found in a folder; those that are named may have any.
FOLDER_RASTER_SUFFIXES = (".tif", ".tiff", ".vrt", ".img", ".asc", ".bil", ".flt", ".hgt", ".dem")

#: Tables of points as text: x, y, z and attributes by column.
POINT_TABLE_SUFFIXES = (".csv", ".xyz")

#: Vector layers of points or triangles, as GDAL reads them.
VECTOR_SUFFIXES = (".gpkg", ".shp", ".geojson", ".json", ".fgb", ".gml", ".kml", ".parquet")

#: Of a pyramid file, and of vector layers.
PYRAMID_SUFFIX = ".gpkg"

#: Pictures that matplotlib draws.
PICTURE_SUFFIXES = (".png", ".svg", ".pdf")


def identifiers(names: Iterable[str], prefix: str = "") -> list[str]:
    """Return names as ASCII identifiers, each another one.

    Parameters
    ----------
    names : iterable of str
        Any, such as those of attributes.
    prefix : str
        Before each.

    Examples
    --------
    >>> identifiers(["depth (m)", "depth [m]", "Höhe"])
    ['depth__m_', 'depth__m__2', 'H_he']
    """
    found: list[str] = []
    for name in names:
        cleaned = "".join(c if c.isalnum() and c.isascii() else "_" for c in name)
        cleaned = prefix + (cleaned or "attribute")
        tried = chain([cleaned], (f"{cleaned}_{number}" for number in count(2)))
        found.append(next(word for word in tried if word not in found))
    return found


def suffix_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file's name, lower case with the dot; empty where there is none.

    Examples
    --------
    >>> suffix_of("data/Tile.COPC.LAZ"), suffix_of("data.v2/tile")
    ('.laz', '')
    """
    return os.path.splitext(os.fspath(path))[1].lower()


def is_cloud(name: str | os.PathLike[str]) -> bool:
    """Return whether a file's name is that of a point cloud.

    Examples
    --------
    >>> is_cloud("tile.copc.laz"), is_cloud("set/ept.json"), is_cloud("points.json")
    (True, True, False)
    """
    return suffix_of(name) in CLOUD_SUFFIXES or os.path.basename(name) == EPT


def mesh_format(path: str | os.PathLike[str]) -> MeshFormat | None:
    """Return the mesh format that a file's suffix names, if there is one."""
    suffix = suffix_of(path)
    return next((row for row in MESH_FORMATS if row.suffix == suffix), None)


def any_of(words: tuple[str, ...] | list[str], last: str = "or") -> str:
    """Return words as a list for people.

    Examples
    --------
    >>> any_of([".ply", ".2dm", ".obj"])
    '.ply, .2dm or .obj'
    """
    *first, final = words
    return f"{', '.join(first)} {last} {final}" if first else final
