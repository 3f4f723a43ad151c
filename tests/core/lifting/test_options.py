"""The options of an analysis: names, whole numbers, and what contradicts what."""

import inspect

import helpers
import numpy as np
import pytest
from helpers_meshes import random_delaunay

import wavelet_core
from wavelet_core import (
    COSTS,
    NORMS,
    PARTITIONS,
    PREDICTIONS,
    QUADRICS,
    SIGNALS,
    UPDATES,
    OptionError,
    UnstableDesignWarning,
    analyse,
    synthetic,
)
from wavelet_core.lifting.prediction import Prediction, predict, uniform
from wavelet_core.lifting.update import update_filter
from wavelet_core.partition.orderings import ColouringPartition
from wavelet_core.partition.registry import PartitionRow

TABLES = {
    "prediction": PREDICTIONS,
    "update": UPDATES,
    "partition": PARTITIONS,
    "norm": NORMS,
    "signal": SIGNALS,
    "quadrics": QUADRICS,
    "cost": COSTS,
}


def chosen(**options):
    """Return what an analysis resolved of its options."""
    return analyse(random_delaunay(40, seed=1), levels=1, **options).parameters


# --- tables -----------------------------------------------------------------------------------


@pytest.mark.parametrize("option", TABLES)
def test_every_row_says_in_one_line_what_it_is(option):
    table = TABLES[option]
    assert table.option == option
    names = [name for row in table.values() for name in _names(row)]
    assert len(set(names)) == len(names)
    for name, row in table.items():
        assert name == row.name
        assert row.help
        assert "\n" not in row.help
        assert not row.help.endswith(".")


def _names(row):
    return {row.name.lower(), getattr(row, "short", row.name).lower()}


@pytest.mark.parametrize("option", TABLES)
def test_a_name_that_no_table_holds_is_an_error_that_names_the_option(option):
    with pytest.raises(OptionError, match=f"{option} is 'best'; give one of ") as caught:
        analyse(synthetic.hills(5, 5), **{option: "best"})
    assert caught.value.option == option
    assert all(name in str(caught.value) for name in TABLES[option])


@pytest.mark.parametrize("value", [3, b"surface", ["surface"]])
def test_what_is_no_text_names_nothing(value):
    with pytest.raises(OptionError, match="partition is "):
        analyse(synthetic.hills(5, 5), partition=value)


def test_an_update_of_another_name_is_no_minimum_norm():
    """It was: the last branch of a chain meant one of the rows."""
    pair = analyse(random_delaunay(40, seed=1), levels=1).filters(0)
    n_odd, n_even = pair.prediction.shape
    with pytest.raises(OptionError, match="update is 'median'"):
        update_filter(
            "median", pair.prediction, np.ones(n_odd), np.ones(n_even), np.zeros(n_even, bool)
        )


def test_a_prediction_of_another_name_is_an_error():
    with pytest.raises(OptionError, match="prediction is 'median'"):
        predict("median", None)


class FirstOnly(ColouringPartition):
    """Removes one vertex a level."""

    def split(self, view, max_odd):
        return super().split(view, min(max_odd, 1))


def test_a_partition_of_the_table_is_used_and_is_not_the_surface_partition(monkeypatch):
    row = PartitionRow("first", lambda source: FirstOnly(), "one vertex a level")
    monkeypatch.setitem(PARTITIONS, "first", row)
    pyramid = analyse(random_delaunay(60, seed=2), levels=3, partition="First")
    assert pyramid.parameters["partition"] == "first"
    assert [step.n_odd for step in pyramid.steps] == [1, 1, 1]


def test_a_prediction_of_the_table_is_used(monkeypatch):
    row = Prediction("again", "AG", uniform, "the mean of the neighbours once more")
    monkeypatch.setitem(PREDICTIONS, "again", row)
    mesh = random_delaunay(60, seed=2)
    ours = analyse(mesh, levels=3, prediction="AGMN")
    theirs = analyse(mesh, levels=3, prediction="UGMN")
    assert ours.parameters["prediction"] == "again"
    assert ours.steps == theirs.steps


def test_the_docstring_of_analyse_lists_every_name():
    text = inspect.getdoc(analyse)
    missing = [name for table in TABLES.values() for name in table if f'"{name}"' not in text]
    assert missing == []


# --- names are parsed before they are compared ----------------------------------------------------


@pytest.mark.parametrize("name", ["barycentric", "BL", "bl", "BLMN", "blmn", "Barycentric", " BL "])
def test_the_partition_is_the_same_however_the_prediction_is_spelt(name):
    parameters = chosen(prediction=name)
    assert parameters["prediction"] == "barycentric"
    assert parameters["partition"] == "surface"
    assert parameters["update"] == "minimum_norm"


def test_joined_designs_of_every_pair():
    for prediction, update in helpers.PAIRS:
        if (prediction, update) == ("least_squares", "martinez_ortega"):
            continue
        joined = PREDICTIONS[prediction].short + UPDATES[update].short
        parameters = chosen(prediction=joined)
        assert (parameters["prediction"], parameters["update"]) == (prediction, update)


# --- whole numbers ----------------------------------------------------------------------------


@pytest.mark.parametrize("levels", [3, 3.0, np.int64(3), np.float32(3)])
def test_whole_numbers_of_any_type_are_taken(levels):
    assert analyse(synthetic.hills(20, 20), levels=levels).parameters["levels"] == 3


@pytest.mark.parametrize("option", ["levels", "target_vertices", "seed"])
@pytest.mark.parametrize("value", [2.7, float("nan"), float("inf"), "4", [4]])
def test_what_is_no_whole_number_is_refused(option, value):
    """levels=2.7 became 2."""
    partition = "random" if option == "seed" else None
    with pytest.raises(OptionError, match=f"{option} is .*; give a whole number") as caught:
        analyse(synthetic.hills(20, 20), partition=partition, **{option: value})
    assert caught.value.options == (option,)


