# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The records of a comparison as short tables for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .temporal import TEMPORAL_MEASURES

HEADS = (
    "light",
    "frame",
    "technique",
    "truth",
    "its error",
    "wrong %",
    "bias",
    "MAE",
    "border MAE",
    "p99 px",
    "acne %",
    "leak %",
    "glow %",
    "shift tx",
    "unbiased px",
    "stair px",
    "stair tx",
    "layer ms",
    "Cycles ms",
)
TEXT_COLUMNS = 4


def format_number(value: float | None, digits: int, scale: float = 1.0) -> str:
    return "-" if value is None else f"{scale * value:.{digits}f}"


def format_table(records: Sequence[Mapping[str, Any]]) -> str:
    """One line per record under a head line; columns aligned."""
    rows = [HEADS]
    for record in records:
        measures = record["measures"]
        rows.append((
            record["light"],
            str(record["frame"]),
            record["technique"],
            record.get("truth", {}).get("kind", "hard"),
            format_number(record.get("truth", {}).get("standard_error", {}).get("rms"), 5),
            format_number(measures["misclassified_fraction"], 4, 100),
            format_number(measures["signed_bias"], 5),
            format_number(measures["mae"], 5),
            format_number(measures["border_mae"], 5),
            format_number(measures["p99_border_distance_px"], 2),
            format_number(measures["acne_fraction"], 4, 100),
            format_number(measures["leak_fraction"], 4, 100),
            format_number(measures["leak_weight"], 4, 100),
            format_number(measures["border_bias_texels"], 3),
            format_number(measures["unbiased_error_px"], 3),
            format_number(measures["staircase_px"], 3),
            format_number(measures["staircase_texels"], 3),
            format_number(record["total_ms"], 1),
            format_number(record["truth_ms"].get("total"), 1),
        ))  # fmt: skip
    return align(rows, TEXT_COLUMNS)


def format_temporal_table(records: Sequence[Mapping[str, Any]]) -> str:
    """One line per record of a move under a head line: what changes from frame to frame beyond the truth."""
    rows = [("light", "technique", "truth", *(info.label for info in TEMPORAL_MEASURES))]
    for record in records:
        numbers = (format_number(record["measures"][info.id], 5) for info in TEMPORAL_MEASURES)
        rows.append((record["light"], record["technique"], record["truth"], *numbers))
    return align(rows, 3)


def align(rows: Sequence[Sequence[str]], text_columns: int) -> str:
    """Columns as wide as their longest cell; the first ones, of text, to the left."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = (
            cell.ljust(width) if column < text_columns else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
