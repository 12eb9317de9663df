// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/exact_visibility.h"

#include <algorithm>
#include <atomic>

#include "stages/caster_forms.h"
#include "stages/occlusion_rule.h"
#include "stages/receiver_tiles.h"
#include "stages/tile_kernel.h"

namespace shadow_layers {
namespace {

using tile_kernel::CasterTriangle;

// Triangles are set up and drawn in chunks, so that memory stays bounded.
constexpr std::size_t kChunk = 1 << 16;
constexpr std::size_t kSetupBlock = 1 << 10;
constexpr int kBandCount = 16;
constexpr std::size_t kOpenPairs = 1 << 12;

class ViewDraw {
public:
    ViewDraw(Engine& engine, const Frame& frame, const LightView& view, const OcclusionRule& rule, ReceiverTiles tiles,
             std::vector<std::uint8_t>& visible)
        : engine_(engine),
          frame_(frame),
          rule_(rule),
          sorted_(std::move(tiles)),
          visible_(visible),
          casters_(*frame.scene, view) {}

    void draw() {
        const std::size_t total = casters_.size();
        triangles_.resize(std::min(kChunk, total));
        engine_.count("list_bytes", std::int64_t(sorted_.byte_size() + triangles_.size() * sizeof(CasterTriangle)));
        for (std::size_t begin = 0; begin < total; begin += kChunk) {
            engine_.check_cancelled();
            const std::size_t count = std::min(kChunk, total - begin);
            set_up(begin, count);
            draw_bands(count);
        }
        engine_.count("caster_triangles", std::int64_t(total));
        engine_.count("tile_tests", std::int64_t(tests_));
        engine_.count("open_pairs", std::int64_t(open_pairs_));
    }

private:
    void set_up(std::size_t begin, std::size_t count) {
        // Places are bounded to this much; a tile's own bound is used where it counts.
        const double margin = 1e-9 + double(sorted_.largest_place_error);
        engine_.threads().parallel_for(count, kSetupBlock, [&](std::size_t from, std::size_t to) {
            for (std::size_t slot = from; slot < to; ++slot) {
                CasterTriangle& t = triangles_[slot];
                if (!casters_.set_up(begin + slot, sorted_.side, margin, t, sorted_.count.data()))
                    t.row_end = t.row_begin = 0;
            }
        });
    }

    void draw_bands(std::size_t count) {
        const int rows = (sorted_.side + kBandCount - 1) / kBandCount;
        const std::size_t bands = std::size_t((sorted_.side + rows - 1) / rows);
        engine_.threads().parallel_for(bands, 1, [&](std::size_t band, std::size_t) {
            draw_band(count, int(band) * rows, std::min(int(band + 1) * rows, sorted_.side));
        });
    }

    void draw_band(std::size_t count, int row_begin, int row_end) {
        std::vector<std::uint32_t> order;
        for (std::size_t i = 0; i < count; ++i)
            if (triangles_[i].row_begin < row_end && triangles_[i].row_end > row_begin)
                order.push_back(std::uint32_t(i));
        std::vector<tile_kernel::OpenPair> open(kOpenPairs);
        tile_kernel::Tiles tiles{sorted_.side,
                                 sorted_.half_size,
                                 sorted_.first.data(),
                                 sorted_.count.data(),
                                 sorted_.least_depth.data(),
                                 sorted_.place_error.data(),
                                 sorted_.depth_error.data(),
                                 sorted_.x.data(),
                                 sorted_.y.data(),
                                 sorted_.depth.data(),
                                 sorted_.pixel.data()};
        static_assert(sizeof(PixelIds) == 2 * sizeof(std::uint32_t));
        tile_kernel::Answers answers{
            visible_.data(), &frame_.ids.data()->instance, open.data(), 0, open.size(), &ViewDraw::settle, this, 0};
        draw_triangles_(triangles_.data(), order.data(), order.size(), row_begin, row_end, tiles, answers);
        settle(this, answers);
        tests_ += answers.tests;
    }

    static void settle(void* context, tile_kernel::Answers& answers) {
        auto& self = *static_cast<ViewDraw*>(context);
        self.open_pairs_ += answers.open_count;
        for (std::size_t i = 0; i < answers.open_count; ++i) {
            const tile_kernel::OpenPair& pair = answers.open[i];
            if (!self.visible_[pair.pixel]) continue;
            const glm::dvec3 receiver = self.rule_.find_receiver(pair.pixel);
            if (self.rule_.is_blocked(receiver, self.frame_.ids[pair.pixel], {pair.instance, pair.triangle}))
                self.visible_[pair.pixel] = 0;
        }
        answers.open_count = 0;
    }

    Engine& engine_;
    const Frame& frame_;
    const OcclusionRule& rule_;
    ReceiverTiles sorted_;
    std::vector<std::uint8_t>& visible_;
    CasterRow casters_;
    std::vector<CasterTriangle> triangles_;
    const tile_kernel::DrawTriangles draw_triangles_ = tile_kernel::choose_draw_triangles();
    std::atomic<std::uint64_t> tests_{0}, open_pairs_{0};
};

}  // namespace

std::vector<std::uint8_t> compute_exact_visibility(Engine& engine, const Frame& frame, const Light& light,
                                                   const LightPosition& position, int most_tiles) {
    SortedReceivers sorted;
    {
        const auto timer = engine.time_stage("receiver_tiles");
        sorted = sort_receivers(frame, light, position, most_tiles, engine.threads());
    }
    const auto timer = engine.time_stage("caster_tiles");
    const OcclusionRule rule(frame, position);
    for (std::size_t view = 0; view < position.views.size(); ++view) {
        engine.count("receivers", std::int64_t(sorted.views[view].receiver_count));
        ViewDraw(engine, frame, position.views[view], rule, std::move(sorted.views[view]), sorted.visible).draw();
    }
    return std::move(sorted.visible);
}

}  // namespace shadow_layers
