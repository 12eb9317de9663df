# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges known in closed form, for the measures of borders: NumPy only.

    python tests/python/analytic_edges.py

prints what the measures find on such edges by the number of samples of the truth per pixel, and what a contour traced
through the layer's own pixels would find. docs/measures.md shows the table.
"""

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

from compare.border import measure_border
from compare.contour import trace_contour
from compare.true_border import TrueBorder

WIDTH, HEIGHT = 320, 200


def sample_centres(width, height, samples=1):
    """x (1, w) and y (h, 1) of the samples, in pixels."""
    return (np.arange(width * samples) + 0.5)[None, :] / samples, (np.arange(height * samples) + 0.5)[:, None] / samples


def edge_coordinates(x, y, angle_deg, size=(WIDTH, HEIGHT)):
    """Along and across an edge through the picture's middle; across grows into the shadow."""
    angle = math.radians(angle_deg)
    u, v = x - (size[0] / 2 + 0.137), y - (size[1] / 2 + 0.291)
    return u * math.cos(angle) + v * math.sin(angle), -u * math.sin(angle) + v * math.cos(angle)


def sawtooth(along, period, height):
    """From -height / 2 to height / 2 over each period: mean 0, RMS height / sqrt(12)."""
    return height * (along / period - np.floor(along / period) - 0.5)


def triangle(along, period, height):
    """Mean 0, RMS height / sqrt(12), without jumps."""
    phase = along / period - np.floor(along / period)
    return height * (2 * np.abs(phase - 0.5) - 0.5)


def draw_truth(angle_deg, samples, size=(WIDTH, HEIGHT)):
    return edge_coordinates(*sample_centres(*size, samples), angle_deg, size)[1] < 0


def draw_layer(angle_deg, shift, wave=None, size=(WIDTH, HEIGHT)):
    """A hard layer at the pixels' centres, lit `shift` pixels too far, and by `wave(along)` more."""
    along, across = edge_coordinates(*sample_centres(*size), angle_deg, size)
    return (across < shift + (wave(along) if wave else 0.0)).astype(np.float32)


def measure_edge(layer, fine_truth, samples, usable=None, **keywords):
    height, width = layer.shape
    usable = np.ones((height, width), bool) if usable is None else usable
    border = TrueBorder(trace_contour(fine_truth, samples), usable)
    truth = keywords.pop("truth", None)
    if truth is None:
        truth = fine_truth[samples // 2 :: samples, samples // 2 :: samples]
    return measure_border(layer, truth, np.ones((height, width), bool), border, **keywords)


def texels_of(texel_px):
    """A map whose texels are squares of the picture."""
    return lambda rows, columns: np.broadcast_to(texel_px * np.eye(2), (len(rows), 2, 2))


def measure_traced_contour(layer, angle_deg):
    """Mean and RMS about it of the distances of a contour traced through the layer itself to the true edge."""
    contour = trace_contour(layer)
    x, y = contour.middles.T
    weights = contour.lengths_px / contour.lengths_px.sum()
    across = edge_coordinates(x, y, angle_deg)[1]
    mean = (weights * across).sum()
    return mean, math.sqrt((weights * (across - mean) ** 2).sum())


ANGLES_DEG = (1.0, 3.0, 7.0, 18.4, 26.6, 38.0, 44.0, 67.3)
STAIRCASES_PX = (0.0, 0.29, 0.58, 1.15)  # RMS; a texel of 1, 2, 4 pixels has these
SHIFTS_PX = (0.0, 0.3, -0.8)


def compute_errors(samples):
    """Worst and RMS errors of shift and staircase over all edges; with 0 samples those of the traced contour."""
    shift_errors, stair_errors, floors = [], [], []
    for angle in ANGLES_DEG:
        truth = draw_truth(angle, max(samples, 1))
        centre = draw_truth(angle, 1)
        for stair in STAIRCASES_PX:
            for shift in SHIFTS_PX:
                layer = draw_layer(angle, shift, lambda t, s=stair: sawtooth(t, 17.3, s * math.sqrt(12)))
                if samples:
                    values = measure_edge(layer, truth, samples, truth=centre, texels=texels_of(4.0)).values
                    found = values["border_bias_px"], values["staircase_px"]
                else:
                    found = measure_traced_contour(layer, angle)
                shift_errors.append(found[0] - shift)
                (stair_errors if stair else floors).append(found[1] - stair)
    return np.array(shift_errors), np.array(stair_errors), np.array(floors)


def make_table():
    """Rows of text: samples, then the errors of shift and staircase, and the staircase found where there is none."""
    rows = []
    for samples in (0, 1, 2, 3, 4, 5, 8):
        cells = [f"{samples} x {samples}" if samples else "traced layer"]
        for number, errors in enumerate(compute_errors(samples)):
            mean = errors.mean() if number == 2 else np.sqrt((errors**2).mean())
            cells.append(f"{mean:.3f}, {np.abs(errors).max():.3f}")
        rows.append(cells)
    return rows


def main():
    print("samples per pixel  shift: RMS, worst  staircase: RMS, worst  without one: mean, worst")
    for row in make_table():
        print("{:19}{:20}{:24}{}".format(*row))


if __name__ == "__main__":
    main()
