#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what the product claims, prints tables and keeps the numbers in out/measure/.

    scripts/measure.py [NAME ...]   accuracy exact edsm_causes orderings borders speed hard_speed soft soft_speed
                                    soft_cycles cycles export memory cancel   (nothing: all)

Runs with the bpy 4.5 module. A figure over its bound is marked and makes the exit code 1. Times are ratios of medians
within one process wherever the bound is a ratio; run it on a machine that does nothing else.
"""

import argparse
import importlib
import json
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import measure_edsm_causes as edsm_causes
import measure_exactness as exactness
import measure_hard_speed as hard_speed
import measure_orderings as orderings
from measure_kit import Table, build_folder, in_blender, make_model, make_scene, make_snapshot, out, root, run
from measure_soft import measure_soft, measure_soft_cycles, measure_soft_speed

kWrongBounds = {"box": 0.05, "jenga": 0.15, "scorpion": 0.5}
kPlaneBound = 0.2
kAcneLeakBound = 0.0005
kCancelBound = 300  # ms


def measure_accuracy() -> Table:
    """Wrong pixels, acne and leak against Cycles at 1280 x 720 with maps of 1024."""
    scenes = [make_scene(name, name) for name in ("box", "jenga", "hall", "fence", "studio", "city")]
    scenes += [make_scene(f"box_{kind}", "box", "--light", kind) for kind in ("sun", "point", "area")]
    planes = [make_scene("jenga_plane", "jenga", "--hide-blocks")]
    for name in ("scorpion", "bunny_hr", "armadillo", "teapot"):
        scenes.append(make_model(name))
        planes.append(make_model(name, "--hide-model"))
    table = Table("Wrong pixels against Cycles, 1280 x 720, maps of 1024 (percent of the compared pixels)",
                  ["scene", "light", "sm", "pcf", "edsm", "edsm/sm", "bound", "most acne", "most leak"])  # fmt: skip
    for path in filter(None, [*scenes, *planes]):
        folder = out / "accuracy" / path.stem
        run(f"comparing {path.stem}", root / "addon" / "batch.py", path, "compare", "--techniques", "sm,pcf,edsm",
            "--resolution", "1280x720", "--map-size", 1024, "--out", folder)  # fmt: skip
        records = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["records"]
        bound = kPlaneBound if path in planes else kWrongBounds.get(path.stem.split("_")[0])
        add_accuracy_rows(table, path.stem, records, bound)
    return table


def add_accuracy_rows(table: Table, scene: str, records: list[dict], bound: float | None) -> None:
    for light in dict.fromkeys(record["light"] for record in records):
        mine = {record["technique"]: record["measures"] for record in records if record["light"] == light}
        wrong = {technique: measures["misclassified_fraction"] for technique, measures in mine.items()}
        ratio = wrong["edsm"] / wrong["sm"] if wrong["sm"] else 0.0
        acne = max(measures["acne_fraction"] for measures in mine.values())
        leak = max(measures["leak_fraction"] for measures in mine.values())
        good = max(acne, leak) <= kAcneLeakBound and (bound is None or ratio <= bound)
        table.add(scene, light, *(f"{100 * wrong[t]:.4f}" for t in ("sm", "pcf", "edsm")), f"{ratio:.3f}",
                  bound or "", f"{100 * acne:.4f}", f"{100 * leak:.4f}", good=good)  # fmt: skip


def measure_exact() -> Table:
    """Techniques without texels on every scene, their wrong pixels by cause."""
    table = Table("Techniques without texels against Cycles, 1280 x 720", exactness.kColumns)
    rows = []

    def compare(name: str, techniques: Sequence[str], *options: object) -> tuple[list[dict], Path]:
        folder = out / "exact" / f"{name}_{options[1]}_{len(techniques)}"
        run(f"comparing {', '.join(techniques)} on {name}, maps of {options[1]}", root / "addon" / "batch.py",
            scenes[name], "compare", "--techniques", ",".join(techniques), *options, "--out", folder)  # fmt: skip
        return json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["records"], folder

    scenes: dict[str, Path] = {}
    for name, script, options in exactness.list_wanted():
        path = make_model(name, *options) if script == "model" else make_scene(name, script, *options)
        if path is not None:
            scenes[path.stem] = path
    for name in scenes:
        for row in exactness.measure_scene(compare, name):
            table.add(*row.cells, good=row.good)
            rows.append(row)
    table.add("all", "", "", "", sum(int(row.cells[4]) for row in rows), "", "", "", exactness.sum_causes(rows))
    return table


def measure_edsm_causes() -> Table:
    """Wrong pixels of edsm by cause, against exact rays."""
    scenes = [make_scene(name, name) for name in edsm_causes.kScenes]
    scenes += filter(None, (make_model(name) for name in edsm_causes.kModels))
    snapshots = [make_snapshot(scene) for scene in scenes]
    program = edsm_causes.build_program(build_folder())
    columns, rows = edsm_causes.read_table(edsm_causes.run_program(program, snapshots))
    table = Table("Wrong pixels of edsm in a million, by cause, 1280 x 720", columns)
    for row in rows:
        table.add(*row, good=edsm_causes.adds_up(row))
    return table


def measure_orderings() -> Table:
    """What papers 003 and 004 say of their techniques, on the same settings."""
    table = Table("Orderings, 1280 x 720, maps of 512", ["what", "scene", "technique", "figure", "bound", "beside it"])
    scenes = {name: make_scene(name, name) for name in ("box", "jenga", orderings.kLeakScene)}
    scenes["scorpion"] = make_model("scorpion")
    runs = 0

    def compare(scene: str, techniques: list[str], *options: object) -> list[dict]:
        nonlocal runs
        runs += 1
        folder = out / "orderings" / f"{runs:02}_{scene}"
        run(f"comparing {', '.join(techniques)} on {scene}", root / "addon" / "batch.py", scenes[scene], "compare",
            "--techniques", ",".join(techniques), *orderings.kSettings, *options, "--out", folder)  # fmt: skip
        return json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["records"]

    for row in orderings.measure(compare, tuple(name for name in orderings.kBorderScenes if scenes[name])):
        table.add(*row.cells, good=row.good)
    return table


def measure_borders() -> Table:
    """How well shift and staircase are found, by the truth's samples: edges known in closed form."""
    sys.path.insert(0, str(root / "tests" / "python"))
    edges = importlib.import_module("analytic_edges")
    table = Table("Errors of the measures of borders (px): RMS, largest; without a staircase: mean, largest",
                  ["samples", "shift", "staircase", "none"])  # fmt: skip
    for row in edges.make_table():
        table.add(*row)
    return table


