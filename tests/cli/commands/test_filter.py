"""The command filter: gains, bands, noise; as a raster, a cloud, a mesh or a pyramid."""

import re
import shlex
from pathlib import Path

import laspy
import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_tif

from wavelet_core.lifting.spacings import level_spacings
from wavelet_gis.cli.main import main
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid


def band_of(path):
    with rasterio.open(path) as file:
        return file.read(1).astype(float)


@pytest.fixture(scope="module")
def noisy(tmp_path_factory):
    """Return a DEM with noise of 0.5 m, and what it was without."""
    folder = tmp_path_factory.mktemp("noisy")
    x = np.linspace(0, 1, 70)
    truth = 300 + 20 * np.sin(5 * x[:, None]) * np.cos(4 * x)
    noise = np.random.default_rng(0).normal(0, 0.5, truth.shape)
    return write_tif(folder / "noisy.tif", (truth + noise).astype("f4")), truth


def test_gains_of_one_change_nothing(done, pyramid, tif, tmp_path):
    out = tmp_path / "same.tif"
    figures = done("filter", pyramid, out, "--gain", "3=1", "--gain", "0=1", "--json").figures
    np.testing.assert_allclose(band_of(out), band_of(tif), atol=1e-3)
    assert figures["rms_change"] == 0.0
    assert figures["gains"] == {"0": 1.0, "3": 1.0}


def test_a_raster_agrees_with_the_core(done, pyramid, tmp_path):
    out = tmp_path / "smooth.tif"
    done("filter", pyramid, out, "--gain", "3=0", "--gain", "2=0.5")
    expected = read_pyramid(pyramid).pyramid.with_gains({3: 0, 2: 0.5}).synthesise()
    np.testing.assert_allclose(band_of(out).ravel(), expected.vertices[:, 2], atol=1e-3)


def test_a_pyramid_can_be_filtered_again_and_tells_its_history(done, pyramid, tmp_path):
    once, twice, both = (tmp_path / name for name in ("once.gpkg", "twice.gpkg", "both.gpkg"))
    done("filter", pyramid, once, "--gain", "3=0.5")
    done("filter", once, twice, "--gain", "3=0.5", "--gain", "1=2")
    done("filter", pyramid, both, "--gain", "3=0.25", "--gain", "1=2")
    ours, theirs = read_pyramid(twice), read_pyramid(both)
    for a, b in zip(ours.pyramid.steps, theirs.pyramid.steps, strict=True):
        np.testing.assert_array_equal(a.details, b.details)
    assert ours.history == ("gains 3=0.5", "gains 1=2, 3=0.5")
    assert not ours.origin.is_exact


def test_a_band_by_level_and_by_size_on_the_ground(done, tif, tmp_path):
    pyramid = tmp_path / "random.gpkg"  # its levels are bands of sizes
    done("analyse", tif, pyramid, "--levels", "4", "--partition", "random", "--quiet")
    by_level, by_size = tmp_path / "level.tif", tmp_path / "size.tif"
    figures = done("filter", pyramid, by_level, "--band", "1:2", "--no-coarse", "--json").figures
    assert [level for level, gain in figures["gains"].items() if gain] == ["1", "2"]
    spacings = level_spacings(read_pyramid(pyramid).pyramid)
    sizes = f"{spacings[3] - 0.01}:{spacings[2] + 0.01}"
    done("filter", pyramid, by_size, "--band-metres", sizes, "--no-coarse")
    np.testing.assert_array_equal(band_of(by_level), band_of(by_size))
    assert abs(band_of(by_level).mean()) < 2.0  # no hill's height is left


def test_metres_are_metres_where_the_crs_counts_feet(done, tmp_path):
    feet = write_tif(tmp_path / "feet.tif", hills().astype("f4"), crs="EPSG:2226")
    file = tmp_path / "feet.gpkg"
    done("analyse", feet, file, "--levels", "3", "--partition", "random", "--quiet")
    spacing = level_spacings(read_pyramid(file).pyramid)[2] * 0.3048006096
    band = f"{spacing * 0.999}:{spacing * 1.001}"
    figures = done("filter", file, tmp_path / "out.tif", "--band-metres", band, "--json").figures
    assert figures["gains"]["1"] == 1.0


@pytest.mark.large
@pytest.mark.parametrize("pyramids", [0, 4])
@pytest.mark.parametrize("sigma", [[], [0.5]])
def test_noise_goes_and_the_terrain_stays(done, noisy, tmp_path, pyramids, sigma):
    file, out = tmp_path / "noisy.gpkg", tmp_path / "clean.tif"
    path, truth = noisy
    done("analyse", path, file, "--quiet", "--partition", "random", "--prediction", "plane")
    figures = done(
        "filter", file, out, "--denoise", *sigma, "--pyramids", pyramids, "--json"
    ).figures
    assert figures["sigma"]["z"] == pytest.approx(0.5, rel=0.15)
    error = np.sqrt(np.mean((band_of(out) - truth) ** 2))
    assert error < (0.2 if pyramids else 0.35)


