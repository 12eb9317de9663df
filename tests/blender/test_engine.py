# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 with the engine: passes, EXR files, borders, view layers, animation, and what is refused."""

import json
import os
import shutil
import sys

import bpy
import numpy as np
import pytest
from addon_helpers import (
    add_camera,
    add_light,
    add_object,
    cube_mesh,
    failed_render,
    plane_mesh,
    read_exr,
    render,
    set_multilayer_output,
)


@pytest.fixture
def scene(fresh_scene):
    """A cube of 2 m that floats 1 m over the ground, under a sun from straight above and a lamp from the side."""
    add_camera((0, -9, 6)).rotation_euler = (0.98, 0, 0)
    add_object("Ground", plane_mesh(30, "Ground"))
    add_object("Cube", cube_mesh(2), (0, 0, 2))
    add_light("SUN", name="Key.001")
    add_light("POINT", name="Füllicht", location=(5, -3, 4))
    fresh_scene.shadow_layers.samples = 1
    fresh_scene.shadow_layers.techniques = {"sm"}
    return fresh_scene


def view_layer_name(scene) -> str:
    return scene.view_layers[0].name


def test_exr_holds_the_cores_arrays_and_their_story(scene, tmp_path):
    scene.shadow_layers.techniques = {"sm", "edsm"}
    path = tmp_path / "layers.exr"
    set_multilayer_output(path)
    captured = render(write_still=True)
    pictures, header = read_exr(path)
    frame, name = captured.frames[0], view_layer_name(scene)
    expected = {f"{name}.{layer.pass_names['visibility']}.X": layer.channels["visibility"] for layer in frame.layers}
    assert len(expected) == 4
    assert {f"{name}.Shadow Key_001 sm.X", f"{name}.Shadow Füllicht edsm.X"} <= expected.keys()
    expected[f"{name}.Coverage.X"] = frame.coverage
    for index, channel in enumerate("RGBA"):
        expected[f"{name}.Combined.{channel}"] = frame.combined[..., index]
    # Blender writes the Combined of the whole render once more as "Composite" or without a layer.
    assert expected.keys() <= pictures.keys()
    for channel, pixels in expected.items():
        np.testing.assert_array_equal(pictures[channel], pixels, err_msg=channel)
    story = json.loads(header[f"shadow_layers.pass.{name}.Shadow Key_001 sm"])
    assert story["light"] == "Key.001"
    assert story["technique"] == "sm"
    assert story["settings"]["map_size"] == scene.shadow_layers.map_size
    assert header["shadow_layers.version"].startswith(frame.info["version"])
    assert "llvmpipe" in header["shadow_layers.gl"] or frame.info["gl_renderer"] in header["shadow_layers.gl"]


def test_picture_is_right_where_it_can_be_told(scene):
    """Sun from straight above: the ground below the cube is dark, beside it lit; the sky is lit and uncovered."""
    camera = add_camera((0, 0, 40), type="ORTHO", ortho_scale=16)
    camera.rotation_euler = (0, 0, 0)
    bpy.data.objects["Cube"].visible_camera = False
    bpy.data.objects["Ground"].scale = (0.4, 0.4, 1)  # 12 m: the sky shows on both sides
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    captured = render()
    frame = captured.frames[0]
    sun = next(layer for layer in frame.layers if layer.light == "Key.001").channels["visibility"]
    metres_per_pixel = 16 / 160
    x = (np.arange(160) + 0.5 - 80) * metres_per_pixel
    y = (np.arange(90) + 0.5 - 45) * metres_per_pixel
    inside = (np.abs(x)[None] < 0.8) & (np.abs(y)[:, None] < 0.8)
    outside = (np.abs(x)[None] > 1.2) | (np.abs(y)[:, None] > 1.2)
    sky = (np.abs(x)[None] > 6.2) & np.ones((90, 1), bool)
    assert (sun[inside] == 0).all()
    assert (sun[outside] == 1).all()
    assert (frame.coverage[sky] == 0).all()
    assert (frame.coverage[~sky & (np.abs(x)[None] < 5.8)] == 1).all()
    assert (frame.combined[..., 3] == frame.coverage).all()


