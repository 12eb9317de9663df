# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The report page: one HTML file with all pictures inside. Made of the records that comparison.json holds as well."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

from .measures import MEASURES, MeasureInfo
from .page_assets import SCRIPT, STYLE
from .pictures import DIFFERENCE_COLORS
from .pixels import EXCLUSION_CAUSES
from .temporal_page import make_temporal_section
from .value_pictures import ERROR_COLORS

# Shares of the compared pixels below which a number is shown as good, and above which as bad. For the eye only.
GOOD_FRACTIONS = {
    "misclassified_fraction": (0.002, 0.01),
    "acne_fraction": (0.0005, 0.005),
    "leak_fraction": (0.0005, 0.005),
}
CAUSE_LABELS = {
    "background": "background",
    "not_same_surface": "other surface seen",
    "faces_away": "turned away from the light",
    "outside_cone": "outside the light's cone",
    "not_linked": "not linked to the light",
    "unlit": "not lit by Cycles",
}

SUMMARY_MEASURES = tuple(info for info in MEASURES if not info.is_detail)

NOTHING = "\N{EN DASH}"
TIMES = "\N{MULTIPLICATION SIGN}"
EMPTY_VIEW = '<div class="view"><img alt="truth" draggable="false"></div>'


@dataclass
class TechniqueEntry:
    """One technique's layer: its record (as in comparison.json) and its pictures as PNG."""

    record: Mapping[str, Any]
    layer_png: bytes
    difference_png: bytes


@dataclass
class LightEntry:
    """One light in one frame: its truth and the techniques' layers. `truth`: which one; `truth_label` tells more."""

    name: str
    kind: str
    frame: int
    truth_png: bytes
    techniques: list[TechniqueEntry] = field(default_factory=list)
    truth: str = "hard"
    truth_label: str = "hard: Cycles, the light without size"


def format_measure(info: MeasureInfo, value: float | None) -> str:
    """With its unit: fractions in percent, visibility plain, distances in pixels or texels."""
    if value is None:
        return NOTHING
    if info.unit in ("fraction", "length"):
        return f"{100 * value:.3f} %"
    if info.unit in ("px", "texels"):
        sign = "+" if info.id.startswith("border_bias") else ""
        return f"{value:{sign}.{2 if info.unit == 'px' else 3}f} {info.unit}"
    return f"{value:+.5f}" if info.id == "signed_bias" else f"{value:.5f}"


def format_ms(value: float | None) -> str:
    if value is None:
        return NOTHING
    return f"{value / 1000:.2f} s" if value >= 1000 else f"{value:.1f} ms"


def get_grade(measure_id: str, value: float | None) -> str:
    """CSS class of a number: good, fair or bad; none where there's nothing to judge."""
    if value is None or measure_id not in GOOD_FRACTIONS:
        return ""
    good, bad = GOOD_FRACTIONS[measure_id]
    return "good" if value <= good else "bad" if value > bad else "fair"


def make_image(png: bytes, alternative: str) -> str:
    data = base64.b64encode(png).decode("ascii")
    source = f"data:image/png;base64,{data}"
    return f'<div class="view"><img alt="{escape(alternative)}" src="{source}" draggable="false"></div>'


def make_figure(png: bytes, title: str, caption: str) -> str:
    image = make_image(png, f"{title}: {caption}")
    return f"<figure><figcaption><b>{escape(title)}</b> {escape(caption)}</figcaption>{image}</figure>"


def make_legend(truth: str) -> str:
    colors = DIFFERENCE_COLORS if truth == "hard" else ERROR_COLORS
    items = "".join(f'<li><i style="background:rgb{color}"></i>{escape(label)}</li>' for color, label in colors)
    return f'<ul class="legend">{items}</ul>'


def make_anchor(light_index: int, technique: str) -> str:
    return f"light-{light_index}-{technique}"


