# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the Blender suite inside the Blender that executes this file; scripts/run_blender_tests.sh starts it.

    blender -b --factory-startup --python-exit-code 1 -P tests/blender/runner.py -- [pytest options]
    python tests/blender/runner.py [pytest options]            (an environment with the bpy wheel)

The process ends with os._exit: Blender 4.5 as a module can hang at interpreter exit, and an exit code must not get
lost.
"""

import faulthandler
import os
import sys
import traceback
from pathlib import Path

tests_dir = Path(__file__).resolve().parent
root = tests_dir.parent.parent


def own_arguments() -> list[str]:
    """What was meant for this file: after `--` inside Blender, everything for the module."""
    if "--" in sys.argv:
        return sys.argv[sys.argv.index("--") + 1 :]
    return sys.argv[1:] if Path(sys.argv[0]).name == "runner.py" else []


def run() -> int:
    faulthandler.enable()
    try:
        import pytest
    except ImportError as error:
        print(f"runner: pytest is missing in {sys.version.split()[0]} of this Blender: {error}", file=sys.stderr)
        return 2
    import bpy

    print(f"runner: Blender {bpy.app.version_string}, Python {sys.version.split()[0]}", flush=True)
    options = [
        "-p",
        "no:cacheprovider",
        "--rootdir",
        str(root),
        "-c",
        str(root / "pyproject.toml"),
        "-o",
        "addopts=-ra",
    ]
    chosen = own_arguments()
    if not any(Path(argument.split("::")[0]).exists() for argument in chosen if not argument.startswith("-")):
        chosen.append(str(tests_dir))
    return int(pytest.main(options + chosen))


code = 2
try:
    os.chdir(root)
    code = run()
except BaseException:
    traceback.print_exc()
finally:
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
