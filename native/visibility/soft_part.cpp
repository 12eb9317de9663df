// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_part.h"

#include <algorithm>
#include <cmath>

namespace shadow_layers {
namespace {

using soft_kernel::Receiver;
using soft_kernel::Shaft;

// What is computed from a few floats, as a part of them, with a reserve.
constexpr double kSlack = 1e-6;
// Receivers less than this above a light's lowest samples, in parts of its size, are near.
constexpr double kNear = 1e-3, kNearDepth = 0.05;
constexpr float kBeyondAll = 3e38f;

}  // namespace

void SoftPart::set_sample_box() {
    sample_low = sets.front().low(), sample_high = sets.front().high();
    for (const SampleSets& list : sets) {
        sample_low = glm::min(sample_low, list.low());
        sample_high = glm::max(sample_high, list.high());
        needs_all = needs_all || list.needs_all();
    }
    for (int k = 0; k < 3; ++k) box_set.low[k] = float(sample_low[k]), box_set.high[k] = float(sample_high[k]);
}

Shaft make_shaft(const SoftPart& part, const Bounds& receivers) {
    Shaft shaft{};
    const bool directional = part.frame.directional;
    shaft.directional = directional;
    for (int k = 0; k < 3; ++k) shaft.low[k] = float(receivers.min[k]), shaft.high[k] = float(receivers.max[k]);
    const glm::dvec3 low = part.sample_low, high = part.sample_high;
    if (directional) {
        shaft.is_near = part.needs_all;
        for (int k = 0; k < 2; ++k) {
            const double slack = kSlack * (1 + high[k] - low[k]);
            shaft.sample_low[k] = float(low[k] - slack), shaft.sample_high[k] = float(high[k] + slack);
        }
        return shaft;
    }
    // Images of samples lower than the highest ones move away from the receiver: by their way across, for the part that
    // their height lacks.
    const glm::dvec3 centre = part.frame.centre;
    const double highest = centre.z + high.z, depth = high.z - low.z, above = highest - receivers.max.z;
    const double extent = std::max(high.x - low.x, high.y - low.y);
    shaft.is_near = !(above - depth > std::max(kNear * extent, kNearDepth * depth));
    const double growth = shaft.is_near ? 0 : depth / (above - depth);
    shaft.sample_high[2] = float(highest + kSlack * (std::abs(highest) + highest - receivers.min.z));
    for (int k = 0; k < 2; ++k) {
        const double first = centre[k] + low[k], last = centre[k] + high[k];
        const double across = std::max({std::abs(first - receivers.max[k]), std::abs(last - receivers.min[k]),
                                        std::abs(first - receivers.min[k]), std::abs(last - receivers.max[k])});
        const double slack = growth * across + kSlack * (across + std::abs(first) + std::abs(last));
        shaft.sample_low[k] = float(first - slack), shaft.sample_high[k] = float(last + slack);
    }
    return shaft;
}

void set_place(const SoftPart& part, const glm::dvec3& place, Receiver& r) {
    const bool directional = part.frame.directional;
    const glm::dvec3 base = directional ? glm::dvec3(0.0) : place - part.frame.centre;
    const double height = directional ? 1 : -base.z;
    for (int k = 0; k < 3; ++k) r.at[k] = place[k];
    r.base_u = float(base.x), r.base_v = float(base.y);
    r.height = float(height);
    if (directional) {
        r.is_near = part.needs_all;
        r.light_low = r.light_high = kBeyondAll;
        return;
    }
    const glm::dvec3 low = part.sample_low, high = part.sample_high;
    const double extent = std::max(high.x - low.x, high.y - low.y), depth = high.z - low.z;
    r.is_near = !(height + low.z > std::max(kNear * extent, kNearDepth * depth));
    r.light_low = r.is_near ? -kBeyondAll : float((height + low.z) * (1 - 8 * kSlack));
    r.light_high = float((height + high.z) * (1 + kSlack));
}

}  // namespace shadow_layers
