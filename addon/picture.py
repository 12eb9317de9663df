# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture that a scene asks for: size, border, samples and pixel filter; and its path."""

from __future__ import annotations

from typing import Any

import numpy as np

from .snapshot import RenderSettings


def render_settings(scene: Any, width: int, height: int, region: tuple[int, int, int, int]) -> RenderSettings:
    """Samples of the scene, with the pixel filter of Cycles where there is one, else Blender's own."""
    cycles = getattr(scene, "cycles", None)
    return RenderSettings(
        width,
        height,
        region,
        samples=scene.shadow_layers.samples,
        filter=getattr(cycles, "pixel_filter_type", "BLACKMAN_HARRIS"),
        filter_width=float(getattr(cycles, "filter_width", scene.render.filter_size)),
    )


def literal_path(render: Any, path: str) -> str:
    """A path for `render.filepath` that Blender takes as it stands: since 4.5 words in braces are variables."""
    property_of_path = render.bl_rna.properties["filepath"]
    if not getattr(property_of_path, "is_path_supports_templates", False):
        return path
    return path.replace("{", "{{").replace("}", "}}")


def render_size(render: Any) -> tuple[int, int]:
    """The full picture in pixels, percentage applied as Blender does."""
    percentage = render.resolution_percentage
    return max(render.resolution_x * percentage // 100, 1), max(render.resolution_y * percentage // 100, 1)


def border_region(render: Any, width: int, height: int) -> tuple[int, int, int, int]:
    """(x, y, width, height) that a render covers: the border in whole pixels if there is one."""
    if not render.use_border:
        return 0, 0, width, height
    # Blender multiplies float by int and cuts; do it in float32 as well, so that the pixels agree.
    x0, x1 = (int(np.float32(v) * np.float32(width)) for v in (render.border_min_x, render.border_max_x))
    y0, y1 = (int(np.float32(v) * np.float32(height)) for v in (render.border_min_y, render.border_max_y))
    return x0, y0, max(x1 - x0, 1), max(y1 - y0, 1)
