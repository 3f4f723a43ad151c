"""Every example in the docstrings runs."""

import doctest
import importlib
import pkgutil

import pytest

import wavelet_gis

MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(wavelet_gis.__path__, "wavelet_gis.")
    if not module.name.startswith("wavelet_gis.cli.commands")
)


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    module = importlib.import_module(name)
    result = doctest.testmod(module)
    assert result.failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder()
    found = [
        test
        for name in MODULES
        for test in finder.find(importlib.import_module(name))
        if test.examples
    ]
    assert len(found) >= 10
