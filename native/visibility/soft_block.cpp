// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/soft_block.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace shadow_layers {
namespace {

using soft_kernel::Receiver;
using soft_kernel::Shaft;

constexpr double kFloat = 1.0 / 16777216;  // 2^-24
// A light with depth: its lowest samples lie lower than the receivers that have tables, by this part of the way.
constexpr double kTableDepth = 1.05;
constexpr std::size_t kMostOwnTriangles = 4;

// Which shift of the pattern a pixel of 4 x 4 takes: neighbours take shifts far from each other.
constexpr std::uint8_t kShiftOrder[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};

std::uint64_t settle_nothing(void*, std::uint32_t, std::uint32_t, std::uint32_t, std::uint64_t) { return 0; }

}  // namespace

void SoftCounts::add(const SoftCounts& other) {
    nodes += other.nodes;
    leaves += other.leaves;
    settled += other.settled;
    lit_blocks += other.lit_blocks;
    dark_blocks += other.dark_blocks;
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
        if (task_.stances[pixel].part != PixelStance::kNone) parts |= 1u << task_.stances[pixel].part;
    });
    for (; parts != 0; parts &= parts - 1) {
        const int number = std::countr_zero(parts);
        members_.clear();
        places_ = {};
        for_pixels([&](std::uint32_t pixel) {
            if (task_.stances[pixel].part == number) add_member(task_.parts[std::size_t(number)], pixel);
        });
        trace_part(task_.parts[std::size_t(number)], visibility);
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
    member.is_lit_by_all = task_.stances[pixel].is_lit_by_all;
    Receiver& r = member.receiver;
    for (int k = 0; k < 3; ++k) r.at[k] = place[k], r.normal[k] = float(normal[k]);
    r.error = float(part.place_error);
    r.instance = frame.ids[pixel].instance, r.triangle = frame.ids[pixel].triangle;
    r.number = pixel;
}

