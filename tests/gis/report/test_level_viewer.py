"""The page with a slider over the levels holds the levels, and stands alone."""

import base64
import json
import re
import zlib
from dataclasses import replace

import numpy as np
import pytest

from wavelet_core import Cancelled, OptionError
from wavelet_gis.report.level_viewer import level_viewer


@pytest.fixture(scope="module")
def page(raster_record):
    return level_viewer(raster_record)


def data_of(text):
    return json.loads(re.search(r'id="data">(.*?)</script>', text, flags=re.DOTALL)[1])


def mesh_of(level, low, high):
    """Unpack a level as the script in the page does."""
    raw = zlib.decompress(base64.b64decode(level["positions"]))
    steps = np.cumsum(np.frombuffer(raw, "<u2").reshape(3, -1).astype(np.int64), axis=1) % 65536
    vertices = low + (high - low) * steps.T / 65535
    corners = np.frombuffer(zlib.decompress(base64.b64decode(level["faces"])), "<i4")
    return vertices, np.cumsum(corners.astype(np.int64)).reshape(-1, 3)


def turned(faces):
    """Return the faces as a set of corners, the lowest first, orientation kept."""
    return {tuple(np.roll(face, -int(np.argmin(face)))) for face in faces}


def test_levels_come_out_as_they_are(raster_record, page):
    data, rows = data_of(page[0]), page[1]["shown"]
    low, high = np.array(data["low"]), np.array(data["high"])
    assert len(rows) == len(data["levels"]) > 1
    for row, level in zip(rows, data["levels"], strict=True):
        mesh = raster_record.pyramid[row["level"]]
        vertices, faces = mesh_of(level, low, high)
        assert np.abs(vertices - mesh.vertices).max(axis=0) == pytest.approx(
            np.zeros(3), abs=(high - low).max() / 65535
        )
        assert turned(faces) == turned(mesh.faces)
        assert f"{mesh.n_vertices:,} vertices" in level["words"]


def test_errors_are_told_where_they_are_known(raster_record, page):
    with_errors = raster_record.with_errors()
    for row in level_viewer(with_errors)[1]["shown"]:
        assert row["rmse"] == with_errors.errors_at(row["level"]).rmse_surface
    assert all(f"{row['n_triangles']:,}" in page[0] for row in page[1]["shown"])


def test_a_limit_leaves_fine_levels_out(raster_record):
    pyramid = raster_record.pyramid
    limit = pyramid.n_vertices(1)
    figures = level_viewer(raster_record, limit)[1]
    assert figures["shown"][-1]["level"] == 1
    with pytest.raises(OptionError, match=f"coarsest level has {pyramid.n_vertices(0)} vertices"):
        level_viewer(raster_record, pyramid.n_vertices(0) - 1)


def test_the_page_needs_nothing_else(page):
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", page[0])
    assert "http" not in page[0]
    assert not re.search(r"@\w+@", page[0])


def test_names_from_strangers_are_text_only(raster_record):
    geo = replace(raster_record, source_name="</script><img src=x onerror=alert(1)>.tif")
    text = level_viewer(geo)[0]
    assert "<img src=x" not in text
    assert text.count("</script>") == 2  # of the data and of the program


def test_same_bytes_twice_and_cancelled_at_once(raster_record, page):
    assert level_viewer(raster_record)[0] == page[0]
    with pytest.raises(Cancelled):
        level_viewer(raster_record, progress=lambda fraction: False)
