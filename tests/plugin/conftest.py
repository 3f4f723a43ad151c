"""QGIS set up as QGIS itself does it, with this repository as the plugin ``terrain_wavelets``.

QGIS has a Python of its own, so these tests run apart from the others: ``make test-qgis``.
"""

import importlib.util
import os
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
HAS_QGIS = importlib.util.find_spec("qgis") is not None

# Without QGIS only what reads files is collected here.
collect_ignore_glob = [] if HAS_QGIS else ["test_qgis_*.py"]


def pytest_terminal_summary(terminalreporter):
    if not HAS_QGIS:
        terminalreporter.write_line(
            "QGIS: its tests did not run here (no qgis module); 'make test-qgis' runs them"
        )


def pytest_collection_modifyitems(items):
    here = Path(__file__).resolve().parent.parent
    for item in items:
        if here / "plugin" in item.path.parents or here / "models" in item.path.parents:
            # Debian's and QGIS's own modules warn of their own affairs.
            item.add_marker(pytest.mark.filterwarnings("default::DeprecationWarning"))
            item.add_marker(pytest.mark.filterwarnings("default::PendingDeprecationWarning"))
            item.add_marker(pytest.mark.filterwarnings("default::FutureWarning:osgeo"))
            item.add_marker(pytest.mark.filterwarnings("default::ImportWarning"))


@pytest.fixture(scope="session")
def profile():
    """Return a folder that stands for an empty user profile, with the plugin in it."""
    folder = Path(tempfile.mkdtemp(prefix="terrain-wavelets-qgis-"))
    (folder / "run").mkdir(mode=0o700)
    (folder / "plugins").mkdir()
    (folder / "plugins" / "terrain_wavelets").symlink_to(ROOT, target_is_directory=True)
    return folder


@pytest.fixture(scope="session")
def qgis_environment(profile):
    """Return the environment for QGIS without a screen and without the user's own settings."""
    return {
        **os.environ,
        "QT_QPA_PLATFORM": "offscreen",
        "XDG_RUNTIME_DIR": str(profile / "run"),
        "QGIS_CUSTOM_CONFIG_PATH": str(profile),
        "QGIS_PLUGINPATH": str(profile / "plugins"),
        "LC_ALL": "C.UTF-8",
    }


@pytest.fixture(scope="session")
def qgis(qgis_environment):
    """Return the running QgsApplication, with Processing and the plugin loaded."""
    os.environ.update(qgis_environment)
    from qgis.core import QgsApplication

    application = QgsApplication([], True)
    application.initQgis()
    # exitQgis is never called: it crashes while Python still holds layers.
    sys.path.append(os.path.join(QgsApplication.pkgDataPath(), "python", "plugins"))
    import qgis.utils
    from processing.core.Processing import Processing

    Processing.initialize()
    sys.path.append(qgis_environment["QGIS_PLUGINPATH"])
    qgis.utils.plugin_paths.append(qgis_environment["QGIS_PLUGINPATH"])
    qgis.utils.updateAvailablePlugins()
    assert qgis.utils.loadPlugin("terrain_wavelets")
    assert qgis.utils.startProcessingPlugin("terrain_wavelets")
    return application


@pytest.fixture
def provider(qgis):
    """Return our provider as the registry has it."""
    return qgis.processingRegistry().providerById("terrainwavelets")


@pytest.fixture
def run(qgis):
    """Return a function that runs one of our algorithms: ``run(name, parameters) -> results``."""
    import processing
    from qgis.core import QgsProcessingContext

    def run_algorithm(name, parameters, feedback=None, context=None):
        context = context or QgsProcessingContext()
        return processing.run(
            f"terrainwavelets:{name}", parameters, feedback=feedback, context=context
        )

    return run_algorithm
