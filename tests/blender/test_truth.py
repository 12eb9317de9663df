# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The truth from Cycles against closed forms, and that the scene is left as it was."""

import math
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Matrix

truth = pytest.importorskip("addon.truth")

WIDTH, HEIGHT = 160, 90


@pytest.fixture
def scene():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return bpy.context.scene


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.rotation_euler = location, rotation
    return made


def add_polygon(name, corners):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [range(len(corners))])
    return add(name, mesh)


def add_ground(size=40.0):
    return add_polygon("Ground", [(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)])


CARD = [(-1.0, -0.7, 1.5), (1.1, -0.9, 1.5), (0.8, 1.2, 1.5), (-1.3, 0.6, 1.5)]


def add_light(kind, location=(0, 0, 5), rotation=(0, 0, 0), name="Key", **settings):
    light = bpy.data.lights.new(name, kind)
    for key, value in settings.items():
        setattr(light, key, value)
    return add(name, light, location, rotation)


def add_camera(scene, ortho=False, height=12.0, span=10.0):
    """Straight down at the origin, `span` units wide on the ground."""
    camera = bpy.data.cameras.new("Camera")
    if ortho:
        camera.type, camera.ortho_scale = "ORTHO", span
    else:
        camera.angle = 2 * math.atan(0.5 * span / height)
    scene.camera = add("Camera", camera, (0.0, 0.0, height))
    return scene.camera


def ground_of_pixels(span=10.0):
    """Where the centres of the pixels meet z = 0, as add_camera sees it: x and y (h, w), and the pixel's size."""
    size = span / WIDTH
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    return (columns + 0.5) * size - span / 2, (rows + 0.5) * size - span * HEIGHT / WIDTH / 2, size


def signed_distance(x, y, corners):
    """To a convex polygon with corners against the clock; positive inside."""
    distance = np.full(x.shape, np.inf)
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        length = math.hypot(bx - ax, by - ay)
        distance = np.minimum(distance, ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / length)
    return distance


def render(scene, light="Key", width=WIDTH, height=HEIGHT):
    with truth.CyclesTruth(scene, scene.view_layers[0], width, height) as cycles:
        return cycles.render_light(light)


def get_shadow_outline(location):
    """The card's outline on the ground, cast from a point."""
    outline = []
    for x, y, z in CARD:
        scale = location[2] / (location[2] - z)
        outline.append((location[0] + (x - location[0]) * scale, location[1] + (y - location[1]) * scale))
    return outline


# ---- what is rendered


@pytest.mark.parametrize("ortho", [False, True])
def test_samples_are_the_centres_of_the_pixels(scene, ortho):
    add_ground()
    add_camera(scene, ortho)
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        surface = cycles.render_surface()
    assert surface.covered.all()
    x, y, size = ground_of_pixels()
    assert np.abs(surface.positions_ws[..., 0] - x).max() < 0.005 * size
    assert np.abs(surface.positions_ws[..., 1] - y).max() < 0.005 * size
    assert np.abs(surface.positions_ws[..., 2]).max() < 1e-5


def test_background_is_not_covered(scene):
    add_polygon("Card", CARD)
    add_camera(scene)
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        surface = cycles.render_surface()
    # Seen from height 12, the card at 1.5 covers what a card scaled by 12 / 10.5 covers on the ground.
    x, y, size = ground_of_pixels()
    inside = signed_distance(x, y, [(cx * 12 / 10.5, cy * 12 / 10.5) for cx, cy, _ in CARD])
    certain = np.abs(inside) > 0.005 * size
    assert np.array_equal(surface.covered[certain], (inside > 0)[certain])


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA", "SUN"])
def test_shadow_of_a_card_is_exact(scene, kind):
    """Soft lights of all kinds against the hard outline in closed form, to a two hundredth of a pixel."""
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene, ortho=True)
    location = (0.31, -0.27, 6.0)
    soft = {
        "POINT": {"shadow_soft_size": 1.0},
        "SPOT": {"shadow_soft_size": 1.0, "spot_size": 2.2, "spot_blend": 0.7},
        "AREA": {"size": 2.0},
        "SUN": {"angle": 0.5},
    }[kind]
    rotation = (0.7, 0.4, 0.4) if kind == "SUN" else (0, 0, 0)
    add_light(kind, location, rotation, **soft)
    result = render(scene)
    assert result.undecided_count == 0
    x, y, size = ground_of_pixels()
    if kind == "SUN":
        axis = bpy.data.objects["Key"].rotation_euler.to_matrix().col[2]
        outline = [(cx - axis[0] / axis[2] * cz, cy - axis[1] / axis[2] * cz) for cx, cy, cz in CARD]
    else:
        outline = get_shadow_outline(location)
    inside = signed_distance(x, y, outline)
    # The camera sees the card itself in the middle; its top is lit.
    on_card = signed_distance(x, y, [(cx, cy) for cx, cy, _ in CARD]) > -size
    certain = (np.abs(inside) > 0.005 * size) & ~on_card
    assert result.lit[certain].all()
    assert np.array_equal(result.visible[certain], (inside < 0)[certain])
    assert (~result.visible & certain).sum() > 500  # there is a shadow to see


