// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part of tile_kernel.cpp: receivers are classified and placed in double, by as many lanes as a register has.

#include "base/kernel_arch.h"
#include "visibility/tile_kernel.h"

namespace shadow_layers::tile_kernel {
namespace {

using Doubles = xsimd::batch<double, Arch>;
constexpr int kDoubles = int(Doubles::size), kLaneCount = ReceiverLanes::kCount;
static_assert(kLaneCount % kDoubles == 0);

struct alignas(64) Values {
    double at[kLaneCount];
};

inline Doubles load(const double* values) { return Doubles::load_aligned(values); }

/// Every third float.
inline void spread(const float* from, double* to) {
    for (int i = 0; i < kLaneCount; ++i) to[i] = double(from[3 * i]);
}

template <class To>
inline void store(const Values& values, To* to) {
    for (int i = 0; i < kLaneCount; ++i) to[i] = To(values.at[i]);
}

inline void set_flags(const Doubles::batch_bool_type& flags, double* to) {
    xsimd::select(flags, Doubles(1.0), Doubles(0.0)).store_aligned(to);
}

inline void find_facing(const facing::Source& source, const float* positions, const float* normals,
                        ReceiverLanes& lanes) {
    using Vector = facing::Vector<Doubles>;
    Values normal[3], in_cone, turned;
    spread(positions, lanes.x), spread(positions + 1, lanes.y), spread(positions + 2, lanes.z);
    for (int k = 0; k < 3; ++k) spread(normals + k, normal[k].at);
    for (int i = 0; i < kLaneCount; i += kDoubles) {
        const Vector receiver{load(lanes.x + i), load(lanes.y + i), load(lanes.z + i)};
        const Vector up{load(normal[0].at + i), load(normal[1].at + i), load(normal[2].at + i)};
        const Vector to_light = facing::find_to_light(source, receiver);
        set_flags(facing::dot(up, to_light) > Doubles(0.0), turned.at + i);
        if (source.cone_cos > -1) set_flags(facing::is_in_cone(source, to_light), in_cone.at + i);
    }
    store(turned, lanes.turned_to_light);
    if (source.cone_cos > -1) store(in_cone, lanes.in_cone);
}

inline void place_receivers(const Projection& projection, ReceiverLanes& lanes) {
    const Doubles one(1.0), half(0.5), side(projection.side), width(2.0 / projection.side);
    Values tile, tile_x, tile_y, depth;
    for (int i = 0; i < kLaneCount; i += kDoubles) {
        const Doubles x = load(lanes.x + i), y = load(lanes.y + i), z = load(lanes.z + i);
        const auto transform = [&](int row) {
            const double* m = projection.rows[row];
            return Doubles(m[0]) * x + Doubles(m[1]) * y + Doubles(m[2]) * z + Doubles(m[3]);
        };
        const Doubles w = transform(3), over_w = one / w;
        const Doubles ndc_x = transform(0) * over_w, ndc_y = transform(1) * over_w;
        const auto inside = w > Doubles(0.0) && xsimd::abs(ndc_x) <= one && xsimd::abs(ndc_y) <= one;
        const auto find_tile = [&](const Doubles& ndc) {
            return xsimd::min(xsimd::trunc((ndc + one) * half * side), side - one);
        };
        const Doubles column = find_tile(ndc_x), row = find_tile(ndc_y);
        xsimd::select(inside, row * side + column, Doubles(-1.0)).store_aligned(tile.at + i);
        (ndc_x - ((column + half) * width - one)).store_aligned(tile_x.at + i);
        (ndc_y - ((row + half) * width - one)).store_aligned(tile_y.at + i);
        (transform(2) * over_w).store_aligned(depth.at + i);
    }
    store(tile, lanes.tile);
    store(tile_x, lanes.tile_x);
    store(tile_y, lanes.tile_y);
    store(depth, lanes.depth);
}

}  // namespace
}  // namespace shadow_layers::tile_kernel
