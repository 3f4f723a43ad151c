"""Wrong input gives one line in the log that says what is wrong, and no traceback."""

import shutil

import numpy as np
import pytest
from qgis_layers import Log, hills, point_layer, survey, wkt_layer, write_las, write_raster

AREA = "Polygon ((700100 6600100, 700900 6600100, 700900 6600900, 700100 6600100))"
LINE = "LineString (700100 6600500, 700900 6600500)"
FAR_AREA = "Polygon ((0 0, 1 0, 1 1, 0 0))"
FAR_LINE = "LineString (0 0, 1 1)"


@pytest.fixture
def output(tmp_path):
    """Return where a pyramid may go; it must not be there after a refusal."""
    path = tmp_path / "results" / "p.gpkg"
    path.parent.mkdir()
    yield str(path)
    assert list(path.parent.iterdir()) == []


@pytest.fixture
def dem(tmp_path):
    return write_raster(tmp_path / "dem.tif", hills(30, 40).astype("float32"), -9999.0)


@pytest.fixture
def warned(run, tmp_path):
    """Return a function that runs what is odd but usable and returns the warnings in the log."""

    def run_warned(name, parameters):
        log = Log()
        run(name, {**parameters, "OUTPUT": str(tmp_path / "odd.gpkg"), "LEVELS": 1}, feedback=log)
        assert log.errors == []
        assert all("\n" not in text and "--" not in text for text in log.warnings)
        return [text for text in log.warnings if "numba" not in text]

    return run_warned


@pytest.fixture
def unselected():
    """Return a function: layer -> the layer as an input of which only selected features count."""
    from qgis.core import QgsProcessingFeatureSourceDefinition, QgsProject

    project = QgsProject.instance()

    def input_of(layer):
        project.addMapLayer(layer)
        return QgsProcessingFeatureSourceDefinition(layer.id(), True)

    yield input_of
    project.clear()


@pytest.fixture
def project_context(qgis):
    from qgis.core import QgsProcessingContext, QgsProject

    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    return context


class TestNoCrs:
    def test_a_dem(self, warned, tmp_path):
        path = write_raster(tmp_path / "nocrs.tif", hills(30, 40).astype("float32"), epsg=None)
        (text,) = warned("analysedem", {"INPUT": path})
        assert text.startswith("nocrs: there is no CRS")
        assert "give one with the layer's properties" in text

    def test_points(self, warned):
        (text,) = warned("analysetin", {"INPUT": point_layer(survey(50), crs="")})
        assert "points: there is no CRS" in text

    def test_a_point_cloud_has_a_parameter_for_it(self, warned, tmp_path):
        pytest.importorskip("laspy")
        path = write_las(tmp_path / "points.las", survey(50), epsg=None)
        (text,) = warned("analysepointcloud", {"INPUT": path})
        assert "there is no CRS" in text
        assert "'CRS of the points'" in text

    def test_a_local_crs_is_no_map_plane(self, warned, tmp_path):
        from osgeo import gdal

        path = write_raster(tmp_path / "local.tif", hills(30, 40).astype("float32"), epsg=None)
        dataset = gdal.Open(path, gdal.GA_Update)
        dataset.SetProjection('LOCAL_CS["site",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]]')
        dataset = None
        (text,) = warned("analysedem", {"INPUT": path})
        assert "local" in text
        assert "taken as they are" in text

    @pytest.mark.parametrize(("of_points", "of_lines"), [("", "EPSG:2154"), ("EPSG:2154", "")])
    def test_only_one_of_two_layers_has_one(self, warned, of_points, of_lines):
        texts = warned(
            "analysetin",
            {
                "INPUT": point_layer(survey(50), crs=of_points),
                "BREAKLINES": wkt_layer("LineString", [LINE], of_lines),
            },
        )
        assert "only one has a CRS" in texts[-1]


