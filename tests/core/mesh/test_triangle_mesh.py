"""Meshes from arrays, grids and points; what is refused, and how the refusal says to mend it."""

import numpy as np
import pytest
from helpers import assert_faces_have_area, euler_number
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import MeshError, TriangleMesh, analyse, synthetic
from wavelet_core._kernels._jit import engine
from wavelet_core.mesh import triangulation as triangulation_module
from wavelet_core.mesh.triangle_mesh import grid_faces
from wavelet_core.mesh.triangulation import canonical_faces, merge_duplicates

SQUARE = np.array([[0.0, 0, 1], [1, 0, 2], [1, 1, 3], [0, 1, 4]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])


# --- the mesh itself --------------------------------------------------------------------------


def test_arrays_are_kept_as_given():
    mesh = TriangleMesh(SQUARE, FACES, [5, 6, 7, 8], ["class"])
    np.testing.assert_array_equal(mesh.vertices, SQUARE)
    np.testing.assert_array_equal(mesh.faces, FACES)
    np.testing.assert_array_equal(mesh.attributes, [[5.0], [6], [7], [8]])
    assert mesh.attribute_names == ("class",)
    assert (mesh.vertices.dtype, mesh.faces.dtype) == (np.float64, np.int64)


def test_a_clockwise_mesh_is_turned_round():
    mesh = TriangleMesh(SQUARE, FACES[:, ::-1])
    assert (mesh.plan_areas > 0).all()


def test_from_triangles_turns_each_face():
    mesh = TriangleMesh.from_triangles(SQUARE, [[0, 1, 2], [3, 2, 0]])
    np.testing.assert_allclose(mesh.plan_areas, [0.5, 0.5])


@pytest.mark.parametrize(
    ("vertices", "faces", "attributes", "names", "message"),
    [
        (SQUARE[:, :2], FACES, None, (), "x, y, z"),
        (np.where(SQUARE == 3, np.nan, SQUARE), FACES, None, (), "vertex 2 .* not a finite"),
        (np.where(SQUARE == 4, np.inf, SQUARE), FACES, None, (), "vertex 3 .* not a finite"),
        (SQUARE, [[0, 1, 4]], None, (), "face 0 .* 0 to 3"),
        (SQUARE, [[0, 1, 2], [0, -1, 2]], None, (), "face 1 "),
        (SQUARE, [[0, 1, 2], [3, 3, 1]], None, (), "face 1 uses a vertex twice"),
        (SQUARE, [[0, 1]], None, (), r"n_faces, 3"),
        (SQUARE, [[0.0, 1.0, 2.0]], None, (), "integer"),
        (SQUARE, FACES, [1, 2, 3], (), "one row for each of 4"),
        (SQUARE, FACES, [1, 2, np.nan, 4], ("a",), "vertex 2 .* attribute"),
        (SQUARE, FACES, None, ("a",), "without attributes"),
        (SQUARE, FACES, np.ones((4, 2)), ("a", "a"), "different name"),
        (SQUARE, FACES, np.ones((4, 2)), ("a",), "different name"),
        (SQUARE, FACES, np.ones((4, 1)), ("z",), "'z' has a coordinate's name"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, faces, attributes, names, message):
    with pytest.raises(MeshError, match=message):
        TriangleMesh(vertices, faces, attributes, names)


def test_an_error_carries_the_offending_index():
    with pytest.raises(MeshError) as caught:
        TriangleMesh(SQUARE, [[0, 1, 2], [0, 2, 9]])
    assert caught.value.index == 1


@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize(
    "faces",
    [
        [[0, 1, 2], [1, 0, 3], [0, 1, 4]],  # three faces at 0-1
        [[0, 1, 2], [0, 1, 3]],  # two that run along 0-1 the same way
    ],
)
def test_an_edge_no_surface_has_is_refused_by_name(faces, signal):
    vertices = [[0, 0, 0], [1, 0, 0], [0.4, 1, 0], [0.5, -1, 0], [0.6, 1, 1]]
    with pytest.raises(MeshError, match=r"(share the edge 0-1|flipped or flat)"):
        analyse(TriangleMesh(vertices, faces), levels=1, signal=signal)


def test_a_flipped_face_is_no_tin_but_a_surface():
    vertices = [[0, 0, 0], [2, 0, 0], [1, 2, 0], [1, 0.5, 1], [1, -1, 0.5]]
    mesh = TriangleMesh(vertices, [[0, 1, 2], [1, 0, 3]])
    with pytest.raises(MeshError, match=r"face 1 .* use signal 'xyz'"):
        analyse(mesh, levels=1, signal="z")
    analyse(mesh, levels=1, signal="xyz")


@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_a_mesh_without_faces_has_no_level(signal):
    pyramid = analyse(TriangleMesh(SQUARE, np.empty((0, 3), dtype=int)), levels=3, signal=signal)
    assert pyramid.n_levels == 0
    np.testing.assert_array_equal(pyramid.mesh(0).vertices, SQUARE)


@pytest.mark.parametrize("options", [{}, {"partition": "quadric"}, {"outline_tolerance": 1.0}])
def test_a_mesh_without_vertices_is_nothing_to_analyse(options):
    """It ended in a ValueError of numpy."""
    empty = TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=int))
    with pytest.raises(MeshError, match="no vertices; there is nothing to analyse"):
        analyse(empty, **options)