def measure_speed() -> Table:
    table = Table("Frame and layer, 1280 x 720, maps of 1024, camera and light moved each time (median ms)",
                  ["scene", "sm", "pcf", "edsm", "edsm/sm", "bound"])  # fmt: skip
    found = in_blender("speed", make_scene("jenga", "jenga"), make_scene("hall", "hall"))
    for scene, bound in (("jenga", 1.5), ("hall", 2.0)):
        median = {technique: values["median"] for technique, values in found[scene].items()}
        ratio = median["edsm"] / median["sm"]
        table.add(
            scene, *(f"{median[t]:.1f}" for t in ("sm", "pcf", "edsm")), f"{ratio:.2f}", bound, good=ratio <= bound
        )
    return table


def measure_hard_speed() -> Table:
    """Exact shadows against a shadow map and against rays, in the same rounds; no Blender but for the scene."""
    table = Table("Exact hard shadows, 1280 x 720, maps of 1024 (medians, ms)", hard_speed.kColumns)
    scenes = [make_scene("jenga", "jenga"), make_scene("hall", "hall"), make_model("scorpion")]
    for scene in filter(None, scenes):
        snapshot = make_snapshot(scene)
        for samples, repeats in hard_speed.kRepeats.items():
            path = out / f"hard_speed_{scene.stem}_{samples}.json"
            print(f"[measure] timing {scene.stem}, {samples} samples a pixel", flush=True)
            command = [build_folder() / "bin" / "shadowcore", "bench", snapshot,
                       "--techniques", ",".join(hard_speed.kTechniques), "--samples", samples, "--repeat", repeats,
                       *hard_speed.kSettings, "--json", path]  # fmt: skip
            subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
            document = json.loads(path.read_text(encoding="utf-8"))
            cells, good = hard_speed.make_row(scene.stem, samples, document)
            table.add(*cells, good=good)
    return table


