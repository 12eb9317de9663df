// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// Points 0..count-1 of a pattern, even over simple shapes; each point stands for the same share of the shape.
class SamplePattern {
public:
    SamplePattern(LightPattern pattern, int count) : pattern_(pattern), count_(count) {}

    glm::dvec2 get_in_square(int i) const;  ///< [0, 1)^2
    glm::dvec2 get_in_disc(int i) const;    ///< radius 1
    /// Radius 1; of a density proportional to (1 - r^2)^(-1/2), which projects to an even disc along every direction.
    glm::dvec3 get_in_ball(int i) const;

private:
    glm::dvec3 get_in_cube(int i) const;
    glm::dvec2 get_in_cell(int i) const;

    LightPattern pattern_;
    int count_;
};

}  // namespace shadow_layers
