// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/receiver_tiles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "base/thread_pool.h"
#include "lights/facing.h"
#include "visibility/tile_bounds.h"

namespace shadow_layers {
namespace {

using tile_kernel::ReceiverBlock;
using tile_kernel::ReceiverLanes;
using tile_kernel::Tile;

constexpr std::uint32_t kLanes = ReceiverBlock::kLanes;
// The picture is cut into parts that count the receivers of each tile by themselves: without a lock, and in few of them
// because each has counts for all tiles.
constexpr int kPartsPerThread = 2;
constexpr std::size_t kMostParts = 32;
// Measured: about so many receivers a tile do best, if all pixels of the picture are receivers.
constexpr double kReceiversPerTile = 16;

int choose_side(std::size_t pixel_count) {
    return std::clamp(int(std::sqrt(double(pixel_count) / kReceiversPerTile)), 16, 1024);
}

/// Makes room for `count` values, with a reserve where what is there doesn't do; nothing is cleared.
template <class T>
void make_room(std::vector<T>& values, std::size_t count) {
    if (values.size() >= count && values.size() / 4 <= count) return;
    values = {};  // frees before it takes
    values = std::vector<T>(count + count / 8);
}

}  // namespace

/// Works on all views of a light sample at once.
class ReceiverSorter::Run {
public:
    Run(ReceiverSorter& sorter, const ReceiverSource& source, const Light& light, const LightSample& sample,
        int most_tiles, ThreadPool& threads)
        : sorter_(sorter), source_(source), sample_(sample), rule_(source, light, sample), threads_(threads) {
        const glm::dmat4 ws_from_rel = glm::translate(glm::dmat4(1.0), source.origin_ws);
        sorter.views_.resize(sample.views.size());
        for (std::size_t k = 0; k < sample.views.size(); ++k) {
            ReceiverTiles& tiles = sorter.views_[k];
            tiles.side = std::clamp(most_tiles, 1, choose_side(source.count() / sample.views.size()));
            tiles.half_size = 1.0 / tiles.side;
            tiles.tiles.resize(std::size_t(tiles.side) * std::size_t(tiles.side));
            rows_.push_back(glm::transpose(sample.views[k].lc_from_ws * ws_from_rel));
            projections_.push_back(make_projection(rows_.back(), tiles.side));
            first_tile_.push_back(std::uint32_t(tile_count_));
            tile_count_ += tiles.tiles.size();
        }
        part_count_ = std::min(std::size_t(kPartsPerThread * threads.thread_count()), kMostParts);
        sorter.visible_.resize(source.count());
        make_room(sorter.places_, source.count());
        parts_.resize(part_count_);
        sorter.offsets_.assign(part_count_ * tile_count_, 0);
    }

    void sort() {
        for_each_part([&](std::size_t part, std::size_t begin, std::size_t end) { place_part(part, begin, end); });
        set_runs();
        for_each_part([&](std::size_t part, std::size_t begin, std::size_t) { store_part(part, begin); });
        double farthest = 0;
        for (const Part& part : parts_) farthest = std::max(farthest, part.farthest);
        for (std::size_t view = 0; view < sorter_.views_.size(); ++view)
            bound_tiles(sorter_.views_[view], sample_.views[view], rows_[view], farthest, threads_);
    }

private:
    static tile_kernel::Projection make_projection(const glm::dmat4& rows, int side) {
        tile_kernel::Projection projection{};
        projection.side = side;
        for (int row = 0; row < 4; ++row)
            for (int i = 0; i < 4; ++i) projection.rows[row][i] = rows[row][i];
        return projection;
    }

    template <class Body>
    void for_each_part(const Body& body) {
        const std::size_t count = source_.count();
        threads_.parallel_for(part_count_, 1, [&](std::size_t part, std::size_t) {
            body(part, part * count / part_count_, (part + 1) * count / part_count_);
        });
    }

    void place_part(std::size_t part, std::size_t begin, std::size_t end) {
        ReceiverLanes lanes{};
        std::fill(std::begin(lanes.in_cone), std::end(lanes.in_cone), 1);
        std::uint32_t* counts = sorter_.offsets_.data() + part * tile_count_;
        Place* next = sorter_.places_.data() + begin;
        double farthest_squared = 0;
        for (std::size_t first = begin; first < end; first += ReceiverLanes::kCount) {
            const int count = int(std::min(std::size_t(ReceiverLanes::kCount), end - first));
            const std::uint32_t lit = classify(first, count, lanes);
            next = place(first, lit, lanes, counts, next, farthest_squared);
        }
        parts_[part] = {std::size_t(next - sorter_.places_.data()), std::sqrt(farthest_squared)};
    }

    /// Bits of the lanes whose visibility the casters decide; sets the visibility of all.
    std::uint32_t classify(std::size_t first, int count, ReceiverLanes& lanes) {
        find_facing(first, count, lanes);
        std::int32_t reached[ReceiverLanes::kCount] = {};  // 1: linked receivers inside the cone
        for (int i = 0; i < count; ++i) reached[i] = rule_.is_candidate(first + std::size_t(i));
        for (int i = 0; i < ReceiverLanes::kCount; ++i) reached[i] &= lanes.in_cone[i];
        std::uint8_t* visible = sorter_.visible_.data() + first;
        for (int i = 0; i < count; ++i) visible[i] = std::uint8_t(1 & ~(reached[i] & ~lanes.turned_to_light[i]));
        std::uint32_t lit = 0;
        for (int i = 0; i < ReceiverLanes::kCount; ++i)
            lit |= std::uint32_t(reached[i] & lanes.turned_to_light[i]) << i;
        return lit;
    }

