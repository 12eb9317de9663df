# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 with the technique `soft` next to renders of Cycles with ever more samples: times and errors, one light.

Errors are taken in a smaller picture, against Cycles with many samples, over the pixels of the penumbra, as root mean
squares from which the truth's own error is taken away; times at full size. Cycles is given its least: direct light of
one lamp on white surfaces, and of its two renders, with and without shadows, only the first counts.
"""

import importlib
import math
import statistics
from pathlib import Path

import bpy
import numpy as np

kFull, kSmall = (1280, 720), (400, 225)
kLightSamples = 64
kTruthSamples = 512
kMostSamples = 512
kRepeats = 5
kDenoiserSeed, kPlainSeed = 900, 700  # none of the truth's


def set_light_size(name: str, size: float) -> None:
    """A radius (point, spot), an angle in degrees (sun) or a width (area)."""
    light = bpy.data.objects[name].data
    if light.type == "SUN":
        light.angle = math.radians(size)
    elif light.type == "AREA":
        light.size, light.size_y = size, light.size_y * size / light.size
    else:
        light.shadow_soft_size = size


def find_error(visibility, truth, penumbra) -> float:
    """Root mean square over the penumbra, without what the truth itself is off by."""
    squares = (visibility - truth.visibility)[penumbra].astype(np.float64) ** 2
    own = truth.error[penumbra].astype(np.float64) ** 2
    return math.sqrt(max(0.0, float(squares.mean() - own.mean())))


def render_cycles(truth, scene, name: str, samples: int, denoise: bool):
    """Visibility of one render with shadows by one without, and the first one's time."""
    cycles = scene.cycles
    cycles.use_denoising = denoise
    cycles.seed = kDenoiserSeed if denoise else kPlainSeed
    shadowed, open_sky, times = truth.render_soft_pair(name, samples)
    ratio = np.divide(shadowed, open_sky, out=np.zeros_like(shadowed), where=open_sky > 0)
    return np.clip(ratio, 0, 1), times["shadows_on"]


def measure_errors(scene, layer, name: str, soft) -> dict:
    """Of the layer `soft`, and of Cycles until its error falls below that: in the small picture."""
    truths = importlib.import_module("addon.truth")
    found: dict = {"plain": [], "denoised": []}
    with truths.CyclesTruth(scene, layer, *kSmall) as truth:
        exact = truth.render_soft_light(name, kTruthSamples)
        penumbra = exact.lit & (exact.visibility > 0.005) & (exact.visibility < 0.995)
        found["penumbra"] = int(penumbra.sum())
        found["error"] = find_error(soft, exact, penumbra)
        found["truth_error"] = float(np.sqrt((exact.error[penumbra].astype(np.float64) ** 2).mean()))
        for key in ("plain", "denoised"):
            samples = 1
            # The denoiser takes time: with as many samples as do without it, it is not the cheaper way.
            most = kMostSamples if key == "plain" else max(1, found["plain"][-1]["samples"] // 2)
            while samples <= most:
                visibility, _ = render_cycles(truth, scene, name, samples, key == "denoised")
                error = find_error(visibility, exact, penumbra)
                found[key].append({"samples": samples, "error": error})
                if error <= found["error"]:
                    break
                samples *= 2
    return found


def measure(open_scene, render, path: Path, name: str, size: float) -> dict:
    """`open_scene`, `render`: of measure_in_blender.py."""
    truths = importlib.import_module("addon.truth")
    scene = open_scene(path, *kSmall)
    set_light_size(name, size)
    for thing in [thing for thing in scene.objects if thing.type == "LIGHT" and thing.name != name]:
        bpy.data.objects.remove(thing)
    layer = scene.view_layers[0]
    frame, _ = render(scene, ["soft"])
    found = measure_errors(scene, layer, name, frame.layers[0].channels["visibility"])
    scene.render.resolution_x, scene.render.resolution_y = kFull
    walls = []
    for step in range(kRepeats + 1):
        scene.objects[name].location.x += 1e-4 * (step + 1)
        walls.append(render(scene, ["soft"])[1] * 1e3)
    found["f12_ms"] = {"median": statistics.median(walls[1:]), "least": min(walls[1:]), "most": max(walls[1:])}
    with truths.CyclesTruth(scene, layer, *kFull) as truth:
        for key in ("plain", "denoised"):
            last = found[key][-1]
            last["ms"] = render_cycles(truth, scene, name, last["samples"], key == "denoised")[1]
    return found
