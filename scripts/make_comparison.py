#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the figures of comparison_figures.toml side by side and writes docs/comparison.md around them.

    scripts/make_comparison.py [FIGURE ...]     some figures alone leave the page as it is

Layers come from shadowcore, truths from Cycles; techniques that are not in the build are left out and named.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import tomllib

root = Path(__file__).resolve().parent.parent
GAP_PX, GROUND, FONT = 3, "#8a8f98", "DejaVu-Sans"
LARGEST_BYTES, LARGEST_TOTAL_BYTES = 150_000, 1_500_000


class FigureError(Exception):
    """A figure cannot be drawn; the text names it and why."""


def say(text: str) -> None:
    print(f"[comparison] {text}", flush=True)


def call(where: str, *command: object, **environment: str) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False,
                          env=os.environ | environment)  # fmt: skip
    if done.returncode:
        lines = (done.stdout + done.stderr).strip().splitlines() or [f"exit code {done.returncode}"]
        raise FigureError(f"{where}: {Path(str(command[0])).name}: {lines[-1]}")
    return done.stdout


def read_figures(path: Path) -> list[dict[str, Any]]:
    """Raises FigureError naming what is wrong."""
    try:
        figures = tomllib.loads(path.read_text(encoding="utf-8"))["figures"]
    except (OSError, tomllib.TOMLDecodeError, KeyError) as error:
        raise FigureError(f"{path} cannot be used: {error}") from None
    needed = ("id", "title", "scene", "look", "settings", "crop", "zoom", "columns", "panels")
    for figure in figures:
        missing = [key for key in needed if key not in figure]
        name = figure.get("id", "?")
        if missing:
            raise FigureError(f"{path}: figure {name}: {', '.join(missing)} is missing")
        for panel in figure["panels"]:
            if ("technique" in panel) == ("truth" in panel):
                raise FigureError(f"{path}: figure {name}: {panel} is neither a technique nor a truth")
    return figures


def choose_settings(figure: dict[str, Any], panel: dict[str, Any], technique: dict) -> dict[str, Any]:
    """The figure's settings that the technique has, under the panel's own. FigureError for one it does not have."""
    names = {parameter["id"] for parameter in technique["parameters"]}
    own = panel.get("settings", {})
    unknown = sorted(set(own) - names)
    if unknown:
        raise FigureError(f"figure {figure['id']}: {technique['id']} has no parameter {', '.join(unknown)}")
    return {key: value for key, value in figure["settings"].items() if key in names} | own


def make_label(panel: dict[str, Any], settings: dict[str, Any]) -> str:
    if "label" in panel:
        return panel["label"]
    shown = {key: value for key, value in settings.items() if key not in ("map_size", "source", "penumbra_from")}
    words = ", ".join(f"{key} {value}" for key, value in shown.items())
    return f"{panel['technique']}{' · ' if words else ''}{words}"