def test_same_frame_twice_is_bit_identical(scene):
    scene.shadow_layers.techniques = {"sm", "pcf", "edsm"}
    scene.shadow_layers.samples = 3
    first, second = render().frames[0], render().frames[0]
    np.testing.assert_array_equal(first.combined, second.combined)
    for a, b in zip(first.layers, second.layers, strict=True):
        np.testing.assert_array_equal(a.channels["visibility"], b.channels["visibility"])


def test_capture_holds_what_the_comparison_needs(scene):
    from addon import engine

    with engine.capture(aux=("position", "normal", "ids", "depth")) as captured:
        bpy.ops.render.render()
    frame = captured.frames[0]
    assert {name: picture.shape for name, picture in frame.aux.items()} == {
        "position": (36, 64, 3),
        "normal": (36, 64, 3),
        "ids": (36, 64, 2),
        "depth": (36, 64),
    }
    assert frame.camera_position == pytest.approx((0, -9, 6))
    assert [layer.light for layer in frame.layers] == ["Key.001", "Füllicht"]
    layer = frame.layers[0]
    assert layer.parameters["map_size"] == scene.shadow_layers.map_size
    assert layer.total_ms > 0
    assert {entry["stage"] for entry in layer.times}
    assert frame.info["gl_renderer"]


@pytest.mark.parametrize("crop", [False, True])
def test_border_is_a_part_of_the_full_picture(scene, tmp_path, crop):
    scene.shadow_layers.techniques = {"sm", "edsm"}
    full = render().frames[0]
    scene.render.use_border, scene.render.use_crop_to_border = True, crop
    scene.render.border_min_x, scene.render.border_max_x = 0.3, 0.8
    scene.render.border_min_y, scene.render.border_max_y = 0.2, 0.9
    path = tmp_path / "border.exr"
    set_multilayer_output(path)
    part = render(write_still=True).frames[0]
    x, y, width, height = part.snapshot.render.region
    assert (x, y, width, height) == (19, 7, 32, 25)
    window = np.s_[y : y + height, x : x + width]
    np.testing.assert_allclose(part.coverage, full.coverage[window])
    for a, b in zip(part.layers, full.layers, strict=True):
        different = a.channels["visibility"] != b.channels["visibility"][window]
        assert different.mean() < 0.02  # a sun's map is fitted to the receivers seen, which a border changes
    written = read_exr(path)[0][f"{view_layer_name(scene)}.Shadow Key_001 sm.X"]
    assert written.shape == ((height, width) if crop else (36, 64))
    inner = written if crop else written[window]
    np.testing.assert_array_equal(inner, part.layers[0].channels["visibility"])


def test_view_layers_land_in_one_file(scene, tmp_path):
    collection = bpy.data.collections.new("Extra")
    scene.collection.children.link(collection)
    lamp = add_light("SPOT", name="Extra", location=(0, 0, 9))
    scene.collection.objects.unlink(lamp)
    collection.objects.link(lamp)
    scene.view_layers.new("Back").layer_collection.children["Extra"].exclude = True
    off = scene.view_layers.new("Beauty only")
    off.shadow_layers.enabled = False
    path = tmp_path / "views.exr"
    set_multilayer_output(path)
    render(write_still=True)
    pictures, _ = read_exr(path)
    first = view_layer_name(scene)
    assert f"{first}.Shadow Extra sm.X" in pictures
    assert "Back.Shadow Key_001 sm.X" in pictures
    assert "Back.Shadow Extra sm.X" not in pictures
    assert not [name for name in pictures if name.startswith("Beauty only.Shadow")]
    assert "Beauty only.Coverage.X" in pictures


