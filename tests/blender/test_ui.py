# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings and panels made from the core's descriptors."""

import bpy
import pytest
from addon_helpers import add_light


class RecordingLayout:
    """Stands for a bpy layout: notes the properties and labels that a panel draws, and that they exist."""

    def __init__(self, drawn: list) -> None:
        self.drawn = drawn

    def prop(self, owner, name, **options):
        assert hasattr(owner, name), f"{owner} has no {name}"
        self.drawn.append(options.get("text") or owner.bl_rna.properties[name].name)

    def label(self, text="", **_options):
        self.drawn.append(text)

    def column(self, **_options):
        return self

    row = box = column


def draw(panel_name: str, **context) -> list[str]:
    """What a registered panel draws."""
    panel = getattr(bpy.types, panel_name)
    drawn: list[str] = []

    class Fake:
        layout = RecordingLayout(drawn)

    class Context:
        scene = bpy.context.scene
        view_layer = bpy.context.view_layer
        engine = bpy.context.scene.render.engine
        light = context.get("light")
        object = context.get("object")

    assert panel.poll(Context)
    panel.draw(Fake, Context)
    return drawn


def descriptors():
    from addon import bridge

    return bridge.techniques()


def test_every_parameter_of_every_technique_is_a_property_with_its_default(fresh_scene):
    settings = fresh_scene.shadow_layers
    light = add_light("SPOT").data.shadow_layers
    assert descriptors()
    for owner in (settings, light):
        for info in descriptors():
            for parameter in info["parameters"]:
                group = owner if parameter["shared"] else getattr(owner, info["id"])
                value = getattr(group, parameter["id"])
                assert value == pytest.approx(parameter["default"]) if parameter["type"] == "float" else True
                if parameter["type"] != "float":
                    assert value == parameter["default"]
                rna = group.bl_rna.properties[parameter["id"]]
                assert rna.name == parameter["label"]
                assert parameter["help"].rstrip(".") in rna.description
                if parameter["type"] in {"int", "float"}:
                    assert rna.hard_min == pytest.approx(parameter["min"], rel=1e-6)
                    assert rna.hard_max == pytest.approx(parameter["max"], rel=1e-6)
                if parameter["type"] == "enum":
                    assert [item.identifier for item in rna.enum_items] == [item["id"] for item in parameter["items"]]


def test_every_settable_value_is_one_the_core_takes(fresh_scene):
    """Each by itself; what is wrong only together (an exponent that 16 bits can't hold) is refused by the render."""
    from addon import bridge, properties

    settings = fresh_scene.shadow_layers
    for info in descriptors():
        for parameter in info["parameters"]:
            group = settings if parameter["shared"] else getattr(settings, info["id"])
            if parameter["type"] in {"int", "float"}:
                low, high = parameter["min"], min(parameter["max"], parameter["min"] + 1000)
                tries = [low, high, (low + high) / 2, low - 5, parameter["max"] + 5]
            elif parameter["type"] == "bool":
                tries = [True, False]
            else:
                tries = [item["id"] for item in parameter["items"]]
            for value in tries:
                setattr(group, parameter["id"], int(value) if parameter["type"] == "int" else value)
                given = properties.parameter_values(settings, info)
                assert bridge.resolve_parameters(info["id"], given).keys() == given.keys()
            setattr(group, parameter["id"], parameter["default"])


def test_techniques_are_a_set_backed_by_one_switch_each(fresh_scene):
    settings = fresh_scene.shadow_layers
    assert settings.techniques == {"edsm"}
    settings.techniques = {"sm", "pcf"}
    assert (settings.use_sm, settings.use_pcf, settings.use_edsm) == (True, True, False)
    settings.use_pcf = False
    assert settings.techniques == {"sm"}


def test_test_only_techniques_are_not_offered(fresh_scene):
    from addon import bridge

    hidden = {info["id"] for info in bridge.techniques(test_only=True)} - {info["id"] for info in descriptors()}
    assert not any(hasattr(fresh_scene.shadow_layers, "use_" + name) for name in hidden)


