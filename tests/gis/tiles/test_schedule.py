"""A schedule of many tiles through the real scheduler, with failures and without any terrain."""

import hashlib
import json
import os
from dataclasses import replace
from pathlib import Path

import pytest
from gis.samples import UTM
from gis.tiles.test_borders import plan_of

from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.tiles.piece import PIECES, read_record
from wavelet_gis.tiles.plan import PLAN, Piece, SourceFile, TilePlan
from wavelet_gis.tiles.tile import run_plan

#: A hundred thousand tiles take some ten minutes.
WHERE_ASKED = pytest.mark.skipif(
    not os.environ.get("TERRAIN_WAVELETS_HUGE_FILES"), reason="asked for by that variable"
)


def lot(piece, what):
    """A number from 0 to 1 that a piece draws."""
    digest = hashlib.sha256(f"{piece.name} {what}".encode()).digest()
    return int.from_bytes(digest[:4], "little") / 2**32


def simulated_piece(folder, piece, inputs):
    """Make a piece of nothing but a name: some kill their worker at first, some fail.

    What it did is written down, so that nothing is killed or fails twice.
    """
    tried = Path(folder) / "tried" / piece.name.replace("/", "_")
    share = float(os.environ["SIMULATED_FAILURES"])
    if not tried.exists():
        if lot(piece, "kill") < share / 5:
            tried.touch()
            os._exit(9)
        if lot(piece, "fail") < share:
            tried.touch()
            return written(
                folder, piece, {"status": "failed", "reason": "simulated", **common(piece, inputs)}
            )
    content = f"{piece.name} {sorted(inputs.items())}".encode()
    place = Path(folder) / PIECES / f"{piece.name}.gpkg"
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(content)
    record = {"status": "whole", "n_levels": 1, "sizes": [1, 2], "n_bytes": len(content)}
    record["sha256"] = hashlib.sha256(content).hexdigest()
    return written(folder, piece, record | common(piece, inputs))


def common(piece, inputs):
    return {**piece._asdict(), "inputs": inputs, "plan": os.environ["SIMULATED_PLAN"]}


def written(folder, piece, record):
    place = Path(folder) / PIECES / f"{piece.name}.json"
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(json.dumps(record))
    return record


def national(n_rows, n_columns, tmp_path):
    """A plan of so many tiles, each with a file of its own that reaches a little beyond it."""
    plan = plan_of(tuple(range(0, 64 * n_rows + 1, 64)), tuple(range(0, 64 * n_columns + 1, 64)))
    files = [
        SourceFile(f"/nowhere/{i}_{j}.laz", 64 * i - 1, 64 * j - 1, 66, 66, 10, 0)
        for i in range(n_rows)
        for j in range(n_columns)
    ]
    (tmp_path / "t" / "tried").mkdir(parents=True)
    plan = replace(plan, files=tuple(files), points=None, system=coordinate_system(UTM).to_dict())
    (tmp_path / "t" / PLAN).write_text(plan.to_json(), "utf-8")
    return plan


@pytest.mark.parametrize(
    ("n_rows", "n_columns", "share"),
    [
        (11, 9, 0.05),
        pytest.param(24, 25, 0.02, marks=pytest.mark.large),
        pytest.param(250, 400, 0.002, marks=[pytest.mark.large, WHERE_ASKED]),
    ],
)
def test_a_schedule_with_failures_ends_with_every_piece(
    n_rows, n_columns, share, tmp_path, monkeypatch
):
    plan = national(n_rows, n_columns, tmp_path)
    monkeypatch.setenv("SIMULATED_FAILURES", str(share))
    monkeypatch.setenv("SIMULATED_PLAN", plan.checksum)
    n_total = sum(len(plan.pieces(stage)) for stage in range(plan.n_stages))
    done = []
    run = {"make": simulated_piece, "on_piece": lambda record, k, n: done.append((k, n))}
    with pytest.warns(TerrainWarning, match="were set aside"):
        first = run_plan(plan, tmp_path / "t", 2, **run)
    assert done[-1] == (n_total, n_total)
    n_failed = len(first.failed)
    assert 0 < n_failed < 3 * share * n_total + 5
    # A group goes on without a part that failed, and is made anew with it.
    second = run_plan(plan, tmp_path / "t", 2, **run)
    assert second.failed == []
    assert second.n_made >= n_failed
    assert second.n_made + second.n_found == n_total
    third = run_plan(plan, tmp_path / "t", 1, **run)
    assert (third.n_made, third.n_found) == (0, n_total)
    root = Piece(plan.n_stages - 1, 0, 0)
    parts = read_record(tmp_path / "t", root)["inputs"]
    assert sorted(parts) == sorted(part.name for part in plan.parts(root))


def test_files_by_tile_are_those_that_each_tile_finds(tmp_path):
    plan = national(7, 5, tmp_path)
    assert plan.inputs_of_tiles() == {piece: plan.inputs_of(piece) for piece in plan.pieces(0)}
    assert plan.inputs_of(Piece(0, 3, 2)) == [5 * i + j for i in (2, 3, 4) for j in (1, 2, 3)]
    points = plan_of((0, 64, 128), (0, 64, 130))
    points = replace(points, files=(SourceFile("a", 73, 0, 9, 20, 1, 1),))
    assert points.inputs_of_tiles()[Piece(0, 0, 0)] == []
    points = replace(points, files=(SourceFile("a", 72, 0, 9, 20, 1, 1),))
    assert points.inputs_of_tiles()[Piece(0, 0, 0)] == [0] == points.inputs_of(Piece(0, 0, 0))
    assert TilePlan.from_json(points.to_json(), "a") == points
