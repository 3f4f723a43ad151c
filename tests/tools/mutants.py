"""Change the code in one place at a time, and see whether a test notices.

    TERRAIN_WAVELETS_NO_NUMBA=1 python tests/tools/mutants.py [--number 150] [--only codecs]

A mutant is the program with one operator, comparison, number or truth value changed. They are drawn
at random, as many from each group of modules, and tried in a copy of the repository by the tests of
that group. One that no test fails on survives, and is printed: a test is missing there, or the
change makes no difference. The code is changed, the inputs are not; for those see ``mutate.py``.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
#: Of each group: the modules, and the tests that must notice; the quickest first.
GROUPS = {
    "lifting": (
        ("wavelet_core/lifting/*.py", "wavelet_core/_arrays/prediction.py",
         "wavelet_core/_arrays/update.py"),
        ("tests/core/lifting/test_hand_worked.py", "tests/core/lifting/test_options.py",
         "tests/core/lifting/test_analytic.py", "tests/core/features/test_spectrum.py",
         "tests/core/filtering/test_gains_and_thresholds.py", "tests/core/lifting/test_pyramid.py",
         "tests/core/lifting/test_recorded.py"),
    ),
    "collapse": (
        ("wavelet_core/mesh/collapse.py", "wavelet_core/partition/*.py",
         "wavelet_core/_arrays/partition.py"),
        ("tests/core/lifting/test_hand_worked.py", "tests/core/partition/test_collapse_costs.py",
         "tests/core/partition/test_plan_record.py", "tests/core/lifting/test_pyramid.py",
         "tests/core/lifting/test_begun.py", "tests/core/lifting/test_recorded.py",
         "tests/core/partition/test_error_guided.py", "tests/core/engines/test_engines.py"),
    ),
    "codecs": (
        ("wavelet_gis/io/pyramid/codecs/*.py",),
        ("tests/gis/io/pyramid/test_array_codec.py", "tests/gis/io/pyramid/test_face_codec.py",
         "tests/gis/io/pyramid/test_grid_codec.py", "tests/gis/io/pyramid/test_grid_reader.py"),
    ),
}  # fmt: skip
SWAPS = {
    ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"), ast.In: ("in", "not in"), ast.NotIn: ("not in", "in"),
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"), ast.Mod: ("%", "*"), ast.BitAnd: ("&", "|"), ast.BitOr: ("|", "&"),
    ast.LShift: ("<<", ">>"), ast.RShift: (">>", "<<"), ast.BitXor: ("^", "|"),
    ast.Pow: ("**", "*"), ast.And: ("and", "or"), ast.Or: ("or", "and"),
}  # fmt: skip


class Mutant(NamedTuple):
    """One change: where in which file, and what stands there instead."""

    path: Path
    start: int
    end: int
    text: str


def mutants_of(path: Path) -> list[Mutant]:
    """Return every mutant of a module that this tool knows how to make."""
    source = path.read_bytes()
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def begin(node: ast.expr) -> int:
        return starts[node.lineno - 1] + node.col_offset

    def end(node: ast.expr) -> int:
        return starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)

    found = []

    def between(left: ast.expr, operator: ast.AST, right: ast.expr) -> None:
        if type(operator) in SWAPS:
            old, new = SWAPS[type(operator)]
            at = source.find(old.encode(), end(left), begin(right))
            if at >= 0:
                found.append(Mutant(path, at, at + len(old), new))

    for node in _code(ast.parse(source)):
        if isinstance(node, ast.Compare):
            for left, operator, right in zip(
                [node.left, *node.comparators], node.ops, node.comparators, strict=False
            ):
                between(left, operator, right)
        elif isinstance(node, ast.BinOp):
            between(node.left, node.op, node.right)
        elif isinstance(node, ast.BoolOp):
            between(node.values[0], node.op, node.values[1])
        elif isinstance(node, ast.UnaryOp) and not isinstance(node.op, ast.UAdd):
            found.append(Mutant(path, begin(node), begin(node.operand), ""))
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            found.append(Mutant(path, begin(node), end(node), str(not node.value)))
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            found.append(Mutant(path, begin(node), end(node), repr(node.value + 1)))
        elif isinstance(node, ast.AugAssign) and type(node.op) in SWAPS:
            old, new = SWAPS[type(node.op)]
            at = source.find(old.encode() + b"=", end(node.target), begin(node.value))
            found.append(Mutant(path, at, at + len(old), new))
    return found


def _code(node: ast.AST) -> list[ast.AST]:
    """Return the nodes that do something: no types, and no words of a refusal."""
    found = [node]
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list") or isinstance(node, ast.Raise):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                found += _code(child)
    return found


def tried(mutant: Mutant, copy: Path, tests: tuple[str, ...], seconds: float) -> bool:
    """Return whether a test fails, or does not end, with the change made in the copy."""
    source = mutant.path.read_bytes()
    changed = source[: mutant.start] + mutant.text.encode() + source[mutant.end :]
    mutant.path.write_bytes(changed)
    try:
        return not passes(copy, tests, seconds)
    finally:
        mutant.path.write_bytes(source)


def passes(copy: Path, tests: tuple[str, ...], seconds: float) -> bool:
    """Return whether the tests pass in the copy within the time."""
    command = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    command += ["-m", "not large and not data and not exhaustive", *tests]
    environment = {**os.environ, "PYTHONPATH": f"{copy}{os.pathsep}{copy / 'tests'}"}
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, timeout=seconds, capture_output=True, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def shown(mutant: Mutant, copy: Path) -> str:
    """Return where the change is, and the line before and after."""
    source = mutant.path.read_bytes()
    line = source.count(b"\n", 0, mutant.start) + 1
    begin = source.rfind(b"\n", 0, mutant.start) + 1
    stop = source.find(b"\n", mutant.end)
    old = source[begin:stop].decode().strip()
    new = (source[begin : mutant.start] + mutant.text.encode() + source[mutant.end : stop]).decode()
    return f"{mutant.path.relative_to(copy)}:{line}\n    - {old}\n    + {new.strip()}"


def main() -> None:
    """Draw, try, report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=150, help="mutants in all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=GROUPS, action="append")
    parser.add_argument("--minutes", type=float, default=600.0, help="no mutant is begun later")
    arguments = parser.parse_args()
    drawn = random.Random(arguments.seed)
    begun = time.monotonic()
    groups = arguments.only or list(GROUPS)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("wavelet_core", "wavelet_gis", "plugin", "tests", "scripts", "pyproject.toml"):
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, copy / name)
        for group in groups:
            patterns, tests = GROUPS[group]
            paths = sorted(path for pattern in patterns for path in copy.glob(pattern))
            all_of_it = [mutant for path in paths for mutant in mutants_of(path)]
            chosen = drawn.sample(all_of_it, min(arguments.number // len(groups), len(all_of_it)))
            start = time.monotonic()
            if not passes(copy, tests, 3600.0):
                raise SystemExit(f"{group}: the tests fail without any change")
            limit = 3.0 * (time.monotonic() - start) + 10.0
            killed = n_tried = 0
            for mutant in chosen:
                if time.monotonic() - begun > 60.0 * arguments.minutes:
                    break
                n_tried += 1
                if tried(mutant, copy, tests, limit):
                    killed += 1
                else:
                    print(f"survives: {shown(mutant, copy)}", flush=True)
            print(
                f"{group}: {killed} of {n_tried} killed; {len(all_of_it):,} can be made", flush=True
            )


if __name__ == "__main__":
    main()
