# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch's verbs render and snapshot."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from . import bridge, engine, exr_check, jobs
from .batch_done import DoneBefore, Wanted
from .batch_files import BatchError, FileNamer, Progress, make_output_folder, whole_file, write_bytes, write_json
from .batch_scene import get_frames, set_up
from .capture import CapturedFrame, CapturedLayer
from .compare.pictures import make_layer_png, quantise
from .compare.png import encode_png
from .names import COVERAGE_PASS, EXR_NAME_BYTES
from .picture import border_region, literal_path, render_size

RENDER_SCHEMA, RENDER_SCHEMA_VERSION = "shadow-layers-render", 1
CHANNEL_LETTERS = {1: "X", 3: "RGB", 4: "RGBA"}


def get_versions() -> dict[str, Any]:
    """What made the files: at the head of every JSON document."""
    info = bridge.session_info()
    return {
        "shadow_layers": info["version"],
        "revision": info["revision"],
        "blender": bpy.app.version_string,
        "backend": info.get("backend", ""),
        "gl_renderer": info.get("gl_renderer", ""),
        "gl_version": info.get("gl_version", ""),
    }


def render_frame(
    scene: bpy.types.Scene, frame: int, *, aux: Sequence[str] = (), write: bool = False
) -> tuple[list[CapturedFrame], float]:
    """F12 of a frame: what was captured of each view layer, and the wall time in ms. Raises BatchError."""
    scene.frame_set(frame)
    if scene.camera is None:
        raise BatchError(f'scene "{scene.name}" has no camera: choose one in its properties, or give --camera')
    layers = [layer.name for layer in scene.view_layers if layer.use]
    with engine.capture(aux=aux) as captured:
        start = time.perf_counter()
        try:
            bpy.ops.render.render(write_still=write, scene=scene.name)
            message = ""
        except RuntimeError as error:
            message = str(error).strip().removeprefix("Error: ")
        time_ms = (time.perf_counter() - start) * 1000.0
    if captured.errors or message:
        raise BatchError(f"frame {frame}: {(captured.errors or [message])[0]}")
    done = [item.view_layer for item in captured.frames]
    if done != layers:
        raise BatchError(f"frame {frame}: Blender rendered view layers {done} instead of {layers}; see its messages")
    return captured.frames, time_ms


def collect_warnings(frames: Sequence[CapturedFrame]) -> list[str]:
    """Each once, in order; what helps where there is none."""
    warnings = dict.fromkeys(warning for frame in frames for warning in frame.warnings)
    return list(warnings) or ["switch Shadow Layers on in View Layer properties > Passes"]


def set_exr_output(scene: bpy.types.Scene) -> None:
    """Multilayer EXR, float, all passes in one part."""
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format = "OPEN_EXR_MULTILAYER"
    image.color_depth = "32"
    image.exr_codec = "ZIP"
    if hasattr(image, "use_exr_interleave"):
        image.use_exr_interleave = True
    scene.render.use_file_extension = True
    scene.render.use_overwrite, scene.render.use_placeholder = True, False


def check_file(path: Path, final: Path, channels: Sequence[str]) -> None:
    """Raises BatchError unless the file is a whole EXR with all these channels: Blender doesn't tell of a full disk."""
    try:
        header = exr_check.check_exr(path)
        missing = [name for name in channels if name not in header.channels]
        if missing and len(missing[0].encode()) > EXR_NAME_BYTES:
            raise BatchError(
                f'"{final}" was not written: this Blender cuts the channel name "{missing[0]}" to {EXR_NAME_BYTES} '
                "bytes; give the view layer a shorter name"
            )
        problem = f'it has no channel "{missing[0]}"' if missing else ""
    except FileNotFoundError:
        problem = "Blender wrote no file"
    except exr_check.ExrError as error:
        problem = str(error)
    if problem:
        raise BatchError(f'"{final}" was not written: {problem}; free its disk, or choose another with --out')


