# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Techniques without texels against Cycles, on every scene: rows for scripts/measure.py.

Each layer may be wrong at 20 pixels in a million, or at one in 1,000 of the pixels on the true border if that is more,
whatever the size of its map. Wrong pixels are sorted by cause (docs/measures.md); none may be the technique's, and none
unexplained.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

root = Path(__file__).resolve().parent.parent
kTechniques = ("exact", "afsm", "sv")
kWithoutMap = ("sv",)
kMapSizes = (256, 4096)
kFurtherSize = 1024  # of the first technique alone, for its layer must be the same
kBoxLights = ("sun", "point", "area")  # besides its own spot
kModels = ("scorpion", "bunny_hr", "armadillo", "teapot")
kModelLights = ("spot", "sun", "point")
kSettings = ("--resolution", "1280x720", "--border-samples", 1, "--truth", "hard", "--causes", 5000)
kBoundPpm = 20.0
kBoundOfBorder = 1e-3
kColumns = ["scene", "light", "technique", "maps", "wrong", "in a million", "on the border", "bound", "by cause"]

# compare(scene, techniques, *options): the records of a comparison, and the folder of their pictures.
Compare = Callable[..., tuple[list[dict[str, Any]], Path]]


@dataclass(frozen=True)
class Row:
    """One layer, or the layers of several maps if they are the same picture."""

    cells: tuple[object, ...]
    good: bool
    counts: dict[str, int]  # wrong pixels by cause


def list_scenes() -> list[str]:
    """Names of the generators of test scenes; that of models needs a file."""
    generators = (root / "test_scenes").glob("*.py")
    return sorted(p.stem for p in generators if "kit.main(build" in p.read_text(encoding="utf-8") and p.stem != "model")


def list_wanted() -> list[tuple[str, str, tuple[str, ...]]]:
    """Name, generator and options of each scene; of models "model" and the light, the name without it."""
    wanted: list[tuple[str, str, tuple[str, ...]]] = [(name, name, ()) for name in list_scenes()]
    wanted += [(f"box_{light}", "box", ("--light", light)) for light in kBoxLights]
    return wanted + [(name, "model", ("--light", light)) for name in kModels for light in kModelLights]


def compute_bound(record: dict[str, Any]) -> float:
    """How many pixels may be wrong."""
    return max(kBoundPpm * 1e-6 * record["pixel_count"], kBoundOfBorder * record["true_border_pixels"])


def judge(record: dict[str, Any]) -> bool:
    counts = record["causes"]["counts"]
    ours = counts["technique"] + counts["unexplained"]
    return record["causes"]["wrong"] <= compute_bound(record) and ours == 0


def list_counts(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{cause} {count}" for cause, count in counts.items() if count)


def tell_causes(causes: dict[str, Any]) -> str:
    reported = list_counts(causes["counts"])
    if causes["sorted"] < causes["wrong"]:
        reported += f" (of {causes['sorted']})"
    return reported


class SceneRows:
    """The rows of one scene: layers that are the same picture for several maps share one."""

    def __init__(self, scene: str) -> None:
        self._scene = scene
        self._found: dict[tuple[str, str], list[tuple[str, dict[str, Any], bytes]]] = {}

    def add(self, records: list[dict[str, Any]], folder: Path) -> None:
        for record in records:
            size = "" if record["technique"] in kWithoutMap else str(record["settings"]["map_size"])
            picture = (folder / record["layer_picture"]).read_bytes()
            self._found.setdefault((record["light"], record["technique"]), []).append((size, record, picture))

    def make_rows(self) -> list[Row]:
        rows = []
        for (light, technique), layers in self._found.items():
            groups: dict[bytes, list[tuple[str, dict[str, Any]]]] = {}
            for size, record, picture in layers:
                groups.setdefault(picture, []).append((size, record))
            for group in groups.values():
                rows.append(self._make_row(light, technique, group, alike=len(groups) == 1))
        return rows

    def _make_row(self, light: str, technique: str, group: list[tuple[str, dict[str, Any]]], alike: bool) -> Row:
        record = group[0][1]
        count, causes = record["pixel_count"], record["causes"]
        scale = 1e6 / max(count, 1)
        cells = (self._scene, light, technique, " = ".join(size for size, _ in group), causes["wrong"],
                 f"{scale * causes['wrong']:.1f}", record["true_border_pixels"],
                 f"{scale * compute_bound(record):.1f}", tell_causes(causes))  # fmt: skip
        # That the map's size changes nothing is asked of all techniques that have one.
        return Row(cells, judge(record) and alike, causes["counts"])


def measure_scene(compare: Compare, scene: str) -> list[Row]:
    """All rows of a scene, of all its lights."""
    rows = SceneRows(scene)
    first, *others = kMapSizes
    rows.add(*compare(scene, kTechniques, "--map-size", first, *kSettings))
    mapped = [name for name in kTechniques if name not in kWithoutMap]
    for size in others:
        rows.add(*compare(scene, mapped, "--map-size", size, *kSettings))
    rows.add(*compare(scene, kTechniques[:1], "--map-size", kFurtherSize, *kSettings))
    return rows.make_rows()


def sum_causes(rows: list[Row]) -> str:
    """Wrong pixels of all rows by cause."""
    total: Counter[str] = Counter()
    for row in rows:
        total.update(row.counts)
    return list_counts(total)
