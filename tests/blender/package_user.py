# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by test_package.py in a process of its own: installs a package the way a user does, renders with it, removes it.

Arguments: ZIP BLEND OUT.json. What was found is written to OUT.json; asserting is left to the test.
"""

import importlib
import json
import os
import sys
import traceback
from pathlib import Path

import bpy

kModern = bpy.app.version >= (4, 2, 0)


def install(package: Path) -> str:
    """Installs and enables; returns the Python name of the add-on."""
    if kModern:
        bpy.ops.extensions.package_install_files(
            filepath=str(package), repo="user_default", enable_on_install=True, overwrite=True
        )
        return "bl_ext.user_default.shadow_layers"
    bpy.ops.preferences.addon_install(filepath=str(package), overwrite=True)
    bpy.ops.preferences.addon_enable(module="shadow_layers")
    return "shadow_layers"


def remove() -> None:
    if kModern:
        repos = [repo.module for repo in bpy.context.preferences.extensions.repos]
        bpy.ops.extensions.package_uninstall(repo_index=repos.index("user_default"), pkg_id="shadow_layers")
    else:
        bpy.ops.preferences.addon_disable(module="shadow_layers")
        try:
            bpy.ops.preferences.addon_remove(module="shadow_layers")
        except RuntimeError as error:  # 3.4 removes it, then wants to redraw an area that a background run hasn't
            if "tag_redraw" not in str(error):
                raise


def engine_exists() -> bool:
    try:
        bpy.context.scene.render.engine = "SHADOW_LAYERS"
    except TypeError:
        return False
    return True


def render(name: str, blend: Path) -> dict:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene = bpy.context.scene
    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    engine = importlib.import_module(f"{name}.engine")
    with engine.capture() as captured:
        bpy.ops.render.render()
    layer = captured.frames[0].layers[0]
    seen = captured.frames[0].coverage > 0.5
    return {
        "errors": captured.errors,
        "passes": list(layer.pass_names.values()),
        "shadow_share": float((layer.channels["visibility"][seen] < 0.5).mean()),
    }


def use(package: Path, blend: Path) -> dict:
    name = install(package)
    add_on = sys.modules[name]
    found = {
        "enabled": name in bpy.context.preferences.addons,
        "folder": str(Path(add_on.__file__).parent),
        "version": list(getattr(add_on, "bl_info", {}).get("version", [])),
        **render(name, blend),
        "module": importlib.import_module(f"{name}.bridge").core().__file__,
        "shaders": str(importlib.import_module(f"{name}.bridge").shader_folder()),
    }
    remove()
    found["enabled_after"] = name in bpy.context.preferences.addons
    bpy.context.scene.render.engine = "CYCLES"
    found["engine_after"] = engine_exists()
    found["files_after"] = Path(found["folder"]).exists()
    return found


code = 1
try:
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    zip_file, blend_file, out = (Path(argument) for argument in arguments)
    out.write_text(json.dumps(use(zip_file, blend_file)), encoding="utf-8")
    code = 0
except BaseException:
    traceback.print_exc()
sys.stdout.flush()
sys.stderr.flush()
os._exit(code)