def get_channel(layer: CapturedLayer, view_layer: str, output: str) -> str:
    """The EXR channels of an output, as `ViewLayer.Shadow Key sm.X`."""
    picture = layer.channels[output]
    letters = CHANNEL_LETTERS[1 if picture.ndim == 2 else picture.shape[2]]
    return f"{view_layer}.{layer.pass_names[output]}.{letters}"


def get_coverage_channel(view_layer: str) -> str:
    return f"{view_layer}.{COVERAGE_PASS}.X"


def sum_times(times: Sequence[dict[str, Any]]) -> dict[str, dict[str, float | None]]:
    """Milliseconds by stage: CPU wall time, and GL time where GL ran (else None)."""
    sums: dict[str, dict[str, float | None]] = {}
    for entry in times:
        stage = sums.setdefault(str(entry["stage"]), {"cpu": 0.0, "gl": None})
        stage["cpu"] = round(float(stage["cpu"] or 0.0) + float(entry["cpu_ms"]), 4)
        if float(entry["gl_ms"]) >= 0:
            stage["gl"] = round(float(stage["gl"] or 0.0) + float(entry["gl_ms"]), 4)
    return sums


def describe_layer(layer: CapturedLayer, light_kind: str, frame: int, view_layer: str) -> dict[str, Any]:
    """What every list says of a layer."""
    return {
        "light": layer.light,
        "light_kind": light_kind,
        "technique": layer.technique,
        "frame": frame,
        "view_layer": view_layer,
        "settings": layer.parameters,
        "time_ms": sum_times(layer.times),
        "total_ms": round(layer.total_ms, 4),
        "counters": layer.counters,
    }


def describe_frame(scene: bpy.types.Scene, frame: CapturedFrame, render_ms: float) -> dict[str, Any]:
    """What every list says of a frame that was just rendered; `render_ms` is all of F12."""
    return {
        "frame": frame.frame,
        "view_layer": frame.view_layer,
        "camera": scene.camera.name,
        "resolution": [frame.snapshot.render.width, frame.snapshot.render.height],
        "region": list(frame.snapshot.render.region),
        "samples": frame.snapshot.render.samples,
        "triangles": frame.snapshot.triangle_count,
        "instances": frame.snapshot.instance_count,
        "render_ms": round(render_ms, 4),
        "time_ms": sum_times(frame.times),
        "addon_ms": {stage: round(value, 4) for stage, value in frame.addon_ms.items()},
        "total_ms": round(frame.total_ms, 4),
        "warnings": frame.warnings,
        "contents": frame.snapshot.contents,
    }


def make_document(schema: str, version: int, scene: bpy.types.Scene) -> dict[str, Any]:
    camera = scene.camera
    return {
        "schema": schema,
        "schema_version": version,
        **get_versions(),
        "file": bpy.path.basename(bpy.data.filepath),
        "scene": scene.name,
        "camera": camera.name if camera else "",
    }


def make_combined_png(combined: np.ndarray) -> bytes:
    """The clay picture (h, w, 4) linear, as sRGB with straight alpha."""
    alpha = np.clip(combined[..., 3:], 0.0, 1.0)
    color = np.clip(combined[..., :3] / np.maximum(alpha, 1e-6), 0.0, 1.0)
    # [IEC 61966-2-1] transfer function of sRGB.
    color = np.where(color <= 0.0031308, 12.92 * color, 1.055 * np.power(color, 1 / 2.4) - 0.055)
    return encode_png(quantise(np.concatenate([color, alpha], axis=2)))


def get_wanted(scene: bpy.types.Scene, layers: Sequence[bpy.types.ViewLayer]) -> Wanted:
    """What a frame's records must hold for the frame to be there already."""
    size = render_size(scene.render)
    region = border_region(scene.render, *size)
    wanted = []
    for layer in layers:
        lights = jobs.predicted_lights(scene, layer)
        for job in jobs.jobs_for(scene, layer, lights):
            settings = bridge.resolve_parameters(job.technique, job.parameters)
            wanted.append((layer.name, lights[job.light].name, job.technique, settings))
    return Wanted(list(size), list(region), scene.shadow_layers.samples, wanted)


