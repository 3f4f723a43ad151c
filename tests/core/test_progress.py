"""How work tells how far it is, and how it is stopped: one way for all of it."""

import ast
from pathlib import Path

import numpy as np
import pytest

from wavelet_core import Cancelled
from wavelet_core.progress import part_of, report

ROOT = Path(__file__).resolve().parent.parent.parent


def test_false_stops_and_nothing_else_does():
    """The False of a comparison of numpy's numbers went on."""
    for answer in (None, True, 0, ""):
        report(lambda fraction, answer=answer: answer, 0.5)
    report(None, 0.5)
    for answer in (False, np.False_):
        with pytest.raises(Cancelled):
            report(lambda fraction, answer=answer: answer, 0.5)
    with pytest.raises(Cancelled, match="nothing was written"):
        report(lambda fraction: False, 0.5, "nothing was written")


def test_a_part_runs_over_its_share_and_ends_exactly():
    seen = []
    for k in range(3):
        part = part_of(seen.append, k / 3, (k + 1) / 3)
        part(0.0)
        part(1.0)
    assert seen == [0.0, 1 / 3, 1 / 3, 2 / 3, 2 / 3, 1.0]
    assert part_of(None, 0.0, 0.5) is None


def test_a_part_hands_the_wish_to_stop_on():
    assert part_of(lambda fraction: False, 0.0, 0.5)(0.5) is False


def test_progress_is_defined_once():
    """It was defined ten times."""
    places = [
        str(path.relative_to(ROOT))
        for layer in ("wavelet_core", "wavelet_gis", "plugin")
        for path in sorted((ROOT / layer).rglob("*.py"))
        for node in ast.parse(path.read_text("utf-8")).body
        if isinstance(node, ast.Assign)
        and any(isinstance(name, ast.Name) and name.id == "Progress" for name in node.targets)
    ]
    assert places == [str(Path("wavelet_core", "progress.py"))]
