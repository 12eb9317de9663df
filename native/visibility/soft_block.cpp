// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_block.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace shadow_layers {
namespace {

using soft_kernel::kLeaf;
using soft_kernel::kNoChild;
using soft_kernel::kWidth;
using soft_kernel::Node;
using soft_kernel::Receiver;
using soft_kernel::Shaft;

constexpr double kFloat = 1.0 / 16777216;  // 2^-24
// What is computed from a few floats, as a part of them, with a reserve.
constexpr double kSlack = 1e-6;
// Receivers less than this above a light's lowest samples, in parts of its size, are near.
constexpr double kNear = 1e-3, kNearDepth = 0.05;
constexpr float kBeyondAll = 3e38f;
// Nodes and leaves that a block's receivers start from, at most.
constexpr std::size_t kMostRoots = 32;

// Which shift of the pattern a pixel of 4 x 4 takes: neighbours take shifts far from each other.
constexpr std::uint8_t kShiftOrder[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};

}  // namespace

void SoftCounts::add(const SoftCounts& other) {
    nodes += other.nodes;
    leaves += other.leaves;
    settled += other.settled;
    lit_blocks += other.lit_blocks;
}

void SoftPart::set_sample_box() {
    sample_low = sets.front().low(), sample_high = sets.front().high();
    for (const SampleSets& list : sets) {
        sample_low = glm::min(sample_low, list.low());
        sample_high = glm::max(sample_high, list.high());
        needs_all = needs_all || list.needs_all();
    }
}

Shaft make_shaft(const SoftPart& part, const Bounds& receivers) {
    Shaft shaft{};
    const bool directional = part.frame.directional;
    shaft.directional = directional;
    for (int k = 0; k < 3; ++k) shaft.low[k] = float(receivers.min[k]), shaft.high[k] = float(receivers.max[k]);
    const glm::dvec3 low = part.sample_low, high = part.sample_high;
    if (directional) {
        shaft.is_near = part.needs_all;
        for (int k = 0; k < 2; ++k) {
            const double slack = kSlack * (1 + high[k] - low[k]);
            shaft.sample_low[k] = float(low[k] - slack), shaft.sample_high[k] = float(high[k] + slack);
        }
        return shaft;
    }
    // Images of samples lower than the highest ones move away from the receiver: by their way across, for the part that
    // their height lacks.
    const glm::dvec3 centre = part.frame.centre;
    const double highest = centre.z + high.z, depth = high.z - low.z, above = highest - receivers.max.z;
    const double extent = std::max(high.x - low.x, high.y - low.y);
    shaft.is_near = !(above - depth > std::max(kNear * extent, kNearDepth * depth));
    const double growth = shaft.is_near ? 0 : depth / (above - depth);
    shaft.sample_high[2] = float(highest + kSlack * (std::abs(highest) + highest - receivers.min.z));
    for (int k = 0; k < 2; ++k) {
        const double first = centre[k] + low[k], last = centre[k] + high[k];
        const double across = std::max({std::abs(first - receivers.max[k]), std::abs(last - receivers.min[k]),
                                        std::abs(first - receivers.min[k]), std::abs(last - receivers.max[k])});
        const double slack = growth * across + kSlack * (across + std::abs(first) + std::abs(last));
        shaft.sample_low[k] = float(first - slack), shaft.sample_high[k] = float(last + slack);
    }
    return shaft;
}

SoftBlock::SoftBlock(const SoftTask& task, int x, int y) : task_(task), x_(x), y_(y) {}

void SoftBlock::trace(std::vector<float>& visibility) {
    std::uint32_t parts = 0;
    const Frame& frame = task_.frame;
    const int x_end = std::min(x_ + kBlockSide, frame.width), y_end = std::min(y_ + kBlockSide, frame.height);
    const auto for_pixels = [&](const auto& body) {
        for (int y = y_; y < y_end; ++y)
            for (int x = x_; x < x_end; ++x) body(std::uint32_t(y) * std::uint32_t(frame.width) + std::uint32_t(x));
    };
    for_pixels([&](std::uint32_t pixel) {
        if (task_.part_of_pixel[pixel] != kNoPart) parts |= 1u << task_.part_of_pixel[pixel];
    });
    for (; parts != 0; parts &= parts - 1) {
        const int number = std::countr_zero(parts);
        const SoftPart& part = task_.parts[std::size_t(number)];
        members_.clear();
        places_ = {};
        for_pixels([&](std::uint32_t pixel) {
            if (task_.part_of_pixel[pixel] == number) add_member(part, pixel);
        });
        trace_part(part, visibility);
    }
}

