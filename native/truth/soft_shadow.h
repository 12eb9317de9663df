// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "truth/ray_oracle.h"

namespace shadow_layers::truth {

/// The part of a light's samples that reaches a pixel: sum of w_i v_i by sum of w_i over the samples that the pixel
/// faces, w_i the light that sample i brings and v_i whether it is seen; where it faces none, the plain mean of what
/// they are without occlusion.
struct LitPart {
    double decided = 1;
    double least = 1, most = 1;  ///< what ties, and weights from places and normals in float, may make of it
    double step = 0;             ///< the most that one sample brings: a wrong bit changes the part by no more
    int bits = 0;                ///< samples that the pixel faces
    int ties = 0;                ///< of these, those whose visibility is not certain
};

/// Exact soft shadows at the very samples that a layer takes, without GL.
class SampleShadows {
public:
    /// All must outlive this.
    SampleShadows(const RayOracle& oracle, const Frame& frame, const Light& light,
                  std::span<const LightSample> samples);

    LitPart find_lit_part(std::size_t pixel) const;

private:
    const RayOracle& oracle_;
    const Frame& frame_;
    const Light& light_;
    std::span<const LightSample> samples_;
    std::vector<LightRule> rules_;
};

/// A soft shadow with its standard error.
struct LitEstimate {
    double mean = 1, standard_error = 0;
};

/// Soft shadows of the light's own shape: even over the rectangle or ellipse of an area light, in solid angle over a
/// sun's disc; a point or spot light is a disc turned to the receiver, as in Cycles. From kLattices lattices of
/// kLatticePoints points, each moved at random: each by itself is an unbiased estimate, and their spread tells the
/// error. Where two lattices see all of the light, or nothing of it, that is the answer.
class ShapeShadows {
public:
    ShapeShadows(const RayOracle& oracle, const Frame& frame, const Light& light)
        : oracle_(oracle), frame_(frame), light_(light) {}

    LitEstimate estimate_lit_part(std::size_t pixel) const;

    static constexpr int kLattices = 8, kLatticePoints = 64;

private:
    LightSample make_sample(const glm::dvec2& square, const glm::dvec3& receiver_ws) const;

    const RayOracle& oracle_;
    const Frame& frame_;
    const Light& light_;
};

}  // namespace shadow_layers::truth
