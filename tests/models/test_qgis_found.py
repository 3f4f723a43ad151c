"""The model for hydraulics on an input that once gave a wrong mesh without a word."""

import re
import shutil

import numpy as np
import pytest
from qgis_layers import Log

#: Of the points along a line at which the mesh is compared with the DEM, in metres.
SPACING = 1.0


def _nodes_and_faces(path):
    rows = [line.split() for line in path.read_text().splitlines()]
    nodes = np.array([row[2:5] for row in rows if row[0] == "ND"], dtype=float)
    faces = np.array([row[2:5] for row in rows if row[0] == "E3T"], dtype=int) - 1
    return nodes, faces


def _heights(nodes, faces, plan):
    """Return heights on a mesh by barycentric coordinates, one point at a time; NaN outside."""
    a, b, c = (nodes[faces[:, k]] for k in range(3))
    low = np.minimum(np.minimum(a, b), c)[:, :2]
    high = np.maximum(np.maximum(a, b), c)[:, :2]
    heights = np.full(len(plan), np.nan)
    for k, (x, y) in enumerate(plan):
        near = np.flatnonzero(((low - 1e-3 <= (x, y)) & (high + 1e-3 >= (x, y))).all(axis=1))
        for f in near:
            matrix = np.array([a[f], b[f], c[f]])
            matrix[:, 2] = 1.0
            share = np.linalg.solve(matrix.T, (x, y, 1.0))
            if share.min() >= -1e-3:
                heights[k] = share @ (a[f][2], b[f][2], c[f][2])
                break
    return heights


def _of_dem(path, plan):
    """Return the least and the largest height of the four cells around each point."""
    from osgeo import gdal

    dataset = gdal.Open(str(path))
    x0, dx, _, y0, _, dy = dataset.GetGeoTransform()
    z = dataset.ReadAsArray().astype(float)
    column = ((plan[:, 0] - x0) / dx - 0.5).clip(0, z.shape[1] - 1.001)
    row = ((plan[:, 1] - y0) / dy - 0.5).clip(0, z.shape[0] - 1.001)
    i, j = row.astype(int), column.astype(int)
    around = np.array([z[i, j], z[i + 1, j], z[i, j + 1], z[i + 1, j + 1]])
    return around.min(axis=0), around.max(axis=0)


def _along(path):
    """Return points every metre along the lines, or outlines, of a layer."""
    from qgis.core import QgsVectorLayer

    layer = QgsVectorLayer(str(path), "lines", "ogr")
    points = []
    for feature in layer.getFeatures():
        line = feature.geometry().densifyByDistance(SPACING)
        points += [(vertex.x(), vertex.y()) for vertex in line.vertices()]
    return np.array(points)


@pytest.mark.data
def test_draped_breakline_lies_on_the_dem_at_every_point(provider, data_folder, tmp_path):
    """Lines without Z, in a model, at a size: within what is printed, also between corners."""
    import processing
    from qgis.core import QgsProcessingContext

    for path in (data_folder / "found" / "draped-breakline").iterdir():
        shutil.copyfile(path, tmp_path / path.name)
    dem = data_folder / "dems" / "lidar_dem_400.tif"
    log = Log()
    processing.run(
        "terrainwavelets:dem_to_hydraulic_mesh",
        {
            "INPUT": str(dem),
            "BREAKLINES": str(tmp_path / "break.gpkg"),
            "CLIP": str(tmp_path / "area.gpkg"),
            "TARGET_VERTICES": 20000,
            "hydraulic_mesh": str(tmp_path / "trench.2dm"),
            "triangles_of_the_mesh": "TEMPORARY_OUTPUT",
        },
        feedback=log,
        context=QgsProcessingContext(),
    )
    said = [re.search(r"Along breaklines .* largest error ([\d.]+)", line) for line in log.lines]
    (largest,) = {float(match[1]) for match in said if match}
    assert largest < 0.05
    nodes, faces = _nodes_and_faces(tmp_path / "trench.2dm")
    assert len(nodes) == 20000
    for name in ("break.gpkg", "area.gpkg"):
        plan = _along(tmp_path / name)
        assert len(plan) > 400
        found = _heights(nodes, faces, plan)
        low, high = _of_dem(dem, plan)
        assert np.maximum(low - found, found - high).max() <= largest
