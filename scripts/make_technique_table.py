#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/techniques.md from the core's descriptors and the benchmark of all techniques.

    scripts/make_technique_table.py FOLDER [docs/techniques.md]

FOLDER: where `scripts/bench.py techniques --out FOLDER` left info.json and results.json. `make table` does both.
"""

import json
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bench_tables import make_line

root = Path(__file__).resolve().parent.parent

MEASURED = """## What they cost, and how far they are from the truth

Default parameters, {resolution}, the scene's light. Error: mean distance to the exact picture that the technique
stands for, by rays, in percent of the pixels that the light may reach; of a hard one, its wrong pixels. Time: whole
frame as a ratio to `sm`'s in the same run, camera and light moved; the median of the scenes (least … most). Memory:
maps, lists and pictures held for the light beside meshes, frame and layer, the most of the scenes. Meshes: the casters
that it serves (any; any, with borders refined at `mesh edges` alone, not where surfaces cut each other; `closed` ones).
Size: what it makes of the light's. None sees the holes that a material's alpha cuts. Machine:
{processor}, {threads} threads, {gl_renderer}; load before: {load_before}. [benchmark.md](benchmark.md) says more on
how this is measured.

"""
PICTURES = """Pictures: a part of the tower's shadow, from maps of 256 texels: the truth that the technique names, the
technique, and the difference between them."""


def describe_range(parameter: dict) -> str:
    kind = parameter["type"]
    if kind == "bool":
        return "on, off"
    if kind == "enum":
        return ", ".join(f"`{item['id']}`" for item in parameter["items"])
    unit = f" {parameter['unit']}" if parameter["unit"] else ""
    step = f", steps of {parameter['step']:g}" if kind == "int" and parameter["step"] > 1 else ""
    return f"{parameter['min']:g} … {parameter['max']:g}{unit}{step}"


def describe_default(parameter: dict) -> str:
    value = parameter["default"]
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


def describe_truth(errors: dict) -> str:
    if errors["truth"] != "filtered":
        return errors["truth"]
    world = errors["footprint_world"]
    return f"filtered, {world:g} units" if world else f"filtered, {errors['footprint_texels']:.3g} texels"


def describe_time(records: list[dict]) -> str:
    """The median over the scenes, and their extremes where these differ."""
    ratios = sorted(record["ratio_to_sm"] for record in records)
    texts = [f"{value:.2f}" for value in (statistics.median(ratios), ratios[0], ratios[-1])]
    return texts[0] if texts[1] == texts[2] else f"{texts[0]} ({texts[1]} … {texts[2]})"


def count_bytes(record: dict) -> int:
    """What a technique says that it holds for a light: the counters that end in _bytes."""
    return sum(count for name, count in record["counters"].items() if name.endswith("_bytes")) // record["lights"]


def find_runs(document: dict) -> list[dict]:
    """The runs of the table of all techniques. SystemExit naming what is missing in it."""
    tables = [table for table in document["tables"] if table["id"] == "techniques"]
    runs = tables[0]["runs"] if tables else []
    bad = [f"{run['scene']}: {run.get('failed') or run.get('skipped')}" for run in runs if "records" not in run]
    if not runs or bad or document["state"] != "whole":
        sys.exit(f"[docs] error: the benchmark of all techniques is not whole: {document['state']} {'; '.join(bad)}")
    return runs


def make_measured_table(techniques: list[dict], document: dict) -> list[str]:
    runs, machine = find_runs(document), document["machine"]
    errors = [f"error, {run['scene']}" for run in runs]
    columns = ["technique", "truth", *errors, "time", "memory", "meshes", "size", "lights"]
    lines = MEASURED.format(resolution=runs[0]["resolution"], **machine).splitlines()
    lines += [make_line(columns), make_line(["---"] * len(columns))]
    for info in techniques:
        records = [record for run in runs for record in run["records"] if record["technique"] == info["id"]]
        if len(records) != len(runs):
            sys.exit(f"[docs] error: the benchmark has no figures of {info['id']}; make it anew")
        memory = f"{max(count_bytes(record) for record in records) / 1e6:.1f} MB"
        cells = [f"[`{info['id']}`](techniques/{info['id']}.md)", describe_truth(records[0]["errors"])]
        cells += [f"{100 * record['errors']['own']['mean_absolute']:.3f}" for record in records]
        cells += [describe_time(records), memory, info["meshes"].replace("_", " "), info["light_size"]]
        lines.append(make_line([*cells, list_lights(info)]))
    return lines


def list_lights(info: dict) -> str:
    return ", ".join(kind.lower() for kind in info["lights"])


def make_section(info: dict) -> list[str]:
    """A technique's picture, source, parameters and outputs."""
    lines = [f"## {info['label']} (`{info['id']}`)", "", f"![{info['id']}](images/{info['id']}.png)", ""]
    lines += [f"Source: {info['reference']} ([references](references.bib)).", ""]
    if info["parameters"]:
        lines += ["| parameter | default | range | meaning |", "| --- | --- | --- | --- |"]
    for parameter in info["parameters"]:
        shared = " (shared by all techniques that have it)" if parameter["shared"] else ""
        lines.append(make_line([f"`{parameter['id']}`", describe_default(parameter), describe_range(parameter),
                                parameter["help"] + shared]))  # fmt: skip
    outputs = "; ".join(f"`{output['id']}`: {output['help']}" for output in info["outputs"])
    return [*lines, *([""] if info["parameters"] else []), f"Outputs: {outputs}."]


def make_page(techniques: list[dict], document: dict) -> str:
    """`techniques`: as shadowcore's info lists them; `document`: the benchmark's results."""
    lines = [
        "# The techniques",
        "",
        "Made by `make docs`, this page alone by `make table`, from the descriptors in `native/techniques/` and a",
        "benchmark; don't edit it by hand.",
        "",
        "| technique | what it does | limits |",
        "| --- | --- | --- |",
    ]
    for info in techniques:
        page = f"[{info['label']}](techniques/{info['id']}.md) (`{info['id']}`)"
        lines.append(make_line([page, info["summary"], info["limits"]]))
    lines += ["", *make_measured_table(techniques, document), ""]
    lines += PICTURES.splitlines()
    for info in techniques:
        lines += ["", *make_section(info)]
    return "\n".join(lines) + "\n"


def main() -> int:
    if len(sys.argv) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    info, document = (json.loads((Path(sys.argv[1]) / name).read_text(encoding="utf-8"))
                      for name in ("info.json", "results.json"))  # fmt: skip
    page = Path(sys.argv[2]) if len(sys.argv) == 3 else root / "docs" / "techniques.md"
    page.write_text(make_page([one for one in info["techniques"] if not one["test_only"]], document), encoding="utf-8")
    print(f"[docs] {page}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