@pytest.mark.large
def test_a_denoised_pyramid_holds_the_denoised_surface(done, noisy, tmp_path):
    file, raster, again = (tmp_path / n for n in ("noisy.gpkg", "clean.tif", "clean.gpkg"))
    done("analyse", noisy[0], file, "--quiet", "--levels", "5")
    done("filter", file, raster, "--denoise", "0.5", "--pyramids", 2)
    done("filter", file, again, "--denoise", "0.5", "--pyramids", 2)
    z = read_pyramid(again).pyramid.synthesise().vertices[:, 2]
    np.testing.assert_allclose(z, band_of(raster).ravel(), atol=1e-3)


@pytest.mark.large
def test_a_cloud_comes_back_as_a_cloud(done, cloud_pyramid, las, tmp_path):
    out = tmp_path / "smooth.laz"
    done("filter", cloud_pyramid, out, "--denoise", "0.2", "--pyramids", 2)
    before, after = laspy.read(las), laspy.read(out)
    assert len(after) == len(before)
    np.testing.assert_array_equal(after.X, before.X)
    np.testing.assert_array_equal(after.classification, before.classification)
    assert (after.Z != before.Z).any()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "nothing to change"),
        (["--gain", "9=0"], "no details at level 9"),
        (["--band", "2:1"], "smaller bound first"),
        (["--denoise", "-1"], "--denoise is -1"),
        (["--denoise", "1", "--channel", "w"], "no channel 'w'"),
        (["--denoise", "--stripes", "flight"], "--stripes is 'flight', which the raster has not"),
        (["--denoise", "--stripes", "rows", "--pyramids", "0"], "thresholds assume white noise"),
    ],
)
def test_what_does_not_fit_is_refused(refused, pyramid, tmp_path, options, words):
    assert words in refused("filter", pyramid, tmp_path / "out.tif", *options)


def test_an_output_of_another_kind_is_refused(refused, pyramid, cloud_pyramid, tmp_path):
    assert "made from a raster" in refused("filter", pyramid, tmp_path / "o.laz", "--gain", "0=0")
    assert "made from a point" in refused(
        "filter", cloud_pyramid, tmp_path / "o.tif", "--gain", "0=0"
    )


@pytest.mark.parametrize("option", ["--gain=5", "--band=2", "--band-metres=a:b", "--denoise=x"])
def test_nonsense_is_a_usage_error(command, pyramid, tmp_path, option):
    assert command("filter", pyramid, tmp_path / "out.tif", option).code == 2


@pytest.mark.large
def test_the_examples_of_the_docs_run(done, noisy, tmp_path, monkeypatch, capsys):
    page = Path(__file__).resolve().parents[3] / "docs/topics/filtering.md"
    blocks = re.findall(r"^```(python|sh)\n(.*?)^```", page.read_text("utf-8"), re.M | re.S)
    assert [language for language, _ in blocks] == ["sh", "python", "python"]
    (tmp_path / "dem.tif").write_bytes(Path(noisy[0]).read_bytes())
    monkeypatch.chdir(tmp_path)
    scope = {}
    for language, text in blocks:
        if language == "python":
            exec(compile(text, page.name, "exec"), scope)
            continue
        for line in text.strip().splitlines():
            program, *arguments = shlex.split(line)
            assert program == "terrain-wavelets"
            done(*arguments)
    assert "furrows" in (out := capsys.readouterr().out)
    assert "noise" in out


def test_noise_by_place_with_a_range_and_outliers_is_told(tmp_path, capsys):
    noisy = hills() + np.random.default_rng(0).normal(0, 0.2, hills().shape)
    noisy[20, 20] += 60
    write_tif(tmp_path / "a.tif", noisy.astype("f4"))
    pyramid, out = str(tmp_path / "p.gpkg"), str(tmp_path / "b.tif")
    assert main(["analyse", str(tmp_path / "a.tif"), pyramid, "--levels", "4", "--quiet"]) == 0
    capsys.readouterr()
    options = ["--outliers", "--local-noise", "--noise-range", "auto", "--pyramids", "1"]
    assert main(["filter", pyramid, out, "--denoise", *options]) == 0
    assert "1 outlier replaced" in capsys.readouterr().out
    assert main(["filter", pyramid, out, "--gain", "1=0", "--outliers", "--overwrite"]) == 1
    assert "give --denoise too" in capsys.readouterr().err
    thresholds = ["--denoise", "--pyramids", "0", "--noise-range", "30", "--overwrite"]
    assert main(["filter", pyramid, out, *thresholds]) == 1
    assert "thresholds assume white noise" in capsys.readouterr().err


