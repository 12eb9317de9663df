#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes docs/techniques.md, docs/comparison.md and every picture of docs/images/ anew, with the program itself.
#
#   scripts/make_docs.sh          all
#   scripts/make_docs.sh table    docs/techniques.md alone
script_name=docs
. "$(dirname "$0")/common.sh"

"$root/scripts/setup.sh" build bpy45 test
work=$root/out/docs
images=$root/docs/images
python=$(env_python bpy45)
export SHADOW_LAYERS_NATIVE=$build_dir/python
mkdir -p "$work" "$images"

batch() { # BLEND VERB [options]; the output is shown where it fails
    "$python" "$root/addon/batch.py" "$@" >"$work/log.txt" 2>&1 || { tail -n 20 "$work/log.txt" >&2; die "batch.py $*"; }
}
make_scene() { "$python" "$root/test_scenes/$1.py" "$work/$1.blend" >/dev/null || die "could not make scene $1"; }

say "the table of techniques"
/usr/bin/python3 "$root/scripts/bench.py" techniques --build "$build_dir" --out "$work/bench"
/usr/bin/python3 "$root/scripts/make_technique_table.py" "$work/bench"
[ "${1:-}" = table ] && exit
mapfile -t techniques < <(technique_ids "$work/bench/info.json")

for scene in box jenga hall fence studio city knot wall door blades bumpy; do
    say "picture of scene $scene"
    make_scene $scene
    batch "$work/$scene.blend" render --samples 16 --out "$work/$scene"
done
convert "$work/studio/combined.png" -quality 92 "$images/studio.jpg"
montage "$work"/{box,jenga,hall,fence,studio,city,knot,wall,door,blades,bumpy}/combined.png -resize 384x216 -tile 4x3 -geometry +4+4 -background '#8a8f98' \
    -quality 90 "$images/scenes.jpg"

# The truth that the technique names, layer and difference of a part of the tower's shadow, twice as large, from a coarse map.
say "pictures of the techniques: ${techniques[*]}"
batch "$work/jenga.blend" compare --techniques "$(IFS=,; echo "${techniques[*]}")" --map-size 256 --border-samples 1 --out "$work/compare"
while IFS=$'\t' read -r technique pictures; do
    (cd "$work/compare" && IFS=$'\t' && montage $pictures -crop 200x150+800+390 +repage -filter point -resize 200% -tile 3x1 \
        -geometry +4+4 -background '#8a8f98' -depth 8 -strip "$images/$technique.png")
done < <(picture_names "$work/compare/comparison.json")
say "layers of the studio scene"
batch "$work/studio.blend" render --techniques edsm --samples 16 --out "$work/layers"
montage "$work"/layers/{Softbox,Spot,Bulb,Sun}_edsm.png -resize 480x270 -tile 2x2 -geometry +4+4 -background '#8a8f98' -quality 90 "$images/layers.jpg"
say "techniques side by side"
/usr/bin/python3 "$root/scripts/make_comparison.py" --build "$build_dir"
say "done: docs/techniques.md, docs/comparison.md and $(find "$images" -type f | wc -l) pictures in docs/images/"
