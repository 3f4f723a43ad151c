"""The program: ``terrain-wavelets``, and ``python -m wavelet_gis.cli`` where it is not installed.

Interrupts are seen to before anything else is imported, and until the process is gone.
"""

from __future__ import annotations

import sys

from wavelet_gis.cli import interrupts


def program() -> int:
    """Run the command line and return its exit code."""
    interrupts.quit_at_once()
    from wavelet_gis._allocator import keep_freed_memory
    from wavelet_gis.cli.main import main

    keep_freed_memory()
    return main()


if __name__ == "__main__":
    sys.exit(program())
