"""A mesh of a pyramid with x, y and z in one unit of length, as mesh files must have them."""

from __future__ import annotations

from typing import NamedTuple

from wavelet_core import TriangleMesh
from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.model.attributes.categories import Categories
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.notes import note

__all__ = ["PlaneMesh", "plane_mesh"]


class PlaneMesh(NamedTuple):
    """A mesh that may go into a mesh file.

    mesh : TriangleMesh
        With x, y and z in one unit.
    system : CoordinateSystem
        Of x and y.
    """

    mesh: TriangleMesh
    system: CoordinateSystem


def plane_mesh(
    geo: GeoPyramid,
    mesh: TriangleMesh,
    to_crs: str | None = None,
    categories: Categories = "nearest",
) -> PlaneMesh:
    """Return a mesh of the pyramid in a plane: the input's own, or one that fits its degrees.

    Parameters
    ----------
    geo : GeoPyramid
        Gives CRS and frame.
    mesh : TriangleMesh
        In the working frame.
    to_crs : str, optional
        A projected CRS such as EPSG:2154, or ``"auto"`` for the UTM zone; by default the input's
        own when it is projected, else the UTM zone.
    categories : {"nearest", "number"}
        See `wavelet_gis.model.geo_pyramid.GeoPyramid.file_mesh`.

    Raises
    ------
    CrsError
        When there is no such CRS, it is not projected, or the input has none.

    Notes
    -----
    Viewers and CAD take x, y and z for one unit, so z of another unit is converted, too. What is
    other than in the input is noted (`wavelet_gis.notes`).
    """
    system = geo.system
    is_geographic = system.kind == "geographic"
    in_file = geo.file_mesh(mesh, categories=categories)
    if to_crs is None and not is_geographic:
        if geo.frame.z_scale != 1.0:
            note(
                "mesh_file_unit",
                "z of the mesh file is converted from {unit} to the unit of x and y",
                unit=geo.vertical_unit.replace("_", " "),
            )
        return PlaneMesh(
            TriangleMesh(mesh.vertices, mesh.faces, in_file.attributes, in_file.attribute_names),
            system,
        )
    from wavelet_gis.crs.projection import plane_for, projected

    plane = plane_for(system, in_file.vertices[:, :2], to_crs or "auto")
    x, y = projected(system, plane, in_file.vertices[:, 0], in_file.vertices[:, 1])
    metres = mesh.vertices[:, 2] * system.working_unit
    vertices = mesh.vertices.copy()
    vertices[:, 0], vertices[:, 1], vertices[:, 2] = x, y, metres / plane.horizontal_unit
    placed = TriangleMesh(vertices, mesh.faces, in_file.attributes, in_file.attribute_names)
    note(
        "mesh_file_crs",
        "x, y and z of the mesh file are in {crs}, instead of {was} ({0} names another CRS)",
        "to_crs",
        crs=plane.name,
        was="degrees" if is_geographic else system.name,
    )
    return PlaneMesh(placed, plane)
