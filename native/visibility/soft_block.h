// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "frame/frame.h"
#include "visibility/block_roots.h"
#include "visibility/occlusion_rule.h"
#include "visibility/soft_light.h"
#include "visibility/soft_part.h"

namespace shadow_layers {

inline constexpr int kBlockSide = 8;  ///< pixels: of blocks of receivers that are traced together

struct SoftCounts {
    std::uint64_t nodes = 0, leaves = 0, settled = 0, lit_blocks = 0, dark_blocks = 0;
    void add(const SoftCounts& other);
};

/// How a pixel stands to the light.
struct PixelStance {
    static constexpr std::uint8_t kNone = 0x7f;
    std::uint8_t part : 7 = kNone;       ///< in which it is a receiver that casters decide; kNone: decided
    std::uint8_t is_lit_by_all : 1 = 0;  ///< no sample is turned away or outside of its cone
};

/// What all blocks of a light share.
struct SoftTask {
    const Frame& frame;
    const SoftLight& samples;
    const std::vector<SoftPart>& parts;
    const std::vector<PixelStance>& stances;
    const OcclusionRule& rule;
    bool is_area;
    int first_shift;  ///< of the pattern in the block's first pixel
};

/// The receivers of 8 x 8 pixels.
class SoftBlock {
public:
    SoftBlock(const SoftTask& task, int x, int y);
    /// Sets the visibility of the pixels that have a part.
    void trace(std::vector<float>& visibility);
    const SoftCounts& counts() const { return counts_; }

private:
    struct Member {
        std::uint32_t pixel;
        std::uint32_t list;
        bool is_lit_by_all;
        soft_kernel::Receiver receiver;
    };
    void add_member(const SoftPart& part, std::uint32_t pixel);
    void finish_member(const SoftPart& part, Member& member) const;
    void set_plane(soft_kernel::Shaft& shaft) const;
    std::vector<PixelIds> find_own_triangles() const;
    void trace_part(const SoftPart& part, std::vector<float>& visibility);
    void start_trace(soft_kernel::Trace& trace, const CasterTree& tree, const BlockRoots& roots);
    float find_visibility(const SoftPart& part, const Member& member);
    std::uint64_t find_lit(const SampleSets& sets, std::size_t set, const Member& member, int& outside) const;
    std::uint64_t trace_set(const SoftPart& part, const Member& member, std::uint64_t lit);
    float weigh(const SampleSets& sets, const Member& member, float unweighted) const;
    const soft_kernel::MaskTables& get_tables(const SoftPart& part, std::size_t list, std::size_t set);
    static std::uint64_t settle(void* context, std::uint32_t receiver, std::uint32_t instance, std::uint32_t triangle,
                                std::uint64_t mask);

    const SoftTask& task_;
    const int x_, y_;
    const soft_kernel::Build& build_ = soft_kernel::choose_build();
    // of the block's receivers in one part
    std::vector<Member> members_;
    Bounds places_;
    BlockRoots roots_{build_}, inner_roots_{build_};
    bool is_lit_ = false, is_dark_ = false;
    soft_kernel::Trace trace_{}, inner_trace_{};
    std::vector<std::uint32_t> last_, inner_last_;                  ///< set by set: Trace::last_hidden_by
    std::vector<std::unique_ptr<soft_kernel::MaskTables>> tables_;  ///< of a light with depth, made when asked for
    // of the receiver being traced
    const SampleSets* sets_ = nullptr;
    const std::vector<LightSample>* samples_ = nullptr;
    std::size_t set_ = 0;
    struct SetAnswer {
        std::uint64_t lit, visible;
    };
    std::vector<SetAnswer> answers_;
    std::uint32_t settled_pixel_ = 0xffffffffu;
    glm::dvec3 settled_place_{0.0};
    SoftCounts counts_;
};

}  // namespace shadow_layers