def test_spot_lights_its_cone_only(scene):
    add_ground()
    add_camera(scene)
    add_light("SPOT", (0.5, 0.2, 4.0), spot_size=0.9, spot_blend=1.0)
    result = render(scene)
    x, y, size = ground_of_pixels()
    inside = 4.0 * math.tan(0.45) - np.hypot(x - 0.5, y - 0.2)
    certain = np.abs(inside) > 0.02 * size
    assert np.array_equal(result.lit[certain], (inside > 0)[certain])


def test_smooth_shading_does_not_move_the_terminator(scene):
    """Coarse smooth sphere under a sun from above: whether a face is lit is decided by the face."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=7, radius=2.0)
    sphere = bpy.context.object
    for polygon in sphere.data.polygons:
        polygon.use_smooth = True
    camera = add_camera(scene)
    camera.location, camera.rotation_euler = (0.0, -12.0, 0.0), (math.pi / 2, 0, 0)
    add_light("SUN", rotation=(0, 0, 0))
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        surface, result = cycles.render_surface(), cycles.render_light("Key")
    assert result.undecided_count == 0
    # Rings of a sphere of 7: the equator's ring of faces stands upright; those above look up, those below look down.
    ring = math.sin(math.pi / 14) * 2.0
    above = surface.covered & (surface.positions_ws[..., 2] > ring + 0.02)
    below = surface.covered & (surface.positions_ws[..., 2] < -ring - 0.02)
    assert above.sum() > 100 and result.lit[above].all() and result.visible[above].all()
    assert below.sum() > 100 and not result.lit[below].any()


def test_other_lights_and_the_world_do_not_matter(scene):
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene)
    add_light("POINT", (1, 1, 5))
    alone = render(scene)
    add_light("SUN", rotation=(0.4, 0, 0), name="Other", energy=100.0)
    add_light("AREA", (0, 0, 1), name="Big", energy=1e6)
    scene.world = bpy.data.worlds.new("Bright")
    scene.world.color = (1, 1, 1)
    together = render(scene)
    assert np.array_equal(alone.visible, together.visible) and np.array_equal(alone.lit, together.lit)
    assert (~render(scene, "Other").visible).any()


def test_light_without_shadows_is_visible_everywhere(scene):
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene)
    light = add_light("POINT", (1, 1, 5))
    truth.set_shadow_switch(light.data, False)
    result = render(scene)
    assert result.lit.any() and result.visible[result.lit].all()


def test_energy_colour_and_animation_of_the_light_do_not_matter(scene):
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene)
    light = add_light("POINT", (1, 1, 5))
    expected = render(scene)
    light.data.color = (0.0, 0.0, 1.0)
    light.data.energy = 0.0
    for name in ("energy", "shadow_soft_size"):
        light.data.keyframe_insert(name, frame=1)
    result = render(scene)
    assert np.array_equal(result.visible, expected.visible) and np.array_equal(result.lit, expected.lit)


def test_materials_do_not_matter(scene):
    ground = add_ground()
    card = add_polygon("Card", CARD)
    add_camera(scene)
    add_light("POINT", (1, 1, 5))
    expected = render(scene)
    glow = bpy.data.materials.new("Glow")
    if bpy.app.version < (5, 0, 0):
        glow.use_nodes = True
    emission = glow.node_tree.nodes.new("ShaderNodeEmission")
    glow.node_tree.links.new(emission.outputs[0], glow.node_tree.nodes["Material Output"].inputs[0])
    ground.data.materials.append(glow)
    card.data.materials.append(glow)
    result = render(scene)
    assert np.array_equal(result.visible, expected.visible) and result.undecided_count == 0


def make_node_material(name, shader):
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    output, made = nodes.new("ShaderNodeOutputMaterial"), nodes.new(shader)
    socket = "Volume" if "Volume" in shader else "Surface"
    material.node_tree.links.new(made.outputs[0], output.inputs[socket])
    return material


@pytest.mark.parametrize("shader", ["ShaderNodeBsdfTransparent", "ShaderNodeVolumeScatter"])
def test_fully_transparent_objects_are_neither_seen_nor_cast(scene, shader):
    """As in the layers. The replaced material must not make them opaque."""
    add_ground()
    add_camera(scene)
    add_light("POINT", (1, 1, 5))
    card = add_polygon("Card", CARD)
    card.data.materials.append(make_node_material("Glass", shader))
    bpy.context.view_layer.update()
    before = dump_all(scene)
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        surface, result = cycles.render_surface(), cycles.render_light("Key")
    assert result.visible.all() and np.abs(surface.positions_ws[..., 2]).max() < 1e-4
    assert_same(before, dump_all(scene))
    scene.view_layers[0].material_override = make_node_material("Clay", "ShaderNodeBsdfDiffuse")
    assert not render(scene).visible.all()


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA", "SUN"])
def test_nodes_of_a_light_do_not_matter(scene, kind):
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene)
    light = add_light(kind, (1, 1, 5), (0.1, 0.1, 0))
    expected = render(scene)
    assert expected.lit.any() and not expected.visible.all()
    light.data.use_nodes = True
    emission = next(node for node in light.data.node_tree.nodes if node.type == "EMISSION")
    emission.inputs["Strength"].default_value = 0.0
    result = render(scene)
    assert np.array_equal(result.visible, expected.visible) and np.array_equal(result.lit, expected.lit)
    assert light.data.use_nodes


def test_rays_that_a_light_is_switched_off_for_do_not_matter(scene):
    """A light that is hidden from diffuse surfaces in Cycles has a layer, so it has a truth too."""
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene)
    light = add_light("POINT", (1, 1, 5))
    expected = render(scene)
    light.visible_diffuse = light.visible_camera = light.visible_shadow = False
    light.data.cycles.max_bounces = 0
    result = render(scene)
    assert np.array_equal(result.visible, expected.visible) and np.array_equal(result.lit, expected.lit)
    assert not light.visible_diffuse


def test_adaptive_subdivision_is_left_aside(scene):
    """The layers know a mesh at its render level."""
    bpy.ops.mesh.primitive_cube_add(size=4.0)
    cube = bpy.context.object
    add_camera(scene)
    modifier = cube.modifiers.new("Subdivision", "SUBSURF")
    modifier.render_levels = 1
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        plain = cycles.render_surface()
    on_modifier = hasattr(modifier, "use_adaptive_subdivision")
    owner = modifier if on_modifier else cube.cycles
    owner.use_adaptive_subdivision = True
    if not on_modifier:
        scene.cycles.feature_set = "EXPERIMENTAL"
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        np.testing.assert_array_equal(cycles.render_surface().covered, plain.covered)
    assert owner.use_adaptive_subdivision


def test_notes_burnt_into_pictures_do_not_matter(scene):
    add_ground()
    add_camera(scene)
    add_light("POINT", (1, 1, 5))
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        plain = cycles.render_surface()
    scene.render.use_stamp = True
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        assert np.array_equal(cycles.render_surface().positions_ws, plain.positions_ws)


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="light linking came with Blender 4.0")
def test_light_and_shadow_linking(scene):
    ground = add_ground()
    card = add_polygon("Card", CARD)
    add_camera(scene)
    light = add_light("POINT", (1, 1, 5))
    receivers, blockers = bpy.data.collections.new("Receivers"), bpy.data.collections.new("Blockers")
    receivers.objects.link(ground)
    light.light_linking.receiver_collection = receivers
    linked = render(scene)
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        on_card = cycles.render_surface().positions_ws[..., 2] > 1.0
    assert on_card.any() and not linked.lit[on_card].any() and linked.lit[~on_card].all()
    assert (~linked.visible & ~on_card).any()
    light.light_linking.receiver_collection = None
    blockers.objects.link(ground)
    light.light_linking.blocker_collection = blockers
    assert render(scene).visible.all()
    blockers.objects.link(card)
    assert not render(scene).visible.all()


def test_animated_camera_and_frames_are_followed(scene):
    add_ground()
    camera = add_camera(scene)
    for frame, x in ((1, 0.0), (11, 3.0)):
        camera.location.x = x
        camera.keyframe_insert("location", frame=frame)
    with truth.CyclesTruth(scene, scene.view_layers[0], WIDTH, HEIGHT) as cycles:
        scene.frame_set(1)
        first = cycles.render_surface()
        scene.frame_set(11)
        second = cycles.render_surface()
    moved = second.positions_ws[..., 0] - first.positions_ws[..., 0]
    np.testing.assert_allclose(moved, 3.0, atol=1e-4)


def test_ratio_is_read_with_its_doubts():
    shadowed = np.array([[0.0, 2.0, 1.0, 0.0, 1.1]], np.float32)
    open_sky = np.array([[2.0, 2.0, 2.0, 0.0, 2.0]], np.float32)
    result = truth.compute_light_truth(shadowed, open_sky, {})
    assert result.lit.tolist() == [[True, True, True, False, True]]
    assert result.visible.tolist() == [[False, True, True, False, True]]
    assert result.undecided_count == 2


# ---- what goes wrong


def test_without_a_camera(scene):
    with pytest.raises(truth.TruthError, match=r"no camera.*--camera"), \
            truth.CyclesTruth(scene, scene.view_layers[0], 8, 8):  # fmt: skip
        pass


def test_name_that_is_no_light(scene):
    add_ground()
    add_camera(scene)
    for name in ("Nowhere", "Ground"):
        with pytest.raises(truth.TruthError, match=f'"{name}" is no light object'):
            render(scene, name, 8, 8)


# ---- what is left behind


def dump(owner: Any) -> dict[str, Any]:
    """All plain properties of a Blender struct, pointers by identity."""
    values = {}
    for prop in owner.bl_rna.properties:
        if prop.identifier in ("rna_type", "is_updated", "is_updated_data", "is_evaluated"):
            continue
        value = getattr(owner, prop.identifier)
        if prop.type == "POINTER":
            value = value.as_pointer() if value is not None else 0
        elif prop.type == "COLLECTION":
            value = len(value)
        elif getattr(prop, "is_array", False):
            value = tuple(tuple(part) if hasattr(part, "__len__") else part for part in value)
        values[prop.identifier] = value
    return values


def dump_all(scene) -> dict[str, Any]:
    owners = {
        "scene": scene,
        "render": scene.render,
        "image": scene.render.image_settings,
        "cycles": scene.cycles,
        "dof": scene.camera.data.dof,
        **{f"layer {layer.name}": layer for layer in scene.view_layers},
        **{f"object {thing.name}": thing for thing in bpy.data.objects},
        **{f"object cycles {thing.name}": thing.cycles for thing in bpy.data.objects if hasattr(thing, "cycles")},
        **{f"light {light.name}": light for light in bpy.data.lights},
        **{f"light cycles {light.name}": light.cycles for light in bpy.data.lights},
    }
    dumped = {name: dump(owner) for name, owner in owners.items()}
    collections = (prop.identifier for prop in bpy.data.bl_rna.properties if prop.type == "COLLECTION")
    names = {name: sorted(thing.name for thing in getattr(bpy.data, name)) for name in collections}
    names["images"] = [name for name in names["images"] if name != "Render Result"]  # Blender's own, of any render
    dumped["names"] = names
    return dumped


def set_up_unusual_scene(scene):
    """Everything the truth touches set to something else than what it needs."""
    add_ground()
    card = add_polygon("Card", CARD)
    card.is_shadow_catcher = True
    camera = add_camera(scene)
    camera.data.dof.use_dof = True
    add_light("POINT", (1, 1, 5), shadow_soft_size=0.7)
    add_light("AREA", (-1, 1, 5), name="Area", shape="ELLIPSE", size=2.0, size_y=0.5)
    add_light("SPOT", (-1, -1, 5), name="Shared")
    add("Shared too", bpy.data.lights["Shared"], (0, 3, 3))
    scene.world = bpy.data.worlds.new("World")
    layer = scene.view_layers[0]
    layer.use_pass_combined = False
    layer.samples = 7
    layer.use = False
    layer.material_override = bpy.data.materials.new("Override")
    scene.view_layers.new("Second")
    render, image = scene.render, scene.render.image_settings
    render.engine = "BLENDER_WORKBENCH"
    render.resolution_x, render.resolution_y, render.resolution_percentage = 300, 200, 50
    render.filepath = "//somewhere"
    render.use_border = render.use_multiview = render.use_motion_blur = render.use_freestyle = True
    render.use_placeholder, render.use_overwrite = True, False
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
    image.file_format, image.color_mode, image.color_depth = "PNG", "RGB", "16"
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.seed, cycles.filter_width = 99, 9, 5, 2.5
    cycles.use_adaptive_sampling, cycles.sample_clamp_direct, cycles.pixel_filter_type = True, 3.0, "BOX"
    if hasattr(cycles, "feature_set"):  # until 4.5
        cycles.feature_set = "EXPERIMENTAL"
    bpy.context.view_layer.update()


def assert_same(before, after):
    for owner in before.keys() | after.keys():
        assert before[owner] == after[owner], owner


def test_scene_is_left_as_it_was(scene):
    set_up_unusual_scene(scene)
    before = dump_all(scene)
    with truth.CyclesTruth(scene, scene.view_layers[0], 32, 18) as cycles:
        cycles.render_surface()
        for name in ("Key", "Area", "Shared"):
            assert cycles.render_light(name).lit.any()
    assert_same(before, dump_all(scene))


@pytest.mark.parametrize("image_format", ["OPEN_EXR_MULTILAYER", "JPEG"])
def test_output_format_is_left_as_it_was(scene, image_format):
    set_up_unusual_scene(scene)
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE" if "MULTILAYER" in image_format else "IMAGE"
    image.file_format = image_format
    before = dump_all(scene)
    render(scene, width=8, height=8)
    assert_same(before, dump_all(scene))


@pytest.mark.parametrize("failing_call", [1, 2, 3])
def test_scene_is_left_as_it_was_after_an_error(scene, monkeypatch, failing_call):
    set_up_unusual_scene(scene)
    before = dump_all(scene)
    calls = []
    load = truth.load_pixels

    def load_or_fail(*arguments):
        calls.append(arguments)
        if len(calls) == failing_call:
            raise truth.TruthError("the disk is on fire")
        return load(*arguments)

    monkeypatch.setattr(truth, "load_pixels", load_or_fail)
    with pytest.raises(truth.TruthError, match="on fire"), \
            truth.CyclesTruth(scene, scene.view_layers[0], 8, 8) as cycles:  # fmt: skip
        cycles.render_surface()
        cycles.render_light("Area")
    assert_same(before, dump_all(scene))


def test_failure_while_setting_up_leaves_the_scene(scene, monkeypatch):
    set_up_unusual_scene(scene)
    before = dump_all(scene)

    def fail(*_):
        raise RuntimeError("no materials today")

    monkeypatch.setattr(truth, "make_diffuse_material", fail)
    with pytest.raises(RuntimeError, match="no materials"), truth.CyclesTruth(scene, scene.view_layers[0], 8, 8):
        pass
    assert_same(before, dump_all(scene))


def test_matrix_of_a_scaled_light_parent_is_kept(scene):
    """A light below a scaled and turned parent stays where it is when its data is exchanged."""
    add_ground()
    add_polygon("Card", CARD)
    add_camera(scene)
    parent = add("Parent", None)
    parent.matrix_world = Matrix.LocRotScale((0.2, 0.1, 1.0), None, (2.0, 2.0, 2.0))
    child = add_light("POINT", (0.4, 0.45, 2.0))
    child.parent = parent
    bpy.context.view_layer.update()
    moved = render(scene)
    bpy.data.objects.remove(child)
    add_light("POINT", (1.0, 1.0, 5.0))
    assert np.array_equal(moved.visible, render(scene).visible)
