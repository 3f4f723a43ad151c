"""The commands details, cluster and report; every example in their pages of the docs runs."""

import json
import re
import shlex
import shutil
from pathlib import Path

import laspy
import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import hills, write_las, write_tif

from wavelet_gis.cli.main import main

pytest.importorskip("matplotlib")

DOCS = Path(__file__).resolve().parents[3] / "docs" / "topics"
SPECTRAL = ["--partition", "random", "--prediction", "plane", "--quiet"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a DEM, a cloud, a training layer, and a pyramid of each of the first."""
    path = tmp_path_factory.mktemp("commands")
    write_tif(path / "dem.tif", hills().astype("f4"))
    write_las(path / "cloud.laz", n_points=1500)
    boxes = [
        shapely.box(500000, 5099600, 500200, 5100000),
        shapely.box(500300, 5099600, 500500, 5100000),
    ]
    pyogrio.raw.write(
        path / "training.gpkg",
        np.array([shapely.to_wkb(box) for box in boxes], dtype=object),
        [np.array([1, 2])],
        ["class"],
        geometry_type="Polygon",
        crs="EPSG:32632",
        driver="GPKG",
    )
    assert (
        main(["analyse", str(path / "dem.tif"), str(path / "d.gpkg"), "--levels", "6", *SPECTRAL])
        == 0
    )
    cloud = [str(path / "cloud.laz"), str(path / "c.gpkg"), "--levels", "8"]
    assert main(["analyse", *cloud, "--attributes", "intensity", *SPECTRAL]) == 0
    return path


@pytest.fixture
def run(folder, tmp_path, capsys):
    """Return a function that runs a command on a pyramid and gives its exit code and figures."""

    def run(command, pyramid, output, *options):
        path = tmp_path / output
        code = main([command, str(folder / pyramid), str(path), "--json", *options])
        captured = capsys.readouterr()
        return code, path, json.loads(captured.out) if code == 0 else captured.err

    return run


def test_details_give_a_band_for_every_level(run):
    code, path, figures = run("details", "d.gpkg", "e.tif")
    assert code == 0
    with rasterio.open(path) as dataset:
        assert dataset.count == 6
        assert dataset.shape == (40, 50)
        assert dataset.descriptions[5].startswith("rms of level 5, spacing 10 m")
        assert dataset.crs.to_epsg() == 32632
        assert np.nanmin(dataset.read()) >= 0
    assert [row["level"] for row in figures["levels"]] == list(range(6))


def test_components_sum_with_the_base_to_the_dem(run, folder):
    from wavelet_core.features.spectrum import band_components
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    _, path, _ = run("details", "d.gpkg", "c.tif", "--what", "component")
    geo = read_pyramid(folder / "d.gpkg")
    base = band_components(geo.pyramid).base.reshape(40, 50)
    with rasterio.open(path) as dataset, rasterio.open(folder / "dem.tif") as dem:
        np.testing.assert_allclose(base + dataset.read().sum(axis=0), dem.read(1), atol=1e-3)


def test_levels_and_shape_as_rasters(run):
    _, path, _ = run("details", "d.gpkg", "l.tif", "--what", "level")
    with rasterio.open(path) as dataset:
        assert set(np.unique(dataset.read(1))) == {0, 1, 2, 3, 4, 5, 255}
    _, path, figures = run("details", "d.gpkg", "s.tif", "--what", "shape", "--level", "2")
    with rasterio.open(path) as dataset:
        assert dataset.descriptions == (
            "slope",
            "aspect",
            "profile",
            "tangential",
            "mean",
            "gaussian",
        )
        slope = dataset.read(1)
        assert 0 <= np.nanmin(slope) < np.nanmax(slope) < 90
    assert figures["what"] == "shape"


def test_roughness_and_deviation_tell_the_strongest_and_its_spacing(run):
    for what in ("roughness", "deviation"):
        _, path, figures = run("details", "d.gpkg", f"{what}.tif", "--what", what)
        with rasterio.open(path) as dataset:
            bands, names = dataset.read(), dataset.descriptions
        assert names[:2] == (f"strongest {what}", "spacing of the strongest, m")
        assert names[2].startswith(f"{what} of level 0, spacing ")
        np.testing.assert_array_equal(np.abs(bands[0]), np.abs(bands[2:]).max(axis=0))
        spacings = {float(name.split()[-2]) for name in names[2:]}
        assert {float(f"{spacing:.3g}") for spacing in np.unique(bands[1])} <= spacings
        assert figures["what"] == what
        _, path, figures = run("details", "d.gpkg", f"{what}.gpkg", "--what", what)
        meta, _, _, columns = pyogrio.raw.read(path, layer=what)
        values = dict(zip(meta["fields"], columns, strict=True))
        np.testing.assert_allclose(values["strongest"], bands[0].ravel(), rtol=1e-6)
        assert {"vertex_id", "spacing", "level_00"} <= set(values)


def test_residual_is_the_height_above_the_mean_around(run, folder):
    from wavelet_core import heights_above_means
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    above = heights_above_means(read_pyramid(folder / "d.gpkg").pyramid, [0])[:, 0]
    _, path, _ = run("details", "d.gpkg", "r.tif", "--what", "residual")
    with rasterio.open(path) as dataset:
        np.testing.assert_allclose(dataset.read(1).ravel(), above, atol=1e-4)
        assert dataset.descriptions == ("height above the mean around, level 0",)
    _, points, _ = run("details", "d.gpkg", "r.gpkg", "--what", "residual", "--level", "0")
    meta, _, _, columns = pyogrio.raw.read(points, layer="residual_level_00")
    values = dict(zip(meta["fields"], columns, strict=True))
    np.testing.assert_allclose(values["residual"], above, atol=1e-9)


def test_landforms_of_a_distance_on_the_ground(run):
    _, path, _ = run("details", "d.gpkg", "f.tif", "--what", "landforms", "--level-metres", "10")
    with rasterio.open(path) as dataset:
        forms = dataset.read(1)
        assert dataset.nodata == 255
        assert dataset.descriptions[0].startswith("landform: 0 planar, 1 pit, 2 channel")
    assert set(np.unique(forms)) <= {0, 1, 2, 3, 4, 5}
    steep = ["--flat-slope", "80", "--flat-curvature", "0"]
    _, path, _ = run("details", "d.gpkg", "g.tif", "--what", "landforms", *steep)
    with rasterio.open(path) as dataset:
        assert (dataset.read(1) != forms).any()
        assert not (dataset.read(1) == 0).any()
    _, points, _ = run("details", "d.gpkg", "f.gpkg", "--what", "landforms")
    meta, _, _, columns = pyogrio.raw.read(points, layer="shape_level_06")
    values = dict(zip(meta["fields"], columns, strict=True))
    np.testing.assert_array_equal(values["landform"], forms.ravel())


def test_shape_is_fitted_to_windows_or_to_the_surface(run, folder):
    from wavelet_core import level_spacings, surface_shape, window_shape
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    pyramid = read_pyramid(folder / "d.gpkg").pyramid
    shapes = {
        (): window_shape(pyramid, level_spacings(pyramid)[3], at=3),
        ("--fit", "windows"): window_shape(pyramid, level_spacings(pyramid)[3], at=3),
        ("--fit", "surface"): surface_shape(pyramid.mesh(3)),
    }
    for options, shape in shapes.items():
        arguments = ("--what", "shape", "--level", "3", *options)
        _, path, _ = run("details", "d.gpkg", f"fit{len(options)}{options[-1:]}.gpkg", *arguments)
        meta, _, _, columns = pyogrio.raw.read(path, layer="shape_level_03")
        values = dict(zip(meta["fields"], columns, strict=True))
        np.testing.assert_allclose(values["mean"], shape.mean, atol=1e-12)
    of_metres = window_shape(pyramid, 33.0)
    wide = ("--what", "shape", "--level-metres", "33")
    _, path, _ = run("details", "d.gpkg", "wide.tif", *wide)
    with rasterio.open(path) as dataset:
        slope = dataset.read(1).ravel()
    assert np.corrcoef(slope, of_metres.slope)[0, 1] > 0.99  # which is interpolated between
    np.testing.assert_allclose(slope.mean(), of_metres.slope.mean(), rtol=0.02)


def test_options_of_other_maps_are_refused(run, folder):
    def said(*options):
        return run("details", "d.gpkg", "x.tif", *options)[2]

    assert "--level-metres is for --what shape" in said("--level-metres", "20")
    assert "--flat-slope is for --what landforms" in said("--what", "shape", "--flat-slope", "2")
    assert "--fit is for --what shape or landforms" in said("--fit", "surface")
    both = said("--what", "shape", "--level", "1", "--level-metres", "20")
    assert "--level and --level-metres exclude each other" in both
    far = said("--what", "residual", "--level-metres", "1e6")
    assert "--level-metres is 1e+06, but the levels' spacings are 10 to" in far
    assert "give 0 or more" in said("--what", "landforms", "--flat-curvature", "-1")
    assert "there is no level 7" in said("--what", "residual", "--level", "7")
    assert "--channel is not for --what roughness" in said("--what", "roughness", "--channel", "z")


def test_maps_of_scales_say_that_levels_are_no_sizes(folder, tmp_path, capsys):
    pyramid = str(tmp_path / "q.gpkg")
    assert main(["analyse", str(folder / "dem.tif"), pyramid, "--levels", "4", "--quiet"]) == 0
    out = str(tmp_path / "r.tif")
    assert main(["details", pyramid, out, "--what", "roughness"]) == 0
    assert "not of one size on the ground everywhere" in capsys.readouterr().err


def test_details_as_points_have_every_vertex(run):
    _, path, figures = run("details", "c.gpkg", "p.gpkg", "--channel", "intensity")
    meta, _, geometry, columns = pyogrio.raw.read(path, layer="vertex_spectra")
    values = dict(zip(meta["fields"], columns, strict=True))
    assert len(geometry) == figures["n_points"] == 1480  # 20 points share a place with another
    assert {"vertex_id", "level", "w_z", "w_intensity", "magnitude", "rms_00", "rms_07"} <= set(
        values
    )
    assert np.isnan(values["magnitude"][values["level"] == -1]).all()
    assert (values["magnitude"][values["level"] >= 0] >= 0).all()
    _, path, _ = run("details", "c.gpkg", "s.gpkg", "--what", "shape", "--level", "0")
    assert pyogrio.list_layers(path)[0][0] == "shape_level_00"


def test_the_picture_is_a_picture(run):
    _, path, _ = run("details", "c.gpkg", "fig.png")
    assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_clusters_as_points_and_raster_agree(run):
    _, points, figures = run("cluster", "d.gpkg", "k.gpkg", "--count", "3")
    _, raster, _ = run("cluster", "d.gpkg", "k.tif", "--count", "3")
    meta, _, _, columns = pyogrio.raw.read(points, layer="clusters")
    values = dict(zip(meta["fields"], columns, strict=True))
    with rasterio.open(raster) as dataset:
        np.testing.assert_array_equal(dataset.read(1).ravel(), values["cluster"])
    assert [c["label"] for c in figures["clusters"]] == [0, 1, 2]
    assert sum(c["n_vertices"] for c in figures["clusters"]) == 2000
    assert len(figures["clusters"][0]["rms"]) == 6


def test_classes_are_learned_from_las_and_written_back(run, folder):
    pytest.importorskip("sklearn")
    options = ["--learn", "las", "--unlabelled", "1", "--validate"]
    code, path, figures = run("cluster", "c.gpkg", "new.laz", *options)
    assert code == 0, figures
    assert figures["validation"]["classes"] == [2, 5]
    assert figures["validation"]["accuracy"] > 0.8
    before, after = laspy.read(folder / "cloud.laz"), laspy.read(path)
    np.testing.assert_array_equal(before.Z, after.Z)
    # every class was known, so none of a vertex has changed
    changed = np.array(before.classification) != np.array(after.classification)
    assert changed.sum() <= 20


def test_unlabelled_points_get_a_class(run, folder, tmp_path):
    pytest.importorskip("sklearn")
    las = laspy.read(folder / "cloud.laz")
    truth = np.array(las.classification)
    hidden = np.array(las.x) > 500060
    las.classification[hidden] = 1
    las.write(tmp_path / "half.laz")
    arguments = [str(tmp_path / "half.laz"), str(tmp_path / "half.gpkg"), "--levels", "8"]
    assert main(["analyse", *arguments, *SPECTRAL]) == 0
    _, path, figures = run("cluster", str(tmp_path / "half.gpkg"), "done.laz", "--learn", "las")
    predicted = np.array(laspy.read(path).classification)
    assert figures["n_labelled"] < (~hidden).sum() + 20
    assert set(predicted) == {2, 5}
    assert np.mean(predicted[hidden] == truth[hidden]) > 0.85


def test_what_does_not_go_together_is_refused(run, folder):
    assert "clusters are no LAS classes" in run("cluster", "c.gpkg", "a.laz")[2]
    assert "not made from a point cloud" in run("cluster", "d.gpkg", "a.tif", "--learn", "las")[2]
    assert "--level is for --what shape" in run("details", "d.gpkg", "a.tif", "--level", "2")[2]
    assert "must end in" in run("details", "d.gpkg", "a.csv")[2]
    assert "no --channel 'hag'" in run("details", "d.gpkg", "a.tif", "--channel", "hag")[2]
    assert "there is no level 9" in run("report", "d.gpkg", "a.html", "--level", "9")[2]
    assert "must end in .html" in run("report", "d.gpkg", "a.pdf")[2]


def test_a_report_is_whole_and_the_same_twice(run):
    code, path, figures = run("report", "d.gpkg", "r.html")
    assert code == 0
    page = path.read_text("utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert page.endswith("</html>\n")
    assert len(figures["levels"]) == 7
    _, again, _ = run("report", "d.gpkg", "r2.html")
    assert again.read_text("utf-8") == page


def test_an_output_is_not_overwritten_unasked(run):
    assert run("report", "d.gpkg", "r.html")[0] == 0
    assert run("report", "d.gpkg", "r.html")[0] == 1
    assert run("report", "d.gpkg", "r.html", "--overwrite")[0] == 0


@pytest.mark.parametrize("page", ["details", "clustering", "report"])
def test_the_examples_of_the_docs_run(page, folder, tmp_path, monkeypatch, capsys):
    if page == "clustering":
        pytest.importorskip("sklearn")
    monkeypatch.chdir(tmp_path)
    for name in ("dem.tif", "cloud.laz", "training.gpkg"):
        shutil.copy(folder / name, tmp_path)
    blocks = re.findall(
        r"^```(python|sh)\n(.*?)^```", (DOCS / f"{page}.md").read_text("utf-8"), re.M | re.S
    )
    assert {language for language, _ in blocks} == {"python", "sh"}
    scope = {}
    for language, text in blocks:
        if language == "python":
            exec(compile(text, f"{page}.md", "exec"), scope)
            continue
        for line in text.strip().splitlines():
            program, *arguments = shlex.split(line)
            assert program == "terrain-wavelets"
            assert main(arguments) == 0, f"{line}: {capsys.readouterr().err}"
    assert capsys.readouterr().out


@pytest.mark.data
@pytest.mark.parametrize(
    ("source", "levels"),
    [("dems/rmnp_u16_4326.tif", "8"), ("clouds/mountain_utm42_38k.las", "8")],
)
def test_real_data_go_through_all_three(source, levels, data_folder, tmp_path, capsys):
    pyramid = tmp_path / "p.gpkg"
    assert (
        main(["analyse", str(data_folder / source), str(pyramid), "--levels", levels, *SPECTRAL])
        == 0
    )
    for command, output in (
        ("details", "e.tif"),
        ("details", "v.gpkg"),
        ("details", "f.png"),
        ("cluster", "k.tif"),
        ("cluster", "k.gpkg"),
        ("report", "r.html"),
    ):
        assert main([command, str(pyramid), str(tmp_path / output), "--quiet"]) == 0, output
        assert (tmp_path / output).stat().st_size > 1000


def labelled_cloud(path, *, tree_share=0.4, copy=False):
    """Write slopes with trees, west of x = 60 m classified, two points at each of ten places."""
    rng = np.random.default_rng(5)
    n = 2400
    x, y = rng.uniform(0, 100, (2, n))
    is_tree = rng.random(n) < tree_share
    z = 0.1 * x + 0.05 * rng.normal(size=n) + np.where(is_tree, rng.uniform(2, 20, n), 0.0)
    truth = np.where(is_tree, 5, 2)
    label = np.where(x < 60, truth, 1)
    x[:10], y[:10] = x[10:20], y[10:20]
    x[:20] -= x[:20] * 0.5  # in the labelled part
    z[:10], z[10:20] = 30.0, 0.0
    truth[:10], truth[10:20] = 5, 2
    label[:10], label[10:20] = 5, 2
    las = laspy.LasData(laspy.LasHeader(version="1.4", point_format=6))
    las.header.scales, las.header.offsets = [0.001] * 3, [0.0] * 3
    if copy:
        las.add_extra_dim(laspy.ExtraBytesParams("survey", "u1"))
        las.survey = np.where(label == 1, 9, label + 40)
    las.x, las.y, las.z, las.classification = x, y, z, label
    las.intensity = rng.integers(0, 999, n)
    las.write(path)
    return truth, label


@pytest.mark.parametrize(
    "attributes",
    [
        ["--attributes", "classification,intensity"],
        ["--attributes", "classification,hag", "--class-channels"],
        ["--attributes", "survey,intensity"],
        ["--attributes", "hag", "--partition", "quadric", "--prediction", "nnls"],
    ],
    ids=["class", "channels and height above ground", "copy", "partition by the answer"],
)
def test_a_label_is_not_learned_from_itself(tmp_path, capsys, attributes):
    # With the class among the features accuracy was 100 %, and every unlabelled point ground.
    truth, label = labelled_cloud(tmp_path / "a.las", copy="survey" in attributes[1])
    options = [] if "--partition" in attributes else SPECTRAL
    files = [str(tmp_path / name) for name in ("a.las", "p.gpkg", "b.las")]
    analysed = ["analyse", *files[:2], "--levels", "6", "--crs", "EPSG:32632", "--quiet"]
    assert main([*analysed, *attributes, *options]) == 0
    capsys.readouterr()
    assert main(["cluster", *files[1:], "--learn", "las"]) == 0
    said = capsys.readouterr().out
    assert "not learned from" in said
    assert "accuracy in blocks of the map left out" in said
    assert "class 5: F1" in said
    done = np.array(laspy.read(files[2]).classification)
    is_given = label != 1
    np.testing.assert_array_equal(done[is_given], label[is_given])
    assert set(done) == {2, 5}
    of_trees = (truth == 5) & ~is_given
    assert np.mean(done[of_trees] == 5) > 0.7
    assert np.mean(done[~is_given] == truth[~is_given]) > 0.75


def test_points_that_have_a_class_keep_it_where_they_share_a_place(tmp_path, capsys):
    labelled_cloud(tmp_path / "a.las")
    files = [str(tmp_path / name) for name in ("a.las", "p.gpkg", "b.las")]
    assert main(["analyse", *files[:2], "--levels", "5", "--crs", "EPSG:32632", *SPECTRAL]) == 0
    options = ["--learn", "las", "--no-validate"]
    capsys.readouterr()
    assert main(["cluster", *files[1:], *options, "--json"]) == 0
    assert "validation" not in json.loads(capsys.readouterr().out)
    before, after = (np.array(laspy.read(files[k]).classification) for k in (0, 2))
    np.testing.assert_array_equal(before[:20], after[:20])
    assert set(after[:10]) == {5}
    merged = ["--merge", "5=6", "--overwrite", "--quiet"]
    assert main(["cluster", *files[1:], *options, *merged]) == 0
    after = np.array(laspy.read(files[2]).classification)
    assert set(after[:10]) == {6}
    assert set(after) == {2, 6}


def test_labels_in_one_place_are_said_not_to_be_checked(run, tmp_path):
    boxes = [
        shapely.box(500000, 5099990, 500010, 5100000),
        shapely.box(500010.1, 5099990, 500020, 5100000),
    ]
    pyogrio.raw.write(
        tmp_path / "corner.gpkg",
        np.array([shapely.to_wkb(box) for box in boxes], dtype=object),
        [np.array([1, 2])],
        ["class"],
        geometry_type="Polygon",
        crs="EPSG:32632",
        driver="GPKG",
    )
    code, _, figures = run("cluster", "d.gpkg", "c.tif", "--learn", str(tmp_path / "corner.gpkg"))
    assert code == 0
    assert "validation" not in figures
    assert figures["notes"][0]["code"] == "not_validated"
    assert "not checked on blocks left out" in figures["notes"][0]["text"]


def test_the_levels_in_a_browser(run):
    code, path, figures = run("view", "d.gpkg", "levels.html")
    assert code == 0
    assert path.read_text("utf-8").startswith("<!DOCTYPE html>")
    assert figures["shown"][0]["level"] == 0
    assert run("view", "d.gpkg", "levels.html")[0] == 1
    assert "must end in .html" in run("view", "d.gpkg", "levels.png")[2]
    assert "--max-vertices" in run("view", "d.gpkg", "b.html", "--max-vertices", "2")[2]
