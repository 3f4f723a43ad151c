"""What toolbox, dialogs and log tell, and that they do while something is computed."""

import numpy as np
import pytest
from qgis_layers import Log, hills, write_raster


@pytest.mark.parametrize(
    "words",
    ["mesh from dem", "tin", "decimate", "thin", "generalise", "generalize", "dem to tin"],
)
def test_the_toolbox_finds_the_way_from_a_dem_to_a_tin(provider, words):
    algorithm = provider.algorithm("simplifydem")
    shown = [algorithm.displayName(), algorithm.shortDescription(), *algorithm.tags()]
    text = " ".join(shown).lower()
    assert all(word in text for word in words.split())


def test_every_algorithm_is_described_in_one_line(provider):
    for algorithm in provider.algorithms():
        if algorithm.group() != "Models":
            assert 20 < len(algorithm.shortDescription()) < 100, algorithm.name()


def test_a_dialog_offers_what_the_tables_hold(provider):
    import wavelet_core
    from wavelet_gis.io.formats import MESH_FORMATS

    algorithm = provider.algorithm("simplifydem")
    for name in ("PARTITION", "NORM", "PREDICTION", "UPDATE", "SIGNAL"):
        parameter = algorithm.parameterDefinition(name)
        table = getattr(wavelet_core, f"{name}S")
        assert parameter.options() == ["default", *table]
        assert all(row.help in parameter.help() for row in table.values())
    mesh = algorithm.parameterDefinition("MESH")
    assert all(f"(*{row.suffix})" in mesh.fileFilter() for row in MESH_FORMATS)
    assert mesh.fileFilter().startswith("2DM")


def test_a_new_row_of_a_table_is_in_the_dialog(qgis, monkeypatch):
    from terrain_wavelets.plugin.algorithms import ALGORITHMS

    import wavelet_core
    from wavelet_gis.io import formats

    first = next(iter(wavelet_core.PREDICTIONS.values()))
    new = first._replace(name="median", short="MD", help="the median of the neighbours")
    monkeypatch.setitem(wavelet_core.PREDICTIONS, "median", new)
    row = formats.MeshFormat(".msh", "Gmsh", "a:b", "finite elements")
    monkeypatch.setattr(formats, "MESH_FORMATS", (*formats.MESH_FORMATS, row))
    (algorithm,) = (a() for a in ALGORITHMS if a().name() == "simplifydem")
    algorithm.initAlgorithm()
    prediction = algorithm.parameterDefinition("PREDICTION")
    assert "median" in prediction.options()
    assert "the median of the neighbours (MD" in prediction.help()
    assert "Gmsh (*.msh)" in algorithm.parameterDefinition("MESH").fileFilter()


def test_dialogs_open_without_scipy_and_say_what_is_missing(qgis, monkeypatch):
    from qgis.core import QgsProcessingContext
    from terrain_wavelets.plugin.algorithms import ALGORITHMS
    from terrain_wavelets.plugin.ui import dependencies

    find = dependencies.missing
    gone = dependencies.SCIPY
    monkeypatch.setattr(
        dependencies, "missing", lambda packages: [p for p in packages if p == gone or find([p])]
    )
    for kind in ALGORITHMS:
        algorithm = kind()
        algorithm.initAlgorithm()
        is_fine, message = algorithm.checkParameterValues({}, QgsProcessingContext())
        assert not is_fine
        assert "missing Python package: scipy" in message


def test_a_command_for_a_terminal_is_quoted(qgis, monkeypatch):
    from terrain_wavelets.plugin.ui import dependencies

    monkeypatch.setattr(dependencies.sys, "platform", "darwin")
    assert "'laspy[lazrs]'" in dependencies.remedy([dependencies.LASPY])
    monkeypatch.setattr(dependencies.sys, "platform", "win32")
    assert '"laspy[lazrs]"' in dependencies.remedy([dependencies.LASPY])


def test_what_is_noted_of_an_input_is_in_the_log(run, tmp_path):
    values = hills(30, 40).astype("float32")
    path = write_raster(tmp_path / "d.tif", values, None, 4326, (7.0, 44.0), 1 / 3600)
    log = Log()
    parameters = {"INPUT": path, "OUTPUT": str(tmp_path / "p.gpkg"), "LEVELS": 1}
    run("analysedem", parameters, feedback=log)
    assert any("local metric frame" in line for line in log.lines)


def test_an_error_names_parameters_as_the_dialog_does(provider):
    from wavelet_core import OptionError

    error = OptionError("{0} is {given}; leave out {1}.", "max_rms", "target_vertices", given=-1)
    assert provider.algorithm("simplifydem").in_words(error) == (
        "'RMSE' is -1; leave out 'Number of vertices'."
    )
    assert provider.algorithm("analysedem").in_words(error) == (
        "'Stop at this RMSE' is -1; leave out 'Stop at this number of vertices'."
    )


@pytest.mark.parametrize("silence", [0, 5, 40])
@pytest.mark.parametrize("step", [1e-5, 1e-3, 2e-2])
def test_the_bar_never_rests_until_the_work_has_caught_up(qgis, silence, step):
    """It rested for 8 s: the clock had moved it ahead of the first word of a simplification."""
    from plugin.qgis_io.background import Bar

    bar = Bar(0.0)
    places = [
        bar.at(max(tenth / 10 - silence, 0) * step, tenth / 10)
        for tenth in range(10 * (silence + 45))
    ]
    each_second = np.diff(places[::10])
    assert (each_second > 1e-4).all()
    assert places[-1] < 1.0


