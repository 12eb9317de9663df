# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/measure.py and its rows share: tables, scenes, runs with the bpy module. All goes to out/measure/."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

root = Path(__file__).resolve().parent.parent
out = root / "out" / "measure"
models = root.parent / "shared" / "models"


@dataclass
class Table:
    title: str
    columns: list[str]
    rows: list[list[str]] = field(default_factory=list)
    over: int = 0

    def add(self, *cells: object, good: bool | None = None) -> None:
        verdict = "" if good is None else "ok" if good else "OVER"
        self.over += good is False
        self.rows.append([*(str(cell) for cell in cells), verdict])

    def print(self) -> None:
        widths = [max(len(row[k]) for row in [[*self.columns, ""], *self.rows]) for k in range(len(self.columns) + 1)]
        print(f"\n{self.title}")
        for row in [[*self.columns, ""], *self.rows]:
            print("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def env_python(name: str) -> str:
    command = [root / "scripts" / "setup.sh", "--python", name]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def run(title: str, *arguments: object) -> None:
    """Runs a script with the bpy module; its output goes to out/measure/log.txt and is shown where it fails."""
    print(f"[measure] {title}", flush=True)
    environment = {"SHADOW_LAYERS_NATIVE": str(build_folder() / "python"), **os.environ}
    command = [env_python("bpy45"), *(str(argument) for argument in arguments)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    with (out / "log.txt").open("a", encoding="utf-8") as log:
        log.write(f"$ {' '.join(command)}\n{done.stdout}{done.stderr}\n")
    if done.returncode:
        print("\n".join((done.stdout + done.stderr).splitlines()[-25:]), file=sys.stderr)
        sys.exit(f"[measure] error: {title}: exit code {done.returncode} (above; {out / 'log.txt'})")


def build_folder() -> Path:
    return Path(os.environ.get("SHADOW_LAYERS_BUILD", root / "build" / "release")).resolve()


def make_scene(name: str, script: str, *options: object) -> Path:
    path = out / "scenes" / f"{name}.blend"
    path.parent.mkdir(parents=True, exist_ok=True)
    run(f"making scene {name}", root / "test_scenes" / f"{script}.py", path, *options)
    return path


def make_model(name: str, *options: object) -> Path | None:
    """The scene of a model from the shared folder; None (said in a line) where that is not there."""
    obj = models / f"{name}.obj"
    if not obj.is_file():
        print(f"[measure] {obj} is not there: left out")
        return None
    return make_scene("_".join([name, *(str(o).strip("-") for o in options)]), "model", "--obj", obj, *options)


def in_blender(name: str, *scenes: Path) -> dict:
    path = out / f"{name}.json"
    run(f"measuring {name}", root / "tests" / "blender" / "measure_in_blender.py", name, path, *scenes)
    return json.loads(path.read_text(encoding="utf-8"))


def make_snapshot(scene: Path) -> Path:
    path = out / "snapshots" / f"{scene.stem}.npz"
    folder = path.with_suffix("")
    run(f"exporting {scene.stem}", root / "addon" / "batch.py", scene, "snapshot", "--out", folder)
    return (folder / "snapshot.npz").rename(path)
