"""The tables of formats: what they say is so, and whoever lists formats has it from them."""

import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from wavelet_core import synthetic
from wavelet_gis.io import formats
from wavelet_gis.io.formats import MESH_FORMATS, MESH_SUFFIXES, mesh_format
from wavelet_gis.io.mesh.meshes import write_mesh

DOCS = Path(__file__).resolve().parent.parent.parent.parent / "docs" / "reference"


@pytest.mark.parametrize("row", MESH_FORMATS, ids=lambda row: row.name)
def test_a_row_says_what_its_writer_does(row, tmp_path):
    mesh = synthetic.plane()
    path = tmp_path / f"a{row.suffix}"
    module = row.writer.split(":")[0]
    library = (row.package or "").removeprefix("python-")
    if library:
        pytest.importorskip(library)
    write_mesh(path, mesh, 'LOCAL_CS["here"]')
    assert path.stat().st_size > 100
    assert path.with_suffix(".prj").exists() == row.has_prj
    assert ("LOCAL_CS[" in path.read_text("latin-1")) == (row.takes_crs and not row.has_prj)
    assert not library or f"import {library}" in Path(
        importlib.import_module(module).__file__
    ).read_text("utf-8")


def test_suffixes_are_told_apart_whatever_their_case():
    assert mesh_format("A.PLY").name == "PLY"
    assert mesh_format("a.b/c") is None
    assert len(set(MESH_SUFFIXES)) == len(MESH_FORMATS)


def test_help_lists_every_format_and_imports_nothing():
    code = (
        "import sys; from wavelet_gis.cli.main import main; main(['extract', '--help']);"
        "print('HEAVY', sorted({'numpy', 'scipy'} & set(sys.modules)))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout
    assert "HEAVY []" in said
    words = " ".join(said.split())
    assert all(row.name in words and row.suffix in words for row in MESH_FORMATS)


def test_the_page_on_formats_has_the_rows_of_the_table():
    page = (DOCS / "formats.md").read_text("utf-8")
    for row in formats.MESH_FORMATS:
        assert f"| {row.name} | `{row.suffix}` | {row.used_by} | {row.package or '-'} |" in page


def test_a_format_is_one_function_and_one_row(tmp_path, monkeypatch):
    """A new row is written by its suffix, listed in messages and taken by the commands' checks."""
    (tmp_path / "my_format.py").write_text(
        "from wavelet_gis.io.read_back import recorded_stream\n"
        "def write_off(path, mesh):\n"
        "    with recorded_stream(path) as stream:\n"
        "        stream.write(f'OFF {mesh.n_vertices} {mesh.n_faces}')\n"
    )
    script = tmp_path / "try_it.py"
    script.write_text(
        "import sys\n"
        "from wavelet_gis.io import formats\n"
        "row = formats.MeshFormat('.off', 'OFF', 'my_format:write_off', 'viewers')\n"
        "formats.MESH_FORMATS = (*formats.MESH_FORMATS, row)\n"
        "formats.MESH_SUFFIXES = (*formats.MESH_SUFFIXES, '.off')\n"
        "import wavelet_gis as wg\n"
        "from wavelet_gis.cli.main import main\n"
        "main(['extract', '--help'])\n"
        "dem = wg.open(sys.argv[1])\n"
        "wg.save(wg.simplify(dem, vertices=50), sys.argv[2])\n"
    )
    from gis.samples import hills, write_tif

    source = write_tif(tmp_path / "dem.tif", hills().astype(np.float32))
    said = subprocess.run(
        [sys.executable, str(script), str(source), str(tmp_path / "a.off")],
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    assert "OFF" in said.stdout
    assert ".off" in said.stdout
    assert (tmp_path / "a.off").read_text().startswith("OFF 50 ")
