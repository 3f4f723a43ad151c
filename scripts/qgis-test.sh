#!/usr/bin/env bash
# Run the tests that need QGIS, under the QGIS of this machine, installing one on Debian as root where there is none.
#
#   scripts/qgis-test.sh [PYTEST_ARG...]             the system's QGIS
#   scripts/qgis-test.sh --chroot [PYTEST_ARG...]    the second one (numpy 2), see qgis-chroot.sh
#
# Where QGIS is neither there nor can be installed, one line says that this part did not run; under CI that is a failure.
set -euo pipefail
cd "$(dirname "$0")/.."

not_run() {
    printf 'QGIS: its tests did not run: %s\n' "$*"
    [ -z "${CI:-}" ] || exit 1
    exit 0
}

if [ "${1:-}" = --chroot ]; then
    shift
    { [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; } || not_run "a chroot needs Debian or Ubuntu, and root"
    scripts/qgis-chroot.sh
    exec scripts/qgis-chroot.sh env LC_ALL=C.UTF-8 python3 -m pytest -p no:cacheprovider tests/plugin tests/models "$@"
fi

scripts/qgis-install.sh || not_run "no QGIS 3.28 or later with Python bindings here"
scripts/qgis-venv.sh .venv-qgis
# Each of the processes has a QGIS of its own.
exec .venv-qgis/bin/python -m pytest --numprocesses auto --dist worksteal tests/plugin tests/models "$@"
