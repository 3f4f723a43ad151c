"""Meshes for solvers: bounds on angles, edges and areas, the outline and the lines kept."""

import builtins
import json

import numpy as np
import pyogrio
import pytest
import shapely
from gis.samples import UTM, hills, write_tif

import wavelet_gis as wg
from wavelet_core import Cancelled, TriangleMesh
from wavelet_core.errors import MissingDependencyError, OptionError
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.location import surface_errors
from wavelet_gis.cli.main import main
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.workflows.solver.quality import quality_of
from wavelet_gis.workflows.solver.solver_mesh import SolverRules, solver_mesh

pytest.importorskip("CGAL")

X, Y = 500000.0, 5100000.0


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    return write_tif(tmp_path_factory.mktemp("dem") / "dem.tif", hills(40, 50))


@pytest.fixture(scope="module")
def tin(dem):
    return wg.simplify(wg.open(dem), max_error=3.0)


def angles_of(mesh):
    """Return all angles in degrees, by the turn from one side to the next."""
    corners = mesh.vertices[mesh.faces][:, :, :2]
    found = []
    for k in range(3):
        u = corners[:, (k + 1) % 3] - corners[:, k]
        v = corners[:, (k + 2) % 3] - corners[:, k]
        turn = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1))
        found.append(np.degrees(turn))
    return np.array(found)


def edges_of(mesh):
    sides = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(sides, axis=0)


def require_sound(made, terrain):
    mesh = made.mesh
    build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    assert mesh.plan_areas.min() > 0
    assert mesh.plan_areas.sum() == pytest.approx(terrain.mesh.plan_areas.sum())
    errors = surface_errors(terrain.mesh, mesh.vertices)
    assert np.nanmax(np.abs(errors)) < 1e-6, "nodes lie on the terrain"
    assert np.isnan(errors).sum() < 0.02 * mesh.n_vertices  # on the outline, by rounding
    known = made.vertex_ids >= 0
    np.testing.assert_array_equal(
        mesh.vertices[known], terrain.mesh.vertices[made.vertex_ids[known]]
    )


@pytest.mark.parametrize("min_angle", [0.0, 15.0, 20.7, 28.0])
def test_the_smallest_angle_holds_and_so_does_the_tolerance(tin, min_angle):
    made = tin.for_solver(min_angle=min_angle)
    require_sound(made, tin.terrain)
    assert angles_of(made.mesh).min() >= min_angle - 1e-6
    assert made.quality.smallest_angle == pytest.approx(angles_of(made.mesh).min(), abs=1e-6)
    errors = np.abs(surface_errors(made.mesh, tin.terrain.mesh.vertices))
    assert np.nanmax(errors) <= 3.0 + 1e-6
    assert made.errors.max_error == pytest.approx(np.nanmax(errors))
    assert made.mesh.n_vertices < 0.7 * tin.terrain.mesh.n_vertices


def test_edges_and_areas_hold(tin):
    made = tin.for_solver(min_angle=20.0, longest_edge=40.0)
    require_sound(made, tin.terrain)
    ends = made.mesh.vertices[edges_of(made.mesh), :2]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    assert lengths.max() <= 40.0 + 1e-9
    assert made.quality.longest_edge == pytest.approx(lengths.max())
    small = tin.for_solver(min_angle=20.0, max_area=200.0)
    assert small.mesh.plan_areas.max() <= 200.0 + 1e-9


def test_vertices_of_the_tin_are_no_nearer_than_the_shortest_edge(dem):
    tin = wg.simplify(wg.open(dem), vertices=500)
    made = tin.for_solver(min_angle=20.0, shortest_edge=30.0)
    ids = made.vertex_ids[made.vertex_ids >= 0]
    kept = tin.terrain.mesh.vertices[ids, :2]
    x, y = kept.T
    on_outline = (x == x.min()) | (x == x.max()) | (y == y.min()) | (y == y.max())
    apart = np.linalg.norm(kept[:, None] - kept[None], axis=2) + np.diag(np.full(len(kept), 1e9))
    assert apart[~on_outline].min() >= 30.0
    assert len(ids) < 500


