// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/afsm/receiver_lists.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "scene/mesh_clusters.h"
#include "techniques/afsm/list_values.h"
#include "visibility/caster_clusters.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kCastersAtOnce = 1 << 16;
constexpr std::size_t kClustersAtOnce = kCastersAtOnce / kClusterTriangles;
constexpr std::size_t kSetupBlock = 1 << 10;
constexpr std::size_t kAnswerBlock = 1 << 10;
constexpr std::size_t kMostGroups = 65535;  // that every driver takes
// About so many texels and receivers are looked at between two looks at the cancel token.
constexpr double kWorkAtOnce = 1e8;
// Beyond the rounding of a clip coordinate.
constexpr double kLeastMargin = 1e-9;

/// Number of casters from `begin` on that one draw may take.
std::size_t choose_piece(const std::vector<ListCaster>& casters, std::size_t begin, double receivers_per_texel) {
    double work = 0;
    std::size_t end = begin;
    while (end < casters.size() && work < kWorkAtOnce) {
        const glm::ivec4& rect = casters[end++].rect;
        work += double(rect.z - rect.x) * double(rect.w - rect.y) * (1 + receivers_per_texel);
    }
    return end;
}

std::vector<ListCaster> make_list_casters(ThreadPool& threads, const CasterRow& row,
                                          std::span<const CasterCluster> clusters, int side, double margin) {
    const auto triangles = set_up_clusters(threads, row, clusters, {side, margin});
    std::vector<ListCaster> casters(triangles.size());
    threads.parallel_for(casters.size(), kSetupBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) casters[i] = make_list_caster(triangles[i], side);
    });
    return casters;
}

}  // namespace

void ReceiverLists::fit(Engine& engine, int side, std::size_t receivers) {
    const gl::Device& device = engine.device();
    if (side_ != side) {
        const auto make = [&](GLenum format, const char* label) {
            return std::make_shared<gl::Texture>(device, gl::TextureDesc{format, side, side}, label);
        };
        head_tx_ = make(GL_R32UI, "list heads");
        farthest_tx_ = make(GL_R32UI, "farthest receivers");
        depth_tx_ = make(GL_DEPTH_COMPONENT32F, "depths of lists");
        target_ = gl::Framebuffer(device, "lists");
        target_.attach_depth(depth_tx_);
        side_ = side;
    }
    if (!counts_buf_) {
        counts_buf_ = gl::Buffer(device, sizeof(ListCounts), "list counts");
        casters_buf_ = gl::Buffer(device, kCastersAtOnce * sizeof(ListCaster), "list casters");
    }
    if (capacity_ >= receivers && capacity_ / 4 <= receivers) return;
    capacity_ = receivers;
    receivers_buf_ = gl::Buffer(device, receivers * sizeof(ListReceiver), "list receivers");
    next_buf_ = gl::Buffer(device, receivers * sizeof(std::uint32_t), "list links");
    blocked_buf_ = gl::Buffer(device, receivers * sizeof(std::uint32_t), "receivers in shadow");
    open_buf_ = gl::Buffer(device, receivers * sizeof(glm::uvec2), "open pairs");
}

void ReceiverLists::count_bytes(Engine& engine) {
    const std::size_t texels = std::size_t(side_) * std::size_t(side_) * 3 * sizeof(std::uint32_t);
    engine.count("map_bytes",
                 std::int64_t(texels + receivers_buf_.byte_size() + next_buf_.byte_size() + blocked_buf_.byte_size() +
                              open_buf_.byte_size() + casters_buf_.byte_size()));
    engine.count("list_bytes", std::int64_t(std::exchange(placed_bytes_, 0)));
}

void ReceiverLists::insert(Engine& engine, std::span<const ListReceiver> receivers) {
    const auto timer = engine.time_stage("receiver_lists");
    receivers_buf_.write(receivers.data(), receivers.size_bytes());
    blocked_buf_.clear();
    head_tx_->clear(&kListEnd);
    farthest_tx_->clear(&kNoReceiver);
    receivers_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kListReceiversSlot);
    next_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kListNextSlot);
    head_tx_->bind_image(kListHeadUnit, GL_READ_WRITE);
    farthest_tx_->bind_image(kListFarthestUnit, GL_READ_WRITE);
    const gl::Program& program = engine.program({"techniques/afsm/insert.comp"});
    program.use();
    program.set("u_count", unsigned(receivers.size()));
    program.set("u_side", unsigned(side_));
    engine.gl().DispatchCompute(Engine::group_count(int(receivers.size()), kInsertGroup), 1, 1);
    engine.gl().MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);

    engine.program("frame/fullscreen.vert", "techniques/afsm/farthest.frag").use();
    target_.bind();
    DrawState state;
    state.depth_test = state.depth_write = true;
    state.depth_function = GL_ALWAYS;
    state.color_write = false;
    engine.draw_fullscreen(state);
}

