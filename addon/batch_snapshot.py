# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch's verb snapshot: the exported scene as a file (docs/snapshot.md)."""

from __future__ import annotations

import argparse

from .batch_files import BatchError, FileNamer, Progress, describe_os_error, make_output_folder, write_json
from .batch_render import get_versions, render_frame
from .batch_scene import get_frames, set_up

SNAPSHOT_SCHEMA, SNAPSHOT_SCHEMA_VERSION = "shadow-layers-snapshots", 1


def run_snapshot(options: argparse.Namespace, progress: Progress) -> None:
    """Writes a snapshot for each frame and view layer. The scene is exported as for a render, so it is rendered too:
    what can't be rendered is said here and not where the file is used."""
    scene, layers = set_up(options, progress)
    folder = make_output_folder(options.out)
    namer = FileNamer()
    records = []
    frames = get_frames(scene, options)
    for index, frame in enumerate(frames):
        with progress.step(f"[{index + 1}/{len(frames)}] frame {frame}: exporting"):
            captured, _ = render_frame(scene, frame)
        for item in captured:
            parts = ["snapshot", item.view_layer if len(layers) > 1 else "", f"{frame:04d}" if options.frames else ""]
            path = folder / (namer.make_name(*parts) + ".npz")
            try:
                item.snapshot.save(path)
            except OSError as error:
                raise BatchError(
                    f'"{path}" can not be written: {describe_os_error(error)}; choose another folder with --out, '
                    "or free its disk"
                ) from error
            records.append({
                "file": path.name,
                "frame": frame,
                "view_layer": item.view_layer,
                "triangles": item.snapshot.triangle_count,
                "instances": item.snapshot.instance_count,
                "lights": [light.name for light in item.snapshot.lights],
                "warnings": item.snapshot.warnings,
            })  # fmt: skip
    if options.json is not None:
        make_output_folder(options.json.parent)
        document = {"schema": SNAPSHOT_SCHEMA, "schema_version": SNAPSHOT_SCHEMA_VERSION, **get_versions()}
        write_json(options.json, {**document, "snapshots": records})
    progress.say(f"{len(records)} snapshots are in {folder}")
