# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch's verb info: versions, GL, techniques, limits."""

from __future__ import annotations

import argparse
import platform
import sys
from typing import Any

import bpy
import numpy as np

from . import bridge
from .batch_files import Progress, make_output_folder, write_json
from .compare.flip import is_flip_available

INFO_SCHEMA, INFO_SCHEMA_VERSION = "shadow-layers-info", 1


def collect_info(options: argparse.Namespace) -> dict[str, Any]:
    """Raises ShadowLayersError without the native module or a GL back end."""
    bridge.session(options.backend or "auto", options.threads or 0)
    return {
        "schema": INFO_SCHEMA,
        "schema_version": INFO_SCHEMA_VERSION,
        "blender": bpy.app.version_string,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "system": f"{platform.system()} {platform.machine()}",
        "flip": is_flip_available(),
        **bridge.session_info(),
        "techniques": bridge.techniques(),
    }


def format_parameter(parameter: dict[str, Any]) -> str:
    if parameter["type"] == "enum":
        limits = " | ".join(item["id"] for item in parameter["items"])
    elif parameter["type"] == "bool":
        limits = "off | on"
    else:
        limits = f"{parameter['min']:g} to {parameter['max']:g}" + (
            f" {parameter['unit']}" if parameter["unit"] else ""
        )
    return f"{parameter['id']} = {parameter['default']}  ({limits})  {parameter['help']}"


def format_info(info: dict[str, Any]) -> str:
    names = (
        "version", "revision", "blender", "python", "numpy", "system", "backend", "gl_version", "gl_renderer",
        "gl_vendor", "software", "threads", "max_texture_size", "flip",
    )  # fmt: skip
    lines = [f"{name:18}{info[name]}" for name in names if name in info]
    for technique in info["techniques"]:
        lines += ["", f"{technique['id']}: {technique['label']}. {technique['summary']}"]
        lines.append(f"    lights: {', '.join(technique['lights']).lower()}")
        lines.append(f"    reference: {technique['reference']}")
        lines.append(f"    limits: {technique['limits']}")
        lines += [f"    {restriction}" for restriction in technique["restrictions"]]
        lines += [f"    --set {technique['id']}.{format_parameter(p)}" for p in technique["parameters"]]
        lines += [f"    output {o['id']} ({o['channels']} channels): {o['help']}" for o in technique["outputs"]]
    return "\n".join(lines)


def run_info(options: argparse.Namespace, progress: Progress) -> None:
    info = collect_info(options)
    progress.say(format_info(info))
    sys.stdout.flush()
    if options.json is not None:
        make_output_folder(options.json.parent)
        write_json(options.json, info)
