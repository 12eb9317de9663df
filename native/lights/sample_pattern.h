// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

/// Added to the coordinates of the square or cube that a pattern's points come from, which go on from its other side:
/// another pattern, as even.
struct PatternShift {
    glm::dvec2 in_square{0.0};
    glm::dvec3 in_cube{0.0};
};

/// Points 0..count-1 of a pattern, even over simple shapes; each point stands for the same share of the shape.
class SamplePattern {
public:
    SamplePattern(LightPattern pattern, int count, const PatternShift& shift = {})
        : pattern_(pattern), count_(count), shift_(shift) {}

    glm::dvec2 get_in_square(int i) const;  ///< [0, 1)^2
    glm::dvec2 get_in_disc(int i) const;    ///< radius 1
    /// Radius 1; of a density proportional to (1 - r^2)^(-1/2), which projects to an even disc along every direction.
    glm::dvec3 get_in_ball(int i) const;

private:
    glm::dvec3 get_in_cube(int i) const;
    glm::dvec2 get_unshifted_in_square(int i) const;
    glm::dvec3 get_unshifted_in_cube(int i) const;
    glm::dvec2 get_in_cell(int i) const;

    LightPattern pattern_;
    int count_;
    PatternShift shift_;
};

/// Shifts 0..shift_count-1: together they make of `count` points shift_count * count that are as even.
std::vector<PatternShift> find_pattern_shifts(LightPattern pattern, int count, int shift_count);

}  // namespace shadow_layers
