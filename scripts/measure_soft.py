# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact soft shadows: wrong bits, time next to hard layers and to Embree, F12 next to Cycles: rows for
scripts/measure.py.

Bits and times come from `shadowcore bench` on snapshots whose light is given another size; `--bits` casts rays in
double to the same samples of the light, `--rays` times Embree on as many rays in the same rounds. F12 is measured in
Blender (tests/blender/soft_renders.py).
"""

import json
import math
import statistics
import subprocess
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from measure_kit import Table, build_folder, in_blender, make_model, make_scene, make_snapshot, out

kTechnique, kHard = "soft", "exact"
kSizes = ("small", "medium", "large")
kBitSamples = (16, 64, 256)
kSpeedSamples = 64
kBitSettings = ("--bits", "--resolution", "320x180", "--samples", 1, "--repeat", 1, "--warm-up", 0)
kSpeedSettings = ("--rays", "--resolution", "1280x720", "--samples", 1, "--repeat", 3, "--warm-up", 1)
kColdSettings = ("--caches", "cold", "--resolution", "1280x720", "--samples", 1, "--repeat", 3, "--warm-up", 0)
kLayerBounds = {"small": 5.0, "medium": 12.0, "large": 30.0}  # hard layers
kLayerAims = {"small": 4.0, "medium": 10.0, "large": 25.0}
kTreeBound = 2.0  # hard layers more with the trees' build, of scenes of this many triangles
kTreeTriangles = (50_000, 200_000)
kTreeStage = "caster_trees"
kWorstToEmbree, kMedianToEmbree = 1.0, 0.35
kCyclesBound = 60.0
kErrorBounds = {64: 0.01, 256: 0.003}  # mean over the penumbra, of full light
kCyclesSizes = {"full": (1280, 720), "small": (400, 225), "truth_samples": 512}
kBitColumns = ["scene", "light", "samples", "bits", "wrong", "ties", "penumbra pixels"]
kSpeedColumns = ["scene", "light", "exact", "soft", "in hard layers", "bound", "aim", "with trees", "Embree", "its way",
                 "soft/Embree"]  # fmt: skip
kErrorColumns = ["scene", "penumbra pixels", "truth's own error %", "samples", "mean error %", "bias %", "bound %"]
kCyclesColumns = ["scene", "F12", "error %", "Cycles, no denoiser", "samples", "error %", "with denoiser", "samples",
                  "error %", "Cycles/F12", "bound"]  # fmt: skip


@dataclass(frozen=True)
class SoftScene:
    """A scene with the light that is measured, and its three sizes: a radius in scene units (point, spot), an angle in
    degrees (sun) or a width in scene units (area)."""

    name: str
    script: str  # generator; "model": `name` is a model of the shared folder
    light: str
    sizes: tuple[float, float, float]
    options: tuple[object, ...] = ()


kScenes = (
    SoftScene("jenga", "jenga", "Lamp", (0.1, 0.5, 2.0)),
    SoftScene("knot", "knot", "Key", (0.1, 0.5, 2.0), ("--triangles", 100_000)),
    SoftScene("hall", "hall", "Sun", (0.53, 5.0, 30.0)),
    SoftScene("city", "city", "Sun", (0.53, 5.0, 30.0)),
    SoftScene("studio", "studio", "Softbox", (0.2, 0.9, 3.0)),
    SoftScene("scorpion", "model", "Key", (0.1, 0.5, 2.0)),
    SoftScene("bunny_hr", "model", "Key", (0.1, 0.5, 2.0)),
)
kCyclesScenes = ("jenga", "studio", "hall")


def set_light_size(light: dict[str, Any], size: float) -> None:
    """Of a light as docs/snapshot.md has it; `size` as in SoftScene."""
    if light["kind"] == "SUN":
        light["sun_angle"] = math.radians(size)
    elif light["kind"] == "AREA":
        width, height = light["area_size"]
        light["area_size"] = [size, size * height / width]
    else:
        light["radius"] = size


def resize_light(snapshot: Path, name: str, size: float, out: Path) -> Path:
    """Writes the snapshot with one light of that size, and without the others and the jobs."""
    with zipfile.ZipFile(snapshot) as source, zipfile.ZipFile(out, "w") as copy:
        for member in source.infolist():
            content = source.read(member)
            if member.filename == "snapshot.json":
                scene = json.loads(content)
                scene["lights"] = [light for light in scene["lights"] if light["name"] == name]
                if not scene["lights"]:
                    raise ValueError(f"{snapshot} has no light '{name}'")
                set_light_size(scene["lights"][0], size)
                scene["jobs"] = []
                content = json.dumps(scene).encode()
            copy.writestr(member, content)
    return out


def make_bit_rows() -> list[dict[str, Any]]:
    return [{"technique": kTechnique, "settings": {"light_samples": count}} for count in kBitSamples]


def make_speed_rows() -> list[dict[str, Any]]:
    return [{"technique": kHard}, {"technique": kTechnique, "settings": {"light_samples": kSpeedSamples}}]


def judge_bits(scene: str, size: str, document: dict[str, Any]) -> list[tuple[list[object], bool]]:
    """Cells of a row for each number of samples, and whether all its bits are right."""
    rows = []
    for record in document["records"]:
        bits = record["bits"]
        cells = [scene, size, bits["light_samples"], bits["bits"], bits["wrong_bits"], bits["ties"],
                 bits["penumbra_pixels"]]  # fmt: skip
        rows.append((cells, bits["wrong_bits"] == 0 and bits["bits"] > 0))
    return rows


@dataclass(frozen=True)
class SoftTimes:
    """Medians in ms; `trees` is what the first frame takes more to build the casters' trees."""

    hard: float
    soft: float
    trees: float
    triangles: int
    embree: float  # build and trace of its quickest way
    way: str

    @property
    def layers(self) -> float:
        return self.soft / self.hard

    @property
    def layers_with_trees(self) -> float:
        return (self.soft + self.trees) / self.hard

    @property
    def to_embree(self) -> float:
        """Both with the build of their trees."""
        return (self.soft + self.trees) / self.embree