def test_points_that_become_nodes_are_apart_from_each_other_too(dem):
    """New ones were held against the nodes there were, not against each other."""
    tin = wg.simplify(wg.open(dem), max_error=0.5)
    with pytest.warns(TerrainWarning, match="nodes would be too near"):
        made = tin.for_solver(min_angle=20.0, shortest_edge=25.0)
    ids = made.vertex_ids[made.vertex_ids >= 0]
    kept = tin.terrain.mesh.vertices[ids, :2]
    x, y = kept.T
    inner = (x > x.min()) & (x < x.max()) & (y > y.min()) & (y < y.max())
    apart = np.linalg.norm(kept[:, None] - kept[None], axis=2) + np.diag(np.full(len(kept), 1e9))
    assert apart[inner].min() >= 25.0


def test_new_nodes_count_for_no_zone(dem):
    """Their id -1 was taken for the last point of the input."""
    terrain = wg.open(dem)
    limits = np.full(terrain.mesh.n_vertices, 3.0)
    limits[-1] = 2.0
    made = wg.simplify(terrain, max_error=limits).for_solver()
    known = np.unique(made.vertex_ids[made.vertex_ids >= 0])
    assert sum(zone.n_vertices for zone in made.zones) == len(known)


def test_a_long_list_of_short_edges_is_made(tin):
    """40 times the nodes of the TIN were the most, whatever the longest edge asked for."""
    flat = TriangleMesh([[0, 0, 0], [90, 0, 0], [90, 90, 0], [0, 90, 0]], [[0, 1, 2], [0, 2, 3]])
    made = solver_mesh(flat, np.arange(4), flat, SolverRules(20.0, longest_edge=0.5))
    assert made.mesh.n_vertices > 40_000


def test_a_building_stays_a_hole_and_a_dike_stays_an_edge(dem, tmp_path):
    dike = shapely.LineString([(X + 40, Y - 60), (X + 200, Y - 210), (X + 440, Y - 350)])
    building = shapely.box(X + 300, Y - 150, X + 330, Y - 120)
    domain = shapely.box(X + 10, Y - 390, X + 490, Y - 10).difference(building)
    paths = {}
    for name, shape in (("breaklines", dike), ("clip", domain)):
        paths[name] = tmp_path / f"{name}.gpkg"
        pyogrio.raw.write(
            paths[name], shapely.to_wkb(np.array([shape])), [], [],
            geometry_type=shape.geom_type, crs=UTM,
        )  # fmt: skip
    terrain = wg.open(dem, **paths)
    tin = wg.simplify(terrain, max_error=2.0)
    made = tin.for_solver(min_angle=25.0)
    mesh = tin.geo.file_mesh(made.mesh)
    assert made.mesh.plan_areas.sum() == pytest.approx(domain.area, rel=1e-9)
    centres = shapely.points(mesh.vertices[mesh.faces].mean(axis=1)[:, :2])
    assert not shapely.contains(building, centres).any()
    ends = shapely.linestrings(mesh.vertices[edges_of(made.mesh), :2])
    along = shapely.contains_properly(dike.buffer(1e-6), ends)
    assert shapely.length(ends[along]).sum() == pytest.approx(dike.length, rel=1e-6)
    small = angles_of(made.mesh) < 25.0 - 1e-6
    corners = shapely.points(mesh.vertices[mesh.faces.T][..., :2])
    near_corner = shapely.distance(
        corners, shapely.multipoints(shapely.get_coordinates([dike, domain]))
    )
    assert (near_corner[small] < 15.0).all(), "only where given edges meet"
    assert made.along_lines.max_error <= 2.0 + 1e-6


