"""A record tells its pyramid to the bit, on every engine and for any number of threads."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from helpers import ForecastWriter
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import TriangleMesh, analyse, synthetic
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.errors import PyramidError
from wavelet_core.lifting import recorded
from wavelet_core.lifting.recorded import pyramid_of, record_of
from wavelet_core.partition.questions import Answers

ENGINES = ["arrays", *(["compiled"] if HAS_NUMBA else [])]


def told(pyramid, mesh):
    record = record_of(pyramid, mesh)
    assert record is not None
    return record, pyramid_of(
        record,
        mesh,
        channels=pyramid.channels,
        update=pyramid.update,
        locked=pyramid.locked,
        parameters=pyramid.parameters,
        stop=pyramid.stop,
    )


def with_attributes(mesh):
    rng = np.random.default_rng(4)
    return TriangleMesh(mesh.vertices, mesh.faces, rng.uniform(0, 9, (mesh.n_vertices, 2)), "ab")


MESHES = {
    "hills": synthetic.hills(25, 30),
    "flat": TriangleMesh.from_grid(np.zeros((20, 20)), np.arange(20.0), np.arange(20.0)),
    "holes": grid_with_holes(24, 30),
    "points": random_delaunay(500, seed=2, offset=1e6),
    "attributes": with_attributes(random_delaunay(300, seed=3)),
}
OPTIONS = {
    "levels": {},
    "size": {"target_vertices": 60},
    "largest error": {"max_error": 0.7},
    "largest error, updated": {"max_error": 0.9, "update": "minimum_norm"},
    "outline": {"outline_tolerance": 1.5, "target_vertices": 50},
}


def are_alike(one, other):
    """Whether two records hold the same numbers."""
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(are_alike, one, other))
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.tobytes() == other.tobytes()
    return one == other


@pytest.mark.parametrize("options", list(OPTIONS))
@pytest.mark.parametrize("name", list(MESHES))
def test_every_pyramid_of_the_default_design_is_told(name, options):
    mesh = MESHES[name]
    pyramid = analyse(mesh, **OPTIONS[options])
    if pyramid.n_levels:
        assert told(pyramid, mesh)[1] == pyramid


@pytest.mark.parametrize("parts", ["one part", "parts", "coarsest"])
@pytest.mark.parametrize("options", list(OPTIONS))
@pytest.mark.parametrize("name", list(MESHES))
def test_an_analysis_takes_the_record_that_a_second_walk_does(name, options, parts, monkeypatch):
    if parts != "one part":
        monkeypatch.setattr(recorded, "LEAST_IN_PARTS", 100)
        monkeypatch.setattr(recorded, "LEAST_IN_PART", 40 if parts == "parts" else 1)
        monkeypatch.setattr(recorded, "PART_SHARE", 0.6 if parts == "parts" else 0.0)
        monkeypatch.setattr(recorded, "COARSEST_SHARE", 0.9)
    mesh = MESHES[name]
    pyramid = analyse(mesh, record=True, **OPTIONS[options])
    assert pyramid == analyse(mesh, **OPTIONS[options])
    if pyramid.n_levels and (name, options) != ("holes", "outline"):
        assert are_alike(pyramid.kept_record.record, record_of(pyramid.with_parts(), mesh))
        assert record_of(pyramid, mesh) is pyramid.kept_record.record


def digest_of_answers(name, options):
    """Return a digest of the answers of an analysis that the engine called ``name`` has made."""
    i, j = np.mgrid[:40, :50]
    z = (3 * i * i + 5 * j * j + i * j) % 97 + 2 * i + 40 * ((i // 9 + j // 13) % 3)
    mesh = TriangleMesh.from_grid(z.astype(float), np.arange(50.0), np.arange(40.0))
    digest = hashlib.sha256()
    with engine(name):
        for part in analyse(mesh, record=True, **options).kept_record.record.parts:
            for array in (part.answers.levels, *part.answers.going, *part.answers.targets):
                digest.update(array.tobytes())
    return digest.hexdigest()[:16]


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize(
    ("options", "expected"), [({}, "d79cd9f1a11a2461"), ({"max_error": 9.0}, "f6f7fa38dadc7dc7")]
)
def test_records_by_forecasts_are_those_of_the_first_files_of_format_2(
    name, options, expected, monkeypatch
):
    """Whoever reads those answers otherwise cannot read the files that are there."""
    monkeypatch.setattr(recorded, "Writer", ForecastWriter)
    assert digest_of_answers(name, options) == expected


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize(
    ("options", "expected"), [({}, "aaa6a6ceaa50e3df"), ({"max_error": 9.0}, "4efae5b9696d0121")]
)
def test_records_are_those_of_the_first_files_of_format_4(name, options, expected):
    assert digest_of_answers(name, options) == expected


@pytest.mark.parametrize("name", list(MESHES))
def test_a_record_by_forecasts_tells_its_pyramid(name, monkeypatch):
    monkeypatch.setattr(recorded, "Writer", ForecastWriter)
    pyramid = analyse(MESHES[name], record=True)
    if pyramid.n_levels:
        record, again = told(pyramid, MESHES[name])
        assert record.parts[0].answers.levels.shape[1] == 2
        assert again == pyramid


def test_a_record_of_the_analysis_is_not_taken_for_another_pyramid_or_input():
    mesh = synthetic.hills(12, 12)
    pyramid = analyse(mesh, levels=4, record=True)
    changed = replace(pyramid, coarse=pyramid.coarse + 1.0)
    assert changed.kept_record is pyramid.kept_record
    assert record_of(changed, mesh) is None
    assert record_of(replace(pyramid, steps=pyramid.steps[1:]), mesh) is None
    raised = TriangleMesh(mesh.vertices + np.array([0.0, 0.0, 1.0]), mesh.faces)
    assert record_of(pyramid, raised) is None
    assert pyramid.with_gains({1: 0.5}).kept_record is None
    assert analyse(mesh, levels=2, prediction="GLMN", record=True).kept_record is None
    assert analyse(mesh, levels=0, record=True).kept_record is None


def test_collapses_that_the_link_condition_forbids_leave_the_record_to_the_writer():
    """Only around holes, and there only with a tolerance, is one forbidden by its own step's."""
    mesh, options = MESHES["holes"], OPTIONS["outline"]
    pyramid = analyse(mesh, record=True, **options)
    assert pyramid.kept_record is None
    assert told(pyramid, mesh)[1] == pyramid


