"""The quality report: its figures are right, and its page stands alone."""

import base64
import json
import re
import struct
import xml.etree.ElementTree as ElementTree
import zlib
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from wavelet_core import Cancelled, OptionError, TriangleMesh, synthetic
from wavelet_core.accuracy.level_errors import level_errors
from wavelet_gis.report.figures import report_data
from wavelet_gis.report.page import report_page
from wavelet_gis.report.pictures import histogram_chart, line_chart
from wavelet_gis.workflows.read_off.levels import default_levels
from wavelet_gis.workflows.solver.quality import triangle_quality


class _Page(HTMLParser):
    """Collects what a page refers to, and that its elements are closed."""

    VOID = ("meta", "img", "br")

    def __init__(self):
        super().__init__()
        self.links, self.stack, self.images, self.charts = [], [], 0, 0

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.links += [attrs[k] for k in ("src", "href", "action") if k in attrs]
        self.images += tag == "img"
        self.charts += tag == "svg"
        if tag not in self.VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.stack.pop() == tag


@pytest.fixture(scope="module")
def page(raster_record):
    return report_page(raster_record)


def test_levels_agree_with_the_core(raster_record, page):
    rows = page[1]["levels"]
    for row, errors in zip(rows, reversed(level_errors(raster_record.pyramid)), strict=True):
        for name in ("level", "n_vertices", "n_faces", "n_uncovered"):
            assert row[name] == getattr(errors, name)
        for name in ("rmse_coefficients", "rmse_surface", "max_error_surface"):
            assert row[name] == pytest.approx(getattr(errors, name), abs=1e-12)
    assert rows[0]["vertex_share"] == 1.0
    assert rows[0]["rmse_surface"] == pytest.approx(0, abs=1e-9)


def test_every_detail_is_in_a_histogram(raster_record, page):
    details = page[1]["details"]
    for row, step in zip(details["levels"], raster_record.pyramid.steps, strict=True):
        assert sum(row["counts"]) == row["n_details"] == step.n_odd
        magnitude = np.linalg.norm(step.details, axis=1)
        assert row["largest"] == pytest.approx(magnitude.max())
        assert row["rms"] == pytest.approx(np.sqrt((magnitude**2).mean()))


def test_errors_by_slope_add_up(page):
    for shown in page[1]["shown"]:
        classes = shown["by_slope"]
        assert sum(c["vertex_share"] for c in classes) == pytest.approx(1)
        assert sum(c["squared_error_share"] for c in classes) == pytest.approx(1)
        row = next(r for r in page[1]["levels"] if r["level"] == shown["level"])
        total = sum(c["vertex_share"] * (c["rmse_surface"] or 0) ** 2 for c in classes)
        assert total == pytest.approx(row["rmse_surface"] ** 2, rel=1e-6)
        assert abs(shown["worst"][0]["error"]) == pytest.approx(row["max_error_surface"])
        assert shown["quantiles"]["1.0"] == pytest.approx(row["max_error_surface"])


def test_worst_places_are_apart_and_in_the_file_s_coordinates(page):
    worst = np.array([[w["x"], w["y"]] for w in page[1]["shown"][-1]["worst"]])
    assert ((worst >= [500000, 5099600]) & (worst <= [500500, 5100000])).all()
    distance = np.hypot(*(worst[:, None] - worst).transpose(2, 0, 1))
    assert distance[np.triu_indices(len(worst), 1)].min() > 0.02 * 390


def test_the_page_stands_alone_and_is_well_formed(page):
    parser = _Page()
    parser.feed(page[0])
    assert parser.stack == []
    assert parser.images >= 3
    assert parser.charts == 4
    assert all(link.startswith("data:image/png;base64,") for link in parser.links)
    assert "http" not in re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page[0])
    assert 'name="viewport"' in page[0]
    for svg in re.findall(r"<svg.*?</svg>", page[0], flags=re.S):
        ElementTree.fromstring(svg)
        assert "nan" not in svg.lower()


