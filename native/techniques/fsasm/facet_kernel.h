// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The inner loop of sub-pixel visibility, built once per instruction set. Plain data only, as in
// visibility/tile_kernel.h.

#include <cstddef>
#include <cstdint>

#include "visibility/tile_kernel.h"

namespace shadow_layers::facet_kernel {

using tile_kernel::CasterTriangle;

inline constexpr int kWords = 4;

/// at_origin + x * by_x + y * by_y.
struct LinearForm {
    double at_origin, by_x, by_y;
};

/// A facet in a view's clip space: x, y, z, w as linear forms over the pixel's square.
struct LightFacet {
    double at[4], by_x[4], by_y[4];
    double extent;  ///< bound of |x| + |y| + |w| over the square
    double depth_extent;
    double near;                    ///< casters whose plane comes nearer in depth are settled
    std::uint32_t in_view[kWords];  ///< samples that this view answers for
    std::uint32_t facet;            ///< number of it; of several views the same
    std::uint32_t is_alone;         ///< 1: no other view answers for it, and all of it lies in the cone
    std::uint32_t instance, triangle;
};

/// A pixel-texel pair: a facet in the list of a texel that it covers, and what the casters of that texel do to it.
struct FacetPair {
    std::uint32_t light_facet;
    std::uint32_t occluded[kWords];
    std::uint32_t cut[kWords];  ///< samples that the validity mask loses
};

/// Texels of a map of side x side with the pairs in them, row-major: numbers of the first pair, how many.
struct PairTexels {
    int side;
    double half_size;  ///< of a texel, in clip units
    const tile_kernel::TileContent* texels;
    FacetPair* pairs;
    const LightFacet* facets;
};

/// Four forms over a square: >= 0 where the three edges and the plane of a caster let it shadow the facet.
struct Conditions {
    double at[4], by_x[4], by_y[4];
    double half_range[4];  ///< what the slopes add within the square, at most
    double error[4];
};

/// Samples, and with `masks` the look-up table of half-planes instead of their places.
struct Samples {
    int count;
    const float *x, *y;
    const void* table;
    void (*look_up)(const void* table, double at, double by_x, double by_y, std::uint32_t (&mask)[kWords]);
};

struct Answers {
    /// Decides a pair whose triangle comes near the facet within the square and shadows the samples in `occluded`.
    void (*settle)(void* context, const CasterTriangle& caster, const LightFacet& facet, const Conditions& conditions,
                   const std::uint32_t (&occluded)[kWords], FacetPair& pair);
    void* context;
    std::uint64_t texel_pairs;  ///< triangle-texel pairs
    std::uint64_t evaluations;  ///< of a triangle and a pixel
    std::uint64_t contacts;     ///< settled
};

/// What is built for an instruction set.
struct Build {
    /// Removes from `mask` the samples where the form, of the place in the square, is negative. Places nearer to 0 than
    /// `error` are looked at in double.
    void (*mask_half_plane)(const Samples& samples, const LinearForm& form, double error,
                            std::uint32_t (&mask)[kWords]);
    /// Draws the triangles over rows [row_begin, row_end) of the texels. A pair belongs to one caller.
    void (*draw_triangles)(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count,
                           int row_begin, int row_end, const PairTexels& texels, const Samples& samples,
                           Answers& answers);
};

extern const Build kBuildBase, kBuildAvx2;

/// Of the instruction set in use.
inline const Build& choose_build() { return shadow_layers::choose_build(kBuildBase, kBuildAvx2); }

}  // namespace shadow_layers::facet_kernel
