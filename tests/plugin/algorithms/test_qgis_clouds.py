"""Point clouds simplified and thinned, in a real QGIS."""

import numpy as np
import pytest
from qgis_layers import Log, survey, write_las

laspy = pytest.importorskip("laspy")


@pytest.fixture
def cloud(tmp_path):
    """Return a LAS file of a slope whose northern half is trees."""
    xyz = survey(3000)
    is_tree = xyz[:, 1] > 6_600_500
    xyz[is_tree, 2] += 15
    return write_las(
        tmp_path / "points.las",
        xyz,
        classification=np.where(is_tree, 5, 2),
        intensity=np.arange(3000) % 500,
        return_number=np.ones(3000, dtype="u1"),
        number_of_returns=np.ones(3000, dtype="u1"),
    )


def rows(las):
    """Return every stored field of the points, one tuple a point."""
    return {tuple(point.tolist()) for point in las.points.array}


def test_a_first_click_gives_the_tin_of_the_ground(run, cloud):
    log = Log()
    made = run("simplifypointcloud", {"INPUT": cloud, "TIN": "memory:"}, feedback=log)
    n_ground = int((laspy.read(cloud)["classification"] == 2).sum())
    assert made["N_INPUT_VERTICES"] == n_ground
    assert made["N_VERTICES"] == max(round(0.05 * n_ground), 3)
    assert any(f"{n_ground} points of the ground" in line for line in log.lines)
    assert made["TIN"].featureCount() == made["N_FACES"]


def test_a_file_without_classes_is_taken_whole_and_the_log_says_so(run, tmp_path):
    path = write_las(tmp_path / "plain.las", survey(500))
    log = Log()
    made = run("simplifypointcloud", {"INPUT": path, "TIN": "memory:"}, feedback=log)
    assert made["N_INPUT_VERTICES"] == 500
    assert any("all points, since none is classified" in line for line in log.lines)


def test_the_thinned_points_are_those_of_the_file_with_all_their_dimensions(run, cloud, tmp_path):
    thinned = str(tmp_path / "thin.las")
    made = run(
        "thinpointcloud",
        {"INPUT": cloud, "CLASSES": "2,5", "VERTICES": 200, "THINNED": thinned, "TIN": None},
    )
    before, after = laspy.read(cloud), laspy.read(thinned)
    assert len(after.points) == made["N_VERTICES"] == 200
    assert rows(after) <= rows(before)
    assert len(rows(after)) == 200
    assert after.header.parse_crs() == before.header.parse_crs()
    assert np.allclose(after.header.maxs, after.xyz.max(axis=0), atol=1e-9)
    assert not made.get("TIN")


def test_the_surface_through_thinned_points_is_as_accurate_as_was_asked(run, cloud, tmp_path):
    from wavelet_core import TriangleMesh
    from wavelet_core.mesh.location import surface_errors

    thinned = str(tmp_path / "thin.laz" if _has_lazrs() else tmp_path / "thin.las")
    made = run("thinpointcloud", {"INPUT": cloud, "MAX_ERROR": 0.5, "THINNED": thinned})
    before, after = laspy.read(cloud), laspy.read(thinned)
    assert set(after["classification"]) == {2}
    ground = before.xyz[before["classification"] == 2]
    errors = surface_errors(TriangleMesh.from_points(np.array(after.xyz)), ground)
    assert np.nanmax(np.abs(errors)) <= 0.5 + 1e-9
    assert made["MAX_ERROR_THINNED"] == pytest.approx(np.nanmax(np.abs(errors)), abs=1e-6)
    assert made["N_THINNED"] == len(after.points) < 0.5 * len(ground)


def test_ground_is_classified_and_all_else_stays(run, tmp_path):
    xyz = survey(3000)
    is_house = (abs(xyz[:, :2] - xyz[:, :2].mean(axis=0)) < 40).all(axis=1)
    xyz[:, 2] = 0.02 * (xyz[:, 0] - xyz[0, 0]) + 25.0 * is_house
    cloud = write_las(tmp_path / "in.las", xyz, intensity=np.arange(3000) % 500)
    log, out = Log(), str(tmp_path / "out.las")
    made = run(
        "classifyground", {"INPUT": cloud, "LARGEST_OBJECT": 120.0, "OUTPUT": out}, feedback=log
    )
    before, after = laspy.read(cloud), laspy.read(out)
    assert np.mean(after["classification"] == np.where(is_house, 1, 2)) > 0.999
    before["classification"][:] = after["classification"]
    assert rows(after) == rows(before)
    assert made["N_GROUND"] == np.count_nonzero(after["classification"] == 2)
    assert made["N_POINTS"] == 3000
    assert any(f"{made['N_GROUND']} of 3000 points are ground" in line for line in log.lines)