def test_the_figures_are_in_the_page(page):
    embedded = re.search(r'<script type="application/json" id="figures">(.*?)</script>', page[0])
    assert json.loads(embedded[1]) == json.loads(json.dumps(page[1]))
    assert page[1]["parameters"]["levels"] == 4
    assert page[1]["versions"]["numpy"] == np.__version__


def test_the_pictures_are_pngs(page):
    for uri in re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", page[0]):
        png = base64.b64decode(uri)
        assert png[:8] == b"\x89PNG\r\n\x1a\n"
        width, height = struct.unpack(">II", png[16:24])
        data = png[png.index(b"IDAT") + 4 : png.index(b"IEND") - 8]
        assert len(zlib.decompress(data)) == height * (width + 1)
        assert 1 < max(width, height) <= 480


def test_names_from_strangers_are_text_only(raster_record):
    geo = replace(raster_record, source_name="</script><img src=x onerror=alert(1)>.tif")
    page, _ = report_page(geo)
    assert "<img src=x" not in page
    assert page.count("</script>") == 1


def test_heights_are_in_the_file_s_unit(raster_record):
    in_feet = replace(raster_record, frame=replace(raster_record.frame, z_scale=0.3048))
    metres = report_data(raster_record).figures
    feet = report_data(in_feet).figures
    for a, b in zip(metres["levels"], feet["levels"], strict=True):
        assert b["rmse_surface"] == pytest.approx(a["rmse_surface"] / 0.3048)
    assert feet["shown"][0]["bias"] == pytest.approx(metres["shown"][0]["bias"] / 0.3048)


def test_chosen_levels_go_from_fine_to_coarse(raster_record):
    levels = default_levels(raster_record)
    assert levels[-1] == 0
    assert levels == sorted(levels, reverse=True)
    assert list(report_data(raster_record, [2, 1]).errors) == [2, 1]
    with pytest.raises(OptionError, match=r"no level 9; they are 0 \(coarsest\) to 4"):
        report_data(raster_record, [9])


def test_a_report_can_be_stopped(raster_record):
    with pytest.raises(Cancelled):
        report_page(raster_record, progress=lambda fraction: fraction < 0.5)


def test_errors_by_slope_and_pictures_are_in_its_progress(raster_record):
    """All was reported before them, and a bar stood for seven seconds."""
    seen = []
    report_page(raster_record, [2, 1, 0], lambda fraction: seen.append(fraction) or True)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    n_levels = raster_record.pyramid.n_levels + 1
    assert len(seen) == n_levels + 3 + 3
    assert seen[n_levels - 1] < 0.8


def test_a_cloud_has_a_report_too(cloud_record):
    page, figures = report_page(cloud_record)
    assert figures["source"]["channels"] == ["z", "classification", "hag", "intensity"]
    assert "A point cloud" in page


def test_quality_of_known_triangles():
    right = TriangleMesh([[0, 0, 0], [1, 0, 5], [0, 1, 9]], [[0, 1, 2]])
    assert triangle_quality(right)["median_smallest_angle"] == pytest.approx(45)
    sliver = TriangleMesh([[0, 0, 0], [10, 0, 0], [5, 0.1, 0]], [[0, 1, 2]])
    assert triangle_quality(sliver)["sliver_share"] == 1.0
    assert triangle_quality(synthetic.fan(6))["low_smallest_angle"] == pytest.approx(60)
    empty = TriangleMesh([[0, 0, 0]], np.empty((0, 3), dtype=int))
    assert np.isnan(triangle_quality(empty)["median_smallest_angle"])


def test_charts_leave_out_what_has_no_place():
    assert line_chart("t", [1.0], [("a", [float("nan")])], "x", "y") == ""
    chart = line_chart("t", [1.0, 10.0], [("a", [0.0, 5.0])], "x", "y", log_y=True)
    assert chart.count("<circle") == 1
    assert histogram_chart("t", [], [], "x") == ""
    flat = line_chart("t", [3.0, 3.0], [("a", [2.0, 2.0])], "x", "y", log_x=True)
    assert "nan" not in flat
