"""A DEM to a TIN of fewer vertices, in a real QGIS."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from qgis_layers import Log, hills, numbers, read_raster, write_raster


class TestSimplify:
    @pytest.fixture
    def dem(self, tmp_path):
        return write_raster(tmp_path / "dem.tif", hills(90, 70).astype("float32"), -9999.0)

    def test_the_number_of_vertices_is_exact(self, run, dem, tmp_path):
        made = run(
            "simplifydem",
            {
                "INPUT": dem,
                "VERTICES": 400,
                "TIN": "TEMPORARY_OUTPUT",
                "RASTER": str(tmp_path / "r.tif"),
                "MESH": str(tmp_path / "m.2dm"),
                "OUTPUT": str(tmp_path / "p.gpkg"),
            },
        )
        assert made["N_VERTICES"] == 400
        assert made["TIN"].featureCount() == made["N_FACES"]
        error = numbers(made["RASTER"]) - numbers(dem)
        assert np.sqrt(np.mean(error**2)) == pytest.approx(made["RMSE_SURFACE"], rel=1e-3)
        assert np.abs(error).max() == pytest.approx(made["MAX_ERROR_SURFACE"], rel=1e-3)
        back = run("reconstruct", {"INPUT": made["OUTPUT"], "DEM": str(tmp_path / "b.tif")})
        assert back["EXACT"] == "yes"

    def test_the_bar_never_runs_back_whichever_outputs_are_wanted(self, run, dem, tmp_path):
        """The TIN began behind where the pyramid had ended."""
        outputs = {"TIN": "TEMPORARY_OUTPUT", "OUTPUT": str(tmp_path / "p.gpkg")}
        log = Log()
        run("simplifydem", {"INPUT": dem, "VERTICES": 300, **outputs}, log)
        assert max(log.fractions) >= 90
        steps = list(pairwise(log.fractions))
        assert [step for step in steps if step[1] < step[0]] == []

    def test_fitted_heights_have_the_smaller_mean_square(self, run, dem):
        parameters = {"INPUT": dem, "VERTICES": 200, "TIN": "TEMPORARY_OUTPUT"}
        fitted, lifted = run("simplifydem", parameters), run("simplifydem", parameters | {"FIT": 0})
        assert fitted["RMSE_SURFACE"] < 0.97 * lifted["RMSE_SURFACE"]

    @pytest.mark.parametrize(
        ("rule", "figure"), [("MAX_ERROR", "MAX_ERROR_SURFACE"), ("RMSE", "RMSE_SURFACE")]
    )
    def test_a_tolerance_is_kept(self, run, dem, rule, figure):
        made = run("simplifydem", {"INPUT": dem, rule: 6.0, "TIN": "TEMPORARY_OUTPUT"})
        assert 0 < made[figure] <= 6.0
        assert made["N_VERTICES"] < 6300

    @pytest.mark.parametrize(
        ("suffix", "start"),
        [
            (".2dm", b"MESH2D"),
            (".ply", b"ply"),
            (".obj", b"#"),
            (".stl", b"origin"),
            (".glb", b"glTF"),
            (".xml", b"<?xml"),
            (".dxf", b"  0"),
            (".slf", b"\0\0\0\x50terrain-wavelets"),
        ],
    )
    def test_every_mesh_format(self, run, dem, tmp_path, suffix, start):
        library = {".glb": "trimesh", ".dxf": "ezdxf", ".slf": "serafin"}.get(suffix)
        if library:
            pytest.importorskip(library)
        path = tmp_path / f"m{suffix}"
        made = run("simplifydem", {"INPUT": dem, "VERTICES": 60, "MESH": str(path)})
        assert made["MESH"] == str(path)
        content = path.read_bytes()
        assert content.startswith(start)
        n_written = {
            ".2dm": content.count(b"E3T"),
            ".stl": int.from_bytes(content[80:84], "little"),
            ".xml": content.count(b"<F>"),
            ".dxf": content.count(b"3DFACE"),
        }
        if suffix in n_written:
            assert n_written[suffix] == made["N_FACES"]

    def test_two_rules_are_refused(self, provider, dem):
        from qgis.core import QgsProcessingContext

        algorithm = provider.algorithm("simplifydem").create()
        is_fine, message = algorithm.checkParameterValues(
            {"INPUT": dem, "VERTICES": 5, "RMSE": 1.0}, QgsProcessingContext()
        )
        assert not is_fine
        assert "one of three" in message

    def test_the_number_of_vertices_is_no_output(self, run, dem, tmp_path, monkeypatch):
        here = tmp_path / "here"
        here.mkdir()
        monkeypatch.chdir(here)
        made = run("simplifydem", {"INPUT": dem, "VERTICES": 60, "TIN": "TEMPORARY_OUTPUT"})
        assert "VERTICES" not in made
        assert list(here.iterdir()) == []

    def test_without_a_rule_a_twentieth_of_the_cells_stays(self, run, dem):
        made = run("simplifydem", {"INPUT": dem, "TIN": "TEMPORARY_OUTPUT"})
        assert made["N_VERTICES"] == round(made["N_INPUT_VERTICES"] / 20)


def test_an_outline_that_may_move_lets_a_level_be_coarser(run, tmp_path):
    values = hills(40, 50).astype("float32")
    rows, columns = np.mgrid[:40, :50]
    values[np.hypot(rows - 20, columns - 25) > 17] = -9999.0
    path = write_raster(tmp_path / "round.tif", values, -9999.0)
    parameters = {"INPUT": path, "VERTICES": 12, "TIN": "TEMPORARY_OUTPUT"}
    log = Log()
    fixed = run("simplifydem", parameters, feedback=log)
    assert fixed["N_VERTICES"] > 12
    assert any("12" in line and "asked" in line for line in log.lines), log.lines
    moved = run("simplifydem", {**parameters, "OUTLINE_TOLERANCE": 40.0})
    assert moved["N_VERTICES"] == 12


class TestToleranceByPlace:
    @pytest.fixture
    def dem(self, tmp_path):
        return write_raster(tmp_path / "dem.tif", hills(40, 50).astype("float32"))

    @pytest.fixture
    def zones(self, dem):
        """Two overlapping polygons over the west of the DEM, the smaller the stricter."""
        from qgis.core import QgsFeature, QgsGeometry, QgsRectangle, QgsVectorLayer

        raster = read_raster(dem)
        west, width, _, north, _, height = raster["transform"]
        layer = QgsVectorLayer("Polygon?crs=EPSG:2154&field=limit:double", "zones", "memory")
        for n_columns, limit in ((10, 0.1), (25, 1.0), (40, None)):
            area = QgsRectangle(west, north + 40 * height, west + n_columns * width, north)
            feature = QgsFeature(layer.fields())
            feature.setGeometry(QgsGeometry.fromRect(area))
            feature.setAttribute("limit", limit)
            layer.dataProvider().addFeatures([feature])
        return layer

    def test_zones(self, run, dem, zones, tmp_path):
        log = Log()
        parameters = {
            "INPUT": dem, "MAX_ERROR": 5.0, "ZONES": zones, "ZONE_FIELD": "limit",
            "RASTER": str(tmp_path / "r.tif"), "TIN": "TEMPORARY_OUTPUT",
        }  # fmt: skip
        made = run("simplifydem", parameters, feedback=log)
        error = np.abs(numbers(made["RASTER"]) - numbers(dem))
        assert error[:, :10].max() <= 0.1 + 1e-4
        assert 0.1 < error[:, 10:25].max() <= 1.0 + 1e-4
        assert 1.0 < error[:, 25:].max() <= 5.0 + 1e-4
        assert sum("Within" in line for line in log.lines) == 3

    def test_the_same_out_of_a_pyramid_and_by_a_raster(self, run, dem, tmp_path):
        limits = np.full((40, 50), 4.0, "float32")
        limits[:, :25] = 0.2
        raster = write_raster(tmp_path / "limits.tif", limits)
        pyramid = run("analysedem", {"INPUT": dem, "OUTPUT": str(tmp_path / "p.gpkg")})["OUTPUT"]
        sizes = {}
        for name, source in (("simplifydem", dem), ("extractlevel", pyramid)):
            parameters = {"INPUT": source, "TOLERANCE": raster, "RASTER": str(tmp_path / "r.tif")}
            if name == "extractlevel":
                parameters["REFINE"] = 8
            made = run(name, parameters)
            error = np.abs(numbers(made["RASTER"]) - numbers(dem))
            assert (error <= limits + 1e-4).all()
            sizes[name] = made["N_VERTICES"]
        assert sizes["extractlevel"] < 1.1 * sizes["simplifydem"]

    def test_what_contradicts_is_refused(self, run, dem, zones, refused):
        for parameters in (
            {"ZONES": zones, "MAX_ERROR": 1.0},
            {"ZONES": zones, "ZONE_FIELD": "limit", "VERTICES": 100},
            {"TOLERANCE": dem, "MAX_ERROR": 1.0},
        ):
            refused("simplifydem", {"INPUT": dem, "TIN": "TEMPORARY_OUTPUT", **parameters})


def test_a_ugrid_mesh_opens_as_a_mesh_layer_with_its_crs(run, tmp_path):
    from qgis.core import QgsMeshDatasetIndex, QgsMeshLayer

    dem = write_raster(tmp_path / "dem.tif", hills(40, 50).astype("float32"))
    made = run("simplifydem", {"INPUT": dem, "VERTICES": 300, "MESH": str(tmp_path / "a.nc")})
    layer = QgsMeshLayer(made["MESH"], "mesh", "mdal")
    assert layer.isValid()
    assert layer.meshVertexCount() == 300
    assert layer.crs().authid() == "EPSG:2154"
    heights = layer.datasetGroupMetadata(QgsMeshDatasetIndex(0))
    values = numbers(dem)
    assert values.min() - 5 < heights.minimum() < heights.maximum() < values.max() + 5


def test_a_selafin_mesh_opens_as_a_mesh_layer_with_its_bed(run, tmp_path):
    from qgis.core import QgsMesh, QgsMeshDatasetIndex, QgsMeshLayer

    pytest.importorskip("serafin")
    dem = write_raster(tmp_path / "dem.tif", hills(40, 50).astype("float32"))
    parameters = {"INPUT": dem, "VERTICES": 300, "FIT": False}
    made, as_text = (
        run("simplifydem", {**parameters, "MESH": str(tmp_path / f"a{suffix}")})
        for suffix in (".slf", ".2dm")
    )
    layer, text_layer = (QgsMeshLayer(one["MESH"], "mesh", "mdal") for one in (made, as_text))
    assert layer.isValid()
    read, other = QgsMesh(), QgsMesh()
    layer.dataProvider().populateMesh(read)
    text_layer.dataProvider().populateMesh(other)
    assert read.vertexCount() == other.vertexCount() == 300
    assert [list(read.face(k)) for k in range(read.faceCount())] == [
        list(other.face(k)) for k in range(other.faceCount())
    ]
    bed = layer.dataProvider().datasetValues(QgsMeshDatasetIndex(0, 0), 0, 300)
    for k in range(300):
        here, there = read.vertex(k), other.vertex(k)
        assert (here.x(), here.y()) == (there.x(), there.y())
        assert bed.value(k).scalar() == pytest.approx(there.z(), rel=1e-14)


def one_polygon(rectangle, **fields):
    from qgis.core import QgsFeature, QgsGeometry, QgsVectorLayer

    of_fields = "".join(f"&field={name}:double" for name in fields)
    layer = QgsVectorLayer(f"Polygon?crs=EPSG:2154{of_fields}", "zones", "memory")
    feature = QgsFeature(layer.fields())
    feature.setGeometry(QgsGeometry.fromRect(rectangle))
    for name, value in fields.items():
        feature.setAttribute(name, value)
    layer.dataProvider().addFeatures([feature])
    return layer


class TestSolverMesh:
    @pytest.fixture
    def dem(self, tmp_path):
        return write_raster(tmp_path / "dem.tif", hills(40, 50).astype("float32"))

    def test_without_the_package_it_says_which_and_how(self, run, dem, monkeypatch):
        from terrain_wavelets.plugin.ui import dependencies

        found = dependencies.missing
        monkeypatch.setattr(
            dependencies,
            "missing",
            lambda packages: (
                found(p for p in packages if p.module != "CGAL")
                + [p for p in packages if p.module == "CGAL"]
            ),
        )
        from qgis.core import QgsProcessingException

        log = Log()
        with pytest.raises(QgsProcessingException):
            run("simplifydem", {"INPUT": dem, "MIN_ANGLE": 20.0, "TIN": "memory:"}, log)
        (told,) = [line for line in log.errors if "cgal" in line]
        assert told.startswith("missing Python package: ")
        assert "cgal" in told.split("Install it")[0]
        assert "cgal" in told.split("Install it")[1]

    def test_bounds_that_no_mesh_can_keep_are_refused_at_once(self, provider, dem):
        from qgis.core import QgsProcessingContext

        algorithm = provider.algorithm("simplifydem")
        parameters = {"INPUT": dem, "TIN": "memory:", "LONGEST_EDGE": 30.0, "SHORTEST_EDGE": 20.0}
        is_fine, why = algorithm.checkParameterValues(parameters, QgsProcessingContext())
        assert not is_fine
        assert "'Shortest edge for a solver' is more than half of 'Longest edge" in why

    def test_the_bounds_hold(self, run, dem):
        pytest.importorskip("CGAL")
        pytest.importorskip("shapely")
        log = Log()
        parameters = {"INPUT": dem, "VERTICES": 100, "MIN_ANGLE": 25.0, "LONGEST_EDGE": 60.0}
        made = run("simplifydem", {**parameters, "TIN": "memory:"}, log)
        assert made["N_VERTICES"] > 100
        for feature in made["TIN"].getFeatures():
            corners = [(v.x(), v.y()) for v in feature.geometry().vertices()][:3]
            sides = [np.hypot(a[0] - b[0], a[1] - b[1]) for a, b in combinations(corners, 2)]
            assert max(sides) <= 60.0 + 1e-6
        assert any(line.startswith("Angles ") for line in log.lines)

    def test_sizes_of_zones_and_of_a_raster_hold(self, run, dem, tmp_path):
        """Each triangle against the input points in it, for the point of the zone's own fields."""
        pytest.importorskip("CGAL")
        pytest.importorskip("shapely")
        from qgis.core import QgsPointXY, QgsRasterLayer, QgsRectangle

        frame = QgsRasterLayer(dem).extent()
        middle = (frame.xMinimum() + frame.xMaximum()) / 2
        zone = QgsRectangle(frame.xMinimum(), frame.yMinimum(), middle, frame.yMaximum())
        zones = one_polygon(zone, edge=12.0, area=150.0)
        parameters = {"INPUT": dem, "VERTICES": 100, "TIN": "memory:", "SIZE_ZONES": zones}
        step = frame.width() / 50
        for options, left, right in (
            ({"SIZE_FIELD": "edge", "LONGEST_EDGE": 60.0}, 12.0, 60.0),
            ({"AREA_FIELD": "area"}, (150.0 * 4 / 3**0.5) ** 0.5, np.inf),
            ({"SIZE_FIELD": "edge", "GRADING": 0.5}, 12.0, np.inf),
        ):
            made = run("simplifydem", {**parameters, **options})
            n_inside = 0
            for feature in made["TIN"].getFeatures():
                geometry = feature.geometry()
                corners = [(v.x(), v.y()) for v in geometry.vertices()][:3]
                longest = max(
                    np.hypot(a[0] - b[0], a[1] - b[1]) for a, b in combinations(corners, 2)
                )
                box = geometry.boundingBox()
                for x in np.arange(frame.xMinimum() + step / 2, box.xMaximum(), step):
                    for y in np.arange(frame.yMinimum() + step / 2, box.yMaximum(), step):
                        if x < box.xMinimum() or y < box.yMinimum():
                            continue
                        if geometry.contains(QgsPointXY(x, y)):
                            n_inside += 1
                            assert longest <= (left if x < middle else right) + 1e-6
            assert n_inside > 500
        sizes = np.full((40, 50), 12.0, dtype="float32")
        raster = write_raster(tmp_path / "sizes.tif", sizes)
        made = run(
            "simplifydem", {"INPUT": dem, "VERTICES": 100, "TIN": "memory:", "SIZE_RASTER": raster}
        )
        for feature in made["TIN"].getFeatures():
            corners = [(v.x(), v.y()) for v in feature.geometry().vertices()][:3]
            sides = [np.hypot(a[0] - b[0], a[1] - b[1]) for a, b in combinations(corners, 2)]
            assert max(sides) <= 12.0 + 1e-6

    def test_sizes_that_say_nothing_are_refused(self, provider, dem):
        from qgis.core import QgsProcessingContext, QgsRectangle

        zones = one_polygon(QgsRectangle(0, 0, 9, 9), edge=5.0)
        for options, why in (
            ({"SIZE_ZONES": zones}, "zones of other sizes and a field"),
            ({"SIZE_RASTER": dem, "LONGEST_EDGE": 5.0}, "not both"),
        ):
            parameters = {"INPUT": dem, "TIN": "memory:", "VERTICES": 50, **options}
            algorithm = provider.algorithm("simplifydem").create()
            is_fine, told = algorithm.checkParameterValues(parameters, QgsProcessingContext())
            assert not is_fine
            assert why in told