def test_settings_survive_saving_and_loading(fresh_scene, tmp_path):
    settings = fresh_scene.shadow_layers
    settings.techniques = {"pcf"}
    settings.pcf.kernel = 7
    light = add_light("SPOT").data.shadow_layers
    light.mode, light.technique, light.map_size = "OVERRIDE", "pcf", 128
    fresh_scene.view_layers[0].shadow_layers.enabled = False
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    assert scene.shadow_layers.techniques == {"pcf"}
    assert scene.shadow_layers.pcf.kernel == 7
    light = bpy.data.lights["Spot"].shadow_layers
    assert (light.mode, light.technique, light.map_size) == ("OVERRIDE", "pcf", 128)
    assert not scene.view_layers[0].shadow_layers.enabled


def test_render_panel_lists_techniques_shared_parameters_and_samples(fresh_scene):
    fresh_scene.shadow_layers.techniques = {info["id"] for info in descriptors()}
    drawn = draw("SHADOWLAYERS_PT_render")
    for info in descriptors():
        assert info["label"] in drawn
    assert "Map Size (texels)" in drawn
    assert "Samples" in drawn
    assert "Pixel Filter" in drawn
    fresh_scene.shadow_layers.techniques = set()
    assert "No technique is chosen" in draw("SHADOWLAYERS_PT_render")


def test_technique_panels_draw_parameters_and_limits(fresh_scene):
    settings = fresh_scene.shadow_layers
    settings.techniques = {info["id"] for info in descriptors()}
    for info in descriptors():
        own = [parameter for parameter in info["parameters"] if not parameter["shared"]]
        if not own:
            continue
        drawn = draw(f"SHADOWLAYERS_PT_technique_{info['id']}")
        for parameter in own:
            assert any(text.startswith(parameter["label"]) for text in drawn)
        for sentence in (info["limits"], *info["restrictions"]):
            assert sentence in " ".join(drawn)


@pytest.mark.parametrize("kind", ["SUN", "SPOT", "POINT", "AREA"])
def test_light_panels(fresh_scene, kind):
    lamp = add_light(kind)
    assert "Casts Shadow" in draw("SHADOWLAYERS_PT_light", light=lamp.data)
    assert len(draw("SHADOWLAYERS_PT_light_layers", light=lamp.data)) == 1
    lamp.data.shadow_layers.mode = "OVERRIDE"
    assert "Technique" in draw("SHADOWLAYERS_PT_light_layers", light=lamp.data)


def test_view_layer_panel_lists_the_passes(fresh_scene):
    for index in range(50):
        add_light("POINT", name=f"Lamp {index}")
    drawn = draw("SHADOWLAYERS_PT_passes")
    assert "Shadow Lamp 0 edsm" in drawn
    assert "and 10 more" in drawn


def test_preferences_have_a_fallback(fresh_scene):
    from addon import preferences

    assert bpy.context.preferences.addons.get("addon") is None  # registered by hand, as `--addons` does
    assert preferences.session_settings(fresh_scene) == preferences.SessionSettings("auto", 0)
    fresh_scene.shadow_layers.backend, fresh_scene.shadow_layers.threads = "osmesa", 3
    assert preferences.session_settings(fresh_scene) == preferences.SessionSettings("osmesa", 3)


def test_preferences_hold_back_end_and_threads(addon):
    properties = addon.preferences.ShadowLayersPreferences.bl_rna.properties
    assert properties["backend"].default == "auto"
    assert (properties["threads"].default, properties["threads"].hard_min) == (0, 0)


def test_blenders_panels_are_shared_and_given_back(fresh_scene, addon):
    assert "SHADOW_LAYERS" in bpy.types.RENDER_PT_color_management.COMPAT_ENGINES
    assert "SHADOW_LAYERS" not in bpy.types.DATA_PT_light.COMPAT_ENGINES
    assert "SHADOW_LAYERS" not in bpy.types.VIEWLAYER_PT_layer_passes.COMPAT_ENGINES
    addon.unregister()
    panels = [panel for panel in bpy.types.Panel.__subclasses__() if not panel.__name__.startswith("SHADOWLAYERS")]
    left = [panel.__name__ for panel in panels if "SHADOW_LAYERS" in getattr(panel, "COMPAT_ENGINES", ())]
    addon.register()
    fresh_scene.render.engine = "SHADOW_LAYERS"
    assert not left
