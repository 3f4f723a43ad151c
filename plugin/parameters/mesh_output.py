"""A surface written as a raster or as a mesh file."""

from __future__ import annotations

import os

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingParameterFileDestination,
    QgsProcessingUtils,
)

from ..ui import dependencies
from ..ui import layer_styles as styles
from ..ui.translation import tr
from .pyramid import cell_size, crs_of

#: Suffixes of mesh files and what their formats are called, the default first; those of
#: ``wavelet_gis.io.meshes``, which a test compares.
FORMATS = {
    ".2dm": "2DM",
    ".ply": "PLY",
    ".obj": "OBJ",
    ".stl": "STL",
    ".glb": "GLB",
    ".xml": "LandXML",
    ".dxf": "DXF",
}
#: What a format needs beyond numpy.
PACKAGES = {".glb": (dependencies.TRIMESH,), ".dxf": (dependencies.EZDXF,)}


def add_mesh_parameter(algorithm, description) -> None:
    """Declare MESH, a file in one of the formats."""
    algorithm.add(
        QgsProcessingParameterFileDestination(
            "MESH",
            description,
            ";;".join(f"{name} (*{suffix})" for suffix, name in FORMATS.items()),
            optional=True,
            createByDefault=False,
        ),
        tr(
            "The suffix chooses the format. A 2DM mesh opens in QGIS as a mesh layer and in "
            "hydraulic models; PLY alone keeps attributes; OBJ, STL and GLB are for 3D viewers and "
            "printers; LandXML (.xml) and DXF for CAD. GLB needs the Python package trimesh, DXF "
            "ezdxf. STL and GLB hold coordinates from a local origin, which the file tells."
        ),
    )


def mesh_packages(algorithm, parameters, context) -> tuple[dependencies.Package, ...]:
    """Return what the format of MESH needs beyond numpy."""
    path = algorithm.parameterAsFileOutput(parameters, "MESH", context)
    return PACKAGES.get(_suffix(path), ())


def write_raster(algorithm, parameters, name, context, geo, mesh, feedback) -> str:
    """Write a mesh of the pyramid (in the working frame) as a raster and return its path.

    The grid is that of the DEM the pyramid came from, or, with CELL_SIZE, one over the mesh.
    """
    from wavelet_gis.products.level_raster import surface_dem

    from ..qgis_io.raster_writer import write_dem

    path = algorithm.parameterAsOutputLayer(parameters, name, context)
    size = cell_size(algorithm, parameters, context)
    write_dem(path, surface_dem(geo, mesh, cell_size=size), crs_of(geo), feedback)
    styles.style_output(context, path, styles.style_hillshade)
    return path


def write_mesh_file(algorithm, parameters, name, context, geo, mesh) -> str:
    """Write a mesh of the pyramid as a mesh file; a 2DM opens as a layer if there is a project."""
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.meshes import write_mesh

    path = algorithm.parameterAsFileOutput(parameters, name, context)
    with new_file(path, overwrite=True) as scratch:
        write_mesh(scratch, geo.file_mesh(mesh), geo.system.wkt)
    if _suffix(path) == ".2dm" and context.project() is not None:
        details = QgsProcessingContext.LayerDetails(
            os.path.splitext(os.path.basename(path))[0],
            context.project(),
            name,
            QgsProcessingUtils.LayerHint.Mesh,
        )
        context.addLayerToLoadOnCompletion(path, details)
        styles.style_output(context, path, styles.set_mesh_crs)
    return path


def _suffix(path: str) -> str:
    return os.path.splitext(path)[1].lower()