class Painter:
    """Makes scenes, layers and truths, each once, and puts crops of them together."""

    def __init__(self, options: argparse.Namespace, folder: Path):
        self.folder, self.build, self.images = folder, options.build, options.images
        self.shadowcore = options.build / "bin" / "shadowcore"
        self.python = call("the environment", root / "scripts" / "setup.sh", "--python", "bpy45").strip()
        info = folder / "info.json"
        call("shadowcore", self.shadowcore, "info", "--json", info)
        listed = json.loads(info.read_text(encoding="utf-8"))["techniques"]
        self.techniques = {entry["id"]: entry for entry in listed if not entry["test_only"]}
        self._scenes: dict[tuple, Path] = {}
        self._truths: dict[tuple, Path] = {}

    def paint(self, figure: dict[str, Any]) -> dict[str, Any]:
        """The figure's file and what its panels show."""
        panels, missing, tiles = [], [], []
        for number, panel in enumerate(figure["panels"]):
            if "technique" in panel and panel["technique"] not in self.techniques:
                missing.append(panel["technique"])
                continue
            settings = {}
            if "truth" in panel:
                picture = self.find_truth(figure, panel["truth"])
            else:
                settings = choose_settings(figure, panel, self.techniques[panel["technique"]])
                picture = self.render(figure, panel["technique"], settings, number)
            label = make_label(panel, settings)
            tiles += ["-label", label, picture]
            panels.append({"label": label, "settings": settings, "technique": panel.get("technique", "")})
        if not tiles:
            raise FigureError(f"figure {figure['id']}: none of its techniques is in this build")
        path = self.put_together(figure, tiles)
        return {"figure": figure, "file": path.name, "panels": panels, "missing": list(dict.fromkeys(missing))}

    def make_scene(self, figure: dict[str, Any]) -> Path:
        arguments = figure.get("arguments", [])
        key = (figure["scene"], *arguments)
        if key not in self._scenes:
            say(f"scene {' '.join(key)}")
            folder = self.folder / "_".join(key).replace("-", "")
            blend = folder / "scene.blend"
            where, module = f"scene {figure['scene']}", str(self.build / "python")
            script = root / "test_scenes" / f"{figure['scene']}.py"
            call(where, self.python, script, blend, *arguments)
            batch = root / "addon" / "batch.py"
            call(where, self.python, batch, blend, "snapshot", "--out", folder, SHADOW_LAYERS_NATIVE=module)
            self._scenes[key] = blend
        return self._scenes[key]

    def render(self, figure: dict[str, Any], technique: str, settings: dict[str, Any], number: int) -> Path:
        where = f"figure {figure['id']}, {technique}"
        out = self.folder / figure["id"] / str(number)
        words = [("true" if value else "false") if isinstance(value, bool) else value for value in settings.values()]
        options = [f"{technique}.{key}={word}" for key, word in zip(settings, words, strict=True)]
        given = [part for option in options for part in ("--set", option)]
        snapshot = self.make_scene(figure).parent / "snapshot.npz"
        chosen = ("--techniques", technique, "--samples", 1, *given)
        call(where, self.shadowcore, "render", snapshot, *chosen, "--out", out)
        layers = json.loads((out / "render.json").read_text(encoding="utf-8"))["layers"]
        return out / next(layer["picture"] for layer in layers if layer["output"] == "visibility")

    def find_truth(self, figure: dict[str, Any], kind: str) -> Path:
        blend = self.make_scene(figure)
        key = (blend, kind)
        if key not in self._truths:
            say(f"the {kind} truth of {figure['scene']}, by Cycles")
            out = blend.parent / f"truth_{kind}"
            call(f"the {kind} truth of {figure['scene']}", self.python, root / "addon" / "batch.py", blend, "compare",
                 "--techniques", "sm", "--truth", kind, "--border-samples", 1, "--out", out,
                 SHADOW_LAYERS_NATIVE=str(self.build / "python"))  # fmt: skip
            records = json.loads((out / "comparison.json").read_text(encoding="utf-8"))["records"]
            self._truths[key] = out / records[0]["truth_picture"]
        return self._truths[key]

    def put_together(self, figure: dict[str, Any], tiles: list[object]) -> Path:
        width, height, left, top = figure["crop"]
        path, made = self.images / f"compare_{figure['id']}.png", self.folder / f"{figure['id']}.png"
        call(f"figure {figure['id']}", "montage", "-font", FONT, "-pointsize", 13, *tiles,
             "-crop", f"{width}x{height}+{left}+{top}", "+repage", "-filter", "point", "-resize",
             f"{100 * figure['zoom']}%", "-tile", f"{figure['columns']}x", "-geometry", f"+{GAP_PX}+{GAP_PX}",
             "-background", GROUND, "-colorspace", "gray", "-type", "Grayscale", "-depth", 8, "-strip",
             "-define", "png:compression-level=9", made)  # fmt: skip
        size = made.stat().st_size
        if size > LARGEST_BYTES:
            raise FigureError(
                f"figure {figure['id']} takes {size:,} bytes, more than {LARGEST_BYTES:,}: crop it smaller"
            )
        self.images.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        shutil.copyfile(made, part)
        part.replace(path)
        say(f"{path.name}: {size // 1024} KiB")
        return path


