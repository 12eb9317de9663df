# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of `make measure NAMES=hard_speed`, from documents of the benchmark."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

import measure_hard_speed as hard_speed


def spread(median):
    return {"median": median}


@pytest.fixture
def document():
    def record(technique, render):
        stages = {"receiver_tiles": spread(4.0), "caster_tiles": spread(6.5), "frame: frame_ids": spread(9.0)}
        return {"technique": technique, "render_ms": spread(render), "stage_ms": stages}

    def ray(name, listing, build, trace):
        return {"name": name, "list_ms": spread(listing), "build_ms": spread(build), "trace_ms": spread(trace)}

    return {
        "records": [record("sm", 50), record("exact", 60), record("afsm", 150), record("sv", 61)],
        "rays": [ray("low quality", 3, 5, 20), ray("medium quality", 2, 15, 9),
                 ray("low quality, instances", 4, 1, 12)],
    }  # fmt: skip


def test_a_row_tells_ratios_and_the_quickest_rays(document):
    cells, good = hard_speed.make_row("jenga", 1, document)
    assert good
    assert cells == ["jenga", 1, "50 ms", "1.20", "3.00", "1.22", 1.2, "10.5 ms", "2.0", "24.0", "13.0"]
    assert len(cells) == len(hard_speed.kColumns)
    assert len(hard_speed.make_row("jenga", 4, document)[0]) == len(hard_speed.kColumns)


@pytest.mark.parametrize(("technique", "render"), [("exact", 60.1), ("sv", 59.0), ("afsm", 59.0)])
def test_a_row_over_its_bound_is_found(document, technique, render):
    next(record for record in document["records"] if record["technique"] == technique)["render_ms"] = spread(render)
    assert not hard_speed.make_row("jenga", 1, document)[1]
