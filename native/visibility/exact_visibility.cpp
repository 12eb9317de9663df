// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/exact_visibility.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>

#include "scene/mesh_clusters.h"
#include "visibility/caster_clusters.h"
#include "visibility/caster_forms.h"
#include "visibility/occlusion_rule.h"
#include "visibility/tile_kernel.h"

namespace shadow_layers {
namespace {

using tile_kernel::CasterTriangle;

// Clusters between two looks for a cancel. The first ones are few: what they shadow spares work on all others.
constexpr std::size_t kFirstClusters = 1 << 6, kMostClusters = 1 << 9;
// Triangles over more tiles than this are drawn by all threads together, in bands of rows.
constexpr int kWideTiles = 1 << 12;
constexpr std::size_t kBandRows = 4;
constexpr std::size_t kOpenPairs = 1 << 8;

class ViewDraw {
public:
    ViewDraw(Engine& engine, const ReceiverSource& source, const LightView& view, const OcclusionRule& rule,
             ReceiverTiles& receivers, std::vector<std::uint8_t>& visible)
        : engine_(engine),
          source_(source),
          rule_(rule),
          visible_(visible),
          casters_(*source.scene, view),
          // Places are off by this much at most; a tile's own bound is used where it counts.
          grid_{receivers.side, 1e-9 + double(receivers.largest_place_error), receivers.tiles.data()},
          tiles_{receivers.side, receivers.half_size, receivers.largest_place_error, receivers.tiles.data(),
                 receivers.blocks} {}

    void draw() {
        const std::vector<CasterCluster> clusters = list_clusters(engine_, *source_.scene, casters_, grid_);
        std::size_t at_once = kFirstClusters;
        for (std::size_t first = 0; first < clusters.size();) {
            engine_.check_cancelled();
            const std::size_t count = std::min(at_once, clusters.size() - first);
            engine_.threads().parallel_for(count, 1,
                                           [&](std::size_t i, std::size_t) { draw_cluster(clusters[first + i]); });
            draw_wide();
            first += count;
            at_once = std::min(2 * at_once, kMostClusters);
        }
        engine_.count("caster_triangles", std::int64_t(casters_.size()));
        engine_.count("tile_tests", std::int64_t(tests_));
        engine_.count("open_pairs", std::int64_t(open_pairs_));
    }

private:
    void draw_cluster(const CasterCluster& cluster) {
        if (!may_meet_receivers(cluster, grid_)) return;
        std::array<CasterTriangle, kClusterTriangles> triangles;
        const std::size_t count = casters_.set_up(cluster.begin, cluster.end, grid_, triangles.data());
        std::size_t narrow = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const CasterTriangle& t = triangles[i];
            if (t.extent.tile_count() <= kWideTiles)
                triangles[narrow++] = t;
            else
                keep_wide(t);
        }
        draw_rows(triangles.data(), narrow, 0, grid_.side);
    }

    void keep_wide(const CasterTriangle& triangle) {
        const std::lock_guard lock(wide_mutex_);
        wide_.push_back(triangle);
    }

    void draw_wide() {
        if (wide_.empty()) return;
        engine_.threads().parallel_for(std::size_t(grid_.side), kBandRows, [&](std::size_t begin, std::size_t end) {
            draw_rows(wide_.data(), wide_.size(), int(begin), int(end));
        });
        wide_.clear();
    }

    void draw_rows(const CasterTriangle* triangles, std::size_t count, int row_begin, int row_end) {
        std::array<tile_kernel::OpenPair, kOpenPairs> open;
        tile_kernel::Answers answers{visible_.data(), open.data(), 0, open.size(), &ViewDraw::settle, this, 0};
        build_.draw_triangles(triangles, count, row_begin, row_end, tiles_, answers);
        settle(this, answers);
        tests_ += answers.tests;
    }

    static void settle(void* context, tile_kernel::Answers& answers) {
        auto& self = *static_cast<ViewDraw*>(context);
        self.open_pairs_ += answers.open_count;
        for (std::size_t i = 0; i < answers.open_count; ++i) {
            const tile_kernel::OpenPair& pair = answers.open[i];
            const std::atomic_ref<std::uint8_t> visible(self.visible_[pair.pixel]);
            if (!visible.load(std::memory_order_relaxed)) continue;
            const glm::dvec3 receiver = self.rule_.find_receiver(pair.pixel);
            if (self.rule_.is_blocked(receiver, self.source_.ids[pair.pixel], {pair.instance, pair.triangle}))
                visible.store(0, std::memory_order_relaxed);
        }
        answers.open_count = 0;
    }

    Engine& engine_;
    const ReceiverSource& source_;
    const OcclusionRule& rule_;
    std::vector<std::uint8_t>& visible_;
    const CasterRow casters_;
    const CasterGrid grid_;
    const tile_kernel::Tiles tiles_;
    std::mutex wide_mutex_;
    std::vector<CasterTriangle> wide_;
    const tile_kernel::Build& build_ = tile_kernel::choose_build();
    std::atomic<std::uint64_t> tests_{0}, open_pairs_{0};
};

}  // namespace

const std::vector<std::uint8_t>& ExactVisibility::compute(Engine& engine, const ReceiverSource& receivers,
                                                          const Light& light, const LightSample& sample,
                                                          int most_tiles) {
    {
        const auto timer = engine.time_stage("receiver_tiles");
        sorter_.sort(receivers, light, sample, most_tiles, engine.threads());
        engine.count("list_bytes", std::int64_t(sorter_.byte_size()));
    }
    const auto timer = engine.time_stage("caster_tiles");
    const OcclusionRule rule(receivers, sample);
    for (std::size_t view = 0; view < sample.views.size(); ++view) {
        ReceiverTiles& tiles = sorter_.views()[view];
        engine.count("receivers", std::int64_t(tiles.receiver_count));
        ViewDraw(engine, receivers, sample.views[view], rule, tiles, sorter_.visible()).draw();
    }
    return sorter_.visible();
}

}  // namespace shadow_layers