# --- from_grid --------------------------------------------------------------------------------


@pytest.mark.parametrize("flip_x", [False, True])
@pytest.mark.parametrize("flip_y", [False, True])
def test_a_grid_may_run_either_way(flip_x, flip_y):
    x, y = np.array([10.0, 11, 13]), np.array([5.0, 7, 8, 9])
    elevation = np.arange(12.0).reshape(4, 3)
    mesh = TriangleMesh.from_grid(elevation, x=x[::-1] if flip_x else x, y=y[::-1] if flip_y else y)
    assert (mesh.n_vertices, mesh.n_faces) == (12, 12)
    assert (mesh.plan_areas > 0).all()
    assert mesh.plan_areas.sum() == pytest.approx(3 * 4)
    np.testing.assert_array_equal(mesh.vertices[:, 2], elevation.ravel())


@pytest.mark.parametrize("hole", [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_a_square_with_three_valid_cells_has_one_face(hole):
    valid = np.ones((2, 2), dtype=bool)
    valid[hole] = False
    mesh = TriangleMesh.from_grid(np.zeros((2, 2)), x=[0, 1], y=[1, 0], valid=valid)
    assert (mesh.n_vertices, mesh.n_faces) == (3, 1)
    assert mesh.plan_areas.sum() == pytest.approx(0.5)


def test_nan_cells_are_holes_and_attributes_follow_the_cells():
    elevation = np.arange(20.0).reshape(4, 5)
    elevation[1, 2] = np.nan
    bands = np.stack([10 * elevation, 100 * elevation], axis=-1)
    mesh = TriangleMesh.from_grid(
        elevation, x=np.arange(5), y=np.arange(4), attributes=bands, attribute_names=("a", "b")
    )
    assert mesh.n_vertices == 19
    np.testing.assert_allclose(mesh.attributes[:, 0], 10 * mesh.vertices[:, 2])
    np.testing.assert_allclose(mesh.attributes[:, 1], 100 * mesh.vertices[:, 2])
    # Four squares meet at the missing cell; each keeps the face that does not need it.
    assert mesh.n_faces == 2 * 12 - 4
    assert euler_number(mesh.n_vertices, mesh.faces) == 0


def test_cells_without_a_face_are_kept_as_isolated_vertices():
    valid = np.array([[1, 1, 0, 0], [1, 1, 0, 1]], dtype=bool)
    mesh = TriangleMesh.from_grid(np.zeros((2, 4)), x=np.arange(4), y=np.arange(2), valid=valid)
    assert (mesh.n_vertices, mesh.n_faces) == (5, 2)
    assert analyse(mesh, levels=2).vertex_ids(0)[-1] == 4


@pytest.mark.parametrize("n", [1, 2, 3])
def test_grids_of_a_single_row_or_column_have_no_face(n):
    mesh = TriangleMesh.from_grid(np.zeros((1, n)), x=np.arange(n), y=[0.0])
    assert (mesh.n_vertices, mesh.n_faces) == (n, 0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"elevation": np.zeros(4)}, "rows, columns"),
        ({"x": [0, 1]}, "give 3 finite"),
        ({"y": [0, np.nan]}, "give 2 finite"),
        ({"x": [0, 2, 1]}, "neither ascends nor descends"),
        ({"valid": np.ones((3, 2), dtype=bool)}, "valid has shape"),
        ({"valid": np.zeros((2, 3), dtype=bool)}, "no cell of the grid is valid"),
        ({"elevation": np.full((2, 3), np.nan)}, "no cell of the grid is valid"),
        ({"attributes": np.ones((3, 2))}, "attributes have shape"),
        ({"elevation": np.full((2, 3), np.nan), "valid": np.ones((2, 3), bool)}, "not a finite"),
    ],
)
def test_what_is_no_grid_is_refused(options, message):
    sound = {"elevation": np.zeros((2, 3)), "x": [0, 1, 2], "y": [0, 1]}
    with pytest.raises(MeshError, match=message):
        TriangleMesh.from_grid(**(sound | options))


