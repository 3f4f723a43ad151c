"""Coarse levels come out of their own part of the file, the same to the bit as out of all of it."""

import shutil

import numpy as np
import pytest
from gis.samples import hills, write_las, write_tif
from tools.pyramid_surgery import operate, reseal

from wavelet_core import TriangleMesh, analyse
from wavelet_core.errors import PyramidError
from wavelet_core.lifting import recorded
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.io.pyramid.pyramid_file import read_levels, read_pyramid, write_pyramid
from wavelet_gis.model.dem import Dem, GridGeometry, cell_plan, dem_mesh
from wavelet_gis.workflows.open import load, open_terrain

DESIGNS = {
    "minimum norm": {"levels": 20},
    "no update": {"norm": "max", "levels": 30},
    "locked": {"levels": 20, "locked": 200},
    "cloud": {"levels": 20},
}


@pytest.fixture(params=[0.25, 0.0], ids=["parts", "coarsest level"])
def share(request):
    """Return by how much vertices must have become fewer for a part; with 0 the coarsest is one."""
    return request.param


@pytest.fixture(params=list(DESIGNS))
def geo(request, share, tmp_path, monkeypatch):
    """Return a pyramid that is written in parts, small as it is."""
    monkeypatch.setattr(recorded, "LEAST_IN_PARTS", 1000)
    monkeypatch.setattr(recorded, "LEAST_IN_PART", 10)
    monkeypatch.setattr(recorded, "PART_SHARE", share)
    monkeypatch.setattr(recorded, "COARSEST_SHARE", 0.5)
    values = hills(50, 60).astype("f4")
    values[5:9, 7:12] = -9999
    if request.param == "cloud":
        terrain = open_terrain(write_las(tmp_path / "a.laz", 2000), attributes=["intensity"])
    else:
        terrain = open_terrain(write_tif(tmp_path / "a.tif", values, nodata=-9999))
    options = dict(DESIGNS[request.param])
    if "locked" in options:
        locked = np.zeros(terrain.mesh.n_vertices, dtype=bool)
        locked[:: options["locked"]] = True
        options["locked"] = locked
    return terrain.geo_pyramid(analyse(terrain.mesh, **options))


@pytest.fixture
def path(geo, tmp_path):
    write_pyramid(tmp_path / "a.gpkg", geo)
    return tmp_path / "a.gpkg"


def test_every_level_is_the_same_from_either(geo, path):
    whole = read_pyramid(path)
    assert whole.pyramid == geo.pyramid
    sizes = set()
    for level in range(geo.pyramid.n_levels + 1):
        part = read_levels(path, level)
        assert part.pyramid.mesh(level) == geo.pyramid.mesh(level)
        ids = part.pyramid.vertex_ids(level)
        assert np.array_equal(ids, geo.pyramid.vertex_ids(level))
        assert part.errors == whole.errors
        sizes.add(part.pyramid.n_levels)
    assert len(sizes) > 1  # the whole, and parts of it


def test_details_of_a_part_are_those_of_the_whole(geo, path):
    part = read_levels(path, 0).pyramid
    assert part.part is not None
    for level, detail in part.details():
        assert detail == geo.pyramid.detail(level)


def test_a_coarse_level_needs_nothing_of_the_fine_ones(path, tmp_path):
    """Half of the file may be gone."""
    broken = shutil.copy(path, tmp_path / "broken.gpkg")
    operate(
        broken,
        "UPDATE wavelet_chunks SET data = zeroblob(7) WHERE array_id IN (SELECT id FROM "
        "wavelet_arrays WHERE name LIKE 'parts/0/%' OR name = 'source/residuals' "
        "OR name LIKE 'faces/%')",
    )
    with pytest.raises(PyramidError, match="damaged"):
        read_pyramid(broken)
    assert read_levels(broken, 0).pyramid.mesh(0) == read_pyramid(path).pyramid.mesh(0)


def test_a_part_is_not_passed_off_as_the_input(path):
    with pytest.raises(PyramidError, match="only the finest level"):
        load(path, level=0).restore()


@pytest.mark.parametrize("level", [-1, 10**6])
def test_a_level_that_is_not_there(path, level):
    with pytest.raises(PyramidError, match="there is no level"):
        load(path, level=level).mesh(level)


@pytest.mark.parametrize("name", ["ids", "faces", "heights", "integrals", "unchanged"])
def test_a_part_that_begins_at_no_level_is_refused(path, tmp_path, name):
    broken = shutil.copy(path, tmp_path / "broken.gpkg")
    where = f"WHERE name LIKE 'parts/%/{name}'"
    operate(
        broken,
        f"UPDATE wavelet_arrays SET shape = replace(shape, '[', '[1') {where}",
    )
    reseal(broken)
    for read in (read_pyramid, lambda file: read_levels(file, 0)):
        with pytest.raises(PyramidError):
            read(broken)


@pytest.mark.parametrize(
    "transform",
    [(10.0, 0.0, 5e5, 0.0, -10.0, 5e6), (3e-4, 0.0, 7.1, 0.0, 2e-4, 46.0), (8, 3, 0, -2, 9, 5)],
)
def test_places_of_cells_are_those_of_the_mesh(transform):
    values = hills(12, 15)
    valid = values > np.quantile(values, 0.2)
    geometry = GridGeometry(values.shape, transform)
    frame = LocalFrame(x_origin=3.3, y_origin=-1.7, x_scale=7.3e4, y_scale=1.1e5)
    mesh: TriangleMesh = dem_mesh(Dem(values, valid, geometry), frame)
    ids = np.arange(0, mesh.n_vertices, 3)
    plan = cell_plan(geometry, valid, frame, ids)
    assert np.array_equal(plan, mesh.vertices[ids, :2])
