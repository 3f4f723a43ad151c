"""Clusters and classes: what is plainly apart is told apart, and the answer does not wander."""

import json
import sys

import numpy as np
import pytest
from gis.samples import write_las

from wavelet_core import Cancelled, MissingDependencyError, OptionError, analyse
from wavelet_core.features.signature import (
    Signature,
    energy_signature,
    joined_levels,
    plain_features,
    scale_features,
)
from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.model.terrain import terrain_of_dem
from wavelet_gis.products import vertex_raster
from wavelet_gis.products.label_layer import label_layer
from wavelet_gis.products.vertex_raster import label_band, value_bands
from wavelet_gis.products.vertex_tables import energy_columns
from wavelet_gis.workflows.learning.classification import (
    Validation,
    learn_classes,
    spatial_folds,
    validate_classes,
)
from wavelet_gis.workflows.learning.cluster import Labelled
from wavelet_gis.workflows.learning.clustering import cluster_summary, cluster_vertices
from wavelet_gis.workflows.learning.labels import (
    NOT_KNOWN,
    cloud_with_classes,
    labels_from_las,
    labels_from_layer,
)
from wavelet_gis.workflows.open import open_terrain


@pytest.fixture(scope="module")
def halves():
    """Return the pyramid of a DEM that is smooth in the west and rough in the east."""
    rng = np.random.default_rng(0)
    _, x = np.mgrid[0:60, 0:80]
    z = 100 + 5 * np.sin(x / 20) + np.where(x >= 40, rng.normal(0, 2.0, x.shape), 0.0)
    z += rng.normal(0, 0.01, x.shape)
    geometry = GridGeometry((60, 80), (1.0, 0.0, 0.0, 0.0, -1.0, 60.0))
    dem = Dem(z, np.ones(z.shape, dtype=bool), geometry)
    with pytest.warns(UserWarning, match="no CRS"):
        terrain = terrain_of_dem("halves", dem, CoordinateSystem())
    return terrain.geo_pyramid(
        analyse(terrain.mesh, levels=6, partition="random", prediction="plane")
    )


def is_east(geo):
    return geo.pyramid.synthesise().vertices[:, 0] > 40


@pytest.mark.parametrize("method", ["kmeans", "mixture"])
def test_smooth_and_rough_ground_fall_apart(halves, method):
    clusters = cluster_vertices(energy_signature(halves.pyramid), 2, method)
    assert clusters.n_clusters == 2
    # cluster 0 has the least energy: the smooth west
    assert np.mean((clusters.labels == 1) == is_east(halves)) > 0.9
    assert ((clusters.confidence >= 0) & (clusters.confidence <= 1)).all()


def test_the_same_seed_gives_the_same_clusters(halves):
    signature = energy_signature(halves.pyramid)
    first, second = (cluster_vertices(signature, 3, seed=4) for _ in range(2))
    np.testing.assert_array_equal(first.labels, second.labels)


def test_a_count_is_found_where_none_is_given(halves):
    clusters = cluster_vertices(energy_signature(halves.pyramid))
    assert 2 <= clusters.n_clusters <= 4
    shares = list(clusters.explained.values())
    assert len(shares) == 10
    assert shares == sorted(shares)


def test_three_balls_are_counted_as_three():
    rng = np.random.default_rng(2)
    centres = np.array([[0, 0], [9, 0], [0, 9]])
    values = np.concatenate([c + rng.normal(0, 0.3, (200, 2)) for c in centres])
    clusters = cluster_vertices(Signature(("a", "b"), values.astype(np.float32)))
    assert clusters.n_clusters == 3
    assert np.bincount(clusters.labels).tolist() == [200, 200, 200]


def test_a_summary_tells_the_rough_from_the_smooth(halves):
    labels = is_east(halves).astype(np.int64)
    summary = cluster_summary(halves, labels)
    smooth, rough = summary["clusters"]
    assert smooth["n_vertices"] + rough["n_vertices"] == 4800
    assert smooth["share"] + rough["share"] == pytest.approx(1)
    assert rough["rms"][-1] > 10 * smooth["rms"][-1]
    assert smooth["relative"][-1] < 1 < rough["relative"][-1]
    assert len(summary["spacings"]) == halves.pyramid.n_levels
    energies = energy_columns(halves) ** 2
    assert rough["rms"][0] == pytest.approx(np.sqrt(energies[labels == 1, 0].mean()))


