// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The inner loop of exact visibility, built once per instruction set. Plain data only: what this header's users inline
// must not be shared between files that are compiled for different processors.

#include <cstddef>
#include <cstdint>

#include "base/instruction_set.h"
#include "lights/facing_formulas.h"

namespace shadow_layers::tile_kernel {

/// Consecutive pixels whose receivers are placed together.
struct alignas(64) ReceiverLanes {
    static constexpr int kCount = 16;
    // set by find_facing
    double x[kCount], y[kCount], z[kCount];                 ///< relative to the frame's origin
    std::int32_t in_cone[kCount], turned_to_light[kCount];  ///< 1 = yes, 0 = no
    // set by place_receivers
    std::int32_t tile[kCount];                            ///< in the view; -1: outside of it
    float tile_x[kCount], tile_y[kCount], depth[kCount];  ///< about the tile's middle, clip units
};

/// A light view's clip space from the frame's space, as rows, and its tiles.
struct Projection {
    double rows[4][4];
    double side;
};

/// Tiles that a caster may touch, [begin, end) on each axis.
struct TileExtent {
    int column_begin, column_end, row_begin, row_end;
    double greatest_depth;  ///< of its corners; infinite if it reaches behind the light

    int tile_count() const { return (column_end - column_begin) * (row_end - row_begin); }
};

/// A caster in a light view, ready to be drawn over tiles: four linear forms at + x * by_x + y * by_y in clip units of
/// the view. Forms 0 to 2 are its edges, >= 0 inside; form 3 is the depth_rz of its plane.
struct CasterTriangle {
    double at[4], by_x[4], by_y[4];
    double error[4];  ///< of the forms, from rounding in double
    TileExtent extent;
    std::uint32_t instance, triangle;
};

/// Receivers of one tile, side by side. Places are kept about the tile's middle, in clip units, so that float resolves
/// them far below a tile. `depth` is "depth_rz": larger nearer to the light; infinite in lanes that hold no receiver,
/// so that nothing shadows them.
struct alignas(64) ReceiverBlock {
    static constexpr std::uint32_t kLanes = 8;
    float x[kLanes], y[kLanes], depth[kLanes];
    std::uint32_t instance[kLanes], triangle[kLanes];  ///< seen there: never in its own shadow
    std::uint32_t pixel[kLanes];
};

/// What lies in a tile, as casters are culled by it.
struct TileContent {
    std::uint32_t first = 0, count = 0;
    float least_depth = 0;  ///< of what is farthest from the light
    float depth_error = 0;  ///< by how much depths may be off
};

/// A tile of receivers: first block, and how many receivers lie in it and the next ones.
struct Tile : TileContent {
    float place_error = 0;   ///< how far off x, y may be, because the frame's positions are rounded
    std::uint32_t busy = 0;  ///< 1 while a thread draws over it
    std::uint32_t instance = kMixed, triangle = kMixed;  ///< that all its receivers lie on, if it is one

    static constexpr std::uint32_t kMixed = 0xffffffffu;
};

/// side x side tiles over [-1, 1]^2 of the view's clip space, row-major. Receivers found to be in shadow leave.
struct Tiles {
    int side;
    double half_size;  ///< of a tile, clip units
    float largest_place_error;
    Tile* tiles;
    ReceiverBlock* blocks;
};

/// A pair that float can't decide.
struct OpenPair {
    std::uint32_t pixel, instance, triangle;
};

/// Where the answers go. `visible[pixel]` becomes 0 where float is sure. `settle` empties `open` when it is full.
struct Answers {
    std::uint8_t* visible;
    OpenPair* open;
    std::size_t open_count, open_capacity;
    void (*settle)(void* context, Answers& answers);
    void* context;
    std::uint64_t tests;  ///< receiver and triangle pairs looked at
};

/// What is built for an instruction set.
struct Build {
    const char* name;  ///< of the instruction set
    /// `positions` and `normals`: x, y, z of ReceiverLanes::kCount pixels. Leaves in_cone where there is no cone.
    void (*find_facing)(const facing::Source& source, const float* positions, const float* normals,
                        ReceiverLanes& lanes);
    void (*place_receivers)(const Projection& projection, ReceiverLanes& lanes);
    /// Draws the triangles over rows [row_begin, row_end) of the tiles. Threads may draw over the same tiles at once.
    void (*draw_triangles)(const CasterTriangle* triangles, std::size_t count, int row_begin, int row_end,
                           const Tiles& tiles, Answers& answers);
};

extern const Build kBuildBase, kBuildAvx2;

/// Of the instruction set in use.
inline const Build& choose_build() { return shadow_layers::choose_build(kBuildBase, kBuildAvx2); }

}  // namespace shadow_layers::tile_kernel
