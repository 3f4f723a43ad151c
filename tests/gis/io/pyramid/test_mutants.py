"""Mutated pyramid files are refused in one line, or read; the tool that makes them can fail."""

import os
import random
import time

import pytest
from tools._limits import Trials
from tools.mutate_pyramid import is_original, mutate, read, samples

from wavelet_core.errors import WaveletError


def behave(case):
    """Do what a reader may do, good and bad."""
    if case == "read":
        return "contents"
    if case == "refuse":
        raise WaveletError("no")
    if case == "two lines":
        raise WaveletError("no\nno")
    if case == "sleep":
        time.sleep(60)
    if case == "allocate":
        bytearray(3 << 30)
    if case == "die":
        os._exit(3)
    raise RuntimeError(case)


def test_every_kind_of_behaviour_is_told():
    expected = {
        "read": "read",
        "refuse": "refused",
        "two lines": "error",
        "raise": "error",
        "allocate": "memory",
        "die": "died",
        "sleep": "slow",
    }
    with Trials(behave, WaveletError, seconds=2.0) as trials:
        outcomes = {case: trials.run(case).outcome for case in [*expected, "read"]}
    assert outcomes == expected


@pytest.mark.parametrize("first", [0, 100])
def test_a_hundred_mutants(tmp_path, first):
    sources = list(samples(tmp_path))
    path = tmp_path / "mutant.gpkg"
    faults, outcomes = [], set()
    with Trials(read, WaveletError) as trials:
        for source, digest in sources:
            verdict = trials.run(source)
            assert (verdict.outcome, verdict.text) == ("read", digest)
        for seed in range(first, first + 100):
            rng = random.Random(seed)
            source, digest = rng.choice(sources)
            state, done = mutate(source, path, rng)
            verdict = trials.run(path)
            outcomes.add(verdict.outcome)
            is_another = verdict.outcome == "read" and not is_original(verdict.text, digest)
            if verdict.outcome not in ("read", "refused") or (state == "intact" and is_another):
                faults.append((seed, state, done, verdict))
    assert not faults
    assert outcomes == {"read", "refused"}
