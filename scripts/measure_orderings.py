# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The orderings that papers 003 and 004 tell of, on the same settings: rows for scripts/measure.py.

Each comparison is a run of the batch's verb compare at 1280 x 720 with maps of 512. Techniques that this build doesn't
have are left out, and said so.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

root = Path(__file__).resolve().parent.parent
kSettings = ("--resolution", "1280x720", "--map-size", 512)
# "Clearly": at most so much of sm's staircase. Straight edges can be rebuilt; the scorpion's outline has features of a
# texel, which no walk along steps brings back.
kStaircaseBounds = {"box": 0.6, "jenga": 0.8, "scorpion": 0.9}
kKernels = (3, 7, 10)
kBlurRadius = 3  # 7 x 7 texels, about as wide as edtsm's penumbra
kBorderScenes = tuple(kStaircaseBounds)
kLeakScene = "wall"


@dataclass(frozen=True)
class Row:
    """One figure: what is compared, by which measure, the figure, the one it is held against, and whether it holds."""

    cells: tuple[str, ...]
    good: bool | None


Compare = Callable[..., list[dict]]


def get_techniques() -> list[str]:
    """Ids in the registry, as the sources have them."""
    registry = (root / "native" / "techniques" / "registry.cpp").read_text(encoding="utf-8")
    return re.findall(r"\{describe_(\w+),", registry)


def choose(*wanted: str) -> list[str]:
    there = get_techniques()
    for name in wanted:
        if name not in there:
            print(f"[measure] there is no technique {name}: left out")
    return [name for name in wanted if name in there]


def sets(techniques: list[str], parameter: str, value: object) -> list[str]:
    return [word for name in techniques for word in ("--set", f"{name}.{parameter}={value}")]


def compare_staircases(compare: Compare, scene: str) -> list[Row]:
    """Revectorised borders against sm's, all against the hard truth: the staircase must fall clearly. Shift and wrong
    pixels stand beside it: smsr trades one for the other."""
    others = choose("smsr", "smsr2", "rsmss", "edsm")
    runs = [(compare(scene, ["sm", *others], "--truth", "hard"), "")]
    if "smsr" in others:
        runs.append((compare(scene, ["smsr"], "--truth", "hard", "--set", "smsr.mode=half"), " half"))
    rows, plain = [], {}
    for records, ending in runs:
        for record in records:
            technique, values = record["technique"] + ending, record["measures"]
            stairs = values["staircase_texels"]
            if technique == "sm":
                plain[record["light"]] = stairs
            bound = kStaircaseBounds[scene] * plain[record["light"]]
            good = None if technique == "sm" else stairs <= bound
            beside = f"shift {values['border_bias_texels']:+.3f} texels, unbiased {values['unbiased_error_px']:.3f} px"
            beside += f", wrong {100 * values['misclassified_fraction']:.3f} %"
            held = "" if good is None else f"<= {bound:.3f}"
            cells = ("staircase", scene, technique, f"{stairs:.3f} texels", held, beside)
            rows.append(Row(cells, good))
    return rows


def compare_filters(compare: Compare, scene: str) -> list[Row]:
    """rpcf against pcf at equal kernel, each against the exact mask filtered over its own square: a smaller RMSE.

    By its shift of half a texel rpcf_smsr has more wrong than pcf, so it is held by what is wrong without the shift.
    """
    techniques = choose("rpcf_smsr", "rpcf_rsmss")
    if not techniques:
        return []
    rows = []
    for kernel in kKernels:
        words = sets(["pcf", *techniques], "kernel", kernel)
        records = compare(scene, ["pcf", *techniques], "--truth", "named", *words)
        plain = next(record["measures"] for record in records if record["technique"] == "pcf")
        for record in records:
            technique, values = record["technique"], record["measures"]
            judged, unit = ("unbiased_error_px", " px") if technique == "rpcf_smsr" else ("rmse", "")
            good, held = None, ""
            if technique != "pcf":
                good, held = values[judged] < plain[judged], f"< {plain[judged]:.5f}"
            name = "RMSE" if judged == "rmse" else "unbiased"
            beside = f"RMSE {values['rmse']:.5f}, unbiased {values['unbiased_error_px']:.3f} px"
            beside += f", staircase {values['staircase_texels']:.3f} texels, bias {values['signed_bias']:+.5f}"
            beside += f", truth's error {record['truth']['standard_error']['rms'] or 0:.5f}"
            figure = f"{name} {values[judged]:.5f}{unit}"
            rows.append(Row(("filtered", scene, f"{technique} {kernel} x {kernel}", figure, held, beside), good))
    return rows


def compare_leaks(compare: Compare) -> list[Row]:
    """Light deep in full shadow: edtsm must have less than each pre-filtered map. Each against the truth filtered as
    widely as it blurs itself."""
    techniques = choose("edtsm", "vsm", "esm", "evsm", "msm")
    maps = [name for name in techniques if name != "edtsm"]
    if "edtsm" not in techniques or not maps:
        return []
    words = [*sets(maps, "blur_radius", kBlurRadius), "--set", "edtsm.penumbra_from=fixed"]
    records = compare(kLeakScene, techniques, "--truth", "named", *words)
    own = max(record["measures"]["leak_weight"] for record in records if record["technique"] == "edtsm")
    rows = []
    for record in records:
        leak, good = record["measures"]["leak_weight"], None
        if record["technique"] != "edtsm":
            good = own < leak
        cells = ("leak", kLeakScene, record["technique"], f"{100 * leak:.4f} % of the pixels",
                 "" if good is None else f"> {100 * own:.4f}",
                 f"truth {record['truth']['kind']}, RMSE {record['measures']['rmse']:.5f}")  # fmt: skip
        rows.append(Row(cells, good))
    return rows


def measure(compare: Compare, scenes: tuple[str, ...]) -> list[Row]:
    """All rows. `compare(scene, techniques, *options)` gives the records of a comparison; `scenes`: those of
    kBorderScenes that are there."""
    rows = []
    for scene in scenes:
        rows += compare_staircases(compare, scene)
    for scene in scenes[:1]:
        rows += compare_filters(compare, scene)
    return rows + compare_leaks(compare)