def measure_cycles() -> Table:
    table = Table("F12 to passes (sm, second frame on) against Cycles' visibility mask, 1280 x 720 (median ms)",
                  ["scene", "F12", "Cycles", "Cycles/F12", "bound"])  # fmt: skip
    scene = make_model("scorpion") or make_scene("hall", "hall")
    values = in_blender("cycles", scene)[scene.stem]
    ratio = values["cycles_ms"]["median"] / values["f12_ms"]["median"]
    f12, mask = (f"{values[key]['median']:.0f}" for key in ("f12_ms", "cycles_ms"))
    table.add(scene.stem, f12, mask, f"{ratio:.1f}", 8,
              good=ratio >= 8)  # fmt: skip
    return table


def measure_export() -> Table:
    table = Table("Export from Blender and writing passes (ms)", ["what", "first", "later", "bound"])
    found = in_blender("export")
    for key, what, bound in (
        ("million_triangles_ms", "triangles in one mesh", 500),
        ("instances_ms", "instances", 2000),
    ):
        values = found[key]
        count = found["triangles"] if key.startswith("million") else values["instances"]
        table.add(
            f"{count:,} {what}",
            f"{values['first']:.0f}",
            f"{values['median']:.0f}",
            bound,
            good=values["first"] <= bound,
        )
    write = found["write_layer_ms"]["median"]
    table.add("one 1080p layer into its pass", "", f"{write:.1f}", 10, good=write <= 10)
    return table


def measure_memory() -> Table:
    found = in_blender("memory", make_scene("studio", "studio"))
    held, count = found["held"], len(found["held"]["allocated"])
    title = f"Memory over {count} animated frames in one process (MB); growth over {found['distance']} frames"
    table = Table(title, ["what", "frame 10", "100", str(count), "growth", "bound"])
    names = {"allocated": "process, allocated", "resident": "process, resident", "host": "core, host caches",
             "gpu": "core, GL objects"}  # fmt: skip
    for key, what in names.items():
        values = [held[key][number - 1] / 1e6 for number in (10, 100, count)]
        growth, bound = found["growth"][key] / 1e6, found["bounds"][key] / 1e6
        table.add(what, *(f"{value:.1f}" for value in values), f"{growth:+.2f}", f"{bound:g}", good=growth <= bound)
    return table


def measure_cancel() -> Table:
    table = Table("From cancel() to the end of the render, city, 1280 x 720 (ms)",
                  ["render", "takes", "cancelled", "median", "longest", "bound"])  # fmt: skip
    found = in_blender("cancel", make_scene("city", "city"))
    for key, what in (("maps", "sm, pcf and edsm, maps of 4096, 4 samples a pixel"),
                      ("soft", "soft, sun of 30 degrees, 256 samples"),
                      ("soft, trees too", "the same in a new session, trees too")):  # fmt: skip
        waits, wait = found[key], found[key]["wait_ms"]
        good = wait["most"] <= kCancelBound and 2 * waits["cancelled"] >= waits["tried"]
        table.add(what, f"{waits['render_s']:.1f} s", f"{waits['cancelled']} of {waits['tried']}",
                  f"{wait['median']:.0f}", f"{wait['most']:.0f}", kCancelBound, good=good)  # fmt: skip
    return table


kMeasures = {
    "accuracy": measure_accuracy,
    "exact": measure_exact,
    "edsm_causes": measure_edsm_causes,
    "orderings": measure_orderings,
    "borders": measure_borders,
    "speed": measure_speed,
    "hard_speed": measure_hard_speed,
    "soft": measure_soft,
    "soft_speed": measure_soft_speed,
    "soft_cycles": measure_soft_cycles,
    "cycles": measure_cycles,
    "export": measure_export,
    "memory": measure_memory,
    "cancel": measure_cancel,
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(kMeasures)} (default: all)")
    names = parser.parse_args().names or list(kMeasures)
    unknown = set(names) - set(kMeasures)
    if unknown:
        parser.error(f"no measure {', '.join(sorted(unknown))}; there are {', '.join(kMeasures)}")
    out.mkdir(parents=True, exist_ok=True)
    print(f"[measure] {platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    tables: list[Table] = []
    for name in names:
        made = kMeasures[name]()
        tables += [made] if isinstance(made, Table) else made
    for table in tables:
        table.print()
    over = sum(table.over for table in tables)
    document = [{"title": t.title, "columns": t.columns, "rows": t.rows} for t in tables]
    (out / "tables.json").write_text(json.dumps(document, indent=1), encoding="utf-8")
    print(f"\n[measure] {over} figures over their bounds; all numbers in {out.relative_to(root)}/")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
