"""LAS, LAZ and COPC files in and out, through laspy and lazrs."""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import MissingDependencyError
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.crs.las import las_crs
from wavelet_gis.errors import InputFileError, OutputFileError, PointCloudWarning
from wavelet_gis.model.categories import channel_category
from wavelet_gis.model.cloud import PointAttribute, PointCloud
from wavelet_gis.model.ground import GROUND_CLASS, height_above_ground

if TYPE_CHECKING:
    from laspy import LasHeader
    from laspy.point.record import PackedPointRecord

__all__ = ["ALIASES", "read_cloud", "write_cloud"]

#: Name of the attribute that is computed rather than read.
HEIGHT_ABOVE_GROUND = "hag"

#: What people call dimensions, beside the names that laspy gives them.
ALIASES: dict[str, tuple[str, ...]] = {
    "class": ("classification",),
    "rgb": ("red", "green", "blue"),
    "returns": ("return_number", "number_of_returns"),
}

#: Owners of VLRs on how points are compressed or arranged, wrong in any file written anew.
_STALE_OWNERS = ("laszip encoded", "copc")

#: Point formats with references to waveform packets.
_WAVEFORM_FORMATS = (4, 5, 9, 10)

#: Offset in the header of the day and year of creation.
_CREATION_DATE = slice(90, 94)


def read_cloud(
    path: str | os.PathLike[str],
    *,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    carry: bool = True,
) -> tuple[PointCloud, Georeference]:
    """Return the chosen points of a LAS or LAZ file, and what it tells of their coordinates.

    Parameters
    ----------
    path : path
        LAS 1.0 to 1.4, LAZ or COPC.
    attributes : sequence of str
        Dimensions to lift along: any that the file has, ``rgb`` for the three colours, ``hag``
        for the height above the ground (class 2). An array-valued dimension gives one attribute
        for each component.
    classes : sequence of int, optional
        Only points of these classes; the ground for ``hag`` is that of the whole file.
    carry : bool
        Keep the other dimensions too, to be given back untouched.

    Raises
    ------
    InputFileError
        When the file is missing, no LAS file, damaged, empty, or lacks what was asked for.
    MissingDependencyError
        When laspy, or lazrs for a LAZ file, is not installed.
    """
    name = os.fspath(path)
    if os.path.isdir(name):
        raise InputFileError(f"{name}: this is a folder; name the LAS or LAZ file in it.")
    if not os.path.exists(name):
        raise InputFileError(f"{name}: there is no such file; check the path.")
    header, points, header_bytes = _read_all(name)
    array = points.array
    if len(array) == 0:
        raise InputFileError(
            f"{name}: the file holds no points"
            + (f" although its header announces {header.point_count}" if header.point_count else "")
            + "; get it again."
        )
    if len(array) < header.point_count:
        warnings.warn(
            f"{name}: the header announces {header.point_count} points, the file ends after "
            f"{len(array)}; those are used",
            PointCloudWarning,
            stacklevel=2,
        )
    _check_scaling(name, header)
    lifted = [
        attribute
        for wanted in dict.fromkeys(attributes)
        for attribute in _attributes(name, wanted, points, header)
    ]
    _check_names(name, lifted)
    chosen = _chosen(name, points, classes)
    integers = np.empty((np.count_nonzero(chosen) if chosen is not None else len(array), 3), "i4")
    for k, axis in enumerate("XYZ"):
        integers[:, k] = _select(array[axis], chosen)
    cloud = PointCloud(
        integers=integers,
        scales=np.array(header.scales, dtype=np.float64),
        offsets=np.array(header.offsets, dtype=np.float64),
        attributes=tuple(_with_values(a, _select(a.values, chosen)) for a in lifted),
        carried=_carried(points, lifted, chosen) if carry else {},
        header=np.frombuffer(header_bytes, np.uint8),
        evlrs=_evlr_bytes(name, header),
        n_in_file=len(array),
        classes=None if classes is None else tuple(int(c) for c in classes),
    )
    _tell_of_waveforms(name, header)
    return cloud, las_crs(header)


