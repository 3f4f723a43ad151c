"""Six adjoining LiDAR files in tiles of their own size: seams, errors beside them, every byte."""

import numpy as np
import pytest
from gis.samples import assert_same_cloud
from gis.tiles.test_tiles import seams, whole_levels

import wavelet_gis as wg
from wavelet_core.metrics import surface_errors

pytestmark = [
    pytest.mark.data,
    pytest.mark.large,
    pytest.mark.filterwarnings("ignore::UserWarning"),
]


@pytest.fixture(scope="module")
def files(data_folder):
    return sorted((data_folder / "clouds").glob("ign_tiles_*.laz"))


@pytest.fixture(scope="module")
def tiled(files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("ign") / "tiles"
    made = wg.tile_clouds(files, folder, tile=50, workers=2)
    assert made.failed == []
    return made


def test_border_vertices_are_identical(tiled):
    plan = tiled.index.plan
    assert (len(plan.rows), len(plan.columns)) == (3, 4)
    for stage in (0, 1):
        for levels, others in seams(tiled.index, stage):
            shared = levels[-1].keys() & others[-1].keys()
            assert len(shared) > 50
            for mine in levels:
                for theirs in others:
                    assert mine.keys() & theirs.keys() == shared
                    assert all(mine[place] == theirs[place] for place in shared)


def test_errors_beside_seams_are_not_above_those_inside(tiled):
    index, plan = tiled.index, tiled.index.plan
    points = wg.extract_region(index, level=index.n_levels).surface.mesh.vertices
    x, y = plan.local_frame.file_x(points[:, 0]), plan.local_frame.file_y(points[:, 1])
    columns, rows = plan.geometry.cells(x, y)
    metre = 1.0 / plan.points.scales[0]
    near = np.min([np.abs(rows - end) for end in plan.rows[1:-1]], axis=0) < metre
    near |= np.min([np.abs(columns - end) for end in plan.columns[1:-1]], axis=0) < metre
    for level in range(0, index.n_levels, 6):
        mesh = wg.extract_region(index, level=level).surface.mesh
        errors = surface_errors(mesh, points)
        inside, beside = (np.sqrt(np.nanmean(errors[mask] ** 2)) for mask in (~near, near))
        print(level, mesh.n_vertices, round(float(inside), 3), round(float(beside), 3))
        assert beside <= 1.05 * inside


def test_the_integral_and_the_surface_hold_at_every_level(tiled):
    total = area = None
    for whole in whole_levels(tiled.index):
        integral = whole.integrals @ whole.vertices[:, 2]
        total = integral if total is None else total
        assert integral == pytest.approx(total, rel=1e-11)
        mesh = whole.mesh
        assert mesh.plan_areas.min() > 0
        area = mesh.plan_areas.sum() if area is None else area
        assert mesh.plan_areas.sum() == pytest.approx(area, rel=1e-9)
        tail, head = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
        directed = tail * mesh.n_vertices + head
        assert len(np.unique(directed)) == len(directed)


def test_every_file_comes_back(files, tiled, tmp_path):
    for number, path in enumerate(files):
        wg.restore_source(tiled.index, number, tmp_path / path.name)
        assert_same_cloud(path, tmp_path / path.name)
