# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of the batch. No bpy: `--help` and mistakes in it are answered before Blender loads."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import NoReturn

DESCRIPTION = """\
Shadow layers without a window. Two ways to run it, with the same verbs and options:

  blender -b FILE.blend -P addon/batch.py -- VERB [options]
  python addon/batch.py FILE.blend VERB [options]        (Python with the bpy module)
"""

EPILOG = """\
Exit code 0: everything asked for was written. 1: something could not be done; the last line says what and what helps.
2: a mistake in the command line. Files appear under their final names only when they are whole.

Examples:
  python addon/batch.py shot.blend render --techniques edsm --frames 1..24 --out layers
  python addon/batch.py shot.blend compare --techniques sm,pcf,edsm --lights Key Fill --resolution 1280x720
  python addon/batch.py shot.blend render --set pcf.kernel=5 --map-size 2048
  python addon/batch.py info
"""

VERBS = {
    "render": "render the layers to one multilayer EXR a frame, and each to a PNG",
    "compare": "render the layers and measure them against Cycles: JSON, pictures and one HTML page",
    "snapshot": "write the exported scene as a snapshot file, for bug reports and for shadowcore",
    "info": "tell versions, GL renderer, techniques with their parameters, and limits",
}

TEMPORAL_MOVES = ("light", "camera", "frames")
TRUTHS = ("named", "hard", "filtered", "soft", "pixel")


