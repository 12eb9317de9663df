#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what the project needs on Debian 12: packages through apt (only the missing ones) and one Python
# environment per requirement file. Running it again costs a second.
#
#   scripts/setup.sh [build] [bpy45] [bpy50] [blender] [test]     (nothing: all of them)
#   scripts/setup.sh --python NAME                                prints the Python of environment NAME
script_name=setup
. "$(dirname "$0")/common.sh"

build_packages=(
    build-essential cmake ninja-build git python3.11-dev python3.11-venv python3-glad
    libglm-dev libxxhash-dev libxsimd-dev libopenimageio-dev openimageio-tools libtinygltf-dev libtinyobjloader-dev
    libzip-dev nlohmann-json3-dev libcli11-dev libembree-dev
    libosmesa6 libegl1 libegl-mesa0 libgl1-mesa-dri
)
# What Blender as a module loads from the system.
bpy_packages=(
    libx11-6 libxrender1 libxfixes3 libxi6 libxxf86vm1 libxkbcommon0 libsm6 libice6 libgl1 libegl1 libgomp1
)
blender_packages=(blender python3-numpy python3-pytest)
test_packages=(libgtest-dev clang-format xvfb xauth xdotool imagemagick fonts-dejavu-core)

is_installed() { [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

install_packages() {
    local package
    local -a missing=() as_root=()
    for package in "$@"; do
        is_installed "$package" || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    command -v apt-get >/dev/null || die "this machine has no apt-get. Install the equivalents of: ${missing[*]}"
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null || die "installing packages needs root or sudo. As root: apt-get install ${missing[*]}"
        as_root=(sudo)
    fi
    local log="$cache/apt.log" started=$SECONDS
    mkdir -p "$cache"
    say "apt-get update"
    "${as_root[@]}" apt-get update -qq >"$log" 2>&1 || { tail -n 20 "$log" >&2; die "apt-get update failed (above)"; }
    say "installing ${#missing[@]} packages: ${missing[*]}"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        "${missing[@]}" >"$log" 2>&1 || { tail -n 20 "$log" >&2; die "apt-get install failed (above)"; }
    say "packages installed in $((SECONDS - started)) s"
}

# An environment counts as made only with its stamp, which is written last. The lock keeps two runs apart.
make_env() {
    local name=$1 note=${2:-} dir started=$SECONDS
    env_is_made "$name" && return 0
    dir=$(env_dir "$name")
    mkdir -p "$cache/envs"
    exec 9>"$cache/envs/.lock"
    flock 9
    if ! env_is_made "$name"; then
        say "making the Python environment $name$note"
        rm -rf "$dir"
        "$base_python" -m venv "$dir" || die "could not make $dir (is python3.11-venv installed?)"
        "$dir/bin/python" -m pip install --quiet --disable-pip-version-check --progress-bar off --no-deps \
            -r "$root/requirements/$name.txt" || die "pip could not install requirements/$name.txt (above)"
        "$dir/bin/python" -m pip check --disable-pip-version-check >/dev/null ||
            die "requirements/$name.txt does not fit together: $("$dir/bin/python" -m pip check 2>&1)"
        touch "$dir/.complete"
        say "environment $name made in $((SECONDS - started)) s"
    fi
    exec 9>&-
}

set_up() {
    case $1 in
    build)
        install_packages "${build_packages[@]}"
        make_env tools
        ;;
    bpy45)
        install_packages python3.11-venv "${bpy_packages[@]}"
        make_env bpy45 " (Blender 4.5 as a module, a large download)"
        ;;
    bpy50)
        install_packages python3.11-venv "${bpy_packages[@]}"
        make_env bpy50 " (Blender 5.0 as a module, a large download)"
        ;;
    blender) install_packages "${blender_packages[@]}" ;;
    test)
        install_packages "${test_packages[@]}"
        make_env tools
        make_env numpy2
        ;;
    *) die "no part called '$1'; the parts are build, bpy45, bpy50, blender and test" ;;
    esac
}

if [ "${1:-}" = --python ]; then
    env_python "${2:?setup.sh --python needs the name of an environment}"
    exit 0
fi
[ $# -gt 0 ] || set -- build bpy45 bpy50 blender test
for part in "$@"; do
    set_up "$part"
done
say "ready: $*"
