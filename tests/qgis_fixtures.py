"""QGIS set up as QGIS itself does it, with this repository as the plugin ``terrain_wavelets``.

QGIS has a Python of its own, so these tests run apart from the others: ``make test-qgis``.
"""

import atexit
import importlib.util
import os
import shutil
import sys
import tempfile
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
#: Some versions of the wrapper script fail where this program does not.
COMMAND = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
HAS_QGIS = importlib.util.find_spec("qgis") is not None

#: What a folder of tests may not collect without QGIS.
NEEDS_QGIS = [] if HAS_QGIS else ["test_qgis_*.py", "*/test_qgis_*.py"]


def say_if_not_run(terminalreporter):
    """Tell in one line that the QGIS tests did not run, where they did not."""
    if not HAS_QGIS:
        terminalreporter.write_line(
            "QGIS: its tests did not run here (no qgis module); 'make test-qgis' runs them"
        )


def tolerate_foreign_warnings(items):
    """Let the warnings pass that Debian's and QGIS's own modules give of their own affairs."""
    for item in items:
        if item.path.name.startswith("test_qgis_"):
            for category in ("DeprecationWarning", "PendingDeprecationWarning", "ImportWarning"):
                item.add_marker(pytest.mark.filterwarnings(f"default::{category}"))
            # Debian's pyproj, at its first import; an error there would leave it half imported
            ignored = "default:Valid PROJ data directory not found:UserWarning"
            item.add_marker(pytest.mark.filterwarnings(ignored))


@cache
def empty_profile() -> Path:
    """Return a folder that stands for an empty user profile, with the plugin in it."""
    folder = Path(tempfile.mkdtemp(prefix="terrain-wavelets-qgis-"))
    (folder / "run").mkdir(mode=0o700)
    (folder / "plugins").mkdir()
    (folder / "plugins" / "terrain_wavelets").symlink_to(ROOT, target_is_directory=True)
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@cache
def environment() -> dict[str, str]:
    """Return the environment for QGIS without a screen and without the user's own settings."""
    folder = empty_profile()
    return {
        **os.environ,
        "QT_QPA_PLATFORM": "offscreen",
        "XDG_RUNTIME_DIR": str(folder / "run"),
        "QGIS_CUSTOM_CONFIG_PATH": str(folder),
        "QGIS_PLUGINPATH": str(folder / "plugins"),
        "LC_ALL": "C.UTF-8",
    }


@cache
def started_qgis():
    """Return the one QgsApplication of this process, with Processing and the plugin loaded."""
    os.environ.update(environment())
    from qgis.core import QgsApplication

    application = QgsApplication([], True)
    application.initQgis()
    # exitQgis is never called: it crashes while Python still holds layers.
    sys.path.append(os.path.join(QgsApplication.pkgDataPath(), "python", "plugins"))
    import qgis.utils
    from processing.core.Processing import Processing

    Processing.initialize()
    sys.path.append(environment()["QGIS_PLUGINPATH"])
    qgis.utils.plugin_paths.append(environment()["QGIS_PLUGINPATH"])
    qgis.utils.updateAvailablePlugins()
    assert qgis.utils.loadPlugin("terrain_wavelets")
    assert qgis.utils.startProcessingPlugin("terrain_wavelets")
    return application


@pytest.fixture
def qgis_environment():
    """Return the environment of a QGIS that runs as another process."""
    return environment()


@pytest.fixture(scope="session")
def qgis():
    """Return the running QgsApplication; the folders of tests share one."""
    return started_qgis()


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


#: What QGIS says around a message of ours.
FROM_QGIS = ("", "Unable to execute algorithm", "There were errors executing the algorithm.")


@pytest.fixture
def refused(run):
    """Return a function that runs what must be refused and returns the one line in the log."""
    from qgis.core import QgsProcessingException
    from qgis_layers import Log

    def run_refused(name, parameters, **options):
        log = Log()
        with pytest.raises(QgsProcessingException) as caught:
            run(name, parameters, feedback=log, **options)
        told = "\n".join([str(caught.value), *log.errors])
        assert "Traceback" not in told
        assert " --" not in told
        lines = {line for line in told.splitlines() if line not in FROM_QGIS}
        assert len(lines) == 1, lines
        return lines.pop()

    return run_refused