@pytest.mark.parametrize("option", ["max_error", "max_rms", "bending_weight", "removal_fraction"])
@pytest.mark.parametrize("value", [-1.0, float("nan"), "1", [1.0, 2.0], 10**400])
def test_what_is_no_number_of_0_or_more_is_refused(option, value):
    partition = "quadric" if option == "bending_weight" else None
    with pytest.raises(OptionError, match=f"{option} is ") as caught:
        analyse(synthetic.hills(20, 20), partition=partition, **{option: value})
    assert caught.value.options == (option,)


@pytest.mark.parametrize("weights", [0.5, np.float64(0.5), [1.0, 2.0], [-1.0], "1"])
def test_weights_that_are_not_one_for_each_attribute(weights):
    """A single number was a TypeError."""
    mesh = random_delaunay(40, n_attributes=1)
    with pytest.raises(OptionError, match="attribute_weights are ") as caught:
        analyse(mesh, attribute_weights=weights)
    assert caught.value.options == ("attribute_weights",)


# --- contradictions ---------------------------------------------------------------------------


@pytest.mark.parametrize("update", ["none", "MO", "one_ring_mean"])
def test_an_update_beside_another_one_in_the_design(update):
    """prediction="GLMN", update="none" gave MN."""
    with pytest.raises(OptionError, match="prediction 'GLMN' names the update minimum_norm, and"):
        chosen(prediction="GLMN", update=update)


@pytest.mark.parametrize("update", ["MN", "mn", "minimum_norm"])
def test_the_same_update_twice_is_no_contradiction(update):
    assert chosen(prediction="GLMN", update=update)["update"] == "minimum_norm"


UNUSED = [
    ({"norm": "max"}, "quadric"),
    ({"norm": "rms"}, "random"),
    ({"removal_fraction": 0.1}, "quadric"),
    ({"removal_fraction": 0.25}, "colouring"),
    ({"bending_weight": 1.0}, "surface"),
    ({"bending_weight": 0.5}, "random"),
    ({"quadrics": "rebuilt"}, "surface"),
    ({"cost": "ring"}, "colouring"),
    ({"seed": 0}, "surface"),
    ({"seed": 3}, "quadric"),
]


@pytest.mark.parametrize(("options", "partition"), UNUSED)
def test_an_option_that_the_partition_does_not_look_at(options, partition):
    """It was ignored without a word."""
    (option,) = options
    with pytest.raises(OptionError, match=f"{option} is an option of partition .*") as caught:
        chosen(partition=partition, **options)
    assert caught.value.options == (option, "partition")
    assert partition in str(caught.value)


def test_an_option_beside_the_partition_that_the_filters_choose():
    with pytest.raises(OptionError, match=r"norm is an option of partition surface.*quadric"):
        chosen(prediction="GL", norm="max")


def test_every_option_of_a_partition_is_one_of_analyse():
    known = set(inspect.signature(analyse).parameters)
    for row in PARTITIONS.values():
        assert set(row.options) <= known


def test_the_options_are_given_by_name_only():
    kinds = [p.kind for p in inspect.signature(analyse).parameters.values()]
    assert kinds[1:] == [inspect.Parameter.KEYWORD_ONLY] * (len(kinds) - 1)


# --- Martinez-Ortega with weights of either sign --------------------------------------------------


@pytest.mark.parametrize("options", [{"prediction": "PLMO"}, {"prediction": "PL", "update": "MO"}])
def test_martinez_ortega_is_refused_with_the_plane_prediction(options):
    """Its sums of weights may cancel: max |U| was 131 on 4,000 points, coarse relief 7.8 times."""
    with pytest.raises(OptionError, match=r"divides by their sums.*minimum_norm") as caught:
        chosen(**options)
    assert caught.value.options == ("prediction", "update")


def test_martinez_ortega_warns_with_the_papers_unstable_baseline():
    with pytest.warns(UnstableDesignWarning, match="least_squares .* martinez_ortega") as caught:
        chosen(prediction="LSMO")
    assert caught[0].filename.endswith("test_options.py")


@pytest.mark.parametrize("update", [name for name in UPDATES if name != "martinez_ortega"])
def test_the_other_updates_go_with_the_plane_prediction(update):
    assert chosen(prediction="plane", update=update)["update"] == update


def test_a_prediction_that_is_not_marked_as_signed_has_no_negative_weight():
    for name, row in PREDICTIONS.items():
        if row.is_signed:
            continue
        pyramid = analyse(random_delaunay(300, seed=5), levels=4, prediction=name)
        assert min(step.weights.min() for step in pyramid.steps) >= -1e-12, name


# --- what a skin makes of an error ----------------------------------------------------------------


def test_an_error_says_its_parameters_in_the_words_of_its_reader():
    with pytest.raises(OptionError) as caught:
        analyse(synthetic.hills(5, 5), partition="quadric", removal_fraction=0.1)
    words = caught.value.in_words(lambda option: "--" + option.replace("_", "-"))
    assert words.startswith("--removal-fraction is an option of --partition surface only")


def test_no_message_of_the_core_speaks_of_a_command_line():
    import pathlib
    import re

    folder = pathlib.Path(wavelet_core.__file__).parent
    flags = re.compile(r"[\"' ]--[a-z]")
    told = [
        f"{path.name}: {line.strip()}"
        for path in folder.rglob("*.py")
        for line in path.read_text("utf-8").splitlines()
        if flags.search(line) and ">>>" not in line and not line.strip().startswith("'--")
    ]
    assert told == []