class TestNoOverlap:
    def test_clip_polygon(self, refused, output):
        for far in (
            wkt_layer("Polygon", [FAR_AREA]),
            wkt_layer("Polygon", [FAR_AREA], "EPSG:4326"),
        ):
            parameters = {"INPUT": point_layer(survey(100)), "CLIP": far, "OUTPUT": output}
            assert "overlap" in refused("analysetin", parameters)

    def test_breaklines(self, refused, output):
        parameters = {
            "INPUT": point_layer(survey(100)),
            "BREAKLINES": wkt_layer("LineString", [FAR_LINE]),
            "OUTPUT": output,
        }
        assert "overlap" in refused("analysetin", parameters)

    def test_training_areas(self, run, refused, dem, tmp_path):
        from qgis.core import QgsFeature, QgsGeometry, QgsVectorLayer

        pytest.importorskip("sklearn")
        made = run("analysedem", {"INPUT": dem, "OUTPUT": str(tmp_path / "p.gpkg"), "LEVELS": 2})
        areas = QgsVectorLayer("Polygon?crs=EPSG:2154&field=kind:integer", "areas", "memory")
        area = QgsFeature(areas.fields())
        area.setGeometry(QgsGeometry.fromWkt(FAR_AREA))
        area.setAttributes([3])
        areas.dataProvider().addFeatures([area])
        parameters = {
            "INPUT": made["OUTPUT"],
            "LEARN_FROM": "training areas",
            "TRAINING": areas,
            "CLASS_FIELD": "kind",
            "RASTER": str(tmp_path / "c.tif"),
        }
        assert "overlap" in refused("clusterdetails", parameters)
        assert not (tmp_path / "c.tif").exists()


@pytest.mark.parametrize("kind", [float("inf"), 1.5, 255.0])
def test_a_class_that_is_no_small_whole_number(run, refused, dem, tmp_path, kind):
    """Infinity ended in an OverflowError."""
    from qgis.core import QgsFeature, QgsGeometry, QgsVectorLayer

    pytest.importorskip("sklearn")
    made = run("analysedem", {"INPUT": dem, "OUTPUT": str(tmp_path / "p.gpkg"), "LEVELS": 2})
    areas = QgsVectorLayer("Polygon?crs=EPSG:2154&field=kind:double", "areas", "memory")
    area = QgsFeature(areas.fields())
    area.setGeometry(QgsGeometry.fromWkt(AREA))
    area.setAttributes([kind])
    areas.dataProvider().addFeatures([area])
    parameters = {
        "INPUT": made["OUTPUT"],
        "LEARN_FROM": "training areas",
        "TRAINING": areas,
        "CLASS_FIELD": "kind",
        "RASTER": str(tmp_path / "c.tif"),
    }
    assert "classes are whole numbers from 0 to 254" in refused("clusterdetails", parameters)


class TestEmptySelection:
    def test_points(self, refused, unselected, project_context, output):
        parameters = {"INPUT": unselected(point_layer(survey(50))), "OUTPUT": output}
        assert "selection" in refused("analysetin", parameters, context=project_context)

    def test_triangles(self, refused, unselected, project_context, output):
        layer = wkt_layer("PolygonZ", ["PolygonZ ((0 0 1, 1 0 1, 1 1 1, 0 0 1))"])
        parameters = {"INPUT": unselected(layer), "OUTPUT": output}
        assert "selection" in refused("analysetin", parameters, context=project_context)

    def test_clip_polygon(self, refused, unselected, project_context, output):
        clip = unselected(wkt_layer("Polygon", [AREA]))
        parameters = {"INPUT": point_layer(survey(50)), "CLIP": clip, "OUTPUT": output}
        assert "selection" in refused("analysetin", parameters, context=project_context)

    def test_breaklines_are_done_without(self, run, unselected, project_context, tmp_path):
        log = Log()
        made = run(
            "analysetin",
            {
                "INPUT": point_layer(survey(50)),
                "BREAKLINES": unselected(wkt_layer("LineString", [LINE])),
                "OUTPUT": str(tmp_path / "p.gpkg"),
            },
            feedback=log,
            context=project_context,
        )
        assert made["N_VERTICES"] == 50
        assert any("no breakline" in text for text in log.warnings)

    def test_a_layer_without_features(self, refused, output):
        assert refused("analysetin", {"INPUT": point_layer([]), "OUTPUT": output})


