"""The tests of this folder need QGIS; see ``qgis_fixtures``."""

from qgis_fixtures import (  # noqa: F401 - fixtures are found by name
    NEEDS_QGIS,
    provider,
    qgis,
    qgis_environment,
    refused,
    run,
    say_if_not_run,
    tolerate_foreign_warnings,
)

collect_ignore_glob = NEEDS_QGIS


def pytest_collection_modifyitems(items):
    tolerate_foreign_warnings(items)


def pytest_terminal_summary(terminalreporter):
    say_if_not_run(terminalreporter)
