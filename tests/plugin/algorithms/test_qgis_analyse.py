"""Rasters, points, TINs and LAS files to pyramids and back, in a real QGIS."""

import numpy as np
import pytest
from qgis_layers import (
    Log,
    assert_same_raster,
    hills,
    point_layer,
    read_raster,
    survey,
    wkt_layer,
    write_las,
    write_raster,
)


@pytest.fixture(scope="module")
def pyramid(qgis, tmp_path_factory):
    """Return the results of an analysis in five levels of a small DEM."""
    import processing

    folder = tmp_path_factory.mktemp("levels")
    path = write_raster(folder / "dem.tif", hills().astype("float32"), -9999.0)
    return processing.run(
        "terrainwavelets:analysedem",
        {"INPUT": path, "OUTPUT": str(folder / "p.gpkg"), "LEVELS": 5},
    )


def weights_in(path):
    """Return the weight of each attribute that a pyramid file tells of."""
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    pyramid = read_pyramid(path).pyramid
    names = pyramid.channels[-len(pyramid.parameters["attribute_weights"]) :]
    return dict(zip(names, pyramid.parameters["attribute_weights"], strict=True))


class TestDem:
    @pytest.mark.parametrize("dtype", ["uint8", "int16", "uint16", "int32", "float32", "float64"])
    def test_reconstruct_is_bit_identical(self, run, tmp_path, dtype):
        values = (hills() / (2 if dtype == "uint8" else 1)).astype(dtype)
        values[5:9, 10:20] = values.dtype.type(7)
        path = write_raster(tmp_path / "dem é b.tif", values, nodata=7)
        made = run("analysedem", {"INPUT": path, "OUTPUT": str(tmp_path / "out.gpkg")})
        assert made["N_VERTICES"] == values.size - 40
        assert made["COARSE_VERTICES"] < made["N_VERTICES"] / 2
        back = run("reconstruct", {"INPUT": made["OUTPUT"], "DEM": str(tmp_path / "back.tif")})
        assert back["EXACT"] == "yes"
        assert_same_raster(path, back["DEM"])

    def test_nan_and_degrees(self, run, tmp_path):
        values = hills().astype("float32")
        values[20:30, 30:50] = np.nan
        path = write_raster(tmp_path / "dem.tif", values, float("nan"), 4326, (7.0, 44.0), 1 / 1200)
        made = run("analysedem", {"INPUT": path, "OUTPUT": str(tmp_path / "out.gpkg")})
        back = run("reconstruct", {"INPUT": made["OUTPUT"], "DEM": str(tmp_path / "back.tif")})
        assert_same_raster(path, back["DEM"])

    def test_a_mesh_file_of_degrees_is_in_metres(self, run, tmp_path):
        from qgis.core import QgsMeshLayer

        dem = write_raster(
            tmp_path / "dem.tif", hills().astype("float32"), None, 4326, (7.0, 44.0), 1 / 1200
        )
        run("simplifydem", {"INPUT": dem, "VERTICES": 60, "MESH": str(tmp_path / "m.2dm")})
        assert "UTM zone 32N" in (tmp_path / "m.prj").read_text("utf-8")
        assert QgsMeshLayer(str(tmp_path / "m.2dm"), "mesh", "mdal").extent().width() > 1000

    @pytest.mark.parametrize(
        ("filler", "told"),
        [
            (-3.4e38, "which is no elevation"),
            (-9999.0, "the layer's additional nodata value -9999 makes them holes"),
        ],
    )
    def test_what_may_stand_for_nothing_is_told(self, run, tmp_path, filler, told):
        """As on the command line; without a word a pit of 3.4e38 m was the result."""
        values = hills().astype("float32")
        values[5:9, 5:9] = filler
        log = Log()
        parameters = {
            "INPUT": write_raster(tmp_path / "dem.tif", values),
            "OUTPUT": str(tmp_path / "out.gpkg"),
        }
        made = run("analysedem", parameters, log)
        assert made["N_VERTICES"] == 60 * 80 - (16 if filler < -1e30 else 0)
        assert any("16 cells hold" in line and told in line for line in log.warnings)

    def test_nodata_set_in_the_layer_properties_is_a_hole(self, run, tmp_path):
        from qgis.core import QgsRasterLayer, QgsRasterRange

        values = hills().astype("float32")
        values[:10] = -1.0
        layer = QgsRasterLayer(write_raster(tmp_path / "dem.tif", values), "dem")
        layer.dataProvider().setUserNoDataValue(1, [QgsRasterRange(-2.0, -1.0)])
        made = run("analysedem", {"INPUT": layer, "OUTPUT": str(tmp_path / "out.gpkg")})
        assert made["N_VERTICES"] == 50 * 80

    def test_a_layer_of_another_provider_is_read_through_qgis(self, run, tmp_path):
        from qgis.core import QgsRasterLayer

        path = write_raster(tmp_path / "dem.tif", hills().astype("float32"))
        source = QgsRasterLayer(path, "dem")
        uri = (
            "?crs=EPSG:2154&extent=700000,6599400,700800,6600000&width=80&height=60"
            f"&formula=%22dem@1%22%20*%202&dem:uri={path}&dem:provider=gdal"
        )
        virtual = QgsRasterLayer(uri, "virtual", "virtualraster")
        assert source.isValid()
        assert virtual.isValid(), virtual.error().message()
        made = run("analysedem", {"INPUT": virtual, "OUTPUT": str(tmp_path / "out.gpkg")})
        back = run("reconstruct", {"INPUT": made["OUTPUT"], "DEM": str(tmp_path / "back.tif")})
        doubled = np.frombuffer(read_raster(path)["bytes"], "f4").astype("f8") * 2
        restored = read_raster(back["DEM"])
        numbers = np.frombuffer(restored["bytes"], "f4" if restored["type"] == 6 else "f8")
        assert np.array_equal(numbers.astype("f8"), doubled.astype(numbers.dtype).astype("f8"))

    def test_stop_rules_are_kept(self, run, tmp_path):
        path = write_raster(tmp_path / "dem.tif", hills().astype("float32"))
        made = run(
            "analysedem",
            {"INPUT": path, "OUTPUT": str(tmp_path / "out.gpkg"), "TARGET_VERTICES": 321},
        )
        assert made["COARSE_VERTICES"] == 321
        tight = run(
            "analysedem", {"INPUT": path, "OUTPUT": str(tmp_path / "b.gpkg"), "MAX_ERROR": 8.0}
        )
        assert 0 < tight["MAX_ERROR_SURFACE"] <= 8.0

    def test_a_smaller_share_at_a_level_makes_more_levels(self, run, tmp_path):
        path = write_raster(tmp_path / "dem.tif", hills().astype("float32"))
        parameters = {"INPUT": path, "OUTPUT": str(tmp_path / "p.gpkg"), "TARGET_VERTICES": 800}
        default = run("analysedem", parameters)
        told = run("analysedem", {**parameters, "REMOVAL_FRACTION": 0.25})
        small = run("analysedem", {**parameters, "REMOVAL_FRACTION": 0.1})
        assert default["N_LEVELS"] == told["N_LEVELS"]
        assert default["RMSE_SURFACE"] == told["RMSE_SURFACE"]
        assert small["N_LEVELS"] > told["N_LEVELS"]
        assert small["COARSE_VERTICES"] == 800

    def test_the_pyramid_is_a_valid_geopackage_with_styled_layers(self, run, tmp_path):
        from osgeo_utils.samples import validate_gpkg
        from qgis.core import QgsVectorLayer

        path = write_raster(tmp_path / "dem.tif", hills().astype("float32"))
        made = run("analysedem", {"INPUT": path, "OUTPUT": str(tmp_path / "o.gpkg"), "LEVELS": 3})
        validate_gpkg.check(made["OUTPUT"])
        tin = QgsVectorLayer(made["OUTPUT"] + "|layername=coarse_tin", "tin")
        assert tin.featureCount() == made["COARSE_FACES"]
        assert tin.crs().authid() == "EPSG:2154"
        assert tin.renderer().type() == "graduatedSymbol"
        details = QgsVectorLayer(made["OUTPUT"] + "|layername=detail_level_02", "details")
        assert {"vertex_id", "level", "w_z", "magnitude"} <= set(details.fields().names())
        assert details.hasSpatialIndex() == details.SpatialIndexPresence.SpatialIndexPresent
        assert tin.extent().width() == pytest.approx(790.0)

    @pytest.mark.parametrize("percent", [1, 20, 60])
    def test_cancel_leaves_nothing_behind(self, run, tmp_path, percent):
        path = write_raster(tmp_path / "dem.tif", hills(200, 200).astype("float32"))
        log = Log(cancel_at=percent)
        folder = tmp_path / "results"
        folder.mkdir()
        made = run("analysedem", {"INPUT": path, "OUTPUT": str(folder / "o.gpkg")}, feedback=log)
        assert not made.get("OUTPUT")
        assert list(folder.iterdir()) == []
        assert max(log.fractions) < 100


