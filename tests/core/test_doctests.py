"""Every example in the core's docstrings runs."""

import doctest
import importlib
import pkgutil

import pytest

import wavelet_core

MODULES = sorted(
    module.name for module in pkgutil.walk_packages(wavelet_core.__path__, "wavelet_core.")
)


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder()
    found = [
        test
        for name in MODULES
        for test in finder.find(importlib.import_module(name))
        if test.examples
    ]
    assert len(found) >= 3
