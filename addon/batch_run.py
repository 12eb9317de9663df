# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a verb of the batch and turns what goes wrong into one line and an exit code."""

from __future__ import annotations

import argparse
import sys


def run(options: argparse.Namespace) -> int:
    """Exit code: 0 only if everything asked for was written."""
    try:
        import bpy  # noqa: F401
    except ImportError as error:
        print(
            f"error: this Python has no bpy module ({error}): pip install bpy, or run it as "
            "blender -b FILE.blend -P addon/batch.py -- VERB ...",
            file=sys.stderr,
        )
        return 1
    from . import batch_compare, batch_info, batch_render, batch_snapshot
    from .batch_files import BatchError, Progress
    from .batch_scene import register_addon
    from .bridge import ShadowLayersError
    from .snapshot import SnapshotError
    from .truth import TruthError

    verbs = {
        "render": batch_render.run_render,
        "compare": batch_compare.run_compare,
        "snapshot": batch_snapshot.run_snapshot,
        "info": batch_info.run_info,
    }
    progress = Progress(options.verbose)
    try:
        register_addon()
        verbs[options.verb](options, progress)
    except (BatchError, ShadowLayersError, SnapshotError, TruthError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("error: stopped by the keyboard; what was written before is whole", file=sys.stderr)
        return 130
    return 0
