# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The records of a comparison as a short table for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

HEADS = (
    "light",
    "frame",
    "technique",
    "truth",
    "wrong %",
    "bias",
    "MAE",
    "p99 px",
    "acne %",
    "leak %",
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
            format_number(measures["misclassified_fraction"], 4, 100),
            format_number(measures["signed_bias"], 5),
            format_number(measures["mae"], 5),
            format_number(measures["p99_border_distance_px"], 2),
            format_number(measures["acne_fraction"], 4, 100),
            format_number(measures["leak_fraction"], 4, 100),
            format_number(record["total_ms"], 1),
            format_number(record["truth_ms"].get("total"), 1),
        ))  # fmt: skip
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADS))]
    lines = []
    for row in rows:
        cells = (
            cell.ljust(width) if column < TEXT_COLUMNS else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