def make_page(drawn: list[dict[str, Any]]) -> str:
    """docs/comparison.md."""
    lines = [
        "# The techniques side by side",
        "",
        "Made by `make docs` from `scripts/comparison_figures.toml`; don't edit it by hand. Every panel is a layer",
        "(white: lit) of the same part of a 1280 x 720 picture, one sample a pixel, enlarged without smoothing; the",
        "truth is Cycles' (grey: not compared). Measured: [benchmark.md](benchmark.md).",
    ]
    for entry in drawn:
        figure = entry["figure"]
        lines += ["", f"## {figure['title']}", "", f"![{figure['title']}](images/{entry['file']})", ""]
        lines += [figure["look"].strip(), ""]
        shared = ", ".join(f"`{key}` {value}" for key, value in figure["settings"].items())
        arguments = " ".join(figure.get("arguments", []))
        lines.append(
            f"Scene `{figure['scene']}`{f' ({arguments})' if arguments else ''}; {shared}. Panels, row by row:"
        )
        lines += ["", *describe_panels(entry["panels"], figure["settings"])]
        if entry["missing"]:
            lines += ["", f"Not in this build: {', '.join(entry['missing'])}."]
    return "\n".join(lines) + "\n"


def describe_panels(panels: list[dict[str, Any]], shared: dict[str, Any]) -> list[str]:
    words = []
    for panel in panels:
        own = {key: value for key, value in panel["settings"].items() if shared.get(key) != value}
        name = f"`{panel['technique']}`" if panel["technique"] else panel["label"]
        words.append(name + (f" ({', '.join(f'{key} {value}' for key, value in own.items())})" if own else ""))
    return [f"{'; '.join(words)}."]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("figures", nargs="*", metavar="FIGURE", help="ids (default: all, and the page)")
    add("--list", type=Path, default=root / "scripts" / "comparison_figures.toml", help="the figures")
    add("--images", type=Path, default=root / "docs" / "images", help="folder of the pictures")
    default = Path(os.environ.get("SHADOW_LAYERS_BUILD", root / "build" / "release"))
    add("--build", type=Path, default=default, help="build folder (default: SHADOW_LAYERS_BUILD or build/release)")
    options = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):  # so that the temporary folder goes, and the program at work
        signal.signal(number, lambda *_: sys.exit("[comparison] interrupted"))
    options.build = options.build.resolve()
    try:
        figures = read_figures(options.list)
        names = [figure["id"] for figure in figures]
        unknown = [name for name in options.figures if name not in names]
        if unknown:
            raise FigureError(f"there is no figure {', '.join(unknown)}; there are {', '.join(names)}")
        with tempfile.TemporaryDirectory(prefix="shadow-layers-") as folder:
            painter = Painter(options, Path(folder))
            drawn = [painter.paint(figure) for figure in figures if figure["id"] in (options.figures or names)]
        total = sum(path.stat().st_size for path in options.images.glob("compare_*.png"))
        if total > LARGEST_TOTAL_BYTES:
            raise FigureError(f"the pictures take {total:,} bytes together, more than {LARGEST_TOTAL_BYTES:,}")
    except FigureError as error:
        print(f"[comparison] error: {error}", file=sys.stderr)
        return 1
    for entry in drawn:
        for name in entry["missing"]:
            say(f"figure {entry['figure']['id']}: {name} is not in this build")
    if not options.figures:
        page = options.images.parent / "comparison.md"
        page.with_suffix(".part").write_text(make_page(drawn), encoding="utf-8")
        page.with_suffix(".part").replace(page)
        say(f"{page}; the pictures take {total // 1024} KiB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