def test_zones_are_told_of_again(dem, tmp_path):
    terrain = wg.open(dem)
    limits = np.where(terrain.mesh.vertices[:, 0] < np.median(terrain.mesh.vertices[:, 0]), 1, 6)
    made = wg.simplify(terrain, max_error=limits.astype(float)).for_solver()
    assert [zone.least for zone in made.zones] == [1.0, 6.0]
    assert all(zone.max_error <= zone.most + 1e-6 for zone in made.zones)


def test_the_same_again(tin):
    first, second = (tin.for_solver(min_angle=25.0) for _ in range(2))
    assert first.mesh == second.mesh


def test_what_no_mesh_can_have_is_refused(tin):
    for options in (
        {"min_angle": 31.0}, {"min_angle": -1.0}, {"min_angle": np.nan}, {"longest_edge": 0.0},
        {"max_area": -2.0}, {"shortest_edge": np.inf}, {"shortest_edge": 30, "longest_edge": 40},
        {"shortest_edge": 30, "max_area": 100.0}, {"longest_edge": 0.05},
    ):  # fmt: skip
        with pytest.raises(OptionError):
            tin.for_solver(**options)


def test_it_stops_when_told_to(tin):
    with pytest.raises(Cancelled):
        tin.for_solver(progress=lambda fraction: False)


def test_without_cgal_the_remedy_is_named(tin, monkeypatch):
    find = builtins.__import__

    def without(name, *arguments, **others):
        if name == "CGAL":
            raise ImportError(name)
        return find(name, *arguments, **others)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingDependencyError, match="pip install cgal"):
        tin.for_solver()


def test_the_command(dem, tmp_path, capsys):
    output = tmp_path / "a.2dm"
    words = ["simplify", str(dem), str(output), "--max-error", "3", "--min-angle", "25", "--json"]
    assert main(words) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["quality"]["smallest_angle"] >= 25 - 1e-6
    assert figures["max_error"] <= 3.0 + 1e-6
    assert output.read_text().count("E3T") == figures["n_triangles"]


def test_the_command_refuses_before_the_work(dem, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("wavelet_gis.workflows.simplify.core_analyse", None)
    words = ["simplify", str(dem), str(tmp_path / "a.2dm"), "--max-error", "3"]
    assert main([*words, "--min-angle", "45"]) == 1
    assert "--min-angle is 45" in capsys.readouterr().err


def test_quality_of_triangles_drawn_by_hand():
    mesh = TriangleMesh([[0, 0, 5], [4, 0, 1], [0, 3, 2], [4, 3, 0]], [[0, 1, 2], [1, 3, 2]])
    quality = quality_of(mesh)
    assert quality.smallest_angle == pytest.approx(np.degrees(np.arctan2(3, 4)))
    assert quality.largest_angle == pytest.approx(90.0)
    assert quality[2:] == (3.0, 5.0, 6.0, 6.0)
    halved = quality_of(mesh, 2.0)
    assert halved[2:] == (1.5, 2.5, 1.5, 1.5)


def test_an_island_in_a_lake_is_meshed_and_the_lake_is_not():
    points = [[0, 0], [9, 0], [9, 9], [0, 9], [3, 3], [6, 3], [6, 6], [3, 6],
              [4, 4], [5, 4], [5, 5], [4, 5]]  # fmt: skip
    ring = [[k, (k + 1) % 4, 4 + k] for k in range(4)] + [
        [(k + 1) % 4, 4 + (k + 1) % 4, 4 + k] for k in range(4)
    ]
    island = [[8, 9, 10], [8, 10, 11]]
    mesh = TriangleMesh(np.column_stack([points, np.zeros(12)]), ring + island)
    made = solver_mesh(mesh, np.arange(12), mesh, SolverRules(20.0))
    assert made.mesh.plan_areas.sum() == pytest.approx(81 - 9 + 1)
    assert angles_of(made.mesh).min() >= 20.0 - 1e-6
    assert made.n_removed == 0
