# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of `make measure NAMES=exact`: bounds, verdicts, layers of several maps."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

import measure_exactness as exactness
from compare.wrong_causes import CAUSES


def make_record(name="exact", size=256, picture="a.png", *, pixels=1_000_000, border=0, **counts):
    wrong = sum(counts.values())
    return {
        "light": "Key",
        "technique": name,
        "settings": {} if name == "sv" else {"map_size": size},
        "layer_picture": picture,
        "pixel_count": pixels,
        "true_border_pixels": border,
        "causes": {"wrong": wrong, "sorted": wrong, "counts": dict.fromkeys(CAUSES, 0) | counts},
    }


@pytest.mark.parametrize(
    ("record", "good"),
    [
        (make_record(), True),
        (make_record(place=20), True),
        (make_record(place=21), False),
        (make_record(place=21, border=21_000), True),
        (make_record(place=4, pixels=100_000), False),
        (make_record(technique=1), False),
        (make_record(unexplained=1), False),
        (make_record(raster=1, offset=2, ambiguous=1), True),
    ],
)
def test_verdicts(record, good):
    assert exactness.judge(record) is good


def make_rows(tmp_path, *records, pictures):
    for name, content in pictures.items():
        (tmp_path / name).write_bytes(content)
    rows = exactness.SceneRows("box")
    rows.add(list(records), tmp_path)
    return rows.make_rows()


def test_equal_layers_share_a_row_and_others_are_told(tmp_path):
    records = [make_record(size=256, picture="a.png", place=2), make_record(size=4096, picture="b.png", place=2)]
    (row,) = make_rows(tmp_path, *records, pictures={"a.png": b"same", "b.png": b"same"})
    assert row.good and row.cells[3] == "256 = 4096" and row.cells[-1] == "place 2"
    assert len(row.cells) == len(exactness.kColumns)
    rows = make_rows(tmp_path, *records, pictures={"a.png": b"one", "b.png": b"other"})
    assert [row.cells[3] for row in rows] == ["256", "4096"] and not any(row.good for row in rows)


def test_each_scene_is_compared_with_all_techniques_and_maps(tmp_path):
    asked = []

    def compare(scene, techniques, *options):
        asked.append((scene, tuple(techniques), options[:2]))
        (tmp_path / "a.png").write_bytes(b"same")
        return [make_record(technique, options[1]) for technique in techniques], tmp_path

    rows = exactness.measure_scene(compare, "hall")
    assert asked == [
        ("hall", ("exact", "afsm", "sv"), ("--map-size", 256)),
        ("hall", ("exact", "afsm"), ("--map-size", 4096)),
        ("hall", ("exact",), ("--map-size", 1024)),
    ]
    assert [(row.cells[2], row.cells[3]) for row in rows] == [
        ("exact", "256 = 4096 = 1024"), ("afsm", "256 = 4096"), ("sv", ""),
    ]  # fmt: skip
    assert exactness.sum_causes(rows) == ""


def test_all_generators_of_scenes_are_measured():
    scenes = exactness.list_scenes()
    assert {"box", "jenga", "hall", "fence", "studio", "city", "knot", "wall", "door", "blades"} <= set(scenes)
    assert not {"model", "scene_kit", "mannequin"} & set(scenes)
    wanted = exactness.list_wanted()
    assert sum(script == "box" for _, script, _ in wanted) == 4
    assert sum(script == "model" for _, script, _ in wanted) == 12