def test_joined_bands_cover_every_level_once(halves):
    bands = joined_levels(halves.pyramid)
    assert [level for first, stop in bands for level in range(first, stop)] == list(range(6))


def test_features_have_names_and_are_finite(cloud_record):
    features = scale_features(cloud_record.pyramid)
    assert len(features.names) == features.values.shape[1] == len(set(features.names))
    assert np.isfinite(features.values).all()
    plain = plain_features(cloud_record.pyramid)
    assert plain.names[:3] == ("classification", "hag", "intensity")
    assert features.joined_to(plain).values.shape[1] == len(features.names) + len(plain.names)


def test_heights_above_a_level_do_not_change_with_the_altitude(halves):
    from dataclasses import replace

    pyramid = halves.pyramid
    raised = replace(pyramid, coarse=pyramid.coarse + 1000.0)
    np.testing.assert_allclose(
        scale_features(raised).values, scale_features(pyramid).values, atol=1e-4
    )


def test_classes_are_learned_from_a_corner_and_hold_elsewhere(halves):
    pytest.importorskip("sklearn")
    east = is_east(halves)
    plan = halves.pyramid.synthesise().vertices[:, :2]
    labels = np.where(plan[:, 1] > 40, east.astype(np.int64), NOT_KNOWN)
    features = scale_features(halves.pyramid)
    classes = learn_classes(features, labels)
    hidden = labels == NOT_KNOWN
    assert np.mean(classes.predicted[hidden] == east[hidden]) > 0.9
    assert classes.confidence.min() >= 0.5
    np.testing.assert_array_equal(classes.predicted, learn_classes(features, labels).predicted)


def test_validation_counts_every_labelled_vertex_once(halves):
    pytest.importorskip("sklearn")
    labels = is_east(halves).astype(np.int64)
    labels[::7] = NOT_KNOWN
    plan = halves.pyramid.synthesise().vertices[:, :2]
    validation = validate_classes(scale_features(halves.pyramid), labels, spatial_folds(plan))
    assert validation.confusion.sum() == (labels >= 0).sum()
    assert validation.accuracy > 0.9
    assert min(validation.f1.values()) > 0.9


def test_figures_of_a_validation_by_hand():
    validation = Validation((2, 5), np.array([[8, 2], [1, 9]]))
    assert validation.accuracy == pytest.approx(0.85)
    assert validation.f1[2] == pytest.approx(2 * 8 / (10 + 9))
    assert validation.as_dict()["confusion"] == [[8, 2], [1, 9]]


def test_folds_are_blocks_and_every_row_and_column_has_all():
    x, y = np.meshgrid(np.arange(50.0), np.arange(50.0))
    folds = spatial_folds(np.column_stack([x.ravel(), y.ravel()])).reshape(50, 50)
    blocks = folds.reshape(5, 10, 5, 10)
    assert (blocks == blocks[:, :1, :, :1]).all()
    for k in range(5):
        assert set(blocks[k, 0, :, 0]) == set(blocks[:, 0, k, 0]) == {0, 1, 2, 3, 4}


def test_what_cannot_be_clustered_or_learned_is_refused(halves):
    signature = energy_signature(halves.pyramid)
    with pytest.raises(OptionError, match="count is 0; give 1 to 254"):
        cluster_vertices(signature, 0)
    with pytest.raises(OptionError, match="give one of kmeans, mixture"):
        cluster_vertices(signature, 2, "ward")
    bare = analyse(halves.pyramid.synthesise(), levels=0)
    with pytest.raises(OptionError, match="no levels"):
        energy_signature(bare)


def test_what_has_one_class_is_not_learned_from(halves):
    pytest.importorskip("sklearn")
    signature, one = energy_signature(halves.pyramid), np.zeros(4800, dtype=np.int64)
    with pytest.raises(OptionError, match="at least two"):
        learn_classes(signature, one)
    with pytest.raises(OptionError, match="cannot be validated"):
        validate_classes(signature, one, np.zeros(4800, dtype=np.int64))


@pytest.mark.parametrize("method", ["kmeans", "mixture"])
def test_clusters_are_the_same_without_scikit_learn(halves, monkeypatch, method):
    signature = energy_signature(halves.pyramid)
    expected = cluster_vertices(signature, method=method)
    monkeypatch.setitem(sys.modules, "sklearn", None)
    found = cluster_vertices(signature, method=method)
    np.testing.assert_array_equal(found.labels, expected.labels)
    np.testing.assert_array_equal(found.confidence, expected.confidence)


