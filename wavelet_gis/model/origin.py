"""What a pyramid was made from, and how its finest mesh becomes that again.

A raster, a point cloud and a TIN answer the same few questions, so that nobody has to ask which of
them it is. Another kind of input is a class that answers them, and one row in `ORIGINS`.
"""

from __future__ import annotations

from typing import Any, Protocol

from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import PyramidError
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.model.dem import Dem, InputGrid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.points.origin import CloudOrigin
from wavelet_gis.model.raster_origin import RasterOrigin

__all__ = ["ORIGINS", "Origin", "Original", "origin_from_parts"]

#: What came in.
Original = Dem | PointCloud | TriangleMesh


class Origin(Protocol):
    """The origin of a pyramid."""

    @property
    def kind(self) -> str:
        """Its name in files and figures: ``raster``, ``points`` or ``tin``."""

    @property
    def noun(self) -> str:
        """What people call it, without an article."""

    @property
    def is_exact(self) -> bool:
        """Whether `restore` gives what came in, to the last bit."""

    @property
    def n_vertices(self) -> int | None:
        """Vertices that the finest mesh must have; None for any number."""

    @property
    def grid(self) -> InputGrid | None:
        """The raster's grid, each of whose cells with data is a vertex; None without one."""

    @property
    def points(self) -> CloudOrigin | None:
        """The points, where there are some; None for a raster or a TIN."""

    def with_corrections(self, original: Any, mesh: TriangleMesh, frame: LocalFrame) -> Origin:
        """Return the origin that gives ``original`` back exactly from the synthesised ``mesh``."""

    def altered(self) -> Origin:
        """Return the origin for a pyramid whose coefficients have been changed."""

    def kept_mesh(
        self, frame: LocalFrame, faces: NDArray[Any] | None = None
    ) -> TriangleMesh | None:
        """Return the mesh that was analysed, to the bit; None where it is not kept.

        Parameters
        ----------
        frame : LocalFrame
        faces : (n_faces, 3) int32, optional
            Of the mesh; those of a raster follow from its cells.
        """

    def restore(self, mesh: TriangleMesh, frame: LocalFrame) -> Original:
        """Return what came in, from the finest mesh of the pyramid.

        Raises
        ------
        PyramidError
            When the mesh is not the finest one, or the exact original was due and did not come
            out.
        """

    def to_parts(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return JSON-able fields, and arrays by name."""


#: The origins by their kind.
ORIGINS: dict[str, Any] = {
    origin.kind: origin for origin in (RasterOrigin, CloudOrigin, MeshOrigin)
}


def origin_from_parts(fields: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> Origin:
    """Return the origin that its ``to_parts`` described, every claim checked.

    Parameters
    ----------
    fields : dict
        JSON-able.
    arrays : dict of str to ndarray
        By the names that ``to_parts`` gave them.

    Raises
    ------
    PyramidError
        When the kind is none of ours, or a part does not fit the rest.
    """
    kind = fields["kind"]
    if not isinstance(kind, str) or kind not in ORIGINS:
        raise PyramidError(f"the file claims a source of kind {kind!r}; analyse the input anew.")
    origin: Origin = ORIGINS[kind].from_parts(fields, arrays)
    return origin