void ReceiverLists::draw(Engine& engine, const Task& task, std::vector<std::uint8_t>& visible) {
    tests_ = open_pairs_ = redraws_ = 0;
    const std::size_t total = task.sorted.receiver_count;
    engine.count("receivers", std::int64_t(total));
    if (total == 0 || task.view.casters.empty()) return;
    const int side = std::clamp(task.view.size_texels, 1, engine.limits().max_texture_size);
    PlacedReceivers placed;
    {
        const auto timer = engine.time_stage("receiver_places");
        placed = make_list_receivers(task.sorted, side, engine.threads());
    }
    float place_error = 0;
    for (const ListReceiver& receiver : placed.receivers) place_error = std::max(place_error, receiver.place_error);
    const std::size_t most =
        std::min(engine.limits().max_ssbo_bytes / sizeof(ListReceiver), kMostGroups * kInsertGroup);
    fit(engine, side, std::min(total, most));
    placed_bytes_ = std::max(placed_bytes_, placed.byte_size());
    for (std::size_t first = 0; first < total; first += most) {
        engine.check_cancelled();
        const std::size_t count = std::min(most, total - first);
        const Slice slice{task, std::span(placed.pixels).subspan(first, count), visible};
        insert(engine, std::span(placed.receivers).subspan(first, count));
        draw_casters(engine, slice, double(place_error));
        take_answers(engine, slice);
    }
    engine.count("list_tests", tests_);
    engine.count("open_pairs", open_pairs_);
    engine.count("redraws", redraws_);
}

void ReceiverLists::draw_casters(Engine& engine, const Slice& slice, double place_error) {
    const CasterRow row(*slice.task.frame.scene, slice.task.view);
    const double margin = kLeastMargin + place_error * 2 / side_;
    const double receivers_per_texel = double(slice.pixels.size()) / (double(side_) * double(side_));
    const gl::Program& program = engine.program("techniques/afsm/casters.vert", "techniques/afsm/casters.frag");
    const auto clusters = list_clusters(engine, *slice.task.frame.scene, row, {side_, margin});
    for (std::size_t begin = 0; begin < clusters.size(); begin += kClustersAtOnce) {
        engine.check_cancelled();
        const auto timer = engine.time_stage("caster_lists");
        const std::size_t count = std::min(kClustersAtOnce, clusters.size() - begin);
        casters_ = make_list_casters(engine.threads(), row, std::span(clusters).subspan(begin, count), side_, margin);
        if (casters_.empty()) continue;
        casters_buf_.write(casters_.data(), casters_.size() * sizeof(ListCaster));
        blocked_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kListBlockedSlot);
        casters_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kListCastersSlot);
        counts_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kListCountsSlot);
        open_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, kListOpenSlot);
        program.use();
        program.set("u_side", float(side_));
        program.set("u_open_capacity", unsigned(capacity_));
        program.set("u_largest_place_error", float(place_error));
        for (std::size_t i = 0; i < casters_.size();) {
            const std::size_t end = choose_piece(casters_, i, receivers_per_texel);
            draw_piece(engine, slice, i, end);
            i = end;
        }
    }
    engine.count("caster_triangles", std::int64_t(row.size()));
}

void ReceiverLists::draw_piece(Engine& engine, const Slice& slice, std::size_t begin, std::size_t end) {
    engine.check_cancelled();
    counts_buf_.clear();
    engine.program("techniques/afsm/casters.vert", "techniques/afsm/casters.frag").set("u_first", unsigned(begin));
    DrawState state;
    state.depth_test = true;
    state.color_write = false;
    engine.draw_vertices(state, GL_TRIANGLES, GLsizei(6 * (end - begin)));
    engine.gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    const ListCounts counts = counts_buf_.download<ListCounts>(1).front();
    tests_ += std::int64_t(std::uint64_t(counts.tests_high) << 32 | counts.tests_low);
    settle(engine, slice, std::min<std::size_t>(counts.open_pairs, capacity_));
    if (counts.open_pairs <= capacity_) {
        open_pairs_ += counts.open_pairs;
        return;
    }
    // Pairs were lost: once more in halves. A single caster leaves at most one pair per receiver open, and these fit.
    ++redraws_;
    const std::size_t middle = begin + (end - begin) / 2;
    draw_piece(engine, slice, begin, middle);
    draw_piece(engine, slice, middle, end);
}

void ReceiverLists::settle(Engine& engine, const Slice& slice, std::size_t pair_count) const {
    const auto pairs = open_buf_.download<glm::uvec2>(pair_count);
    const Task& task = slice.task;
    engine.threads().parallel_for(pair_count, kAnswerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t pixel = slice.pixels[pairs[i].x];
            const std::atomic_ref<std::uint8_t> visible(slice.visible[pixel]);
            if (visible.load(std::memory_order_relaxed) == 0) continue;
            const ListCaster& caster = casters_[pairs[i].y];
            if (task.rule.is_blocked(task.rule.find_receiver(pixel), task.frame.ids[pixel],
                                     {caster.instance, caster.triangle}))
                visible.store(0, std::memory_order_relaxed);
        }
    });
}

void ReceiverLists::take_answers(Engine& engine, const Slice& slice) const {
    const auto timer = engine.time_stage("answers");
    const auto blocked = blocked_buf_.download<std::uint32_t>(slice.pixels.size());
    engine.threads().parallel_for(blocked.size(), kAnswerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (blocked[i]) slice.visible[slice.pixels[i]] = 0;
    });
}

}  // namespace shadow_layers
