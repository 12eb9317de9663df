# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What exact hard shadows cost, next to a shadow map and to Embree: rows for scripts/measure.py.

From `shadowcore bench --rays`: whole frames as ratios to sm's, and what the layer itself takes next to Embree's rays
over the same receivers, in the same rounds. Embree has float alone and settles nothing in double; listing the receivers
that face the light is told apart, since `exact` does it, too, while it sorts them.
"""

from typing import Any

kTechniques = ("sm", "exact", "afsm", "sv")
kSettings = ("--map-size", "1024", "--resolution", "1280x720", "--rays")
kRepeats = {1: 9, 4: 3}  # by samples a pixel
kBoundToSm = 1.2
kExactStages = ("receiver_tiles", "caster_tiles")
kColumns = ["scene", "samples", "sm", "exact/sm", "afsm/sm", "sv/sm", "bound", "exact alone", "Embree's list",
            "build + trace", "of instances"]  # fmt: skip


def find_render_ms(document: dict[str, Any], technique: str) -> float:
    """Median of the whole frame."""
    record = next(record for record in document["records"] if record["technique"] == technique)
    return record["render_ms"]["median"]


def find_stages_ms(document: dict[str, Any]) -> float:
    """What `exact` itself takes: the longer of CPU and GL time of its stages."""
    record = next(record for record in document["records"] if record["technique"] == "exact")
    return sum(record["stage_ms"][stage]["median"] for stage in kExactStages)


def find_rays_ms(document: dict[str, Any], instanced: bool) -> tuple[float, float]:
    """Of Embree's quickest way, over all triangles or over instances: the list; build and trace."""
    rays = [ray for ray in document["rays"] if ("instances" in ray["name"]) == instanced]
    times = [(ray["list_ms"]["median"], ray["build_ms"]["median"] + ray["trace_ms"]["median"]) for ray in rays]
    return min(times, key=lambda time: time[1])


def make_row(scene: str, samples: int, document: dict[str, Any]) -> tuple[list[object], bool]:
    """Cells, and whether `exact` keeps its bound and is the quickest of the three. Rays are shot once a pixel."""
    render = {technique: find_render_ms(document, technique) for technique in kTechniques}
    ratios = {technique: render[technique] / render["sm"] for technique in kTechniques}
    cells: list[object] = [scene, samples, f"{render['sm']:.0f} ms", *(f"{ratios[t]:.2f}" for t in kTechniques[1:])]
    cells.append(kBoundToSm)
    if samples == 1:
        listing, flat = find_rays_ms(document, instanced=False)
        cells += [f"{find_stages_ms(document):.1f} ms", f"{listing:.1f}", f"{flat:.1f}"]
        cells.append(f"{find_rays_ms(document, instanced=True)[1]:.1f}")
    else:
        cells += [""] * 4
    good = ratios["exact"] <= kBoundToSm and ratios["exact"] < min(ratios["afsm"], ratios["sv"])
    return cells, good
