"""Small layers and rasters that the QGIS tests are fed with, and what they read back."""

import math

import numpy as np
from osgeo import gdal, osr
from qgis.core import (
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsGeometry,
    QgsPoint,
    QgsProcessingFeedback,
    QgsVectorFileWriter,
    QgsVectorLayer,
)

gdal.DontUseExceptions()
osr.DontUseExceptions()

GDAL_TYPES = {
    "uint8": gdal.GDT_Byte,
    "int16": gdal.GDT_Int16,
    "uint16": gdal.GDT_UInt16,
    "int32": gdal.GDT_Int32,
    "float32": gdal.GDT_Float32,
    "float64": gdal.GDT_Float64,
}


class Log(QgsProcessingFeedback):
    """A feedback that keeps what it is told, and cancels at a fraction if asked to."""

    def __init__(self, cancel_at=None):
        super().__init__(False)
        self.lines, self.warnings, self.errors, self.fractions = [], [], [], []
        self.cancel_at = cancel_at
        self.progressChanged.connect(self._on_progress)

    def _on_progress(self, percent):
        self.fractions.append(percent)
        if self.cancel_at is not None and percent >= self.cancel_at:
            self.cancel()

    def pushInfo(self, info):
        self.lines.append(info)

    def pushWarning(self, warning):
        self.warnings.append(warning)

    def reportError(self, error, fatalError=False):
        self.errors.append(error)


def hills(n_rows=60, n_columns=80, amplitude=40.0):
    """Return elevations of rolling hills with a little roughness, always the same."""
    rows, columns = np.mgrid[:n_rows, :n_columns]
    rough = np.random.default_rng(7).normal(size=(n_rows, n_columns))
    return 300 + amplitude * np.sin(rows / 9) * np.cos(columns / 13) + 0.5 * rough


def write_raster(path, values, nodata=None, epsg=2154, origin=(700000.0, 6600000.0), cell=10.0):
    """Write a GeoTIFF with GDAL itself, so that no code under test has a hand in it."""
    n_rows, n_columns = values.shape
    dataset = gdal.GetDriverByName("GTiff").Create(
        str(path), n_columns, n_rows, 1, GDAL_TYPES[values.dtype.name]
    )
    dataset.SetGeoTransform((origin[0], cell, 0.0, origin[1], 0.0, -cell))
    if epsg:
        system = osr.SpatialReference()
        system.ImportFromEPSG(epsg)
        dataset.SetProjection(system.ExportToWkt())
    band = dataset.GetRasterBand(1)
    if nodata is not None:
        band.SetNoDataValue(nodata)
    band.WriteRaster(0, 0, n_columns, n_rows, np.ascontiguousarray(values).tobytes())
    del band, dataset
    return str(path)


def read_raster(path):
    """Return bytes of the band, shape, type, nodata, geotransform and EPSG code of a raster."""
    dataset = gdal.Open(str(path))
    band = dataset.GetRasterBand(1)
    nodata = band.GetNoDataValue()
    system = osr.SpatialReference(dataset.GetProjection())
    return {
        "bytes": band.ReadRaster(),
        "shape": (dataset.RasterYSize, dataset.RasterXSize),
        "type": band.DataType,
        "nodata": "nan" if nodata is not None and math.isnan(nodata) else nodata,
        "transform": dataset.GetGeoTransform(),
        "same_crs": system,
    }


def assert_same_raster(left, right):
    """Fail unless two rasters are the same bit for bit, with type, nodata, grid and CRS."""
    a, b = read_raster(left), read_raster(right)
    for part in ("shape", "type", "nodata", "transform"):
        assert a[part] == b[part], part
    assert a["same_crs"].IsSame(b["same_crs"]) or not a["same_crs"].ExportToWkt()
    assert a["bytes"] == b["bytes"], "the numbers differ"


def point_layer(xyz, crs="EPSG:2154", fields=(), rows=()):
    """Return a memory layer of points; ``fields`` as ``name:type``, one row of values a point."""
    definition = "".join(f"&field={field}" for field in fields)
    layer = QgsVectorLayer(f"PointZ?crs={crs}{definition}", "points", "memory")
    features = []
    for k, (x, y, z) in enumerate(xyz):
        feature = QgsFeature(layer.fields())
        feature.setGeometry(QgsGeometry(QgsPoint(x, y, z)))
        if len(rows):
            feature.setAttributes(list(rows[k]))
        features.append(feature)
    layer.dataProvider().addFeatures(features)
    return layer


def write_points(path, xyz, epsg=2154):
    """Write points with Z as a GeoPackage."""
    layer = point_layer(xyz, f"EPSG:{epsg}")
    options = QgsVectorFileWriter.SaveVectorOptions()
    written = QgsVectorFileWriter.writeAsVectorFormatV3(
        layer, str(path), QgsCoordinateTransformContext(), options
    )
    assert written[0] == QgsVectorFileWriter.WriterError.NoError, written
    return str(path)


def wkt_layer(geometry_type, wkts, crs="EPSG:2154"):
    """Return a memory layer of geometries given as text."""
    layer = QgsVectorLayer(f"{geometry_type}?crs={crs}", geometry_type, "memory")
    for wkt in wkts:
        feature = QgsFeature()
        feature.setGeometry(QgsGeometry.fromWkt(wkt))
        layer.dataProvider().addFeatures([feature])
    return layer


def survey(n=2000, size=1000.0, seed=3):
    """Return ``(n, 3)`` points of a surveyed slope with a bank, in EPSG:2154."""
    plan = np.random.default_rng(seed).random((n, 2)) * size
    z = 100 + 15 * np.sin(plan[:, 0] / 120) + np.where(plan[:, 1] > size / 2, 8.0, 0.0)
    return np.column_stack([plan[:, 0] + 700000.0, plan[:, 1] + 6600000.0, z])


def write_las(path, xyz, epsg=2154, **dimensions):
    """Write points as LAS 1.4 with whole millimetres; ``dimensions`` by their LAS names."""
    import laspy
    from pyproj import CRS

    header = laspy.LasHeader(point_format=7, version="1.4")
    header.offsets, header.scales = np.floor(np.min(xyz, axis=0)), np.full(3, 0.001)
    if epsg:
        header.add_crs(CRS.from_epsg(epsg))
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = np.transpose(xyz)
    for name, values in dimensions.items():
        cloud[name] = values
    cloud.write(str(path))
    return str(path)


def numbers(path, dtype="f4"):
    """Return the numbers of a raster as an array."""
    raster = read_raster(path)
    return np.frombuffer(raster["bytes"], dtype).reshape(raster["shape"])
