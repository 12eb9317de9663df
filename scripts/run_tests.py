#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every suite, two at a time where they leave a core idle, and says what passed, failed and was skipped.

    scripts/run_tests.py [STEP ...]        (nothing: all of them; --list names them)

A suite that runs no test counts as failed. A failure does not keep the later suites from running. The full output of
each is in build/test-logs/. The exit code is 0 only when every suite passed.
"""

import argparse
import os
import re
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

root = Path(__file__).resolve().parent.parent
build = Path(os.environ.get("SHADOW_LAYERS_BUILD", root / "build" / "release")).resolve()
logs = root / "build" / "test-logs"
kAtOnce = 2
kQuietS = 30.0  # a line of progress is printed at least this often


@dataclass
class Step:
    name: str
    title: str
    command: list[str]
    kind: str  # "check": exit code alone; "pytest" and "gtest": counted
    parts: tuple[str, ...] = ()  # of scripts/setup.sh
    needs_build: bool = True
    alone: bool = False  # uses all cores by itself


@dataclass
class Outcome:
    step: Step
    passed: int = 0
    failed: int = 0
    skipped: int = 0
    seconds: float = 0.0
    notes: list[str] = field(default_factory=list)

    @property
    def good(self) -> bool:
        return self.failed == 0 and self.passed > 0


def env_python(name: str) -> str:
    return subprocess.run(
        [root / "scripts" / "setup.sh", "--python", name], check=True, capture_output=True, text=True
    ).stdout.strip()


def make_steps() -> list[Step]:
    tools, numpy2 = env_python("tools"), env_python("numpy2")
    scripts = f"{root / 'scripts'}/"
    blender = scripts + "run_blender_tests.sh"
    pytest = ["-m", "pytest", "-p", "no:cacheprovider"]
    return [
        Step("ruff", "Python style", [tools, "-m", "ruff", "check", "."], "check", ("build",), False),
        Step("format", "C++ layout", [scripts + "format.sh", "--check"], "check", ("test",), False),
        Step("core", "core, without GL and with", ["ctest", "--test-dir", str(build), "--verbose", "-j2"],
             "gtest", ("test",), alone=True),
        Step("python", "Python outside Blender", [tools, *pytest, "tests/python"], "pytest", ("test",)),
        Step("numpy2", "native module with NumPy 2", [numpy2, *pytest, *sorted(
            str(p.relative_to(root)) for p in (root / "tests" / "python").glob("test_module*.py"))],
            "pytest", ("test",)),
        Step("blender-3.4", "inside Blender 3.4 (Debian)", [blender, "3.4"], "pytest", ("blender", "test")),
        Step("blender-4.5", "inside Blender 4.5 (module)", [blender, "4.5"], "pytest", ("bpy45",)),
        Step("blender-5.0", "inside Blender 5.0 (module)", [blender, "5.0"], "pytest", ("bpy50",)),
    ]  # fmt: skip


def run_logged(step: Step) -> tuple[int, str, float]:
    """Runs the command into its log; prints a line now and then so that nobody thinks it hangs."""
    log = logs / f"{step.name}.log"
    started = time.monotonic()
    with log.open("w", encoding="utf-8", errors="replace") as out:
        process = subprocess.Popen(step.command, cwd=root, stdout=out, stderr=subprocess.STDOUT)
        done = threading.Event()

        def tell() -> None:
            while not done.wait(kQuietS):
                lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
                last = lines[-1][-90:] if lines else "starting"
                print(f"  … {step.name}: {time.monotonic() - started:.0f} s: {last}", flush=True)

        teller = threading.Thread(target=tell, daemon=True)
        teller.start()
        code = process.wait()
        done.set()
        teller.join()
    return code, log.read_text(encoding="utf-8", errors="replace"), time.monotonic() - started


def count_pytest(text: str) -> dict[str, int]:
    """Numbers of pytest's closing line ("3 failed, 10 passed, 2 skipped in 4.56s")."""
    closing = [
        line
        for line in text.splitlines()
        if re.search(r"\b(passed|failed|error|errors|skipped|no tests ran)\b.* in [\d.]+s", line)
    ]
    counts = dict.fromkeys(("passed", "failed", "skipped", "error"), 0)
    if closing:
        for number, word in re.findall(r"(\d+) (passed|failed|skipped|error)", closing[-1]):
            counts[word] = int(number)
    return counts


def count_gtest(text: str) -> dict[str, int]:
    """Numbers of the lines that GoogleTest prints as each test ends, in ctest's verbose output."""
    words = re.findall(r"^\d+: \[ +(OK|FAILED|SKIPPED) +\] .* \(\d+ ms\)$", text, re.M)
    return {"passed": words.count("OK"), "failed": words.count("FAILED"), "skipped": words.count("SKIPPED"), "error": 0}


