// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "stages/depth_map.h"

namespace shadow_layers {

enum class BlurFilter : int { Box, Gaussian };

/// Weights of the texels 0 to `radius` away from the middle; with their mirror images they add up to 1. The Gaussian's
/// standard deviation is half the kernel's half width, (radius + 1/2) / 2.
std::vector<double> compute_blur_weights(int radius, BlurFilter filter);
/// Variance of that kernel along an axis, in squared texels.
double compute_blur_variance(int radius, BlurFilter filter);

struct MomentMapOptions {
    std::string encode;          ///< function of shaders/lib/moment_lib.glsl: what a texel stores of a depth
    GLenum format = GL_RGBA32F;  ///< of the map; averages are taken in 32-bit floats all the same
    glm::dvec2 exponents{0.0};   ///< of the encodings that take some
    int radius = 0;              ///< of the blur, 0 to kMostBlurTexels
    BlurFilter filter = BlurFilter::Box;
    int widest_texels = 1;  ///< longest side of a pixel's footprint that lookups average over; 1: no mipmaps
};

/// A depth map made into something that can be averaged: linear depths (shaders/lib/linear_depth_lib.glsl), encoded,
/// blurred by a separable kernel and, if asked for, averaged down to mipmaps. An array with a layer per view, read with
/// linear filters; a layer knows nothing of the others. Texels beyond the rim count as the rim's: who asks for
/// find_margin_texels() of border never sees them.
struct MomentMap {
    std::shared_ptr<const gl::Texture> texture;
    ContentKey key;
    std::vector<float> relative_ranges;  ///< by layer: what turns its reversed depths into linear ones
    MomentMapOptions options;
    std::size_t byte_size() const { return texture->byte_size(); }

    /// Binds the map and sets the uniforms of shaders/stages/moment_inputs.glsl. `program` must be in use.
    void bind(const gl::Program& program) const;
};

/// How far lookups reach over a receiver's 2 x 2 texels: the border that a technique asks for.
int find_margin_texels(const MomentMapOptions& options);

/// Cached by the depth map's key and the options. Adds to "map_bytes"; stages "moment_map", "moment_blur",
/// "moment_levels".
std::shared_ptr<const MomentMap> render_moment_map(Engine& engine, const LightSample& sample, const DepthMap& depth_map,
                                                   const MomentMapOptions& options);

}  // namespace shadow_layers
