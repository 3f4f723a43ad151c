"""The pyramid's answers fit one another; parts that are none are refused; errors are told."""

import dataclasses
from itertools import pairwise

import helpers
import numpy as np
import pytest
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import (
    Cancelled,
    OptionError,
    Pyramid,
    PyramidError,
    TriangleMesh,
    WaveletError,
    analyse,
    synthetic,
)


@pytest.fixture(scope="module", params=["z", "xyz"])
def pyramid(request):
    mesh = random_delaunay(200, n_attributes=2, seed=3)
    return analyse(mesh, levels=5, partition="quadric", prediction="GLMN", signal=request.param)


def parts_of(pyramid):
    fields = dataclasses.fields(Pyramid)
    return {
        field.name: getattr(pyramid, field.name)
        for field in fields
        if field.name not in ("part", "measured", "kept_record", "coarse_faces")
    }


# --- answers ----------------------------------------------------------------------------------


def test_counts_ids_and_orders_fit(pyramid):
    ids = pyramid.vertex_ids(pyramid.n_levels)
    np.testing.assert_array_equal(ids, np.arange(200))
    for level in reversed(range(pyramid.n_levels)):
        pair, detail = pyramid.filters(level), pyramid.detail(level)
        np.testing.assert_array_equal(detail.vertex_ids, ids[pair.odd])
        ids = ids[pair.even]
        np.testing.assert_array_equal(pyramid.vertex_ids(level), ids)
        mesh = pyramid.mesh(level)
        assert mesh.n_vertices == len(ids) == pyramid.n_vertices(level)
        assert mesh.n_faces == pyramid.n_faces(level)
        assert detail.vectors.shape == (len(pair.odd), len(pyramid.channels))
        np.testing.assert_allclose(detail.magnitude, np.linalg.norm(detail.vectors, axis=1))
        np.testing.assert_array_equal(detail.positions, pyramid.mesh(level + 1).vertices[pair.odd])
        assert (pyramid.integrals(level) >= 1).all()


def test_channels_and_names(pyramid):
    leading = ("z",) if pyramid.signal == "z" else ("x", "y", "z")
    assert pyramid.channels == (*leading, "class", "intensity")
    assert pyramid.attribute_names == ("class", "intensity")
    assert pyramid.mesh(0).attribute_names == ("class", "intensity")


def test_the_finest_mesh_shares_the_faces_of_its_input():
    mesh = random_delaunay(200, n_attributes=1, seed=3)
    pyramid = analyse(mesh)
    finest = pyramid.finest_on(mesh)
    assert finest == pyramid.synthesise() != pyramid.mesh(0)
    assert finest.faces is mesh.faces


@pytest.mark.parametrize("update", ["none", "minimum_norm"])
def test_faces_that_the_analysis_kept_are_those_that_the_collapses_leave(update):
    for mesh in (random_delaunay(300, seed=4), grid_with_holes(20, 23, seed=2, hole_share=0.1)):
        pyramid = analyse(mesh, update=update, target_vertices=40)
        followed = dataclasses.replace(pyramid, coarse_faces=None)
        assert pyramid.coarse_faces is not None
        assert pyramid.mesh(0) == followed.mesh(0)
        assert pyramid.denoised(0.1).mesh(0).n_faces == followed.n_faces(0)


def test_meshes_and_details_in_one_pass_are_those_asked_for_one_by_one(pyramid):
    meshes = list(pyramid)
    assert len(meshes) == len(pyramid) == pyramid.n_levels + 1
    for level, mesh in enumerate(meshes):
        helpers.assert_same_mesh(mesh, pyramid.mesh(level), relative=0)
        helpers.assert_same_mesh(mesh, pyramid[level], relative=0)
        helpers.assert_same_mesh(mesh, pyramid[level - len(pyramid)], relative=0)
    for level, detail in pyramid.details():
        np.testing.assert_array_equal(detail.vectors, pyramid.detail(level).vectors)
        np.testing.assert_array_equal(detail.positions, pyramid.detail(level).positions)


def test_with_signal_z_every_vertex_keeps_its_x_and_y():
    mesh = grid_with_holes(12, 12, seed=1, offset=1e6)
    pyramid = analyse(mesh, levels=6, partition="quadric", signal="z")
    for level in range(pyramid.n_levels + 1):
        kept = mesh.vertices[pyramid.vertex_ids(level), :2]
        np.testing.assert_array_equal(pyramid.mesh(level).vertices[:, :2], kept)