def test_locked_vertices_and_stars_where_all_are():
    mesh = synthetic.hills(20, 20)
    locked = np.random.default_rng(0).random(mesh.n_vertices) < 0.6
    pyramid = analyse(mesh, locked=locked, levels=6)
    assert told(pyramid, mesh)[1] == pyramid


@pytest.mark.parametrize("reader", ENGINES)
@pytest.mark.parametrize("writer", ENGINES)
def test_what_one_engine_writes_another_reads(writer, reader):
    mesh = MESHES["attributes"]
    with engine(writer):
        pyramid = analyse(mesh, levels=5)
        record = record_of(pyramid, mesh)
    with engine(reader):
        back = pyramid_of(
            record, mesh, channels=pyramid.channels, update=pyramid.update, locked=None,
            parameters=pyramid.parameters, stop=None,
        )  # fmt: skip
    assert back == pyramid


@pytest.mark.parametrize("threads", ["1", "2", "4"])
def test_any_number_of_threads_writes_the_same(threads, monkeypatch):
    mesh = synthetic.hills(90, 90)
    pyramid = analyse(mesh, levels=4)
    expected = record_of(pyramid, mesh)
    monkeypatch.setenv("TERRAIN_WAVELETS_THREADS", threads)
    again = record_of(pyramid, mesh)
    for one, other in zip(expected.parts[0].answers, again.parts[0].answers, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize(
    "options", [{"prediction": "GLMN"}, {"partition": "quadric"}, {"signal": "xyz"}, {"levels": 0}]
)
def test_other_designs_have_no_record(options):
    mesh = synthetic.hills(12, 12)
    assert record_of(analyse(mesh, **({"levels": 2} | options)), mesh) is None


def test_an_altered_pyramid_has_no_record():
    mesh = synthetic.hills(12, 12)
    pyramid = analyse(mesh, levels=4)
    assert record_of(pyramid.with_gains({1: 0.5}), mesh) is None
    raised = TriangleMesh(mesh.vertices + np.array([0.0, 0.0, 1.0]), mesh.faces)
    assert record_of(pyramid, raised) is None


def test_forecasts_leave_little_to_tell():
    mesh = synthetic.hills(60, 60)
    answers = record_of(analyse(mesh, levels=8), mesh).parts[0].answers
    targets = np.concatenate(answers.targets)
    assert np.mean(targets == 0) > 0.6
    flat = MESHES["flat"]
    answers = record_of(analyse(flat), flat).parts[0].answers
    assert np.mean(np.concatenate(answers.targets) == 0) > 0.9


def test_answers_that_tell_no_steps_are_refused():
    mesh = MESHES["hills"]
    pyramid = analyse(mesh, levels=4)
    record = record_of(pyramid, mesh)
    answers = record.parts[0].answers
    turned = tuple(1 - part for part in answers.going)
    wild = tuple(np.full_like(part, 60) for part in answers.targets)
    for broken in (
        answers._replace(going=turned),
        answers._replace(targets=wild),
        answers._replace(levels=answers.levels[:2]),
        answers._replace(levels=np.concatenate([answers.levels, answers.levels])),
        Answers(answers.levels, answers.going[::-1], answers.targets),
    ):
        part = record.parts[0]._replace(answers=broken)
        with pytest.raises(PyramidError):
            pyramid_of(
                record._replace(parts=(part,)), mesh, channels=pyramid.channels,
                update=pyramid.update, locked=None, parameters=pyramid.parameters, stop=None,
            )  # fmt: skip