class TestTwoCrs:
    """Layers in another CRS are transformed, see ``test_qgis_analyse``; here it cannot be done."""

    def test_a_clip_polygon_that_cannot_be_transformed(self, refused, output):
        clip = wkt_layer("Polygon", [AREA], "EPSG:4326")  # metres said to be degrees
        parameters = {"INPUT": point_layer(survey(50)), "CLIP": clip, "OUTPUT": output}
        assert "no polygon to clip by" in refused("analysetin", parameters)

    def test_breaklines_that_cannot_be_transformed(self, warned):
        lines = wkt_layer("LineString", [LINE], "EPSG:4326")
        texts = warned("analysetin", {"INPUT": point_layer(survey(50)), "BREAKLINES": lines})
        assert "cannot be brought into the CRS" in texts[0]
        assert "without" in texts[1]

    def test_points_whose_crs_is_wrong(self, refused, output):
        parameters = {"INPUT": point_layer(survey(50), crs="EPSG:4326"), "OUTPUT": output}
        assert "not degrees" in refused("analysetin", parameters)


class TestNoData:
    @pytest.mark.parametrize("value", [-9999.0, np.nan])
    def test_a_raster_of_nodata(self, refused, tmp_path, output, value):
        empty = np.full((20, 30), value, "float32")
        path = write_raster(tmp_path / "void.tif", empty, -9999.0)
        text = refused("analysedem", {"INPUT": path, "OUTPUT": output})
        assert text.startswith("void: every cell of the raster is nodata")
        parameters = {"INPUT": path, "VERTICES": 5, "TIN": "TEMPORARY_OUTPUT"}
        assert "nodata" in refused("simplifydem", parameters)

    def test_a_band_that_is_not_there(self, refused, dem, output):
        assert "no band 7" in refused("analysedem", {"INPUT": dem, "BAND": 7, "OUTPUT": output})

    def test_too_wide_for_one_frame(self, refused, tmp_path, output):
        values = hills().astype("float32")
        wide = write_raster(tmp_path / "wide.tif", values, None, 4326, (0.0, 60.0), 0.5)
        assert "reproject" in refused("analysedem", {"INPUT": wide, "OUTPUT": output})


class TestOtherFiles:
    @pytest.mark.parametrize("name", ["text.las", "text.laz"])
    @pytest.mark.parametrize("content", ["these are no points", ""])
    def test_a_text_as_las(self, refused, tmp_path, output, name, content):
        pytest.importorskip("laspy")
        path = tmp_path / name
        path.write_text(content)
        text = refused("analysepointcloud", {"INPUT": str(path), "OUTPUT": output})
        assert "cannot be read as LAS or LAZ" in text

    def test_a_text_as_raster(self, refused, tmp_path, output):
        path = tmp_path / "text.tif"
        path.write_text("no raster")
        assert "text.tif" in refused("analysedem", {"INPUT": str(path), "OUTPUT": output})

    def test_a_text_as_pyramid(self, refused, tmp_path):
        path = tmp_path / "text.gpkg"
        path.write_text("no pyramid")
        text = refused("extractlevel", {"INPUT": str(path), "TIN": "TEMPORARY_OUTPUT"})
        assert "an analysis made" in text

    def test_a_raster_cut_short(self, refused, tmp_path, output):
        from osgeo import gdal

        whole = write_raster(tmp_path / "whole.tif", hills(300, 300).astype("float32"))
        path = tmp_path / "damaged.tif"
        options = ["COMPRESS=DEFLATE"]
        gdal.GetDriverByName("GTiff").CreateCopy(str(path), gdal.Open(whole), 0, options)
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 2])
        text = refused("analysedem", {"INPUT": str(path), "OUTPUT": output})
        assert text.startswith("damaged: the raster cannot be read")


class TestPointsAndTriangles:
    def test_points_without_elevation(self, refused, output):
        flat = wkt_layer("Point", ["Point (1 1)", "Point (2 1)", "Point (1 2)"])
        assert "field" in refused("analysetin", {"INPUT": flat, "OUTPUT": output})

    def test_points_on_a_line(self, refused, output):
        line = point_layer([(700000 + k, 6600000 + k, k) for k in range(10)])
        assert "line" in refused("analysetin", {"INPUT": line, "OUTPUT": output})

    def test_a_polygon_that_is_no_triangle(self, refused, output):
        square = wkt_layer("PolygonZ", ["PolygonZ ((0 0 1, 1 0 1, 1 1 1, 0 1 1, 0 0 1))"])
        assert "triangle" in refused("analysetin", {"INPUT": square, "OUTPUT": output})


