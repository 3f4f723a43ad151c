"""A surface written as a raster or as a mesh file."""

from __future__ import annotations

import html
import os
from typing import TYPE_CHECKING

from qgis.core import QgsProcessingContext, QgsProcessingParameterFileDestination

from ..ui import dependencies
from ..ui import layer_styles as styles
from ..ui.enums import MESH_LAYER
from ..ui.translation import tr
from .pyramid import crs_of

if TYPE_CHECKING:
    from wavelet_gis.io.formats import MeshFormat
    from wavelet_gis.workflows.extract import Surface

    from ..base import TerrainWaveletsAlgorithm
    from ..qgis_io.background import Work
    from .request import Request

#: What a dialog offers first, because it opens in QGIS.
DEFAULT_SUFFIX = ".2dm"


def add_mesh_parameter(algorithm: TerrainWaveletsAlgorithm, description: str) -> None:
    """Declare MESH, a file in one of the formats of ``wavelet_gis.io.formats``."""
    from wavelet_gis.io.formats import MESH_FORMATS

    rows = sorted(MESH_FORMATS, key=lambda row: row.suffix != DEFAULT_SUFFIX)
    algorithm.add(
        QgsProcessingParameterFileDestination(
            "MESH",
            description,
            ";;".join(f"{row.name} (*{row.suffix})" for row in rows),
            optional=True,
            createByDefault=False,
        ),
        tr("The suffix chooses the format:") + "".join(f"<br>{_format_help(row)}" for row in rows),
    )


def _format_help(row: MeshFormat) -> str:
    """Return one mesh format as a line: its suffix, what opens it, what it needs and keeps."""
    facts = [html.escape(tr(row.used_by), quote=False)]
    if row.package:
        facts.append(tr("needs the Python package {}").format(row.package))
    if row.keeps_attributes:
        facts.append(tr("keeps attributes"))
    if row.has_local_origin:
        facts.append(tr("coordinates count from an origin that the file names"))
    return f"<i>{row.suffix}</i> {row.name}: {'; '.join(facts)}"


def mesh_packages(request: Request) -> tuple[dependencies.Package, ...]:
    """Return what the format of MESH needs beyond NumPy."""
    from wavelet_gis.io.formats import mesh_format

    row = mesh_format(request.output_file("MESH"))
    return () if row is None or row.package is None else (dependencies.named(row.package),)


def write_raster(request: Request, name: str, surface: Surface, start: float, stop: float) -> str:
    """Write a surface as a raster, in a part of the bar, and return its path.

    The grid is that of the DEM the pyramid came from, or, with CELL_SIZE, one over the surface.
    """
    from wavelet_gis.products.level_raster import surface_dem

    from ..qgis_io.raster_writer import write_dem

    path = request.output_layer(name)
    cell_size, middle = request.size("CELL_SIZE"), (start + stop) / 2
    dem = request.computed(
        lambda work: surface_dem(surface.geo, surface.mesh, cell_size=cell_size), start, middle
    )
    write_dem(path, dem, crs_of(surface.geo), request.feedback, request.progress(middle, stop))
    request.finish(name, path, styles.style_hillshade)
    return path


def write_mesh_file(
    request: Request, name: str, surface: Surface, start: float, stop: float
) -> str:
    """Write a surface as a mesh file, in a part of the bar.

    A 2DM opens as a layer if there is a project.
    """
    from wavelet_core.progress import report, watched_part
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.formats import suffix_of

    path = request.output_file(name)

    def write(work: Work) -> None:
        with new_file(path, overwrite=True) as scratch, watched_part(work.progress):
            surface.write(scratch)
            report(work.progress, 1.0)  # the last moment at which it can be stopped

    request.computed(write, start, stop)
    project = request.context.project()
    if suffix_of(path) == ".2dm" and project is not None:
        title = _title_of(request, name, path)
        details = QgsProcessingContext.LayerDetails(title, project, name, MESH_LAYER)
        request.context.addLayerToLoadOnCompletion(path, details)
        request.finish(name, path, styles.set_mesh_crs)
    return path


def _title_of(request: Request, name: str, path: str) -> str:
    """Return the name of a mesh layer: the file's, or, of a temporary one, the output's."""
    definition = request.algorithm.parameterDefinition(name)
    stem = os.path.splitext(os.path.basename(path))[0]
    return definition.description() if definition is not None and stem == name else stem
