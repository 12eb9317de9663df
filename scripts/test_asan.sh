#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# The core's tests under the address and undefined-behaviour sanitizers.
script_name=test-asan
. "$(dirname "$0")/common.sh"

cd "$root"
say "configuring build/asan"
cmake --preset asan >/dev/null
say "compiling"
cmake --build --preset asan
# The software rasteriser's compiler keeps memory until the process ends, without frames that a suppression could name.
export ASAN_OPTIONS=detect_leaks=0:strict_string_checks=1 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
say "running the tests"
ctest --test-dir build/asan --output-on-failure -j2
