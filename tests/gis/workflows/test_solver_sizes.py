"""Sizes of a mesh for solvers by place: every triangle is checked by itself, from outside."""

import json

import numpy as np
import pyogrio
import pytest
import shapely
from gis.samples import UTM, hills, write_tif

import wavelet_gis as wg
from wavelet_core import synthetic
from wavelet_core.errors import OptionError
from wavelet_core.features.shape import surface_shape
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_gis.cli.main import main
from wavelet_gis.errors import InputFileError
from wavelet_gis.workflows.solver.size_field import SizeField, graded, pieces_within

pytest.importorskip("CGAL")

X, Y = 500000.0, 5100000.0


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    return write_tif(tmp_path_factory.mktemp("dem") / "dem.tif", hills(40, 50))


@pytest.fixture(scope="module")
def tin(dem):
    return wg.simplify(wg.open(dem), max_error=8.0)


def longest_edges(mesh):
    corners = mesh.vertices[mesh.faces][..., :2]
    return np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)


def require_sizes(made, sizes, min_angle=20.0):
    """Check every triangle against the size at every input vertex that lies in it."""
    mesh, plan = made.mesh, made.terrain.mesh.vertices[:, :2]
    build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    assert mesh.plan_areas.min() > 0
    assert mesh.plan_areas.sum() == pytest.approx(made.terrain.mesh.plan_areas.sum())
    assert made.quality.smallest_angle >= min_angle - 1e-6
    longest = longest_edges(mesh)
    triangles = shapely.polygons(mesh.vertices[mesh.faces][..., :2])
    face, vertex = shapely.STRtree(shapely.points(plan)).query(triangles, predicate="contains")
    assert len(np.unique(vertex)) > 0.4 * len(plan)
    assert (longest[face] <= sizes[vertex] + 1e-9).all()
    away = np.linalg.norm(mesh.vertices[:, None, :2] - plan[None], axis=2)
    is_nearest = (
        away <= away.min(axis=1, keepdims=True) + 1e-9
    )  # of equally near ones any may count
    at_corner = np.where(is_nearest, sizes, 0.0).max(axis=1)
    assert (longest <= at_corner[mesh.faces].min(axis=1) + 1e-9).all()
    return longest


def write_zones(path, limits, **fields):
    boxes = [shapely.box(X + a, Y - 400, X + b, Y) for a, b in limits]
    pyogrio.raw.write(
        path, shapely.to_wkb(np.array(boxes)), [np.array(v) for v in fields.values()],
        list(fields), geometry_type="Polygon", crs=UTM,
    )  # fmt: skip
    return path


def in_file(tin):
    return tin.geo.file_mesh(tin.terrain.mesh).vertices


def test_by_a_function_of_height(tin):
    z = tin.terrain.mesh.vertices[:, 2]
    middle = np.median(z)
    made = tin.for_solver(min_angle=20.0, longest_edge=f"where(z > {middle}, 15, 90)")
    longest = require_sizes(made, np.where(z > middle, 15.0, 90.0))
    assert longest.max() > 45, "large ones where they may be"
    everywhere = tin.for_solver(min_angle=20.0, longest_edge=15.0)
    assert made.mesh.n_vertices < 0.75 * everywhere.mesh.n_vertices
    assert made.errors.max_error <= 8.0 + 1e-6


def test_by_a_function_of_slope_as_an_area(tin):
    slope = surface_shape(tin.terrain.mesh).slope
    steep = float(np.quantile(slope, 0.8))
    made = tin.for_solver(min_angle=20.0, max_area=f"where(slope > {steep}, 120, 4000)")
    areas = np.where(slope > steep, 120.0, 4000.0)
    require_sizes(made, np.sqrt(areas * 4 / np.sqrt(3)))
    plan = tin.terrain.mesh.vertices[:, :2]
    triangles = shapely.polygons(made.mesh.vertices[made.mesh.faces][..., :2])
    face, vertex = shapely.STRtree(shapely.points(plan)).query(triangles, predicate="contains")
    assert (made.mesh.plan_areas[face] <= areas[vertex] + 1e-9).all()


def test_by_a_raster_with_nothing_in_places(tin, tmp_path):
    sizes = np.full((40, 50), np.nan)
    sizes[:, :20] = 18.0
    path = write_tif(tmp_path / "sizes.tif", sizes)
    made = tin.for_solver(min_angle=20.0, longest_edge=path)
    x = in_file(tin)[:, 0]
    known = np.where(x < X + 200, 18.0, np.inf)
    assert require_sizes(made, known).max() > 36.0


def test_by_polygons_with_both_fields(tin, tmp_path):
    zones = write_zones(tmp_path / "z.gpkg", [(0, 100), (300, 500)], longest_edge=[14.0, 40.0])
    made = tin.for_solver(min_angle=20.0, size_zones=zones, longest_edge=120.0)
    x = in_file(tin)[:, 0]
    sizes = np.where(x <= X + 100, 14.0, np.where(x >= X + 300, 40.0, 120.0))
    require_sizes(made, sizes)
    both = write_zones(tmp_path / "b.gpkg", [(0, 100), (300, 500)], edge=[14.0, 70.0],
                       area=[9000.0, 60.0])  # fmt: skip
    made = tin.for_solver(min_angle=20.0, size_zones=both, size_field="edge", area_field="area")
    small = np.sqrt(60.0 * 4 / np.sqrt(3))
    require_sizes(made, np.where(x <= X + 100, 14.0, np.where(x >= X + 300, small, np.inf)))
    made = tin.for_solver(min_angle=20.0, size_zones=both, area_field="area")
    require_sizes(made, np.where(x >= X + 300, small, np.inf))