def test_all_channels_are_lifted_together():
    """Where the partition looks at x and y alone, no channel changes the lifting of another."""
    mesh = random_delaunay(100, n_attributes=2, seed=5)
    options = {"levels": 3, "partition": "random", "prediction": "UG", "update": "MN"}
    both = analyse(mesh, **options)
    alone = analyse(TriangleMesh(mesh.vertices, mesh.faces), **options)
    np.testing.assert_array_equal(both.mesh(0).vertices, alone.mesh(0).vertices)
    swapped = TriangleMesh(
        np.column_stack([mesh.vertices[:, :2], mesh.attributes[:, 1]]), mesh.faces
    )
    np.testing.assert_allclose(
        both.mesh(0).attributes[:, 1], analyse(swapped, **options).mesh(0).vertices[:, 2]
    )


def test_no_levels():
    mesh = random_delaunay(30, seed=1)
    pyramid = analyse(mesh, levels=0)
    assert pyramid.n_levels == 0
    helpers.assert_same_mesh(pyramid.synthesise(), mesh, relative=0)


# --- levels that are not there ----------------------------------------------------------------


@pytest.mark.parametrize("level", [-1, 6, 99, 1.5, float("nan")])
@pytest.mark.parametrize(
    "question", ["mesh", "n_vertices", "n_faces", "vertex_ids", "integrals", "synthesise"]
)
def test_a_level_that_is_not_there(pyramid, question, level):
    with pytest.raises(PyramidError, match=f"no level {level}; the levels are 0 to 5"):
        getattr(pyramid, question)(level)


@pytest.mark.parametrize("level", [-1, 5, 1.5])
@pytest.mark.parametrize("question", ["detail", "filters"])
def test_a_step_that_is_not_there(pyramid, question, level):
    with pytest.raises(PyramidError, match=f"no details at level {level}; they are at 0 to 4"):
        getattr(pyramid, question)(level)


def test_a_gain_of_a_level_between_two_is_refused(pyramid):
    """It was taken, and changed nothing."""
    with pytest.raises(OptionError, match=r"no details at level 1\.5; they are at 0 to 4"):
        pyramid.with_gains({1.5: 0.0})


def test_a_pyramid_without_levels_has_no_details():
    """They were said to be at 0 to -1."""
    flat = analyse(random_delaunay(30, seed=1), levels=0)
    with pytest.raises(PyramidError, match="no details at level 0; this pyramid has none"):
        flat.detail(0)
    with pytest.raises(OptionError, match="no details at level 0; this pyramid has none"):
        flat.with_gains({0: 2.0})


# --- parts from strangers ---------------------------------------------------------------------


def test_sound_parts_make_the_same_pyramid(pyramid):
    again = Pyramid.from_parts(**parts_of(pyramid))
    helpers.assert_same_mesh(again.synthesise(), pyramid.synthesise(), relative=0)


def with_step(parts, level=1, **changes):
    steps = list(parts["steps"])
    steps[level] = dataclasses.replace(steps[level], **changes)
    return parts | {"steps": tuple(steps)}


def altered(array, index, value):
    array = np.array(array)
    array[index] = value
    return array


