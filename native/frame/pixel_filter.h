// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shadow_layers/request.h"

namespace shadow_layers {

/// Offsets in pixels from the pixel's centre whose density is the filter, so that the filtered pixel is their plain
/// mean. Low-discrepancy (Hammersley) and always the same for the same count; one sample is the centre itself.
std::vector<glm::dvec2> make_sample_offsets(const PixelFilter& filter, int sample_count);

/// The filter's weight at `x_px` from the centre, not normalised; 0 outside its width.
double evaluate_pixel_filter(const PixelFilter& filter, double x_px);

}  // namespace shadow_layers
