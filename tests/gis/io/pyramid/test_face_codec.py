"""Faces come back from what their points do not tell of them."""

import hashlib

import numpy as np
import pytest

from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.errors import Cancelled, PyramidError
from wavelet_core.mesh.triangulation import canonical_faces, delaunay_faces
from wavelet_gis.io.pyramid.codecs.face_codec import decode_faces, encode_faces


def scattered(n=500, seed=0, side=10_000):
    rng = np.random.default_rng(seed)
    return rng.permutation(np.unique(rng.integers(0, side, (n, 2)), axis=0))


def faces_of(points):
    return canonical_faces(delaunay_faces(points.astype(float)))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("side", [40, 10_000, 2**24])
def test_a_triangulation_comes_back(seed, side):
    points = scattered(seed=seed, side=side)
    faces = faces_of(points)
    record = encode_faces(points, faces)
    assert np.array_equal(decode_faces(points, record), faces)


def test_points_on_a_grid_where_circles_tie():
    points = np.stack(np.meshgrid(np.arange(30), np.arange(20)), axis=-1).reshape(-1, 2)
    faces = faces_of(points)
    assert np.array_equal(decode_faces(points, encode_faces(points, faces)), faces)


def test_holes_and_missing_faces_come_back():
    points = scattered()
    faces = faces_of(points)
    gone = np.random.default_rng(5).random(len(faces)) < 0.1
    faces = faces[~gone]
    record = encode_faces(points, faces)
    assert len(record.holes) > 10
    assert np.array_equal(decode_faces(points, record), faces)


def test_any_one_face_may_be_missing():
    """The first triangle and the last as well."""
    points = scattered(40)
    faces = faces_of(points)
    for gone in range(len(faces)):
        fewer = np.delete(faces, gone, axis=0)
        assert np.array_equal(decode_faces(points, encode_faces(points, fewer)), fewer)


def test_points_without_any_face_come_back():
    points, none = scattered(40), np.empty((0, 3), dtype=np.int64)
    assert decode_faces(points, encode_faces(points, none)).shape == (0, 3)


def test_a_triangulation_that_is_not_delaunay_comes_back():
    points = scattered()
    squeezed = points * np.array([1, 7])
    faces = canonical_faces(delaunay_faces(squeezed.astype(float)))
    record = encode_faces(points, faces)
    assert np.array_equal(decode_faces(points, record), faces)


def test_nearly_all_is_told_by_the_points():
    points = scattered(4000, side=100_000)
    record = encode_faces(points, faces_of(points))
    clear = [0, 2, 6]
    wrong = sum(min(a.sum(), len(a) - a.sum()) for k, a in enumerate(record.answers) if k in clear)
    assert wrong < 0.02 * len(points)
    assert len(record.far) < 0.15 * len(points)


def test_what_cannot_be_told_exactly_is_not():
    assert encode_faces(np.array([[0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])) is None
    far = scattered() * 2**20
    assert encode_faces(far, faces_of(scattered())) is None
    points = scattered()
    assert encode_faces(points, faces_of(points)[::-1]) is None  # of another order


def test_records_of_other_points_are_refused():
    points = scattered()
    record = encode_faces(points, faces_of(points))
    for broken in (
        record._replace(answers=tuple(a[:-1] for a in record.answers)),
        record._replace(answers=tuple(np.append(a, 0).astype(np.uint8) for a in record.answers)),
        record._replace(far=np.array([[0, 10**6]], np.int32)),
        record._replace(far=np.array([[5, 5]], np.int32)),
        record._replace(holes=np.array([10**9])),
    ):
        with pytest.raises(PyramidError):
            decode_faces(points, broken)


ENGINES = ["arrays", "loops", *(["compiled"] if HAS_NUMBA else [])]


def digest_of(record):
    digest = hashlib.sha256()
    for array in (*record.answers, record.far, record.holes):
        digest.update(array.tobytes())
    return digest.hexdigest()[:16]


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize(
    ("seed", "side", "every", "expected"),
    [(1, 10_000, 3, "662f44d4fd2adf11"), (2, 2**24, 1, "9a59f152f889a04e")],
)
def test_records_are_those_of_the_first_files_of_format_2(name, seed, side, every, expected):
    """The numbers are those of the code before there were kernels."""
    points = scattered(seed=seed, side=side)
    faces = faces_of(points)[::every]
    with engine(name):
        record = encode_faces(points, faces)
        assert digest_of(record) == expected
        assert np.array_equal(decode_faces(points, record), faces)


@pytest.mark.parametrize("name", ENGINES)
def test_a_point_that_is_joined_to_hundreds(name):
    """More spokes than are sorted by insertion, and triangles of one lowest corner."""
    angle = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    rim = np.rint(1e6 * np.column_stack([np.cos(angle), np.sin(angle)])).astype(np.int64)
    points = np.vstack([[0, 0], rim])
    around = np.arange(300)
    faces = np.column_stack([np.zeros(300, int), 1 + around, 1 + (around + 1) % 300])
    faces = faces[np.argsort(faces[:, 1])]
    with engine(name):
        record = encode_faces(points, faces)
        assert np.array_equal(decode_faces(points, record), faces)


def test_faces_of_many_points_tell_how_far_they_are(monkeypatch):
    """A QGIS without numba showed nothing for 7 s, and heard no cancel, over 500,000 points."""
    monkeypatch.setattr("wavelet_core.mesh.point_faces.POINTS_AT_ONCE", 100)
    monkeypatch.setattr("wavelet_core._arrays.point_faces.POINTS_AT_ONCE", 100)
    points = scattered(2000)
    faces = faces_of(points)
    seen, seen_back = [], []
    with engine("arrays"):
        record = encode_faces(points, faces, seen.append)
        assert np.array_equal(decode_faces(points, record, seen_back.append), faces)
    for fractions in (seen, seen_back):
        assert fractions == sorted(fractions)
        assert np.diff([0.0, *fractions, 1.0]).max() < 0.12


@pytest.mark.parametrize("last", [0, 3, 7])
def test_work_on_faces_stops(last, monkeypatch):
    monkeypatch.setattr("wavelet_core.mesh.point_faces.POINTS_AT_ONCE", 100)
    points = scattered()
    faces = faces_of(points)
    record = encode_faces(points, faces)
    for work in (
        lambda go: encode_faces(points, faces, go),
        lambda go: decode_faces(points, record, go),
    ):
        seen = []

        def go(fraction, seen=seen):
            seen.append(fraction)
            return len(seen) <= last

        with engine("arrays"), pytest.raises(Cancelled):
            work(go)
        assert len(seen) == last + 1
