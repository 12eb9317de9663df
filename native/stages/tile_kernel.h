// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The inner loop of exact visibility, built once per instruction set. Plain data only: what this header's users inline
// must not be shared between files that are compiled for different processors.

#include <cstddef>
#include <cstdint>

namespace shadow_layers::tile_kernel {

/// value(x, y) = at_origin + x * by_x + y * by_y, in clip units of a light view.
struct LinearForm {
    double at_origin, by_x, by_y;
};

/// A caster in a light view, ready to be drawn over tiles.
struct CasterTriangle {
    LinearForm edges[3];   ///< >= 0 inside
    LinearForm depth;      ///< depth_rz of its plane
    double edge_error[3];  ///< of at_origin + ..., from rounding in double
    double depth_error;
    double greatest_depth;  ///< of its corners; infinite if it reaches behind the light
    std::uint32_t instance, triangle;
    int column_begin, column_end, row_begin, row_end;  ///< tiles that it may touch
};

/// Receivers by tile; see ReceiverTiles. `count` shrinks as receivers are found to be in shadow.
struct Tiles {
    int side;
    double half_size;
    const std::uint32_t* first;
    std::uint32_t* count;
    const float *least_depth, *place_error, *depth_error;
    float *x, *y, *depth;
    std::uint32_t* pixel;
};

/// A pair that float can't decide.
struct OpenPair {
    std::uint32_t pixel, instance, triangle;
};

/// Where the answers go. `visible[pixel]` becomes 0 where float is sure. `settle` empties `open` when it is full.
struct Answers {
    std::uint8_t* visible;
    const std::uint32_t* ids;  ///< instance and triangle of each pixel's receiver: never in its own shadow
    OpenPair* open;
    std::size_t open_count, open_capacity;
    void (*settle)(void* context, Answers& answers);
    void* context;
    std::uint64_t tests;  ///< receiver and triangle pairs looked at
};

/// Draws the triangles over rows [row_begin, row_end) of the tiles. Tiles of a row belong to one caller.
using DrawTriangles = void (*)(const CasterTriangle* triangles, const std::uint32_t* order, std::size_t count,
                               int row_begin, int row_end, Tiles& tiles, Answers& answers);

void draw_triangles_base(const CasterTriangle*, const std::uint32_t*, std::size_t, int, int, Tiles&, Answers&);
#if defined(__x86_64__)
void draw_triangles_avx2(const CasterTriangle*, const std::uint32_t*, std::size_t, int, int, Tiles&, Answers&);
#endif

/// The best that this processor runs; `name` tells which.
DrawTriangles choose_draw_triangles(const char** name = nullptr);

}  // namespace shadow_layers::tile_kernel
