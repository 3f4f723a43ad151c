"""Points to mesh, and the mesh back to the very integers that came in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import PyramidError
from wavelet_core.mesh.triangulation import delaunay_faces, merge_duplicates
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.cloud import PointAttribute, PointCloud
from wavelet_gis.model.exact_restore import (
    ExactColumn,
    checksum,
    exact_column,
    nearest_of_dtype,
    number_dtype,
)

__all__ = ["CloudOrigin", "cloud_mesh"]


@dataclass(frozen=True, slots=True)
class CloudOrigin:
    """How a pyramid's finest mesh becomes the points it was made from.

    Attributes
    ----------
    cloud : PointCloud
        The points without their coordinates and attribute values, which the pyramid holds:
        `integers` and the attributes' `values` are empty.
    n_points : int
        Points in the reconstruction.
    dropped : (n_dropped,) int64
        Rows of the points that share x and y with another and so are no vertex.
    representative : (n_dropped,) int64
        The vertex that stands for each.
    differences : (n_dropped, 3) int64
        X, Y, Z of each, less those of its vertex.
    dropped_attributes : tuple of (n_dropped,) arrays
        Their attributes as stored.
    corrections : tuple of ExactColumn, or None
        What rounding loses, for X, Y, Z and each attribute; None once the pyramid has been
        altered (filtered).
    checksum : str
        SHA-256 of the original columns.
    """

    cloud: PointCloud
    n_points: int
    dropped: NDArray[np.int64]
    representative: NDArray[np.int64]
    differences: NDArray[np.int64]
    dropped_attributes: tuple[NDArray[Any], ...]
    corrections: tuple[ExactColumn, ...] | None
    checksum: str

    kind = "points"
    noun = "point cloud"
    grid = None

    @classmethod
    def from_cloud(
        cls,
        cloud: PointCloud,
        kept: NDArray[np.int64],
        representative: NDArray[np.int64],
    ) -> CloudOrigin:
        """Return the origin of a cloud, before there is a pyramid (and so without corrections).

        Parameters
        ----------
        cloud : PointCloud
            All points.
        kept, representative
            As `wavelet_core.mesh.triangulation.merge_duplicates` returns them.
        """
        is_dropped = np.ones(cloud.n_points, dtype=bool)
        is_dropped[kept] = False
        dropped = np.flatnonzero(is_dropped)
        vertex = representative[dropped]
        differences = cloud.integers[dropped].astype(np.int64) - cloud.integers[kept[vertex]]
        return cls(
            cloud=_emptied(cloud),
            n_points=cloud.n_points,
            dropped=dropped,
            representative=vertex,
            differences=differences,
            dropped_attributes=tuple(a.values[dropped] for a in cloud.attributes),
            corrections=None,
            checksum=checksum(cloud.columns()),
        )

    def with_corrections(
        self, cloud: PointCloud, mesh: TriangleMesh, frame: LocalFrame
    ) -> CloudOrigin:
        """Return the origin that gives `cloud` back exactly from the synthesised `mesh`."""
        kept = self._kept()
        columns = tuple(
            exact_column(original[kept], approximate)
            for original, approximate in zip(
                cloud.columns(), self._approximate(mesh, frame), strict=True
            )
        )
        return replace(self, corrections=columns)

    def altered(self) -> CloudOrigin:
        """Return the origin for a pyramid whose coefficients have been changed."""
        return replace(self, corrections=None)

    @property
    def is_exact(self) -> bool:
        """Whether the original comes back bit for bit."""
        return self.corrections is not None

    @property
    def points(self) -> CloudOrigin:
        """The points themselves."""
        return self

    @property
    def n_vertices(self) -> int:
        """Number of points that are vertices."""
        return self.n_points - len(self.dropped)

    def restore(self, mesh: TriangleMesh, frame: LocalFrame) -> PointCloud:
        """Return the points of the finest mesh of a pyramid, in their first order.

        Raises
        ------
        PyramidError
            When the mesh does not have the vertices of the origin, or the exact original was
            due and the result's checksum is another.
        """
        if mesh.n_vertices != self.n_vertices or mesh.attributes.shape[1] != len(
            self.cloud.attributes
        ):
            raise PyramidError(
                f"the mesh has {mesh.n_vertices} vertices and {mesh.attributes.shape[1]} "
                f"attributes for {self.n_vertices} points with {len(self.cloud.attributes)}; "
                "only the finest level can be turned back into the points."
            )
        kept = self._kept()
        columns = [
            self._full_column(k, approximate, kept)
            for k, approximate in enumerate(self._approximate(mesh, frame))
        ]
        attributes = tuple(
            replace(attribute, values=column)
            for attribute, column in zip(self.cloud.attributes, columns[3:], strict=True)
        )
        cloud = replace(self.cloud, integers=np.column_stack(columns[:3]), attributes=attributes)
        if self.is_exact and checksum(cloud.columns()) != self.checksum:
            raise PyramidError(
                "the reconstruction is not exactly the original (its checksum differs); "
                "the file is damaged, analyse the input anew."
            )
        return cloud

    def _full_column(
        self, k: int, approximate: NDArray[np.float64], kept: NDArray[np.int64]
    ) -> NDArray[Any]:
        """One column for all points: corrected vertices first, then what they stand for."""
        dtype = np.dtype(np.int32) if k < 3 else self.cloud.attributes[k - 3].values.dtype
        if self.corrections is None:
            of_vertices = nearest_of_dtype(approximate, dtype)
        else:
            of_vertices = self.corrections[k].restore(approximate)
        column = np.empty(self.n_points, dtype=dtype)
        column[kept] = of_vertices
        if k < 3:
            moved = of_vertices[self.representative].astype(np.int64) + self.differences[:, k]
            limits = np.iinfo(dtype)
            column[self.dropped] = np.clip(moved, limits.min, limits.max).astype(dtype)
        else:
            column[self.dropped] = self.dropped_attributes[k - 3]
        return column

    def _kept(self) -> NDArray[np.int64]:
        is_kept = np.ones(self.n_points, dtype=bool)
        is_kept[self.dropped] = False
        return np.flatnonzero(is_kept)

    def _approximate(self, mesh: TriangleMesh, frame: LocalFrame) -> Iterator[NDArray[np.float64]]:
        """Yield the columns of the mesh in the units that the file stores."""
        x, y, z = mesh.vertices.T
        in_file = (frame.file_x(x), frame.file_y(y), frame.file_z(z))
        for k, values in enumerate(in_file):
            yield (values - self.cloud.offsets[k]) / self.cloud.scales[k]
        for k, attribute in enumerate(self.cloud.attributes):
            yield (mesh.attributes[:, k] - attribute.offset) / attribute.scale

    def to_parts(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return JSON-able fields, and arrays by name."""
        cloud = self.cloud
        described = [
            {
                "name": a.name,
                "dimension": a.dimension,
                "component": a.component,
                "scale": a.scale,
                "offset": a.offset,
                "dtype": a.values.dtype.newbyteorder("<").str,
            }
            for a in cloud.attributes
        ]
        fields: dict[str, Any] = {
            "kind": self.kind,
            "n_points": self.n_points,
            "n_in_file": cloud.n_in_file,
            "classes": None if cloud.classes is None else list(cloud.classes),
            "scales": cloud.scales.tolist(),
            "offsets": cloud.offsets.tolist(),
            "attributes": described,
            "carried": list(cloud.carried),
            "checksum": self.checksum,
        }
        arrays: dict[str, NDArray[Any]] = {
            "source/dropped": self.dropped,
            "source/representative": self.representative,
            "source/differences": self.differences,
            "source/header": cloud.header,
            "source/evlrs": cloud.evlrs,
        }
        for k, values in enumerate(self.dropped_attributes):
            arrays[f"source/dropped_attribute_{k}"] = values
        for k, values in enumerate(cloud.carried.values()):
            arrays[f"source/carried_{k}"] = values
        if self.corrections is not None:
            fields["ledger"] = []
            for k, column in enumerate(self.corrections):
                column_fields, column_arrays = column.to_parts(f"source/ledger_{k}")
                fields["ledger"].append(column_fields)
                arrays.update(column_arrays)
        return fields, arrays

    @classmethod
    def from_parts(cls, fields: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> CloudOrigin:
        """Return the origin that `to_parts` described, every claim checked.

        Raises
        ------
        PyramidError
            When a part is missing, of another type, or does not fit the rest.
        """
        try:
            return cls._from_parts(fields, arrays)
        except PyramidError:
            raise
        except (KeyError, TypeError, ValueError) as error:
            raise PyramidError(
                f"the description of the points is damaged ({error}); analyse the input anew."
            ) from error

    @classmethod
    def _from_parts(cls, fields: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> CloudOrigin:
        stored = Fields(fields, "the points")
        n_points = stored.integer("n_points")
        attributes = tuple(_attribute(described) for described in stored.objects("attributes"))
        cloud = PointCloud(
            integers=np.empty((0, 3), np.int32),
            scales=np.array(stored.numbers("scales", 3)),
            offsets=np.array(stored.numbers("offsets", 3)),
            attributes=attributes,
            carried={
                name: arrays[f"source/carried_{k}"]
                for k, name in enumerate(stored.texts("carried"))
            },
            header=arrays["source/header"],
            evlrs=arrays["source/evlrs"],
            n_in_file=stored.integer("n_in_file"),
            classes=None if stored["classes"] is None else tuple(stored.integers("classes")),
        )
        corrections = None
        if "ledger" in stored:
            corrections = tuple(
                ExactColumn.from_parts(f"source/ledger_{k}", column, arrays)
                for k, column in enumerate(stored.objects("ledger"))
            )
        origin = cls(
            cloud=cloud,
            n_points=n_points,
            dropped=arrays["source/dropped"],
            representative=arrays["source/representative"],
            differences=arrays["source/differences"],
            dropped_attributes=tuple(
                arrays[f"source/dropped_attribute_{k}"] for k in range(len(attributes))
            ),
            corrections=corrections,
            checksum=stored.text("checksum", 200),
        )
        origin._check()
        return origin

    def _check(self) -> None:
        cloud, n_dropped = self.cloud, len(self.dropped)
        n_columns = 3 + len(cloud.attributes)
        _require(self.n_points >= n_dropped, "more points dropped than there are")
        for numbers in (cloud.scales, cloud.offsets):
            _require(numbers.shape == (3,) and bool(np.isfinite(numbers).all()), "scales")
        _require(bool((cloud.scales != 0).all()), "a scale of zero")
        for rows, limit in ((self.dropped, self.n_points), (self.representative, self.n_vertices)):
            _require(rows.shape == (n_dropped,) and rows.dtype == np.int64, "dropped points")
            _require(
                n_dropped == 0 or bool(rows.min() >= 0 and rows.max() < limit), "a row out of range"
            )
        _require(bool((np.diff(self.dropped) > 0).all()), "dropped points out of order")
        _require(
            self.differences.shape == (n_dropped, 3) and self.differences.dtype == np.int64,
            "differences",
        )
        for attribute, values in zip(cloud.attributes, self.dropped_attributes, strict=True):
            _require(
                values.shape == (n_dropped,) and values.dtype == attribute.values.dtype,
                f"attribute {attribute.name}",
            )
        for name, values in cloud.carried.items():
            _require(len(values) == self.n_points, f"dimension {name}")
        for block in (cloud.header, cloud.evlrs):
            _require(block.ndim == 1 and block.dtype == np.uint8, "header")
        if self.corrections is not None:
            dtypes = [np.dtype(np.int32)] * 3 + [a.values.dtype for a in cloud.attributes]
            _require(len(self.corrections) == n_columns, "corrections")
            _require(
                [column.dtype for column in self.corrections] == dtypes,
                "data types of the corrections",
            )


def cloud_mesh(cloud: PointCloud, frame: LocalFrame) -> tuple[TriangleMesh, CloudOrigin]:
    """Return the Delaunay TIN of the points in the working frame, and how to come back from it.

    Parameters
    ----------
    cloud : PointCloud
        In the file's coordinates.
    frame : LocalFrame
        From `wavelet_gis.crs.frame.working_frame`.

    Raises
    ------
    InputFileError
        When a coordinate or an attribute is not finite.
    MeshError
        When there are fewer than three points, or all lie on one line.
    """
    vertices = frame.to_local(cloud.coordinates())
    if not np.isfinite(vertices).all():
        raise InputFileError(
            "the cloud has coordinates that are no finite numbers; check the scales and offsets "
            "in its header."
        )
    merged = merge_duplicates(vertices)
    origin = CloudOrigin.from_cloud(cloud, merged.kept, merged.representative)
    kept = merged.kept
    attributes = np.empty((len(kept), len(cloud.attributes)))
    for k, attribute in enumerate(cloud.attributes):
        attributes[:, k] = attribute.lifted()[kept]
        if not np.isfinite(attributes[:, k]).all():
            raise InputFileError(
                "attribute {attribute} has values that are no finite numbers; leave it out of {0}.",
                "attributes",
                attribute=attribute.name,
            )
    names = tuple(attribute.name for attribute in cloud.attributes)
    vertices = vertices[kept]
    faces = delaunay_faces(vertices[:, :2])
    return TriangleMesh(vertices, faces, attributes, names), origin


def _emptied(cloud: PointCloud) -> PointCloud:
    return replace(
        cloud,
        integers=np.empty((0, 3), np.int32),
        attributes=tuple(
            replace(a, values=np.empty(0, a.values.dtype.newbyteorder("<")))
            for a in cloud.attributes
        ),
    )


def _attribute(described: Fields) -> PointAttribute:
    dtype = number_dtype(described.text("dtype"))
    scale, offset = described.number("scale"), described.number("offset")
    if scale == 0:
        raise ValueError("an attribute with a scale of zero")
    return PointAttribute(
        name=described.text("name"),
        dimension=described.text("dimension"),
        values=np.empty(0, dtype),
        component=None if described["component"] is None else described.integer("component"),
        scale=scale,
        offset=offset,
    )


def _require(holds: bool, what: str) -> None:
    if not holds:
        raise PyramidError(
            f"the description of the points is damaged ({what}); analyse the input anew."
        )
