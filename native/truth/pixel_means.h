// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "truth/ray_oracle.h"
#include "truth/triangle_tree.h"

namespace shadow_layers::truth {

/// The hard mask averaged over each pixel's square, 0 to 1, for a frame that `oracle.make_frame` made: the plain mean
/// over places that each count what they see by themselves, background as 1 and faces turned away as 0, which is what a
/// hard technique's layer tends to with ever more samples per pixel of a box filter.
///
/// Exact where the camera sees one plane through the whole square (plane_shadow.h). Elsewhere the pixel's corners,
/// sides' middles and centre are the answer where they agree; where they don't, kSamplesAcross^2 places are taken, one
/// at a random place of each cell of a grid, the same ones every time. `check_cancelled` is called now and then by any
/// thread, and may throw.
std::vector<float> compute_pixel_means(const RayOracle& oracle, const TriangleTree& tree, const Frame& frame,
                                       const Light& light, const LightSample& position, ThreadPool& threads,
                                       const std::function<void()>& check_cancelled);

inline constexpr int kSamplesAcross = 16;

}  // namespace shadow_layers::truth
