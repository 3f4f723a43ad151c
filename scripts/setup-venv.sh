#!/usr/bin/env bash
# Make a virtual environment and install this project and its extras into it.
# usage: setup-venv.sh VENV PYTHON [EXTRAS]    (for example: setup-venv.sh .venv python3 demo,dev)
# Without EXTRAS the environment is made and stays empty.
set -euo pipefail

venv=$1 python=$2 extras=${3:-}

refuse() { printf 'setup: %s\n' "$*" >&2; exit 1; }

command -v "$python" >/dev/null || refuse "no $python here; install Python 3.11 or later, or name one: make PYTHON=..."
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    refuse "$("$python" --version) is too old; Python 3.11 or later is needed: make PYTHON=python3.12"

if [ ! -x "$venv/bin/python" ]; then
    # Debian splits venv and ensurepip off into a package of their own.
    if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
        version=$("$python" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
        command -v apt-get >/dev/null || refuse "$python lacks the venv module; install it from your system's packages"
        [ "$(id -u)" = 0 ] || refuse "$python lacks the venv module; install it: sudo apt-get install $version"
        printf 'setup: installing %s\n' "$version" >&2
        apt-get update -qq
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$version" >/dev/null
    fi
    printf 'setup: virtual environment in %s, with %s\n' "$venv" "$("$python" --version)" >&2
    "$python" -m venv "$venv"
fi

[ -n "$extras" ] || exit 0
printf 'setup: installing terrain-wavelets[%s] (a few minutes the first time)\n' "$extras" >&2
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --editable ".[$extras]"
