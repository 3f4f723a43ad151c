"""Pyramid to what it was made from, bit for bit; of a filtered one, its filtered form."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from wavelet_core import TriangleMesh
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.atomic import check_output
from wavelet_gis.io.formats import (
    CLOUD_SUFFIXES,
    MESH_SUFFIXES,
    PYRAMID_SUFFIX,
    any_of,
    suffix_of,
)
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import Original
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of
from wavelet_gis.workflows.save import write_tin

__all__ = ["Reconstruction", "check_restored_output", "reconstruct", "reconstruct_file"]

Path = str | os.PathLike[str]


@dataclass(frozen=True, slots=True)
class Reconstruction:
    """What a pyramid was made from.

    Attributes
    ----------
    geo : GeoPyramid
        The pyramid.
    finest : TriangleMesh
        Its finest mesh, in the working frame.
    original : Dem, PointCloud or TriangleMesh
        In the coordinates of the input.
    """

    geo: GeoPyramid
    finest: TriangleMesh
    original: Original

    @property
    def is_exact(self) -> bool:
        """Whether this is the original to the last bit, checksum verified."""
        return self.geo.origin.is_exact

    @property
    def size(self) -> str:
        """How much it is, for people."""
        return _ROWS[self.geo.origin.kind].size(self.original)

    def write(self, path: Path) -> None:
        """Write it; see `wavelet_gis.workflows.save.save`."""
        check_restored_output(path, self.geo.origin.kind, overwrite=True)
        _ROWS[self.geo.origin.kind].write(path, self)

    def figures(self) -> dict[str, Any]:
        """Return what it is as JSON-able values."""
        return {"kind": self.geo.origin.kind, "is_exact": self.is_exact, "size": self.size}


def reconstruct(
    data: HoldsPyramid | GeoPyramid, *, finest: TriangleMesh | None = None
) -> Reconstruction:
    """Return what a pyramid was made from.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    finest : TriangleMesh, optional
        Its finest mesh, where it has been synthesised already.

    Raises
    ------
    PyramidError
        When the exact original was due and did not come out.
    """
    geo = pyramid_of(data)
    mesh = geo.pyramid.synthesise() if finest is None else finest
    return Reconstruction(geo, mesh, geo.restore(mesh))


def reconstruct_file(path: Path) -> Reconstruction:
    """Return what the pyramid in a file was made from, without its levels where that can be.

    Parameters
    ----------
    path : path
        A pyramid file.

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    PyramidError
        When its parts are damaged, or the exact original was due and did not come out.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_input

    return reconstruct(read_input(path))


def check_restored_output(
    path: Path,
    kind: str,
    *,
    or_pyramid: bool = False,
    overwrite: bool = False,
    inputs: tuple[Path, ...] = (),
) -> None:
    """Refuse, before the long work, an output of another kind than the input was.

    Parameters
    ----------
    path : path
        Where the reconstruction is wanted.
    kind : str
        Of the pyramid's origin.
    or_pyramid : bool
        Whether a pyramid file will do as well.
    overwrite, inputs
        See `wavelet_gis.io.atomic.check_output`.

    Raises
    ------
    OutputFileError
        A suffix that does not fit, or what `wavelet_gis.io.atomic.check_output` refuses.
    """
    check_output(path, overwrite=overwrite, inputs=inputs)
    row, suffix = _ROWS[kind], suffix_of(path)
    if row.fits(suffix) or (or_pyramid and suffix == PYRAMID_SUFFIX):
        return
    pyramid = f" or, for a pyramid, {PYRAMID_SUFFIX}" if or_pyramid else ""
    raise OutputFileError(
        f"{path}: the pyramid was made from {row.what}; give an output ending in "
        f"{row.suffixes}{pyramid}."
    )


class _Row(NamedTuple):
    """How one kind of origin is written.

    what : str, with its article
    suffixes : str, those that it may have, for people
    fits : callable, whether a suffix may be used
    write : callable of path and Reconstruction
    size : callable, how much it is, for people
    """

    what: str
    suffixes: str
    fits: Callable[[str], bool]
    write: Callable[[Path, Reconstruction], None]
    size: Callable[[Any], str]


def _is_raster_suffix(suffix: str) -> bool:
    """Whether GDAL may be asked: it writes many formats, by more suffixes than we could list."""
    return suffix not in (*CLOUD_SUFFIXES, *MESH_SUFFIXES, PYRAMID_SUFFIX, "")


def _write_raster(path: Path, restored: Reconstruction) -> None:
    from wavelet_gis.io.raster import write_dem

    write_dem(path, restored.original, restored.geo.system.wkt)  # type: ignore[arg-type]


def _write_points(path: Path, restored: Reconstruction) -> None:
    from wavelet_gis.io.las import write_cloud

    write_cloud(path, restored.original)  # type: ignore[arg-type]


def _write_mesh(path: Path, restored: Reconstruction) -> None:
    pyramid = restored.geo.pyramid
    level = pyramid.n_levels
    ids = pyramid.vertex_ids(level)
    write_tin(path, restored.geo, restored.finest, ids, f"level_{level:02d}")


def _cells(dem: Dem) -> str:
    return f"{dem.geometry.shape[0]} x {dem.geometry.shape[1]} cells"


def _points(cloud: PointCloud) -> str:
    return f"{cloud.n_points:,} points"


def _triangles(mesh: TriangleMesh) -> str:
    return f"{mesh.n_faces:,} triangles"


#: By the kind of the origin.
_ROWS = {
    "raster": _Row("a raster", ".tif", _is_raster_suffix, _write_raster, _cells),
    "points": _Row(
        "a point cloud",
        any_of(CLOUD_SUFFIXES),
        CLOUD_SUFFIXES.__contains__,
        _write_points,
        _points,
    ),
    "tin": _Row(
        "a TIN",
        any_of((PYRAMID_SUFFIX, *MESH_SUFFIXES)),
        (PYRAMID_SUFFIX, *MESH_SUFFIXES).__contains__,
        _write_mesh,
        _triangles,
    ),
}