def test_without_scikit_learn_the_remedy_is_told(halves, monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn", None)
    labels = is_east(halves).astype(np.int64)
    with pytest.raises(MissingDependencyError, match="pip install scikit-learn"):
        learn_classes(energy_signature(halves.pyramid), labels)


# -- labels in and out ---------------------------------------------------------------------------


@pytest.mark.parametrize(("version", "point_format"), [("1.2", 3), ("1.4", 6)])
def test_las_classes_go_out_and_come_back(tmp_path, version, point_format):
    path = write_las(tmp_path / "a.las", version=version, point_format=point_format)
    terrain = open_terrain(path)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=2))
    labels = labels_from_las(geo)
    assert set(labels.tolist()) == {2, 5}
    swapped = np.where(labels == 2, 6, NOT_KNOWN)
    cloud = cloud_with_classes(geo, swapped)
    from wavelet_gis.io.las import write_cloud

    write_cloud(tmp_path / "b.las", cloud)
    import laspy

    before, after = laspy.read(path), laspy.read(tmp_path / "b.las")
    np.testing.assert_array_equal(before.X, after.X)
    np.testing.assert_array_equal(before.gps_time, after.gps_time)
    np.testing.assert_array_equal(before.return_number, after.return_number)
    is_vertex = np.ones(400, dtype=bool)
    is_vertex[geo.origin.dropped] = False
    was, now = np.array(before.classification), np.array(after.classification)
    np.testing.assert_array_equal(now[is_vertex], np.where(was[is_vertex] == 2, 6, 5))
    # a point without a vertex of its own goes with the one at its place
    kept = np.flatnonzero(is_vertex)
    stand_in = kept[geo.origin.representative]
    changed = was[stand_in] == 2
    assert (now[geo.origin.dropped][changed] == 6).all()


def test_unlabelled_classes_are_not_known(tmp_path):
    path = write_las(tmp_path / "a.las")
    terrain = open_terrain(path)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=1))
    labels = labels_from_las(geo, unlabelled=(5,))
    assert set(labels.tolist()) == {2, NOT_KNOWN}


def test_lifted_classes_serve_too(cloud_record):
    assert set(labels_from_las(cloud_record).tolist()) == {2, 5}


def test_classes_that_are_not_there_are_refused(halves, tmp_path):
    with pytest.raises(OptionError, match="not made from a point cloud"):
        labels_from_las(halves)
    with pytest.raises(OptionError, match="not made from a point cloud"):
        cloud_with_classes(halves, np.zeros(4800, dtype=np.int64))
    terrain = open_terrain(write_las(tmp_path / "a.las"), carry=False)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=1))
    with pytest.raises(OptionError, match="again, with carry"):
        labels_from_las(geo)


def write_layer(path, shapes, classes, crs=None):
    import pyogrio
    import shapely

    pyogrio.raw.write(
        path,
        np.array([shapely.to_wkb(s) for s in shapes], dtype=object),
        [np.array(classes)],
        ["class"],
        geometry_type=shapes[0].geom_type,
        crs=crs,
        driver="GPKG",
    )
    return path


@pytest.mark.filterwarnings("ignore:'crs' was not provided")
def test_polygons_and_points_label_vertices(halves, tmp_path):
    import shapely

    plan = halves.pyramid.synthesise().vertices[:, :2]
    boxes = [shapely.box(0, 0, 10, 10), shapely.box(5, 0, 20, 10)]
    labels = labels_from_layer(halves, write_layer(tmp_path / "p.gpkg", boxes, [3, 4]), "class")
    in_first = (plan[:, 0] <= 10) & (plan[:, 1] <= 10)
    assert (labels[in_first] == 3).all()  # the first of two that overlap
    assert (labels[(plan[:, 0] > 10) & (plan[:, 0] < 20) & (plan[:, 1] < 10)] == 4).all()
    assert (labels[plan[:, 1] > 10] == NOT_KNOWN).all()
    points = [shapely.Point(30.4, 30.4), shapely.Point(900, 900)]
    labels = labels_from_layer(halves, write_layer(tmp_path / "q.gpkg", points, [7, 8]), "class")
    (vertex,) = np.flatnonzero(labels >= 0)
    assert labels[vertex] == 7
    assert np.abs(plan[vertex] - 30.4).max() < 0.6