class TestLevels:
    def test_every_output_of_a_level(self, run, pyramid, tmp_path):
        from qgis.core import QgsMeshLayer, QgsRasterLayer

        made = run(
            "extractlevel",
            {
                "INPUT": pyramid["OUTPUT"],
                "LEVEL": 2,
                "TIN": "TEMPORARY_OUTPUT",
                "VERTICES": "TEMPORARY_OUTPUT",
                "RASTER": str(tmp_path / "level.tif"),
                "MESH": str(tmp_path / "level.2dm"),
            },
        )
        assert made["TIN"].featureCount() == made["N_FACES"]
        assert made["VERTICES"].featureCount() == made["N_VERTICES"]
        area = sum(feature.geometry().area() for feature in made["TIN"].getFeatures())
        assert area == pytest.approx(590 * 790)
        raster = QgsRasterLayer(made["RASTER"], "level")
        assert (raster.width(), raster.height()) == (80, 60)
        mesh = QgsMeshLayer(made["MESH"], "mesh", "mdal")
        assert mesh.isValid()
        assert mesh.dataProvider().faceCount() == made["N_FACES"]

    def test_the_raster_of_the_finest_level_is_the_dem(self, run, pyramid, tmp_path):
        made = run(
            "extractlevel",
            {"INPUT": pyramid["OUTPUT"], "LEVEL": 5, "RASTER": str(tmp_path / "finest.tif")},
        )
        back = run("reconstruct", {"INPUT": pyramid["OUTPUT"], "DEM": str(tmp_path / "dem.tif")})
        assert read_raster(made["RASTER"])["bytes"] == read_raster(back["DEM"])["bytes"]
        assert made["RMSE_SURFACE"] == pytest.approx(0.0, abs=1e-9)

    def test_a_size_or_an_accuracy_between_two_levels(self, run, refused, pyramid):
        parameters = {"INPUT": pyramid["OUTPUT"], "TIN": "TEMPORARY_OUTPUT"}
        size = (pyramid["COARSE_VERTICES"] + pyramid["N_VERTICES"]) // 2
        log = Log()
        made = run("extractlevel", {**parameters, "VERTICES_WANTED": size}, feedback=log)
        assert made["N_VERTICES"] == size
        assert 0 < made["FOUND_LEVEL"] <= pyramid["N_LEVELS"]
        assert any(line.split()[:1] == ["0"] for line in log.lines), "the table of levels"
        coarse = run("extractlevel", {**parameters, "MAX_ERROR": 1e9})
        fine = run("extractlevel", {**parameters, "MAX_ERROR": 0.2})
        assert coarse["N_VERTICES"] == pyramid["COARSE_VERTICES"]
        assert fine["N_VERTICES"] > coarse["N_VERTICES"]
        both = {**parameters, "MAX_ERROR": 1.0, "LEVEL": 1}
        assert "one of three" in refused("extractlevel", both)

    def test_a_level_that_is_not_there(self, refused, pyramid):
        message = refused(
            "extractlevel", {"INPUT": pyramid["OUTPUT"], "LEVEL": 9, "TIN": "TEMPORARY_OUTPUT"}
        )
        assert "0 (coarsest) to 5" in message

    def test_a_geopackage_that_is_no_pyramid(self, refused, run, tmp_path):
        import processing

        layer = point_layer(survey(10))
        path = str(tmp_path / "other.gpkg")
        processing.run("native:savefeatures", {"INPUT": layer, "OUTPUT": path})
        message = refused("extractlevel", {"INPUT": path, "TIN": "TEMPORARY_OUTPUT"})
        assert "pyramid" in message

    def test_details_are_all_the_vertices_that_went(self, run, pyramid):
        made = run("detaillayers", {"INPUT": pyramid["OUTPUT"], "OUTPUT": "TEMPORARY_OUTPUT"})
        went = pyramid["N_VERTICES"] - pyramid["COARSE_VERTICES"]
        assert made["N_DETAILS"] == went == made["OUTPUT"].featureCount()
        assert {f["level"] for f in made["OUTPUT"].getFeatures()} == set(range(5))
        fewer = run(
            "detaillayers",
            {
                "INPUT": pyramid["OUTPUT"],
                "OUTPUT": "TEMPORARY_OUTPUT",
                "FIRST_LEVEL": 1,
                "LAST_LEVEL": 2,
                "MIN_MAGNITUDE": 0.01,
            },
        )
        rows = list(fewer["OUTPUT"].getFeatures())
        assert {f["level"] for f in rows} == {1, 2}
        assert min(f["magnitude"] for f in rows) >= 0.01

    def test_outputs_open_styled(self, run, pyramid, tmp_path):
        import processing
        from qgis.core import QgsProcessingContext, QgsProject

        project = QgsProject.instance()
        context = QgsProcessingContext()
        context.setProject(project)
        processing.runAndLoadResults(
            "terrainwavelets:detaillayers",
            {"INPUT": pyramid["OUTPUT"], "OUTPUT": "TEMPORARY_OUTPUT"},
            context=context,
        )
        processing.runAndLoadResults(
            "terrainwavelets:extractlevel",
            {
                "INPUT": pyramid["OUTPUT"],
                "TIN": "TEMPORARY_OUTPUT",
                "MESH": str(tmp_path / "mesh.2dm"),
            },
            context=context,
        )
        processing.runAndLoadResults(
            "terrainwavelets:reconstruct",
            {"INPUT": pyramid["OUTPUT"], "DEM": str(tmp_path / "dem.tif")},
            context=context,
        )
        layers = {layer.name(): layer for layer in project.mapLayers().values()}
        assert layers["Details by level"].renderer().type() == "categorizedSymbol"
        assert layers["TIN of the level"].renderer().type() == "graduatedSymbol"
        assert layers["Reconstructed DEM"].renderer().type() == "hillshade"
        assert layers["mesh"].crs().authid() == "EPSG:2154"
        assert all(layer.crs().isValid() for layer in layers.values())
        project.clear()


