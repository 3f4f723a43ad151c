"""LAZ files that make the decoder fail, die, or wait: one line, and this process goes on."""

import struct
import sys
import time

import laspy
import numpy as np
import pytest
from gis.samples import write_las

from wavelet_gis.errors import InputFileError
from wavelet_gis.io.las import laz_decoder, read_cloud
from wavelet_gis.io.las.layout import laszip_record, read_layout

pytestmark = pytest.mark.filterwarnings("ignore:.*(left out of the surface|runs from)")


@pytest.fixture(params=[("1.2", 3), ("1.4", 7)], ids=["pointwise", "layered"])
def laz(request, tmp_path):
    version, point_format = request.param
    return write_las(tmp_path / "a.laz", version=version, point_format=point_format)


def job_of(path):
    with open(path, "rb") as stream:
        layout = read_layout(str(path), stream)
    record = laszip_record(str(path), layout)
    return laz_decoder.Job(
        str(path), layout.points_start, record.data, layout.record_length, layout.n_points
    )


def decoded(job):
    out = np.empty(job.n_points * job.record_length, np.uint8)
    laz_decoder.decoded(job, out)
    return out.tobytes()


def test_the_child_and_this_process_decode_alike(laz, monkeypatch):
    expected = laspy.read(laz).points.array.tobytes()
    assert decoded(job_of(laz)) == expected
    monkeypatch.setattr(laz_decoder, "interpreter", lambda: None)
    assert decoded(job_of(laz)) == expected


def test_threads_decode_the_same(laz, monkeypatch):
    monkeypatch.setattr(laz_decoder, "THREADED", 10)
    pieces = []
    laz_decoder.decode(job_of(laz), lambda piece: pieces.append(bytes(piece)))
    assert b"".join(pieces) == laspy.read(laz).points.array.tobytes()


def test_an_embedding_program_is_no_interpreter(monkeypatch, tmp_path):
    """In QGIS on some systems `sys.executable` is QGIS: starting it would open another window."""
    qgis = tmp_path / "qgis-bin"
    qgis.write_text("")
    qgis.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(qgis))
    found = laz_decoder.interpreter()
    assert found != str(qgis)
    monkeypatch.setattr(sys, "_base_executable", str(qgis), raising=False)
    monkeypatch.setattr(sys, "exec_prefix", str(tmp_path))
    monkeypatch.setattr(sys, "base_exec_prefix", str(tmp_path))
    assert laz_decoder.interpreter() is None


def changed(path, edit):
    content = bytearray(path.read_bytes())
    edit(content, struct.unpack_from("<I", content, 96)[0])
    path.write_bytes(content)


def chunk_count(number):
    def edit(content, start):
        (table,) = struct.unpack_from("<q", content, start)
        struct.pack_into("<I", content, table + 4, number)

    return edit


def table_at(offset):
    return lambda content, start: struct.pack_into("<q", content, start, offset)


@pytest.mark.parametrize("in_child", [True, False])
@pytest.mark.parametrize(
    "edit",
    [
        chunk_count(2122465084),
        chunk_count(0),
        chunk_count(2),
        table_at(0),
        table_at(-1),
        table_at(-(1 << 60)),
        table_at(1 << 60),
        table_at(2000),
    ],
)
def test_tables_of_chunks_that_cannot_be(laz, monkeypatch, edit, in_child):
    if not in_child:
        monkeypatch.setattr(laz_decoder, "interpreter", lambda: None)
    changed(laz, edit)
    with pytest.raises(InputFileError, match="cannot be read") as caught:
        read_cloud(laz)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("size", [0xFFFFFFFF, 0x7FFFFFFF, 1 << 24])
def test_layers_longer_than_their_chunk(tmp_path, size):
    """The decoder makes room for each layer before it reads it."""
    laz = write_las(tmp_path / "a.laz", point_format=7)

    def edit(content, start):
        length = struct.unpack_from("<H", content, 105)[0]
        struct.pack_into("<I", content, start + 8 + length + 4, size)

    changed(laz, edit)
    with pytest.raises(InputFileError, match="layers"):
        read_cloud(laz)


@pytest.mark.parametrize("n_points", [1, 399, 401, 60_000, 1 << 20, 1 << 60])
def test_more_or_fewer_points_than_the_chunks_hold(tmp_path, n_points):
    laz = write_las(tmp_path / "a.laz")
    changed(laz, lambda content, _: struct.pack_into("<Q", content, 247, n_points))
    with pytest.raises(InputFileError):
        read_cloud(laz)


def dying(body):
    """Return a decoder that runs this instead."""
    return f"import sys\n{body}\n"


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("import os; os.abort()", "gives up"),
        ("sys.stderr.write('memory allocation of 34 bytes failed'); sys.exit(134)", "memory"),
        ("sys.stderr.write('thread panicked\\nlaz decoder: so it is\\n'); sys.exit(1)", "so it is"),
        ("sys.stdout.write('few')", "gives up"),
        ("sys.stderr.write('x' * 10_000_000); sys.exit(3)", "gives up"),
    ],
)
def test_a_decoder_that_dies_takes_one_line_with_it(tmp_path, monkeypatch, capfd, body, words):
    laz = write_las(tmp_path / "a.laz")
    script = tmp_path / "decoder.py"
    script.write_text(dying(body))
    monkeypatch.setattr(laz_decoder, "__file__", str(script))
    with pytest.raises(InputFileError, match=words) as caught:
        read_cloud(laz)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_a_decoder_that_waits_is_ended(tmp_path, monkeypatch):
    laz = write_las(tmp_path / "a.laz")
    script = tmp_path / "decoder.py"
    script.write_text(dying("import time; time.sleep(60)"))
    monkeypatch.setattr(laz_decoder, "__file__", str(script))
    monkeypatch.setattr(laz_decoder, "PATIENCE", 0.1)
    began = time.perf_counter()
    with pytest.raises(InputFileError, match="too long"):
        read_cloud(laz)
    assert time.perf_counter() - began < 10


def test_a_decoder_that_spins_is_ended_by_the_system(tmp_path, monkeypatch):
    laz = write_las(tmp_path / "a.laz")
    script = tmp_path / "decoder.py"
    script.write_text(
        dying("import resource; resource.setrlimit(resource.RLIMIT_CPU, (1, 2))\nwhile True: pass")
    )
    monkeypatch.setattr(laz_decoder, "__file__", str(script))
    with pytest.raises(InputFileError, match="too long"):
        read_cloud(laz)


@pytest.mark.parametrize("seed", range(12))
def test_damaged_compressed_points_are_read_or_refused(tmp_path, seed):
    laz = write_las(tmp_path / "a.laz", point_format=[1, 7][seed % 2])
    rng = np.random.default_rng(seed)

    def edit(content, start):
        for at in rng.integers(start, len(content), 3):
            content[at] = rng.integers(0, 256)

    changed(laz, edit)
    fault = None
    try:
        read_cloud(laz)
    except InputFileError as error:
        fault = str(error)
    assert fault is None or "\n" not in fault
