// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/soft_shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shadow_layers::truth {
namespace {

/// Sums over the samples that a receiver faces.
struct Sums {
    double all = 0, lit = 0;    ///< as decided
    double sure = 0;            ///< of samples that are faced for certain
    double open = 0, shut = 0;  ///< of these, what is seen, what is hidden for certain
    double perhaps = 0;         ///< of samples that another program may not count as faced
    double error = 0, largest = 0;
    double unoccluded = 0, unoccluded_least = 0, unoccluded_most = 0;

    void add_weight(const Standings& standings, double weight, const Sight& sight) {
        largest = std::max(largest, weight);
        if (standings.decided == Standing::Facing) {
            all += weight;
            if (!sight.blocked) lit += weight;
        }
        if (standings.may_be_apart || standings.may_be_turned_away) {
            perhaps += weight;
            return;
        }
        sure += weight;
        if (sight.certain) (sight.blocked ? shut : open) += weight;
    }
    void add_unoccluded(const Standings& standings) {
        unoccluded += standings.decided == Standing::Apart;
        unoccluded_least += !standings.may_be_turned_away;
        unoccluded_most += standings.may_be_apart;
    }

    LitPart find_part(double count) const {
        LitPart part;
        if (!(all > 0)) {
            part = {unoccluded / count, unoccluded_least / count, unoccluded_most / count, 1 / count, 0, 0};
            if (perhaps > 0) part.least = 0, part.most = 1;
            return part;
        }
        part.decided = lit / all;
        part.step = largest / all;
        part.least = sure > 0 ? (open - error) / (sure + perhaps) : 0;
        part.most = sure > 0 ? (sure - shut + perhaps + error) / (sure + perhaps) : 1;
        part.least = std::clamp(part.least, 0.0, part.decided);
        part.most = std::clamp(part.most, part.decided, 1.0);
        // All or nothing is so whatever the weights are.
        if (perhaps == 0 && shut == sure) part.most = 0;
        if (perhaps == 0 && open == sure) part.least = 1;
        return part;
    }
};

std::uint64_t scramble(std::uint64_t bits) {
    bits += 0x9E3779B97F4A7C15u;
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
    return bits ^ (bits >> 31);
}

/// At random in the unit square, but the same for the same number.
glm::dvec2 draw_from_square(std::uint64_t number) {
    const std::uint64_t first = scramble(number);
    return glm::dvec2(double(first >> 11), double(scramble(first) >> 11)) * 0x1p-53;
}

glm::dvec2 map_to_disc(const glm::dvec2& square) {
    const double angle = 2 * std::numbers::pi * square.y;
    return std::sqrt(square.x) * glm::dvec2(std::cos(angle), std::sin(angle));
}

/// Two unit vectors at right angles to a unit vector and to each other.
std::pair<glm::dvec3, glm::dvec3> find_across(const glm::dvec3& axis) {
    const glm::dvec3 aside = std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(axis, aside));
    return {x, glm::cross(axis, x)};
}

}  // namespace

SampleShadows::SampleShadows(const RayOracle& oracle, const Frame& frame, const Light& light,
                             std::span<const LightSample> samples)
    : oracle_(oracle), frame_(frame), light_(light), samples_(samples) {
    for (const LightSample& sample : samples) rules_.emplace_back(*frame.scene, light, sample);
}

LitPart SampleShadows::find_lit_part(std::size_t pixel) const {
    const auto receiver = oracle_.find_receiver(frame_, pixel);
    if (!receiver) return {};
    Sums sums;
    int bits = 0, ties = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Standings standings = rules_[i].find_standings(*receiver);
        sums.add_unoccluded(standings);
        if (!standings.may_be_facing) continue;
        const Sight sight = light_.casts_shadow ? oracle_.look(*receiver, light_, samples_[i]) : Sight{};
        ++bits;
        ties += !sight.certain;
        sums.error += rules_[i].find_weight_error(*receiver);
        sums.add_weight(standings, std::max(0.0, rules_[i].compute_weight(*receiver)), sight);
    }
    LitPart part = sums.find_part(double(samples_.size()));
    part.bits = bits, part.ties = ties;
    if (!receiver->certain) part.least = 0, part.most = 1;
    return part;
}

LightSample ShapeShadows::make_sample(const glm::dvec2& square, const glm::dvec3& receiver_ws) const {
    const glm::dmat4& matrix = light_.world_from_light;
    const glm::dvec3 x = glm::normalize(glm::dvec3(matrix[0])), y = glm::normalize(glm::dvec3(matrix[1])),
                     z = glm::normalize(glm::dvec3(matrix[2]));
    LightSample sample;
    sample.position_ws = glm::dvec3(matrix[3]);
    sample.directional = light_.kind == LightKind::Sun;
    if (light_.kind == LightKind::Area) {
        const glm::dvec2 place = light_.area_round ? 0.5 * map_to_disc(square) : square - 0.5;
        sample.position_ws += place.x * light_.area_size.x * x + place.y * light_.area_size.y * y;
    } else if (light_.kind == LightKind::Sun) {
        // Even in solid angle: the versine of the angle to the axis is.
        const double angle = 0.5 * std::min(light_.sun_angle, std::numbers::pi);
        const double versine = square.x * 2 * std::pow(std::sin(0.5 * angle), 2),
                     turn = 2 * std::numbers::pi * square.y;
        const auto [right, up] = find_across(z);
        sample.to_light_ws = glm::normalize((1 - versine) * z + std::sqrt(versine * (2 - versine)) *
                                                                    (std::cos(turn) * right + std::sin(turn) * up));
    } else if (sample.position_ws != receiver_ws) {
        const glm::dvec2 place = light_.radius * map_to_disc(square);
        const auto [right, up] = find_across(glm::normalize(sample.position_ws - receiver_ws));
        sample.position_ws += place.x * right + place.y * up;
    }
    return sample;
}

LitEstimate ShapeShadows::estimate_lit_part(std::size_t pixel) const {
    const auto receiver = oracle_.find_receiver(frame_, pixel);
    if (!receiver) return {};
    std::vector<double> parts;
    for (int lattice = 0; lattice < kLattices; ++lattice) {
        const glm::dvec2 shift = draw_from_square(std::uint64_t(pixel) * kLattices + std::uint64_t(lattice));
        Sums sums;
        for (int i = 0; i < kLatticePoints; ++i) {
            const glm::dvec2 point((i + 0.5) / kLatticePoints, i / std::numbers::phi);
            const LightSample sample = make_sample(glm::fract(point + shift), receiver->place_ws);
            const LightRule rule(*frame_.scene, light_, sample);
            const Standings standings = rule.find_standings(*receiver);
            sums.add_unoccluded(standings);
            if (standings.decided != Standing::Facing) continue;
            const Sight sight = light_.casts_shadow ? oracle_.look(*receiver, light_, sample) : Sight{};
            sums.add_weight(standings, rule.compute_weight(*receiver), sight);
        }
        parts.push_back(sums.find_part(kLatticePoints).decided);
        if (lattice == 1 && parts[0] == parts[1] && (parts[0] == 0 || parts[0] == 1)) break;
    }
    double sum = 0, squares = 0;
    for (const double part : parts) sum += part;
    const double count = double(parts.size()), mean = sum / count;
    for (const double part : parts) squares += (part - mean) * (part - mean);
    return {mean, std::sqrt(squares / (count * (count - 1)))};
}

}  // namespace shadow_layers::truth