    void find_facing(std::size_t first, int count, ReceiverLanes& lanes) const {
        static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
        const float *positions = &source_.positions_rel[first].x, *normals = &source_.normals[first].x;
        float padded[2][3 * ReceiverLanes::kCount] = {};
        if (count < ReceiverLanes::kCount) {  // the picture's last pixels: nothing may be read behind them
            std::copy_n(positions, 3 * count, padded[0]);
            std::copy_n(normals, 3 * count, padded[1]);
            positions = padded[0], normals = padded[1];
        }
        build_.find_facing(rule_.source(), positions, normals, lanes);
    }

    int find_view(std::size_t pixel) const {
        return choose_view(sample_.choice, glm::transpose(sample_.axes_ws) * -rule_.get_to_light(pixel));
    }

    /// Of the lanes in `lit`, those that fall into this view.
    std::uint32_t keep_view(std::size_t first, std::uint32_t lit, int view) const {
        if (sample_.choice.kind.x == kOneView) return lit;
        std::uint32_t here = 0;
        for (std::uint32_t left = lit; left != 0; left &= left - 1) {
            const int i = std::countr_zero(left);
            if (find_view(first + std::size_t(i)) == view) here |= 1u << i;
        }
        return here;
    }

    /// Finds the tiles of these lanes, view by view, and counts them.
    Place* place(std::size_t first, std::uint32_t lit, ReceiverLanes& lanes, std::uint32_t* counts, Place* next,
                 double& farthest_squared) const {
        while (lit != 0) {
            const int view = find_view(first + std::size_t(std::countr_zero(lit)));
            std::uint32_t here = keep_view(first, lit, view);
            lit &= ~here;
            if (view < 0) continue;
            build_.place_receivers(projections_[std::size_t(view)], lanes);
            const std::uint32_t first_tile = first_tile_[std::size_t(view)];
            for (; here != 0; here &= here - 1) {
                const int i = std::countr_zero(here);
                if (lanes.tile[i] < 0) continue;
                const std::uint32_t tile = first_tile + std::uint32_t(lanes.tile[i]);
                const glm::dvec3 receiver(lanes.x[i], lanes.y[i], lanes.z[i]);
                farthest_squared = std::max(farthest_squared, glm::dot(receiver, receiver));
                *next++ = {lanes.tile_x[i], lanes.tile_y[i],
                           lanes.depth[i],  tile,
                           counts[tile]++,  std::uint32_t(first) + std::uint32_t(i)};
            }
        }
        return next;
    }

    /// Gives each tile its blocks, and each part of the picture its places in them.
    void set_runs() {
        std::uint32_t blocks = 0;
        std::size_t index = 0;
        for (ReceiverTiles& tiles : sorter_.views_) {
            tiles.receiver_count = 0;
            for (Tile& tile : tiles.tiles) {
                tile = Tile{};
                tile.first = blocks;
                for (std::size_t part = 0; part < part_count_; ++part) {
                    std::uint32_t& offset = sorter_.offsets_[part * tile_count_ + index];
                    tile.count += std::exchange(offset, blocks * kLanes + tile.count);
                }
                blocks += (tile.count + kLanes - 1) / kLanes;
                tiles.receiver_count += tile.count;
                ++index;
            }
        }
        make_room(sorter_.blocks_, blocks);
        for (ReceiverTiles& tiles : sorter_.views_) tiles.blocks = sorter_.blocks_.data();
    }

    void store_part(std::size_t part, std::size_t begin) {
        const std::uint32_t* offsets = sorter_.offsets_.data() + part * tile_count_;
        const Place* places = sorter_.places_.data();
        const PixelIds* ids = source_.ids.data();
        ReceiverBlock* blocks = sorter_.blocks_.data();
        for (std::size_t k = begin; k < parts_[part].end; ++k) {
            const Place& place = places[k];
            const std::uint32_t slot = offsets[place.tile] + place.rank, lane = slot % kLanes;
            ReceiverBlock& block = blocks[slot / kLanes];
            block.x[lane] = place.x;
            block.y[lane] = place.y;
            block.depth[lane] = place.depth;
            block.instance[lane] = ids[place.pixel].instance;
            block.triangle[lane] = ids[place.pixel].triangle;
            block.pixel[lane] = place.pixel;
        }
    }

    ReceiverSorter& sorter_;
    const ReceiverSource& source_;
    const LightSample& sample_;
    const FacingRule rule_;
    ThreadPool& threads_;
    const tile_kernel::Build& build_ = tile_kernel::choose_build();
    // by view
    std::vector<glm::dmat4> rows_;  ///< of the clip space from the frame's, as columns
    std::vector<tile_kernel::Projection> projections_;
    std::vector<std::uint32_t> first_tile_;
    std::size_t tile_count_ = 0, part_count_ = 1;
    struct Part {
        std::size_t end = 0;  ///< of its places
        double farthest = 0;  ///< distance of its receivers from the camera
    };
    std::vector<Part> parts_;
};

void ReceiverSorter::sort(const ReceiverSource& receivers, const Light& light, const LightSample& sample,
                          int most_tiles, ThreadPool& threads) {
    Run(*this, receivers, light, sample, most_tiles, threads).sort();
}

std::size_t ReceiverSorter::byte_size() const {
    std::size_t tiles = 0;
    for (const ReceiverTiles& view : views_) tiles += view.tiles.size();
    return tiles * sizeof(Tile) + blocks_.size() * sizeof(ReceiverBlock) + places_.size() * sizeof(Place) +
           offsets_.size() * sizeof(std::uint32_t) + visible_.size();
}

}  // namespace shadow_layers