def find_record(document: dict[str, Any], technique: str) -> dict[str, Any]:
    return next(record for record in document["records"] if record["technique"] == technique)


def read_times(document: dict[str, Any], cold: dict[str, Any]) -> SoftTimes:
    """From a benchmark of both techniques with kept trees, and one of `soft` that begins anew each time."""
    hard, soft, first = (find_record(document, kHard), find_record(document, kTechnique), find_record(cold, kTechnique))
    ways = {ray["name"]: ray["build_ms"]["median"] + ray["trace_ms"]["median"] for ray in document["rays"]}
    way = min(ways, key=lambda name: ways[name])
    kept = soft["stage_ms"][kTreeStage]["median"]
    return SoftTimes(
        hard=hard["layers_ms"]["median"], soft=soft["layers_ms"]["median"],
        trees=max(0.0, first["stage_ms"][kTreeStage]["median"] - kept), triangles=soft["triangles"],
        embree=ways[way], way=way,
    )  # fmt: skip


def judge_speed(scene: str, size: str, times: SoftTimes) -> tuple[list[object], bool]:
    bound = kLayerBounds[size]
    good = times.layers <= bound and times.to_embree <= kWorstToEmbree
    if kTreeTriangles[0] <= times.triangles <= kTreeTriangles[1]:
        good = good and times.layers_with_trees - times.layers <= kTreeBound
    cells = [scene, size, f"{times.hard:.1f} ms", f"{times.soft:.0f} ms", f"{times.layers:.1f}", f"{bound:g}",
             f"{kLayerAims[size]:g}", f"{times.layers_with_trees:.1f}", f"{times.embree:.0f} ms", times.way,
             f"{times.to_embree:.2f}"]  # fmt: skip
    return cells, good


def judge_median(all_times: list[SoftTimes]) -> tuple[list[object], bool]:
    median = statistics.median(times.to_embree for times in all_times)
    blank = [""] * (len(kSpeedColumns) - 4)
    return ["median", "", f"bound {kMedianToEmbree:g}", *blank, f"{median:.2f}"], median <= kMedianToEmbree


def find_cheapest(renders: list[dict[str, Any]], error: float) -> dict[str, Any]:
    """The first of renders with ever more samples whose error is no larger; the last if there is none."""
    return next((render for render in renders if render["error"] <= error), renders[-1])


def judge_errors(scene: str, found: dict[str, Any]) -> list[tuple[list[object], bool]]:
    """Cells of a row for each number of samples of `soft`, from what judge_cycles() takes too."""
    rows = []
    for row in found["soft"]:
        bound = kErrorBounds[row["samples"]]
        cells = [scene, found["penumbra"], f"{100 * found['truth_error']:.2f}", row["samples"],
                 f"{100 * row['error']:.2f}", f"{100 * row['bias']:+.2f}", f"{100 * bound:g}"]  # fmt: skip
        rows.append((cells, row["error"] <= bound))
    return rows