def samples_along(line, n=1000):
    """Return points in plan at equal distances along a line, its ends left out."""
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = (np.arange(n) + 0.5) / n * along[-1]
    return np.column_stack([np.interp(at, along, column) for column in line.T])


def heights_on(triangles, plan):
    """Return the height of a TIN at positions; NaN where it has none."""
    heights = np.full(len(plan), np.nan)
    for a, b, c in triangles:
        system = np.array([b[:2] - a[:2], c[:2] - a[:2]]).T
        u, v = np.linalg.solve(system, (plan - a[:2]).T)
        inside = (u > -1e-9) & (v > -1e-9) & (u + v < 1 + 1e-9)
        heights[inside] = (a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]))[inside]
    return heights


class TestPointsAndTins:
    def test_points_with_attributes_breaklines_clip_and_locks(self, run, tmp_path):
        xyz = survey()
        rows = [(int(x > 700500), int(y < 6600010)) for x, y, _ in xyz]
        layer = point_layer(xyz, fields=("kind:integer", "lock:integer"), rows=rows)
        lines = wkt_layer(
            "LineString",
            [
                "LineString (700100 6600500, 700900 6600500)",
                "LineString (700500 6599000, 700500 6602000)",
            ],
        )
        polygon = (
            "Polygon ((700050 6600050, 700950 6600050, 700950 6600950, 700500 6600700, "
            "700050 6600950, 700050 6600050))"
        )
        clip = wkt_layer("Polygon", [polygon])
        made = run(
            "analysetin",
            {
                "INPUT": layer,
                "ATTRIBUTES": ["kind"],
                "LOCK_FIELD": "lock",
                "BREAKLINES": lines,
                "CLIP": clip,
                "OUTPUT": str(tmp_path / "p.gpkg"),
                "COARSE_TIN": "TEMPORARY_OUTPUT",
            },
        )
        triangles = [feature.geometry() for feature in made["COARSE_TIN"].getFeatures()]
        clip_geometry = next(clip.getFeatures()).geometry()
        assert sum(t.area() for t in triangles) == pytest.approx(clip_geometry.area())
        # The breaklines are edges still, also at the coarsest level: no triangle straddles them.
        for triangle in triangles:
            ys = [p.y() for p in triangle.vertices()]
            xs = [p.x() for p in triangle.vertices()]
            assert not (min(xs) < 700499 and max(xs) > 700501 and min(ys) < 6600700)
            inside = min(xs) >= 700100 - 1e-6 and max(xs) <= 700900 + 1e-6
            assert not (inside and min(ys) < 6600499 and max(ys) > 6600501)

    def test_points_of_one_place_are_told_and_counted(self, run, tmp_path):
        from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

        xyz = survey()
        layer = point_layer(np.concatenate([xyz, xyz[:30] + np.array([0.0, 0.0, 12.0])]))
        log = Log()
        output = str(tmp_path / "p.gpkg")
        run("analysetin", {"INPUT": layer, "LEVELS": 2, "OUTPUT": output}, feedback=log)
        (told,) = [line for line in log.warnings if "share x and y" in line]
        assert "30 points share x and y with others; the lowest" in told
        assert "up to 12 off" in told
        errors = read_pyramid(output).errors
        assert min(level.max_error_surface for level in errors) == pytest.approx(12.0)

    def test_lines_without_z_lie_on_the_terrain_at_all_of_their_points(self, run, tmp_path):
        from scipy.interpolate import LinearNDInterpolator

        xyz = survey()
        tolerance = 0.25
        line = np.array([[700100.0, 6600200], [700850, 6600420], [700300, 6600900]])
        ring = np.array(
            [[700060.0, 6600050], [700930, 6600080], [700900, 6600960], [700080, 6600930]]
        )
        ring = np.vstack([ring, ring[:1]])
        text = [", ".join(f"{x} {y}" for x, y in part) for part in (line, ring)]
        made = run(
            "analysetin",
            {
                "INPUT": point_layer(xyz),
                "BREAKLINES": wkt_layer("LineString", [f"LineString ({text[0]})"]),
                "CLIP": wkt_layer("Polygon", [f"Polygon (({text[1]}))"]),
                "LINE_TOLERANCE": tolerance,
                "TARGET_VERTICES": 500,
                "OUTPUT": str(tmp_path / "p.gpkg"),
                "COARSE_TIN": "TEMPORARY_OUTPUT",
            },
        )
        assert made["COARSE_VERTICES"] == 500
        terrain = LinearNDInterpolator(xyz[:, :2] - xyz[0, :2], xyz[:, 2])
        triangles = np.array(
            [
                [(p.x(), p.y(), p.z()) for p in list(feature.geometry().vertices())[:3]]
                for feature in made["COARSE_TIN"].getFeatures()
            ]
        )
        for name, part in (("line", line), ("ring", ring)):
            distance = heights_on(triangles, samples_along(part)) - terrain(
                samples_along(part) - xyz[0, :2]
            )
            assert np.isfinite(distance).sum() > 900
            assert np.nanmax(np.abs(distance)) <= tolerance + 1e-6, name
        assert 0 < made["RMSE_LINES"] <= made["MAX_ERROR_LINES"] <= tolerance + 1e-9

    def test_a_field_gives_the_elevation_and_a_selection_is_respected(self, run, tmp_path):
        import processing
        from qgis.core import QgsProcessingFeatureSourceDefinition, QgsProject

        xyz = survey(500)
        layer = point_layer(
            np.column_stack([xyz[:, :2], np.zeros(500)]),
            fields=("height:double",),
            rows=[(float(z),) for z in xyz[:, 2]],
        )
        layer.selectByIds(list(range(1, 301)))
        QgsProject.instance().addMapLayer(layer)
        try:
            made = processing.run(
                "terrainwavelets:analysetin",
                {
                    "INPUT": QgsProcessingFeatureSourceDefinition(layer.id(), True),
                    "Z_FIELD": "height",
                    "OUTPUT": str(tmp_path / "p.gpkg"),
                },
            )
        finally:
            QgsProject.instance().removeMapLayer(layer.id())
        assert made["N_VERTICES"] == 300
        back = run("reconstruct", {"INPUT": made["OUTPUT"], "TIN": "TEMPORARY_OUTPUT"})
        top = max(p.z() for f in back["TIN"].getFeatures() for p in f.geometry().vertices())
        assert top == pytest.approx(xyz[:300, 2].max())

    def test_weights_are_those_of_the_named_fields(self, run, refused, tmp_path):
        xyz = survey(400)
        rows = [(float(x), float(y)) for x, y, _ in xyz]
        layer = point_layer(xyz, fields=("east:double", "north:double"), rows=rows)
        parameters = {
            "INPUT": layer,
            "ATTRIBUTES": ["north", "east"],
            "OUTPUT": str(tmp_path / "p.gpkg"),
        }
        made = run("analysetin", {**parameters, "ATTRIBUTE_WEIGHTS": ["east", 0.25]})
        assert weights_in(made["OUTPUT"]) == {"north": 1.0, "east": 0.25}
        message = refused("analysetin", {**parameters, "ATTRIBUTE_WEIGHTS": ["up", 0.25]})
        assert "north, east" in message
        message = refused("analysetin", {**parameters, "ATTRIBUTE_WEIGHTS": ["east", "heavy"]})
        assert "such as intensity and 0.5" in message
        message = refused("analysetin", {**parameters, "ATTRIBUTE_WEIGHTS": ["east", -1]})
        assert "0 or more" in message

    def test_triangles_come_back_as_they_were(self, run, tmp_path):
        first = run(
            "analysetin",
            {
                "INPUT": point_layer(survey(400)),
                "LEVELS": 2,
                "OUTPUT": str(tmp_path / "a.gpkg"),
                "COARSE_TIN": "TEMPORARY_OUTPUT",
            },
        )
        second = run(
            "analysetin", {"INPUT": first["COARSE_TIN"], "OUTPUT": str(tmp_path / "b.gpkg")}
        )
        assert second["N_FACES"] == first["COARSE_FACES"]
        back = run("reconstruct", {"INPUT": second["OUTPUT"], "TIN": "TEMPORARY_OUTPUT"})

        def corners(layer):
            return sorted(
                sorted(
                    (round(p.x(), 6), round(p.y(), 6), round(p.z(), 6))
                    for p in f.geometry().vertices()
                )
                for f in layer.getFeatures()
            )

        assert corners(back["TIN"]) == corners(first["COARSE_TIN"])

    def test_breaklines_in_another_crs_are_transformed(self, run, tmp_path):
        from qgis.core import (
            QgsCoordinateReferenceSystem,
            QgsCoordinateTransform,
            QgsGeometry,
            QgsProject,
        )

        geometry = QgsGeometry.fromWkt("LineString (700100 6600500, 700900 6600500)")
        to_degrees = QgsCoordinateTransform(
            QgsCoordinateReferenceSystem("EPSG:2154"),
            QgsCoordinateReferenceSystem("EPSG:4326"),
            QgsProject.instance(),
        )
        geometry.transform(to_degrees)
        made = run(
            "analysetin",
            {
                "INPUT": point_layer(survey()),
                "BREAKLINES": wkt_layer("LineString", [geometry.asWkt(12)], "EPSG:4326"),
                "OUTPUT": str(tmp_path / "p.gpkg"),
                "COARSE_TIN": "TEMPORARY_OUTPUT",
            },
        )
        corners = [p for f in made["COARSE_TIN"].getFeatures() for p in f.geometry().vertices()]
        ends = [p for p in corners if abs(p.y() - 6600500) < 0.01]
        assert min(p.x() for p in ends) == pytest.approx(700100, abs=0.01)
        assert max(p.x() for p in ends) == pytest.approx(700900, abs=0.01)


