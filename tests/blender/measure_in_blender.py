# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of scripts/measure.py that runs inside Blender: times, memory and cancelling, measured in one process.

    python tests/blender/measure_in_blender.py NAME OUT.json [SCENE.blend ...]

Times are medians over repeats in which camera and light move a little, as from frame to frame of an animation: meshes
stay, everything else is made anew. Nothing is judged here; measure.py knows the bounds.
"""

import importlib
import json
import math
import os
import statistics
import sys
import threading
import time
import traceback
from pathlib import Path

import bpy
import numpy as np

root = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(root), str(root / "tests" / "blender")]

kRepeats = 7


def open_scene(path: Path, width: int, height: int, map_size: int = 1024):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return set_up(bpy.context.scene, width, height, map_size)


def set_up(scene, width: int, height: int, map_size: int = 1024):
    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.shadow_layers.map_size = map_size
    scene.shadow_layers.samples = 1
    return scene


def nudge(scene, step: int) -> None:
    """Moves camera and lights by a thousandth of a unit, never to the same place twice."""
    for thing in scene.objects:
        if thing.type in {"LIGHT", "CAMERA"}:
            turn = 1e-4 * (step % 97 + 1)
            thing.location.x += turn
            if thing.type == "LIGHT" and thing.data.type == "SUN":
                thing.rotation_euler.x += turn


def render(scene, techniques, aux=()):
    """(captured frame, wall seconds of the render operator)."""
    engine = importlib.import_module("addon.engine")
    scene.shadow_layers.techniques = set(techniques)
    with engine.capture(aux=aux) as captured:
        started = time.perf_counter()
        bpy.ops.render.render()
        wall_s = time.perf_counter() - started
    if captured.errors:
        raise RuntimeError(captured.errors[0])
    return captured.frames[0], wall_s


def spread(values: list[float]) -> dict:
    return {"median": statistics.median(values), "least": min(values), "most": max(values), "count": len(values)}


def measure_speed(paths: list[Path]) -> dict:
    """ms of frame and layer together for each technique, one after the other in turn."""
    found = {}
    for path in paths:
        scene = open_scene(path, 1280, 720)
        times: dict[str, list[float]] = {"sm": [], "pcf": [], "edsm": []}
        for step in range(kRepeats + 1):
            for number, technique in enumerate(times):
                nudge(scene, 3 * step + number)
                frame, _ = render(scene, [technique])
                times[technique].append(frame.total_ms + sum(layer.total_ms for layer in frame.layers))
        found[path.stem] = {technique: spread(values[1:]) for technique, values in times.items()}
    return found


def measure_cycles(paths: list[Path]) -> dict:
    """F12 with sm against the two renders of the visibility mask by Cycles."""
    truth_module = importlib.import_module("addon.truth")
    found = {}
    for path in paths:
        scene = open_scene(path, 1280, 720)
        light = next(thing.name for thing in scene.objects if thing.type == "LIGHT")
        walls = []
        for step in range(kRepeats + 1):
            nudge(scene, step)
            walls.append(render(scene, ["sm"])[1] * 1e3)
        masks = []
        for step in range(kRepeats):
            nudge(scene, step)
            with truth_module.CyclesTruth(scene, scene.view_layers[0], 1280, 720) as truth:
                masks.append(sum(truth.render_light(light).times_ms.values()))
        found[path.stem] = {"f12_ms": spread(walls[1:]), "cycles_ms": spread(masks), "first_f12_ms": walls[0]}
    return found


def new_empty_scene():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = set_up(bpy.context.scene, 160, 90, 256)
    for data in (bpy.data.cameras.new("Camera"), bpy.data.lights.new("Sun", "SUN")):
        thing = bpy.data.objects.new(data.name, data)
        thing.location = (0, 0, 400)
        scene.collection.objects.link(thing)
        if data.name == "Camera":
            scene.camera, data.clip_end = thing, 2000
    return scene


def add_shape(scene, shape):
    kit = importlib.import_module("scene_kit")
    thing = bpy.data.objects.new("Thing", kit.new_mesh("Thing", shape))
    scene.collection.objects.link(thing)
    return thing


def measure_export(_paths: list[Path]) -> dict:
    """Export of one mesh of a million triangles, and of 100,000 instances of one mesh; writing 1080p passes."""
    sys.path.insert(0, str(root / "test_scenes"))
    kit = importlib.import_module("scene_kit")
    found = {}
    scene = new_empty_scene()
    axis = np.linspace(-100, 100, 709, dtype=np.float32)
    x, y = np.meshgrid(axis, axis)
    grid = kit.Shape(np.stack([x, y, np.sin(x) * np.cos(y)], axis=-1), kit.grid(709, 709))
    add_shape(scene, grid)
    found["triangles"] = 2 * len(grid.faces)
    found["million_triangles_ms"] = repeat_export(scene)
    scene = new_empty_scene()
    axis = np.linspace(-100, 100, 317, dtype=np.float32)
    x, y = np.meshgrid(axis, axis)
    points = kit.Shape(np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)[:100_000], np.zeros((0, 3)))
    host, child = add_shape(scene, points), add_shape(scene, kit.box((0.3, 0.3, 0.3)))
    child.parent, host.instance_type = host, "VERTS"
    found["instances"] = 100_000
    found["instances_ms"] = repeat_export(scene)
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    writes = [render(scene, ["sm"])[0].addon_ms["write"] for _ in range(kRepeats)]
    found["write_layer_ms"] = spread(writes)
    return found


def repeat_export(scene) -> dict:
    """The first export, in which nothing is known, and later ones."""
    frames = [render(scene, ["sm"])[0] for _ in range(4)]
    times = [frame.addon_ms["export"] for frame in frames]
    sizes = np.array([len(mesh.triangles) for mesh in frames[0].snapshot.meshes])
    count = int(sizes[frames[0].snapshot.instance_mesh].sum())
    return {"first": times[0], "median": statistics.median(times[1:]),
            "instances": len(frames[0].snapshot.instance_mesh),
            "triangles": count}  # fmt: skip


def measure_memory(paths: list[Path]) -> dict:
    """What the process and the core's caches hold after each of 202 frames of the animated figure: 10 frames to settle
    in, then the whole animation four times. `growth`: over `distance` frames (process_memory.compute_growth)."""
    # llvmpipe's threads leave each frame's triangles behind until the work is asked for again, tens of megabytes that
    # depend on the moment. Without threads of its own it holds them once.
    os.environ["LP_NUM_THREADS"] = "0"
    memory = importlib.import_module("process_memory")
    bridge = importlib.import_module("addon.bridge")
    scene = open_scene(paths[0], 160, 90, 128)
    for name in ("Softbox", "Bulb"):  # two kinds of light are enough, and half the time
        bpy.data.objects.remove(scene.objects[name])
    scene.render.use_simplify, scene.render.simplify_subdivision_render = True, 1
    settings = importlib.import_module("addon.preferences").session_settings(scene)
    settle, period = 10, 48
    held: dict[str, list[int]] = {}
    for number in range(settle + 4 * period):
        scene.frame_set(1 + number % period)
        render(scene, ["sm", "pcf", "edsm", "sv", "exact"])
        session = bridge.session(settings.backend, settings.threads)
        now = {**memory.read_memory(), "host": session.host_bytes, "gpu": session.gpu_bytes}
        for key, value in now.items():
            held.setdefault(key, []).append(value)
    growth = {key: memory.compute_growth(values, settle, period) for key, values in held.items()}
    distance = memory.growth_distance(settle + 4 * period, settle, period)
    return {"held": held, "settle": settle, "period": period, "growth": growth, "distance": distance,
            "bounds": memory.kGrowthBounds, "allocator": memory.allocator_name()}  # fmt: skip


def measure_cancel(paths: list[Path]) -> dict:
    """Milliseconds from cancel() to the render's end, at moments spread over heavy renders: of maps, and of a slow soft
    layer, with and without its trees to build."""
    bridge = importlib.import_module("addon.bridge")
    scene = open_scene(paths[0], 1280, 720, 4096)
    scene.shadow_layers.samples = 4
    maps, _ = render(scene, ["sm", "pcf", "edsm"])
    found = {"maps": cancel_at_moments(bridge, maps.snapshot, 24)}
    scene.shadow_layers.samples = 1
    scene.shadow_layers.soft.light_samples = 256
    for thing in scene.objects:
        if thing.type == "LIGHT":
            thing.data.angle = math.radians(30)
    soft, _ = render(scene, ["soft"])

    def begin_anew() -> None:
        bridge.shutdown()
        bridge.session()

    return {**found, "soft": cancel_at_moments(bridge, soft.snapshot, 24),
            "soft, trees too": cancel_at_moments(bridge, soft.snapshot, 12, begin_anew)}  # fmt: skip


def cancel_at_moments(bridge, snapshot, count: int, prepare=lambda: None) -> dict:
    """Of `count` renders, each cancelled at another moment; `prepare` runs before each."""
    prepare()
    whole_s = time_render(bridge, snapshot)
    waits = []
    for moment in np.linspace(0.02, 0.95, count):
        prepare()
        token, ended = bridge.CancelToken(), []

        def work(token=token, ended=ended) -> None:
            try:
                bridge.render_snapshot(snapshot, token=token)
            except bridge.RenderCancelled:
                ended.append(time.perf_counter())

        thread = threading.Thread(target=work)
        thread.start()
        time.sleep(float(moment) * whole_s)
        asked = time.perf_counter()
        while thread.is_alive():
            token.cancel()
            thread.join(0.005)
        if ended:
            waits.append((ended[0] - asked) * 1e3)
    return {"render_s": whole_s, "cancelled": len(waits), "tried": count, "wait_ms": spread(waits)}


def time_render(bridge, snapshot) -> float:
    started = time.perf_counter()
    bridge.render_snapshot(snapshot)
    return time.perf_counter() - started


def measure_soft_cycles(paths: list[Path]) -> dict:
    """F12 with `soft`, and Cycles with ever more samples (soft_renders.py); the second path says what is wanted."""
    wanted = json.loads(paths[1].read_text(encoding="utf-8"))
    return importlib.import_module("soft_renders").measure(open_scene, render, paths[0], wanted)


kMeasures = {
    "speed": measure_speed,
    "cycles": measure_cycles,
    "export": measure_export,
    "memory": measure_memory,
    "cancel": measure_cancel,
    "soft_cycles": measure_soft_cycles,
}


def main() -> None:
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    name, out, paths = arguments[0], Path(arguments[1]), [Path(path) for path in arguments[2:]]
    importlib.import_module("addon").register()
    found = kMeasures[name](paths)
    found["blender"] = bpy.app.version_string
    bridge = importlib.import_module("addon.bridge")
    found["core"] = {key: value for key, value in bridge.session_info().items() if isinstance(value, str | int)}
    out.write_text(json.dumps(found, indent=1), encoding="utf-8")


code = 1
try:
    main()
    code = 0
except BaseException:
    traceback.print_exc()
sys.stdout.flush()
sys.stderr.flush()
os._exit(code)
