"""Damage files at random and see what the readers make of them.

    python tests/tools/mutate.py las --count 20000 --seed 1 --keep found

Each mutated file goes through a reader in a worker process with a limit on its memory and a clock.
What counts as a fault:

* ``crash``      the worker died (a signal, an abort);
* ``hang``       more than 10 s on one file;
* ``traceback``  an exception that is none of the package's own, or a message of several lines;
* ``chatter``    something on standard error that the package did not say (a Rust panic);
* ``silent``     coordinates changed, and neither an error nor a warning: only for damage before the
  first point, since a LAS file holds no checksum over its points.

The same seed gives the same files, whatever the number of workers. The exit code is 1 where a fault
was found; ``--keep`` writes the files that gave one.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import select
import struct
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

# The readers of this tree, whatever is installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

SECONDS, MEMORY = 10.0, 1 << 30
FAULTS = ("crash", "hang", "traceback", "chatter", "silent")

#: Numbers that readers trip over, by width in bytes.
NUMBERS = {
    1: (0, 1, 0x7F, 0x80, 0xFF),
    2: (0, 1, 0x7FFF, 0x8000, 0xFFFF),
    4: (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 20),
    8: (0, 1, (1 << 63) - 1, 1 << 63, (1 << 64) - 1, 1 << 32, 1 << 40),
}
DOUBLES = (0.0, -1.0, float("nan"), float("inf"), 1e308, -1e308, 5e-324, 1e12, 1e-9)


class Base(NamedTuple):
    """A sound file, and where its points begin."""

    name: str
    content: bytes
    head: int


class Kind(NamedTuple):
    """What is tried: the sound files, and a reader that returns what must not change silently."""

    bases: Callable[[Path], list[Base]]
    read: Callable[[Path], Any]


def mutated(base: Base, rng: np.random.Generator) -> tuple[bytes, bool]:
    """Return a damaged file, and whether all the damage lies before its points."""
    content = bytearray(base.content)
    in_head = bool(rng.random() < 0.75)
    for _ in range(int(rng.choice([1, 1, 1, 2, 2, 4, 8]))):
        limit = min(base.head, len(content)) if in_head else len(content)
        if limit < 16:
            break
        _damage(content, int(rng.integers(0, limit)), limit, rng)
    if rng.random() < 0.05:
        del content[int(rng.integers(0, len(content))) :]
        in_head = False
    return bytes(content), in_head and len(content) == len(base.content)


def _damage(content: bytearray, at: int, limit: int, rng: np.random.Generator) -> None:
    way = int(rng.integers(0, 6))
    if way == 0:
        content[at] ^= 1 << int(rng.integers(0, 8))
    elif way == 1:
        content[at] = int(rng.integers(0, 256))
    elif way in (2, 3):
        width = int(rng.choice(list(NUMBERS)))
        number = int(NUMBERS[width][int(rng.integers(0, len(NUMBERS[width])))])
        at = min(at, limit - width)
        content[at : at + width] = number.to_bytes(width, "little")
    elif way == 4:
        at = min(at, limit - 8)
        content[at : at + 8] = struct.pack("<d", DOUBLES[int(rng.integers(0, len(DOUBLES)))])
    else:
        other = int(rng.integers(0, limit))
        n_bytes = int(min(rng.integers(1, 9), limit - at, limit - other))
        content[at : at + n_bytes] = content[other : other + n_bytes]


def las_bases(folder: Path) -> list[Base]:
    """Return small LAS and LAZ files of every kind."""
    import laspy

    bases = []
    for suffix in ("las", "laz"):
        for version, point_format in (("1.2", 3), ("1.3", 1), ("1.4", 6), ("1.4", 7), ("1.4", 1)):
            header = laspy.LasHeader(version=version, point_format=point_format)
            header.scales, header.offsets = [0.01] * 3, [500000.0, 5100000.0, 0.0]
            if version == "1.4":
                header.add_extra_dim(
                    laspy.ExtraBytesParams("range", "i2", scales=[0.5], offsets=[1.0])
                )
            from pyproj import CRS

            header.add_crs(CRS.from_epsg(25832))
            las = laspy.LasData(header)
            rng = np.random.default_rng(point_format)
            las.x, las.y = 500000 + 90 * rng.random((1, 300))[0], 5100000 + 90 * rng.random(300)
            las.z = 300 + 9 * np.sin(np.asarray(las.x) / 9)
            las.classification = rng.choice([1, 2, 5], 300).astype(np.uint8)
            las.return_number = np.ones(300, np.uint8)
            if version == "1.4":
                las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("me", 5, "", bytes(40))])
            path = folder / f"base_{version}_{point_format}.{suffix}"
            las.write(path)
            content = path.read_bytes()
            head = struct.unpack_from("<I", content, 96)[0]
            bases.append(Base(path.name, content, head))
    return bases


def read_las(path: Path) -> Any:
    """Return the coordinates of a LAS file, taken through the mesh and back."""
    from wavelet_gis.io.las import write_cloud
    from wavelet_gis.workflows.open import open_terrain

    terrain = open_terrain(path)
    write_cloud(path.with_name("back.las"), terrain.original)  # type: ignore[arg-type]
    return terrain.original.coordinates()  # type: ignore[union-attr]


KINDS = {"las": Kind(las_bases, read_las)}


def outcome_of(kind: Kind, path: Path, expected: Any, in_head: bool) -> tuple[str, str]:
    """Return what became of one file, in this process."""
    from wavelet_core.errors import WaveletError

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            found = kind.read(path)
        except WaveletError as error:
            lines = str(error).splitlines()
            return ("refused" if len(lines) == 1 else "traceback"), str(error)
        except BaseException as error:  # a panic is no Exception
            if isinstance(error, KeyboardInterrupt):
                raise
            return "traceback", f"{type(error).__name__}: {error}"
    if told:
        return "warned", str(told[0].message)
    if in_head and not _same(found, expected):
        return "silent", "coordinates changed"
    return "read", ""


def _same(found: Any, expected: Any) -> bool:
    if found.shape != expected.shape:
        return False
    slack = 0.002 * np.ptp(expected, axis=0) + 0.1
    return bool((np.abs(found - expected) <= slack).all())


def work(kind_name: str, seed: int, numbers: range) -> None:
    """Try files of given numbers, one line of JSON for each: the worker's side."""
    kind = KINDS[kind_name]
    with tempfile.TemporaryDirectory() as folder:
        bases = kind.bases(Path(folder))
        expected = []
        for base in bases:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                expected.append(kind.read(Path(folder) / base.name))
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
        for number in numbers:
            content, in_head, k = case(bases, seed, number)
            path = Path(folder) / f"case{Path(bases[k].name).suffix}"
            path.write_bytes(content)
            print(json.dumps({"number": number}), flush=True)
            before = os.fstat(2).st_size
            began = time.perf_counter()
            what, message = outcome_of(kind, path, expected[k], in_head)
            if os.fstat(2).st_size != before:
                what, message = "chatter", message
            seconds = time.perf_counter() - began
            line = {"number": number, "what": what, "message": message, "seconds": seconds}
            print(json.dumps(line), flush=True)