class _Parser(argparse.ArgumentParser):
    """Says mistakes in one line, with the way to the help."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"error: {message}; see --help\n")


def parse_resolution(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d+)[xX](\d+)", text)
    if not match or not (4 <= int(match[1]) <= 65536 and 4 <= int(match[2]) <= 65536):
        raise argparse.ArgumentTypeError(f'"{text}" is no resolution: write WxH, as 1280x720, 4 to 65536 each')
    return int(match[1]), int(match[2])


def parse_frames(text: str) -> range:
    match = re.fullmatch(r"(-?\d+)(?:\.\.(-?\d+))?", text)
    if not match:
        raise argparse.ArgumentTypeError(f'"{text}" is no range of frames: write A..B, as 1..24, or one frame')
    first = int(match[1])
    last = first if match[2] is None else int(match[2])
    if last < first:
        raise argparse.ArgumentTypeError(f'"{text}" runs backwards: write {last}..{first}')
    return range(first, last + 1)


def parse_techniques(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise argparse.ArgumentTypeError("no technique is named: write their ids with commas, as sm,edsm")
    return list(dict.fromkeys(names))


def parse_truths(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    unknown = [name for name in names if name not in TRUTHS]
    if unknown or not names:
        raise argparse.ArgumentTypeError(f'"{text}" is no truth: write {", ".join(TRUTHS)}, or several with commas')
    return list(dict.fromkeys(names))


def parse_step(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-6 <= value <= 10.0:
        raise argparse.ArgumentTypeError(f'"{text}" is no step: write degrees, 0.000001 to 10, as 0.05')
    return value


def parse_setting(text: str) -> tuple[str, str, str]:
    match = re.fullmatch(r"(\w+)\.(\w+)=(.*)", text)
    if not match:
        raise argparse.ArgumentTypeError(f'"{text}" sets nothing: write TECHNIQUE.PARAMETER=VALUE, as pcf.kernel=5')
    return match[1], match[2], match[3]


def parse_count(low: int, high: int):
    """A parser of integers from `low` to `high`."""

    def parse(text: str) -> int:
        if not re.fullmatch(r"-?\d+", text) or not low <= int(text) <= high:
            raise argparse.ArgumentTypeError(f'"{text}" is no whole number from {low} to {high}')
        return int(text)

    return parse


def make_parser() -> argparse.ArgumentParser:
    verbs = "\n".join(f"  {verb:9} {text}" for verb, text in VERBS.items())
    parser = _Parser(
        prog="batch.py",
        usage="batch.py [FILE.blend] VERB [options]",
        description=f"{DESCRIPTION}\nverbs:\n{verbs}",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("verb", choices=VERBS, metavar="VERB", help="render, compare, snapshot or info")
    add = parser.add_argument_group("what to render").add_argument
    add("--scene", metavar="NAME", help="scene (default: the file's active one)")
    add("--view-layer", metavar="NAME", help="view layer (default: all that are enabled)")
    add("--camera", metavar="NAME", help="camera object, in place of the scene's and of camera markers")
    add("--frames", metavar="A..B", type=parse_frames, help="frames, first and last (default: the current one)")
    add("--resolution", metavar="WxH", type=parse_resolution, help="picture size (default: the scene's)")
    add("--lights", metavar="NAME", nargs="+", help="light objects (default: all that are not switched off)")
    add = parser.add_argument_group("how").add_argument
    add("--techniques", metavar="ID,ID", type=parse_techniques, help="for all lights (default: as set in the file)")
    add("--map-size", metavar="N", type=parse_count(1, 1 << 20), help="side of the shadow maps, in texels")
    add("--set", metavar="T.P=V", type=parse_setting, action="append", default=[], dest="settings",
        help="parameter P of technique T, as pcf.kernel=5; may be repeated")  # fmt: skip
    add("--samples", metavar="N", type=parse_count(1, 64), help="per pixel, 1 to 64; compare always takes 1")
    add("--threads", metavar="N", type=parse_count(1, 256), help="CPU threads (default: all cores)")
    add("--backend", choices=("auto", "osmesa", "egl"), help="where the maps are drawn (default: as set in the file)")
    add("--repeat", metavar="N", type=parse_count(1, 1000), default=1,
        help="compare: render N times; the later ones' median, with maps cached, is reported too")  # fmt: skip
    add("--border-samples", metavar="N", type=parse_count(1, 16), default=3,
        help="compare: the truth's samples across a pixel, for shift and staircase (default 3)")  # fmt: skip
    add("--truth", metavar="KIND,KIND", type=parse_truths, default=["named"],
        help="compare: named (what each technique stands for; default), hard, filtered, soft, pixel")  # fmt: skip
    add("--truth-samples", metavar="N", type=parse_count(4, 65536), default=64,
        help="compare: samples per pixel of filtered, soft and pixel truths (default 64)")  # fmt: skip
    add("--causes", metavar="N", type=parse_count(0, 1_000_000), default=0,
        help="compare: sort up to N pixels of each layer that are wrong against a hard truth by cause")  # fmt: skip
    add("--temporal", choices=TEMPORAL_MOVES,
        help="compare: measure changes too, over a short move of lights or camera, or over --frames")  # fmt: skip
    add("--temporal-frames", metavar="N", type=parse_count(2, 1000), default=8, help="frames of the move (default 8)")
    add("--temporal-step", metavar="DEG", type=parse_step,
        help="degrees a frame, seen from the middle of the view (default: light 0.1, camera 0.02)")  # fmt: skip
    add = parser.add_argument_group("where to").add_argument
    add("--out", metavar="DIR", type=Path, default=Path("shadow_layers"), help="folder (default: shadow_layers)")
    add("--json", metavar="FILE", type=Path, help="the list of results (default: render.json, comparison.json in DIR)")
    add("--skip-existing", action="store_true", help="leave out frames whose files are all there")
    add("--cache", metavar="DIR", type=Path, help="compare: folder of the rendered truth (default: the user's cache)")
    add("--no-cache", action="store_true", help="compare: render the truth anew and keep nothing")
    add("--verbose", action="store_true", help="show Blender's own messages too")
    return parser


def split_file(arguments: list[str]) -> tuple[Path | None, list[str]]:
    """The .blend file, if the first argument is none of the verbs or options, and the rest."""
    if arguments and not arguments[0].startswith("-") and arguments[0] not in VERBS:
        return Path(arguments[0]), arguments[1:]
    return None, arguments


def join_negative_frames(arguments: list[str]) -> list[str]:
    """`--frames -5..5` as `--frames=-5..5`: argparse takes the range for an option."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] == "--frames" and re.match(r"-\d", argument):
            joined[-1] = f"--frames={argument}"
        else:
            joined.append(argument)
    return joined


def parse_arguments(arguments: list[str]) -> argparse.Namespace:
    """The options, with `file` (Path or None). Exits with code 2 on a mistake, 0 after --help."""
    file, rest = split_file(arguments)
    if file is not None and file.suffix != ".blend":
        make_parser().error(f'"{file}" is neither a verb ({", ".join(VERBS)}) nor a .blend file')
    options = make_parser().parse_args(join_negative_frames(rest))
    options.file = file
    return options
