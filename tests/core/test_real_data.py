"""Real DEMs and LiDAR clouds come back, and every step on them obeys the rules."""

import helpers
import numpy as np
import pytest

from wavelet_core import TriangleMesh, analyse

pytestmark = [pytest.mark.data, pytest.mark.large]


def read_window(path, n_rows, n_columns):
    """Return the mesh of a corner of a DEM, in metres."""
    import rasterio

    with rasterio.open(path) as dataset:
        window = rasterio.windows.Window(20, 30, n_columns, n_rows)
        band = dataset.read(1, window=window, masked=True)
        cell = (dataset.res[0], dataset.res[1])
    if max(cell) < 0.1:  # degrees
        cell = (cell[0] * 85_000, cell[1] * 111_000)
    return TriangleMesh.from_grid(
        band.astype(float).filled(np.nan),
        x=500_000 + cell[0] * np.arange(n_columns),
        y=4_500_000 - cell[1] * np.arange(n_rows),
    )


def read_cloud(path, n_points):
    """Return the mesh of the westernmost points of a LAS file, with class and intensity."""
    import laspy

    cloud = laspy.read(path)
    points = np.column_stack([cloud.x, cloud.y, cloud.z])
    chosen = np.argsort(points[:, 0], kind="stable")[:n_points]
    attributes = np.column_stack([cloud.classification, cloud.intensity]).astype(float)
    return TriangleMesh.from_points(points[chosen], attributes[chosen], ("class", "intensity"))


@pytest.fixture(scope="module")
def terrains(data_folder):
    return {
        "dem of metres": read_window(data_folder / "dems" / "lidar_dem_400.tif", 60, 80),
        "dem with holes": read_window(data_folder / "dems" / "codem_dsm_holes.tif", 70, 80),
        "dem of degrees, integers": read_window(data_folder / "dems" / "rmnp_u16_4326.tif", 50, 60),
        "lidar": read_cloud(data_folder / "clouds" / "mountain_utm42_38k.las", 3000),
        "lidar of vertical walls": read_cloud(
            data_folder / "clouds" / "ign_tiles_77050_627755.laz", 5000
        ),
    }


@helpers.UNSTABLE_TOO
@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize(("prediction", "update"), helpers.PAIRS)
def test_all_filter_pairs_over_24_levels(terrains, prediction, update, signal):
    for name in ("dem of degrees, integers", "lidar"):
        mesh = terrains[name]
        pyramid = analyse(
            mesh,
            levels=24,
            partition="quadric",
            prediction=prediction,
            update=update,
            signal=signal,
        )
        helpers.assert_pyramid_is_consistent(pyramid, mesh)


@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize("design", ["GLMN", "NNLSMN", "CLORMP"])
@pytest.mark.parametrize("name", ["dem of metres", "dem with holes", "lidar of vertical walls"])
def test_other_terrain(terrains, name, design, signal):
    mesh = terrains[name]
    pyramid = analyse(mesh, levels=24, partition="quadric", prediction=design, signal=signal)
    assert pyramid.n_levels >= 12
    helpers.assert_pyramid_is_consistent(pyramid, mesh)


@pytest.mark.parametrize("name", ["dem of metres", "dem of degrees, integers", "lidar"])
def test_a_quarter_to_a_third_of_the_vertices_go_per_level(terrains, name):
    mesh = terrains[name]
    pyramid = analyse(mesh, levels=10, partition="quadric", prediction="GLMN", signal="xyz")
    share = 1 - (pyramid.n_vertices(0) / mesh.n_vertices) ** (1 / pyramid.n_levels)
    assert 0.25 <= share <= 0.32