def case(bases: list[Base], seed: int, number: int) -> tuple[bytes, bool, int]:
    """Return the file of a number, whether its points are untouched, and its base."""
    rng = np.random.default_rng([seed, number])
    k = int(rng.integers(0, len(bases)))
    return (*mutated(bases[k], rng), k)


def run(kind_name: str, seed: int, numbers: range, *, again: bool = False) -> list[dict[str, Any]]:
    """Return the outcomes of some files, however often the worker dies; hangs are tried twice."""
    outcomes: list[dict[str, Any]] = []
    while len(numbers):
        with tempfile.TemporaryFile() as chatter:
            command = [sys.executable, __file__, kind_name, "--seed", str(seed), "--worker"]
            command += [str(numbers.start), str(numbers.stop)]
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=chatter) as worker:
                done, fault = _listen(worker)
        outcomes += done
        if fault is None:
            break
        number = fault["number"]
        if number is None:
            raise RuntimeError("the worker dies before its first file")
        if fault["what"] == "hang" and not again:  # or the machine is busy
            outcomes += run(kind_name, seed, range(number, number + 1), again=True)
        else:
            outcomes.append(fault)
        numbers = range(number + 1, numbers.stop)
    return outcomes


def _listen(worker: subprocess.Popen[bytes]) -> tuple[list[dict[str, Any]], dict[str, Any] | None]:
    """Collect a worker's lines; return them, and the fault that ended it if one did."""
    assert worker.stdout is not None
    done: list[dict[str, Any]] = []
    current: int | None = None
    descriptor, pending = worker.stdout.fileno(), b""
    while True:
        ready = select.select([descriptor], [], [], SECONDS + (60 if current is None else 2))[0]
        if not ready:
            worker.kill()
            return done, {"number": current, "what": "hang", "message": "", "seconds": SECONDS}
        piece = os.read(descriptor, 65536)
        if not piece:
            break
        *lines, pending = (pending + piece).split(b"\n")
        for line in map(json.loads, lines):
            current = line["number"]
            if "what" in line:
                if line["seconds"] > SECONDS:
                    line["what"] = "hang"
                done.append(line)
    code = worker.wait()
    if code == 0:
        return done, None
    return done, {"number": current, "what": "crash", "message": f"exit {code}", "seconds": 0.0}


def main() -> int:
    """Run the tool."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--count", type=int, default=1000, metavar="N")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="number of the first")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="write files with faults here")
    parser.add_argument("--worker", type=int, nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        work(arguments.kind, arguments.seed, range(*arguments.worker))
        return 0
    began = time.perf_counter()
    numbers = range(arguments.first, arguments.first + arguments.count)
    outcomes = run(arguments.kind, arguments.seed, numbers)
    counts = Counter(outcome["what"] for outcome in outcomes)
    faults = [outcome for outcome in outcomes if outcome["what"] in FAULTS]
    for fault in faults:
        print(f"{fault['number']}: {fault['what']} {fault['message']}")
    if arguments.keep and faults:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as folder:
            bases = KINDS[arguments.kind].bases(Path(folder))
        for fault in faults:
            content, _, k = case(bases, arguments.seed, fault["number"])
            name = f"{fault['number']}_{fault['what']}{Path(bases[k].name).suffix}"
            (arguments.keep / name).write_bytes(content)
    slowest = max((outcome["seconds"] for outcome in outcomes), default=0.0)
    told = ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
    print(
        f"{len(outcomes)} files of seed {arguments.seed}: {told}; slowest {slowest:.1f} s; "
        f"{time.perf_counter() - began:.0f} s in all"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
