// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part of soft_kernel.cpp: boxes. What a box may hide from a receiver is found by its image on the light's plane w =
// 0, seen from the receiver.

#include "base/kernel_lanes.h"
#include "visibility/soft_kernel.h"

namespace shadow_layers::soft_kernel {
namespace {

// Images of boxes are off by a few roundings of their distance from the light's centre, with a reserve.
constexpr float kImageError = 1.0f / 1048576;  // 2^-20
// Boxes that reach down to the receiver are seen at all heights from here on, as parts of the light's.
constexpr float kLeastHeight = 1e-18f;

// Trees are no deeper than this allows (scene/box_tree.cpp), twice over for instances.
constexpr int kStackSize = 1024;
// Up to so many samples are followed as rays.
constexpr int kFewRays = 2;

/// A child that waits for its turn, with the samples that it may hide.
struct Waiting {
    std::uint64_t mask;
    std::uint32_t child;
};

/// A receiver as its boxes are tested, with what does not change from node to node.
struct View {
    float at[3], normal[3];
    float base_u, base_v, height, top;  ///< boxes above `top` lie beyond the light
    float error_u, error_v;             ///< of an image
    float slope;                        ///< 0: unknown
    float direction_size;               ///< no coordinate of a direction to a sample is larger
    bool is_near;