FAULTS = {
    "a signal of another name": lambda p, s: p | {"signal": "xy"},
    "an update of another name": lambda p, s: p | {"update": "median"},
    "channels that do not begin with z": lambda p, s: p | {"channels": ("a", *p["channels"][1:])},
    "a channel twice": lambda p, s: p | {"channels": (*p["channels"][:-1], p["channels"][-2])},
    "a channel too many": lambda p, s: p | {"channels": (*p["channels"], "b")},
    "coarse coefficients with NaN": lambda p, s: (
        p | {"coarse": altered(p["coarse"], (0, 0), np.nan)}
    ),
    "too few coarse coefficients": lambda p, s: p | {"coarse": p["coarse"][:-1]},
    "coarse coefficients of one dimension": lambda p, s: p | {"coarse": p["coarse"][:, 0]},
    "a face out of range": lambda p, s: p | {"faces": altered(p["faces"], (0, 0), 200)},
    "a negative face": lambda p, s: p | {"faces": altered(p["faces"], (0, 0), -1)},
    "faces of fractions": lambda p, s: p | {"faces": p["faces"] + 0.4},
    "odd vertices of fractions": lambda p, s: with_step(p, odd=s.odd + 0.4),
    "columns of fractions": lambda p, s: with_step(p, indices=s.indices + 0.4),
    "row pointers of fractions": lambda p, s: with_step(p, indptr=s.indptr * 1.0),
    "faces of another shape": lambda p, s: p | {"faces": p["faces"][:, :2]},
    "a face with a vertex twice": lambda p, s: (
        p | {"faces": altered(p["faces"], (0, 0), p["faces"][0, 1])}
    ),
    "a locked mask of another length": lambda p, s: p | {"locked": np.zeros(3, bool)},
    "an odd vertex twice": lambda p, s: with_step(p, odd=altered(s.odd, 0, s.odd[1])),
    "an odd vertex out of range": lambda p, s: with_step(p, odd=altered(s.odd, 0, 10_000)),
    "a negative odd vertex": lambda p, s: with_step(p, odd=altered(s.odd, 0, -1)),
    "an odd target": lambda p, s: with_step(p, target=altered(s.target, 0, s.odd[1])),
    "a target out of range": lambda p, s: with_step(p, target=altered(s.target, 0, 10_000)),
    "a target too few": lambda p, s: with_step(p, target=s.target[:-1]),
    "a column out of range": lambda p, s: with_step(p, indices=altered(s.indices, 0, 10_000)),
    "a negative column": lambda p, s: with_step(p, indices=altered(s.indices, 0, -1)),
    "row pointers that fall": lambda p, s: with_step(p, indptr=altered(s.indptr, 1, 10_000)),
    "row pointers that start late": lambda p, s: with_step(p, indptr=altered(s.indptr, 0, 1)),
    "a weight of NaN": lambda p, s: with_step(p, weights=altered(s.weights, 0, np.nan)),
    "a weight too few": lambda p, s: with_step(p, weights=s.weights[:-1]),
    "an infinite detail": lambda p, s: with_step(p, details=altered(s.details, (0, 0), np.inf)),
    "a detail too few": lambda p, s: with_step(p, details=s.details[:-1]),
    "a channel of details too few": lambda p, s: with_step(p, details=s.details[:, 1:]),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_parts_of_no_pyramid_are_refused(pyramid, fault):
    parts = FAULTS[fault](parts_of(pyramid), pyramid.steps[1])
    with pytest.raises(PyramidError):
        Pyramid.from_parts(**parts)


def test_x_and_y_must_be_there_exactly_when_they_are_not_lifted(pyramid):
    parts = parts_of(pyramid)
    wrong = None if pyramid.signal == "z" else np.zeros((200, 2))
    with pytest.raises(PyramidError):
        Pyramid.from_parts(**(parts | {"horizontal": wrong}))


# --- options ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"levels": -1}, "levels is -1; give a whole number from 0 to 1000"),
        ({"partition": "best"}, "partition is 'best'; give one of .*quadric"),
        ({"prediction": "best"}, r"prediction is 'best'; give one of .*geometric \(GL\)"),
        ({"prediction": "GLXX"}, "prediction is 'GLXX'"),
        ({"update": "best"}, r"update is 'best'; give one of .*minimum_norm \(MN\)"),
        ({"signal": "xy"}, "signal is 'xy'; give one of z, xyz"),
        ({"target_vertices": 2}, "target_vertices is 2"),
        ({"max_error": -1.0}, "max_error is -1.0"),
        ({"max_rms": np.nan}, "max_rms is nan"),
        ({"attribute_weights": (1.0,)}, "give 2 numbers"),
        ({"attribute_weights": (1.0, -1.0)}, "give 2 numbers"),
        ({"bending_weight": -0.1, "partition": "quadric"}, "bending_weight is -0.1"),
        ({"bending_weight": np.inf, "partition": "quadric"}, "bending_weight is inf"),
        ({"locked": [True, False]}, "locked has shape .* 30 vertices"),
        ({"locked": np.zeros(30, dtype=int)}, "locked has .* one bool"),
    ],
)
def test_an_option_that_has_no_meaning_is_refused(options, message):
    mesh = random_delaunay(30, n_attributes=2, seed=1)
    with pytest.raises(OptionError, match=message) as caught:
        analyse(mesh, **options)
    assert isinstance(caught.value, WaveletError)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("prediction", ["GLMN", "glmn", "GL"])
