"""The table of what a stock QGIS does leaves out no algorithm."""

import importlib.util
from pathlib import Path

BENCHMARK = Path(__file__).resolve().parents[3] / "benchmarks" / "cost" / "stock_qgis.py"


def benchmark():
    spec = importlib.util.spec_from_file_location("stock_qgis", BENCHMARK)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_algorithm_is_measured_or_has_a_reason_not_to_be(provider):
    stock = benchmark()
    measured = {name for name, _ in stock.CASES.values()}
    assert measured.isdisjoint(stock.LEFT_OUT)
    assert measured | set(stock.LEFT_OUT) == {a.name() for a in provider.algorithms()}
    assert all(stock.LEFT_OUT.values())


def test_cases_have_parameters_that_there_are(provider):
    for case, (name, parameters) in benchmark().CASES.items():
        algorithm = provider.algorithm(name)
        missing = [key for key in parameters if algorithm.parameterDefinition(key) is None]
        assert not missing, case
