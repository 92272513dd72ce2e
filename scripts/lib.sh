# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the other scripts. Each ensure_* function does nothing when its work is already done.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$root/.venv
jobs=$(nproc)
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1 PIP_ROOT_USER_ACTION=ignore

apt_packages=(
    g++ cmake ninja-build git
    libeigen3-dev libnanoflann-dev libgtest-dev libgmock-dev libbenchmark-dev libceres-dev
    python3 python3-venv python3-dev
    blender python3-numpy xvfb xauth libgl1-mesa-dri libegl1
)

say() { printf '\033[1m== %s\033[0m\n' "$*" >&2; }

die() {
    printf '%s: %s\n' "$(basename "$0")" "$*" >&2
    exit 1
}

# One build or install at a time in this checkout.
locked() {
    mkdir -p "$root/build"
    flock "$root/build/.lock" "$@"
}

as_root() {
    if [[ $(id -u) == 0 ]]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        die "root is needed for: $*. Run it as root, or install sudo."
    fi
}

check_system() {
    local ID='' VERSION_ID='' PRETTY_NAME='an unknown system'
    # shellcheck source=/dev/null
    if [[ -r /etc/os-release ]]; then . /etc/os-release; fi
    if [[ $ID != debian || $VERSION_ID != 12 || $(uname -m) != x86_64 ]]; then
        die "this is $PRETTY_NAME ($(uname -m)); the build is made for Debian 12 on x86_64." \
            "Elsewhere install what the apt_packages of scripts/lib.sh stand for and use CMake directly (docs/development.md)."
    fi
}

ensure_apt() {
    local missing=() package
    for package in "${apt_packages[@]}"; do
        if [[ $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) != 'install ok installed' ]]; then
            missing+=("$package")
        fi
    done
    ((${#missing[@]})) || return 0
    say "installing ${missing[*]}"
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# A Python 3.11 that can make venvs; Debian's own if it can.
python_311() {
    local candidate
    for candidate in /usr/bin/python3.11 python3.11; do
        if command -v "$candidate" >/dev/null && "$candidate" -c 'import ensurepip, venv' 2>/dev/null; then
            command -v "$candidate"
            return
        fi
    done
    die "no Python 3.11 with venv was found: install python3-venv."
}

# .venv with the tools of pyproject.toml's group `dev`.
ensure_venv() {
    local want
    want=$(sed -n '/^\[dependency-groups\]/,/^\]/p' "$root/pyproject.toml" | sha256sum)
    [[ -x $venv/bin/python && $(cat "$venv/.isograft-tools" 2>/dev/null) == "$want" ]] && return
    say "installing the Python tools into .venv"
    [[ -x $venv/bin/python ]] || "$(python_311)" -m venv "$venv"
    # --group needs pip 25.1, Debian's is older.
    locked "$venv/bin/python" -m pip install --quiet 'pip>=25.1'
    (cd "$root" && locked "$venv/bin/python" -m pip install --quiet --group dev)
    printf '%s\n' "$want" >"$venv/.isograft-tools"
}

# build PRESET [TARGET...]: configures where that was never done (ninja does it again when a CMake file changes).
build() {
    local preset=$1
    shift
    if [[ ! -f $root/build/$preset/build.ninja ]]; then
        say "configuring preset $preset"
        (cd "$root" && locked cmake --preset "$preset" >&2)
    fi
    (cd "$root" && locked cmake --build --preset "$preset" -j "$jobs" ${1:+--target "$@"} >&2)
}

# The package in .venv: Python files from the checkout, the compiled module as it is now.
ensure_package() {
    local now
    now=$(cat "$root/pyproject.toml" "$root"/build/release/_native*.so "$venv/.isograft-tools" | sha256sum)
    [[ $(cat "$venv/.isograft-package" 2>/dev/null) == "$now" ]] && return
    say "installing the package into .venv"
    # The folder of the wheel build is that of the preset `release`: nothing is compiled twice.
    (cd "$root" && locked "$venv/bin/python" -m pip install --quiet --no-build-isolation --no-deps --editable .)
    now=$(cat "$root/pyproject.toml" "$root"/build/release/_native*.so "$venv/.isograft-tools" | sha256sum)
    printf '%s\n' "$now" >"$venv/.isograft-package"
}

# .venv-bpy-VERSION with Blender as a Python module, and pytest in it.
ensure_bpy_venv() {
    local version=$1 folder=$root/.venv-bpy-$1
    if "$folder/bin/python" -c 'import importlib.metadata as m; m.version("bpy"), m.version("pytest")' 2>/dev/null; then
        return
    fi
    say "installing Blender $version (bpy, about 1 GB) into $(basename "$folder")"
    [[ -x $folder/bin/python ]] || "$(python_311)" -m venv "$folder"
    "$folder/bin/python" -m pip install --quiet "bpy==$version.*" 'pytest==9.2.0'
}