class TestPointCloud:
    @pytest.fixture
    def cloud(self, tmp_path):
        """Return a LAS file of a slope with a class, an intensity and colours."""
        pytest.importorskip("laspy")
        xyz = survey(600)
        east = (xyz[:, 0] - xyz[:, 0].min()).astype("uint16")
        return write_las(
            tmp_path / "points.las",
            xyz,
            classification=np.where(xyz[:, 1] > 6600500, 5, 2),
            intensity=east,
            red=east + 1,
            green=east[::-1],
            blue=2 * east,
        )

    def test_a_weight_of_rgb_is_that_of_the_three_colours(self, run, cloud, tmp_path):
        made = run(
            "analysepointcloud",
            {
                "INPUT": cloud,
                "ATTRIBUTES": ["intensity", "rgb"],
                "ATTRIBUTE_WEIGHTS": ["rgb", 0.5, "intensity", 0],
                "OUTPUT": str(tmp_path / "p.gpkg"),
            },
        )
        assert weights_in(made["OUTPUT"]) == {
            "intensity": 0.0,
            "red": 0.5,
            "green": 0.5,
            "blue": 0.5,
        }
        back = run(
            "reconstruct",
            {"INPUT": made["OUTPUT"], "POINT_CLOUD": str(tmp_path / "back.las")},
        )
        assert back["EXACT"] == "yes"

    def test_noise_duplicates_and_gaps(self, run, tmp_path):
        pytest.importorskip("laspy")
        xyz = survey(600)
        xyz = xyz[np.abs(xyz[:, 0] - 700500) > 200]  # a gap of 400 m across
        pit, above = xyz[:1] - np.array([-1, -1, 50]), xyz[1:2] + np.array([0, 0, 3])
        path = write_las(
            tmp_path / "points.las",
            np.vstack([xyz, pit, above]),
            classification=np.array([2] * len(xyz) + [7, 2]),
        )

        def analysed(name, **options):
            output = str(tmp_path / f"{name}.gpkg")
            made = run("analysepointcloud", {"INPUT": path, "OUTPUT": output, **options})
            layer = {"INPUT": output, "LEVEL": made["N_LEVELS"], "VERTICES": "TEMPORARY_OUTPUT"}
            heights = [f["elevation"] for f in run("extractlevel", layer)["VERTICES"].getFeatures()]
            return made, np.array(heights)

        plain, heights = analysed("plain")
        assert plain["N_VERTICES"] == len(xyz)
        assert heights.min() > 80
        assert analysed("noise", KEEP_NOISE=True)[1].min() < 80
        highest = analysed("highest", DUPLICATES="highest")[1]
        assert highest.sum() == pytest.approx(heights.sum() + 3)
        with_gap, _ = analysed("gap", MAX_EDGE=150)
        assert with_gap["N_FACES"] < plain["N_FACES"]
        assert analysed("auto", MAX_EDGE=0)[0]["N_FACES"] < plain["N_FACES"]

    def test_a_weight_of_what_is_not_analysed_is_refused(self, refused, cloud, tmp_path):
        parameters = {"INPUT": cloud, "OUTPUT": str(tmp_path / "p.gpkg")}
        weights = {"ATTRIBUTE_WEIGHTS": ["rgb", 0.5]}
        assert "choose the attributes" in refused("analysepointcloud", {**parameters, **weights})
        parameters["ATTRIBUTES"] = ["intensity"]
        message = refused("analysepointcloud", {**parameters, **weights})
        assert "no attribute rgb" in message
        assert "intensity" in message