def make_summary(lights: Sequence[LightEntry], has_flip: bool) -> str:
    """One row per light and technique, the best of each light's in bold."""
    several_frames = len({light.frame for light in lights}) > 1
    heads = ["Light", *(["Frame"] if several_frames else []), "Technique", "Truth"]
    heads += [info.label for info in SUMMARY_MEASURES] + (["FLIP"] if has_flip else []) + ["Layer", "Cycles", "Ratio"]
    helps = {
        **{info.label: info.help for info in SUMMARY_MEASURES},
        "FLIP": "mean FLIP, 0 to 1",
        "Layer": "time of the layer alone",
        "Cycles": "time of the two renders of the truth",
        "Ratio": "Cycles / layer",
    }
    top = max(
        (entry.record["measures"]["misclassified_fraction"] or 0.0 for light in lights for entry in light.techniques),
        default=0.0,
    )
    rows = []
    for index, light in enumerate(lights):
        best = find_best(light)
        for entry in light.techniques:
            record = entry.record
            link = f'<a href="#{make_anchor(index, record["technique"])}">{escape(record["technique"])}</a>'
            cells = [
                escape(light.name),
                *([str(light.frame)] if several_frames else []),
                link,
                format_truth(light, record),
            ]
            row = "".join(f'<td class="text">{cell}</td>' for cell in cells)
            row += "".join(make_measure_cell(info, record["measures"][info.id], top) for info in SUMMARY_MEASURES)
            if has_flip:
                flip = record.get("flip")
                row += f"<td>{NOTHING if flip is None else f'{flip:.4f}'}</td>"
            row += f"<td>{format_ms(record['total_ms'])}</td><td>{format_ms(record['truth_ms'].get('total'))}</td>"
            row += f"<td>{format_ratio(record)}</td>"
            rows.append(f'<tr class="{"best" if entry is best else ""}">{row}</tr>')
    head = "".join(
        f'<th class="{"" if name in helps else "text"}" title="{escape(helps.get(name, ""))}">{escape(name)}</th>'
        for name in heads
    )
    return (
        f'<div class="scroll"><table class="summary"><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def make_measure_cell(info: MeasureInfo, value: float | None, top: float) -> str:
    bar = ""
    if info.id == "misclassified_fraction" and top > 0:
        width = round(88 * (value or 0.0) / top)
        bar = f'<span class="rail"><span class="bar" style="width:{width}px"></span></span>'
    return f'<td class="{get_grade(info.id, value)}">{format_measure(info, value)}{bar}</td>'


def format_ratio(record: Mapping[str, Any]) -> str:
    """How many times faster the layer was than the truth."""
    truth_ms, layer_ms = record["truth_ms"].get("total"), record["total_ms"]
    return f"{truth_ms / layer_ms:.1f}{TIMES}" if truth_ms and layer_ms else NOTHING


def format_truth(light: LightEntry, record: Mapping[str, Any]) -> str:
    """Which truth, and its own standard error where it has one."""
    error = (record.get("truth") or {}).get("standard_error", {}).get("rms")
    return escape(light.truth) + (f" \N{PLUS-MINUS SIGN} {error:.4f}" if error else "")


def find_best(light: LightEntry) -> TechniqueEntry | None:
    """The technique with the fewest wrong pixels, where there are several to choose from."""
    judged = [e for e in light.techniques if e.record["measures"]["misclassified_fraction"] is not None]
    if len(judged) < 2:
        return None
    return min(judged, key=lambda entry: entry.record["measures"]["misclassified_fraction"])


def make_numbers(record: Mapping[str, Any]) -> str:
    measures = "".join(
        f'<tr title="{escape(info.help)}"><th class="text">{escape(info.label)}</th>'
        f'<td class="{get_grade(info.id, record["measures"][info.id])}">'
        f"{format_measure(info, record['measures'][info.id])}</td></tr>"
        for info in MEASURES
    )
    if record.get("flip") is not None:
        measures += f'<tr><th class="text">FLIP</th><td>{record["flip"]:.4f}</td></tr>'
    measures += make_error_rows(record.get("truth"))
    stages = "<tr><th></th><th>CPU</th><th>GL</th></tr>" + "".join(
        f'<tr><th class="text">{escape(stage)}</th><td>{format_ms(ms["cpu"])}</td><td>{format_ms(ms["gl"])}</td></tr>'
        for stage, ms in record["time_ms"].items()
    )
    stages += f'<tr><th class="text">whole layer</th><td><b>{format_ms(record["total_ms"])}</b></td><td></td></tr>'
    pixels = f'<tr><th class="text">compared</th><td>{record["pixel_count"]:,}</td></tr>' + "".join(
        f'<tr><th class="text">{CAUSE_LABELS[cause]}</th><td>{record["excluded"][cause]:,}</td></tr>'
        for cause in EXCLUSION_CAUSES
        if record["excluded"][cause]
    )
    settings = ", ".join(f"{escape(key)} = {escape(str(value))}" for key, value in record["settings"].items())
    tables = "".join(
        f"<div><h3>{title}</h3><table>{rows}</table></div>"
        for title, rows in (("Measures", measures), ("Times", stages), ("Pixels", pixels))
    )
    return f'<div class="numbers">{tables}</div><details><summary>Settings</summary>{settings}</details>'


def make_error_rows(truth: Mapping[str, Any] | None) -> str:
    """The truth's own standard error, where it has one."""
    if truth is None or not truth["standard_error"]["rms"]:
        return ""
    rows = (("Truth's error, RMS", "rms", "no layer's RMSE can fall below it"),
            ("Truth's error, mean", "bias", "standard error of the bias"))  # fmt: skip
    return "".join(
        f'<tr title="{help_text}"><th class="text">{label}</th><td>{truth["standard_error"][name]:.5f}</td></tr>'
        for label, name, help_text in rows
    )


def make_light_section(index: int, light: LightEntry) -> str:
    """Truth, layer and difference side by side for each technique. The truth is embedded once; the script shows it in
    the other rows."""
    truth = make_figure(light.truth_png, "truth", f"{light.truth_label}; grey is not compared")
    rows = []
    for number, entry in enumerate(light.techniques):
        record = entry.record
        fraction = record["measures"]["misclassified_fraction"]
        wrong = "nothing to compare" if fraction is None else f"{100 * fraction:.3f} % wrong"
        again = f'<figure class="again"><figcaption><b>truth</b></figcaption>{EMPTY_VIEW}</figure>'
        rows.append(
            f'<div class="row" id="{make_anchor(index, record["technique"])}"><h3>{escape(record["technique"])}</h3>'
            f'<div class="three">{truth if number == 0 else again}'
            + make_figure(entry.layer_png, "layer", "1 (white) is lit")
            + make_figure(entry.difference_png, "difference", wrong)
            + f"</div>{make_numbers(record)}</div>"
        )
    first = light.techniques[0].record if light.techniques else {}
    truth_ms = format_ms(first.get("truth_ms", {}).get("total"))
    cached = " (from the cache)" if first.get("truth_cached") else ""
    return (
        f'<section class="card" data-zoom><div class="head"><h2>{escape(light.name)}</h2>'
        f"<span>{escape(light.kind.lower())} light, frame {light.frame}, Cycles mask {truth_ms}{cached}</span></div>"
        f"{make_legend(light.truth)}{''.join(rows)}</section>"
    )


def build_page(
    title: str,
    facts: Mapping[str, Any],
    lights: Sequence[LightEntry],
    notes: Sequence[str] = (),
    temporal: Sequence[Mapping[str, Any]] = (),
) -> str:
    """The whole page. `facts`: label -> value lines under the title; `notes`: sentences for the reader; `temporal`:
    the records of a move, as comparison.json has them."""
    has_flip = any(entry.record.get("flip") is not None for light in lights for entry in light.techniques)
    fact_line = "".join(f"<span>{escape(str(key))} <b>{escape(str(value))}</b></span>" for key, value in facts.items())
    note_lines = "".join(f'<p class="note">{escape(note)}</p>' for note in notes)
    measures = "".join(
        f'<tr><td class="text"><b>{escape(info.label)}</b></td><td class="text">{escape(info.help)}</td></tr>'
        for info in MEASURES
    )
    sections = "".join(make_light_section(index, light) for index, light in enumerate(lights))
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE}</style></head>
<body><header><h1>{escape(title)}</h1><div class="facts">{fact_line}</div></header>
<main><section class="card">{make_summary(lights, has_flip)}{note_lines}
<details><summary>What the columns mean</summary><table>{measures}</table>
<p>Layer: time of the layer alone, without the frame that all layers share; a stage that several techniques share counts
for the first of them. Cycles: its two renders of the visibility mask. Ratio: Cycles / layer. Measures run over the
pixels in which both see the same face and it is turned to the light.</p></details></section>
<p class="note">Click a picture to zoom in, drag to move, wheel to zoom further, <kbd>Esc</kbd> to see it whole. All
pictures of a light move together.</p>
{make_temporal_section(temporal)}{sections}</main>
<footer>Made by Shadow Layers. 1 (white) is lit, 0 (black) in shadow.</footer>
<script>{SCRIPT}</script></body></html>
"""
