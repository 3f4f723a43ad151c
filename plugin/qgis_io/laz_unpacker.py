"""LAZ files unpacked by the program that QGIS brings, where the package lazrs is missing.

QGIS on Windows and macOS has ``pdal_wrench`` beside its other programs, for its own algorithms on
point clouds. It writes the points of a LAZ or COPC file as LAS, in a folder that is forgotten.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from qgis.core import QgsApplication

from ..ui.dependencies import LAZRS, missing
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .crs_and_progress import require_running

if TYPE_CHECKING:
    from qgis.core import QgsFeedback

#: By which QGIS itself can be pointed to another place.
VARIABLE = "QGIS_WRENCH_EXECUTABLE"


def unpacker(path: str) -> str | None:
    """Return the program that must unpack a file; None where it need not, or is not there."""
    if not path.lower().endswith(".laz") or not missing([LAZRS]):
        return None
    name = "pdal_wrench.exe" if os.name == "nt" else "pdal_wrench"
    candidates = [os.environ.get(VARIABLE), os.path.join(QgsApplication.libexecPath(), name)]
    for candidate in [*candidates, shutil.which(name)]:
        if candidate and os.access(candidate, os.X_OK):
            return candidate
    return None


@contextmanager
def as_las(path: str, feedback: QgsFeedback) -> Iterator[str]:
    """Yield a file that can be read without lazrs: the file itself, or an unpacked copy.

    Parameters
    ----------
    path : str
        LAS, LAZ or COPC.
    feedback : QgsProcessingFeedback
        Holds the cancel button.

    Raises
    ------
    QgsProcessingException
        The program failed.
    Cancelled
    """
    program = unpacker(path)
    if program is None:
        yield path
        return
    with tempfile.TemporaryDirectory(
        prefix="terrain-wavelets-", ignore_cleanup_errors=True
    ) as folder:
        unpacked = os.path.join(folder, "points.las")
        with subprocess.Popen(  # nosec B603 - QGIS's own program, and no shell
            [program, "translate", f"--input={os.path.abspath(path)}", f"--output={unpacked}"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        ) as process:
            said = _watched(process, feedback)
        if process.returncode != 0 or not os.path.isfile(unpacked):
            lines = said.decode("utf-8", errors="replace").strip().splitlines()
            raise QgsProcessingException(
                tr("{}: QGIS's pdal_wrench cannot unpack this file ({}); get it again.").format(
                    path, lines[-1].rstrip(".") if lines else process.returncode
                )
            )
        yield unpacked


def _watched(process: subprocess.Popen[bytes], feedback: QgsFeedback) -> bytes:
    """Wait for a process, which ends with the work, and return what it said of its errors."""
    try:
        while True:
            try:
                return process.communicate(timeout=0.2)[1]
            except subprocess.TimeoutExpired:
                require_running(feedback)
    except BaseException:
        process.kill()
        raise
