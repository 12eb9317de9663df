# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two hundred frames of a deforming, subdivided figure in one process: nothing grows after the tenth."""

import os
from pathlib import Path

import bpy
import numpy as np
from addon_helpers import render

kFrames, kPeriod = 200, 48  # the animation comes again after kPeriod frames
# What the process may grow by after the first period: allocators keep pieces, a leak of one small picture a frame
# (160 x 90 floats, 58 kB) would be three times as much over the rest.
kGrowthBytes = 3_000_000


def resident_bytes() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_two_hundred_frames_do_not_grow(open_scene):
    from addon import bridge, preferences

    scene = open_scene("studio")
    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    scene.shadow_layers.map_size = 128
    scene.shadow_layers.techniques = {"edsm"}
    for name in ("Softbox", "Bulb"):  # two kinds of light are enough, and half the time
        bpy.data.objects.remove(scene.objects[name])
    settings = preferences.session_settings(scene)
    # A frame a period later is the same frame, so that what each needs can be compared.
    resident, host, gpu = (np.zeros(kFrames, np.int64) for _ in range(3))
    for number in range(kFrames):
        scene.frame_set(1 + number % kPeriod)
        assert not render().errors
        session = bridge.session(settings.backend, settings.threads)
        resident[number], host[number], gpu[number] = resident_bytes(), session.host_bytes, session.gpu_bytes
    settled, later = slice(10, 10 + kPeriod), slice(kFrames - kPeriod, kFrames)
    assert gpu[later].max() <= gpu[settled].max()
    assert host[later].max() <= host[settled].max()
    assert resident[later].max() - resident[settled].max() < kGrowthBytes
