// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_kernel.h"

#include "base/instruction_set.h"
#include "base/kernel_lanes.h"
#include "visibility/soft_kernel_leaves.h"
#include "visibility/soft_kernel_nodes.h"

namespace shadow_layers::soft_kernel {
namespace {

// Trees are no deeper than this allows (scene/box_tree.cpp), twice over for instances.
constexpr int kStackSize = 1024;
// A leaf that hides at least so many samples of one receiver is tried first for the next ones.
constexpr int kHintSamples = 8;

// Up to so many samples are followed as rays.
constexpr int kFewRays = 2;

struct Waiting {
    std::uint64_t mask;
    std::uint32_t child;
};

void note_hint(Trace& trace, std::uint32_t leaf) {
    for (int i = 0; i < trace.hint_count; ++i)
        if (trace.hints[i] == leaf) return;
    if (trace.hint_count < Trace::kMostHints) {
        trace.hints[trace.hint_count++] = leaf;
        return;
    }
    for (int i = 1; i < Trace::kMostHints; ++i) trace.hints[i - 1] = trace.hints[i];
    trace.hints[Trace::kMostHints - 1] = leaf;
}

inline const Leaf& get_leaf(const Trace& trace, std::uint32_t link) {
    const std::uint32_t number = link & ~(kLeaf | kOfBlock);
    return link & kOfBlock ? trace.roots.leaves[number] : trace.tree.leaves[number];
}

template <bool kFlat>
void try_hints(Trace& trace, const Receiver& r, const View& view, std::uint64_t& open) {
    int kept = 0;
    for (int i = 0; i < trace.hint_count && open != 0; ++i) {
        const std::uint32_t leaf = trace.hints[i];
        if (test_leaf<kFlat>(trace, get_leaf(trace, leaf), r, view, open, open) >= kHintSamples)
            trace.hints[kept++] = leaf;
    }
    if (open != 0) trace.hint_count = kept;
}

template <bool kFlat>
std::uint64_t trace_tree(Trace& trace, const Receiver& r, std::uint64_t open) {
    const View view(r, *trace.samples);
    try_hints<kFlat>(trace, r, view, open);
    Waiting stack[kStackSize];
    int top = 0;
    const auto open_node = [&](const Node& node, std::uint64_t mask) {
        ++trace.counts.nodes;
        std::uint64_t masks[kWidth];
        std::uint32_t children = __builtin_popcountll(mask) <= kFewRays
                                     ? test_rays(node, view, *trace.samples, mask, masks)
                                     : test_node(node, view, *trace.tables, mask, masks);
        for (; children != 0; children &= children - 1) {
            const int i = __builtin_ctz(children);
            stack[top++] = {masks[i], node.child[i]};
        }
    };
    for (int root = 0; root < trace.roots.count && open != 0; ++root) {
        open_node(trace.roots.nodes[root], open);
        while (top > 0) {
            const Waiting next = stack[--top];
            const std::uint64_t mask = next.mask & open;
            if (mask == 0) continue;
            if (!(next.child & kLeaf)) {
                open_node(trace.tree.nodes[next.child], mask);
                continue;
            }
            const Leaf& leaf = get_leaf(trace, next.child);
            if (test_leaf<kFlat>(trace, leaf, r, view, mask, open) >= kHintSamples) note_hint(trace, next.child);
            if (open == 0) return 0;
        }
    }
    return open;
}

std::uint64_t trace_receiver(Trace& trace, const Receiver& r, std::uint64_t open) {
    return trace.samples->is_flat ? trace_tree<true>(trace, r, open) : trace_tree<false>(trace, r, open);
}

void weigh(const SampleSet& s, const Receiver& r, bool is_area, std::uint64_t lit, std::uint64_t visible,
           float& lit_weight, float& visible_weight) {
    const Floats8 zero(0.0f);
    alignas(32) float weights[kWidth];
    lit_weight = visible_weight = 0;
    // In parts of the light's distance, so that no square leaves the range of a float.
    const auto size = [](float x) { return x < 0 ? -x : x; };
    // All sets of a light have one scale, or an area light's would be weighed by different units.
    const float away = size(r.base_u) + size(r.base_v) + size(r.height),
                least = 1e-8f * (s.high[0] - s.low[0]) + 1e-37f;
    const Floats8 scale(1.0f / (away > least ? away : least));
    for (int group = 0; group < s.group_count; ++group) {
        const Floats8 u = (Floats8::load(s.u + 8 * group) - Floats8(r.base_u)) * scale;
        const Floats8 v = (Floats8::load(s.v + 8 * group) - Floats8(r.base_v)) * scale;
        const Floats8 w = (Floats8::load(s.w + 8 * group) + Floats8(r.height)) * scale;
        const Floats8 squared = fma(u, u, fma(v, v, w * w));
        const Floats8 along = fma(u, Floats8(r.normal[0]), fma(v, Floats8(r.normal[1]), w * Floats8(r.normal[2])));
        const Floats8 weight = is_area ? along * w / (squared * squared) : along / sqrt(squared);
        max(weight, zero).store(weights);
        for (int i = 0; i < kWidth; ++i) {
            const std::uint64_t bit = std::uint64_t(1) << (8 * group + i);
            if (lit & bit) lit_weight += weights[i];
            if (lit & visible & bit) visible_weight += weights[i];
        }
    }
}

}  // namespace

extern const Build SHADOW_LAYERS_OF_SET(kBuild){get_name(InstructionSet::SHADOW_LAYERS_SET), trace_receiver,
                                                find_covering, test_shaft, weigh};

}  // namespace shadow_layers::soft_kernel
