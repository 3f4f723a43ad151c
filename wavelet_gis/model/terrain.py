"""From a DEM, a cloud or a TIN to the mesh that is analysed, and to all needed to come back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wavelet_core import MeshError, Pyramid, TriangleMesh, WaveletError
from wavelet_gis.crs.frame import (
    CoordinateSystem,
    LocalFrame,
    assumed_vertical_unit,
    vertical_unit_name,
    working_frame,
)
from wavelet_gis.errors import CrsError, CrsWarning, InputFileError, UnitWarning
from wavelet_gis.model.dem import Dem, dem_mesh, grid_bounds, require_sound
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.model.origin import Origin, Original
from wavelet_gis.model.points.cloud import PointCloud, cloud_bounds
from wavelet_gis.model.points.mesh import cloud_mesh
from wavelet_gis.model.raster_origin import RasterOrigin
from wavelet_gis.notes import Note, collected, note, warn

__all__ = [
    "Terrain",
    "frame_of_bounds",
    "require_plan",
    "terrain_of_cloud",
    "terrain_of_dem",
    "terrain_of_mesh",
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
    original : Dem, PointCloud or TriangleMesh
        As it came.
    origin : Origin
        How to come back; without corrections until there is a pyramid.
    system : CoordinateSystem
        The CRS.
    frame : LocalFrame
        Between the file's coordinates and those of the mesh.
    vertical_unit : str
        Unit of z in the file.
    notes : tuple of Note
        What is worth saying about it.
    merged : (n_merged, 3) float64 or None
        Points in the working frame that are no vertices, such as those that share x and y with a
        vertex which stands for them, where the origin does not keep them.
    locked : (n_vertices,) bool or None
        Vertices that stay at every level: of breaklines and a clip polygon, and fixed points.
    profile : (n, 3) float64 or None
        Where the terrain is known along such lines, in the working frame.
    segments : (n, 2, 2) float64 or None
        The pieces of such lines in plan, from and to.
    """

    name: str
    mesh: TriangleMesh
    original: Original
    origin: Origin
    system: CoordinateSystem
    frame: LocalFrame
    vertical_unit: str
    notes: tuple[Note, ...] = ()
    merged: NDArray[np.float64] | None = None
    locked: NDArray[np.bool_] | None = None
    profile: NDArray[np.float64] | None = None
    segments: NDArray[np.float64] | None = None

    def points_for_errors(self) -> NDArray[np.float64]:
        """Return every input point of the surface in the working frame, merged ones too."""
        points = self.origin.points
        if points is None:
            if self.merged is None:
                return self.mesh.vertices
            return np.concatenate([self.mesh.vertices, self.merged])
        return points.points_for_errors(self.mesh, self.frame)

    def with_notes(self, notes: list[Note]) -> Terrain:
        """Return the terrain with these notes instead of its own."""
        return replace(self, notes=tuple(notes))

    def uncorrected(self, pyramid: Pyramid) -> GeoPyramid:
        """Return the pyramid at its place, not yet fit to give the input back exactly.

        For what is taken from a pyramid that nobody keeps.
        """
        return GeoPyramid(
            pyramid=pyramid,
            system=self.system,
            frame=self.frame,
            vertical_unit=self.vertical_unit,
            origin=self.origin,
            source_name=self.name,
            notes=self.notes,
        )

    def geo_pyramid(self, pyramid: Pyramid, finest: TriangleMesh | None = None) -> GeoPyramid:
        """Return the pyramid with everything that its file must hold.

        Parameters
        ----------
        pyramid : Pyramid
            Of the terrain's mesh.
        finest : TriangleMesh, optional
            Its finest mesh, where it has been synthesised already; else it is here, to keep what
            rounding loses.
        """
        mesh = pyramid.synthesise() if finest is None else finest
        origin = self.origin.with_corrections(self.original, mesh, self.frame)
        return replace(self.uncorrected(pyramid), origin=origin)


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
    require_sound(dem, name)
    if not dem.valid.any():
        raise InputFileError(
            f"{name}: every cell of the raster is nodata; check the band and the nodata value."
        )
    with collected() as notes:
        frame, unit = frame_of_bounds(name, system, grid_bounds(dem.geometry), vertical_unit)
    mesh = dem_mesh(dem, frame)
    if mesh.n_faces == 0:
        raise InputFileError(
            f"{name}: no three neighbouring cells have data, so there is no surface; check the "
            "band and the nodata value."
        )
    origin = RasterOrigin.from_dem(dem)
    return Terrain(name, mesh, dem, origin, system, frame, unit, tuple(notes))


