# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""shadow_core without a context: data in, errors, the stub."""

import ast
import gc
import sys
import time
import weakref

import numpy as np
import pytest
import small_scene


def stub_tree(root):
    return ast.parse((root / "native" / "bindings" / "shadow_core.pyi").read_text(encoding="utf-8"))


def stub_names(body):
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node.name, node
        elif isinstance(node, ast.AnnAssign):
            yield node.target.id, node


def is_typed_dict(node):
    return isinstance(node, ast.ClassDef) and any(getattr(base, "id", "") == "TypedDict" for base in node.bases)


def test_the_module_is_what_the_stub_says(core, root):
    stub = dict(stub_names(stub_tree(root).body))
    typed_dicts = {name for name, node in stub.items() if is_typed_dict(node)}
    public = {name for name in dir(core) if not name.startswith("_")} | {"__version__", "__revision__"}
    assert public == set(stub) - typed_dicts
    for name, node in stub.items():
        if isinstance(node, ast.ClassDef) and name not in typed_dicts:
            python_class = getattr(core, name)
            assert node.bases == [] or python_class.__bases__[0].__name__ == node.bases[0].id
            for member, member_node in stub_names(node.body):
                assert hasattr(python_class, member), f"{name}.{member}"
                if isinstance(member_node, ast.FunctionDef) and not member.startswith("__e"):
                    check_arguments(f"{name}.{member}", getattr(python_class, member), member_node)


def check_arguments(place, function, node):
    """Names in the order of the stub, as pybind11 writes them in the docstring's first line."""
    if isinstance(function, property):
        return
    signature = function.__doc__.splitlines()[0]
    position = 0
    for argument in [*node.args.args, *node.args.kwonlyargs]:
        found = signature.find(f"{argument.arg}:", position)
        assert found >= 0, f"{place}: {argument.arg} missing or out of order in {signature}"
        position = found


def test_errors_form_one_family(core):
    assert issubclass(core.Error, RuntimeError)
    for name in ("InputError", "ContextError", "ShaderError", "DriverError", "Cancelled"):
        assert issubclass(getattr(core, name), core.Error)


def test_techniques_have_the_keys_of_the_stub(core, root):
    classes = dict(stub_names(stub_tree(root).body))

    def keys(name):
        return {member for member, _ in stub_names(classes[name].body)}

    techniques = core.techniques()
    assert techniques
    for technique in techniques:
        assert set(technique) == keys("TechniqueInfo")
        assert technique["outputs"][0]["id"] == "visibility"
        for parameter in technique["parameters"]:
            assert set(parameter) == keys("ParameterInfo")
            kind = {"bool": bool, "int": int, "float": float, "enum": str}[parameter["type"]]
            assert type(parameter["default"]) is kind
            if kind is str:
                assert parameter["default"] in [item["id"] for item in parameter["items"]]
        for output in technique["outputs"]:
            assert set(output) == keys("OutputInfo")


def test_parameters_are_resolved_and_checked(core):
    technique = core.techniques()[0]
    defaults = {parameter["id"]: parameter["default"] for parameter in technique["parameters"]}
    assert core.resolve_parameters(technique["id"], {}) == defaults
    size = core.resolve_parameters(technique["id"], {"map_size": np.int64(512)})["map_size"]
    assert size == 512
    with pytest.raises(core.InputError, match="no_such"):
        core.resolve_parameters(technique["id"], {"no_such": 1})
    with pytest.raises(core.InputError, match="nonesuch"):
        core.resolve_parameters("nonesuch", {})
    with pytest.raises(core.InputError, match="map_size"):
        core.resolve_parameters(technique["id"], {"map_size": -5})
    with pytest.raises(TypeError, match="map_size"):
        core.resolve_parameters(technique["id"], {"map_size": [1024]})
    with pytest.raises(core.InputError, match="map_size"):
        core.resolve_parameters(technique["id"], {"map_size": 1 << 80})
    with pytest.raises(TypeError, match="mapping"):
        core.resolve_parameters(technique["id"], [("map_size", 1)])


def test_meshes_are_kept_not_copied(core):
    positions, triangles = small_scene.BOX.copy(), small_scene.BOX_TRIANGLES.copy()
    counts = sys.getrefcount(positions), sys.getrefcount(triangles)
    scene = core.Scene()
    assert scene.add_mesh("box", positions, triangles) == 0
    assert scene.add_mesh("again", positions, triangles) == 1
    assert (sys.getrefcount(positions), sys.getrefcount(triangles)) == (counts[0] + 2, counts[1] + 2)
    del scene
    core.Scene()  # passing by, it drops what was queued
    assert (sys.getrefcount(positions), sys.getrefcount(triangles)) == counts


def test_memory_goes_with_the_scene_without_another_call(core):
    positions = small_scene.BOX.copy()
    watch = weakref.ref(positions)
    scene = core.Scene()
    scene.add_mesh("box", positions, small_scene.BOX_TRIANGLES.copy())
    del positions
    gc.collect()
    assert watch() is not None
    del scene
    end = time.monotonic() + 10
    while watch() is not None and time.monotonic() < end:
        sum(range(1000))  # the interpreter runs its pending calls between bytecodes
    assert watch() is None


def test_a_mesh_cannot_change_under_the_core(core):
    positions, triangles = small_scene.BOX.copy(), small_scene.BOX_TRIANGLES.copy()
    core.Scene().add_mesh("box", positions, triangles)
    with pytest.raises(ValueError, match="read-only"):
        positions[0, 0] = 5
    with pytest.raises(ValueError, match="read-only"):
        triangles[0, 0] = 5


