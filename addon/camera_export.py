# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera as the core wants it: a window at depth 1 and a placement without scale, both in double."""

from __future__ import annotations

from typing import Any

import numpy as np

from .bridge import ShadowLayersError
from .snapshot import CameraData


def window_from_projection(projection: np.ndarray) -> tuple[bool, tuple[float, float, float, float]]:
    """(perspective, (left, right, bottom, top)) of an OpenGL projection matrix (4, 4), row-major."""
    p = np.asarray(projection, np.float64)
    if p[3, 3] == 0.0:  # clip w is the depth
        return True, (
            (p[0, 2] - 1) / p[0, 0],
            (p[0, 2] + 1) / p[0, 0],
            (p[1, 2] - 1) / p[1, 1],
            (p[1, 2] + 1) / p[1, 1],
        )
    return False, (
        (-1 - p[0, 3]) / p[0, 0],
        (1 - p[0, 3]) / p[0, 0],
        (-1 - p[1, 3]) / p[1, 1],
        (1 - p[1, 3]) / p[1, 1],
    )


def without_scale(matrix: np.ndarray) -> np.ndarray:
    """A placement with orthonormal axes: Z keeps its direction, Y the plane of Y and Z, X its side (mirroring stays).
    An axis that was scaled to nothing is replaced by one that fits."""
    source = np.asarray(matrix, np.float64)
    z = _unit(source[:3, 2], np.array([0.0, 0.0, 1.0]))
    y = source[:3, 1] - z * (source[:3, 1] @ z)
    if np.linalg.norm(y) <= 1e-9 * np.linalg.norm(source[:3, 1]):
        y = np.cross(z, source[:3, 0])
    y = _unit(y, np.cross(z, np.eye(3)[np.argmin(np.abs(z))]))
    x = np.cross(y, z)
    if x @ source[:3, 0] < 0:
        x = -x
    placed = np.eye(4)
    placed[:3, 0], placed[:3, 1], placed[:3, 2] = x, y, z
    placed[:3, 3] = source[:3, 3]
    return placed


def _unit(vector: np.ndarray, fallback: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vector)
    if not np.isfinite(length) or length == 0:
        length, vector = np.linalg.norm(fallback), fallback
    return vector / length


def refusal(camera: Any) -> str | None:
    """Why a camera object can't be rendered, with the remedy; None if it can."""
    if camera is None:
        return "the scene has no camera; add one, or choose one in Properties > Scene > Camera"
    kind = getattr(camera.data, "type", None)
    if camera.type == "CAMERA" and kind not in {"PERSP", "ORTHO"}:
        return (
            f'camera "{camera.name}" is {str(kind).lower()}, which has no single projection plane; '
            "set its Type to Perspective or Orthographic"
        )
    return None


def export_camera(camera: Any, depsgraph: Any, width: int, height: int, aspect: tuple[float, float]) -> CameraData:
    """The camera of a render. width and height are the full picture in pixels, aspect the render's pixel aspect."""
    reason = refusal(camera)
    if reason is not None:
        raise ShadowLayersError(reason)
    evaluated = camera.evaluated_get(depsgraph)
    projection = evaluated.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=aspect[0], scale_y=aspect[1])
    perspective, window = window_from_projection(projection)
    return CameraData(
        perspective=perspective,
        window=window,
        clip_start=float(getattr(evaluated.data, "clip_start", 0.1)),
        clip_end=float(getattr(evaluated.data, "clip_end", 1000.0)),
        world_from_camera=without_scale(np.array(evaluated.matrix_world, np.float64)),
    )


def camera_from_view(view_matrix: Any, window_matrix: Any, clip_start: float, clip_end: float) -> CameraData:
    """The camera of a 3D viewport, from its region's view and window matrices."""
    perspective, window = window_from_projection(np.array(window_matrix, np.float64))
    placement = without_scale(np.linalg.inv(np.array(view_matrix, np.float64)))
    if not perspective:
        # An orthographic viewport sees behind its origin too: start from as far back as it sees ahead.
        placement[:3, 3] += placement[:3, 2] * clip_end
        clip_start, clip_end = min(clip_start, clip_end * 1e-3), 2 * clip_end
    return CameraData(perspective, window, clip_start, clip_end, placement)
