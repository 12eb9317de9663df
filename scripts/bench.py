#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the tables of bench_grid.toml with shadowcore; JSON and Markdown in out/bench/ (docs/benchmark.md).

    scripts/bench.py [TABLE ...] [--quick]      nothing: all tables; --list names them

Exit code 1: something failed, which is named; the rest was measured. 130: interrupted; what was measured is kept.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import FrameType
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bench_grid
import bench_tables

root = Path(__file__).resolve().parent.parent
INTERRUPTED = 130


class Interrupted(Exception):
    """Ctrl-C, or the process was asked to end."""


def say(text: str) -> None:
    print(f"[bench] {text}", flush=True)


def raise_interrupted(_signal: int, _frame: FrameType | None) -> None:
    raise Interrupted


def run_program(command: list[object], **options: Any) -> subprocess.CompletedProcess:
    """Runs to the end; an interrupt is handed on and waited for, so that nothing works on or is left half written."""
    with subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          start_new_session=True, **options) as process:  # fmt: skip
        try:
            output, _ = process.communicate()
        except BaseException:
            os.killpg(process.pid, signal.SIGINT)
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
            raise
        return subprocess.CompletedProcess(command, process.returncode, output)


def last_line(output: str, code: int) -> str:
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return f"{lines[-1].removeprefix('error: ')} (exit code {code})" if lines else f"exit code {code}"


def write_whole(path: Path, text: str) -> None:
    """The file appears under its name only when it is whole."""
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=".bench-", suffix=path.suffix)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8") as stream:
            stream.write(text)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def describe_machine() -> dict[str, Any]:
    processor = platform.machine()
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            processor = line.split(":", 1)[1].strip()
            break
    pages = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return {
        "processor": processor,
        "threads": len(os.sched_getaffinity(0)),
        "memory_gb": round(pages / 1e9),
        "system": platform.platform(),
        "started": time.strftime("%Y-%m-%d %H:%M:%S %z"),
        "load_before": round(os.getloadavg()[0], 2),
    }


class Bench:
    """Makes the scenes, calls shadowcore for each run, keeps what it says."""

    def __init__(self, options: argparse.Namespace):
        self.out, self.models = options.out, options.models
        self.shadowcore = options.build / "bin" / "shadowcore"
        self.module = options.build / "python"
        self.machine = describe_machine()
        self.failed = 0
        self._snapshots: dict[str, Path] = {}

    def read_techniques(self) -> list[dict]:
        path = self.out / "info.json"
        done = run_program([self.shadowcore, "info", "--json", path])
        if done.returncode:
            raise bench_grid.GridError(f"{self.shadowcore}: {last_line(done.stdout, done.returncode)}")
        info = json.loads(path.read_text(encoding="utf-8"))
        self.machine |= {key: info.get(key, "") for key in ("gl_renderer", "gl_version", "revision")}
        return info["techniques"]

    def measure(self, run: bench_grid.Run) -> dict[str, Any]:
        """The records of a run, or why there are none."""
        entry: dict[str, Any] = {"scene": run.scene.name, "resolution": f"{run.resolution_name} ({run.resolution})"}
        model = self.models / f"{run.scene.model}.obj"
        if run.scene.model and not model.is_file():
            say(f"{run.table}: {model} is not there: scene {run.scene.name} is left out")
            return entry | {"skipped": f"the model {model.name} is not there"}
        say(f"{run.table}: {run.scene.name}, {run.resolution}: {len(run.rows)} rows, {run.repeat} rounds")
        try:
            snapshot = self.make_snapshot(run.scene, model)
            return entry | {"records": self.call(run, snapshot)}
        except RuntimeError as error:
            self.failed += 1
            say(f"error: {run.table}, {run.scene.name}: {error}")
            return entry | {"failed": str(error)}

    def make_snapshot(self, scene: bench_grid.Scene, model: Path) -> Path:
        """Made once a call of this program: generators are quick, and may have changed since."""
        if scene.name not in self._snapshots:
            folder = self.out / "scenes" / scene.name
            folder.mkdir(parents=True, exist_ok=True)
            blend = folder / f"{scene.name}.blend"
            arguments = [*scene.arguments, *(["--obj", model] if scene.model else [])]
            environment = os.environ | {"SHADOW_LAYERS_NATIVE": str(self.module)}
            python = run_program([root / "scripts" / "setup.sh", "--python", "bpy45"]).stdout.strip()
            for command in (
                [python, root / "test_scenes" / f"{scene.script}.py", blend, *arguments],
                [python, root / "addon" / "batch.py", blend, "snapshot", "--out", folder],
            ):
                done = run_program(command, env=environment)
                if done.returncode:
                    raise RuntimeError(f"scene {scene.name}: {last_line(done.stdout, done.returncode)}")
            self._snapshots[scene.name] = folder / "snapshot.npz"
        return self._snapshots[scene.name]

    def call(self, run: bench_grid.Run, snapshot: Path) -> list[dict]:
        rows, result = self.out / ".rows.json", self.out / ".records.json"
        write_whole(rows, json.dumps([{"technique": row.technique, "settings": row.settings, "name": row.method}
                                      for row in run.rows]))  # fmt: skip
        command = [self.shadowcore, "bench", snapshot, "--rows", rows, "--resolution", run.resolution, "--samples", 1,
                   "--repeat", run.repeat, "--warm-up", run.warm_up, "--json", result]  # fmt: skip
        try:
            done = run_program([*command, *(["--errors"] if run.errors else [])])
            if done.returncode:
                raise RuntimeError(last_line(done.stdout, done.returncode))
            document = json.loads(result.read_text(encoding="utf-8"))
        finally:
            rows.unlink(missing_ok=True)
            result.unlink(missing_ok=True)
        self.machine |= {key: document[key] for key in ("gl_renderer", "gl_version", "revision")}
        records = document["records"]
        if len(records) != len(run.rows):
            raise RuntimeError(f"{len(run.rows)} rows were asked for, {len(records)} came: a technique serves no light")
        for record, row in zip(records, run.rows, strict=True):
            record |= {"method": row.method, "place": row.place}
        return records