/// What only receivers that are traced need.
void SoftBlock::finish_member(const SoftPart& part, Member& member) const {
    Receiver& r = member.receiver;
    set_place(part, {r.at[0], r.at[1], r.at[2]}, r);
    // The flattest direction: least height over the receiver's plane, by the longest way.
    const glm::dvec3 low = part.sample_low, high = part.sample_high, normal(r.normal[0], r.normal[1], r.normal[2]);
    const glm::dvec3 middle = 0.5 * (low + high) + glm::dvec3(-double(r.base_u), -double(r.base_v), double(r.height));
    const glm::dvec3 half = 0.5 * (high - low);
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

/// Empty where there are many.
std::vector<PixelIds> SoftBlock::find_own_triangles() const {
    std::vector<PixelIds> own;
    for (const Member& member : members_) {
        const PixelIds ids{member.receiver.instance, member.receiver.triangle};
        const auto is_same = [&](const PixelIds& other) {
            return other.instance == ids.instance && other.triangle == ids.triangle;
        };
        if (std::any_of(own.begin(), own.end(), is_same)) continue;
        if (own.size() == kMostOwnTriangles) return {};
        own.push_back(ids);
    }
    return own;
}

void SoftBlock::trace_part(const SoftPart& part, std::vector<float>& visibility) {
    BlockRoots::Block block{part, make_shaft(part, places_), places_, {}, members_.front().receiver};
    set_plane(block.shaft);
    const std::vector<PixelIds> own = find_own_triangles();
    block.own = own;
    roots_.find(block, *part.tree, task_.rule);
    block.own = {};
    // What lies inside of casters can't hide what their surfaces don't.
    if (!roots_.is_empty() && !roots_.is_dark()) inner_roots_.find(block, *part.inner_tree, task_.rule);
    is_lit_ = roots_.is_empty();
    is_dark_ = !is_lit_ && (roots_.is_dark() || inner_roots_.is_dark());
    counts_.lit_blocks += is_lit_;
    counts_.dark_blocks += is_dark_;
    start_trace(trace_, *part.tree, roots_);
    start_trace(inner_trace_, *part.inner_tree, inner_roots_);
    inner_trace_.settle = &settle_nothing;
    tables_.clear();
    last_.assign(64 * part.sets.front().count(), soft_kernel::kNoChild);
    inner_last_ = last_;
    for (Member& member : members_) {
        if (!is_lit_) finish_member(part, member);
        visibility[member.pixel] = is_lit_ && member.is_lit_by_all ? 1.0f : find_visibility(part, member);
    }
    for (const soft_kernel::Trace* trace : {&trace_, &inner_trace_}) {
        counts_.nodes += trace->counts.nodes;
        counts_.leaves += trace->counts.leaves;
    }
    counts_.settled += trace_.counts.settled;
}

void SoftBlock::start_trace(soft_kernel::Trace& trace, const CasterTree& tree, const BlockRoots& roots) {
    trace = {};
    trace.tree = tree.view();
    trace.roots = roots.view();
    trace.settle = &SoftBlock::settle;
    trace.context = this;
}

/// The samples of a set that light the receiver if nothing lies between; counts those whose cone it lies outside of.
std::uint64_t SoftBlock::find_lit(const SampleSets& sets, std::size_t set, const Member& member, int& outside) const {
    const std::uint64_t all = sets.set(set).all;
    if (member.is_lit_by_all) return all;
    std::uint64_t lit = 0;
    for (std::uint64_t left = all; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        const Facing facing = task_.samples.classify(member.list, sets.get_number(set, bit), member.pixel);
        if (facing == Facing::Undecided) lit |= std::uint64_t(1) << bit;
        if (facing == Facing::OutsideCone) ++outside;
    }
    return lit;
}

float SoftBlock::find_visibility(const SoftPart& part, const Member& member) {
    const SampleSets& sets = part.sets[member.list];
    sets_ = &sets;
    samples_ = &task_.samples.samples(member.list);
    answers_.resize(sets.count());
    int lit_count = 0, visible_count = 0, outside = 0;
    for (set_ = 0; set_ < sets.count(); ++set_) {
        SetAnswer& answer = answers_[set_];
        answer.lit = answer.visible = find_lit(sets, set_, member, outside);
        if (is_dark_)
            answer.visible = 0;
        else if (answer.lit != 0 && !is_lit_)
            answer.visible = trace_set(part, member, answer.lit);
        lit_count += std::popcount(answer.lit);
        visible_count += std::popcount(answer.visible);
    }
    // Where no sample brings light, those outside of whose cone the receiver lies are taken as lit.
    if (lit_count == 0) return float(outside) / float(task_.samples.sample_count());
    if (visible_count == lit_count) return 1.0f;
    if (visible_count == 0) return 0.0f;
    return weigh(sets, member, float(visible_count) / float(lit_count));
}

std::uint64_t SoftBlock::trace_set(const SoftPart& part, const Member& member, std::uint64_t lit) {
    const soft_kernel::MaskTables* tables = member.receiver.is_near ? nullptr : &get_tables(part, member.list, set_);
    std::uint64_t open = lit;
    trace_.last_hidden_by = last_.data() + 64 * set_;
    inner_trace_.last_hidden_by = inner_last_.data() + 64 * set_;
    for (soft_kernel::Trace* trace : {&inner_trace_, &trace_}) {
        if (trace->roots.count == 0 || open == 0) continue;
        trace->samples = &part.sets[member.list].set(set_);
        trace->tables = tables;
        open = build_.trace(*trace, member.receiver, open);
    }
    return open;
}

/// `unweighted`: the answer where no sample brings any light, as from the plane of an area light.
float SoftBlock::weigh(const SampleSets& sets, const Member& member, float unweighted) const {
    double lit_weight = 0, visible_weight = 0;
    for (std::size_t set = 0; set < sets.count(); ++set) {
        float lit = 0, visible = 0;
        build_.weigh(sets.set(set), member.receiver, task_.is_area, answers_[set].lit, answers_[set].visible, lit,
                     visible);
        lit_weight += double(lit);
        visible_weight += double(visible);
    }
    return lit_weight > 0 ? float(visible_weight / lit_weight) : unweighted;
}

const soft_kernel::MaskTables& SoftBlock::get_tables(const SoftPart& part, std::size_t list, std::size_t set) {
    const SampleSets& sets = part.sets[list];
    if (sets.is_flat()) return sets.tables(set);
    tables_.resize(part.sets.size() * sets.count());
    auto& made = tables_[list * sets.count() + set];
    if (!made) {
        const glm::dvec3 low = places_.min - part.frame.centre, high = places_.max - part.frame.centre;
        const double least = std::max(-high.z, -part.sample_low.z * kTableDepth);
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
