#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# From nothing to a page: installs, builds, makes the studio scene, renders its layers, compares them with Cycles.
#
#   scripts/preview.sh                       with Blender 4.5 as a module
#   BLENDER=/path/to/blender scripts/preview.sh
script_name=preview
. "$(dirname "$0")/common.sh"

out=$root/out/preview
started=$SECONDS

if [ -n "${BLENDER:-}" ]; then
    blender=$(command -v "$BLENDER") || die "BLENDER=$BLENDER is no program"
    version=$("$blender" -b --factory-startup --python-expr 'import bpy, sys; print("version", bpy.app.version_string, "python", *sys.version_info[:2])' 2>/dev/null | grep ^version) ||
        die "$blender does not run in the background"
    case $version in
    *"python 3 11") say "with ${version% python*} of $blender" ;;
    *) die "$blender has another Python than 3.11 ($version), for which no native module is built" ;;
    esac
    "$root/scripts/setup.sh" build
    run_script() { # SCRIPT [arguments]
        local script=$1
        shift
        "$blender" -b --factory-startup --python-exit-code 1 -P "$script" -- "$@"
    }
    run_batch() { # VERB [options]
        "$blender" -b "$out/studio.blend" --factory-startup --python-exit-code 1 -P "$root/addon/batch.py" -- "$@"
    }
else
    "$root/scripts/setup.sh" build bpy45
    python=$(env_python bpy45)
    run_script() { "$python" "$@"; }
    run_batch() { "$python" "$root/addon/batch.py" "$out/studio.blend" "$@"; }
fi
"$root/scripts/build.sh"
export SHADOW_LAYERS_NATIVE=$build_dir/python

mkdir -p "$out"
log=$out/preview.log
: >"$log"
# Goes to the log, and is shown only where it fails.
quietly() {
    "$@" >>"$log" 2>&1 || {
        tail -n 25 "$log" >&2
        die "that failed (above; all of it in $log)"
    }
}
say "making the studio scene"
quietly run_script "$root/test_scenes/studio.py" "$out/studio.blend"
# The batch tells its own progress, and at the end its table.
shown() {
    "$@" 2>>"$log" | tee -a "$log" || {
        tail -n 25 "$log" >&2
        die "that failed (above; all of it in $log)"
    }
}
say "rendering the layers of 4 lights with 3 techniques, 16 samples a pixel"
shown run_batch render --techniques soft,exact,edsm --samples 16 --out "$out"
say "comparing them with Cycles (two renders of Cycles for each light: with its size and without)"
shown run_batch compare --techniques soft,exact,edsm --resolution 640x360 --out "$out"
for file in layers.exr comparison.json index.html; do
    [ -s "$out/$file" ] || die "$out/$file was not written; $log says more"
done
say "done in $((SECONDS - started)) s. Open $out/index.html; the layers are in $out/layers.exr"
