# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two hundred frames of a deforming, subdivided figure in one process: nothing grows after the tenth."""

import json

import numpy as np
import process_memory
import pytest

kPictureBytes = 160 * 90 * 4  # of one layer of the measured animation


def test_two_hundred_frames_do_not_grow(project_root, scene_file, run_script, tmp_path):
    # In a process of its own: what other tests left to be freed some time would be noise.
    out = tmp_path / "memory.json"
    script = project_root / "tests" / "blender" / "measure_in_blender.py"
    run_script(script, ["memory", str(out), str(scene_file("studio"))], timeout_s=3600)
    found = json.loads(out.read_text(encoding="utf-8"))
    assert len(found["held"]["allocated"]) >= 200
    # A leak of one small picture a frame would be far over the bounds.
    assert max(found["bounds"].values()) < kPictureBytes * found["distance"] / 2
    over = {key: growth for key, growth in found["growth"].items() if growth > found["bounds"][key]}
    assert not over, f"grown by (bytes, with {found['allocator']}): {found['growth']}"
    settled = slice(found["settle"], found["settle"] + found["period"])
    for key in ("host", "gpu"):  # what the core counts has no noise, so that its peaks count too
        values = found["held"][key]
        assert max(values[-found["period"] :]) <= max(values[settled])


def test_memory_that_is_kept_is_seen():
    before = process_memory.read_memory()
    kept = [np.ones(kPictureBytes // 4, np.float32) for _ in range(64)]
    held = process_memory.read_memory()
    size = sum(picture.nbytes for picture in kept)
    # Allocators round up by less than a quarter.
    assert size <= held["allocated"] - before["allocated"] < 1.25 * size + 100_000
    assert held["resident"] - before["resident"] > 0.9 * size
    kept.clear()
    after = process_memory.read_memory()
    assert held["allocated"] - after["allocated"] > 0.9 * size
    assert held["resident"] - after["resident"] > 0.9 * size


def test_growth_is_a_leak_and_no_peak():
    settle, period, count = 10, 48, 202
    distance = process_memory.growth_distance(count, settle, period)
    assert distance == 96
    number = np.arange(count)
    needs = 1e7 * np.sin(2 * np.pi * number / period)  # what each frame of the animation needs
    needs[:settle] = 0  # caches fill
    peaks = needs + 4e7 * ((number > 100) & (number % 7 < 3))  # more, for a moment
    for held in (needs, peaks):
        assert abs(process_memory.compute_growth(held, settle, period)) < 1
        leak = process_memory.compute_growth(held + kPictureBytes * number, settle, period)
        assert leak == pytest.approx(kPictureBytes * distance, rel=0.5)
    with pytest.raises(ValueError, match="two periods"):
        process_memory.compute_growth(needs[:100], settle, period)
