# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the other scripts: where things are, and how a line of progress is printed.
set -euo pipefail

# Debian's Blender looks for its Python's home beside the first python3 of the PATH; a version manager or an environment
# in front would give it another standard library, without the packages that were installed for it.
export PATH="/usr/bin:/bin:$PATH"

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cache=${SHADOW_LAYERS_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/shadow-layers}
base_python=/usr/bin/python3.11 # the bpy wheels of 4.5 and 5.0, and Debian's Blender, are all CPython 3.11
build_dir=${SHADOW_LAYERS_BUILD:-$root/build/release}

say() { printf '[%s] %s\n' "${script_name:-shadow-layers}" "$*"; }
die() {
    printf '[%s] error: %s\n' "${script_name:-shadow-layers}" "$*" >&2
    exit 1
}

# Folder of an environment: its name and the hash of its requirement file, so that a change of a pin makes a new one
# and every checkout with the same pins shares it.
env_dir() {
    local hash
    hash=$(sha256sum "$root/requirements/$1.txt") || die "requirements/$1.txt is missing"
    printf '%s/envs/%s-%s' "$cache" "$1" "${hash:0:12}"
}

env_python() { printf '%s/bin/python' "$(env_dir "$1")"; }

# True once the environment was made to its end.
env_is_made() { [ -f "$(env_dir "$1")/.complete" ]; }

# Ids of the techniques that users get, one a line, from a file that `shadowcore info --json FILE` wrote.
technique_ids() {
    /usr/bin/python3 -c '
import json, sys
for info in json.load(open(sys.argv[1], encoding="utf-8"))["techniques"]:
    if not info["test_only"]:
        print(info["id"])' "$1"
}

# Technique and names of its pictures (truth, layer, difference) of each record in a comparison.json, with tabs between.
picture_names() {
    /usr/bin/python3 -c '
import json, sys
for record in json.load(open(sys.argv[1], encoding="utf-8"))["records"]:
    print(record["technique"], *(record[f"{kind}_picture"] for kind in ("truth", "layer", "difference")), sep="\t")' "$1"
}
