"""``python -m wavelet_gis.cli``: the command, where its script is not installed."""

import sys

from .main import main

if __name__ == "__main__":
    sys.exit(main())
