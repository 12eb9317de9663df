# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender window (test_viewport.py starts it under Xvfb): edits a scene in Rendered mode, step by step, and
writes a screenshot and the pixel positions of probe points after each.

    blender --factory-startup -P tests/blender/viewport_session.py -- ROOT OUT_FOLDER
"""

import json
import sys
import time
import traceback
from pathlib import Path

import bmesh
import bpy

root, out = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1 :])
sys.path[:0] = [str(root), str(root / "tests" / "blender")]
bpy.context.preferences.view.show_splash = False

from addon_helpers import add_camera, add_light, add_object, cube_mesh, plane_mesh  # noqa: E402
from bpy_extras.view3d_utils import location_3d_to_region_2d  # noqa: E402

import addon  # noqa: E402 - the path is set above

SETTLE_S, GIVE_UP_S = 0.4, 60.0
# Points on the ground: where the cube's shadow falls at first, where after the cube, where after the sun has moved.
PROBES = {"first": (0, 0, 0), "cube moved": (4, 0, 0), "sun moved": (4, 4, 0), "never": (-4, -4, 0)}
record: dict[str, object] = {"steps": {}}


def view() -> tuple:
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return window, area, region


def build() -> None:
    addon.register()
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    scene = bpy.context.scene
    scene.render.engine = "SHADOW_LAYERS"
    scene.shadow_layers.techniques = {"sm"}
    scene.view_settings.view_transform = "Standard"
    add_object("Ground", plane_mesh(60))
    cube = add_object("Cube", cube_mesh(3), (0, 0, 4))
    cube.visible_camera = False  # so that its shadow is seen from above
    add_light("SUN", name="Sun", energy=3)
    add_camera((0, 0, 30))


def enter_rendered_mode() -> None:
    _window, area, _region = view()
    space = area.spaces.active
    space.show_region_header = space.show_region_toolbar = space.show_gizmo = False
    space.overlay.show_overlays = False
    space.region_3d.view_perspective = "ORTHO"
    space.region_3d.view_rotation = (1, 0, 0, 0)
    space.region_3d.view_location = (0, 0, 0)
    space.region_3d.view_distance = 20
    space.shading.type = "RENDERED"


def move_cube() -> None:
    bpy.data.objects["Cube"].location.x = 4


def turn_sun() -> None:
    # 45 degrees about X: the shadow of what is 4 m up falls 4 m to the side.
    bpy.data.objects["Sun"].rotation_euler.x = 0.7853982


def look_in_perspective() -> None:
    region_3d = view()[1].spaces.active.region_3d
    region_3d.view_perspective = "PERSP"
    region_3d.view_rotation = (0.966, 0.2588, 0, 0)


def look_through_camera() -> None:
    view()[1].spaces.active.region_3d.view_perspective = "CAMERA"


def hide_cube() -> None:
    bpy.data.objects["Cube"].hide_set(True)


def switch_light_off() -> None:
    bpy.data.objects["Cube"].hide_set(False)
    bpy.data.objects["Sun"].data.use_shadow = False


def edit_mesh() -> None:
    bpy.data.objects["Sun"].data.use_shadow = True
    bpy.data.objects["Sun"].rotation_euler.x = 0
    mesh = bpy.data.objects["Cube"].data
    for vertex in mesh.vertices:
        vertex.co.x -= 4
    mesh.update()


def enter_edit_mode() -> None:
    """With an edit that is not written back yet: the shadow moves by 4 m again."""
    cube = bpy.data.objects["Cube"]
    window, area, region = view()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.context.view_layer.objects.active = cube
        bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(cube.data)
    for vertex in edited.verts:
        vertex.co.x += 4
    bmesh.update_edit_mesh(cube.data)


def leave_edit_mode() -> None:
    cube = bpy.data.objects["Cube"]
    for vertex in bmesh.from_edit_mesh(cube.data).verts:
        vertex.co.x -= 4
    window, area, region = view()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.object.mode_set(mode="OBJECT")


def render_beside() -> None:
    """F12 as a user starts it: a job beside the interface, with this viewport still in Rendered mode."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 180, 100
    scene.render.filepath = str(out / "final.png")
    scene.shadow_layers.samples = 8
    window, area, region = view()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)


def note_arrays() -> None:
    """Whether moving an object left the arrays of all meshes alone."""
    from addon import viewport

    exported = next(iter(viewport._open))._scene
    record.setdefault("arrays", []).append(sorted(id(mesh.positions) for mesh in exported.meshes))


STEPS = [
    enter_rendered_mode,
    move_cube,
    turn_sun,
    look_in_perspective,
    look_through_camera,
    hide_cube,
    switch_light_off,
    edit_mesh,
    enter_edit_mode,
    leave_edit_mode,
]


def save(step: str) -> None:
    window, area, region = view()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.screenshot_area(filepath=str(out / f"{step}.png"))
    offset = (region.x - area.x, region.y - area.y)
    points = {}
    for name, point in PROBES.items():
        at = location_3d_to_region_2d(region, area.spaces.active.region_3d, point)
        points[name] = [at[0] + offset[0], at[1] + offset[1]]
    record["steps"][step] = points


def leave() -> None:
    from addon import viewport

    record["open while rendered"] = len(list(viewport._open))
    view()[1].spaces.active.shading.type = "SOLID"


def finish() -> None:
    from addon import viewport

    record["open afterwards"] = len(list(viewport._open))
    view()[1].spaces.active.shading.type = "RENDERED"  # and quit with a live viewport
    (out / "record.json").write_text(json.dumps(record))


def act() -> float | None:
    """Timer: one action at a time; a picture is saved once the viewport has been quiet for a while."""
    from addon import viewport

    try:
        waiting = viewport.is_busy() or bpy.app.is_job_running("RENDER")
        if waiting and time.monotonic() - act.since < GIVE_UP_S:
            return SETTLE_S
        if not act.plan:
            bpy.ops.wm.quit_blender()
            return None
        act.since = time.monotonic()
        act.plan.pop(0)()
        return SETTLE_S
    except Exception:
        traceback.print_exc()
        sys.stderr.flush()
        bpy.ops.wm.quit_blender()
        return None


act.since = time.monotonic()
act.plan = [build]
for step in STEPS:
    act.plan += [step, lambda: None, lambda step=step: save(step.__name__)]
    act.plan += [note_arrays] if step in {enter_rendered_mode, move_cube, edit_mesh} else []
act.plan += [render_beside, lambda: None, leave, lambda: None, finish, lambda: None]
bpy.app.timers.register(act, first_interval=1.0)