@pytest.mark.parametrize(("width", "seconds"), [(0.2, 120), (0.65, 500)])
def test_the_bar_keeps_its_room_through_long_work(qgis, width, seconds):
    """The clock took the room of nine minutes in three; then the bar stood, for 81 s at a time."""
    from plugin.qgis_io.background import Bar

    bar = Bar(0.0, width)
    places = [bar.at((tenth // 10) / seconds, tenth / 10) for tenth in range(10 * seconds)]
    each_second = width * np.diff(places[::10])
    assert (each_second > 1e-4).all()
    assert np.median(each_second) > 0.3 * width / seconds
    assert np.abs(np.array(places[::10]) - np.arange(seconds) / seconds).max() < 0.3


@pytest.mark.parametrize(("width", "seconds"), [(0.012, 7), (0.024, 12), (0.1, 20), (0.65, 60)])
def test_the_bar_moves_every_second_while_the_work_says_nothing(qgis, width, seconds):
    """It stood for 1.5 s after eight of triangulating, and in narrow parts after three."""
    from plugin.qgis_io.background import LEAST, Bar

    bar = Bar(0.0, width)
    seen, moments = 0.0, [0.0]
    for tenth in range(10 * seconds):
        place = width * bar.at(0.0, tenth / 10)
        if place - seen >= LEAST:
            seen = place
            moments.append(tenth / 10)
    assert np.diff(moments).max() <= 1.0
    assert moments[-1] > seconds - 1


def test_the_bar_keeps_steps_for_the_end_of_long_work(qgis):
    """Terrain for the web, ten minutes: the clock had led, and the last step took 9 s."""
    from plugin.qgis_io.background import LEAST, Bar

    width, seconds = 0.95, 640
    bar = Bar(0.0, width)
    seen, moments = 0.0, [0.0]
    for tenth in range(10 * seconds):
        place = width * bar.at((tenth // 10) / seconds, tenth / 10)
        if place - seen >= LEAST:
            seen = place
            moments.append(tenth / 10)
    moments.append(float(seconds))
    assert np.diff(moments).max() <= 1.2


def test_a_part_whose_place_was_passed_has_room_too(qgis):
    """The raster of a level after its TIN: the bar stood still for three seconds."""
    from terrain_wavelets.plugin.parameters.request import Request

    log = Log()
    request = Request(None, {}, None, log)
    request.computed(lambda work: None, 0.1, 0.9)
    parts = [(0.2, 0.3), (0.5, 0.9), (0.3, 0.6), (0.1, 0.9)]
    for start, stop in parts:
        before = log.fractions[-1]
        request.computed(lambda work: None, start, stop)
        assert before + 0.5 < log.fractions[-1] < 100.0
    request.progress(0.0, 0.5)(0.5)
    assert log.fractions[-1] < 100.0
    assert log.fractions == sorted(log.fractions)


def test_writing_a_dem_moves_the_bar_and_heeds_cancel(qgis, provider, tmp_path):
    from qgis.core import QgsCoordinateReferenceSystem, QgsFeedback
    from terrain_wavelets.plugin.qgis_io.raster_writer import write_dem

    from wavelet_core import Cancelled
    from wavelet_gis.model.dem import Dem, GridGeometry

    geometry = GridGeometry((1500, 1000), (1.0, 0.0, 5e5, 0.0, -1.0, 5e6))
    values = np.zeros((1500, 1000), "f4")
    dem = Dem(values, np.ones(values.shape, bool), geometry)
    crs, seen = QgsCoordinateReferenceSystem("EPSG:25832"), []
    write_dem(str(tmp_path / "a.tif"), dem, crs, QgsFeedback(), seen.append)
    assert seen == sorted(seen)
    assert len(seen) > 5
    feedback = QgsFeedback()
    with pytest.raises(Cancelled):
        write_dem(str(tmp_path / "b.tif"), dem, crs, feedback, lambda share: feedback.cancel())
    assert [path.name for path in tmp_path.iterdir()] == ["a.tif"]


def test_computing_answers_a_cancel_and_moves_the_bar(qgis):
    """A step that asks nobody for long, as a triangulation does."""
    import threading
    import time

    from terrain_wavelets.plugin.qgis_io.background import computed

    from wavelet_core.errors import Cancelled

    log, told = Log(), []
    timer = threading.Timer(2.5, log.cancel)
    timer.start()
    began = time.perf_counter()

    def work(work):
        time.sleep(8)
        told.append(work.progress(1.0))

    with pytest.raises(Cancelled):
        computed(log, work, 0.2, 0.6)
    assert time.perf_counter() - began < 5
    assert len(set(log.fractions)) >= 3
    assert log.fractions == sorted(log.fractions)
    assert min(log.fractions) >= 20
    assert max(log.fractions) < 60
    assert not told, "nobody waited for it"


def test_what_is_computed_comes_back_with_its_warnings_notes_and_errors(qgis):
    from terrain_wavelets.plugin.qgis_io.background import computed
    from terrain_wavelets.plugin.ui.warning_log import shown_in

    from wavelet_core.errors import MeshError
    from wavelet_gis.errors import TerrainWarning
    from wavelet_gis.notes import collected, warn

    log = Log()

    def work(work):
        warn(TerrainWarning, "odd", "this is odd")
        work.in_log(log.pushInfo)("begun")
        assert work.progress(0.5)
        return 7

    with shown_in(log, str), collected() as notes:
        assert computed(log, work, 0.0, 1.0) == 7
    assert [note.code for note in notes] == ["odd"]
    assert any("this is odd" in line for line in log.warnings)
    assert log.lines == ["begun"]

    def fails(work):
        raise MeshError("no mesh")

    with pytest.raises(MeshError, match="no mesh"):
        computed(log, fails, 0.0, 1.0)
