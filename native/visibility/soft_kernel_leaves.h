// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part of soft_kernel.cpp: triangles. With a, b, c the corners seen from the receiver and d the direction to a
// sample, d . (b x c), d . (c x a) and d . (a x b) all have the sign of the volume a . b x c iff the ray meets the
// triangle in front of the receiver. They are linear in the sample's place: three forms by_u u + by_v v + by_w w + at.
// No division: triangles that reach below the receiver need no clipping.

#include "base/kernel_lanes.h"
#include "visibility/soft_kernel_nodes.h"

namespace shadow_layers::soft_kernel {
namespace {

constexpr float kRounding = 1.0f / 16777216;  // 2^-24: of one operation
constexpr std::uint64_t kGroupBits = 0xff;

inline const Leaf& get_leaf(const Trace& trace, std::uint32_t link) {
    const std::uint32_t number = link & ~(kLeaf | kOfBlock);
    return link & kOfBlock ? trace.roots.leaves[number] : trace.tree.leaves[number];
}

/// Three edges' forms for each triangle of a leaf, turned so that all three are positive where it hides a sample, and
/// the bound of their error.
struct LeafForms {
    alignas(32) float by_u[3][kWidth], by_v[3][kWidth], by_w[3][kWidth], at[3][kWidth];
    alignas(32) float error[kWidth], volume[kWidth];
    std::uint32_t lanes;   ///< that may hide samples
    std::uint32_t unsure;  ///< lanes whose volume is 0 within rounding: either orientation may be right
    std::uint32_t beyond;  ///< lanes that reach up to the light
};

struct Vector8 {
    Floats8 x, y, z;
};

inline Vector8 cross(const Vector8& p, const Vector8& q) {
    const Floats8 zero(0.0f);
    return {fma(p.y, q.z, zero - p.z * q.y), fma(p.z, q.x, zero - p.x * q.z), fma(p.x, q.y, zero - p.y * q.x)};
}

inline Floats8 dot(const Vector8& p, const Vector8& q) { return fma(p.x, q.x, fma(p.y, q.y, p.z * q.z)); }

inline Floats8 find_largest(const Vector8& p) { return max(max(abs(p.x), abs(p.y)), abs(p.z)); }

inline Vector8 operator-(const Vector8& p, const Vector8& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }

inline Vector8 with_sign_of(const Vector8& p, const Floats8& sign) {
    return {with_sign_of(p.x, sign), with_sign_of(p.y, sign), with_sign_of(p.z, sign)};
}

/// Triangles of a leaf about the receiver.
struct NearTriangles {
    Vector8 a, edge_1, edge_2;
    NearTriangles(const Leaf& leaf, const Receiver& r) {
        const auto load = [](const float(&values)[3][kWidth]) -> Vector8 {
            return {Floats8::load(values[0]), Floats8::load(values[1]), Floats8::load(values[2])};
        };
        a = load(leaf.a), edge_1 = load(leaf.edge_1), edge_2 = load(leaf.edge_2);
        a.x = a.x - Floats8(float(r.at[0] - leaf.origin[0]));
        a.y = a.y - Floats8(float(r.at[1] - leaf.origin[1]));
        a.z = a.z - Floats8(float(r.at[2] - leaf.origin[2]));
    }
    Vector8 find_low() const {
        const Floats8 zero(0.0f);
        return {a.x + min(min(edge_1.x, edge_2.x), zero), a.y + min(min(edge_1.y, edge_2.y), zero),
                a.z + min(min(edge_1.z, edge_2.z), zero)};
    }
    Vector8 find_high() const {
        const Floats8 zero(0.0f);
        return {a.x + max(max(edge_1.x, edge_2.x), zero), a.y + max(max(edge_1.y, edge_2.y), zero),
                a.z + max(max(edge_1.z, edge_2.z), zero)};
    }
};

/// Lanes that rise over the receiver's own plane steeper than the flattest direction to a sample. `reach`: no corner's
/// coordinate is larger.
inline std::uint32_t find_rising(const NearTriangles& t, const View& view, const Floats8& reach,
                                 const Floats8& place_error) {
    const Vector8 normal{Floats8(view.normal[0]), Floats8(view.normal[1]), Floats8(view.normal[2])};
    const Floats8 zero(0.0f), slope(view.slope);
    Floats8 rise = dot(normal, t.a) + max(max(dot(normal, t.edge_1), dot(normal, t.edge_2)), zero);
    // The normal is rounded, too: by a part of the distance of the corner that rises most.
    rise = rise + fma(reach, Floats8(8 * kRounding), Floats8(4.0f) * place_error);
    const std::uint32_t rising = find_greater(rise, zero);
    // Most triangles rise steeply, or not at all; only others are worth finding how near they come.
    if (view.slope <= 0 || (rising & ~find_greater(rise, slope * reach)) == 0) return rising;
    const Vector8 low = t.find_low(), high = t.find_high();
    const Floats8 distance = max(max(max(low.x, zero - high.x), max(low.y, zero - high.y)), max(low.z, zero - high.z));
    return find_greater(rise, slope * max(distance, zero));
}

/// A box of samples: middle and half sizes.
struct SampleBox {
    float middle[3], half[3];
};

/// The box round the groups that have samples in the mask.
inline SampleBox find_box(const SampleSet& s, std::uint64_t mask) {
    float low[3] = {3e38f, 3e38f, 3e38f}, high[3] = {-3e38f, -3e38f, -3e38f};
    const float* middles[3] = {s.group_u, s.group_v, s.group_w};
    const float* reaches[3] = {s.reach_u, s.reach_v, s.reach_w};
    for (int group = 0; group < s.group_count; ++group) {
        if (!(mask >> (8 * group) & kGroupBits)) continue;
        for (int k = 0; k < 3; ++k) {
            const float from = middles[k][group] - reaches[k][group], to = middles[k][group] + reaches[k][group];
            low[k] = from < low[k] ? from : low[k];
            high[k] = to > high[k] ? to : high[k];
        }
    }
    SampleBox box;
    for (int k = 0; k < 3; ++k) box.middle[k] = 0.5f * (low[k] + high[k]), box.half[k] = 0.5f * (high[k] - low[k]);
    return box;
}

/// The lanes of the triangle that the receiver lies on.
inline std::uint32_t find_own(const Leaf& leaf, const Receiver& r) {
    std::uint32_t own = 0;
    for (int i = 0; i < kWidth; ++i) own |= std::uint32_t(leaf.triangle[i] == r.triangle) << i;
    if (own == 0) return 0;
    for (int i = 0; i < kWidth; ++i) own &= ~(std::uint32_t(leaf.instance[i] != r.instance) << i);
    return own;
}

/// The forms of a leaf's triangles. Lanes are those that rise over the receiver's plane, but for its own triangle.
inline void make_forms(const Leaf& leaf, const Receiver& r, const View& view, LeafForms& forms) {
    const NearTriangles t(leaf, r);
    const Floats8 a_size = find_largest(t.a), edge_size = max(find_largest(t.edge_1), find_largest(t.edge_2));
    // Of the corner a: its own rounding, that of its difference to the receiver, and the receiver's.
    const Floats8 place_error = fma(a_size, Floats8(2 * kRounding), Floats8(r.error + 4 * kRounding * leaf.size));
    forms.lanes = leaf.lanes & find_rising(t, view, a_size + edge_size, place_error);
    forms.unsure = forms.beyond = 0;
    if (forms.lanes != 0) forms.lanes &= ~find_own(leaf, r);
    if (forms.lanes == 0) return;

    const Floats8 zero(0.0f);
    Vector8 edges[3];
    edges[0] = cross(t.a, t.edge_1);
    edges[1] = cross(t.edge_2, t.a);
    const Vector8 across = cross(t.edge_1, t.edge_2);
    edges[2] = across - edges[0] - edges[1];
    const Floats8 volume = dot(t.a, across);
    // Bounds of rounding by magnitudes, each with a reserve of some times.
    const Floats8 corner = fma(a_size, Floats8(24 * kRounding), Floats8(6.0f) * place_error);
    const Floats8 edge_error = edge_size * fma(edge_size, Floats8(24 * kRounding), corner);
    const Floats8 volume_error = edge_size * edge_size * corner;
    forms.unsure = forms.lanes & ~find_greater(abs(volume), volume_error);
    if (float(leaf.origin[2] - r.at[2]) + 1.01f * leaf.size > r.light_low) {
        const Floats8 high = t.a.z + max(max(t.edge_1.z, t.edge_2.z), zero);
        forms.beyond = forms.lanes & find_greater(high + Floats8(4.0f) * place_error, Floats8(r.light_low));
    }
    for (int k = 0; k < 3; ++k) {
        const Vector8 e = with_sign_of(edges[k], volume);
        e.x.store(forms.by_u[k]), e.y.store(forms.by_v[k]), e.z.store(forms.by_w[k]);
        fma(e.z, Floats8(view.height), zero - fma(e.x, Floats8(view.base_u), e.y * Floats8(view.base_v)))
            .store(forms.at[k]);
    }
    (Floats8(view.direction_size) * edge_error).store(forms.error);
    abs(volume).store(forms.volume);
}

/// Leaves the lanes that may hide samples of the box; returns those that hide all of them.
template <bool kFlat>
inline std::uint32_t narrow_lanes(const SampleBox& box, LeafForms& forms) {
    const Floats8 zero(0.0f), error = Floats8::load(forms.error);
    std::uint32_t alive = ~0u, turned = ~0u, full = ~0u;
    for (int k = 0; k < 3; ++k) {
        const Floats8 by_u = Floats8::load(forms.by_u[k]), by_v = Floats8::load(forms.by_v[k]);
        Floats8 value =
            fma(by_u, Floats8(box.middle[0]), fma(by_v, Floats8(box.middle[1]), Floats8::load(forms.at[k])));
        Floats8 reach = fma(abs(by_u), Floats8(box.half[0]), abs(by_v) * Floats8(box.half[1]));
        if constexpr (!kFlat) {
            const Floats8 by_w = Floats8::load(forms.by_w[k]);
            value = fma(by_w, Floats8(box.middle[2]), value);
            reach = fma(abs(by_w), Floats8(box.half[2]), reach);
        }
        alive &= find_greater(value + reach, zero - error);
        turned &= find_greater(error, value - reach);
        full &= find_greater(value - reach, error);
    }
    forms.lanes &= alive | (turned & forms.unsure);
    return forms.lanes & full & ~(forms.unsure | forms.beyond);
}

/// A form of one triangle at eight places.
template <bool kFlat>
inline Floats8 evaluate(const LeafForms& f, int k, int lane, const float* u, const float* v, const float* w) {
    Floats8 value = fma(Floats8(f.by_u[k][lane]), Floats8::load(u), Floats8(f.at[k][lane]));
    value = fma(Floats8(f.by_v[k][lane]), Floats8::load(v), value);
    if constexpr (!kFlat) value = fma(Floats8(f.by_w[k][lane]), Floats8::load(w), value);
    return value;
}

/// How far a form gets from its value in the middle of each group.
template <bool kFlat>
inline Floats8 find_group_reach(const LeafForms& f, int k, int lane, const SampleSet& s) {
    const auto size = [](float x) { return Floats8(x < 0 ? -x : x); };
    Floats8 reach = size(f.by_u[k][lane]) * Floats8::load(s.reach_u);
    reach = fma(size(f.by_v[k][lane]), Floats8::load(s.reach_v), reach);
    if constexpr (!kFlat) reach = fma(size(f.by_w[k][lane]), Floats8::load(s.reach_w), reach);
    return reach;
}

struct Answer {
    std::uint64_t hidden, open;  ///< surely; to be decided in double
};

/// The samples of a group: what a triangle hides of them.
template <bool kFlat>
inline void test_group(const LeafForms& f, int lane, const SampleSet& s, int group, std::uint64_t mask,
                       Answer& answer) {
    const Floats8 zero(0.0f), error(f.error[lane]);
    Floats8 value[3];
    for (int k = 0; k < 3; ++k)
        value[k] = evaluate<kFlat>(f, k, lane, s.u + 8 * group, s.v + 8 * group, s.w + 8 * group);
    Floats8 least = min(min(value[0], value[1]), value[2]);
    std::uint32_t hidden = find_greater(least, error), possible = find_greater(least, zero - error);
    if (f.unsure >> lane & 1u) {
        const Floats8 most = max(max(value[0], value[1]), value[2]);
        possible |= find_greater(error, most);
        hidden = 0;
    } else if (f.beyond >> lane & 1u) {
        // The triangle lies nearer than the sample where the sum of the forms, d . (b - a) x (c - a), exceeds the
        // volume.
        const Floats8 before = value[0] + value[1] + value[2] - Floats8(f.volume[lane]);
        const Floats8 slack = Floats8(4.0f) * error + Floats8(f.volume[lane] * (8 * kRounding));
        hidden &= find_greater(before, slack);
        possible &= find_greater(before, zero - slack);
    }
    const int shift = 8 * group;
    answer.hidden |= (std::uint64_t(hidden) << shift) & mask;
    answer.open |= (std::uint64_t(possible & ~hidden) << shift) & mask;
}

inline std::uint64_t spread_groups(std::uint32_t groups) {
    // Bit i becomes byte i; the last one by itself, or its copies would meet those of the first.
    const std::uint64_t bytes = (groups & 0x7f) * 0x0002040810204081ull & 0x0101010101010101ull;
    return (bytes | std::uint64_t(groups >> 7 & 1u) << 56) * kGroupBits;
}

template <bool kFlat>
inline Answer test_triangle(const LeafForms& f, int lane, const SampleSet& s, std::uint64_t mask) {
    Answer answer{0, 0};
    const Floats8 zero(0.0f), error(f.error[lane]);
    std::uint32_t alive = ~0u, full = ~0u, turned = ~0u;
    for (int k = 0; k < 3; ++k) {
        const Floats8 value = evaluate<kFlat>(f, k, lane, s.group_u, s.group_v, s.group_w);
        const Floats8 reach = find_group_reach<kFlat>(f, k, lane, s);
        alive &= find_greater(value + reach, zero - error);
        full &= find_greater(value - reach, error);
        turned &= find_greater(error, value - reach);
    }
    const bool is_unsure = f.unsure >> lane & 1u;
    if (is_unsure) alive |= turned;
    if (is_unsure || (f.beyond >> lane & 1u)) full = 0;
    const std::uint32_t present = (1u << s.group_count) - 1;
    alive &= present, full &= alive;
    answer.hidden = spread_groups(full) & mask;
    for (std::uint32_t left = alive & ~full; left != 0; left &= left - 1) {
        const int group = __builtin_ctz(left);
        if (mask >> (8 * group) & kGroupBits) test_group<kFlat>(f, lane, s, group, mask, answer);
    }
    return answer;
}

/// All triangles against one sample: lanes that hide it, and lanes that double must decide.
struct LaneAnswer {
    std::uint32_t hidden, open;
};

template <bool kFlat>
inline LaneAnswer test_sample(const LeafForms& f, const SampleSet& s, int sample) {
    const Floats8 zero(0.0f), error = Floats8::load(f.error), u(s.u[sample]), v(s.v[sample]);
    Floats8 value[3];
    for (int k = 0; k < 3; ++k) {
        value[k] = fma(Floats8::load(f.by_u[k]), u, fma(Floats8::load(f.by_v[k]), v, Floats8::load(f.at[k])));
        if constexpr (!kFlat) value[k] = fma(Floats8::load(f.by_w[k]), Floats8(s.w[sample]), value[k]);
    }
    const Floats8 least = min(min(value[0], value[1]), value[2]);
    std::uint32_t possible = find_greater(least, zero - error) & f.lanes, hidden = 0;
    if (possible != 0) hidden = find_greater(least, error) & f.lanes;
    if ((f.unsure | (f.beyond & possible)) == 0) return {hidden, possible & ~hidden};
    const Floats8 most = max(max(value[0], value[1]), value[2]), volume = Floats8::load(f.volume);
    possible |= find_greater(error, most) & f.unsure;
    // The triangle lies nearer than the sample where the sum of the forms, d . (b - a) x (c - a), exceeds the volume.
    const Floats8 before = value[0] + value[1] + value[2] - volume;
    const Floats8 slack = fma(volume, Floats8(8 * kRounding), Floats8(4.0f) * error);
    const std::uint32_t is_beyond = f.beyond & ~f.unsure;
    hidden &= ~f.unsure & (~is_beyond | find_greater(before, slack));
    possible &= ~is_beyond | find_greater(before, zero - slack);
    return {hidden, possible & ~hidden};
}

inline std::uint64_t settle(Trace& trace, const Leaf& leaf, const Receiver& r, int lane, std::uint64_t samples) {
    ++trace.counts.settled;
    return trace.settle(trace.context, r.number, leaf.instance[lane], leaf.triangle[lane], samples);
}

/// Sample by sample, which is best for few.
template <bool kFlat>
inline void test_samples(Trace& trace, const Leaf& leaf, const Receiver& r, const LeafForms& forms, std::uint64_t mask,
                         std::uint64_t& open) {
    for (std::uint64_t left = mask; left != 0; left &= left - 1) {
        const int sample = __builtin_ctzll(left);
        const std::uint64_t bit = std::uint64_t(1) << sample;
        const LaneAnswer answer = test_sample<kFlat>(forms, *trace.samples, sample);
        if (answer.hidden != 0) {
            open &= ~bit;
            continue;
        }
        for (std::uint32_t lanes = answer.open; lanes != 0 && (open & bit) != 0; lanes &= lanes - 1)
            open &= ~settle(trace, leaf, r, __builtin_ctz(lanes), bit);
    }
}

// Of up to so many samples it pays to look at their lines first.
constexpr int kFewSamples = 8;

/// Of a few samples, those whose lines may meet a triangle of the leaf: most meet none, and this is quicker than the
/// forms, which have a bound for each triangle and look at what lies behind the receiver, below it or beyond the light.
template <bool kFlat>
inline std::uint64_t find_meeting(const Leaf& leaf, const Receiver& r, const View& view, const SampleSet& s,
                                  std::uint64_t mask) {
    const NearTriangles t(leaf, r);
    const Vector8 across = cross(t.edge_1, t.edge_2);
    float away = 0;
    for (int k = 0; k < 3; ++k) {
        const float to = float(leaf.origin[k] - r.at[k]);
        away = to > away ? to : -to > away ? -to : away;
    }
    // The bound of make_forms for the largest values that any lane may have.
    const float a_size = away + leaf.size, edge_size = 2 * leaf.size;
    const float place_error = a_size * (2 * kRounding) + r.error + 4 * kRounding * leaf.size;
    const float corner = a_size * (24 * kRounding) + 6 * place_error;
    const Floats8 error(1.1f * view.direction_size * edge_size * (edge_size * (24 * kRounding) + corner));
    const Floats8 zero(0.0f);
    std::uint64_t meeting = 0;
    for (std::uint64_t left = mask; left != 0; left &= left - 1) {
        const int sample = __builtin_ctzll(left);
        const Vector8 d{Floats8(s.u[sample] - view.base_u), Floats8(s.v[sample] - view.base_v),
                        Floats8((kFlat ? 0 : s.w[sample]) + view.height)};
        const Vector8 side = cross(d, t.a);
        const Floats8 sum = dot(d, across), first = dot(side, t.edge_1), second = zero - dot(side, t.edge_2),
                      third = sum - first - second;
        const Floats8 least = min(min(first, second), third), most = max(max(first, second), third);
        const Floats8 inside = max(least, zero - most);
        if ((find_greater(inside, zero - error) & leaf.lanes) != 0) meeting |= left & -left;
    }
    return meeting;
}

// Of more samples than this triangles are first narrowed to those that may hide any of them.
constexpr int kManySamples = 12;
// A triangle against all samples takes about as long as so many samples against all triangles.
constexpr int kSamplesPerTriangle = 4;

/// Takes away from `open` what the leaf hides of `mask`. Returns how many samples that is.
template <bool kFlat>
inline int test_leaf(Trace& trace, const Leaf& leaf, const Receiver& r, const View& view, std::uint64_t mask,
                     std::uint64_t& open) {
    const SampleSet& samples = *trace.samples;
    const std::uint64_t before = open;
    LeafForms forms;
    make_forms(leaf, r, view, forms);
    if (forms.lanes == 0) return 0;
    const int count = __builtin_popcountll(mask);
    if (count > kManySamples && narrow_lanes<kFlat>(find_box(samples, mask), forms) != 0) {
        open &= ~mask;
        return __builtin_popcountll(before ^ open);
    }
    if (count <= kSamplesPerTriangle * __builtin_popcount(forms.lanes)) {
        test_samples<kFlat>(trace, leaf, r, forms, mask, open);
        return __builtin_popcountll(before ^ open);
    }
    for (std::uint32_t left = forms.lanes; left != 0 && (mask & open) != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        Answer answer = test_triangle<kFlat>(forms, lane, samples, mask & open);
        open &= ~answer.hidden;
        answer.open &= open;
        if (answer.open != 0) open &= ~settle(trace, leaf, r, lane, answer.open);
    }
    return __builtin_popcountll(before ^ open);
}

/// Notes for the receivers to come which leaf hid these samples.
inline void note_hidden(Trace& trace, std::uint32_t leaf, std::uint64_t hidden) {
    for (; hidden != 0; hidden &= hidden - 1) trace.last_hidden_by[__builtin_ctzll(hidden)] = leaf;
}

/// Samples whose last leaf is this.
inline std::uint64_t find_same(const std::uint32_t* leaves, std::uint32_t leaf, std::uint64_t mask) {
    std::uint64_t same = 0;
    for (; mask != 0; mask &= mask - 1)
        same |= std::uint64_t(leaves[__builtin_ctzll(mask)] == leaf) << __builtin_ctzll(mask);
    return same;
}

/// What hid samples from the receiver before mostly does so again.
template <bool kFlat>
void try_last(Trace& trace, const Receiver& r, const View& view, std::uint64_t& open) {
    for (std::uint64_t left = open; left != 0;) {
        const std::uint32_t leaf = trace.last_hidden_by[__builtin_ctzll(left)];
        const std::uint64_t same = find_same(trace.last_hidden_by, leaf, left);
        left &= ~same;
        if (leaf == kNoChild) continue;
        ++trace.counts.leaves;
        test_leaf<kFlat>(trace, get_leaf(trace, leaf), r, view, same, open);
        note_hidden(trace, kNoChild, same & open);
    }
}

/// Lanes that hide every sample of the box from the receiver.
inline std::uint32_t find_covering(const Leaf& leaf, const Receiver& r, const SampleSet& samples) {
    const View view(r, samples);
    SampleBox box;
    for (int k = 0; k < 3; ++k) {
        box.middle[k] = 0.5f * (samples.low[k] + samples.high[k]);
        // Larger than by the rounding of both.
        box.half[k] = 0.5f * (samples.high[k] - samples.low[k]) * (1 + 4 * kImageError);
    }
    LeafForms forms;
    make_forms(leaf, r, view, forms);
    return forms.lanes != 0 ? narrow_lanes<false>(box, forms) : 0;
}

}  // namespace
}  // namespace shadow_layers::soft_kernel