void SoftBlock::add_member(const SoftPart& part, std::uint32_t pixel) {
    const Frame& frame = task_.frame;
    const LightFrame& axes = part.frame;
    const glm::dvec3 place = axes.from_rel(glm::dvec3(frame.positions_rel[pixel]));
    const glm::dvec3 normal = axes.turn(glm::dvec3(frame.normals[pixel]));
    places_.add(place);
    Member& member = members_.emplace_back();
    member.pixel = pixel;
    const std::uint32_t x = pixel % std::uint32_t(frame.width), y = pixel / std::uint32_t(frame.width);
    const std::size_t shift = std::size_t(kShiftOrder[y % 4][x % 4] + task_.first_shift);
    member.list = std::uint32_t(shift % part.sets.size());
    member.is_lit_by_all = task_.samples.find_stance(pixel).is_lit_by_all();
    Receiver& r = member.receiver;
    for (int k = 0; k < 3; ++k) r.at[k] = place[k], r.normal[k] = float(normal[k]);
    const glm::dvec3 base = axes.directional ? glm::dvec3(0.0) : place - axes.centre;
    r.base_u = float(base.x), r.base_v = float(base.y);
    const double height = axes.directional ? 1 : -base.z;
    r.height = float(height);
    r.error = float(part.place_error);
    r.instance = frame.ids[pixel].instance, r.triangle = frame.ids[pixel].triangle;
    r.number = pixel;
    const glm::dvec3 low = part.sample_low, high = part.sample_high;
    const double extent = std::max(high.x - low.x, high.y - low.y), depth = high.z - low.z;
    r.is_near = axes.directional ? part.needs_all
                                 : !(height + low.z > std::max(kNear * extent, kNearDepth * depth));
    if (axes.directional)
        r.light_low = r.light_high = kBeyondAll;
    else {
        r.light_low = r.is_near ? -kBeyondAll : float((height + low.z) * (1 - 8 * kSlack));
        r.light_high = float((height + high.z) * (1 + kSlack));
    }
    // The flattest direction: least height over the receiver's plane, by the longest way.
    const glm::dvec3 middle = 0.5 * (low + high) + glm::dvec3(-base.x, -base.y, height), half = 0.5 * (high - low);
    const double rise = glm::dot(normal, middle) - glm::dot(glm::abs(normal), half);
    r.least_slope = float(rise / (glm::length(middle) + glm::length(half)) - 1e-5);
}

/// Receivers of one plane are in no shadow of what lies underneath.
void SoftBlock::set_plane(Shaft& shaft) const {
    const Receiver& first = members_.front().receiver;
    double least = 0, largest = 0;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const Receiver& r = members_[i].receiver;
        for (int k = 0; k < 3; ++k)
            if (r.normal[k] != first.normal[k]) return;
        const double offset = double(r.normal[0]) * r.at[0] + r.normal[1] * r.at[1] + r.normal[2] * r.at[2];
        least = i == 0 ? offset : std::min(least, offset);
        for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(r.at[k]));
    }
    shaft.has_plane = 1;
    std::copy_n(first.normal, 3, shaft.normal);
    shaft.offset = float(least - 8 * kFloat * (std::abs(least) + largest));
}

/// Opens the tree's nodes from the top as long as few enough are left.
void SoftBlock::expand_roots(const SoftPart& part, const Shaft& shaft) {
    struct Root {
        float low[3], high[3];
        std::uint32_t child;
    };
    std::array<Root, kMostRoots + kWidth> found;
    std::size_t count = 0;
    const auto add_children = [&](const Node& node, std::uint32_t alive) {
        for (; alive != 0; alive &= alive - 1) {
            const int i = std::countr_zero(alive);
            Root& root = found[count++];
            for (int k = 0; k < 3; ++k) root.low[k] = node.low[k][i], root.high[k] = node.high[k][i];
            root.child = node.child[i];
        }
    };
    const Node& top = part.tree->root();
    add_children(top, build_.test_shaft(shaft, top));
    const Node* nodes = part.tree->view().nodes;
    for (std::size_t next = 0; next < count;) {
        if (found[next].child & kLeaf) {
            ++next;
            continue;
        }
        const Node& node = nodes[found[next].child];
        const std::uint32_t alive = build_.test_shaft(shaft, node);
        if (count - 1 + std::size_t(std::popcount(alive)) > kMostRoots) break;
        found[next] = found[--count];
        add_children(node, alive);
    }
    roots_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (i % kWidth == 0) {
            Node& fresh = roots_.emplace_back();
            for (int lane = 0; lane < kWidth; ++lane) {
                for (int k = 0; k < 3; ++k) fresh.low[k][lane] = INFINITY, fresh.high[k][lane] = -INFINITY;
                fresh.child[lane] = kNoChild;
            }
        }
        Node& node = roots_.back();
        for (int k = 0; k < 3; ++k)
            node.low[k][i % kWidth] = found[i].low[k], node.high[k][i % kWidth] = found[i].high[k];
        node.child[i % kWidth] = found[i].child;
    }
}