def test_short_names_and_joined_designs(prediction):
    pyramid = analyse(random_delaunay(30, seed=1), levels=1, prediction=prediction, update="MN")
    assert pyramid.parameters["prediction"] == "geometric"
    assert pyramid.parameters["update"] == pyramid.update == "minimum_norm"


def test_parameters_are_plain_and_complete():
    import json

    pyramid = analyse(random_delaunay(30, n_attributes=1, seed=1), levels=2, signal="xyz")
    told = json.loads(json.dumps(dict(pyramid.parameters)))
    assert told["signal"] == "xyz"
    assert {"levels", "partition", "prediction", "update", "attribute_weights"} <= told.keys()


# --- stop rules -------------------------------------------------------------------------------


def test_levels_is_a_maximum_and_as_many_by_default_as_the_partition_wants():
    mesh = synthetic.hills(40, 40)
    assert analyse(mesh, levels=3).n_levels == 3
    assert analyse(mesh).n_levels == 24
    assert analyse(mesh, prediction="GLMN").n_levels == 12  # the paper's experiments
    assert analyse(mesh, levels=500).n_levels < 500
    assert analyse(synthetic.hills(40, 40), partition="quadric").n_levels == 12


@pytest.mark.parametrize("signal", ["z", "xyz"])
@pytest.mark.parametrize("target", [1600, 1599, 700, 100])
def test_target_vertices_is_met_exactly_where_it_can_be(target, signal):
    pyramid = analyse(
        synthetic.hills(40, 40), target_vertices=target, partition="quadric", signal=signal
    )
    assert pyramid.n_vertices(0) == target


@pytest.mark.parametrize(("rule", "limit"), [("max_error", 5.0), ("max_rms", 1.0)])
def test_no_level_is_above_the_tolerance_and_the_next_would_be(rule, limit):
    from wavelet_core.accuracy.level_errors import level_errors

    mesh = synthetic.hills(40, 40)
    figure = {"max_error": "max_error_surface", "max_rms": "rmse_surface"}[rule]
    pyramid = analyse(mesh, **{rule: limit}, partition="quadric")
    errors = [getattr(row, figure) for row in level_errors(pyramid)]
    assert 0 < max(errors) <= limit
    one_more = analyse(mesh, levels=pyramid.n_levels + 1, partition="quadric")
    assert getattr(level_errors(one_more)[0], figure) > limit


# --- progress ---------------------------------------------------------------------------------


def test_progress_runs_from_0_to_1_and_never_back():
    seen = []
    analyse(synthetic.hills(30, 30), levels=6, progress=seen.append)
    assert seen[0] == 0.0
    assert seen[-1] == 1.0
    assert all(a <= b for a, b in pairwise(seen))
    assert len(seen) > 6


@pytest.mark.parametrize("calls", [1, 2, 7])
def test_a_progress_that_returns_false_cancels(calls):
    left = [calls]

    def progress(fraction):
        left[0] -= 1
        return left[0] > 0

    with pytest.raises(Cancelled):
        analyse(synthetic.hills(30, 30), levels=6, progress=progress)
    assert left[0] == 0


def test_a_progress_that_returns_nothing_goes_on():
    assert analyse(synthetic.hills(10, 10), levels=2, progress=lambda _: None).n_levels == 2


def test_an_error_in_progress_is_passed_on():
    def progress(fraction):
        raise KeyError(fraction)

    with pytest.raises(KeyError):
        analyse(synthetic.hills(10, 10), progress=progress)


# --- a sequence of meshes, a value, a line ------------------------------------------------------


def test_a_pyramid_is_a_sequence_of_meshes_the_coarsest_first(pyramid):
    assert pyramid.n_levels == 5
    assert len(pyramid) == 6
    sizes = [mesh.n_vertices for mesh in pyramid]
    assert sizes == sorted(sizes) == [pyramid.n_vertices(level) for level in range(6)]
    assert pyramid[0] == pyramid[-6] == pyramid.mesh(0)
    assert pyramid[-1] == pyramid[np.int64(5)] == pyramid.synthesise()