def terrain_of_cloud(
    name: str,
    cloud: PointCloud,
    system: CoordinateSystem,
    vertical_unit: str | None = None,
    *,
    fault: str = "",
    duplicates: str | None = None,
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
        See `wavelet_gis.model.points.mesh.cloud_mesh`.
    """
    n_points = cloud.n_used
    if n_points < 3:
        raise InputFileError(
            "{name}: the cloud has {points}; a surface needs at least three (check the file, and "
            "{0} if given).",
            "classes",
            name=name,
            points=f"{n_points} point{'s' * (n_points != 1)}",
        )
    require_plan(name, cloud, system)
    try:
        with collected() as notes:
            frame, unit = frame_of_bounds(name, system, cloud_bounds(cloud), vertical_unit, fault)
            mesh, origin = cloud_mesh(
                cloud, frame, duplicates=duplicates, max_edge=max_edge, concave=concave, name=name
            )
    except (MeshError, InputFileError) as error:
        raise _about(name, error, InputFileError) from error
    return Terrain(name, mesh, cloud, origin, system, frame, unit, tuple(notes))


def terrain_of_mesh(
    name: str,
    mesh: TriangleMesh,
    system: CoordinateSystem,
    frame: LocalFrame,
    vertical_unit: str,
) -> Terrain:
    """Return the terrain of a TIN that is in its working frame already.

    Parameters
    ----------
    name : str
        For messages and metadata.
    mesh : TriangleMesh
        In the working frame.
    system : CoordinateSystem
        The CRS of the input.
    frame : LocalFrame
        Between the two, as `wavelet_gis.model.tin.frame_of_coordinates` gives it.
    vertical_unit : str
        Unit of z in the input.
    """
    return Terrain(name, mesh, mesh, MeshOrigin(), system, frame, vertical_unit)


def require_plan(name: str, cloud: PointCloud, system: CoordinateSystem) -> None:
    """Refuse coordinates from the centre of the earth, where z is no height.

    Parameters
    ----------
    name : str
        For messages.
    cloud : PointCloud
        Some points.
    system : CoordinateSystem
        Their CRS.
    """
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
        When the CRS or its extent cannot be used.

    Warns
    -----
    CrsWarning, UnitWarning
        See `wavelet_gis.workflows.opening.raster_or_cloud.open_terrain`.
    """
    try:
        frame = working_frame(system, bounds, vertical_unit)
    except CrsError as error:
        raise _about(name, error, CrsError) from error
    if system.wkt is None:
        what = f"the CRS is broken ({fault})" if fault else "there is no CRS"
        warn(
            CrsWarning,
            "crs_missing",
            "{name}: {what}; x, y and z are taken as they are (give one with {0})",
            "crs",
            stacklevel=3,
            name=name,
            what=what,
        )
    elif system.kind == "unknown":
        warn(
            CrsWarning,
            "crs_of_unknown_kind",
            "{name}: the CRS {crs!r} is neither geographic nor projected; x, y and z are taken as "
            "they are (give another with {0})",
            "crs",
            stacklevel=3,
            name=name,
            crs=system.name,
        )
    elif system.kind == "geographic":
        note(
            "local_metric_frame",
            "{crs} is geographic: working in a local metric frame, {metres_east:.1f} m a unit of "
            "longitude and {metres_north:.1f} m of latitude; results stay in the input's "
            "coordinates",
            crs=system.name,
            metres_east=frame.x_scale,
            metres_north=frame.y_scale,
        )
    unit = vertical_unit or system.vertical_unit
    is_assumed = unit is None
    unit = assumed_vertical_unit(system) if unit is None else vertical_unit_name(unit)
    if is_assumed and system.kind == "projected" and frame.z_scale != 1.0:
        warn(
            UnitWarning,
            "vertical_unit_assumed",
            "{name}: x and y are in units of {metres:g} m and nothing gives the unit of z; metres "
            "are assumed ({0} names another)",
            "vertical_unit",
            stacklevel=3,
            name=name,
            metres=system.horizontal_unit,
        )
    elif frame.z_scale != 1.0 and abs(frame.z_scale - 1.0) > 1e-5:
        warn(
            UnitWarning,
            "vertical_unit_converted",
            "{name}: z is in {unit} and is converted to the unit of the horizontal plane while "
            "working; results are in the file's units",
            stacklevel=3,
            name=name,
            unit=unit.replace("_", " "),
        )
    return frame, unit


def _about(name: str, error: WaveletError, kind: type[WaveletError]) -> WaveletError:
    """Return the error with the name of the input before it, its parameters still named."""
    if not error.options and not error.values:
        return kind(f"{name}: {error}")
    return kind("{name}: " + error.template, *error.options, name=name, **error.values)
