#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Lays out C++ as .clang-format says; --check only tells what differs.
script_name=format
. "$(dirname "$0")/common.sh"

cd "$root"
command -v clang-format >/dev/null || die "no clang-format: run scripts/setup.sh test"
mapfile -d '' files < <(git ls-files -z -- '*.h' '*.cpp')
[ ${#files[@]} -gt 0 ] || die "no C++ file is in the repository"
if [ "${1:-}" = --check ]; then
    clang-format --dry-run -Werror "${files[@]}" || die "run 'make format'"
    say "${#files[@]} files are laid out as .clang-format says"
else
    clang-format -i "${files[@]}"
    say "${#files[@]} files laid out"
fi
