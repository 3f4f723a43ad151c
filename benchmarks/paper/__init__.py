"""The paper's experiments on the nearest data at hand: ``python -m benchmarks.paper``."""