@pytest.mark.filterwarnings("ignore:'crs' was not provided")
def test_labels_that_do_not_fit_are_refused(halves, cloud_record, tmp_path):
    import shapely

    far = write_layer(tmp_path / "far.gpkg", [shapely.box(900, 900, 910, 910)], [1])
    with pytest.raises(InputFileError, match="no vertex lies in"):
        labels_from_layer(halves, far, "class")
    with pytest.raises(InputFileError, match="no field 'kind'"):
        labels_from_layer(halves, far, "kind")
    with pytest.raises(InputFileError, match="cannot be read"):
        labels_from_layer(halves, tmp_path / "none.gpkg", "class")
    ring = {"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 9]]]}  # is not closed
    feature = {"type": "Feature", "properties": {"class": 1}, "geometry": ring}
    damaged = tmp_path / "ring.geojson"
    damaged.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    with pytest.raises(InputFileError, match="a shape of the layer ring is damaged"):
        labels_from_layer(halves, damaged, "class")
    line = write_layer(tmp_path / "line.gpkg", [shapely.LineString([(0, 0), (9, 9)])], [1])
    with pytest.raises(InputFileError, match="polygons or points"):
        labels_from_layer(halves, line, "class")
    text = write_layer(tmp_path / "text.gpkg", [shapely.box(0, 0, 9, 9)], ["wood"])
    with pytest.raises(InputFileError, match="whole numbers"):
        labels_from_layer(halves, text, "class")
    lonlat = write_layer(tmp_path / "ll.gpkg", [shapely.box(0, 0, 9, 9)], [1], crs="EPSG:4326")
    with pytest.raises(
        InputFileError, match=r"reproject the labels to that first \(ogr2ogr -t_srs EPSG:\d+\)"
    ):
        labels_from_layer(cloud_record, lonlat, "class")


def test_labels_become_a_raster_and_a_layer(raster_record, cloud_record):
    mesh = raster_record.pyramid.synthesise()
    labels = np.arange(mesh.n_vertices) % 5 - 1
    bands = label_band(raster_record, mesh, labels, "cluster")
    valid = raster_record.origin.valid
    np.testing.assert_array_equal(bands.values[0][valid], np.where(labels < 0, 255, labels))
    assert (bands.values[0][~valid] == 255).all()
    with pytest.raises(InputFileError, match="does not fit a raster of bytes"):
        label_band(raster_record, mesh, labels + 300, "cluster")
    mesh = cloud_record.pyramid.synthesise()
    ones = np.ones(mesh.n_vertices, dtype=np.int64)
    bands = label_band(cloud_record, mesh, ones, "class", cell_size=5.0)
    assert set(np.unique(bands.values)) <= {1, 255}
    layer = label_layer(cloud_record, ones, np.ones(len(ones)), "class")
    assert layer.name == "classes"
    assert list(layer.fields) == ["vertex_id", "class", "confidence"]


def test_labels_report_while_they_become_rasters_and_sums(cloud_record, monkeypatch):
    """They said nothing of it, so that the bar stood still and a cancel came late."""
    labels = np.arange(cloud_record.pyramid.synthesise().n_vertices) % 5
    labelled = Labelled(cloud_record, labels, np.ones(len(labels)), "class", {})
    whole = labelled.raster(5.0).values
    monkeypatch.setattr(vertex_raster, "CELLS_AT_ONCE", 50)
    for work in (lambda tell: labelled.raster(5.0, tell), labelled.summary):
        seen = [0.0]
        made = work(seen.append)
        assert seen == sorted(seen)
        assert np.diff(seen).max() < 0.71
        assert len(seen) > 5
        assert len([f for f in seen if f > 0.6]) > 4  # not the first part alone
        if not isinstance(made, dict):
            np.testing.assert_array_equal(made.values, whole)
            n_cells = np.count_nonzero(whole != 255)
            assert len([f for f in seen if f > 0.75]) >= n_cells // 50
        with pytest.raises(Cancelled):
            work(lambda fraction: fraction < 0.8)


def test_value_bands_keep_the_grid_of_a_raster(raster_record):
    mesh = raster_record.pyramid.synthesise()
    bands = value_bands(raster_record, mesh, mesh.vertices[:, [2]], ["z"])
    valid = raster_record.origin.valid
    np.testing.assert_array_equal(bands.values[0][valid], mesh.vertices[:, 2].astype(np.float32))
    assert np.isnan(bands.values[0][~valid]).all()
