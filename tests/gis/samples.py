"""Small rasters and point clouds that the tests write, and how two files are compared."""

from pathlib import Path

import laspy
import numpy as np
import rasterio

UTM = "EPSG:32632"


def hills(n_rows=40, n_columns=50, seed=0):
    """Return smooth elevations with a little noise, float64."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:n_rows, 0:n_columns]
    smooth = 300 + 40 * np.sin(x / 9) * np.cos(y / 7) + 0.5 * x
    return smooth + rng.normal(0, 0.5, smooth.shape)


def write_tif(path, values, *, crs=UTM, transform=None, nodata=None, **options):
    """Write a one-band GeoTIFF, or one of several bands for three-dimensional values."""
    bands = values if values.ndim == 3 else values[None]
    if transform is None:
        transform = rasterio.Affine(10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0)
    profile = {
        "driver": "GTiff",
        "count": len(bands),
        "height": bands.shape[1],
        "width": bands.shape[2],
        "dtype": bands.dtype.name,
        "crs": crs,
        "transform": transform,
        "nodata": nodata,
    }
    with rasterio.open(path, "w", **(profile | options)) as dataset:
        dataset.write(bands)
    return Path(path)


def write_las(path, n_points=400, *, seed=0, version="1.4", point_format=6, crs=UTM, degrees=False):
    """Write a cloud of ground and trees with duplicates, classes, colours and GPS time."""
    from pyproj import CRS

    rng = np.random.default_rng(seed)
    header = laspy.LasHeader(version=version, point_format=point_format)
    header.scales = [1e-7, 1e-7, 0.001] if degrees else [0.01, 0.01, 0.001]
    header.offsets = [11.0, 46.0, 0.0] if degrees else [500000.0, 5100000.0, 100.0]
    header.add_extra_dim(laspy.ExtraBytesParams("range", "i2", scales=[0.5], offsets=[10.0]))
    if crs:
        header.add_crs(CRS.from_user_input(crs))
    las = laspy.LasData(header)
    step = 1e-5 if degrees else 1.0
    x = header.offsets[0] + step * rng.uniform(0, 100, n_points)
    y = header.offsets[1] + step * rng.uniform(0, 100, n_points)
    z = 300 + 0.2 * rng.normal(size=n_points)
    is_tree = rng.random(n_points) < 0.4
    z[is_tree] += rng.uniform(2, 20, is_tree.sum())
    x[-20:], y[-20:] = x[:20], y[:20]  # points that share x and y with another
    las.x, las.y, las.z = x, y, z
    las.classification = np.where(is_tree, 5, 2).astype(np.uint8)
    las.intensity = rng.integers(0, 65536, n_points).astype(np.uint16)
    las.return_number = rng.integers(1, 4, n_points)
    las.number_of_returns = np.full(n_points, 3)
    las.gps_time = rng.uniform(0, 1e9, n_points)
    las.range = 10.0 + 0.5 * rng.integers(-100, 100, n_points)
    if "red" in las.point_format.dimension_names:
        las.red = rng.integers(0, 65536, n_points)
    las.write(path)
    return Path(path)


def assert_same_raster(path, other, band=1):
    """Assert that a band came back with its bits, type, nodata, transform and CRS."""
    with rasterio.open(path) as expected, rasterio.open(other) as actual:
        assert actual.read(1).tobytes() == expected.read(band).tobytes()
        assert actual.dtypes[0] == expected.dtypes[band - 1]
        assert repr(actual.nodata) == repr(expected.nodatavals[band - 1])
        assert tuple(actual.transform) == tuple(expected.transform)
        assert actual.crs == expected.crs
        assert (actual.read_masks(1) == expected.read_masks(band)).all()
        assert actual.scales[0] == expected.scales[band - 1]
        assert actual.offsets[0] == expected.offsets[band - 1]
        assert actual.tags().get("AREA_OR_POINT") == expected.tags().get("AREA_OR_POINT")


def assert_same_cloud(path, other):
    """Assert that every byte of every point record came back, and what the header says."""
    expected, actual = laspy.read(path), laspy.read(other)
    assert actual.points.array.dtype == expected.points.array.dtype
    assert actual.points.array.tobytes() == expected.points.array.tobytes()
    assert list(actual.header.scales) == list(expected.header.scales)
    assert list(actual.header.offsets) == list(expected.header.offsets)
    assert actual.header.point_format == expected.header.point_format
    for name in ("uuid", "system_identifier", "generating_software", "file_source_id"):
        assert getattr(actual.header, name) == getattr(expected.header, name), name
    assert records_of(actual) == records_of(expected)


def records_of(las):
    """Return the VLRs that must survive byte for byte.

    Not those of the compression; and of the record of extra dimensions, whose smallest and largest
    values laspy reckons anew, the names, types, scales and descriptions.
    """
    extra = [
        (d.name, d.dtype, d.description, None if d.scales is None else list(d.scales))
        for d in las.point_format.extra_dimensions
    ]
    return extra, [
        (record.user_id, record.record_id, bytes(record.record_data_bytes()))
        for record in las.vlrs
        if record.user_id != "copc" and (record.user_id, record.record_id) != ("LASF_Spec", 4)
    ]
