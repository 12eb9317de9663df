// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "visibility/caster_tree.h"
#include "visibility/sample_sets.h"
#include "visibility/soft_kernel.h"

namespace shadow_layers {

/// The receivers that a light shines on in one of its frames, and their casters.
struct SoftPart {
    LightFrame frame;
    Bounds receivers;                              ///< in the frame
    double largest_rel = 0;                        ///< coordinate of any receiver, relative to the picture's origin
    double largest_place = 0;                      ///< in the frame
    double place_error = 0;                        ///< of any receiver's place, on each axis
    std::vector<SampleSets> sets;                  ///< one for each list of samples
    glm::dvec3 sample_low{0.0}, sample_high{0.0};  ///< box of all samples of all lists, about the light's centre
    soft_kernel::SampleSet box_set{};              ///< that box alone
    bool needs_all = false;                        ///< as of SampleSets
    std::unique_ptr<CasterTree> tree;
    std::unique_ptr<CasterTree> inner_tree;  ///< of what lies inside of casters (scene/inner_occluders.h)

    void set_sample_box();
    /// Of casters' boxes, for the rounding of their coordinates and of the receivers'.
    BoxWidening widening() const { return {kBoxRounding, kBoxRounding * largest_place + 2 * place_error}; }
};

/// Sets all of a receiver that follows from where it lies, in the part's frame.
void set_place(const SoftPart& part, const glm::dvec3& place, soft_kernel::Receiver& receiver);

/// What the receivers of a box may get light from.
soft_kernel::Shaft make_shaft(const SoftPart& part, const Bounds& receivers);

}  // namespace shadow_layers
