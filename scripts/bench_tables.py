# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Markdown of a benchmark: one table per table of the grid, scene and resolution, from shadowcore's records."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

STAGES_SHOWN = 5  # the longest ones of a layer
FRAME_PREFIX = "frame: "


def make_page(document: dict[str, Any]) -> str:
    """All of a document as bench.py writes it: the machine's facts, then the tables."""
    lines = ["# Benchmark", "", *make_facts(document["machine"]), ""]
    if document["state"] != "whole":
        lines += [f"**Not whole: {document['state']}.**", ""]
    lines += [
        "Times in ms: median (lower, upper quartile) of whole frames with one technique. Ratios are taken round by",
        "round against `sm` with the same map size in the same run, which takes turns with the others. Own: mean",
        "distance to what the technique approximates; wrong: pixels on the wrong side of one half of the hard mask;",
        "both in percent of the pixels that face the light, against exact rays. Stages: the longest of the layer.",
    ]
    for table in document["tables"]:
        lines += ["", f"## {table['title']}", "", f"`{table['id']}`"]
        if table["missing"]:
            lines += ["", f"Missing, not in this build: {', '.join(table['missing'])}."]
        for run in table["runs"]:
            lines += ["", *make_run(run, table.get("against", []))]
    return "\n".join(lines) + "\n"


def make_facts(machine: dict[str, Any]) -> list[str]:
    names = {
        "processor": "processor", "threads": "threads", "memory_gb": "memory (GB)", "system": "system",
        "gl_renderer": "GL renderer", "gl_version": "GL version", "revision": "revision", "started": "started",
        "load_before": "load before", "load_after": "load after",
    }  # fmt: skip
    facts = [(text, machine[key]) for key, text in names.items() if machine.get(key) not in (None, "")]
    return ["| machine | |", "| --- | --- |", *(f"| {text} | {value} |" for text, value in facts)]


def make_run(run: dict[str, Any], against: Sequence[str] = ()) -> list[str]:
    """Heading, head and rows of one scene in one resolution, or why there are none."""
    head = f"### {run['scene']}, {run['resolution']}"
    if run.get("skipped"):
        return [head, "", f"Left out: {run['skipped']}."]
    if run.get("failed"):
        return [head, "", f"Failed: {run['failed']}."]
    records = run["records"]
    axes = list(dict.fromkeys(axis for record in records for axis in record["place"]))
    with_errors = any(record["errors"] for record in records)
    columns = [
        "technique",
        *axes,
        "render",
        "ratio",
        *(f"to {name}" for name in against),
        "layer ratio",
        "resolve ratio",
    ]
    columns += ["own", "truth", "wrong"] if with_errors else []
    with_borders = any(describe_border(record["errors"]) for record in records)
    columns += ["border"] if with_borders else []
    columns.append("stages")
    lines = [f"{head}, {records[0]['triangles']:,} triangles, {records[0]['render_ms']['count']} rounds", ""]
    lines += [make_line(columns), make_line(["---"] * len(columns))]
    for record in records:
        others = [compute_ratio(record, records, name) for name in against]
        lines.append(make_line(make_cells(record, axes, others, with_errors, with_borders)))
    return lines


def compute_ratio(record: dict[str, Any], records: Sequence[dict[str, Any]], method: str) -> float | None:
    """The record's median by that of another method at the same place, as far as both have the axes."""
    for other in records:
        shared = set(record["place"]) & set(other["place"])
        if other["method"] == method and all(record["place"][axis] == other["place"][axis] for axis in shared):
            return record["render_ms"]["median"] / other["render_ms"]["median"]
    return None


def make_line(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def make_cells(
    record: dict[str, Any], axes: list[str], others: Sequence[float | None], with_errors: bool, with_borders: bool
) -> list[str]:
    cells = [f"`{record['method']}`", *(str(record["place"].get(axis, "")) for axis in axes)]
    cells.append(describe_spread(record["render_ms"], 1))
    ratio = record["ratio_to_sm_spread"]
    cells.append(describe_spread(ratio, 2) if ratio else "")
    cells += [describe_number(value, 2) for value in others]
    cells.append(describe_number(record["layers_ratio_to_sm"], 2))
    cells.append(describe_number(record["stage_ratio_to_sm"].get("resolve"), 2))
    if with_errors:
        cells += describe_errors(record["errors"])
    if with_borders:
        cells.append(describe_border(record["errors"]))
    cells.append(describe_stages(record["stage_ms"]))
    return cells


def describe_spread(spread: dict[str, float], digits: int) -> str:
    low, high = (f"{spread[key]:.{digits}f}" for key in ("quartile_1", "quartile_3"))
    return f"{spread['median']:.{digits}f} ({low}, {high})"


def describe_number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def describe_errors(errors: dict[str, Any] | None) -> list[str]:
    if not errors:
        return ["", "", ""]
    truth = errors["truth"]
    if truth == "filtered":
        world = errors["footprint_world"]
        truth += f" {world:.3g} units" if world > 0 else f" {errors['footprint_texels']:.3g} texels"
    return [f"{100 * errors['own']['mean_absolute']:.3f}", truth, f"{100 * errors['hard']['wrong_fraction']:.3f}"]


def describe_border(errors: dict[str, Any] | None) -> str:
    """Mean error of the pixels whose truth is neither 0 nor 1; of antialiased layers alone."""
    if not errors or errors["truth"] != "pixel":
        return ""
    share = errors["own"]["border_mean_absolute"]
    return describe_number(None if share is None else 100 * share, 2)


def describe_stages(stages: dict[str, dict[str, float]]) -> str:
    own = {name: spread["median"] for name, spread in stages.items() if not name.startswith(FRAME_PREFIX)}
    longest = sorted(own, key=lambda name: -own[name])[:STAGES_SHOWN]
    return " · ".join(f"{name} {own[name]:.1f}" for name in longest)