def write_cloud(path: str | os.PathLike[str], cloud: PointCloud) -> None:
    """Write the points with the header, VLRs and dimensions they came with.

    Parameters
    ----------
    path : path
        ``.laz`` is compressed, anything else is not.
    cloud : PointCloud
        What to write.

    Raises
    ------
    OutputFileError
        When laspy cannot write this version or point format.
    """
    laspy = _laspy()
    header = _header_from(laspy, cloud.header)
    stored_date = bytes(cloud.header[_CREATION_DATE])
    # Taken out one by one: setting the list anew would make laspy rewrite the other records.
    for stale in [v for v in header.vlrs if v.user_id in _STALE_OWNERS]:
        header.vlrs.remove(stale)
    computed = [a for a in cloud.attributes if a.dimension == HEIGHT_ABOVE_GROUND]
    for attribute in computed:
        if attribute.name not in header.point_format.dimension_names:
            header.add_extra_dim(
                laspy.ExtraBytesParams(attribute.name, "f4", description="Height above ground")
            )
    if header.version.minor == 0:  # laspy knows no layout for 1.0, which 1.1 only adds to
        header._version = laspy.header.Version(1, 1)
    record = laspy.PackedPointRecord.zeros(cloud.n_points, header.point_format)
    for attribute in cloud.attributes:
        category = channel_category(attribute)
        if category is not None:  # what is carried comes over it
            dimension, value = category
            record[dimension] = np.where(attribute.values != 0, value, record[dimension])
    for name, values in cloud.carried.items():
        if name in (record.array.dtype.names or ()) and name not in ("X", "Y", "Z"):
            record.array[name] = values
    for k, axis in enumerate("XYZ"):
        record.array[axis] = cloud.integers[:, k]
    for attribute in cloud.attributes:
        if channel_category(attribute) is None:
            _put(record, attribute)
    try:
        with open(path, "wb") as stream:
            writer = laspy.LasWriter(
                stream,
                header,
                do_compress=Path(path).suffix.lower() == ".laz",
                closefd=False,
                encoding_errors="ignore",
            )
            writer.write_points(record)
            _write_evlrs(laspy, writer, cloud.evlrs)
            writer.close()
            if not any(stored_date):  # laspy writes today where there was no date
                stream.seek(_CREATION_DATE.start)
                stream.write(stored_date)
    except (laspy.LaspyException, ValueError, KeyError) as error:
        raise OutputFileError(
            f"{path}: the points cannot be written as LAS {header.version} ({error})."
        ) from error


def _laspy() -> Any:
    try:
        import laspy
    except ImportError as error:
        raise MissingDependencyError(
            "reading and writing LAS files needs laspy; install it with "
            "'pip install \"laspy[lazrs]\"'."
        ) from error
    return laspy


def _read_all(name: str) -> tuple[LasHeader, PackedPointRecord, bytes]:
    laspy = _laspy()
    try:
        with laspy.open(name) as reader:
            if reader.header.are_points_compressed and not laspy.LazBackend.detect_available():
                raise MissingDependencyError(
                    f"{name}: reading LAZ needs lazrs; install it with 'pip install lazrs'."
                )
            points = reader.read_points(-1)
            header = reader.header
        with open(name, "rb") as stream:
            header_bytes = stream.read(header.offset_to_point_data)
    except MissingDependencyError:
        raise
    except MemoryError as error:
        raise InputFileError(
            f"{name}: the header announces more points than memory can hold; if that is no "
            "mistake, cut the file into tiles."
        ) from error
    # laspy lets whatever a damaged file provokes in it pass: struct, Unicode, value errors.
    except Exception as error:
        reason = str(error).splitlines()[0].rstrip(".") if str(error) else type(error).__name__
        raise InputFileError(
            f"{name}: this cannot be read as LAS or LAZ ({reason}); the file is damaged or of "
            "another format, get it again."
        ) from error
    return header, points, header_bytes


def _check_scaling(name: str, header: LasHeader) -> None:
    numbers = np.concatenate([header.scales, header.offsets])
    if not np.isfinite(numbers).all() or (np.asarray(header.scales) == 0).any():
        raise InputFileError(
            f"{name}: the header has the scales {list(header.scales)} and offsets "
            f"{list(header.offsets)}, which give no coordinates; the file is damaged."
        )


def _attributes(
    name: str, wanted: str, points: PackedPointRecord, header: LasHeader
) -> list[PointAttribute]:
    available = list(points.point_format.dimension_names)
    if wanted not in available and wanted in ALIASES:
        return [
            attribute
            for part in ALIASES[wanted]
            for attribute in _attributes(name, part, points, header)
        ]
    if wanted not in available and wanted == HEIGHT_ABOVE_GROUND:
        return [_height_attribute(points, header)]
    matches = [d for d in available if d == wanted] or [
        d for d in available if d.lower() == wanted.lower()
    ]
    if not matches or matches[0] in ("X", "Y", "Z"):
        choices = ", ".join(d for d in available if d not in ("X", "Y", "Z"))
        raise InputFileError(
            f"{name}: there is no dimension {wanted!r}; the file has {choices} (and hag can be "
            "computed)."
        )
    return _dimension(matches[0], points)


def _dimension(dimension: str, points: PackedPointRecord) -> list[PointAttribute]:
    info = points.point_format.dimension_by_name(dimension)
    packed = dimension not in (points.array.dtype.names or ())
    values = np.array(points[dimension]) if packed else points.array[dimension]
    n_components = 1 if values.ndim == 1 else values.shape[1]
    scales = np.ones(n_components) if info.scales is None else np.asarray(info.scales)
    offsets = np.zeros(n_components) if info.offsets is None else np.asarray(info.offsets)
    if n_components == 1:
        column = values if values.ndim == 1 else values[:, 0]
        component = None if values.ndim == 1 else 0
        return [
            PointAttribute(
                dimension, dimension, column, component, float(scales[0]), float(offsets[0])
            )
        ]
    return [
        PointAttribute(
            f"{dimension}_{k}", dimension, values[:, k], k, float(scales[k]), float(offsets[k])
        )
        for k in range(n_components)
    ]