void SoftBlock::trace_part(const SoftPart& part, std::vector<float>& visibility) {
    roots_.clear();
    if (!part.tree->is_empty()) {
        Shaft shaft = make_shaft(part, places_);
        set_plane(shaft);
        expand_roots(part, shaft);
    }
    if (roots_.empty()) ++counts_.lit_blocks;
    trace_ = {};
    trace_.tree = part.tree->view();
    trace_.roots = {roots_.data(), int(roots_.size())};
    trace_.settle = &SoftBlock::settle;
    trace_.context = this;
    tables_.clear();
    for (Member& member : members_) visibility[member.pixel] = find_visibility(part, member);
    counts_.nodes += trace_.counts.nodes;
    counts_.leaves += trace_.counts.leaves;
    counts_.settled += trace_.counts.settled;
}

/// The samples of a set that light the receiver if nothing lies between; counts those whose cone it lies outside of.
std::uint64_t SoftBlock::find_lit(const SampleSets& sets, std::size_t set, const Member& member, int& outside) const {
    const std::uint64_t all = sets.set(set).all;
    if (member.is_lit_by_all) return all;
    std::uint64_t lit = 0;
    for (std::uint64_t left = all; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        const Facing facing = task_.samples.classify(member.list, sets.get_number(set, bit), member.pixel);
        if (facing == Facing::Lit) lit |= std::uint64_t(1) << bit;
        if (facing == Facing::OutsideCone) ++outside;
    }
    return lit;
}

float SoftBlock::find_visibility(const SoftPart& part, Member& member) {
    const SampleSets& sets = part.sets[member.list];
    sets_ = &sets;
    samples_ = &task_.samples.samples(member.list);
    double lit_weight = 0, visible_weight = 0;
    std::size_t lit_count = 0, visible_count = 0;
    int outside = 0;
    for (set_ = 0; set_ < sets.count(); ++set_) {
        const std::uint64_t lit = find_lit(sets, set_, member, outside);
        std::uint64_t visible = lit;
        if (lit != 0 && !roots_.empty()) {
            trace_.samples = &sets.set(set_);
            trace_.tables = member.receiver.is_near ? nullptr : &get_tables(part, member.list, set_);
            trace_.hint_count = set_ == 0 ? trace_.hint_count : 0;
            visible = build_.trace(trace_, member.receiver, lit);
        }
        lit_count += std::size_t(std::popcount(lit));
        visible_count += std::size_t(std::popcount(visible));
        float lit_part = 0, visible_part = 0;
        build_.weigh(sets.set(set_), member.receiver, task_.is_area, lit, visible, lit_part, visible_part);
        lit_weight += double(lit_part);
        visible_weight += double(visible_part);
    }
    // Where no sample brings light, those outside of whose cone the receiver lies are taken as lit.
    if (lit_count == 0) return float(outside) / float(task_.samples.sample_count());
    if (visible_count == lit_count) return 1.0f;
    if (visible_count == 0) return 0.0f;
    if (!(lit_weight > 0)) return float(visible_count) / float(lit_count);
    return float(visible_weight / lit_weight);
}

const soft_kernel::MaskTables& SoftBlock::get_tables(const SoftPart& part, std::size_t list, std::size_t set) {
    const SampleSets& sets = part.sets[list];
    if (sets.is_flat()) return sets.tables(set);
    tables_.resize(part.sets.size() * sets.count());
    auto& made = tables_[list * sets.count() + set];
    if (!made) {
        const glm::dvec3 low = places_.min - part.frame.centre, high = places_.max - part.frame.centre;
        const double least = std::max(-high.z, -part.sample_low.z * (1 + kNearDepth));
        made = std::make_unique<soft_kernel::MaskTables>(
            make_tables(sets.set(set), {{low.x, high.x}, {low.y, high.y}, {least, std::max(least, -low.z)}}));
    }
    return *made;
}

std::uint64_t SoftBlock::settle(void* context, std::uint32_t receiver, std::uint32_t instance, std::uint32_t triangle,
                                std::uint64_t mask) {
    auto& self = *static_cast<SoftBlock*>(context);
    if (self.settled_pixel_ != receiver) {
        self.settled_pixel_ = receiver;
        self.settled_place_ = self.task_.rule.find_receiver(receiver);
    }
    const PixelIds ids = self.task_.frame.ids[receiver];
    std::uint64_t hidden = 0;
    for (; mask != 0; mask &= mask - 1) {
        const int bit = std::countr_zero(mask);
        const LightSample& sample = self.samples_->at(self.sets_->get_number(self.set_, bit));
        if (self.task_.rule.is_blocked(self.settled_place_, ids, {instance, triangle}, sample))
            hidden |= std::uint64_t(1) << bit;
    }
    return hidden;
}

}  // namespace shadow_layers
