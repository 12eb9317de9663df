// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "frame/frame.h"
#include "visibility/caster_tree.h"
#include "visibility/occlusion_rule.h"
#include "visibility/sample_sets.h"
#include "visibility/soft_kernel.h"
#include "visibility/soft_light.h"

namespace shadow_layers {

inline constexpr int kBlockSide = 8;  ///< pixels: of blocks of receivers that are traced together
inline constexpr std::uint8_t kNoPart = 0xff;

/// Where receivers lie, and how many.
struct PartBounds {
    Bounds box;
    double largest = 0;  ///< coordinate of any, relative to the picture's origin
    std::size_t count = 0;

    void add(const glm::dvec3& place, double coordinate) {
        box.add(place);
        largest = std::max(largest, coordinate);
        ++count;
    }
    void add(const PartBounds& other) {
        box.add(other.box);
        largest = std::max(largest, other.largest);
        count += other.count;
    }
};

/// The receivers that a light shines on in one of its frames, and their casters.
struct SoftPart {
    LightFrame frame;
    Bounds receivers;          ///< in the frame
    double largest_rel = 0;    ///< coordinate of any receiver, relative to the picture's origin
    double largest_place = 0;  ///< in the frame
    double place_error = 0;    ///< of any receiver's place, on each axis
    std::vector<SampleSets> sets;  ///< one for each list of samples
    glm::dvec3 sample_low{0.0}, sample_high{0.0};  ///< box of all samples of all lists, about the light's centre
    bool needs_all = false;                        ///< as of SampleSets
    std::unique_ptr<CasterTree> tree;

    void set_sample_box();
};

/// What the receivers of a box may get light from.
soft_kernel::Shaft make_shaft(const SoftPart& part, const Bounds& receivers);

struct SoftCounts {
    std::uint64_t nodes = 0, leaves = 0, settled = 0, lit_blocks = 0;
    void add(const SoftCounts& other);
};

/// What all blocks of a light share.
struct SoftTask {
    const Frame& frame;
    const SoftLight& samples;
    const std::vector<SoftPart>& parts;
    const std::vector<std::uint8_t>& part_of_pixel;
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
    void trace_part(const SoftPart& part, std::vector<float>& visibility);
    void add_member(const SoftPart& part, std::uint32_t pixel);
    void set_plane(soft_kernel::Shaft& shaft) const;
    void expand_roots(const SoftPart& part, const soft_kernel::Shaft& shaft);
    float find_visibility(const SoftPart& part, Member& member);
    std::uint64_t find_lit(const SampleSets& sets, std::size_t set, const Member& member, int& outside) const;
    const soft_kernel::MaskTables& get_tables(const SoftPart& part, std::size_t list, std::size_t set);
    static std::uint64_t settle(void* context, std::uint32_t receiver, std::uint32_t instance, std::uint32_t triangle,
                                std::uint64_t mask);

    const SoftTask& task_;
    const int x_, y_;
    const soft_kernel::Build& build_ = soft_kernel::choose_build();
    std::vector<Member> members_;
    Bounds places_;
    std::vector<soft_kernel::Node> roots_;
    soft_kernel::Trace trace_{};
    SoftCounts counts_;
    // of the receiver being traced
    const SampleSets* sets_ = nullptr;
    const std::vector<LightSample>* samples_ = nullptr;
    std::size_t set_ = 0;
    std::uint32_t settled_pixel_ = 0xffffffffu;
    glm::dvec3 settled_place_{0.0};
    // of a light with depth: tables for this block, made when first asked for
    std::vector<std::unique_ptr<soft_kernel::MaskTables>> tables_;
};

}  // namespace shadow_layers
