# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Kernels built for the base instructions and for the best that this processor has find the same bits. The choice is
made once in a process, so each set has its own."""

import json
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

# A soup of triangles over the ground, seen from aside: penumbrae, self-shadows, slivers.
SCRIPT = """
import json
import sys
import numpy as np
import shadow_core as core
import small_scene

random = np.random.default_rng(5)
corners = random.normal(0, 1.2, (160, 1, 3)) + random.normal(0, 0.5, (160, 3, 3)) + (0, 2.5, 0)
corners[::5, 2] = corners[::5, 1] + random.normal(0, 0.01, (32, 3))
scene = core.Scene()
scene.add_mesh("ground", small_scene.GROUND.copy(), small_scene.GROUND_TRIANGLES.copy())
scene.add_mesh("soup", corners.reshape(-1, 3).astype(np.float32), np.arange(480, dtype=np.uint32).reshape(-1, 3))
flags = core.INSTANCE_CAMERA | core.INSTANCE_SHADOW
scene.set_instances(np.array([0, 1], dtype=np.uint32), np.stack([np.eye(4)] * 2), np.full(2, flags, dtype=np.uint32))
place = small_scene.looking_down(7.0)
place[:3, 3] = (0.7, 7.0, 0.4)
slanting = place.copy()
slanting[:3, :3] = place[:3, :3] @ [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]]
scene.add_light("sun", "SUN", slanting, sun_angle=0.3)
scene.add_light("spot", "SPOT", place, radius=0.5, spot_angle=1.2)
scene.add_light("point", "POINT", place, radius=0.5)
scene.add_light("area", "AREA", place, area_size=(1.5, 0.8))
soft = [{"light_samples": n, "pattern": p} for n, p in json.loads(sys.argv[3])]
jobs = [(light, *job) for job in [("exact", {}), *(("soft", s) for s in soft)] for light in range(4)]
with core.Session(backend="osmesa", shader_dir=sys.argv[1], threads=2) as session:
    result = session.render(scene, small_scene.make_camera(core), jobs, width=160, height=160)
np.save(sys.argv[2], np.stack([layer.channels["visibility"] for layer in result.layers]))
"""
LIGHTS = 4
SOFT = [(1, "fixed"), (2, "rotated"), (48, "fixed"), (64, "rotated"), (130, "fixed"), (1024, "rotated")]


@pytest.fixture(scope="module")
def pictures(core, shader_dir, tmp_path_factory):
    """Layers by instruction set: four lights by `exact`, then by each `soft`."""
    folder = tmp_path_factory.mktemp("instruction_sets")
    (folder / "render.py").write_text(textwrap.dedent(SCRIPT), encoding="utf-8")
    found = {}
    for name in ("base", ""):
        path = folder / f"{name or 'best'}.npy"
        search = os.pathsep.join([os.path.dirname(core.__file__), os.path.dirname(__file__)])
        environment = {**os.environ, "SHADOW_LAYERS_INSTRUCTION_SET": name, "PYTHONPATH": search}
        command = [sys.executable, str(folder / "render.py"), str(shader_dir), str(path), json.dumps(SOFT)]
        subprocess.run(command, check=True, env=environment, timeout=120)
        found[name] = np.load(path)
    return found["base"], found[""]


def test_hard_layers_are_the_same_to_the_bit(pictures):
    base, best = (layers[:LIGHTS] for layers in pictures)
    assert ((base == 0).mean(axis=(1, 2)) > 0.02).all() and ((base == 1).mean(axis=(1, 2)) > 0.2).all()
    assert np.array_equal(base, best)


@pytest.mark.parametrize(("samples", "pattern"), SOFT)
def test_soft_layers_are_the_same_but_for_the_rounding_of_their_sums(pictures, samples, pattern):
    begin = LIGHTS * (1 + SOFT.index((samples, pattern)))
    base, best = (layers[begin : begin + LIGHTS].astype(np.float64) for layers in pictures)
    if samples == 1:
        assert np.array_equal(base, pictures[0][:LIGHTS]) and np.array_equal(base, best)
        return
    penumbra = (base > 0) & (base < 1)
    assert (penumbra.mean(axis=(1, 2)) > 0.05).all()
    assert np.array_equal(penumbra, (best > 0) & (best < 1))
    # A sample brings no less than a tenth of its share here.
    assert np.abs(base - best).max() < 2e-6 < 0.1 / samples
