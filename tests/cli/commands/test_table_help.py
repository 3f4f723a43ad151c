"""Help names the rows of the tables, and no list of such names is kept beside them."""

import argparse
import re

import pytest

import wavelet_core
from wavelet_core._table import Table
from wavelet_gis.cli.main import argument_parser
from wavelet_gis.model.points.aside import DUPLICATE_RULES
from wavelet_gis.workflows.learning.clustering import CLUSTERINGS

TABLES = {
    "--partition": wavelet_core.PARTITIONS,
    "--prediction": wavelet_core.PREDICTIONS,
    "--update": wavelet_core.UPDATES,
    "--norm": wavelet_core.NORMS,
    "--quadrics": wavelet_core.QUADRICS,
    "--cost": wavelet_core.COSTS,
    "--duplicates": DUPLICATE_RULES,
    "--method": CLUSTERINGS,
}


def commands():
    (subparsers,) = (
        action
        for action in argument_parser()._actions
        if isinstance(action, argparse._SubParsersAction)
    )
    return subparsers.choices


@pytest.mark.parametrize("flag", TABLES)
def test_help_names_every_row_wherever_the_option_is(flag):
    takers = [p for p in commands().values() if flag in p._option_string_actions]
    assert takers
    for parser in takers:
        said = re.sub(r"\s+", " ", parser.format_help())
        said = said[said.rindex(f" {flag} ") :]
        for row in TABLES[flag].values():
            assert row.name in re.split(r"\W+", said.replace("-", "_"))


@pytest.mark.parametrize("flag", TABLES)
def test_the_command_line_has_no_list_of_its_own(flag):
    for parser in commands().values():
        action = parser._option_string_actions.get(flag)
        assert action is None or (action.choices is None and action.default is None)


def test_what_is_not_chosen_is_the_first_row():
    for table in TABLES.values():
        assert isinstance(table, Table)
        assert table.chosen(None) is next(iter(table.values()))
        for row in table.values():
            assert table.chosen(row.name) is row