@pytest.mark.parametrize("level", [6, -7, 99])
def test_a_level_that_the_sequence_does_not_have(pyramid, level):
    with pytest.raises(PyramidError, match=f"no level {level}; the levels are 0 to 5") as caught:
        pyramid[level]
    assert caught.value.level == level


@pytest.mark.parametrize("level", [0.5, "0", slice(2)])
def test_a_level_is_a_whole_number(pyramid, level):
    with pytest.raises(TypeError):
        pyramid[level]


def test_errors_are_those_of_the_levels_the_coarsest_first(pyramid):
    from wavelet_core.metrics import level_errors

    fractions = []
    rows = pyramid.errors(fractions.append)
    assert rows == level_errors(pyramid)
    assert [row.level for row in rows] == list(range(6))
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_pyramids_are_equal_by_their_values(pyramid):
    """`==` raised, as it compared arrays to one another."""
    again = Pyramid.from_parts(**parts_of(pyramid))
    assert (pyramid == again) is True
    assert (pyramid != again) is False
    assert pyramid != pyramid.with_gains({0: 2.0})
    assert pyramid != "a pyramid"
    assert pyramid.steps[0] == again.steps[0]
    assert pyramid.detail(0) == again.detail(0)
    assert pyramid.detail(0) != pyramid.detail(1)
    for one in (pyramid, pyramid.steps[0], pyramid.detail(0)):
        with pytest.raises(TypeError, match="unhashable"):
            hash(one)


def test_each_says_in_one_line_what_it_is(pyramid):
    """repr of 600 vertices had 25,695 characters."""
    channels = " + ".join(pyramid.channels)
    sizes = f"{pyramid.n_vertices(5)} → {pyramid.n_vertices(0)} vertices"
    assert repr(pyramid) == f"<Pyramid 5 levels, {sizes}, {channels}>"
    n_odd, n_channels = pyramid.steps[0].n_odd, len(pyramid.channels)
    assert repr(pyramid.steps[0]) == f"<Step {n_odd} odd vertices, {n_channels} channels>"
    assert repr(pyramid.detail(0)) == f"<Detail {n_odd} vertices, {n_channels} channels>"
    alone = analyse(synthetic.hills(40, 50), levels=0)
    assert repr(alone) == "<Pyramid 0 levels, 2,000 vertices, z>"
    assert repr(analyse(synthetic.hills(4, 4), levels=1)).startswith("<Pyramid 1 level, 16 → ")


def test_the_arrays_of_the_caller_stay_his_own(pyramid):
    """Pyramid.from_parts made them read-only; now ours are, and his later changes reach none."""
    parts = parts_of(pyramid)
    mine = {
        name: np.array(parts[name])
        for name in ("faces", "coarse", "horizontal")
        if parts[name] is not None
    }
    steps = [
        dataclasses.replace(
            step,
            **{f.name: np.array(getattr(step, f.name)) for f in dataclasses.fields(step)},
        )
        for step in parts["steps"]
    ]
    locked = np.zeros(pyramid.n_vertices(5), dtype=bool)
    again = Pyramid.from_parts(**(parts | mine | {"steps": steps, "locked": locked}))
    theirs = [*mine.values(), locked, *_arrays_of(steps)]
    assert all(array.flags.writeable for array in theirs)
    kept = [array.copy() for array in theirs]
    for array in theirs:
        array[...] = 0
    ours = [getattr(again, name) for name in mine] + [again.locked, *_arrays_of(again.steps)]
    for our, value in zip(ours, kept, strict=True):
        assert not our.flags.writeable
        np.testing.assert_array_equal(our, value)


def test_arrays_that_nobody_can_change_are_shared(pyramid):
    parts = parts_of(pyramid)
    again = Pyramid.from_parts(**parts)
    assert np.shares_memory(again.faces, pyramid.faces)
    assert np.shares_memory(again.steps[0].details, pyramid.steps[0].details)
    seen = pyramid.coarse.copy()
    view = seen[:]
    view.flags.writeable = False
    again = Pyramid.from_parts(**(parts | {"coarse": view}))
    assert not np.shares_memory(again.coarse, seen)


def _arrays_of(steps):
    return [getattr(step, f.name) for step in steps for f in dataclasses.fields(step)]
