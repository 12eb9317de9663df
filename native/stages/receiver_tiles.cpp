// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/receiver_tiles.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "base/thread_pool.h"
#include "lights/facing.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kPixelBlock = 1 << 13;
constexpr std::size_t kTileBlock = 1 << 12;
constexpr std::uint32_t kNoTile = 0xffffffffu;
// A float position is off by half a unit in the last place on each axis; the root of 3 and a reserve make it this.
constexpr double kPositionRounding = 1.0 / 8388608.0;  // 2^-23
// Measured: about so many receivers a tile do best, if all pixels of the picture are receivers.
constexpr double kReceiversPerTile = 8;

struct Place {
    float x, y, depth;
    std::uint32_t tile = kNoTile, rank;  ///< rank: among the tile's receivers
    std::uint8_t view;
};

/// +X -X +Y -Y +Z -Z of the light's axes, as shaders/lib/facing_lib.glsl has it.
int find_cube_face(const glm::dmat3& axes_ws, const glm::dvec3& direction_ws) {
    const glm::dvec3 direction = glm::transpose(axes_ws) * direction_ws, size = glm::abs(direction);
    if (size.x >= size.y && size.x >= size.z) return direction.x >= 0 ? 0 : 1;
    if (size.y >= size.z) return direction.y >= 0 ? 2 : 3;
    return direction.z >= 0 ? 4 : 5;
}

int choose_side(std::size_t pixel_count) {
    return std::clamp(int(std::sqrt(double(pixel_count) / kReceiversPerTile)), 16, 1024);
}

/// Works on all views of a position at once.
class Sorter {
public:
    Sorter(const Frame& frame, const Light& light, const LightPosition& position, int most_tiles, ThreadPool& threads)
        : frame_(frame), position_(position), rule_(frame, light, position), threads_(threads) {
        const glm::dmat4 ws_from_rel = glm::translate(glm::dmat4(1.0), frame.origin_ws);
        sorted_.views.resize(position.views.size());
        for (std::size_t k = 0; k < position.views.size(); ++k) {
            view_of_face_[position.views[k].face] = int(k);
            lc_from_rel_.push_back(position.views[k].lc_from_ws * ws_from_rel);
            ReceiverTiles& tiles = sorted_.views[k];
            tiles.side = std::clamp(most_tiles, 1, choose_side(frame.pixel_count()));
            tiles.half_size = 1.0 / tiles.side;
            tiles.count.assign(std::size_t(tiles.side) * std::size_t(tiles.side), 0);
        }
        sorted_.visible.resize(frame.pixel_count());
        places_.resize(frame.pixel_count());
    }

    SortedReceivers sort() {
        threads_.parallel_for(frame_.pixel_count(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
            float farthest = 0;
            for (std::size_t pixel = begin; pixel < end; ++pixel)
                if (place(pixel)) farthest = std::max(farthest, glm::length(frame_.positions_rel[pixel]));
            std::atomic_ref<float> shared(farthest_);
            float old = shared.load();
            while (old < farthest && !shared.compare_exchange_weak(old, farthest)) {
            }
        });
        for (ReceiverTiles& tiles : sorted_.views) set_runs(tiles);
        threads_.parallel_for(frame_.pixel_count(), kPixelBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pixel = begin; pixel < end; ++pixel) store(pixel);
        });
        for (std::size_t view = 0; view < sorted_.views.size(); ++view) bound_tiles(view);
        return std::move(sorted_);
    }

