"""The origin of a pyramid that was made from a TIN: its finest mesh is all there is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_gis.crs.frame import LocalFrame

__all__ = ["MeshOrigin", "mesh_in_file"]


@dataclass(frozen=True, slots=True)
class MeshOrigin:
    """How a pyramid's finest mesh becomes the TIN it was made from: it is that TIN."""

    kind = "tin"
    noun = "TIN"
    is_exact = False
    grid = None
    points = None
    n_vertices = None

    def with_corrections(
        self, original: TriangleMesh, mesh: TriangleMesh, frame: LocalFrame
    ) -> MeshOrigin:
        """Return the origin as it is: there is nothing to correct."""
        return self

    def altered(self) -> MeshOrigin:
        """Return the origin for a pyramid whose coefficients have been changed."""
        return self

    def kept_mesh(
        self, frame: LocalFrame, faces: NDArray[Any] | None = None
    ) -> TriangleMesh | None:
        """Return None: the input is not kept beside the pyramid."""
        return None

    def restore(self, mesh: TriangleMesh, frame: LocalFrame) -> TriangleMesh:
        """Return the finest mesh of a pyramid in the coordinates of the input."""
        return mesh_in_file(mesh, frame)

    def to_parts(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return JSON-able fields, and arrays by name."""
        return {"kind": self.kind}, {}

    @classmethod
    def from_parts(cls, fields: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> MeshOrigin:
        """Return the origin that `to_parts` described."""
        return cls()


def mesh_in_file(mesh: TriangleMesh, frame: LocalFrame) -> TriangleMesh:
    """Return a mesh of the working frame in the coordinates of the file.

    Parameters
    ----------
    mesh : TriangleMesh
        In the working frame.
    frame : LocalFrame
        Between the two.
    """
    if frame.is_identity:
        return mesh
    return TriangleMesh(
        frame.to_file(mesh.vertices), mesh.faces, mesh.attributes, mesh.attribute_names
    )
