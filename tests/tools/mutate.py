"""Damage files at random and see what the readers make of them.

    python tests/tools/mutate.py las --count 20000 --seed 1 --keep found
    python tests/tools/mutate.py tif --count 100000

Each mutated file goes through a reader in a worker process with a limit on its memory and a clock.
What counts as a fault:

* ``crash``      the worker died (a signal, an abort);
* ``hang``       more than 10 s of the processor on one file;
* ``traceback``  an exception that is none of the package's own, or a message of several lines;
* ``chatter``    something on standard error that the package did not say (a Rust panic);
* ``silent``     another result than the damaged file holds, see `readers`.

The same seed gives the same files, whatever the number of workers. The exit code is 1 where a fault
was found; ``--keep`` writes the files that gave one.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import select
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

# The readers of this tree, whatever is installed.
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from tools.readers import KINDS, Base, Kind  # noqa: E402

SECONDS, MEMORY = 10.0, 1 << 30

#: The clock on the wall may show this many times more.
PATIENCE = 8

#: Files that one worker tries before another takes its place, and before figures are printed.
BATCH = 5000

FAULTS = ("crash", "hang", "traceback", "chatter", "silent")

#: Numbers that readers trip over, by width in bytes.
NUMBERS = {
    1: (0, 1, 0x7F, 0x80, 0xFF),
    2: (0, 1, 0x7FFF, 0x8000, 0xFFFF),
    4: (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 20),
    8: (0, 1, (1 << 63) - 1, 1 << 63, (1 << 64) - 1, 1 << 32, 1 << 40),
}
DOUBLES = (0.0, -1.0, float("nan"), float("inf"), 1e308, -1e308, 5e-324, 1e12, 1e-9)


#: What numbers in text are replaced by.
WORDS = (
    b"0", b"-1", b"1e308", b"-1e308", b"nan", b"inf", b"1e999", b"4294967296", b"1e-320", b"x", b"",
    b"9" * 400, b"1.2.3", b"[" * 2000, b"\0", b"\xff", b"1,5", b"<", b'"', b"-9999", b"1e18",
)  # fmt: skip
TEXTS = (".csv", ".xyz", ".geojson", ".gml", ".kml")
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")


def mutated(base: Base, rng: np.random.Generator) -> tuple[bytes, bool]:
    """Return a damaged file, and whether all the damage lies before its points."""
    content = bytearray(base.content)
    if base.name.endswith(TEXTS) and rng.random() < 0.5:
        return _reworded(content, rng), False
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


def _reworded(content: bytearray, rng: np.random.Generator) -> bytes:
    places = list(NUMBER.finditer(content))
    for k in sorted(rng.choice(len(places), int(rng.integers(1, 4))), reverse=True):
        content[places[k].start() : places[k].end()] = WORDS[int(rng.integers(0, len(WORDS)))]
    return bytes(content)


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
    texts = [str(warning.message) for warning in told]
    is_told = kind.telling is not None and any(kind.telling in text for text in texts)
    if not is_told and kind.is_wrong(found, expected, path, in_head):
        return "silent", "another result than the file holds"
    return ("warned", texts[0]) if texts else ("read", "")


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
            path = laid_out(Path(folder), bases[k], content)
            print(json.dumps({"number": number}), flush=True)
            before = os.fstat(2).st_size
            began = _processor_time()
            what, message = outcome_of(kind, path, expected[k], in_head)
            if os.fstat(2).st_size != before:
                what, message = "chatter", message
            seconds = _processor_time() - began
            line = {"number": number, "what": what, "message": message, "seconds": seconds}
            print(json.dumps(line), flush=True)


def _processor_time() -> float:
    """Return the seconds of this process and its children: other work on the machine is none."""
    return sum(os.times()[:4])


def laid_out(folder: Path, base: Base, content: bytes) -> Path:
    """Write a damaged file with the companions of the sound one; return its path."""
    for old in folder.glob("case*"):
        old.unlink()
    stem, suffix = base.name.rsplit(".", 1)
    for companion in folder.glob(f"{stem}.*"):
        if companion.suffix in (".shx", ".dbf", ".prj", ".cpg"):
            shutil.copy(companion, folder / f"case{companion.suffix}")
    path = folder / f"case.{suffix}"
    path.write_bytes(content)
    return path


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
            chatter.seek(0)
            said = chatter.read()[-2000:].decode(errors="replace")
        outcomes += done
        if fault is None:
            break
        number = fault["number"]
        if number is None:
            raise RuntimeError(f"the worker dies before its first file: {said}")
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
        ready = select.select([descriptor], [], [], 600 if current is None else SECONDS * PATIENCE)[
            0
        ]
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
    numbers = range(arguments.first, arguments.first + arguments.count)
    counts: Counter[str] = Counter()
    began, slowest = time.perf_counter(), 0.0
    for start in range(numbers.start, numbers.stop, BATCH):
        batch = range(start, min(start + BATCH, numbers.stop))
        outcomes = run(arguments.kind, arguments.seed, batch)
        counts.update(outcome["what"] for outcome in outcomes)
        slowest = max([slowest, *(outcome["seconds"] for outcome in outcomes)])
        faults = [outcome for outcome in outcomes if outcome["what"] in FAULTS]
        for fault in faults:
            print(f"{fault['number']}: {fault['what']} {fault['message']}")
        if arguments.keep and faults:
            keep(arguments.kind, arguments.seed, faults, arguments.keep)
        told = ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
        print(
            f"{counts.total()} files of seed {arguments.seed}: {told}; slowest {slowest:.1f} s; "
            f"{time.perf_counter() - began:.0f} s in all",
            flush=True,
        )
    return 1 if any(counts[what] for what in FAULTS) else 0


def keep(kind_name: str, seed: int, faults: list[dict[str, Any]], folder: Path) -> None:
    """Write the files that gave a fault."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        bases = KINDS[kind_name].bases(Path(scratch))
    for fault in faults:
        content, _, k = case(bases, seed, fault["number"])
        name = f"{fault['number']}_{fault['what']}{Path(bases[k].name).suffix}"
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    sys.exit(main())