def test_an_array_and_a_number_together(tin):
    sizes = np.where(np.arange(tin.terrain.mesh.n_vertices) == 1025, 6.0, np.nan)
    made = tin.for_solver(min_angle=20.0, longest_edge=sizes, max_area=2000.0)
    most = np.sqrt(2000.0 * 4 / np.sqrt(3))
    require_sizes(made, np.where(np.isnan(sizes), most, sizes))


def test_grading_lets_edges_grow_by_a_share_of_the_distance(tin):
    """From one fine place, and from the vertices of the TIN: within what straight lines allow."""
    plan = tin.terrain.mesh.vertices[:, :2]
    sizes = np.where(np.arange(len(plan)) == 1025, 6.0, 100.0)
    own = tin.mesh.vertices[:, :2]
    apart = np.linalg.norm(own[:, None] - own[None], axis=2) + np.diag(np.full(len(own), 1e9))
    before = None
    for grading in (1.0, 0.3):
        made = tin.for_solver(min_angle=20.0, longest_edge=sizes, grading=grading)
        from_place = 6.0 + grading * np.linalg.norm(plan - plan[1025], axis=1)
        distance = np.linalg.norm(plan[:, None] - own[None], axis=2)
        from_tin = (2 * apart.min(axis=0) + grading * distance).min(axis=1)
        require_sizes(made, np.minimum(np.minimum(from_place, from_tin), 100.0))
        assert before is None or made.mesh.n_vertices > before
        before = made.mesh.n_vertices
    alone = tin.for_solver(min_angle=20.0, grading=0.3)
    from_tin = (2 * apart.min(axis=0) + 0.3 * distance).min(axis=1)
    require_sizes(alone, from_tin)
    with pytest.raises(AssertionError):
        require_sizes(tin.for_solver(min_angle=20.0), from_tin)


def test_graded_sizes_are_between_the_steepest_and_a_little_less():
    mesh = synthetic.plane(31, 31)
    plan = mesh.vertices[:, :2]
    sizes = np.full(len(plan), np.inf)
    sizes[[400, 77]] = 0.5, 2.0
    found = graded(mesh, sizes, 0.4)
    exact = np.min([sizes[k] + 0.4 * np.linalg.norm(plan - plan[k], axis=1) for k in (400, 77)],
                   axis=0)  # fmt: skip
    assert (found <= exact + 1e-12).all()
    assert (found >= 0.9 * exact).all()
    np.testing.assert_array_equal(found[[400]], [0.5])


def test_edges_that_stay_are_halved_where_they_are_too_long():
    field = SizeField(np.array([[0.0, 0.0], [7.0, 0.0]]), np.array([1.0, np.inf]))
    points, edges = pieces_within(np.array([[0.0, 0.0], [8.0, 0.0]]), np.array([[0, 1]]), field)
    lengths = np.sort(np.abs(points[edges[:, 0], 0] - points[edges[:, 1], 0]))
    assert lengths.sum() == 8.0
    assert lengths[-1] == 4.0
    assert lengths[:-1].max() <= 1.0


def test_what_makes_no_sense_is_refused(tin, tmp_path):
    zones = write_zones(tmp_path / "z.gpkg", [(0, 100)], edge=[5.0])
    for options, match in (
        ({"longest_edge": "z - 10000"}, "longest_edge is not above 0"),
        ({"longest_edge": "z >"}, "longest_edge|no such file|cannot"),
        ({"max_area": np.ones(3)}, "max_area has the shape"),
        ({"grading": 0.0}, "grading is 0"),
        ({"grading": -1.0}, "grading is -1"),
        ({"size_field": "edge"}, "size_field goes with size_zones"),
        ({"area_field": "edge"}, "area_field goes with size_zones"),
        ({"longest_edge": "where(z > 0, 30, 40)", "shortest_edge": 20.0}, "more than half"),
        ({"longest_edge": "0.01 + 0 * z"}, "some .* nodes"),
        ({"size_zones": zones}, "longest_edge"),
    ):
        with pytest.raises((OptionError, InputFileError), match=match):
            tin.for_solver(**options)


def test_the_same_again(tin):
    first, second = (
        tin.for_solver(longest_edge="where(z > 0, 12, 60)", grading=0.5) for _ in range(2)
    )
    assert first.mesh == second.mesh


def test_the_command(dem, tmp_path, capsys):
    zones = write_zones(tmp_path / "z.gpkg", [(0, 100)], edge=[12.0])
    output = tmp_path / "a.2dm"
    words = ["simplify", dem, output, "--max-error", "8", "--longest-edge", "100",
             "--size-zones", zones, "--size-field", "edge", "--grading", ".5",
             "--json"]  # fmt: skip
    assert main([str(word) for word in words]) == 0
    figures = json.loads(capsys.readouterr().out)
    terrain = wg.open(dem)
    made = wg.simplify(terrain, max_error=8.0).for_solver(
        longest_edge=100.0, size_zones=zones, size_field="edge", grading=0.5
    )
    assert figures["n_vertices"] == made.mesh.n_vertices
    assert figures["quality"]["longest_edge"] <= 100
    words[words.index("--size-field") + 1] = "other"
    assert main([*map(str, words), "--overwrite"]) == 1
    assert "other" in capsys.readouterr().err
    words = ["simplify", dem, zones, "--max-error", "8", "--size-zones", zones, "--overwrite"]
    assert main([str(word) for word in words]) == 1
    assert "--size-field" not in capsys.readouterr().err
