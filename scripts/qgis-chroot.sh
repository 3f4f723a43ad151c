#!/usr/bin/env bash
# Run a command under a second QGIS (Debian 13: Python 3.13, numpy 2), in a chroot made on first use.
#
#   scripts/qgis-chroot.sh                     make the chroot, print its versions
#   scripts/qgis-chroot.sh COMMAND [ARG...]    run COMMAND in it, in this repository
#
# The repository appears in the chroot at its own path, and so does the folder of test data beside it, if there.
# Mounts live in a namespace of their own and end with the command. Needs Debian or Ubuntu, root, about 3 GB.
set -euo pipefail

repository=$(cd "$(dirname "$0")/.." && pwd -P)
root=${QGIS_CHROOT:-${XDG_CACHE_HOME:-$HOME/.cache}/terrain-wavelets/qgis-trixie}
suite=trixie
packages=(qgis python3-qgis qgis-providers python3-scipy python3-numba python3-pytest python3-hypothesis
          python3-laspy python3-sklearn python3-pip python3-venv proj-data make git)
from_pip=(PythonCDT lazrs 'trimesh>=4.4' 'ezdxf>=1.1' 'python-serafin>=0.2')

say() { printf 'qgis-chroot: %s\n' "$*" >&2; }

make_chroot() {
    if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
        say "making the chroot needs root on Debian or Ubuntu"
        exit 1
    fi
    export DEBIAN_FRONTEND=noninteractive
    command -v debootstrap >/dev/null || { apt-get update -q; apt-get install -y -q --no-install-recommends debootstrap; } >&2
    local uri
    uri=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' | awk '$1 == "Debian" {print $2; exit}')
    if [ -z "$uri" ]; then
        say "no Debian package source in this machine's apt configuration; run 'apt-get update' or add one"
        exit 1
    fi
    rm -rf "$root"
    mkdir -p "$root"
    debootstrap --variant=minbase --include=ca-certificates "$suite" "$root" "$uri" >&2
    # Certificates that this machine trusts (a company's proxy, for one) are trusted inside too.
    cp -L --remove-destination /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/ca-certificates.crt"
    local file
    for file in /etc/apt/apt.conf.d/*[Pp]roxy* /etc/pip.conf; do
        [ ! -f "$file" ] || cp -L "$file" "$root$file"
    done
    printf 'Dpkg::Use-Pty "0";\nAcquire::Retries "3";\nAPT::Install-Recommends "false";\n' >"$root/etc/apt/apt.conf.d/90terrain-wavelets"
    inside "apt-get update -q && apt-get install -y -q ${packages[*]} && apt-get clean" >&2
    touch "$root/.terrain-wavelets-ready"
}

# What Debian does not carry, or too old; the chroot is ours alone, so its own Python may take it.
add_from_pip() {
    local stamp=$root/.terrain-wavelets-pip
    [ "$(cat "$stamp" 2>/dev/null)" != "${from_pip[*]}" ] || return 0
    inside "python3 -m pip install -q --break-system-packages --root-user-action=ignore $(printf '%q ' "${from_pip[@]}")" >&2
    printf '%s\n' "${from_pip[*]}" >"$stamp"
}

# inside SHELL_COMMAND: run it by sh in the chroot, with proc, dev and the repository mounted for it alone
inside() {
    local data=$repository/../shared/data
    if [ -d "$data" ]; then data=$(cd "$data" && pwd -P); else data=; fi
    ROOT=$root REPOSITORY=$repository DATA=$data DEBIAN_FRONTEND=noninteractive \
    unshare --mount sh -euc '
        mount -t proc proc "$ROOT/proc"
        mount --rbind /dev "$ROOT/dev"
        mount --rbind /sys "$ROOT/sys"
        cp -L /etc/resolv.conf /etc/hosts "$ROOT/etc/" 2>/dev/null || true
        mkdir -p "$ROOT$REPOSITORY"
        mount --bind "$REPOSITORY" "$ROOT$REPOSITORY"
        if [ -n "$DATA" ]; then mkdir -p "$ROOT$DATA"; mount --bind -o ro "$DATA" "$ROOT$DATA"; fi
        exec chroot "$ROOT" /bin/bash -euc "cd \"$REPOSITORY\"; $1"
    ' sh "$1"
}

[ -e "$root/.terrain-wavelets-ready" ] || make_chroot
add_from_pip

if [ $# -eq 0 ]; then
    inside "QT_QPA_PLATFORM=offscreen python3 -c 'import sys, numpy, scipy, numba; from qgis.core import Qgis; print(\"QGIS\", Qgis.QGIS_VERSION, \"Python\", sys.version.split()[0], \"numpy\", numpy.__version__, \"scipy\", scipy.__version__, \"numba\", numba.__version__)'"
else
    quoted=$(printf '%q ' "$@")
    inside "exec $quoted"
fi
