#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs tests/blender inside one Blender.
#
#   scripts/run_blender_tests.sh 3.4|4.5|5.0|/path/to/blender [pytest options]
script_name=blender-tests
. "$(dirname "$0")/common.sh"

[ $# -gt 0 ] || die "which Blender? 3.4 (Debian's), 4.5, 5.0 (modules) or a path to an executable"
which=$1
shift

# Nothing of the user's Blender is read or written.
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export BLENDER_USER_RESOURCES=$scratch/user BLENDER_USER_CONFIG=$scratch/user/config
export BLENDER_USER_SCRIPTS=$scratch/user/scripts BLENDER_USER_EXTENSIONS=$scratch/user/extensions
export PYTHONDONTWRITEBYTECODE=1
mkdir -p "$BLENDER_USER_CONFIG" "$BLENDER_USER_SCRIPTS" "$BLENDER_USER_EXTENSIONS"

run_with_wheel() {
    env_is_made "$1" || die "the environment $1 is not there: run scripts/setup.sh $1"
    local python; python=$(env_python "$1")
    shift
    "$python" "$root/tests/blender/runner.py" --basetemp "$scratch/pytest" "$@"
}

run_with_executable() {
    local blender=$1
    shift
    command -v "$blender" >/dev/null || die "no Blender at '$blender': run scripts/setup.sh blender"
    "$blender" -b --factory-startup --python-exit-code 1 -P "$root/tests/blender/runner.py" -- \
        --basetemp "$scratch/pytest" "$@"
}

case $which in
4.5) run_with_wheel bpy45 "$@" ;;
5.0) run_with_wheel bpy50 "$@" ;;
3.4) run_with_executable blender "$@" ;;
*) run_with_executable "$which" "$@" ;;
esac
