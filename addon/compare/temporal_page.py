# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The report page's card on changes from frame to frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from .temporal import TEMPORAL_MEASURES

MOVES = {"light": "the lights moved", "camera": "the camera moved", "frames": "the scene's own frames"}
NOTHING = "\N{EN DASH}"


def describe_move(record: Mapping[str, Any]) -> str:
    step = "" if record["step_deg"] is None else f", {record['step_deg']:g}\N{DEGREE SIGN} each"
    return f"{MOVES[record['move']]}, {record['frames']} frames{step}"


def make_temporal_section(records: Sequence[Mapping[str, Any]]) -> str:
    """A card with one line per light, technique and truth; nothing without records."""
    if not records:
        return ""
    head = "".join(f'<th class="text">{name}</th>' for name in ("Light", "Technique", "Truth"))
    head += "".join(f'<th title="{escape(info.help)}">{escape(info.label)}</th>' for info in TEMPORAL_MEASURES)
    rows = []
    for record in records:
        error = record["truth_standard_error"]
        truth = record["truth"] + (f" \N{PLUS-MINUS SIGN} {error:.4f}" if error else "")
        cells = "".join(
            f'<td class="text">{escape(text)}</td>' for text in (record["light"], record["technique"], truth)
        )
        for info in TEMPORAL_MEASURES:
            value = record["measures"][info.id]
            cells += f"<td>{NOTHING if value is None else f'{value:.5f}'}</td>"
        rows.append(f"<tr>{cells}</tr>")
    meanings = "".join(
        f'<tr><td class="text"><b>{escape(info.label)}</b></td><td class="text">{escape(info.help)}</td></tr>'
        for info in TEMPORAL_MEASURES
    )
    table = f'<table class="summary"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'
    return (
        f'<section class="card"><div class="head"><h2>From frame to frame</h2>'
        f"<span>{escape(describe_move(records[0]))}</span></div>"
        f'<div class="scroll">{table}'
        f"</div><details><summary>What the columns mean</summary><table>{meanings}</table>"
        "<p>D is the change from one frame to the next at the same place of the same surface; s the layer, t the truth."
        "</p></details></section>"
    )
