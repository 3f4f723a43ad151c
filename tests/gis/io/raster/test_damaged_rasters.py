"""Rasters as `tests/tools/mutate.py tif` made them."""

import struct

import pytest
from gis.samples import hills, write_tif
from tools.readers import KINDS

from wavelet_gis.errors import RasterWarning
from wavelet_gis.workflows.open import open_input


def widened(path, width):
    """Let the first directory of a classic little-endian TIFF claim another width."""
    content = bytearray(path.read_bytes())
    (start,) = struct.unpack_from("<I", content, 4)
    (n_tags,) = struct.unpack_from("<H", content, start)
    for at in range(start + 2, start + 2 + 12 * n_tags, 12):
        if struct.unpack_from("<H", content, at)[0] == 256:
            struct.pack_into("<H", content, at + 8, width)
    path.write_bytes(content)
    return path


def test_what_gdal_complains_of_is_told(tmp_path, capfd):
    """A JPEG narrower than its raster leaves cells that were never written, with exit 0."""
    path = write_tif(tmp_path / "x.tif", (hills(20, 24) / 3).astype("u1"), compress="jpeg")
    widened(path, 56)
    with pytest.warns(RasterWarning) as caught:
        terrain = open_input(path)
    told = [str(one.message) for one in caught if "GDAL reported" in str(one.message)]
    assert len(told) == 1
    assert "expected 56x20, got 24x20" in told[0]
    notes = [note for note in terrain.notes if note.code == "raster_read_with_complaints"]
    assert notes[0].text.startswith("x.tif: read, but GDAL reported: ")
    assert KINDS["tif"].telling in notes[0].text  # the fuzzer knows it by these words
    assert capfd.readouterr().err == ""


def test_a_sound_raster_raises_no_complaint(tmp_path):
    path = write_tif(tmp_path / "x.tif", hills(20, 24).astype("f4"), compress="deflate")
    assert open_input(path).notes == ()
