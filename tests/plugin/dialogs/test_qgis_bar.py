"""The bar moves at least every second, and never back, where parts of the work are long."""

from importlib import import_module
from itertools import pairwise

import numpy as np
import pytest
from qgis_layers import Log, point_layer, survey, wkt_layer


def longest_rest(width, reports, seconds):
    """Return for how long a part of the bar shows nothing new, by what is reported when."""
    from terrain_wavelets.plugin.qgis_io.background import LEAST, Bar

    bar = Bar(0.0, width)
    seen, moments = 0.0, [0.0]
    for tenth in range(10 * seconds):
        reported = max((share for moment, share in reports if 10 * moment <= tenth), default=0.0)
        place = width * bar.at(reported, tenth / 10)
        if place - seen >= LEAST:
            seen = place
            moments.append(tenth / 10)
    return np.diff([*moments, seconds]).max()


def test_the_bar_soon_moves_after_steps_that_showed_nothing(qgis):
    """Between reading points and placing them it stood for 1.2 s: one rest went into another."""
    from terrain_wavelets.plugin.qgis_io.background import LEAST, Bar

    bar = Bar(0.0, 0.02)
    assert 0.02 * max(bar.at(0.0, tenth / 10) for tenth in range(7)) >= LEAST


def test_a_computer_that_slept_does_not_slow_the_bar(qgis):
    """Ten minutes of sleep were counted as work, so that what was left seemed to take hours."""
    from terrain_wavelets.plugin.qgis_io.background import LEAST, Bar

    width, seconds = 0.8, 400
    bar, seen, moments = Bar(0.0, width), 0.0, []
    for tenth in range(10 * seconds):
        second = tenth / 10
        now = second + (600.0 if second > 60 else 0.0)
        place = width * bar.at((tenth // 10) / seconds, now)
        if place - seen >= LEAST:
            seen = place
            moments.append(second)
    assert np.diff([*moments, seconds]).max() <= 1.0


class TestReadingAPyramid:
    """Seconds are those of four million cells, and of two million points, on two cores."""

    @pytest.fixture(params=["web_terrain", "filter_levels"])
    def width(self, qgis, request):
        from terrain_wavelets.plugin.algorithms import filter_levels, web_terrain

        if request.param == "web_terrain":
            return web_terrain.READING
        return filter_levels.READING_BEFORE_DENOISING

    def test_of_cells(self, width):
        """It stood for 2.3 s: a fifth of it was said to be done after a thirtieth of the time."""
        from wavelet_gis.io.pyramid.pyramid_parts import _SOURCE_IS_READ

        left = 1.0 - _SOURCE_IS_READ
        levels = [(s, _SOURCE_IS_READ + left * (s - 0.6) / 22.4) for s in np.arange(2.0, 23.0, 1.1)]
        assert longest_rest(width, [(0.6, _SOURCE_IS_READ), *levels], 23) <= 1.0

    def test_of_points(self, width):
        from wavelet_core.mesh.point_faces import _OF_NEAREST
        from wavelet_gis.io.pyramid.codecs.face_codec import _OF_PAIRS
        from wavelet_gis.io.pyramid.pyramid_parts import _SOURCE_IS_READ
        from wavelet_gis.io.pyramid.recorded_pyramid import _SHARE_OF_FACES

        left = 1.0 - _SOURCE_IS_READ
        faces = left * _SHARE_OF_FACES
        pairs = faces * _OF_PAIRS
        ends = [
            (1.1, _SOURCE_IS_READ),
            (12.5, _SOURCE_IS_READ + pairs * _OF_NEAREST),
            (14.5, _SOURCE_IS_READ + pairs),
            (19.0, _SOURCE_IS_READ + faces),
            (54.0, 1.0),
        ]
        moments = np.arange(1.1, 54.0, 0.7)
        reports = list(zip(moments, np.interp(moments, *zip(*ends, strict=True)), strict=True))
        assert longest_rest(width, reports, 54) <= 1.0


@pytest.mark.parametrize("parts", ["DENOISED", "DENOISED_AND_WRITTEN"])
def test_removing_noise_has_the_bar_that_its_time_takes(qgis, parts):
    """It stood for 3.2 s near its end: nine minutes of ten had two thirds of the bar.

    Seconds are those of four million cells: finding the noise, four pyramids, filters for all
    vertices, and what they take out.
    """
    from terrain_wavelets.plugin.algorithms import filter_levels

    denoise = import_module("wavelet_core.filtering.denoise")
    find, of_vertices = denoise.TO_FIND_NOISE, denoise.TIME_OF_VERTICES["compiled"]
    pyramid = (1.0 - find) / (4 + of_vertices)
    shares = [find, 4 * pyramid, denoise.OF_BANK * of_vertices * pyramid]
    ends = np.cumsum([0, 85, 200, 85, 91])
    moments = np.arange(0.0, ends[-1], 1.5)
    reports = np.interp(moments, ends, [0.0, *np.cumsum(shares), 1.0])
    width = getattr(filter_levels, parts)[0] - filter_levels.READING_BEFORE_DENOISING
    reports = list(zip(moments, reports, strict=True))
    assert longest_rest(width, reports, int(ends[-1])) <= 1.0


def test_laying_lines_never_moves_the_bar_back(run, tmp_path, monkeypatch):
    """The points were read up to 5 % of it; what followed began at 3 %."""
    from terrain_wavelets.plugin.qgis_io import vectors

    monkeypatch.setattr(vectors, "CHUNK", 50)
    log = Log()
    run(
        "analysetin",
        {
            "INPUT": point_layer(survey()),
            "BREAKLINES": wkt_layer(
                "LineString", ["LineString (700100 6600200, 700850 6600420, 700300 6600900)"]
            ),
            "TARGET_VERTICES": 500,
            "OUTPUT": str(tmp_path / "p.gpkg"),
        },
        log,
    )
    assert len([percent for percent in log.fractions if 0 < percent < 5]) > 5
    assert [step for step in pairwise(log.fractions) if step[1] < step[0]] == []


@pytest.mark.parametrize("name", ["inside", "rows_in"])
def test_points_are_looked_for_in_a_polygon_a_block_at_a_time(qgis, name):
    """Two million were made one list first, which held QGIS and its button for 1.2 s."""
    from qgis.core import QgsGeometry
    from terrain_wavelets.plugin.qgis_io import geometry

    from wavelet_core import Cancelled

    area = QgsGeometry.fromWkt("Polygon ((0 0, 8 0, 8 8, 0 8, 0 0))")
    places = np.random.default_rng(3).uniform(0.01, 9.99, (5 * geometry.BLOCK, 2))
    is_there = (places < 8).all(axis=1)
    look, seen = getattr(geometry, name), []
    found = look(area, places, seen.append)
    if name == "inside":
        assert np.array_equal(found, is_there)
        assert len(seen) == 5
    else:
        assert np.array_equal(found, np.flatnonzero(is_there))
        assert len(seen) == -(-is_there.sum() // geometry.BLOCK)
    assert seen == sorted(seen)
    assert max(seen) < 1.0
    with pytest.raises(Cancelled):
        look(area, places, lambda share: share < 0.3)