def test_a_view_layer_whose_channels_blender_cuts_is_named(scene):
    view_layer = bpy.context.view_layer
    for name, is_cut in (("ViewLayer", False), ("A view layer whose name takes more than its share", True)):
        view_layer.name = name
        (frame,) = render().frames
        reported = [text for text in frame.warnings if "shorter name" in text]
        assert len(reported) == (is_cut and bpy.app.version < (5, 0, 0))
        assert all(name in text for text in reported)


def test_percentage_and_png(scene, tmp_path):
    scene.render.resolution_percentage = 50
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "IMAGE"
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(tmp_path / "picture.png")
    frame = render(write_still=True).frames[0]
    assert frame.coverage.shape == (18, 32)
    image = bpy.data.images.load(str(tmp_path / "picture.png"))
    assert image.size[:] == (32, 18)
    pixels = np.array(image.pixels[:]).reshape(18, 32, 4)
    assert pixels[..., :3].std() > 0.02


def test_animation_writes_a_file_per_frame(scene, tmp_path):
    cube = bpy.data.objects["Cube"]
    for frame, x in ((1, -3), (3, 3)):
        cube.location.x = x
        cube.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = 1, 3
    set_multilayer_output(tmp_path / "frame_")
    scene.render.use_file_extension = True
    captured = render(animation=True)
    assert [frame.frame for frame in captured.frames] == [1, 2, 3]
    files = sorted(tmp_path.iterdir())
    assert [file.name for file in files] == [f"frame_{i:04d}.exr" for i in (1, 2, 3)]
    channel = f"{view_layer_name(scene)}.Shadow Key_001 sm.X"
    pictures = [read_exr(file)[0][channel] for file in files]
    assert not np.array_equal(pictures[0], pictures[2])
    np.testing.assert_array_equal(pictures[1], captured.frames[1].layers[0].channels["visibility"])


def test_compositor_has_a_socket_for_every_pass(scene):
    view_layer = scene.view_layers[0]
    view_layer.update_render_passes()
    if bpy.app.version >= (5, 0):
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        scene.compositing_node_group = tree
    else:
        scene.use_nodes = True
        tree = scene.node_tree
    node = tree.nodes.new("CompositorNodeRLayers")
    node.scene = scene
    view_layer.update_render_passes()
    sockets = {socket.name: socket.type for socket in node.outputs if socket.enabled}
    assert sockets["Shadow Key_001 sm"] == "VALUE"
    assert sockets["Shadow Füllicht sm"] == "VALUE"
    assert sockets["Coverage"] == "VALUE"