def test_a_grid_with_many_holes_has_sound_faces():
    mesh = grid_with_holes(40, 50, hole_share=0.4, seed=8)
    assert_faces_have_area(mesh, in_plan=True)


# --- from_points ------------------------------------------------------------------------------


def test_the_engines_give_a_grid_the_same_faces():
    rng = np.random.default_rng(4)
    for shape in ((1, 1), (1, 5), (7, 1), (9, 13)):
        valid = rng.random(shape) < 0.7
        for clockwise in (False, True):
            by_engine = []
            for name in ("loops", "arrays"):
                with engine(name):
                    by_engine.append(grid_faces(valid, clockwise))
            np.testing.assert_array_equal(*by_engine)
    counts = [
        len(grid_faces(np.array(v, bool).reshape(2, 2), False)) for v in np.ndindex(2, 2, 2, 2)
    ]
    assert counts == [max(sum(v) - 2, 0) for v in np.ndindex(2, 2, 2, 2)]


def test_points_in_any_order_are_all_used():
    rng = np.random.default_rng(0)
    points = rng.random((500, 3)) + np.array([5e5, 6e6, 100])
    mesh = TriangleMesh.from_points(points, rng.random((500, 2)), ("a", "b"))
    np.testing.assert_array_equal(mesh.vertices, points)
    assert_faces_have_area(mesh, in_plan=True)
    assert set(mesh.faces.ravel()) == set(range(500))
    assert euler_number(500, mesh.faces) == 1


def test_the_triangulation_is_delaunay():
    """No vertex lies within the circumcircle of a face."""
    rng = np.random.default_rng(1)
    mesh = TriangleMesh.from_points(rng.random((80, 3)))
    for face in mesh.faces:
        a, b, c = mesh.vertices[face, :2]
        matrix = 2 * np.array([b - a, c - a])
        centre = a + np.linalg.solve(matrix, [np.sum((b - a) ** 2), np.sum((c - a) ** 2)])
        radius = np.linalg.norm(a - centre)
        distance = np.linalg.norm(mesh.vertices[:, :2] - centre, axis=1)
        assert distance.min() >= radius * (1 - 1e-9)


def test_of_duplicates_the_lowest_is_kept_and_of_equal_ones_the_first():
    points = np.array([[0, 0, 3], [1, 0, 1], [0, 0, 2], [0, 1, 5], [1, 0, 1], [0, 0, 2]], float)
    merged = merge_duplicates(points)
    np.testing.assert_array_equal(merged.kept, [1, 2, 3])
    np.testing.assert_array_equal(merged.representative, [1, 0, 1, 2, 0, 1])
    mesh = TriangleMesh.from_points(points, np.arange(6), ("id",))
    np.testing.assert_array_equal(mesh.attributes[:, 0], [1, 2, 3])


def test_points_quantised_to_a_grid_are_triangulated():
    """LiDAR is quantised to a centimetre: many points are cocircular and collinear."""
    rng = np.random.default_rng(2)
    points = np.column_stack([rng.integers(0, 60, (2000, 2)) * 0.01, rng.random(2000)])
    points[:, :2] += [650000.0, 5017000.0]
    mesh = TriangleMesh.from_points(points)
    assert mesh.n_vertices == len(np.unique(points[:, :2], axis=0))
    assert set(mesh.faces.ravel()) == set(range(mesh.n_vertices))
    assert_faces_have_area(mesh, in_plan=True)


@pytest.mark.parametrize(
    "points",
    [
        np.empty((0, 3)),
        [[0, 0, 0]],
        [[0, 0, 0], [1, 1, 1]],
        [[0, 0, 0], [0, 0, 1], [0, 0, 2], [1, 1, 1]],
        [[k, 2 * k, k * k] for k in range(10)],
        [[5e5 + 0.1 * k, 6e6 + 0.3 * k, k * k] for k in range(10)],
    ],
    ids=["none", "one", "two", "two different", "collinear", "collinear far away"],
)
def test_points_that_span_no_area_are_refused(points):
    with pytest.raises(MeshError, match=r"three|3|line"):
        TriangleMesh.from_points(points)


def test_points_with_nan_are_refused_by_row():
    with pytest.raises(MeshError, match="vertex 1 "):
        TriangleMesh.from_points([[0, 0, 0], [np.nan, 1, 1], [1, 0, 0], [0, 1, 0]])


