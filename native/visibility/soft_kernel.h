// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The inner loop of exact soft visibility, built once per instruction set. Plain data only, as in tile_kernel.h.
//
// Everything lies in a frame of the light, axes u, v, w: w points from the receivers towards the light. The direction
// from a receiver r to sample i is (u_i - r.base_u, v_i - r.base_v, r.height + w_i): for a light with a place, samples
// are points about its centre, base_u, base_v the receiver's place about that centre, and height how far the centre
// lies above it; for a sun, samples are slopes (a, b), base_u = base_v = 0, height = 1.

#include <cstddef>
#include <cstdint>

#include "base/instruction_set.h"

namespace shadow_layers::soft_kernel {

inline constexpr int kWidth = 8;         ///< children of a node, triangles of a leaf, samples of a group
inline constexpr int kMostSamples = 64;  ///< of a set: the bits of a mask
inline constexpr int kBins = 128;        ///< of a mask table
inline constexpr int kTableSize = kBins + 2;
/// Links: kLeaf and a leaf's number, kLeaf, kOfBlock and the number of a leaf of the block's own, or a node's number.
inline constexpr std::uint32_t kLeaf = 0x80000000u, kOfBlock = 0x40000000u, kNoChild = 0xffffffffu;

/// Children of a node: boxes in the light's frame, widened so that float arithmetic on them misses nothing.
struct alignas(64) Node {
    float low[3][kWidth], high[3][kWidth];  ///< low > high where there is none
    std::uint32_t child[kWidth];            ///< a link; kNoChild
};

/// Triangles of a leaf about its own origin: a corner and the two edges from it.
struct alignas(64) Leaf {
    float a[3][kWidth], edge_1[3][kWidth], edge_2[3][kWidth];  ///< all 0 in empty lanes
    double origin[3];
    float size;           ///< largest coordinate of any corner about the origin
    std::uint32_t lanes;  ///< bits of the lanes that hold a triangle
    std::uint32_t instance[kWidth], triangle[kWidth];
};

/// Which samples of a set may a box hide whose image on the plane w = 0 of the light is given? Entry x of `u_from`:
/// the samples in bin x - 1 of u and beyond; of `u_to`: those in bins up to x - 1. So a box from u_low to u_high may
/// hide u_from[x(u_low)] & u_to[x(u_high)]; the same in v.
struct MaskTables {
    float scale_u, offset_u, scale_v, offset_v;  ///< x(u) = u * scale_u + offset_u, held within [0, kBins + 1]
    std::uint64_t u_from[kTableSize], u_to[kTableSize], v_from[kTableSize], v_to[kTableSize];
};

/// Up to 64 samples of a light, in groups of eight that lie close together. Unused places repeat the first sample.
struct alignas(64) SampleSet {
    float u[kMostSamples], v[kMostSamples], w[kMostSamples];
    float group_u[kWidth], group_v[kWidth], group_w[kWidth];  ///< middles of the boxes of groups
    float reach_u[kWidth], reach_v[kWidth], reach_w[kWidth];  ///< half their sizes
    std::uint64_t all;                                        ///< the bits of samples that are there
    int group_count;
    bool is_flat;           ///< all w are 0
    float low[3], high[3];  ///< box of all samples
};

/// What is asked about one receiver and one set.
struct Receiver {
    double at[3];     ///< in the light's frame
    float normal[3];  ///< unit, towards the light's side; in the light's frame
    float base_u, base_v, height;
    /// Heights over the receiver, along w, between which the light lies. Of a sun, and only of one, both are larger
    /// than any triangle's. Low is less than any triangle's if samples may lie below the receiver.
    float light_low, light_high;
    float error;                       ///< how far off `at` may be, on each axis
    float least_slope;                 ///< of normal . d / |d| over directions to samples; <= 0: unknown
    std::uint32_t instance, triangle;  ///< that it lies on
    std::uint32_t is_near;  ///< 1: samples may lie beside or below it along w; no box is left out for where it lies
    std::uint32_t number;   ///< for `settle`
};

/// Roots of the tree as a block of receivers needs it: what its shaft has left.
struct Roots {
    const Node* nodes;  ///< with links into the tree, and to the block's leaves
    int count;
    const Leaf* leaves;
};

struct Tree {
    const Node* nodes;
    const Leaf* leaves;
};

struct Counts {
    std::uint64_t nodes, leaves, settled;  ///< tests of a node, of a leaf; pairs of receiver and triangle for `settle`
};

/// What a trace is done with; one for each thread.
struct Trace {
    Tree tree;
    Roots roots;
    const SampleSet* samples;
    const MaskTables* tables;
    /// Bits of the samples in `mask` that the triangle hides, in double.
    std::uint64_t (*settle)(void* context, std::uint32_t receiver, std::uint32_t instance, std::uint32_t triangle,
                            std::uint64_t mask);
    void* context;
    std::uint32_t* last_hidden_by;  ///< by sample: a link to the leaf that hid it from the receiver before; kNoChild
    Counts counts;
};

/// A block of receivers as one, for leaving out what none of them needs.
struct Shaft {
    float low[3], high[3];  ///< box of the receivers
    /// Of a sun: box of the slopes of all samples. Else: box on the plane w = sample_high[2], behind the whole light,
    /// of the images of all samples from any of the receivers. A little larger than that.
    float sample_low[3], sample_high[3];
    std::uint32_t directional;
    std::uint32_t is_near;    ///< as in Receiver, of any
    std::uint32_t has_plane;  ///< 1: all lie in the plane normal . p = offset, at least as high
    float normal[3], offset;
};

/// What is built for an instruction set.
struct Build {
    const char* name;
    /// Which of the samples in `open` does nothing hide?
    std::uint64_t (*trace)(Trace& trace, const Receiver& receiver, std::uint64_t open);
    /// Lanes of the leaf whose triangles hide all of the samples' box from the receiver; those that are there for sure.
    std::uint32_t (*find_covering)(const Leaf& leaf, const Receiver& receiver, const SampleSet& samples);
    /// Bits of the children that may hide something from the shaft's receivers.
    std::uint32_t (*test_shaft)(const Shaft& shaft, const Node& node);
    /// Sums of the samples' weights: of those in `lit`, and of those in `visible` among them. A sample counts by the
    /// cosine at the receiver; with `is_area` also by that at the light (along w) and by the inverse square of its
    /// distance. Up to a common factor.
    void (*weigh)(const SampleSet& samples, const Receiver& receiver, bool is_area, std::uint64_t lit,
                  std::uint64_t visible, float& lit_weight, float& visible_weight);
};

extern const Build kBuildBase, kBuildAvx2;

/// Of the instruction set in use.
inline const Build& choose_build() { return shadow_layers::choose_build(kBuildBase, kBuildAvx2); }

}  // namespace shadow_layers::soft_kernel