def test_instanced_lights_get_their_passes(scene, tmp_path):
    collection = bpy.data.collections.new("Lamps")
    lamp = add_light("POINT", name="Bulb", location=(0, 0, 3))
    scene.collection.objects.unlink(lamp)
    collection.objects.link(lamp)
    for x in (-4, 4):
        empty = add_object(f"Post{x}", None, (x, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
    path = tmp_path / "lamps.exr"
    set_multilayer_output(path)
    render(write_still=True)
    channels = read_exr(path)[0]
    name = view_layer_name(scene)
    assert {f"{name}.Shadow Bulb @Post-4 sm.X", f"{name}.Shadow Bulb @Post4 sm.X"} <= channels.keys()


def test_lights_from_geometry_nodes_are_added_while_rendering(scene, tmp_path):
    lamp = add_light("POINT", name="Spark", location=(0, 0, 3))
    lamp.hide_render = True
    host = add_object("Host", plane_mesh(8, "Host"))
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    info, points = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeMeshGrid")
    place, end = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("NodeGroupOutput")
    points.inputs["Vertices X"].default_value = points.inputs["Vertices Y"].default_value = 2
    points.inputs["Size X"].default_value = points.inputs["Size Y"].default_value = 6
    info.inputs[0].default_value = lamp
    if "As Instance" in info.inputs:
        info.inputs["As Instance"].default_value = True
    tree.links.new(points.outputs[0], place.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
    tree.links.new(place.outputs[0], end.inputs[0])
    host.modifiers.new("Nodes", "NODES").node_group = tree
    path = tmp_path / "sparks.exr"
    set_multilayer_output(path)
    captured = render(write_still=True)
    lights = [layer.light for layer in captured.frames[0].layers]
    assert lights == ["Key.001", "Füllicht", *["Spark @Host", "Spark @Host 2", "Spark @Host 3", "Spark @Host 4"]]
    channels = read_exr(path)[0]
    for layer in captured.frames[0].layers:
        pixels = channels[f"{view_layer_name(scene)}.{layer.pass_names['visibility']}.X"]
        np.testing.assert_array_equal(pixels, layer.channels["visibility"])


def test_many_lights_with_hostile_names(scene, tmp_path):
    for index in range(40):
        add_light("POINT", name=f"A lamp with a very long name indeed {index:03d}", location=(index % 7 - 3, 0, 5))
    path = tmp_path / "many.exr"
    set_multilayer_output(path)
    captured = render(write_still=True)
    channels = read_exr(path)[0]
    layers = captured.frames[0].layers
    assert len({layer.pass_names["visibility"] for layer in layers}) == 42
    for layer in layers:
        pixels = channels[f"{view_layer_name(scene)}.{layer.pass_names['visibility']}.X"]
        np.testing.assert_array_equal(pixels, layer.channels["visibility"])


def test_linked_and_local_lights_of_one_name(scene, tmp_path):
    library = tmp_path / "lamps.blend"
    lamp = add_light("POINT", name="Twin", location=(3, 0, 6))
    bpy.data.libraries.write(str(library), {lamp})
    bpy.data.objects.remove(lamp)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Twin"]
    scene.collection.objects.link(wanted.objects[0])
    add_light("POINT", name="Twin", location=(-3, 0, 6))
    path = tmp_path / "twins.exr"
    set_multilayer_output(path)
    captured = render(write_still=True)
    channels = read_exr(path)[0]
    twins = {layer.light: layer for layer in captured.frames[0].layers if layer.light.startswith("Twin")}
    assert sorted(twins) == ["Twin", "Twin [lamps.blend]"]
    written = [channels[f"{view_layer_name(scene)}.{t.pass_names['visibility']}.X"] for t in twins.values()]
    assert not np.array_equal(*written)
    for pixels, layer in zip(written, twins.values(), strict=True):
        np.testing.assert_array_equal(pixels, layer.channels["visibility"])


def test_lights_that_come_and_go_in_an_animation(scene, tmp_path):
    """Pass names are announced before a frame is evaluated: a light keyed on gets its pass, one keyed off a lit one."""
    for name, hidden_at in (("Comes", 1), ("Goes", 2)):
        lamp = add_light("POINT", name=name, location=(3, -3, 5))
        for frame in (1, 2):
            lamp.hide_render = frame == hidden_at
            lamp.keyframe_insert("hide_render", frame=frame)
    scene.frame_start, scene.frame_end = 1, 2
    set_multilayer_output(tmp_path / "f_")
    scene.render.use_file_extension = True
    captured = render(animation=True)
    for frame in captured.frames:
        channels = read_exr(tmp_path / f"f_{frame.frame:04d}.exr")[0]
        lights = {layer.light: layer for layer in frame.layers}
        assert ("Comes" in lights, "Goes" in lights) == (frame.frame == 2, frame.frame == 1)
        for name in ("Comes", "Goes"):
            pixels = channels.get(f"{view_layer_name(scene)}.Shadow {name} sm.X")
            if name in lights:
                np.testing.assert_array_equal(pixels, lights[name].channels["visibility"])
            else:
                assert pixels is None or (pixels == 1).all()


def no_light(scene):
    for item in [item for item in scene.objects if item.type == "LIGHT"]:
        item.hide_render = True


def no_technique(scene):
    scene.shadow_layers.techniques = set()


def all_off(scene):
    for light in bpy.data.lights:
        light.shadow_layers.mode = "OFF"


def stereo(scene):
    scene.render.use_multiview = True


def panorama(scene):
    scene.camera.data.type = "PANO"


REFUSED = [
    (no_light, "has no light; add a sun"),
    (no_technique, "no technique is chosen"),
    (all_off, "no technique is chosen"),
    (stereo, "stereo is not supported; switch"),
    (panorama, "Perspective or Orthographic"),
]


@pytest.mark.parametrize(("break_it", "text"), REFUSED, ids=[case.__name__ for case, _ in REFUSED])
def test_refusals_say_what_and_how_and_leave_no_file(scene, tmp_path, break_it, text):
    break_it(scene)
    set_multilayer_output(tmp_path / "refused.exr")
    assert text in failed_render()
    with pytest.raises(RuntimeError, match="Shadow Layers"):
        bpy.ops.render.render(write_still=True)
    assert not (tmp_path / "refused.exr").exists()


def test_a_technique_of_another_version_is_named_with_its_light(scene):
    from addon import properties

    own = bpy.data.lights["Key.001"].shadow_layers
    own.mode = "OVERRIDE"
    if bpy.app.version >= (5, 0):
        own.bl_system_properties_get()["technique"] = properties.enum_number("from the future")
    else:
        own["technique"] = properties.enum_number("from the future")
    assert own.technique == ""
    text = failed_render()
    assert '"Key.001"' in text
    assert "choose another" in text


def test_a_view_layer_without_light_beside_others_is_no_error(scene):
    collection = bpy.data.collections.new("Lights")
    scene.collection.children.link(collection)
    for item in [item for item in scene.objects if item.type == "LIGHT"]:
        scene.collection.objects.unlink(item)
        collection.objects.link(item)
    scene.view_layers.new("Dark").layer_collection.children["Lights"].exclude = True
    captured = render()
    assert not captured.errors
    dark = next(frame for frame in captured.frames if frame.view_layer == "Dark")
    assert not dark.layers
    assert any("has no light" in warning for warning in dark.warnings)


def test_an_error_of_the_core_is_reported_with_a_published_result(scene, tmp_path):
    set_multilayer_output(tmp_path / "bad.exr")
    mesh = bpy.data.objects["Cube"]
    mesh.scale = (float("nan"), 1, 1)
    text = failed_render()
    assert "Cube" in text or "not finite" in text.lower()


def test_cancelling_ends_the_render_without_frame_or_error(scene, monkeypatch):
    from addon import capture, final_render

    scene.render.resolution_x, scene.render.resolution_y = 640, 360
    scene.shadow_layers.samples = 64
    scene.shadow_layers.techniques = {"sm", "pcf", "edsm"}
    asked = []

    def stop_soon(_render) -> bool:
        asked.append(True)
        return len(asked) > 3

    monkeypatch.setattr(final_render.FinalRender, "_stop_wanted", stop_soon)
    with capture.capture() as captured:
        bpy.ops.render.render()
    assert not captured.frames
    assert not captured.errors
    monkeypatch.undo()
    scene.shadow_layers.samples = 1
    assert len(render().frames) == 1  # the session goes on


def test_animation_does_not_grow(scene):
    from addon import bridge

    scene.render.resolution_x, scene.render.resolution_y = 32, 18
    scene.shadow_layers.map_size = 64
    cube = bpy.data.objects["Cube"]
    cube.shape_key_add(name="Basis")
    cube.shape_key_add(name="Other").data[0].co.x += 1
    key = cube.data.shape_keys.key_blocks["Other"]
    for frame, value in ((1, 0.0), (60, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    sizes = []
    for frame in range(1, 61):
        scene.frame_set(frame)
        bpy.ops.render.render()
        session = bridge.session()
        sizes.append((session.host_bytes, session.gpu_bytes))
    assert max(sizes[30:])[0] <= max(sizes[:20])[0] * 1.2 + 65536
    assert max(size[1] for size in sizes[30:]) <= max(size[1] for size in sizes[:20]) * 1.2 + 65536


def test_without_native_module_or_shaders(project_root, tmp_path, run_script):
    """An installation without its native parts registers, reports and survives EXR output."""
    package = tmp_path / "somewhere" / "shadow_layers"
    ignore = shutil.ignore_patterns("native", "shaders", "__pycache__")
    shutil.copytree(project_root / "addon", package, ignore=ignore)
    script = tmp_path / "render.py"
    script.write_text(
        "import sys, os\n"
        f"sys.path[:0] = [{str(package.parent)!r}, {str(project_root / 'tests' / 'blender')!r}]\n"
        "import bpy, shadow_layers, pathlib\n"
        "shadow_layers.register()\n"
        "from addon_helpers import *\n"
        "scene = bpy.context.scene\n"
        "scene.render.engine = 'SHADOW_LAYERS'\n"
        "add_camera(); add_light('SUN')\n"
        f"set_multilayer_output(pathlib.Path({str(tmp_path / 'out.exr')!r}))\n"
        "try:\n"
        "    bpy.ops.render.render(write_still=True)\n"
        "except RuntimeError as error:\n"
        "    print('REPORTED', error, flush=True)\n"
        "shadow_layers.unregister()\n"
        "print('SURVIVED', flush=True)\n"
        "os._exit(0)\n"
    )
    empty = tmp_path / "empty"
    empty.mkdir()
    no_module = run_script(script, [], env={"SHADOW_LAYERS_NATIVE": str(empty)})
    assert "REPORTED" in no_module.stdout, no_module.stdout + no_module.stderr
    assert "native module shadow_core" in no_module.stdout
    assert "SURVIVED" in no_module.stdout
    no_shaders = run_script(script, [])
    assert "the shader folder is in none of" in no_shaders.stdout, no_shaders.stdout + no_shaders.stderr
    assert "SURVIVED" in no_shaders.stdout
    assert not (tmp_path / "out.exr").exists()


@pytest.mark.skipif(not bpy.app.binary_path, reason="the bpy module has no command line")
def test_command_line_renders_and_fails_with_exit_codes(scene, tmp_path, project_root, run_script):
    import subprocess

    enable = tmp_path / "enable.py"
    enable.write_text(f"import sys; sys.path.insert(0, {str(project_root)!r}); import addon; addon.register()")

    def command_line(blend, *arguments):
        first = [
            bpy.app.binary_path,
            "-b",
            "--factory-startup",
            str(blend),
            "--python-exit-code",
            "1",
            "-P",
            str(enable),
        ]
        done = subprocess.run([*first, *arguments], capture_output=True, text=True, timeout=120, check=False)
        return done.returncode, done.stdout + done.stderr

    good, dark = tmp_path / "good.blend", tmp_path / "dark.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(good), copy=True)
    no_light(scene)
    bpy.ops.wm.save_as_mainfile(filepath=str(dark), copy=True)
    output = ["-o", str(tmp_path / "out_"), "-F", "OPEN_EXR_MULTILAYER", "-x", "1"]
    code, log = command_line(good, *output, "-f", "1")
    assert code == 0, log
    assert (tmp_path / "out_0001.exr").stat().st_size > 1000
    code, log = command_line(good, "-s", "2", "-e", "4", *output, "-a")
    assert code == 0, log
    assert (tmp_path / "out_0004.exr").exists()
    dark_output = ["-o", str(tmp_path / "dark_"), "-F", "OPEN_EXR_MULTILAYER", "-x", "1"]
    code, log = command_line(dark, *dark_output, "-f", "1")
    assert code == 1, log
    assert "has no light" in log
    assert not (tmp_path / "dark_0001.exr").exists()


def test_register_and_unregister_again(scene, addon):
    addon.unregister()
    assert not hasattr(bpy.types.Scene, "shadow_layers")
    assert scene.render.engine != "SHADOW_LAYERS"
    addon.register()
    scene.render.engine = "SHADOW_LAYERS"
    scene.shadow_layers.techniques = {"sm"}
    assert len(render().frames[0].layers) == 2
    assert "addon.bridge" in sys.modules
    assert os.environ.get("SHADOW_LAYERS_NATIVE")
