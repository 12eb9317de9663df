#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Times the techniques on snapshots of the test scenes with shadowcore; results in out/bench/.
script_name=bench
. "$(dirname "$0")/common.sh"

work=$root/out/bench
python=$(env_python bpy45)
export SHADOW_LAYERS_NATIVE=$build_dir/python
mkdir -p "$work"
[ $# -gt 0 ] || set -- jenga hall studio
"$build_dir/bin/shadowcore" info --json "$work/info.json" >/dev/null
techniques=$(technique_ids "$work/info.json" | paste -sd,)
for scene in "$@"; do
    say "snapshot of $scene"
    "$python" "$root/test_scenes/$scene.py" "$work/$scene.blend" >/dev/null
    "$python" "$root/addon/batch.py" "$work/$scene.blend" snapshot --out "$work/$scene" >/dev/null
    say "timing $scene"
    "$build_dir/bin/shadowcore" bench "$work/$scene/snapshot.npz" --techniques "$techniques" --json "$work/$scene.json"
done
say "results in $work/"
