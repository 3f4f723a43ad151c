"""What has changed between two surveys of one place, by scale."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.features.signature import joined_levels
from wavelet_core.features.spectrum import Components, band_components
from wavelet_core.filtering.gains import relifted
from wavelet_core.lifting.spacings import level_spacings
from wavelet_core.mesh.location import surface_errors
from wavelet_core.progress import part_of, report
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import note
from wavelet_gis.products.vertex_raster import Bands, value_bands
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of, require_levels

__all__ = ["ChangeBand", "ChangeByScale", "change_by_scale"]

FloatArray = NDArray[np.float64]


class ChangeBand(NamedTuple):
    """The change of one band of sizes.

    levels : (int, int) or None, the first and the last; None for the base, which is coarser
    spacing : float, median edge length of the finest mesh of the band, in the working unit
    rms, lowest, highest : float, of the change, in the unit of z of the pyramid's input
    """

    levels: tuple[int, int] | None
    spacing: float
    rms: float
    lowest: float
    highest: float


@dataclass(frozen=True, slots=True)
class ChangeByScale:
    """The change at the vertices of a pyramid, as a sum of bands of sizes.

    Attributes
    ----------
    geo : GeoPyramid
        The pyramid of the change itself: its z is how much has risen. It can be filtered, mapped
        and saved like any other.
    columns : (n_vertices, n_bands) float64
        What each band adds, the base first, in the input's unit of z. Their sum is the change.
    is_known : (n_vertices,) bool
        Where both surveys have a height.
    bands : tuple of ChangeBand
        One for each column.
    """

    geo: GeoPyramid
    columns: FloatArray
    is_known: NDArray[np.bool_]
    bands: tuple[ChangeBand, ...]

    @property
    def total(self) -> FloatArray:
        """Return how much each vertex has risen."""
        total: FloatArray = self.columns.sum(axis=1)
        return total

    def raster(self, cell_size: float | None = None, progress: Progress | None = None) -> Bands:
        """Return the change as a raster: all of it, then one band for each column.

        Parameters
        ----------
        cell_size : float, optional
            In the input's unit of x and y; by default the grid of the input.
        progress : callable, optional
            Called with a fraction in [0, 1]; the work stops when it returns False.
        """
        values = np.where(self.is_known, np.column_stack([self.total, self.columns]).T, np.nan).T
        sizes = [f"{band.spacing:.4g}" for band in self.bands]
        names = ["change", f"base, above {sizes[0]}", *(f"spacing {size}" for size in sizes[1:])]
        mesh = self.geo.pyramid.synthesise()
        return value_bands(self.geo, mesh, values, names, cell_size, progress)

    def write(
        self, path: str | os.PathLike[str], *, cell_size: float | None = None
    ) -> dict[str, Any]:
        """Write a raster; see `wavelet_gis.workflows.save.save`."""
        from wavelet_gis.io.raster import write_bands

        bands = self.raster(cell_size)
        write_bands(path, bands, self.geo.system.wkt)
        return {"band_names": list(bands.names), "shape": list(bands.geometry.shape)}

    def figures(self) -> dict[str, Any]:
        """Return the change of all and of each band, as JSON-able values."""
        known = self.total[self.is_known]
        return {
            "n_vertices": int(np.count_nonzero(self.is_known)),
            "n_not_covered": int(np.count_nonzero(~self.is_known)),
            "mean": float(known.mean()),
            "rms": float(np.sqrt((known**2).mean())),
            "lowest": float(known.min()),
            "highest": float(known.max()),
            "bands": [band._asdict() for band in self.bands],
        }


def change_by_scale(
    later: HoldsPyramid | GeoPyramid,
    earlier: Terrain | str | os.PathLike[str],
    *,
    progress: Progress | None = None,
) -> ChangeByScale:
    """Return how much terrain has risen since an earlier survey, taken apart by scale.

    Parameters
    ----------
    later : Analysis, Filtered or GeoPyramid
        The pyramid of the later survey. For bands that mean sizes on the ground it is one with
        ``partition="random", prediction="plane"``.
    earlier : Terrain or path
        The earlier survey, whatever `wavelet_gis.open` opens, in the same CRS. Its cells, or
        points, need not be those of the later one.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        A pyramid without levels, or one that lifts x and y.
    InputFileError
        An earlier survey that is a pyramid, has another CRS, or lies elsewhere.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The earlier surface is read at the vertices of the later one, and the difference is lifted by
    the filters of the later pyramid. Lifting is linear, so each band of it is the band of the later
    survey less that of the earlier one, on one and the same set of levels. Where the earlier survey
    has nothing the change of the nearest place goes on, for the sake of the levels, and is left out
    of what is written.
    """
    geo = pyramid_of(later)
    require_levels(geo)
    if geo.pyramid.horizontal is None:
        raise OptionError("the pyramid lifts x and y too; analyse with {0} z.", "signal")
    if geo.pyramid.parameters.get("partition") != "random":
        note(
            "bands_are_no_sizes",
            "the levels of this pyramid are no bands of sizes; analyse with {0} random and {1} "
            "plane for those",
            "partition",
            "prediction",
        )
    terrain = earlier if isinstance(earlier, Terrain) else _opened(earlier)
    rise, is_known = _rise(geo, terrain)
    report(progress, 0.3)
    finest = geo.pyramid.synthesise()
    vertices = np.column_stack([finest.vertices[:, :2], rise])
    change = TriangleMesh(
        vertices, finest.faces, np.zeros_like(finest.attributes), finest.attribute_names
    )
    lifted = relifted(geo.pyramid, change)
    report(progress, 0.5)
    components = band_components(lifted, "z", part_of(progress, 0.5, 0.7))
    altered = geo.with_pyramid(lifted, f"change since {terrain.name}")
    unit = geo.frame.z_scale
    levels = joined_levels(lifted)
    columns = _columns(components, levels) / unit
    bands = _bands(altered, levels, columns, is_known, part_of(progress, 0.7, 1.0))
    return ChangeByScale(altered, columns, is_known, bands)


def _opened(path: str | os.PathLike[str]) -> Terrain:
    from wavelet_gis.workflows.open import open_data

    opened = open_data(path)
    if not isinstance(opened, Terrain):
        raise InputFileError(
            f"{os.fspath(path)}: this is a pyramid; give the DEM or the cloud that it was made "
            "from, or 'reconstruct' it."
        )
    return opened


def _rise(geo: GeoPyramid, earlier: Terrain) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return how far the vertices are above the earlier surface, in the working frame."""
    from wavelet_gis.crs.agreement import agreed

    agreed(
        [geo.source_name, earlier.name],
        [Georeference(wkt=geo.system.wkt), Georeference(wkt=earlier.system.wkt)],
    )
    places = geo.frame.to_file(geo.pyramid.synthesise().vertices)
    rise = surface_errors(earlier.mesh, earlier.frame.to_local(places))
    is_known = np.isfinite(rise)
    if not is_known.any():
        raise InputFileError(
            f"{earlier.name}: nothing of it lies below {geo.source_name}; check that they overlap."
        )
    if not is_known.all():
        from scipy.spatial import cKDTree

        plan = geo.pyramid.synthesise().vertices[:, :2]
        nearest = cKDTree(plan[is_known]).query(plan[~is_known])[1]
        rise[~is_known] = rise[is_known][nearest]
    return rise, is_known


def _columns(components: Components, levels: list[tuple[int, int]]) -> FloatArray:
    bands = [components.bands[:, first:stop].sum(axis=1) for first, stop in levels]
    return np.column_stack([components.base, *bands])


def _bands(
    geo: GeoPyramid,
    levels: list[tuple[int, int]],
    columns: FloatArray,
    is_known: NDArray[np.bool_],
    progress: Progress | None,
) -> tuple[ChangeBand, ...]:
    spacings = level_spacings(geo.pyramid, progress)
    rows = [(None, spacings[0]), *(((a, b - 1), spacings[b]) for a, b in levels)]
    return tuple(
        ChangeBand(
            own,
            float(spacing),
            float(np.sqrt((column**2).mean())),
            float(column.min()),
            float(column.max()),
        )
        for (own, spacing), column in zip(rows, columns[is_known].T, strict=True)
    )