class _Outputs:
    """The files of a frame: their names are known only once the layers are."""

    def __init__(self, options: argparse.Namespace, frame: int, layer_count: int) -> None:
        self.folder = options.out
        self._ending = "" if options.frames is None else f"_{frame:04d}"
        self._several_layers = layer_count > 1
        self._namer = FileNamer()

    def get_path(self, *parts: str, suffix: str) -> Path:
        return self.folder / (self._namer.make_name(*parts) + self._ending + suffix)

    def get_layer_path(self, view_layer: str, *parts: str) -> Path:
        return self.get_path(*([view_layer] if self._several_layers else []), *parts, suffix=".png")


def run_render(options: argparse.Namespace, progress: Progress) -> None:
    scene, layers = set_up(options, progress)
    folder = make_output_folder(options.out)
    set_exr_output(scene)
    document = make_document(RENDER_SCHEMA, RENDER_SCHEMA_VERSION, scene)
    document["frames"], document["layers"] = [], []
    json_path = options.json or folder / "render.json"
    make_output_folder(json_path.parent)
    done_before = DoneBefore(json_path, folder, document)
    frames = get_frames(scene, options)
    for index, frame in enumerate(frames):
        label = f"[{index + 1}/{len(frames)}] frame {frame}"
        if options.skip_existing and (found := done_before.find(frame, get_wanted(scene, layers), "layers")):
            progress.say(f"{label}: is there already")
            document["frames"] += found[0]
            document["layers"] += found[1]
            continue
        with progress.step(f"{label}: rendering"):
            frame_records, layer_records = render_and_write(options, scene, frame, len(layers))
        document["frames"] += frame_records
        document["layers"] += layer_records
        # After every frame, so that a run that is stopped can go on with --skip-existing.
        write_json(json_path, {**document, **get_versions()})
    write_json(json_path, {**document, **get_versions()})
    progress.say(f"{len(document['layers'])} layers are in {folder}, listed in {json_path}")


def render_and_write(
    options: argparse.Namespace, scene: bpy.types.Scene, frame: int, layer_count: int
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Renders a frame and writes its EXR and PNGs; the records of its view layers and of its layers."""
    outputs = _Outputs(options, frame, layer_count)
    exr = outputs.get_path("layers", suffix=".exr")
    with whole_file(exr) as temporary:
        scene.render.filepath = literal_path(scene.render, str(temporary))
        captured, render_ms = render_frame(scene, frame, write=True)
        if not any(item.layers for item in captured):  # with several view layers the engine only warns of each
            why = "; ".join(collect_warnings(captured))
            raise BatchError(f"frame {frame}: no view layer has a shadow layer: {why}")
        channels = [get_coverage_channel(item.view_layer) for item in captured]
        for item in captured:
            for layer in item.layers:
                for output in layer.channels:
                    name, _, letters = get_channel(layer, item.view_layer, output).rpartition(".")
                    channels += [f"{name}.{letter}" for letter in letters]
        check_file(temporary, exr, channels)
    frame_records, layer_records = [], []
    for item in captured:
        record = describe_frame(scene, item, render_ms)
        record["file"] = exr.name
        record["coverage_channel"] = get_coverage_channel(item.view_layer)
        if item.combined is not None:
            picture = outputs.get_layer_path(item.view_layer, "combined")
            write_bytes(picture, make_combined_png(item.combined))
            record["picture"] = picture.name
        frame_records.append(record)
        for layer in item.layers:
            kind = item.snapshot.lights[layer.job.light].kind
            for output in layer.channels:
                picture = outputs.get_layer_path(
                    item.view_layer, layer.light, layer.technique, "" if output == "visibility" else output
                )
                write_bytes(picture, make_layer_png(layer.channels[output]))
                layer_records.append({
                    **describe_layer(layer, kind, frame, item.view_layer),
                    "output": output,
                    "file": exr.name,
                    "channel": get_channel(layer, item.view_layer, output),
                    "picture": picture.name,
                })  # fmt: skip
    return frame_records, layer_records