def _height_attribute(points: PackedPointRecord, header: LasHeader) -> PointAttribute:
    integers = np.column_stack([points.array[axis] for axis in "XYZ"])
    coordinates = integers * np.asarray(header.scales) + np.asarray(header.offsets)
    is_ground = np.array(points["classification"]) == GROUND_CLASS
    heights = height_above_ground(coordinates, is_ground)
    return PointAttribute(HEIGHT_ABOVE_GROUND, HEIGHT_ABOVE_GROUND, heights)


def _check_names(name: str, lifted: list[PointAttribute]) -> None:
    seen: set[str] = set()
    for attribute in lifted:
        if attribute.name in seen:
            raise InputFileError(
                f"{name}: attribute {attribute.name!r} is asked for twice; name it once."
            )
        seen.add(attribute.name)


def _chosen(
    name: str, points: PackedPointRecord, classes: Sequence[int] | None
) -> NDArray[np.bool_] | None:
    if classes is None:
        return None
    of_point = np.array(points["classification"])
    chosen: NDArray[np.bool_] = np.isin(of_point, list(classes))
    if not chosen.any():
        present = ", ".join(str(c) for c in np.unique(of_point))
        raise InputFileError(
            f"{name}: no point has class {', '.join(map(str, classes))}; the classes in the file "
            f"are {present}."
        )
    return chosen


def _select(values: NDArray[Any], chosen: NDArray[np.bool_] | None) -> NDArray[Any]:
    return np.ascontiguousarray(values if chosen is None else values[chosen])


def _with_values(attribute: PointAttribute, values: NDArray[Any]) -> PointAttribute:
    return PointAttribute(
        attribute.name,
        attribute.dimension,
        values,
        attribute.component,
        attribute.scale,
        attribute.offset,
    )


def _carried(
    points: PackedPointRecord, lifted: list[PointAttribute], chosen: NDArray[np.bool_] | None
) -> dict[str, NDArray[Any]]:
    """Return the fields of the records that the pyramid does not hold.

    A lifted sub-field (the class of formats 0 to 5 shares its byte with flags) stays in its
    byte, and so do the other components of an array.
    """
    whole = {a.dimension for a in lifted if a.component is None}
    names = points.array.dtype.names or ()
    return {
        name: _select(points.array[name], chosen)
        for name in names
        if name not in ("X", "Y", "Z") and name not in whole
    }


def _put(record: PackedPointRecord, attribute: PointAttribute) -> None:
    """Put the stored values of an attribute in its dimension."""
    if attribute.dimension in (record.array.dtype.names or ()):
        field = record.array[attribute.dimension]
        if attribute.component is None:
            field[:] = attribute.values
        else:
            field[:, attribute.component] = attribute.values
        return
    largest = record.point_format.dimension_by_name(attribute.dimension).max or 0
    record[attribute.dimension] = np.minimum(attribute.values, largest)


def _tell_of_waveforms(name: str, header: LasHeader) -> None:
    if header.point_format.id in _WAVEFORM_FORMATS:
        warnings.warn(
            f"{name}: the points refer to waveforms; their references are carried, the waveform "
            "samples themselves are not",
            PointCloudWarning,
            stacklevel=3,
        )


def _evlr_bytes(name: str, header: LasHeader) -> NDArray[np.uint8]:
    evlrs = header.evlrs
    if evlrs is None or len(evlrs) == 0:
        return np.empty(0, np.uint8)
    stream = io.BytesIO()
    kept = type(evlrs)(v for v in evlrs if v.user_id not in _STALE_OWNERS)
    try:
        kept.write_to(stream, as_extended=True, encoding_errors="ignore")
    except (ValueError, OverflowError) as error:
        warnings.warn(
            f"{name}: the extended VLRs cannot be carried ({error})",
            PointCloudWarning,
            stacklevel=3,
        )
        return np.empty(0, np.uint8)
    return np.frombuffer(stream.getvalue(), np.uint8)


def _write_evlrs(laspy: Any, writer: Any, stored: NDArray[np.uint8]) -> None:
    if len(stored) == 0 or writer.header.version.minor < 4:
        return
    stream, evlrs = io.BytesIO(stored.tobytes()), []
    while stream.tell() < len(stored):
        evlrs.extend(laspy.vlrs.vlrlist.VLRList.read_from(stream, 1, extended=True))
    writer.write_evlrs(laspy.vlrs.vlrlist.VLRList(evlrs))


def _header_from(laspy: Any, stored: NDArray[np.uint8]) -> LasHeader:
    try:
        return laspy.LasHeader.read_from(io.BytesIO(stored.tobytes()))
    except Exception as error:  # whatever a damaged header provokes in laspy
        raise InputFileError(
            f"the stored LAS header is damaged ({error}); analyse the input anew."
        ) from error