    View(const Receiver& r, const SampleSet& samples) {
        for (int k = 0; k < 3; ++k) at[k] = float(r.at[k]), normal[k] = r.normal[k];
        base_u = r.base_u, base_v = r.base_v, height = r.height;
        const float size = samples.high[0] - samples.low[0] + samples.high[1] - samples.low[1];
        const float away = (base_u < 0 ? -base_u : base_u) + (base_v < 0 ? -base_v : base_v) + size;
        error_u = error_v = kImageError * away;
        top = r.light_high * (1 + kImageError);
        slope = r.least_slope > 0 ? r.least_slope : 0.0f;
        is_near = r.is_near != 0;
        const float base[3] = {base_u, base_v, height};
        direction_size = 0;
        for (int k = 0; k < 3; ++k) {
            const float reach = samples.high[k] > -samples.low[k] ? samples.high[k] : -samples.low[k];
            const float most = (base[k] < 0 ? -base[k] : base[k]) + reach;
            direction_size = most > direction_size ? most : direction_size;
        }
    }
};

/// A node's boxes about the receiver.
struct NearBoxes {
    Floats8 low[3], high[3];
    NearBoxes(const Node& node, const float (&at)[3]) {
        for (int k = 0; k < 3; ++k) {
            low[k] = Floats8::load(node.low[k]) - Floats8(at[k]);
            high[k] = Floats8::load(node.high[k]) - Floats8(at[k]);
        }
    }
    /// The greatest height over the plane through the receiver.
    Floats8 find_rise(const float (&normal)[3]) const {
        Floats8 rise = Floats8(normal[0]) * (normal[0] >= 0 ? high[0] : low[0]);
        for (int k = 1; k < 3; ++k) rise = fma(Floats8(normal[k]), normal[k] >= 0 ? high[k] : low[k], rise);
        return rise;
    }
    /// Not more than the distance of any point of the box; may be negative.
    Floats8 find_distance() const {
        Floats8 distance = max(low[0], Floats8(0.0f) - high[0]);
        for (int k = 1; k < 3; ++k) distance = max(distance, max(low[k], Floats8(0.0f) - high[k]));
        return distance;
    }
};

inline float clamp_entry(float x) { return x > 0 ? (x < float(kBins + 1) ? x : float(kBins + 1)) : 0.0f; }

/// The entries of a mask table for a box's image, two for each child.
struct Entries {
    alignas(32) float u_low[kWidth], u_high[kWidth], v_low[kWidth], v_high[kWidth];
};

inline void find_entries(const Floats8& low, const Floats8& high, const Floats8& t_near, const Floats8& t_far,
                         float base, float error, float scale, float offset, float* entry_low, float* entry_high) {
    const Floats8 least = min(low * t_near, low * t_far), most = max(high * t_near, high * t_far);
    const Floats8 zero(0.0f), last(float(kBins + 1));
    const float at_low = (base - error) * scale + offset, at_high = (base + error) * scale + offset;
    min(max(fma(least, Floats8(scale), Floats8(at_low)), zero), last).store(entry_low);
    min(max(fma(most, Floats8(scale), Floats8(at_high)), zero), last).store(entry_high);
}

/// Bits of the children that may hide samples in `mask`, and which.
inline std::uint32_t test_node(const Node& node, const View& view, const MaskTables& tables, std::uint64_t mask,
                               std::uint64_t (&masks)[kWidth]) {
    const NearBoxes boxes(node, view.at);
    const Floats8 zero(0.0f);
    std::uint32_t alive =
        find_greater(boxes.find_rise(view.normal), Floats8(view.slope) * max(boxes.find_distance(), zero));
    if (view.is_near) {
        for (std::uint32_t left = alive; left != 0; left &= left - 1) masks[__builtin_ctz(left)] = mask;
        return alive;
    }
    alive &= find_greater(boxes.high[2], zero) & find_greater(Floats8(view.top), boxes.low[2]);
    if (alive == 0) return 0;
    const Floats8 height(view.height);
    const Floats8 t_near = height / max(boxes.low[2], Floats8(view.height * kLeastHeight)),
                  t_far = height / boxes.high[2];
    Entries entries;
    find_entries(boxes.low[0], boxes.high[0], t_near, t_far, view.base_u, view.error_u, tables.scale_u, tables.offset_u,
                 entries.u_low, entries.u_high);
    find_entries(boxes.low[1], boxes.high[1], t_near, t_far, view.base_v, view.error_v, tables.scale_v, tables.offset_v,
                 entries.v_low, entries.v_high);
    std::uint32_t kept = 0;
    for (std::uint32_t left = alive; left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        masks[i] = mask & tables.u_from[int(entries.u_low[i])] & tables.u_to[int(entries.u_high[i])] &
                   tables.v_from[int(entries.v_low[i])] & tables.v_to[int(entries.v_high[i])];
        if (masks[i] != 0) kept |= 1u << i;
    }
    return kept;
}

/// For very few samples: the rays to them against the boxes themselves, which are smaller than their images' bounds.
inline std::uint32_t test_rays(const Node& node, const View& view, const SampleSet& samples, std::uint64_t mask,
                               std::uint64_t (&masks)[kWidth]) {
    const NearBoxes boxes(node, view.at);
    const Floats8 zero(0.0f);
    std::uint32_t kept = 0;
    for (int i = 0; i < kWidth; ++i) masks[i] = 0;
    for (std::uint64_t left = mask; left != 0; left &= left - 1) {
        const int sample = __builtin_ctzll(left);
        const float d[3] = {samples.u[sample] - view.base_u, samples.v[sample] - view.base_v,
                            samples.w[sample] + view.height};
        Floats8 enter(0.0f), leave(3e38f);
        for (int k = 0; k < 3; ++k) {
            const float least = kLeastHeight * view.direction_size;
            const float over = 1 / (d[k] < 0 ? (d[k] < -least ? d[k] : -least) : (d[k] > least ? d[k] : least));
            enter = max(enter, (over > 0 ? boxes.low[k] : boxes.high[k]) * Floats8(over));
            leave = min(leave, (over > 0 ? boxes.high[k] : boxes.low[k]) * Floats8(over));
        }
        // Where there is no child rays enter at infinity.
        std::uint32_t hit = find_greater(leave * Floats8(1 + 4 * kImageError), enter) & find_greater(leave, zero);
        kept |= hit;
        for (; hit != 0; hit &= hit - 1) masks[__builtin_ctz(hit)] |= std::uint64_t(1) << sample;
    }
    return kept;
}

/// The image's least and greatest u (or v) over all receivers of the shaft: u = at + (p - at) t grows with p, and falls
/// with `at`, for t >= 1.
inline void find_shaft_image(const Floats8& low, const Floats8& high, const Floats8& t_near, const Floats8& t_far,
                             float at_low, float at_high, Floats8& least, Floats8& most) {
    least = Floats8(at_high) + min((low - Floats8(at_high)) * t_near, (low - Floats8(at_high)) * t_far);
    most = Floats8(at_low) + max((high - Floats8(at_low)) * t_near, (high - Floats8(at_low)) * t_far);
}

inline std::uint32_t test_shaft(const Shaft& shaft, const Node& node) {
    Floats8 low[3], high[3];
    for (int k = 0; k < 3; ++k) low[k] = Floats8::load(node.low[k]), high[k] = Floats8::load(node.high[k]);
    const Floats8 zero(0.0f);
    std::uint32_t alive = find_greater(high[0], Floats8(-3e38f));  // not where there is no child
    if (shaft.has_plane) {
        Floats8 rise(-shaft.offset);
        for (int k = 0; k < 3; ++k) rise = fma(Floats8(shaft.normal[k]), shaft.normal[k] >= 0 ? high[k] : low[k], rise);
        alive &= find_greater(rise, zero);
    }
    if (shaft.is_near) return alive;
    const Floats8 top = high[2] - Floats8(shaft.low[2]), bottom = low[2] - Floats8(shaft.high[2]);
    alive &= find_greater(top, zero);
    if (shaft.directional) {
        const Floats8 t_near = Floats8(1.0f) / max(bottom, top * Floats8(kLeastHeight)), t_far = Floats8(1.0f) / top;
        for (int k = 0; k < 2; ++k) {
            const Floats8 from = low[k] - Floats8(shaft.high[k]), to = high[k] - Floats8(shaft.low[k]);
            alive &= find_greater(Floats8(shaft.sample_high[k]), min(from * t_near, from * t_far));
            alive &= find_greater(max(to * t_near, to * t_far), Floats8(shaft.sample_low[k]));
        }
        return alive;
    }
    const float highest = shaft.sample_high[2];
    alive &= find_greater(Floats8(highest), low[2]);
    const Floats8 least_bottom = max(bottom, (Floats8(highest - shaft.high[2])) * Floats8(kLeastHeight));
    const Floats8 t_near = Floats8(1.0f) + max(Floats8(highest) - low[2], zero) / least_bottom;
    const Floats8 t_far = Floats8(1.0f) + max(Floats8(highest) - high[2], zero) / top;
    for (int k = 0; k < 2; ++k) {
        Floats8 least, most;
        find_shaft_image(low[k], high[k], t_near, t_far, shaft.low[k], shaft.high[k], least, most);
        alive &= find_greater(Floats8(shaft.sample_high[k]), least) & find_greater(most, Floats8(shaft.sample_low[k]));
    }
    return alive;
}

}  // namespace
}  // namespace shadow_layers::soft_kernel