def _has_lazrs():
    from importlib.util import find_spec

    return find_spec("lazrs") is not None


#: In place of QGIS's own program, which the QGIS of Linux distributions does not bring.
WRENCH = """#!{python}
import sys, laspy
verb, source, target = sys.argv[1:]
assert verb == "translate"
laspy.read(source.removeprefix("--input=")).write(target.removeprefix("--output="))
"""


@pytest.fixture
def without_lazrs(monkeypatch, tmp_path):
    """Let the plugin find no lazrs, and a program in QGIS's place for it."""
    import sys

    from terrain_wavelets.plugin.qgis_io import laz_unpacker
    from terrain_wavelets.plugin.ui import dependencies

    program = tmp_path / "pdal_wrench"
    program.write_text(WRENCH.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setenv(laz_unpacker.VARIABLE, str(program))
    there = dependencies.missing

    def missing(packages):
        return [p for p in packages if p is dependencies.LAZRS or there([p])]

    monkeypatch.setattr(dependencies, "missing", missing)
    monkeypatch.setattr(laz_unpacker, "missing", missing)
    return program


@pytest.mark.skipif(not _has_lazrs(), reason="a LAZ file is needed to begin with")
class TestWithoutLazrs:
    def test_laz_is_unpacked_by_the_program_that_qgis_brings(self, run, without_lazrs, tmp_path):
        path = write_las(tmp_path / "points.laz", survey(400))
        log = Log()
        made = run("analysepointcloud", {"INPUT": path, "OUTPUT": str(tmp_path / "p.gpkg")}, log)
        assert made["N_VERTICES"] == 400
        assert any("pdal_wrench" in line for line in log.lines)
        back = tmp_path / "back.las"
        run("reconstruct", {"INPUT": made["OUTPUT"], "POINT_CLOUD": str(back)})
        assert rows(laspy.read(back)) == rows(laspy.read(path))

    def test_what_the_program_cannot_unpack_is_refused_in_one_line(
        self, refused, without_lazrs, tmp_path
    ):
        path = tmp_path / "points.laz"
        path.write_bytes(b"LASF")
        told = refused(
            "analysepointcloud", {"INPUT": str(path), "OUTPUT": str(tmp_path / "p.gpkg")}
        )
        assert "pdal_wrench cannot unpack" in told
        assert not (tmp_path / "p.gpkg").exists()

    def test_without_the_program_the_package_is_needed(self, provider, without_lazrs):
        from qgis.core import QgsProcessingContext
        from terrain_wavelets.plugin.parameters.request import Request
        from terrain_wavelets.plugin.ui import dependencies

        def needed(path):
            algorithm = provider.algorithm("analysepointcloud")
            return algorithm.packages(Request(algorithm, {"INPUT": path}, QgsProcessingContext()))

        assert dependencies.LAZRS not in needed("a.laz")
        without_lazrs.unlink()
        assert dependencies.LAZRS in needed("a.laz")
        assert dependencies.LAZRS not in needed("a.las")


def test_zones_are_those_of_a_point_cloud_too(run, cloud):
    from qgis.core import QgsFeature, QgsGeometry, QgsVectorLayer

    zones = QgsVectorLayer("Polygon?crs=EPSG:2154&field=limit:double", "zones", "memory")
    feature = QgsFeature(zones.fields())
    feature.setGeometry(
        QgsGeometry.fromWkt("Polygon ((0 0, 700500 0, 700500 6700000, 0 6700000, 0 0))")
    )
    feature.setAttributes([0.05])
    zones.dataProvider().addFeatures([feature])
    log = Log()
    parameters = {"INPUT": cloud, "ZONES": zones, "ZONE_FIELD": "limit", "MAX_ERROR": 5.0}
    made = run("simplifypointcloud", {**parameters, "TIN": "memory:"}, log)
    assert made["N_VERTICES"] < made["N_INPUT_VERTICES"]
    assert any(line.startswith("Within 0.05: ") for line in log.lines), log.lines


class TestLayers:
    """A point cloud layer of the project; a real one is COPC, which QGIS reads without PDAL."""

    @pytest.fixture
    def project(self, qgis):
        from qgis.core import QgsProject

        yield QgsProject.instance()
        QgsProject.instance().clear()

    @pytest.fixture
    def layer(self, project, data_folder):
        from qgis.core import QgsPointCloudLayer

        path = data_folder / "nasty" / "simple_with_page.copc.laz"
        if not path.is_file():
            pytest.skip("no COPC file at hand")
        pytest.importorskip("lazrs")
        layer = QgsPointCloudLayer(str(path), "lone star", "copc")
        assert layer.isValid()
        project.addMapLayer(layer)
        return layer

    def run_with(self, run, project, name, parameters):
        from qgis.core import QgsProcessingContext

        context, log = QgsProcessingContext(), Log()
        context.setProject(project)
        return run(name, parameters, log, context), log

    def test_a_layer_is_read_from_its_file(self, run, project, layer):
        parameters = {"VERTICES": 100, "REFINE": 0, "TIN": "memory:"}
        by_file = run("simplifypointcloud", {"INPUT": layer.source(), **parameters})
        for named in (layer.id(), layer.name()):
            made, _ = self.run_with(
                run, project, "simplifypointcloud", {"INPUT": named, **parameters}
            )
            assert made["RMSE_SURFACE"] == by_file["RMSE_SURFACE"]
            assert made["TIN"].crs() == by_file["TIN"].crs()

    def test_the_filter_of_a_layer_counts(self, run, project, layer):
        with laspy.open(layer.source()) as file:
            classes = np.array(file.read().classification)
        kept = int(classes[0])
        layer.setSubsetString(f"Classification = {kept}")
        made, log = self.run_with(
            run,
            project,
            "simplifypointcloud",
            {"INPUT": layer.id(), "VERTICES": 100, "REFINE": 0, "TIN": "memory:"},
        )
        assert 0 < made["N_INPUT_VERTICES"] <= (classes == kept).sum()
        assert f"The filter of the layer lone star leaves: {kept}" in log.lines

    def test_a_filter_by_something_else_is_refused(self, provider, project, layer):
        from qgis.core import QgsProcessingContext

        layer.setSubsetString("Intensity > 10")
        context = QgsProcessingContext()
        context.setProject(project)
        is_fine, why = provider.algorithm("simplifypointcloud").checkParameterValues(
            {"INPUT": layer.id(), "TIN": "memory:"}, context
        )
        assert not is_fine
        assert "filter by Classification alone" in why

    def test_the_file_of_a_layer_is_among_those_that_no_result_replaces(
        self, provider, project, layer
    ):
        from qgis.core import QgsProcessingContext
        from terrain_wavelets.plugin.parameters.output_check import _input_files

        context = QgsProcessingContext()
        context.setProject(project)
        algorithm = provider.algorithm("thinpointcloud").create()
        assert layer.source() in _input_files(algorithm, {"INPUT": layer.name()}, context)

    def test_the_dialog_lists_the_layers_of_the_project(self, provider, project, layer):
        from processing.gui.AlgorithmDialog import AlgorithmDialog

        layer.setSubsetString("Classification = 2")
        dialog = AlgorithmDialog(provider.algorithm("thinpointcloud").create(), False, None)
        combo = dialog.mainWidget().wrappers["INPUT"].choice.combo
        assert [combo.itemText(k) for k in range(combo.count())] == [
            "lone star [Classification = 2]"
        ]
        assert dialog.mainWidget().wrappers["INPUT"].parameterValue() == layer.id()


@pytest.mark.parametrize(
    ("subset", "classes"),
    [
        ("Classification = 2", (2,)),
        ("Classification = 2 OR Classification IN (6, 9)", (2, 6, 9)),
        ("NOT (Classification > 1)", (0, 1)),
        ("Classification = 300", ()),
        ("Intensity > 3", None),
        ("Classification = 2 AND ReturnNumber = 1", None),
        ("Classification = ", None),
    ],
)
def test_the_classes_of_a_filter(qgis, subset, classes):
    from terrain_wavelets.plugin.algorithms._cloud_source import classes_of

    assert classes_of(subset) == classes
