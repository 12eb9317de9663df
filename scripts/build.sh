#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Configures and builds into build/release (or SHADOW_LAYERS_BUILD).
#
#   scripts/build.sh            the Python module and shadowcore
#   scripts/build.sh --tests    and the core's tests
script_name=build
. "$(dirname "$0")/common.sh"

tests=OFF
# A folder that was configured with tests stays so: a preview after a test run then rebuilds nothing.
if [ "${1:-}" = --tests ] || grep -qs 'SHADOW_LAYERS_TESTS:BOOL=ON' "$build_dir/CMakeCache.txt"; then tests=ON; fi

# Precompiled headers are cached only so.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
options=(-DSHADOW_LAYERS_TESTS=$tests)
started=$SECONDS
say "configuring $build_dir"
mkdir -p "$build_dir"
cmake -S "$root" -B "$build_dir" --preset release "${options[@]}" >"$build_dir/configure.log" 2>&1 || {
    tail -n 30 "$build_dir/configure.log" >&2
    die "CMake failed (above; $build_dir/configure.log)"
}
say "compiling (a few minutes the first time)"
if [ -t 1 ]; then
    cmake --build "$build_dir"
else # without a terminal ninja prints a line for each file; every tenth is enough
    cmake --build "$build_dir" 2>&1 | awk '/^\[[0-9]+\/[0-9]+\] / { if (++n % 10 == 0) print; next } { print } END { fflush() }'
fi
say "built in $((SECONDS - started)) s"
