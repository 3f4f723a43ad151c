"""The way back from a mesh to the very points, integer for integer, that it was made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import PyramidError
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.model.exact_restore import (
    CORRECTIONS,
    ExactColumn,
    KeptColumn,
    checksum,
    column_from_parts,
    kept_column,
    nearest_of_dtype,
    number_dtype,
    require_checksum,
)
from wavelet_gis.model.points.aside import Aside, MergedHeights
from wavelet_gis.model.points.cloud import PointAttribute, PointCloud

__all__ = ["CloudOrigin"]

_NO_SHIFTS = np.empty((0, 2), np.int64)
_NOTHING_ASIDE = Aside(np.empty(0, np.int64), ())


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
    corrections : tuple of KeptColumn or ExactColumn, or None
        What gives X, Y, Z and each attribute of the vertices back to the bit; None once the
        pyramid has been altered (filtered).
    checksum : str
        SHA-256 of the original columns.
    aside : Aside
        Points that are no part of the surface.
    duplicates : str
        The rule by which points that share x and y are merged.
    shifts : (n_shifted, 2) int64
        Vertices whose height is the mean of several points, and what the stored Z of their own
        point is above it.
    spacing : float or None
        Side of the square that one point has to itself, in the working frame; None in a pyramid
        of before this was stored.
    """

    cloud: PointCloud
    n_points: int
    dropped: NDArray[np.int64]
    representative: NDArray[np.int64]
    differences: NDArray[np.int64]
    dropped_attributes: tuple[NDArray[Any], ...]
    corrections: tuple[KeptColumn | ExactColumn, ...] | None
    checksum: str
    aside: Aside = _NOTHING_ASIDE
    duplicates: str = "lowest"
    shifts: NDArray[np.int64] = field(default_factory=_NO_SHIFTS.copy)
    spacing: float | None = None

    kind = "points"
    noun = "point cloud"
    grid = None

    @classmethod
    def from_cloud(
        cls,
        cloud: PointCloud,
        kept: NDArray[np.int64],
        representative: NDArray[np.int64],
        z_of_vertices: NDArray[np.int64] | None = None,
        duplicates: str = "lowest",
    ) -> CloudOrigin:
        """Return the origin of a cloud, before there is a pyramid (and so without corrections).

        Parameters
        ----------
        cloud : PointCloud
            All points.
        kept, representative
            Of the points that are part of the surface, as
            `wavelet_core.mesh.triangulation.merge_duplicates` returns them.
        z_of_vertices : (n_kept,) int64, optional
            Stored Z of the vertices, where it is not that of the points kept.
        duplicates : str
            The rule by which points were merged.
        """
        aside = Aside.of_cloud(cloud)
        used = np.delete(np.arange(cloud.n_points), aside.rows)
        is_dropped = np.ones(len(used), dtype=bool)
        is_dropped[kept] = False
        dropped, vertex, kept_rows = used[is_dropped], representative[is_dropped], used[kept]
        of_vertices = cloud.integers[kept_rows].astype(np.int64)
        shift = np.zeros(len(kept), np.int64)
        if z_of_vertices is not None:
            shift = of_vertices[:, 2] - z_of_vertices
            of_vertices[:, 2] = z_of_vertices
        shifted = np.flatnonzero(shift)
        return cls(
            cloud=_emptied(cloud),
            n_points=cloud.n_points,
            dropped=dropped,
            representative=vertex,
            differences=cloud.integers[dropped].astype(np.int64) - of_vertices[vertex],
            dropped_attributes=tuple(a.values[dropped] for a in cloud.attributes),
            corrections=None,
            checksum=checksum(cloud.columns()),
            aside=aside,
            duplicates=duplicates,
            shifts=np.column_stack([shifted, shift[shifted]]).astype(np.int64),
        )

    def with_corrections(
        self, cloud: PointCloud, mesh: TriangleMesh, frame: LocalFrame
    ) -> CloudOrigin:
        """Return the origin that gives `cloud` back exactly from the synthesised `mesh`."""
        kept = self.vertex_rows()
        originals = [column[kept] for column in cloud.columns()]
        originals[2][self.shifts[:, 0]] -= self.shifts[:, 1].astype(np.int32)
        columns = tuple(
            kept_column(original, approximate)
            for original, approximate in zip(originals, self._approximate(mesh, frame), strict=True)
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
        return self.n_points - len(self.dropped) - len(self.aside.rows)

    def vertex_rows(self) -> NDArray[np.int64]:
        """Return the row in the file of the point that each vertex is."""
        is_vertex = np.ones(self.n_points, dtype=bool)
        is_vertex[self.dropped] = False
        is_vertex[self.aside.rows] = False
        return np.flatnonzero(is_vertex)

    def merged_heights(self) -> MergedHeights:
        """Return how far merged points are from the vertices that stand for them."""
        apart = np.concatenate([self.differences[:, 2], self.shifts[:, 1]]).astype(np.float64)
        apart *= abs(float(self.cloud.scales[2]))
        return MergedHeights(
            rule=self.duplicates,
            n_points=len(self.dropped),
            largest=float(np.abs(apart).max(initial=0.0)),
            rms=float(np.sqrt(np.mean(apart**2))) if len(apart) else 0.0,
        )

    def points_for_errors(self, mesh: TriangleMesh, frame: LocalFrame) -> NDArray[np.float64]:
        """Return every input point of the surface in the working frame, merged ones too.

        Parameters
        ----------
        mesh : TriangleMesh
            The finest one, whose vertices are the points that stand for others.
        frame : LocalFrame
            The working frame.

        Returns
        -------
        (n, 3) float64
            The points of the vertices first, in their order, then the merged ones. An error "at
            all input points" is one at these.
        """
        unit = float(self.cloud.scales[2]) * frame.z_scale
        of_vertices = mesh.vertices.copy()
        merged = mesh.vertices[self.representative]
        of_vertices[self.shifts[:, 0], 2] += self.shifts[:, 1] * unit
        merged[:, 2] += self.differences[:, 2] * unit
        return np.concatenate([of_vertices, merged])

    @property
    def kept_places(self) -> NDArray[np.int64] | None:
        """X and Y of the vertices as stored, ``(n_vertices, 2)``; None where they are not kept."""
        kept = [column.values for column in self.corrections or () if hasattr(column, "values")]
        if len(kept) < 2 or len({len(values) for values in kept[:2]}) > 1:
            return None
        return np.column_stack(kept[:2]).astype(np.int64)

    def kept_mesh(
        self, frame: LocalFrame, faces: NDArray[np.int32] | None = None
    ) -> TriangleMesh | None:
        """Return the mesh that was analysed, to the bit; None where it is not kept.

        Parameters
        ----------
        frame : LocalFrame
        faces : (n_faces, 3) int32
            Of the mesh; they do not follow from the points alone.
        """
        kept = self.corrections
        if faces is None or kept is None:
            return None
        columns = [column.values for column in kept if isinstance(column, KeptColumn)]
        if len(columns) < len(kept):
            return None
        if any(len(values) != self.n_vertices for values in columns):
            raise PyramidError(
                "the cloud's points do not match their numbers; analyse the input anew."
            )
        vertices = np.column_stack(columns[:3]) * self.cloud.scales + self.cloud.offsets
        attributes = np.empty((self.n_vertices, len(columns) - 3))
        for k, attribute in enumerate(self.cloud.attributes):
            attributes[:, k] = replace(attribute, values=columns[3 + k]).lifted()
        names = tuple(attribute.name for attribute in self.cloud.attributes)
        return TriangleMesh(frame.to_local(vertices), faces, attributes, names)

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
        kept = self.vertex_rows()
        columns = [
            self._full_column(k, approximate, kept)
            for k, approximate in enumerate(self._approximate(mesh, frame))
        ]
        attributes = tuple(
            replace(attribute, values=column)
            for attribute, column in zip(self.cloud.attributes, columns[3:], strict=True)
        )
        cloud = replace(
            self.cloud,
            integers=np.column_stack(columns[:3]),
            attributes=attributes,
            is_altered=not self.is_exact,
        )
        if self.is_exact:
            require_checksum(cloud.columns(), self.checksum)
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
        if len(self.aside.rows):
            column[self.aside.rows] = self.aside.columns[k]
        if k >= 3:
            column[self.dropped] = self.dropped_attributes[k - 3]
            return column
        vertices = of_vertices.astype(np.int64)
        column[self.dropped] = _int32(vertices[self.representative] + self.differences[:, k])
        if k == 2:
            shifted, shift = self.shifts.T
            column[kept[shifted]] = _int32(vertices[shifted] + shift)
        return column

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
            "duplicates": self.duplicates,
            "spacing": self.spacing,
            "evlrs_at": cloud.evlrs_at,
        }
        arrays: dict[str, NDArray[Any]] = {
            "source/dropped": self.dropped,
            "source/representative": self.representative,
            "source/differences": self.differences,
            "source/header": cloud.header,
            "source/evlrs": cloud.evlrs,
            **self.aside.to_arrays(),
        }
        if len(self.shifts):
            arrays["source/shifts"] = self.shifts
        for k, values in enumerate(self.dropped_attributes):
            arrays[f"source/dropped_attribute_{k}"] = values
        for k, values in enumerate(cloud.carried.values()):
            arrays[f"source/carried_{k}"] = values
        if self.corrections is not None:
            fields[CORRECTIONS] = []
            for k, column in enumerate(self.corrections):
                column_fields, column_arrays = column.to_parts(f"source/{CORRECTIONS}_{k}")
                fields[CORRECTIONS].append(column_fields)
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
            evlrs_at=None if fields.get("evlrs_at") is None else stored.integer("evlrs_at"),
        )
        corrections = None
        if CORRECTIONS in stored:
            corrections = tuple(
                column_from_parts(f"source/{CORRECTIONS}_{k}", column, arrays)
                for k, column in enumerate(stored.objects(CORRECTIONS))
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
            aside=Aside.from_arrays(arrays, attributes, n_points),
            duplicates=stored.text("duplicates", 20) if "duplicates" in stored else "lowest",
            shifts=arrays.get("source/shifts", _NO_SHIFTS),
            spacing=None if fields.get("spacing") is None else stored.number("spacing"),
        )
        origin._check()
        return origin

    def _check(self) -> None:
        cloud, n_dropped = self.cloud, len(self.dropped)
        n_columns = 3 + len(cloud.attributes)
        _require(self.n_vertices >= 0, "more points dropped than there are")
        _require(self.shifts.ndim == 2 and self.shifts.shape[1] == 2, "shifts")
        _require(self.shifts.dtype == np.int64, "shifts")
        shifted = self.shifts[:, 0]
        _require(bool(((shifted >= 0) & (shifted < self.n_vertices)).all()), "shifts")
        _require(not np.isin(self.aside.rows, self.dropped).any(), "a point dropped twice")
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


def _int32(values: NDArray[np.int64]) -> NDArray[np.int32]:
    limits = np.iinfo(np.int32)
    return np.clip(values, limits.min, limits.max).astype(np.int32)


def _emptied(cloud: PointCloud) -> PointCloud:
    return replace(
        cloud,
        aside=None,
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
