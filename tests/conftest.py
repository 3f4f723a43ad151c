"""What every test may use: the real data, and how a run without numba is told."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

# The same examples on every run and machine; HYPOTHESIS_PROFILE=explore looks for new ones.
settings.register_profile("house", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("explore", deadline=None, max_examples=1000, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "house"))

#: Real terrain data, kept beside the repository; see its README.md. Never part of the repository.
DATA = Path(__file__).resolve().parent.parent.parent / "shared" / "data"


def pytest_configure(config: pytest.Config) -> None:
    """Let the one announcement of a run without numba pass; all other warnings stay errors."""
    if os.environ.get("TERRAIN_WAVELETS_NO_NUMBA"):
        config.addinivalue_line("filterwarnings", "ignore:numba is not installed:UserWarning")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip what needs the real data where that folder is absent."""
    if DATA.is_dir():
        return
    skip = pytest.mark.skip(reason="no real terrain data in ../shared/data")
    for item in items:
        if item.get_closest_marker("data"):
            item.add_marker(skip)


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """Return the folder of real data; use it in tests marked ``data`` only."""
    return DATA