def judge(step: Step, code: int, text: str, seconds: float) -> Outcome:
    outcome = Outcome(step, seconds=seconds)
    if step.kind == "check":
        outcome.passed, outcome.failed = (1, 0) if code == 0 else (0, 1)
        return outcome
    counts = count_pytest(text) if step.kind == "pytest" else count_gtest(text)
    outcome.passed, outcome.skipped = counts["passed"], counts["skipped"]
    outcome.failed = counts["failed"] + counts["error"]
    if outcome.passed + outcome.failed == 0:
        outcome.failed = 1
        outcome.notes.append("no test ran")
    elif code != 0 and outcome.failed == 0:
        outcome.failed = 1
        outcome.notes.append(f"ended with exit code {code} though no test failed (a crash?)")
    outcome.notes += sorted(set(re.findall(r"^SKIPPED .*$", text, re.M)))
    outcome.notes += re.findall(r"^\d+: (\[  FAILED  \] .* \(\d+ ms\))$", text, re.M)
    return outcome


def prepare(steps: list[Step]) -> bool:
    """Installs and builds what the steps need. False (with the reason printed) where that fails."""
    parts = sorted({part for step in steps for part in step.parts} | {"build", "test"})
    if subprocess.run([root / "scripts" / "setup.sh", *parts], check=False).returncode:
        return False
    if any(step.needs_build for step in steps):
        return subprocess.run([root / "scripts" / "build.sh", "--tests"], check=False).returncode == 0
    return True


def report(outcomes: list[Outcome]) -> int:
    print("\n=== tests: summary ===")
    for outcome in outcomes:
        word = "ok    " if outcome.good else "FAILED"
        numbers = f"{outcome.passed} passed, {outcome.failed} failed, {outcome.skipped} skipped"
        print(f"{word} {outcome.step.name:12} {numbers:42} {outcome.seconds:6.0f} s   {outcome.step.title}")
    for outcome in outcomes:
        for note in outcome.notes:
            print(f"  {outcome.step.name}: {note}")
    totals = [sum(getattr(outcome, name) for outcome in outcomes) for name in ("passed", "failed", "skipped")]
    bad = [outcome.step.name for outcome in outcomes if not outcome.good]
    if bad:
        print(f"failed: {', '.join(bad)} (logs in {logs.relative_to(root)}/)")
    print(f"{totals[0]} passed, {totals[1]} failed, {totals[2]} skipped", flush=True)
    return 1 if bad else 0


def run_step(step: Step) -> Outcome:
    print(f"=== tests: {step.name}: {step.title} ===", flush=True)
    outcome = judge(step, *run_logged(step))
    lines = []
    if not outcome.good:
        lines = (logs / f"{step.name}.log").read_text(encoding="utf-8", errors="replace").splitlines()[-60:]
    reported = f"{step.name}: {outcome.passed} passed, {outcome.failed} failed, {outcome.skipped} skipped"
    print("\n".join([*lines, reported]), flush=True)
    return outcome


def run_all(steps: list[Step]) -> list[Outcome]:
    """Those that use all cores one after the other, then the rest, kAtOnce at a time: Python and Blender's own work
    keep one core busy. Outcomes are in the order of the steps."""
    outcomes = {step.name: run_step(step) for step in steps if step.alone}
    rest = [step for step in steps if not step.alone]
    with ThreadPoolExecutor(kAtOnce) as pool:
        outcomes |= dict(zip((step.name for step in rest), pool.map(run_step, rest), strict=True))
    return [outcomes[step.name] for step in steps]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("steps", nargs="*", metavar="STEP", help="suites to run (default: all)")
    parser.add_argument("--list", action="store_true", help="name the suites and end")
    options = parser.parse_args()
    steps = make_steps()
    if options.list:
        print("\n".join(f"{step.name:12} {step.title}" for step in steps))
        return 0
    unknown = set(options.steps) - {step.name for step in steps}
    if unknown:
        parser.error(f"no suite {', '.join(sorted(unknown))}; --list names them")
    if options.steps:
        steps = [step for step in steps if step.name in options.steps]
    logs.mkdir(parents=True, exist_ok=True)
    if not prepare(steps):
        print("tests: could not install or build what the tests need (above)")
        print("0 passed, 1 failed, 0 skipped", flush=True)
        return 1
    wanted = {step.name for step in steps}
    return report(run_all([step for step in make_steps() if step.name in wanted]))


if __name__ == "__main__":
    sys.exit(main())
