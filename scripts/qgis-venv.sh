#!/usr/bin/env bash
# Make a virtual environment over the system's Python, so that tests see QGIS, its numpy and the test packages.
# usage: qgis-venv.sh VENV
#
# The system's numpy, scipy and numba stay as they are: they are what the plugin meets in QGIS.
set -euo pipefail

venv=$1
python=${QGIS_PYTHON:-/usr/bin/python3}
stamp=$venv/.installed-qgis

[ -e "$stamp" ] && [ "$stamp" -nt "$0" ] && exit 0

numpy=$("$python" -c 'import numpy; print(numpy.__version__)')
printf 'qgis-venv: %s over %s, numpy %s\n' "$venv" "$("$python" --version)" "$numpy" >&2
"$python" -m venv --system-site-packages "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    "numpy==$numpy" 'pytest>=8' 'pytest-xdist>=3.5' hypothesis 'laspy>=2.4' lazrs 'PythonCDT>=2.0' 'scikit-learn>=1.3' \
    'trimesh>=4.4' 'ezdxf>=1.1' 'python-serafin>=0.2'
touch "$stamp"
