"""Every real DEM and point cloud comes back: cells to the bit, point records to the byte.

Large files take one level here, without layers: what is tested is the way there and back, which
does not depend on the number of levels; the core's tests go through all of them. The cloud of ten
million points is tried where TERRAIN_WAVELETS_HUGE_FILES is set: decoding its faces takes minutes.
"""

import os

import pytest
from conftest import DATA
from gis.samples import assert_same_cloud, assert_same_raster

from wavelet_core import analyse
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.io.las import write_cloud
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, write_pyramid
from wavelet_gis.io.raster import write_dem
from wavelet_gis.workflows.open import open_terrain

pytestmark = [
    pytest.mark.data,
    pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning"),
]

#: More than four million vertices each: one level, and not in runs without numba.
LARGE = {
    "autzen_full_10M.laz",
    "srtm1_N48W125_4326.tif",
    "srtm1_N48W125_utm10_30m.tif",
    "srtm3_pyrenees_utm31_45m.tif",
}


HUGE = {"autzen_full_10M.laz"}


def files(folder, *suffixes):
    """Return the files of a folder of the data, the large ones marked so."""
    found = sorted(DATA.glob(f"{folder}/*")) if DATA.is_dir() else []
    return [
        pytest.param(
            path,
            id=path.name,
            marks=[pytest.mark.large] if is_large(path) else [],
        )
        for path in found
        if path.suffix in suffixes
        and (path.name not in HUGE or os.environ.get("TERRAIN_WAVELETS_HUGE_FILES"))
    ] or [pytest.param(None, id="absent")]


def is_large(path):
    return path.name in LARGE


def through_a_file(path, folder, attributes=()):
    """Return the pyramid read from the pyramid file that was made of ``path``."""
    terrain = open_terrain(path, attributes=attributes)
    n_levels = 1 if terrain.mesh.n_vertices > 300_000 else 3
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=n_levels))
    write_pyramid(folder / "a.gpkg", geo)
    del terrain, geo
    return read_pyramid(folder / "a.gpkg")


@pytest.mark.parametrize("path", files("dems", ".tif"))
def test_every_dem(path, tmp_path):
    geo = through_a_file(path, tmp_path)
    write_dem(tmp_path / "out.tif", geo.restore(), geo.system.wkt)
    assert_same_raster(path, tmp_path / "out.tif")
    os.remove(tmp_path / "a.gpkg")


@pytest.mark.parametrize("path", files("clouds", ".las", ".laz"))
def test_every_cloud(path, tmp_path):
    attributes = ["classification", "intensity", "return_number"]
    geo = through_a_file(path, tmp_path, attributes)
    write_cloud(tmp_path / f"out{path.suffix}", geo.restore())
    assert_same_cloud(path, tmp_path / f"out{path.suffix}")
    os.remove(tmp_path / "a.gpkg")


@pytest.mark.parametrize("name", ["autzen_trim.las", "Topography.laz", "bcts_1.laz"])
def test_height_above_ground_and_colour(data_folder, tmp_path, name):
    import laspy
    import numpy as np

    path = data_folder / "clouds" / name
    colours = ["red", "green"] if name.startswith("autzen") else []
    geo = through_a_file(path, tmp_path, ["hag", "classification", *colours])
    write_cloud(tmp_path / "out.laz", geo.restore())
    before, after = laspy.read(path), laspy.read(tmp_path / "out.laz")
    for dimension in before.point_format.dimension_names:
        assert (np.asarray(after[dimension]) == np.asarray(before[dimension])).all(), dimension
    heights = np.asarray(after.hag)
    is_ground = np.asarray(before.classification) == 2
    assert np.percentile(np.abs(heights[is_ground]), 99) < 0.05
    assert np.median(heights[~is_ground]) > 0


REFUSED = {
    "all_nan.tif": "nodata",
    "all_nodata_4band_u16.tif": "4 bands",
    "corrupt.tif": "3 bands",
    "nocrs_3band_u8.tif": "3 bands",
    "header_says_1065_has_0.las": "no points",
    "no_points.las": "no points",
    "las10_pdrf1.las": "1 point",
    "las11_pdrf0.las": "1 point",
    "lots_of_vlr.las": "1 point",
    "truncated_60pct.laz": "damaged",
}

#: Usable, but not without a word; the text is part of the warning.
WARNED = {
    "bad_vlr_count.las": "announces 3 VLRs, 2 lie before the points",
    "old_pointwise.laz": "say that x and y are in us survey foot",
    "lone-star.copc.laz": "neither geographic nor projected",
    "wkt_and_geotiff.las": "25 of the noise classes",
    "las13_waveform_pdrf4.las": "waveform",
    "las14_pdrf6_badwkt.laz": "CRS is broken",
    "warsaw_empty_wkt.las": "CRS is broken",
    "extrabytes.las": "no CRS",
    "simple1_1.las": "no CRS",
    "sample_c_nocrs.las": "no CRS",
    "local_cs_nonsquare.tif": "neither geographic nor projected",
    "pdrf10_waveform.laz": "waveform",
    "simple_with_page.copc.laz": "us survey foot",
}


@pytest.mark.filterwarnings("always::wavelet_gis.errors.TerrainWarning")
@pytest.mark.parametrize("path", files("nasty", ".tif", ".las", ".laz"))
def test_every_nasty_file_works_or_is_refused(path, tmp_path, recwarn):
    from wavelet_core import WaveletError

    if path.name in REFUSED:
        with pytest.raises(WaveletError, match=REFUSED[path.name]) as caught:
            open_terrain(path)
        assert path.name in str(caught.value)
        return
    geo = through_a_file(path, tmp_path)
    warned = [str(w.message) for w in recwarn if issubclass(w.category, TerrainWarning)]
    usual = ("share x and y with others", "gaps between the points", "no triangle")
    warned = [text for text in warned if not any(words in text for words in usual)]
    if path.name in WARNED:
        assert any(WARNED[path.name] in text for text in warned), warned
    else:
        assert warned == []
    if path.suffix == ".tif":
        write_dem(tmp_path / "out.tif", geo.restore(), geo.system.wkt)
        assert_same_raster(path, tmp_path / "out.tif")
        return
    import laspy

    write_cloud(tmp_path / f"out{path.suffix}", geo.restore())
    if path.suffix == ".las":
        assert (tmp_path / "out.las").read_bytes() == path.read_bytes()
        return
    before, after = laspy.read(path), laspy.read(tmp_path / f"out{path.suffix}")
    assert after.points.array.tobytes() == before.points.array.tobytes()
    assert list(after.header.scales) == list(before.header.scales)


@pytest.mark.parametrize(
    ("name", "band", "what"),
    [
        ("all_nodata_4band_u16.tif", 2, "nodata"),
        ("corrupt.tif", 1, "damaged"),
        ("all_nodata_4band_u16.tif", 5, "no band 5"),
    ],
)
def test_bands_of_nasty_rasters(data_folder, name, band, what):
    from wavelet_gis.errors import InputFileError

    with pytest.raises(InputFileError, match=what):
        open_terrain(data_folder / "nasty" / name, band=band)


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_a_band_of_a_picture(data_folder, tmp_path):
    path = data_folder / "nasty" / "nocrs_3band_u8.tif"
    terrain = open_terrain(path, band=1)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=2))
    write_dem(tmp_path / "out.tif", geo.restore(), geo.system.wkt)
    assert_same_raster(path, tmp_path / "out.tif", band=1)