def test_outliers_that_pass_through_are_told(done, tmp_path):
    """Fifteen spikes of 60 m used to come through a denoising without a word."""
    rng = np.random.default_rng(4)
    rows, columns = np.mgrid[:60, :60]
    terrain = 300 + 40 * np.sin(columns / 9) * np.cos(rows / 7)
    noisy = terrain + rng.normal(0, 0.3, terrain.shape)
    spikes = rng.choice(np.arange(61, 3539, 7), 15, replace=False)
    noisy.flat[spikes] += 60
    for name, values in (("spikes", noisy), ("hills", terrain)):
        source = write_tif(tmp_path / f"{name}.tif", values)
        done("analyse", source, tmp_path / f"{name}.gpkg", "--partition", "quadric", "--quiet")
    spiky = tmp_path / "spikes.gpkg"
    said = done("filter", spiky, tmp_path / "a.tif", "--denoise")
    assert "(15 here; --outliers replaces them)" in said.err
    assert done("filter", spiky, tmp_path / "b.tif", "--denoise", "--outliers").err == ""
    assert done("filter", tmp_path / "hills.gpkg", tmp_path / "c.tif", "--denoise").err == ""
    with rasterio.open(tmp_path / "b.tif") as dataset:
        assert np.std(dataset.read(1) - terrain) < 0.2


@pytest.mark.parametrize(
    ("flag", "value"),
    [
        ("--channel", "z"),
        ("--pyramids", "4"),
        ("--noise-range", "30"),
        ("--outliers", None),
        ("--stripes", "rows"),
    ],
)
def test_what_tells_of_noise_is_refused_without_denoising(pyramid, refused, tmp_path, flag, value):
    """``--channel`` and ``--pyramids`` were passed over in silence."""
    options = [flag] if value is None else [flag, value]
    said = refused("filter", pyramid, tmp_path / "x.tif", "--gain", "0=0", *options)
    assert f"{flag} is for --denoise; give --denoise too" in said


@pytest.mark.parametrize("along", ["rows", "columns"])
def test_stripes_of_a_raster_with_a_hole_are_taken_out_and_told(done, tmp_path, along):
    rng = np.random.default_rng(5)
    y, x = np.mgrid[:70, :80]
    truth = 300 + 10 * np.sin(x / 15) * np.cos(y / 13) + 0.2 * x
    offsets = rng.normal(0, 1.0, 70)[:, None] if along == "rows" else rng.normal(0, 1.0, 80)
    striped = (truth + rng.normal(0, 0.2, truth.shape) + offsets).astype("f4")
    striped[20:35, 30:50] = -9999
    write_tif(tmp_path / "a.tif", striped, nodata=-9999)
    pyramid, clean, plain = (tmp_path / name for name in ("p.gpkg", "clean.tif", "plain.tif"))
    done("analyse", tmp_path / "a.tif", pyramid, "--quiet")
    said = done("filter", pyramid, clean, "--denoise", "--stripes", along, "--pyramids", 2).out
    taken = re.search(r"offsets of ([\d.]+) taken out of (\d+) lines", said)
    assert float(taken[1]) == pytest.approx(offsets.std(), rel=0.35)
    assert int(taken[2]) == offsets.size
    done("filter", pyramid, plain, "--denoise", "--pyramids", 2)
    has = striped != -9999
    errors = [np.sqrt(np.mean((band_of(path) - truth)[has] ** 2)) for path in (clean, plain)]
    assert errors[0] < 0.6 * errors[1]


def test_flight_lines_that_do_not_match_are_put_together(done, refused, tmp_path):
    rng = np.random.default_rng(6)
    plan = rng.uniform(0, 100, (5_000, 2)).round(2)
    flight = np.where(plan[:, 0] + rng.normal(0, 10, 5_000) > 50, 12, 7)
    truth = 200 + 5 * np.sin(plan[:, 0] / 15) + 0.05 * plan[:, 1]
    cloud = laspy.create(point_format=6, file_version="1.4")
    cloud.header.scales = [0.01, 0.01, 0.001]
    cloud.x, cloud.y = plan.T
    cloud.z = truth + rng.normal(0, 0.05, 5_000) + np.where(flight == 12, 0.4, 0.0)
    cloud.point_source_id = flight
    cloud.write(str(tmp_path / "a.las"))
    pyramid, out = tmp_path / "p.gpkg", tmp_path / "b.las"
    done("analyse", tmp_path / "a.las", pyramid, "--quiet")
    options = ["--denoise", "--pyramids", 2, "--stripes"]
    said = done("filter", pyramid, out, *options, "point_source_id").out
    assert "taken out of 2 lines" in said
    apart = np.asarray(laspy.read(out).z) - truth
    step = apart[flight == 12].mean() - apart[flight == 7].mean()
    assert step == pytest.approx(0.0, abs=0.02)
    words = refused("filter", pyramid, tmp_path / "c.las", *options, "rows")
    assert "--stripes is rows, which a point cloud has not" in words
    cloud_without = ["--denoise", "--stripes", "scan"]
    words = refused("filter", pyramid, tmp_path / "c.las", *cloud_without)
    assert "--stripes is 'scan', which the point cloud has not" in words