def parse_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("tables", nargs="*", metavar="TABLE", help="ids of tables (default: all)")
    add("--quick", action="store_true", help="the quick form of the tables that have one: under two minutes")
    add("--list", action="store_true", help="name the tables and what they hold")
    add("--grid", type=Path, default=root / "scripts" / "bench_grid.toml", help="what to measure")
    add("--out", type=Path, default=root / "out" / "bench", help="folder (default: out/bench)")
    add("--models", type=Path, default=root.parent / "shared" / "models", help="folder of the OBJ models")
    default = Path(os.environ.get("SHADOW_LAYERS_BUILD", root / "build" / "release"))
    add("--build", type=Path, default=default, help="build folder (default: SHADOW_LAYERS_BUILD or build/release)")
    options = parser.parse_args()
    options.out, options.build = options.out.resolve(), options.build.resolve()
    return options


def write_results(bench: Bench, tables: list[dict], state: str) -> None:
    bench.machine["load_after"] = round(os.getloadavg()[0], 2)
    document = {"schema": "shadow-layers-bench-tables", "schema_version": 1, "state": state, "machine": bench.machine,
                "tables": tables}  # fmt: skip
    write_whole(bench.out / "results.json", json.dumps(document, indent=1) + "\n")
    write_whole(bench.out / "results.md", bench_tables.make_page(document))


def main() -> int:
    options = parse_options()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, raise_interrupted)
    options.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(options)
    tables: list[dict] = []
    try:
        grid = bench_grid.read_grid(options.grid)
        plan = bench_grid.lay_out(grid, techniques=bench.read_techniques(), only=options.tables, quick=options.quick)
        if options.list:
            for table in plan:
                print(f"{table.name:24} {table.title}; {sum(len(run.rows) for run in table.runs)} rows")
            return 0
        for table in plan:
            for method in table.missing:
                say(f"{table.name}: {method} is missing in this build")
            entry = {"id": table.name, "title": table.title, "missing": table.missing, "against": table.against,
                     "runs": []}  # fmt: skip
            tables.append(entry)
            for run in table.runs:
                entry["runs"].append(bench.measure(run))
    except bench_grid.GridError as error:
        print(f"[bench] error: {error}", file=sys.stderr)
        return 2
    except Interrupted:
        write_results(bench, tables, "interrupted")
        say(f"interrupted; what was measured is in {options.out}/")
        return INTERRUPTED
    write_results(bench, tables, "failures" if bench.failed else "whole")
    say(f"results in {options.out}/results.md and results.json" + (f"; {bench.failed} failed" if bench.failed else ""))
    return 1 if bench.failed else 0


if __name__ == "__main__":
    sys.exit(main())
