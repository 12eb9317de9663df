# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow layers from the command line, inside Blender or with the bpy module; `--help` tells all, docs/batch.md more.

blender -b FILE.blend -P addon/batch.py -- VERB [options]
python addon/batch.py FILE.blend VERB [options]
"""

from __future__ import annotations

import contextlib
import importlib
import os
import shutil
import sys
import traceback
from pathlib import Path
from types import ModuleType

HERE = Path(__file__).resolve().parent


def get_own_arguments() -> list[str]:
    """What follows `--` inside Blender; everything for a plain Python."""
    if "--" in sys.argv:
        return sys.argv[sys.argv.index("--") + 1 :]
    return sys.argv[1:] if Path(sys.argv[0]).name == Path(__file__).name else []


def import_package() -> ModuleType:
    """The add-on that this file belongs to, as a package. Nothing of Blender is imported by it."""
    if sys.path and Path(sys.path[0] or ".").resolve() == HERE:
        del sys.path[0]  # the folder of a script; its modules are the package's, not the world's
    if HERE.name in sys.modules or str(HERE.parent) in sys.path:
        return importlib.import_module(HERE.name)
    sys.path.insert(0, str(HERE.parent))
    try:
        return importlib.import_module(HERE.name)
    finally:
        sys.path.remove(str(HERE.parent))


def leave(code: int) -> None:
    """Ends the process at once: Blender 4.5 as a module can hang at the interpreter's exit, and Blender hides exit
    codes of scripts. What Blender would do at its exit is done here: its temporary folder is removed."""
    sys.stdout.flush()
    sys.stderr.flush()
    bpy = sys.modules.get("bpy")
    if bpy is not None:
        with contextlib.suppress(AttributeError):
            folder = Path(bpy.app.tempdir)
            if folder.name.startswith("blender_"):
                shutil.rmtree(folder, ignore_errors=True)
    os._exit(code)


def main() -> int:
    package = import_package().__name__
    options = importlib.import_module(f"{package}.batch_options").parse_arguments(get_own_arguments())
    return importlib.import_module(f"{package}.batch_run").run(options)


if __name__ == "__main__":
    code = 1
    try:
        code = main()
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else 1
    except BaseException:
        traceback.print_exc()
        print("error: internal error, please report it with the lines above", file=sys.stderr)
    finally:
        leave(code)