BAD_POSITIONS = {
    "dtype": (np.zeros((4, 3), np.float64), "float64"),
    "big endian": (np.zeros((4, 3), ">f4"), ">f4"),
    "shape": (np.zeros((4, 2), np.float32), r"\(4, 2\)"),
    "flat": (np.zeros(12, np.float32), r"\(12,\)"),
    "strided": (np.zeros((8, 3), np.float32)[::2], "not C-contiguous"),
    "fortran": (np.asfortranarray(np.zeros((4, 3), np.float32)), "not C-contiguous"),
    "unaligned": (np.frombuffer(bytes(49), np.uint8)[1:].view(np.float32).reshape(4, 3), "not aligned"),
}


@pytest.mark.parametrize("case", BAD_POSITIONS)
def test_bad_positions_are_named(core, case):
    array, text = BAD_POSITIONS[case]
    with pytest.raises(core.InputError, match=rf"box.*positions.*float32 \(n, 3\).*{text}"):
        core.Scene().add_mesh("box", array, small_scene.BOX_TRIANGLES)


@pytest.mark.parametrize("value", [[[0.0, 0.0, 0.0]], None, "positions", 3])
def test_no_array_is_a_type_error(core, value):
    with pytest.raises(TypeError, match=r"positions.*NumPy array"):
        core.Scene().add_mesh("box", value, small_scene.BOX_TRIANGLES)


def test_bad_triangles_are_named(core):
    with pytest.raises(core.InputError, match=r"triangles.*uint32 \(m, 3\).*int32"):
        core.Scene().add_mesh("box", small_scene.BOX, small_scene.BOX_TRIANGLES.astype(np.int32))
    beyond = small_scene.BOX_TRIANGLES.copy()
    beyond[5, 1] = 8
    with pytest.raises(core.InputError, match=r"box.*5.*8"):
        core.Scene().add_mesh("box", small_scene.BOX, beyond)


def test_an_empty_mesh_is_allowed(core):
    scene = core.Scene()
    assert scene.add_mesh("nothing", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32)) == 0
    assert scene.triangle_count == 0


def instances(count=2, **changes):
    arguments = {
        "mesh": np.zeros(count, np.uint32),
        "world_from_object": np.tile(np.eye(4), (count, 1, 1)),
        "flags": np.full(count, 3, np.uint32),
        "receiver_group": np.zeros(count, np.uint8),
        "blocker_group": np.zeros(count, np.uint8),
    }
    return arguments | changes


BAD_INSTANCES = [
    ("mesh", np.zeros(2, np.int64)),
    ("world_from_object", np.zeros((2, 4, 4), np.float32)),
    ("world_from_object", np.zeros((3, 4, 4), np.float64)),
    ("world_from_object", np.zeros((2, 16), np.float64)),
    ("flags", np.zeros(1, np.uint32)),
    ("receiver_group", np.zeros(2, np.uint32)),
    ("blocker_group", np.zeros(3, np.uint8)),
]


@pytest.mark.parametrize(("argument", "value"), BAD_INSTANCES)
def test_bad_instances_are_named(core, argument, value):
    with pytest.raises(core.InputError, match=rf"set_instances: {argument}: expected.*got"):
        core.Scene().set_instances(**instances(**{argument: value}))


def test_triangles_are_counted_over_instances(core):
    scene = core.Scene()
    scene.add_mesh("box", small_scene.BOX.copy(), small_scene.BOX_TRIANGLES.copy())
    scene.set_instances(**instances(3))
    assert scene.triangle_count == 36
    scene.set_instances(**instances(5, receiver_group=None, blocker_group=None))
    assert scene.triangle_count == 60


BAD_LIGHTS = [
    ({"kind": "HEMI"}, "HEMI"),
    ({"world_from_light": np.eye(3)}, "world_from_light"),
    ({"world_from_light": "up"}, "world_from_light"),
    ({"color": (1, 1)}, "color"),
    ({"area_size": 3}, "area_size"),
    ({"receiver_set": -1}, "receiver_set"),
    ({"blocker_set": 1 << 64}, "blocker_set"),
]


@pytest.mark.parametrize(("change", "culprit"), BAD_LIGHTS)
def test_bad_lights_are_named(core, change, culprit):
    arguments = {"name": "Key", "kind": "SPOT", "world_from_light": np.eye(4)} | change
    with pytest.raises(core.InputError, match=culprit):
        core.Scene().add_light(**arguments)


def test_lights_count_up_and_take_all_bits(core):
    scene = core.Scene()
    assert scene.add_light("a", "SUN", np.eye(4)) == 0
    assert scene.add_light("b", "AREA", np.eye(4).tolist(), receiver_set=(1 << 64) - 1, blocker_set=0) == 1


def test_bad_cameras_are_named(core):
    good = {
        "perspective": True,
        "window": (-1, 1, -1, 1),
        "clip_start": 0.1,
        "clip_end": 10,
        "world_from_camera": np.eye(4),
    }
    core.Camera(**good)
    for change in (
        {"window": (1, 2, 3)},
        {"window": (1, -1, -1, 1)},
        {"clip_end": 0.01},
        {"clip_start": float("nan")},
        {"world_from_camera": np.eye(4) * 2},
    ):
        with pytest.raises(core.InputError, match=next(iter(change)).split("_")[0]):
            core.Camera(**(good | change))
