#!/usr/bin/env bash
# Install QGIS 3.28 or later with the system's Python, on Debian or Ubuntu as root. Does nothing when it is there.
#
# Debian 12 carries QGIS 3.22, whose model format and qgis_process have known faults; its backports carry 3.40.
# The backports line is derived from the package sources this machine already uses, so mirrors and proxies keep working.
set -euo pipefail

minimum=3.28
python=${QGIS_PYTHON:-/usr/bin/python3}

say() { printf 'qgis-install: %s\n' "$*" >&2; }

has_qgis() {
    command -v qgis_process >/dev/null && QT_QPA_PLATFORM=offscreen "$python" - <<'PY' 2>/dev/null
import sys
from qgis.core import Qgis
import scipy, numpy
sys.exit(Qgis.QGIS_VERSION_INT < 32800)
PY
}

if has_qgis; then
    exit 0
fi
if ! command -v apt-get >/dev/null; then
    say "no QGIS $minimum or later here, and this is no Debian or Ubuntu; install QGIS from your system's packages"
    exit 1
fi
if [ "$(id -u)" != 0 ]; then
    say "no QGIS $minimum or later here, and installing one needs root; run: sudo $0"
    exit 1
fi

export DEBIAN_FRONTEND=noninteractive
install="apt-get install -y -q --no-install-recommends -o Dpkg::Use-Pty=0 -o Acquire::Retries=3"
apt-get update -q

# A machine's own sources come first; backports only where they are too old.
release=()
candidate=$(apt-cache policy qgis | awk '/Candidate:/ {print $2}')
if [ -z "$candidate" ] || [ "$candidate" = "(none)" ] || dpkg --compare-versions "$candidate" lt "$minimum"; then
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:?}")
    source_file=/etc/apt/sources.list.d/terrain-wavelets-backports.sources
    uri=$(apt-get indextargets --format '$(CODENAME) $(SUITE) $(REPO_URI)' 'Created-By: Packages' \
          | awk -v codename="$codename" '$1 == codename {print $3; exit}')
    if [ -z "$uri" ]; then
        say "no package source for $codename found in this machine's apt configuration; add one, or install QGIS $minimum or later by hand"
        exit 1
    fi
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    {
        printf 'Types: deb\nURIs: %s\nSuites: %s-backports\nComponents: main\n' "$uri" "$codename"
        [ ! -f "$keyring" ] || printf 'Signed-By: %s\n' "$keyring"
    } >"$source_file"
    say "QGIS ${candidate:-(none)} is too old; using $codename-backports"
    apt-get update -q
    release=(-t "$codename-backports")
fi

# qgis brings qgis_process, python3-qgis the bindings and the Processing plugin.
$install "${release[@]}" qgis python3-qgis qgis-providers
# The rest from the release itself: what the plugin needs (scipy) and what makes it fast (numba).
$install python3-scipy python3-numba python3-venv python3-gdal proj-data

if ! has_qgis; then
    say "QGIS was installed, but '$python' cannot import qgis.core and scipy; see the messages above"
    exit 1
fi
