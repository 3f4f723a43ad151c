"""A TIN of a pyramid as an object of other libraries, which are imported when asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from wavelet_core import TriangleMesh
from wavelet_core.errors import MissingDependencyError, OptionError
from wavelet_gis.model.geo_pyramid import GeoPyramid

if TYPE_CHECKING:
    import geopandas
    import pyvista
    import trimesh
    import xarray

__all__ = ["InOtherLibraries"]


class InOtherLibraries:
    """What a TIN with its place is as an object of geopandas, xarray, pyvista and trimesh."""

    __slots__ = ()

    geo: GeoPyramid
    mesh: TriangleMesh

    def to_geodataframe(
        self, what: Literal["triangles", "vertices"] = "triangles"
    ) -> geopandas.GeoDataFrame:
        """Return the triangles, or the vertices, in the CRS of the input.

        Parameters
        ----------
        what : {"triangles", "vertices"}
            Polygons with z, one a face; or points with z, with the attributes as columns.

        Raises
        ------
        MissingDependencyError
            Without geopandas.
        OptionError
            Another word.
        """
        if what not in ("triangles", "vertices"):
            raise OptionError(
                "{0} is {given}; give triangles or vertices.", "what", given=repr(what)
            )
        gpd = _library("geopandas")
        import shapely

        mesh = self.geo.file_mesh(self.mesh)
        crs = self.geo.system.wkt or None
        if what == "triangles":
            return gpd.GeoDataFrame(geometry=shapely.polygons(mesh.vertices[mesh.faces]), crs=crs)
        columns = {name: mesh.attributes[:, k] for k, name in enumerate(mesh.attribute_names)}
        return gpd.GeoDataFrame(columns, geometry=shapely.points(mesh.vertices), crs=crs)

    def to_dataarray(
        self, cell_size: float | None = None, attribute: str | None = None
    ) -> xarray.DataArray:
        """Return the heights, or an attribute, on a grid, NaN where no triangle is.

        Parameters
        ----------
        cell_size : float, optional
            In the unit of the CRS; by default the grid of the input, and for points their mean
            spacing.
        attribute : str, optional
            Instead of the elevation.

        Returns
        -------
        xarray.DataArray
            With the coordinates ``y`` and ``x`` of the cells' centres, and the CRS as rioxarray
            reads it (``.rio.crs``), which need not be installed.

        Raises
        ------
        MissingDependencyError
            Without xarray.
        OptionError
            The grid of the input is turned and no cell size is given, or there are too many cells.
        """
        xr = _library("xarray")
        from wavelet_gis.products.level_raster import surface_dem

        dem = surface_dem(self.geo, self.mesh, cell_size=cell_size, attribute=attribute)
        if not dem.geometry.is_axis_aligned:
            raise OptionError(
                "the grid of the input is rotated, so that its rows have no single y; give {0}.",
                "cell_size",
            )
        values = np.full(dem.geometry.shape, np.nan)
        values[dem.valid] = dem.elevations()
        n_rows, n_columns = dem.geometry.shape
        x = dem.geometry.centres(np.arange(n_columns), np.zeros(n_columns))[0]
        y = dem.geometry.centres(np.zeros(n_rows), np.arange(n_rows))[1]
        wkt = self.geo.system.wkt
        place = xr.DataArray(0, attrs={"crs_wkt": wkt, "spatial_ref": wkt} if wkt else {})
        return xr.DataArray(
            values,
            {"y": y, "x": x, "spatial_ref": place},
            ("y", "x"),
            name=attribute or "elevation",
            attrs={"units": self.geo.vertical_unit} if attribute is None else {},
        )

    def to_pyvista(self) -> pyvista.PolyData:
        """Return the TIN as a surface to be drawn, in the working frame, attributes included.

        Raises
        ------
        MissingDependencyError
            Without pyvista.
        """
        pv = _library("pyvista")
        mesh = self.geo.file_mesh(self.mesh)
        faces = np.column_stack([np.full(self.mesh.n_faces, 3), self.mesh.faces])
        surface = pv.PolyData(self.mesh.vertices.copy(), faces.ravel())
        surface["elevation"] = mesh.vertices[:, 2]
        for k, name in enumerate(mesh.attribute_names):
            surface[name] = mesh.attributes[:, k]
        return surface

    def to_trimesh(self) -> trimesh.Trimesh:
        """Return the TIN as it is, vertices in their order, in the working frame.

        Raises
        ------
        MissingDependencyError
            Without trimesh.
        """
        library = _library("trimesh")
        return library.Trimesh(self.mesh.vertices, self.mesh.faces, process=False)


def _library(name: str) -> Any:
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError as error:
        raise MissingDependencyError(
            f"this needs the Python package {name}; install it: pip install {name}"
        ) from error
