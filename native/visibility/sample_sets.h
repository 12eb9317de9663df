// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lights/light_views.h"
#include "visibility/light_frame.h"
#include "visibility/soft_kernel.h"

namespace shadow_layers {

/// The samples of a light in one of its frames, cut into sets of up to 64 that lie close together, each in groups of
/// eight that do.
class SampleSets {
public:
    /// Samples of one light. `distance`: of receivers from it, about.
    SampleSets(std::span<const LightSample> samples, const LightFrame& frame, const glm::dvec3& picture_origin_ws,
               double distance);

    std::size_t count() const { return sets_.size(); }
    const soft_kernel::SampleSet& set(std::size_t i) const { return sets_[i]; }
    /// The sample behind a bit of a set: a number in `samples`.
    std::uint32_t get_number(std::size_t set, int bit) const { return numbers_[64 * set + std::size_t(bit)]; }

    /// All lie in the plane w = 0: their tables are the same for all receivers.
    bool is_flat() const { return is_flat_; }
    /// Tables of a flat set.
    const soft_kernel::MaskTables& tables(std::size_t i) const { return tables_[i]; }

    /// A sun so wide that its samples have no useful place on a plane: they are kept as directions, and no box is left
    /// out for where it lies.
    bool needs_all() const { return needs_all_; }

    /// Box of all, about the light's centre: low, high.
    const glm::dvec3& low() const { return low_; }
    const glm::dvec3& high() const { return high_; }

private:
    void add_set(std::span<const glm::dvec3> places, std::span<std::uint32_t> numbers);

    std::vector<soft_kernel::SampleSet> sets_;
    std::vector<soft_kernel::MaskTables> tables_;
    std::vector<std::uint32_t> numbers_;
    glm::dvec3 low_{0.0}, high_{0.0};
    double distance_;
    bool is_flat_ = true, needs_all_ = false;
};

/// Where receivers of a block lie, as the tables of a light with depth need it: their places about the light's centre.
struct BlockPlace {
    double base_u[2], base_v[2], height[2];  ///< low, high; heights above those of all samples
};

/// Tables for all receivers of a block.
soft_kernel::MaskTables make_tables(const soft_kernel::SampleSet& set, const BlockPlace& place);

}  // namespace shadow_layers
