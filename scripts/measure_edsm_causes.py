# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Why edsm is wrong where it is: rows for scripts/measure.py, and the table of docs/techniques/edsm.md.

The counting is done by a program of tests/bench/, against exact rays, on snapshots of the test scenes.
"""

import subprocess
from collections.abc import Iterable
from pathlib import Path

root = Path(__file__).resolve().parent.parent
kProgram = "edsm_causes"
kScenes = ("box", "jenga", "hall", "studio")
kModels = ("scorpion", "bunny_hr")
kSettings = ("--map-size", "1024,512", "--resolution", "1280x720")


def build_program(build: Path) -> Path:
    """Builds on demand; the folder is then one with tests."""
    commands = (
        ("cmake", "-S", root, "-B", build, "--preset", "release", "-DSHADOW_LAYERS_TESTS=ON"),
        ("cmake", "--build", build, "--target", kProgram),
    )
    for command in commands:
        done = subprocess.run(command, capture_output=True, text=True, cwd=root, check=False)
        if done.returncode:
            raise RuntimeError(f"{kProgram} could not be built:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return build / "tests" / kProgram


def run_program(program: Path, snapshots: Iterable[Path]) -> list[str]:
    """The lines of its Markdown table, printed as they come."""
    lines = []
    command = (program, *snapshots, *kSettings)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            print(line, end="", flush=True)
            lines.append(line.rstrip("\n"))
    if process.returncode:
        raise RuntimeError(f"{kProgram} ended with exit code {process.returncode}")
    return lines


def read_table(lines: list[str]) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of a Markdown table."""
    cells = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    columns, rule, *rows = cells
    if set("".join(rule)) != {"-"} or any(len(row) != len(columns) for row in rows):
        raise ValueError("no Markdown table:\n" + "\n".join(lines))
    return columns, rows


def adds_up(row: list[str]) -> bool:
    """Scene, map size, wrong pixels in a million, those of each cause; all rounded."""
    wrong, *causes = (int(cell) for cell in row[2:])
    return abs(wrong - sum(causes)) <= (len(causes) + 1) / 2
