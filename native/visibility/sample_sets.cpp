// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/sample_sets.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace shadow_layers {
namespace {

using soft_kernel::kBins;
using soft_kernel::kMostSamples;
using soft_kernel::kTableSize;
using soft_kernel::kWidth;
using soft_kernel::MaskTables;
using soft_kernel::SampleSet;

// Slopes of a sun's samples farther from its axis than this (80 degrees) would be useless as places on a plane.
const double kLeastCosine = std::cos(80 * 3.14159265358979323846 / 180);

/// Halves the numbers by place along the longest side, until parts of `size` are left; their sizes are whole multiples
/// of it but for the last.
void sort_compactly(std::span<const glm::dvec3> places, std::span<std::uint32_t> numbers, std::size_t size) {
    if (numbers.size() <= size) return;
    glm::dvec3 low(places[numbers[0]]), high(low);
    for (const std::uint32_t i : numbers) low = glm::min(low, places[i]), high = glm::max(high, places[i]);
    const glm::dvec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t parts = (numbers.size() + size - 1) / size, middle = (parts / 2) * size;
    std::nth_element(numbers.begin(), numbers.begin() + std::ptrdiff_t(middle), numbers.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return places[a][axis] != places[b][axis] ? places[a][axis] < places[b][axis] : a < b;
                     });
    sort_compactly(places, numbers.first(middle), size);
    sort_compactly(places, numbers.subspan(middle), size);
}

/// Where a sample's image may lie on one axis.
struct ImageRange {
    double low, high;
};

int find_entry(double at, float scale, float offset) {
    const float x = float(at) * scale + offset;
    return int(x > 0 ? (x < float(kBins + 1) ? x : float(kBins + 1)) : 0.0f);
}

void fill_tables(std::span<const ImageRange> images, double least_width, float& scale, float& offset,
                 std::uint64_t (&from)[kTableSize], std::uint64_t (&to)[kTableSize]) {
    double low = images[0].low, high = images[0].high;
    for (const ImageRange& image : images) low = std::min(low, image.low), high = std::max(high, image.high);
    // From entry 2 to the last but two: images before and behind have entries of their own, and each sample one to
    // spare.
    const double width = std::max(high - low, least_width);
    scale = float((kBins - 3) / width);
    offset = float(2 - low * double(scale));
    for (int x = 0; x < kTableSize; ++x) from[x] = to[x] = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
        from[std::clamp(find_entry(images[i].high, scale, offset) + 1, 1, kBins)] |= std::uint64_t(1) << i;
        to[std::clamp(find_entry(images[i].low, scale, offset) - 1, 1, kBins)] |= std::uint64_t(1) << i;
    }
    // An image that starts at entry x hides what ends there or beyond it.
    for (int x = kTableSize - 2; x >= 0; --x) from[x] |= from[x + 1];
    for (int x = 1; x < kTableSize; ++x) to[x] |= to[x - 1];
}

}  // namespace