def test_meshes_are_equal_by_their_values():
    """`==` raised, as it compared arrays to one another."""
    one, same = synthetic.hills(5, 6), synthetic.hills(5, 6)
    assert (one == same) is True
    assert (one != same) is False
    assert one != synthetic.hills(6, 5)
    named = TriangleMesh(one.vertices, one.faces, one.vertices[:, :1], ["a"])
    assert named != one
    assert named != TriangleMesh(one.vertices, one.faces, one.vertices[:, :1], ["b"])
    assert one != "a mesh"
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)


def test_a_mesh_says_in_one_line_what_it_is():
    mesh = synthetic.hills(40, 50)
    assert repr(mesh) == "<TriangleMesh 2,000 vertices, 3,822 faces>"
    attributes = np.zeros((3, 2))
    small = TriangleMesh(SQUARE[:3], [[0, 1, 2]], attributes, ["intensity", "class"])
    assert repr(small) == "<TriangleMesh 3 vertices, 1 face, intensity + class>"


def test_the_arrays_of_the_caller_stay_his_own():
    vertices = np.array(SQUARE, dtype=np.float64)
    faces = np.array([[0, 1, 2]], dtype=np.int64)
    attributes = np.zeros((len(vertices), 1))
    for make in (TriangleMesh, TriangleMesh.from_triangles):
        mesh = make(vertices, faces, attributes)
        for mine, ours in ((vertices, mesh.vertices), (faces, mesh.faces)):
            assert mine.flags.writeable
            assert not ours.flags.writeable
            assert not np.shares_memory(mine, ours)
        assert attributes.flags.writeable
        assert not np.shares_memory(attributes, mesh.attributes)
    points = TriangleMesh.from_points(vertices)
    assert vertices.flags.writeable
    assert not np.shares_memory(vertices, points.vertices)
    elevation, x = np.zeros((3, 3)), np.arange(3.0)
    grid = TriangleMesh.from_grid(elevation, x=x, y=x)
    assert elevation.flags.writeable
    assert x.flags.writeable
    assert not np.shares_memory(elevation, grid.vertices)


def test_faces_in_their_one_order_and_merged_points_are_those_of_a_full_sort():
    rng = np.random.default_rng(3)
    for faces in (
        random_delaunay(500, seed=5).faces,
        rng.permuted(np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4], [5, 0, 1]]), axis=0),
        np.empty((0, 3), dtype=np.int64),
    ):
        shuffled = np.array([np.roll(face, k % 3) for k, face in enumerate(faces)]).reshape(-1, 3)
        turned = [tuple(np.roll(face, -int(np.argmin(face)))) for face in shuffled]
        expected = np.array(sorted(turned), dtype=np.int64).reshape(-1, 3)
        np.testing.assert_array_equal(canonical_faces(shuffled.astype(np.int32)), expected)
    points = rng.integers(0, 6, (200, 3)).astype(float)
    for rule, sign in (("lowest", 1.0), ("highest", -1.0), ("first", 0.0)):
        best = {}
        for row, (x, y, z) in enumerate(points):
            best[x, y] = min(best.get((x, y), (np.inf, 0)), (sign * z, row))
        kept, representative = merge_duplicates(points, rule)
        assert kept.tolist() == sorted(row for _, row in best.values())
        assert [best[x, y][1] for x, y, _ in points] == kept[representative].tolist()


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_points_of_one_place_are_found_whatever_their_share(share):
    """Both zeros are one place; places that only look alike in one coordinate are not."""
    rng = np.random.default_rng(8)
    points = rng.normal(size=(70_000, 3))  # more than a block
    points[:, 0] = np.round(points[:, 0], 2)
    doubled = rng.random(len(points)) < share
    points[doubled, :2] = np.round(points[doubled, :2], 1)
    points[:4, :2] = [[0.0, -0.0], [-0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]
    kept, representative = merge_duplicates(points, "first")
    _, first, place = np.unique(points[:, :2] + 0.0, axis=0, return_index=True, return_inverse=True)
    np.testing.assert_array_equal(kept, np.sort(first))
    np.testing.assert_array_equal(kept[representative], first[place.ravel()])
    assert representative[0] == representative[1]


def test_the_faces_left_out_are_those_of_the_library():
    pythoncdt = pytest.importorskip("pythoncdt")
    plan = np.random.default_rng(4).integers(0, 200, (3000, 2)).astype(float)
    plan = np.unique(plan, axis=0)
    triangulation = pythoncdt.Triangulation(
        pythoncdt.VertexInsertionOrder.AUTO,
        pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED,
        0.0,
    )
    triangulation.insert_vertices(plan)
    triangulation.erase_super_triangle()
    expected = triangulation.triangles_array(copy=True)["vertices"]
    faces = triangulation_module._cdt_faces(pythoncdt, plan, None)
    np.testing.assert_array_equal(faces, expected)
