"""The provider, its listing and its help, in a real QGIS."""

import pytest

IDS = {
    "simplifypointcloud",
    "thinpointcloud",
    "analysedem",
    "analysepointcloud",
    "analysetin",
    "clusterdetails",
    "detaillayers",
    "extractlevel",
    "filterlevels",
    "qualityreport",
    "reconstruct",
    "simplifydem",
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
