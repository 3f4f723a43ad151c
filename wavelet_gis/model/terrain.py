"""From a DEM or a cloud to the mesh that is analysed, and to all that is needed to come back."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wavelet_core import MeshError, Pyramid, TriangleMesh
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame, vertical_unit_name, working_frame
from wavelet_gis.errors import CrsError, CrsWarning, InputFileError, UnitWarning
from wavelet_gis.model.cloud import PointCloud, cloud_bounds
from wavelet_gis.model.cloud_origin import PointSource, cloud_mesh
from wavelet_gis.model.dem import Dem, RasterSource, dem_mesh, grid_bounds
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = [
    "Terrain",
    "frame_of_bounds",
    "terrain_of_cloud",
    "terrain_of_dem",
]


@dataclass(frozen=True, slots=True)
class Terrain:
    """A terrain in its working frame, ready to be analysed.

    Attributes
    ----------
    name : str
        Of the file, for messages and metadata.
    mesh : TriangleMesh
        In the working frame.
    original : Dem or PointCloud
        As it came.
    source : RasterSource or PointSource
        How to come back; without corrections until there is a pyramid.
    system : CoordinateSystem
        The CRS.
    frame : LocalFrame
        Between the file's coordinates and those of the mesh.
    vertical_unit : str
        Unit of z in the file.
    """

    name: str
    mesh: TriangleMesh
    original: Dem | PointCloud
    source: RasterSource | PointSource
    system: CoordinateSystem
    frame: LocalFrame
    vertical_unit: str

    def points_for_errors(self) -> NDArray[np.float64]:
        """Return every input point of the surface in the working frame, merged ones too."""
        if isinstance(self.source, PointSource):
            return self.source.points_for_errors(self.mesh, self.frame)
        return self.mesh.vertices

    def geo_pyramid(self, pyramid: Pyramid) -> GeoPyramid:
        """Return the pyramid with everything that its file must hold.

        The finest mesh is synthesised once, to keep what rounding loses.
        """
        finest = pyramid.synthesise()
        source = self.source.with_corrections(self.original, finest, self.frame)  # type: ignore[arg-type]
        return GeoPyramid(
            pyramid=pyramid,
            system=self.system,
            frame=self.frame,
            vertical_unit=self.vertical_unit,
            source=source,
            source_name=self.name,
        )


def terrain_of_dem(
    name: str, dem: Dem, system: CoordinateSystem, vertical_unit: str | None = None
) -> Terrain:
    """Return the terrain of a DEM that is in memory already, as QGIS hands it over.

    Parameters
    ----------
    name : str
        For messages and metadata.
    dem : Dem
        The raster.
    system : CoordinateSystem
        Its CRS.
    vertical_unit : str, optional
        Unit of z; see `wavelet_gis.crs.frame.working_frame` for what holds without it.
    """
    if not dem.valid.any():
        raise InputFileError(
            f"{name}: every cell of the raster is nodata, so there is no terrain in it; check the "
            "band and the nodata value."
        )
    frame, unit = frame_of_bounds(name, system, grid_bounds(dem.geometry), vertical_unit)
    mesh = dem_mesh(dem, frame)
    if mesh.n_faces == 0:
        raise InputFileError(
            f"{name}: no three neighbouring cells have data, so there is no surface; check the "
            "band and the nodata value."
        )
    return Terrain(name, mesh, dem, RasterSource.from_dem(dem), system, frame, unit)


def terrain_of_cloud(
    name: str,
    cloud: PointCloud,
    system: CoordinateSystem,
    vertical_unit: str | None = None,
    *,
    fault: str = "",
    duplicates: str = "lowest",
    max_edge: float | Literal["auto"] | None = None,
    concave: bool = False,
) -> Terrain:
    """Return the terrain of a point cloud that is in memory already.

    Parameters
    ----------
    name : str
        For messages and metadata.
    cloud : PointCloud
        The points.
    system : CoordinateSystem
        Their CRS.
    vertical_unit : str, optional
        Unit of z; see `wavelet_gis.crs.frame.working_frame` for what holds without it.
    fault : str
        Why there is no CRS, for the warning.
    duplicates, max_edge, concave
        See `wavelet_gis.model.cloud_origin.cloud_mesh`.
    """
    n_points = cloud.n_used
    if n_points < 3:
        raise InputFileError(
            f"{name}: the cloud has {n_points} point{'s' * (n_points != 1)}; a "
            "surface needs at least three (check the file, and --classes if given)."
        )
    _require_plan(name, cloud, system)
    frame, unit = frame_of_bounds(name, system, cloud_bounds(cloud), vertical_unit, fault)
    try:
        mesh, source = cloud_mesh(
            cloud, frame, duplicates=duplicates, max_edge=max_edge, concave=concave, name=name
        )
    except (MeshError, InputFileError) as error:
        raise InputFileError(f"{name}: {error}") from error
    return Terrain(name, mesh, cloud, source, system, frame, unit)


def _require_plan(name: str, cloud: PointCloud, system: CoordinateSystem) -> None:
    """Refuse coordinates from the centre of the earth, where z is no height."""
    wkt = (system.wkt or "").replace(" ", "")
    if "GEOCCS[" not in wkt and "CS[Cartesian,3" not in wkt:
        return
    middle = cloud.coordinates()[: 1 << 20].mean(axis=0)
    if 6.2e6 < float(np.linalg.norm(middle)) < 6.5e6:
        raise CrsError(
            f"{name}: {system.name} is geocentric, x, y and z are from the centre of the earth and "
            "z is no height; reproject the points to a projected CRS first (for instance with "
            "PDAL's filters.reprojection)."
        )


def frame_of_bounds(
    name: str,
    system: CoordinateSystem,
    bounds: tuple[float, float, float, float],
    vertical_unit: str | None,
    fault: str = "",
) -> tuple[LocalFrame, str]:
    """Return the working frame over an area, and the name of its unit of z.

    Parameters
    ----------
    name : str
        Of the input, for messages.
    system : CoordinateSystem
        Its CRS.
    bounds : tuple of float
        Smallest x and y, largest x and y.
    vertical_unit : str or None
        Unit of z; see `wavelet_gis.crs.frame.working_frame` for what holds without it.
    fault : str
        Why there is no CRS, for the warning.

    Raises
    ------
    CrsError
        When the CRS or its extent cannot serve.

    Warns
    -----
    CrsWarning, UnitWarning
        As `wavelet_gis.workflows.open.open_terrain` tells.
    """
    try:
        frame = working_frame(system, bounds, vertical_unit)
    except CrsError as error:
        raise CrsError(f"{name}: {error}") from error
    if system.wkt is None:
        what = f"the CRS is broken ({fault})" if fault else "there is no CRS"
        _warn(f"{name}: {what}; x, y and z are taken as they are (give one with --crs)")
    elif system.kind == "unknown":
        _warn(
            f"{name}: the CRS {system.name!r} is neither geographic nor projected; x, y and z are "
            "taken as they are (give another with --crs)"
        )
    unit = vertical_unit or system.vertical_unit
    if unit is None:
        unit = "metre" if system.kind == "geographic" else "unit of x and y"
    else:
        unit = vertical_unit_name(unit)
    if frame.z_scale != 1.0 and abs(frame.z_scale - 1.0) > 1e-5:
        warnings.warn(
            f"{name}: z is in {unit.replace('_', ' ')} and is converted to the unit of the "
            "horizontal plane while working; results are in the file's units",
            UnitWarning,
            stacklevel=3,
        )
    return frame, unit


def _warn(message: str) -> None:
    warnings.warn(message, CrsWarning, stacklevel=4)