private:
    /// False if the pixel needs no caster.
    bool place(std::size_t pixel) {
        places_[pixel].tile = kNoTile;
        const Facing facing = rule_.classify(pixel);
        sorted_.visible[pixel] = facing == Facing::TurnedAway ? 0 : 1;
        if (facing != Facing::Lit) return false;
        int view = sorted_.views.empty() ? -1 : 0;
        if (position_.cube) view = view_of_face_[find_cube_face(position_.axes_ws, -rule_.get_to_light(pixel))];
        if (view < 0) return false;
        const glm::dvec4 lc = lc_from_rel_[std::size_t(view)] * glm::dvec4(frame_.positions_rel[pixel], 1.0);
        if (!(lc.w > 0)) return false;
        const glm::dvec3 ndc = glm::dvec3(lc) * (1 / lc.w);
        if (!(std::abs(ndc.x) <= 1 && std::abs(ndc.y) <= 1)) return false;
        ReceiverTiles& tiles = sorted_.views[std::size_t(view)];
        const int column = std::min(int((ndc.x + 1) * 0.5 * tiles.side), tiles.side - 1);
        const int row = std::min(int((ndc.y + 1) * 0.5 * tiles.side), tiles.side - 1);
        const std::uint32_t tile = std::uint32_t(row) * std::uint32_t(tiles.side) + std::uint32_t(column);
        const std::uint32_t rank =
            std::atomic_ref<std::uint32_t>(tiles.count[tile]).fetch_add(1, std::memory_order_relaxed);
        places_[pixel] = {float(ndc.x - tiles.middle(column)),
                          float(ndc.y - tiles.middle(row)),
                          float(ndc.z),
                          tile,
                          rank,
                          std::uint8_t(view)};
        return true;
    }

    static void set_runs(ReceiverTiles& tiles) {
        tiles.first.resize(tiles.count.size());
        std::uint32_t total = 0;
        for (std::size_t tile = 0; tile < tiles.count.size(); ++tile) {
            tiles.first[tile] = total;
            total += tiles.count[tile];
        }
        tiles.receiver_count = total;
        for (auto* values : {&tiles.x, &tiles.y, &tiles.depth}) values->resize(total + kTilePadding);
        tiles.pixel.resize(total + kTilePadding);
    }

    void store(std::size_t pixel) {
        const Place& place = places_[pixel];
        if (place.tile == kNoTile) return;
        ReceiverTiles& tiles = sorted_.views[place.view];
        const std::uint32_t slot = tiles.first[place.tile] + place.rank;
        tiles.x[slot] = place.x;
        tiles.y[slot] = place.y;
        tiles.depth[slot] = place.depth;
        tiles.pixel[slot] = std::uint32_t(pixel);
    }

    /// With position error e, x = X / w is off by e (|X row| + |x| |w row|) / w, and depth likewise. 1 / w follows from
    /// the depth: z = alpha + beta w for a perspective view.
    void bound_tiles(std::size_t view) {
        ReceiverTiles& tiles = sorted_.views[view];
        const LightView& light_view = position_.views[view];
        const glm::dmat4 rows = glm::transpose(lc_from_rel_[view]);
        glm::dvec4 length(0.0);
        for (int i = 0; i < 4; ++i) length[i] = glm::length(glm::dvec3(rows[i]));
        const double error = kPositionRounding * double(farthest_);
        const double near = light_view.near_ls, far = light_view.far_ls;
        tiles.least_depth.resize(tiles.count.size());
        tiles.place_error.resize(tiles.count.size());
        tiles.depth_error.resize(tiles.count.size());
        threads_.parallel_for(tiles.count.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t tile = begin; tile < end; ++tile) {
                float least = std::numeric_limits<float>::infinity(), greatest = -least;
                for (std::uint32_t i = tiles.first[tile]; i < tiles.first[tile] + tiles.count[tile]; ++i) {
                    least = std::min(least, tiles.depth[i]);
                    greatest = std::max(greatest, tiles.depth[i]);
                }
                tiles.least_depth[tile] = least;
                if (tiles.count[tile] == 0) continue;
                // depth = near (far - w) / (w (far - near)): 1 / w = (depth (far - near) / near + 1) / far
                const double over_w =
                    light_view.perspective ? std::max((double(greatest) * (far - near) / near + 1) / far, 1e-300) : 1.0;
                const double largest = std::max(std::abs(double(least)), std::abs(double(greatest)));
                tiles.place_error[tile] = float(error * over_w * (std::max(length.x, length.y) + length.w));
                tiles.depth_error[tile] = float(error * over_w * (length.z + largest * length.w));
            }
        });
        for (const float bound : tiles.place_error)
            tiles.largest_place_error = std::max(tiles.largest_place_error, bound);
    }

    const Frame& frame_;
    const LightPosition& position_;
    const FacingRule rule_;
    ThreadPool& threads_;
    int view_of_face_[6] = {-1, -1, -1, -1, -1, -1};
    std::vector<glm::dmat4> lc_from_rel_;
    std::vector<Place> places_;
    float farthest_ = 0;  ///< distance of the receivers from the camera
    SortedReceivers sorted_;
};

}  // namespace

SortedReceivers sort_receivers(const Frame& frame, const Light& light, const LightPosition& position, int most_tiles,
                               ThreadPool& threads) {
    return Sorter(frame, light, position, most_tiles, threads).sort();
}

}  // namespace shadow_layers