SampleSets::SampleSets(std::span<const LightSample> samples, const LightFrame& frame,
                       const glm::dvec3& picture_origin_ws, double distance)
    : distance_(frame.directional ? 1 : distance) {
    std::vector<glm::dvec3> places;
    bool has_slopes = frame.directional;
    for (const LightSample& sample : samples) {
        if (frame.directional)
            places.push_back(frame.turn(sample.to_light_ws));
        else
            places.push_back(frame.from_rel(sample.position_ws - picture_origin_ws) - frame.centre);
        has_slopes = has_slopes && places.back().z >= kLeastCosine;
    }
    if (frame.directional)
        for (glm::dvec3& place : places)
            place = has_slopes ? glm::dvec3(place.x / place.z, place.y / place.z, 0) : place - glm::dvec3(0, 0, 1);
    low_ = high_ = places.front();
    for (const glm::dvec3& place : places) low_ = glm::min(low_, place), high_ = glm::max(high_, place);
    // An area light's samples lie in its plane but for rounding.
    const double extent = std::max({high_.x - low_.x, high_.y - low_.y, glm::length(frame.centre)});
    is_flat_ = std::max(std::abs(low_.z), std::abs(high_.z)) <= 1e-12 * extent;
    if (is_flat_) {
        for (glm::dvec3& place : places) place.z = 0;
        low_.z = high_.z = 0;
    }
    needs_all_ = frame.directional && !has_slopes;
    std::vector<std::uint32_t> numbers(places.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    sort_compactly(places, numbers, kMostSamples);
    for (std::size_t begin = 0; begin < numbers.size(); begin += kMostSamples) {
        const std::size_t count = std::min<std::size_t>(kMostSamples, numbers.size() - begin);
        add_set(places, std::span(numbers).subspan(begin, count));
    }
}

void SampleSets::add_set(std::span<const glm::dvec3> places, std::span<std::uint32_t> numbers) {
    sort_compactly(places, numbers, kWidth);
    SampleSet set{};
    set.all = numbers.size() == kMostSamples ? ~std::uint64_t(0) : (std::uint64_t(1) << numbers.size()) - 1;
    set.group_count = int((numbers.size() + kWidth - 1) / kWidth);
    const auto place_at = [&](std::size_t i) { return places[numbers[i < numbers.size() ? i : 0]]; };
    for (std::size_t i = 0; i < kMostSamples; ++i) {
        const glm::dvec3 place = place_at(i);
        set.u[i] = float(place.x), set.v[i] = float(place.y), set.w[i] = float(place.z);
        numbers_.push_back(numbers[i < numbers.size() ? i : 0]);
    }
    glm::dvec3 low(place_at(0)), high(low);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        low = glm::min(low, place_at(i)), high = glm::max(high, place_at(i));
    for (int k = 0; k < 3; ++k) set.low[k] = float(low[k]), set.high[k] = float(high[k]);
    for (int group = 0; group < kWidth; ++group) {
        glm::dvec3 group_low(place_at(std::size_t(8 * group))), group_high(group_low);
        for (std::size_t i = std::size_t(8 * group); i < std::min(numbers.size(), std::size_t(8 * group + 8)); ++i)
            group_low = glm::min(group_low, place_at(i)), group_high = glm::max(group_high, place_at(i));
        const glm::dvec3 middle = 0.5 * (group_low + group_high), reach = 0.5 * (group_high - group_low) * (1 + 1e-6);
        set.group_u[group] = float(middle.x), set.group_v[group] = float(middle.y),
        set.group_w[group] = float(middle.z);
        set.reach_u[group] = float(reach.x), set.reach_v[group] = float(reach.y), set.reach_w[group] = float(reach.z);
    }
    set.is_flat = is_flat_;
    sets_.push_back(set);
    if (is_flat_) tables_.push_back(make_tables(set, {{0, 0}, {0, 0}, {distance_, distance_}}));
}

soft_kernel::MaskTables make_tables(const SampleSet& set, const BlockPlace& place) {
    MaskTables tables;
    ImageRange u[kMostSamples], v[kMostSamples];
    const std::size_t count = std::size_t(std::popcount(set.all));
    for (std::size_t i = 0; i < count; ++i) {
        u[i] = v[i] = {double(set.u[i]), double(set.u[i])};
        v[i] = {double(set.v[i]), double(set.v[i])};
        if (set.w[i] == 0) continue;
        // On the plane w = 0, from (base, height): base + (place - base) height / (height + w). In each of base and
        // height it only grows or only falls, so corners are extremes.
        u[i] = v[i] = {1e300, -1e300};
        for (int k = 0; k < 4; ++k) {
            const double t = place.height[k & 1] / (place.height[k & 1] + double(set.w[i]));
            const double at_u = place.base_u[k >> 1] + (set.u[i] - place.base_u[k >> 1]) * t;
            const double at_v = place.base_v[k >> 1] + (set.v[i] - place.base_v[k >> 1]) * t;
            u[i] = {std::min(u[i].low, at_u), std::max(u[i].high, at_u)};
            v[i] = {std::min(v[i].low, at_v), std::max(v[i].high, at_v)};
        }
    }
    const double least_width = 1e-6 * (place.height[1] + std::abs(place.base_u[0]) + std::abs(place.base_v[0]));
    fill_tables(std::span(u, count), least_width, tables.scale_u, tables.offset_u, tables.u_from, tables.u_to);
    fill_tables(std::span(v, count), least_width, tables.scale_v, tables.offset_v, tables.v_from, tables.v_to);
    return tables;
}

}  // namespace shadow_layers
