// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_kernel.h"

#include "base/instruction_set.h"
#include "base/kernel_lanes.h"
#include "visibility/soft_kernel_leaves.h"
#include "visibility/soft_kernel_nodes.h"

namespace shadow_layers::soft_kernel {
namespace {

template <bool kFlat>
std::uint64_t trace_tree(Trace& trace, const Receiver& r, std::uint64_t open) {
    const View view(r, *trace.samples);
    try_last<kFlat>(trace, r, view, open);
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
            std::uint64_t mask = next.mask & open;
            if (mask == 0) continue;
            if (!(next.child & kLeaf)) {
                open_node(trace.tree.nodes[next.child], mask);
                continue;
            }
            const Leaf& leaf = get_leaf(trace, next.child);
            ++trace.counts.leaves;
            if (__builtin_popcountll(mask) <= kFewSamples)
                mask = find_meeting<kFlat>(leaf, r, view, *trace.samples, mask);
            if (mask == 0) continue;
            const std::uint64_t before = open;
            if (test_leaf<kFlat>(trace, leaf, r, view, mask, open) > 0) note_hidden(trace, next.child, before & ~open);
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
