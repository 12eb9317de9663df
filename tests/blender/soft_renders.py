# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 with the technique `soft` next to renders of Cycles with ever more samples: times and errors, one light.

Errors are means over the pixels of the penumbra, against Cycles with many samples in a smaller picture, from which what
the truth itself is off by is taken away; times at full size. Cycles is given its least: direct light of one lamp on
white surfaces, and of its two renders, with and without shadows, only the first counts.
"""

import importlib
import math
import statistics
import time
from pathlib import Path

import bpy
import numpy as np

kSoftSamples = (64, 256)
kFasterSamples = kSoftSamples[0]  # F12 is timed with these, and Cycles is given samples until it is as good
kMostSamples = 1024
kRepeats = 5
kDenoiserSeed, kPlainSeed = 900, 700  # none of the truth's
# Of |x|, x of a normal distribution; and of the standard deviation found from four values.
kMeanOfNormal, kMeanOfFour = math.sqrt(2 / math.pi), 0.9213


def set_light_size(name: str, size: float) -> None:
    """A radius (point, spot), an angle in degrees (sun) or a width (area)."""
    light = bpy.data.objects[name].data
    if light.type == "SUN":
        light.angle = math.radians(size)
    elif light.type == "AREA":
        light.size, light.size_y = size, light.size_y * size / light.size
    else:
        light.shadow_soft_size = size


def find_truth_error(truth, penumbra) -> float:
    """Mean error of the truth itself, from its standard error (four seeds: addon/truth.py, SEEDS)."""
    return kMeanOfNormal * float(truth.error[penumbra].mean(dtype=np.float64)) / kMeanOfFour


def find_error(visibility, truth, penumbra) -> float:
    """Mean error over the penumbra, without what the truth itself is off by: independent errors add up as squares.
    Not root mean squares: some ten pixels in which Cycles sees another surface would stand for all others."""
    mean = float(np.abs(visibility - truth.visibility)[penumbra].mean(dtype=np.float64))
    return math.sqrt(max(0.0, mean**2 - find_truth_error(truth, penumbra) ** 2))


def render_cycles(truth, scene, name: str, samples: int, denoise: bool):
    """Visibility of one render with shadows by one without, and the first one's time."""
    cycles = scene.cycles
    cycles.use_denoising = denoise
    cycles.seed = kDenoiserSeed if denoise else kPlainSeed
    shadowed, open_sky, times = truth.render_soft_pair(name, samples)
    ratio = np.divide(shadowed, open_sky, out=np.zeros_like(shadowed), where=open_sky > 0)
    return np.clip(ratio, 0, 1), times["shadows_on"]


def measure_cycles_errors(render_one, exact, penumbra, bound: float) -> dict:
    """Of Cycles without and with denoiser, with ever more samples until the error falls to `bound`; `render_one` takes
    the samples and whether to denoise."""
    found: dict = {"plain": [], "denoised": []}
    for key, renders in found.items():
        samples = 1
        # The denoiser takes time: with as many samples as do without it, it is not the cheaper way.
        most = kMostSamples if key == "plain" else max(1, found["plain"][-1]["samples"] // 2)
        while samples <= most:
            visibility = render_one(samples, key == "denoised")
            renders.append({"samples": samples, "error": find_error(visibility, exact, penumbra)})
            if renders[-1]["error"] <= bound:
                break
            samples *= 2
    return found


def render_soft(scene, render, samples: int):
    """The layer and the wall time in seconds."""
    scene.shadow_layers.soft.light_samples = samples
    frame, wall_s = render(scene, ["soft"])
    return frame.layers[0].channels["visibility"], wall_s


def measure_errors(scene, layer, render, wanted: dict) -> dict:
    """Of `soft` by its samples, and of Cycles: in the small picture."""
    truths = importlib.import_module("addon.truth")
    name = wanted["light"]
    pictures = {samples: render_soft(scene, render, samples)[0] for samples in kSoftSamples}
    with truths.CyclesTruth(scene, layer, *wanted["small"]) as truth:
        exact = truth.render_soft_light(name, wanted["truth_samples"])
        penumbra = exact.lit & (exact.visibility > 0.005) & (exact.visibility < 0.995)
        errors = {samples: find_error(picture, exact, penumbra) for samples, picture in pictures.items()}
        biases = {samples: float((pictures[samples] - exact.visibility)[penumbra].mean()) for samples in pictures}

        def render_one(samples: int, denoise: bool):
            return render_cycles(truth, scene, name, samples, denoise)[0]

        return {
            "penumbra": int(penumbra.sum()), "truth_error": find_truth_error(exact, penumbra),
            "soft": [{"samples": samples, "error": errors[samples], "bias": biases[samples]} for samples in errors],
            "error": errors[kFasterSamples],
            **measure_cycles_errors(render_one, exact, penumbra, errors[kFasterSamples]),
        }  # fmt: skip


def measure_times(scene, layer, render, wanted: dict, found: dict) -> None:
    """Of F12, and of the last renders of Cycles: at full size. Added to `found`."""
    truths = importlib.import_module("addon.truth")
    scene.render.resolution_x, scene.render.resolution_y = wanted["full"]
    name = wanted["light"]
    walls, works = [], []
    for step in range(kRepeats + 1):
        scene.objects[name].location.x += 1e-4 * (step + 1)
        started = time.process_time()
        walls.append(render_soft(scene, render, kFasterSamples)[1] * 1e3)
        works.append((time.process_time() - started) * 1e3)
    found["f12_ms"] = {"median": statistics.median(walls[1:]), "least": min(walls[1:]), "most": max(walls[1:])}
    found["f12_cpu_ms"] = statistics.median(works[1:])
    with truths.CyclesTruth(scene, layer, *wanted["full"]) as truth:
        for key in ("plain", "denoised"):
            last = found[key][-1]
            started = time.process_time()
            last["ms"] = render_cycles(truth, scene, name, last["samples"], key == "denoised")[1]
            # Both renders, of which the second casts no rays.
            last["pair_cpu_ms"] = (time.process_time() - started) * 1e3


def measure(open_scene, render, path: Path, wanted: dict) -> dict:
    """`open_scene`, `render`: of measure_in_blender.py. `wanted`: "light", its "size" (set_light_size), sizes of the
    pictures for times and errors "full" and "small", "truth_samples"."""
    scene = open_scene(path, *wanted["small"])
    name = wanted["light"]
    set_light_size(name, wanted["size"])
    for thing in [thing for thing in scene.objects if thing.type == "LIGHT" and thing.name != name]:
        bpy.data.objects.remove(thing)
    layer = scene.view_layers[0]
    found = measure_errors(scene, layer, render, wanted)
    measure_times(scene, layer, render, wanted, found)
    return found
