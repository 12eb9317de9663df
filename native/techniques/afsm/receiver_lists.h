// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/engine.h"
#include "techniques/afsm/receiver_list.h"
#include "visibility/caster_forms.h"
#include "visibility/occlusion_rule.h"
#include "visibility/receiver_tiles.h"

namespace shadow_layers {

/// Lists of receivers by the texels of a light view, on the GL, and the draw of the casters over them. Kept by a
/// technique between frames, with its memory.
class ReceiverLists {
public:
    struct Task {
        const Frame& frame;
        const LightView& view;
        const OcclusionRule& rule;
        const ReceiverTiles& sorted;
    };
    /// Sets visible[pixel] = 0 for the receivers of the view that a caster shadows. Counts "receivers",
    /// "caster_triangles", "list_tests", "open_pairs" (settled in double), "redraws".
    void draw(Engine& engine, const Task& task, std::vector<std::uint8_t>& visible);
    /// Counts "map_bytes" (buffers, kept from draw to draw) and "list_bytes" (receivers on the CPU, at their most since
    /// the last call).
    void count_bytes(Engine& engine);

private:
    /// Consecutive receivers of a view, as many as the buffers hold.
    struct Slice {
        const Task& task;
        std::span<const std::uint32_t> pixels;
        std::vector<std::uint8_t>& visible;
    };
    void fit(Engine& engine, int side, std::size_t receivers);
    void insert(Engine& engine, std::span<const ListReceiver> receivers);
    void draw_casters(Engine& engine, const Slice& slice, double place_error);
    void draw_piece(Engine& engine, const Slice& slice, std::size_t begin, std::size_t end);
    void settle(Engine& engine, const Slice& slice, std::size_t pair_count) const;
    void take_answers(Engine& engine, const Slice& slice) const;

    int side_ = 0;
    std::size_t capacity_ = 0;  ///< receivers, and open pairs
    std::shared_ptr<gl::Texture> head_tx_, farthest_tx_, depth_tx_;
    gl::Framebuffer target_;
    gl::Buffer receivers_buf_, next_buf_, blocked_buf_, casters_buf_, counts_buf_, open_buf_;
    std::vector<ListCaster> casters_;  ///< in casters_buf_
    std::size_t placed_bytes_ = 0;
    std::int64_t tests_ = 0, open_pairs_ = 0, redraws_ = 0;
};

}  // namespace shadow_layers