def judge_cycles(scene: str, found: dict[str, Any]) -> tuple[list[object], bool]:
    """`found`: milliseconds of F12 and its error; per denoiser (off, on) renders of Cycles, each with samples, error
    and milliseconds."""
    error, f12 = found["error"], found["f12_ms"]["median"]
    plain, denoised = (find_cheapest(found[key], error) for key in ("plain", "denoised"))
    reached = [render for render in (plain, denoised) if render["error"] <= error]
    quickest = min((render["ms"] for render in reached), default=min(plain["ms"], denoised["ms"]))
    ratio = quickest / f12
    cells: list[object] = [scene, f"{f12:.0f} ms", f"{100 * error:.2f}"]
    for render in (plain, denoised):
        more = "" if render["error"] <= error else "over "
        cells += [f"{render['ms'] / 1000:.1f} s", f"{more}{render['samples']}", f"{100 * render['error']:.2f}"]
    return [*cells, f"{ratio:.0f}", f"{kCyclesBound:g}"], ratio >= kCyclesBound


# ---- runs


def make_soft_scene(scene: SoftScene) -> Path | None:
    if scene.script == "model":
        return make_model(scene.name, *scene.options)
    return make_scene(f"soft_{scene.name}", scene.script, *scene.options)


def list_snapshots() -> Iterator[tuple[SoftScene, str, Path]]:
    """Each scene with its light in each of its sizes."""
    for scene in kScenes:
        path = make_soft_scene(scene)
        if path is None:
            continue
        snapshot = make_snapshot(path)
        for size, value in zip(kSizes, scene.sizes, strict=True):
            yield scene, size, resize_light(snapshot, scene.light, value, snapshot.with_name(f"{path.stem}_{size}.npz"))


def run_bench(title: str, snapshot: Path, rows: list[dict[str, Any]], settings: tuple[object, ...]) -> dict[str, Any]:
    print(f"[measure] {title} {snapshot.stem}", flush=True)
    path = out / f"soft_{title}_{snapshot.stem}.json"
    rows_path = out / f"soft_{title}_rows.json"
    rows_path.write_text(json.dumps(rows), encoding="utf-8")
    command = [build_folder() / "bin" / "shadowcore", "bench", snapshot, "--rows", rows_path, *settings, "--json", path]
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
    return json.loads(path.read_text(encoding="utf-8"))


def measure_soft() -> Table:
    """Bits of soft layers against rays in double to the same samples."""
    table = Table("Exact soft shadows: wrong bits against rays to the same samples, 320 x 180", kBitColumns)
    for scene, size, snapshot in list_snapshots():
        for cells, good in judge_bits(scene.name, size, run_bench("bits", snapshot, make_bit_rows(), kBitSettings)):
            table.add(*cells, good=good)
    return table


def measure_soft_speed() -> Table:
    """Layers of `soft` next to `exact`'s and to as many of Embree's rays, in the same rounds."""
    table = Table(f"Exact soft shadows, {kSpeedSamples} samples, 1280 x 720 (medians)", kSpeedColumns)
    all_times = []
    for scene, size, snapshot in list_snapshots():
        warm = run_bench("speed", snapshot, make_speed_rows(), kSpeedSettings)
        cold = run_bench("cold", snapshot, make_speed_rows()[1:], kColdSettings)
        all_times.append(read_times(warm, cold))
        cells, good = judge_speed(scene.name, size, all_times[-1])
        table.add(*cells, good=good)
    cells, good = judge_median(all_times)
    table.add(*cells, good=good)
    return table


def measure_soft_cycles() -> tuple[Table, Table]:
    """Errors of `soft` against Cycles, and F12 next to the cheapest render of Cycles of the same error."""
    errors = Table("Exact soft shadows against Cycles: means over the penumbra, medium lights", kErrorColumns)
    times = Table("F12 with soft next to Cycles of the same error, medium lights, 1280 x 720", kCyclesColumns)
    for scene in (scene for scene in kScenes if scene.name in kCyclesScenes):
        path = make_soft_scene(scene)
        if path is None:
            continue
        wanted = out / "soft_cycles_wanted.json"
        wanted.write_text(json.dumps({"light": scene.light, "size": scene.sizes[1], **kCyclesSizes}), encoding="utf-8")
        found = in_blender("soft_cycles", path, wanted)
        (out / f"soft_cycles_{scene.name}.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
        for cells, good in judge_errors(scene.name, found):
            errors.add(*cells, good=good)
        cells, good = judge_cycles(scene.name, found)
        times.add(*cells, good=good)
    return errors, times
