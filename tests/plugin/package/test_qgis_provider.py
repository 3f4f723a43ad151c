"""The provider, its listing and its help, in a real QGIS."""

import pytest

IDS = {
    "contours",
    "simplifypointcloud",
    "thinpointcloud",
    "analysedem",
    "analysepointcloud",
    "analysetin",
    "changebyscale",
    "classifyground",
    "clusterdetails",
    "detaillayers",
    "difference",
    "extractfromtiles",
    "extractlevel",
    "filterlevels",
    "meshquality",
    "profile",
    "shapeoflevel",
    "qualityreport",
    "reconstruct",
    "simplifydem",
    "tileterrain",
    "webterrain",
}


def test_every_algorithm_is_listed(provider):
    assert {a.name() for a in provider.algorithms() if a.group() != "Models"} == IDS


def test_provider_has_an_icon_that_renders(provider):
    pixmap = provider.icon().pixmap(32, 32)
    assert not pixmap.isNull()
    assert pixmap.toImage().pixelColor(16, 12).alpha() > 0


@pytest.mark.parametrize("algorithm_id", sorted(IDS))
def test_help_tells_of_every_parameter(provider, algorithm_id):
    algorithm = provider.algorithm(algorithm_id)
    assert algorithm.tags()
    text = algorithm.shortHelpString()
    for parameter in algorithm.parameterDefinitions():
        assert parameter.help(), parameter.name()
        assert parameter.help() in text


def test_the_options_tell_of_each_package_and_store_nothing(provider, monkeypatch):
    from processing.core.ProcessingConfig import ProcessingConfig
    from qgis.core import QgsSettings
    from terrain_wavelets.plugin.ui import dependencies, options_page

    page = ProcessingConfig.getSettings()["Terrain Wavelets"]
    assert len(page) == len(dependencies.optional_packages())
    keys = {setting.name for setting in page}
    ProcessingConfig.readSettings()
    for setting in page:
        setting.save()
    assert not [key for key in QgsSettings().allKeys() if key.split("/")[-1] in keys]
    monkeypatch.setattr(dependencies, "missing", list)
    rows = options_page.rows()
    assert all("missing, install it" in description for _, description, _ in rows)
    commands = {key.removeprefix("TERRAIN_WAVELETS_"): text for key, _, text in rows}
    assert commands["LAZRS"].endswith("lazrs")
    assert "'laspy[lazrs]'" in commands["LASPY"]


def test_a_refusal_for_want_of_numba_has_the_command_of_this_platform(monkeypatch, qgis):
    from terrain_wavelets.plugin.ui import dependencies

    text = "fit_nnls over 60000 items is too slow without numba; install numba, or choose another."
    monkeypatch.setattr(dependencies, "missing", list)
    told = dependencies.with_remedy(text)
    assert told.startswith(text)
    assert dependencies.remedy([dependencies.NUMBA]) in told
    assert dependencies.with_remedy("choose another level.") == "choose another level."