class TestOutputs:
    """An output that cannot be is refused before the work, and inputs are never replaced."""

    @pytest.fixture
    def refused_early(self, refused, monkeypatch):
        from terrain_wavelets.plugin.base import TerrainWaveletsAlgorithm
        from terrain_wavelets.plugin.provider import ALGORITHMS

        def fail(*_):
            raise AssertionError("the work was started")

        for algorithm in (TerrainWaveletsAlgorithm, *ALGORITHMS):
            monkeypatch.setattr(algorithm, "work", fail)
        return refused

    def test_a_folder_that_is_not_there(self, refused_early, dem, tmp_path):
        missing = tmp_path / "missing"
        for name, output in (("MESH", "m.2dm"), ("RASTER", "r.tif"), ("TIN", "t.gpkg")):
            parameters = {"INPUT": dem, "VERTICES": 50, name: str(missing / output)}
            assert "no such folder" in refused_early("simplifydem", parameters)

    def test_another_suffix(self, refused_early, dem, tmp_path):
        parameters = {"INPUT": dem, "OUTPUT": str(tmp_path / "p.txt")}
        assert ".gpkg" in refused_early("analysedem", parameters)
        parameters = {"INPUT": dem, "VERTICES": 50, "MESH": str(tmp_path / "m.shp")}
        assert ".2dm" in refused_early("simplifydem", parameters)

    def test_the_input_itself(self, run, refused, dem, tmp_path):
        parameters = {"INPUT": dem, "VERTICES": 50, "RASTER": dem}
        assert "input itself" in refused("simplifydem", parameters)
        pyramid = str(tmp_path / "p.gpkg")
        run("analysedem", {"INPUT": dem, "OUTPUT": pyramid, "LEVELS": 2})
        parameters = {"INPUT": pyramid, "GAINS": [1, 0.5], "OUTPUT": pyramid}
        assert "input itself" in refused("filterlevels", parameters)
        assert "input itself" in refused("reconstruct", {"INPUT": pyramid, "DEM": pyramid})
        assert run("reconstruct", {"INPUT": pyramid, "DEM": str(tmp_path / "b.tif")})


#: What is said of a nasty file that is refused; the others run.
REFUSED = {
    "all_nan.tif": "nodata",
    "all_nodata_4band_u16.tif": "nodata",
    "corrupt.tif": "the file is damaged",
    "header_says_1065_has_0.las": "no points although",
    "las10_pdrf1.las": "at least three",
    "las11_pdrf0.las": "at least three",
    "lots_of_vlr.las": "at least three",
    "no_points.las": "no points",
    "truncated_60pct.laz": "the file is damaged",
}
RUN = (
    "bad_vlr_count.las",
    "epsg_4326_degrees.las",
    "evlr_1_4.las",
    "extrabytes.las",
    "las13_waveform_pdrf4.las",
    "las14_pdrf6_badwkt.laz",
    "local_cs_nonsquare.tif",
    "nan57_no_nodata_tag.tif",
    "old_pointwise.laz",
    "pdrf10_waveform.laz",
    "sample_c_nocrs.las",
    "simple1_1.las",
    "simple_with_page.copc.laz",
    "warsaw_empty_wkt.las",
    "wkt_and_geotiff.las",
)
RUN_LARGE = ("nocrs_3band_u8.tif", "rotated_20deg.tif", "south_up.tif")


@pytest.mark.data
class TestNastyFiles:
    @pytest.fixture
    def input_of(self, data_folder, tmp_path):
        """Return a function: name -> algorithm and parameters, on a copy that QGIS may write by."""

        def copied(name):
            path = shutil.copy(data_folder / "nasty" / name, tmp_path)
            is_raster = name.endswith(".tif")
            if not is_raster:
                pytest.importorskip("laspy")
            return "analysedem" if is_raster else "analysepointcloud", {"INPUT": path}

        return copied

    def test_every_file_is_listed_here(self, data_folder):
        there = {path.name for path in (data_folder / "nasty").iterdir()}
        assert {*REFUSED, *RUN, *RUN_LARGE} <= there

    @pytest.mark.parametrize("name", REFUSED)
    def test_refused(self, refused, input_of, output, name):
        algorithm, parameters = input_of(name)
        assert REFUSED[name] in refused(algorithm, {**parameters, "OUTPUT": output})

    @pytest.mark.parametrize(
        "name", [*RUN, *(pytest.param(name, marks=pytest.mark.large) for name in RUN_LARGE)]
    )
    def test_run(self, warned, input_of, name):
        warned(*input_of(name))
