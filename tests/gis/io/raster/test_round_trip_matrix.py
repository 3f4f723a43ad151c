"""DEMs of every type, nodata value, scale, mask, CRS and orientation come back bit for bit.

By default a sample runs in which every pair of values of two axes occurs; the whole is marked
`exhaustive`.
"""

import itertools
import warnings

import numpy as np
import pytest
import rasterio
from gis.samples import assert_same_raster, hills, write_tif

from wavelet_core import analyse
from wavelet_gis.io.raster import write_dem
from wavelet_gis.workflows.open import open_terrain

#: The stored number that is tagged as nodata, by type; "low" is the lowest that it has.
TAGS = (None, "low", 0, "nan")

SCALES = ((1.0, 0.0), (0.1, -100.0), (-2.0, 0.0))

#: What tells of holes beside the tag.
MASKS = ("none", "internal", "beside", "not finite")

SYSTEMS = {
    "none": None,
    "metres": "EPSG:32632",
    "feet": "EPSG:2263",
    "kilometres": "+proj=utm +zone=32 +units=km",
    "degrees": "EPSG:4326",
    "compound": "EPSG:32632+5773",
    "feet over metres": "EPSG:26915+6360",
    "local": 'LOCAL_CS["site",UNIT["metre",1]]',
}

#: The affine map of cells to a plane whose cells have a side of one.
ORIENTATIONS = {
    "north up": (1.0, 0.0, 0.0, -1.0),
    "south up": (1.0, 0.0, 0.0, 1.0),
    "west right": (-1.0, 0.0, 0.0, -1.0),
    "turned": (0.8, -0.6, -0.6, -0.8),
    "a quarter": (0.0, 1.0, 1.0, 0.0),
    "sheared": (1.0, 0.3, 0.0, -0.7),
}

DTYPES = ("uint8", "int8", "int16", "uint16", "int32", "uint32", "float32", "float64")

AXES = (DTYPES, TAGS, SCALES, MASKS, tuple(SYSTEMS), tuple(ORIENTATIONS))


def has_meaning(case):
    """Whether a case can be: integers are never NaN, and a mask hides a tag."""
    dtype, tag, _, mask, _, _ = case
    is_float = dtype[0] == "f"
    if (tag == "nan" or mask == "not finite") and not is_float:
        return False
    return tag is None or mask in ("none", "not finite")


def pairs_of(case):
    return set(itertools.combinations(enumerate(case), 2))


def sample():
    """Return cases that hold every pair of values that any case has, chosen greedily."""
    cases = [case for case in itertools.product(*AXES) if has_meaning(case)]
    order = np.random.default_rng(0).permutation(len(cases))
    left = set().union(*map(pairs_of, cases))
    chosen = []
    while left:
        some = order[np.random.default_rng(len(left)).integers(0, len(order), 400)]
        best = max((cases[k] for k in some), key=lambda case: len(pairs_of(case) & left))
        if pairs_of(best) & left:
            chosen.append(best)
            left -= pairs_of(best)
        else:  # a pair too rare for the draw
            pair = min(left, key=str)
            best = next(case for case in cases if pair in pairs_of(case))
            chosen.append(best)
            left -= pairs_of(best)
    return chosen


def write_case(path, case):
    dtype, tag, (scale, offset), mask, system, orientation = case
    a, b, d, e = ORIENTATIONS[orientation]
    side = {"degrees": 0.001, "kilometres": 0.01}.get(system, 10.0)
    x, y = {"degrees": (7.0, 44.0), "kilometres": (500.0, 5100.0)}.get(system, (5e5, 5.1e6))
    transform = rasterio.Affine(a * side, b * side, x, d * side, e * side, y)
    values = (hills(12, 13) / 4).astype(dtype)
    if dtype in ("int16", "int32", "float32", "float64"):
        values[1] *= -1
    low = np.finfo(dtype).min if dtype[0] == "f" else np.iinfo(dtype).min
    number = {"low": low, "nan": np.nan, None: None, 0: 0}[tag]
    if tag is not None:
        values[2:5, 3:6] = number
    if mask == "not finite":
        values[8, 8:10] = np.nan, -np.inf
    number = None if number is None else float(number)
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=mask == "internal"):
        write_tif(path, values, crs=SYSTEMS[system], transform=transform, nodata=number)
        if mask in ("internal", "beside"):
            data = np.ones(values.shape, dtype=bool)
            data[7:9, 7:9] = False
            with rasterio.open(path, "r+") as dataset:
                dataset.write_mask(data)
    if (scale, offset) != (1.0, 0.0):
        with rasterio.open(path, "r+") as dataset:
            dataset.scales, dataset.offsets = (scale,), (offset,)
    with rasterio.open(path, "r+") as dataset:
        dataset.update_tags(maker="a company", AREA_OR_POINT="Point")
        dataset.update_tags(1, LAYER_TYPE="thematic")
        dataset.set_band_description(1, "elevation")


def come_back(folder, cases):
    source, out = folder / "a.tif", folder / "b.tif"
    for case in cases:
        for path in folder.iterdir():
            path.unlink()
        write_case(source, case)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            terrain = open_terrain(source)
        geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=1))
        write_dem(out, geo.restore(), geo.system.wkt)
        try:
            assert_same_raster(source, out)
            with rasterio.open(source) as before, rasterio.open(out) as after:
                assert after.tags() == before.tags()
                assert after.tags(1) == before.tags(1)
                assert after.descriptions == before.descriptions
        except AssertionError as error:
            raise AssertionError(f"{case}: {error}") from error


def test_the_sample_holds_every_pair():
    held = set().union(*map(pairs_of, sample()))
    for one, other in itertools.combinations(range(len(AXES)), 2):
        for first, second in itertools.product(AXES[one], AXES[other]):
            pair = ((one, first), (other, second))
            case = next((c for c in itertools.product(*AXES) if pair[0][1] == c[one]
                         and pair[1][1] == c[other] and has_meaning(c)), None)  # fmt: skip
            assert case is None or pair in held


def test_a_sample_of_the_matrix(tmp_path):
    come_back(tmp_path, sample())


@pytest.mark.exhaustive
@pytest.mark.parametrize("dtype", DTYPES)
def test_the_whole_matrix(tmp_path, dtype):
    cases = [c for c in itertools.product(*AXES) if c[0] == dtype and has_meaning(c)]
    assert len(cases) > 500
    come_back(tmp_path, cases)
