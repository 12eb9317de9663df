// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/edsm_causes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace shadow_layers::testing {

const char* get_name(EDSMCause cause) {
    constexpr const char* names[] = {"below a texel", "no silhouette", "depth test", "two edges", "corner",
                                     "meeting",       "other edge",    "not stored", "rounding"};
    static_assert(std::size(names) == kEDSMCauseCount);
    return names[std::size_t(cause)];
}

EDSMCause decide_cause(const FootprintFacts& facts) {
    const auto agree = [](const std::array<bool, 4>& tests) {
        return std::all_of(tests.begin(), tests.end(), [&](bool test) { return test == tests[0]; });
    };
    if (agree(facts.exact) && facts.exact[0] != facts.lit)
        return facts.border_edges > 0 ? EDSMCause::BelowTexel : EDSMCause::NoSilhouette;
    if (facts.tested != facts.exact && facts.right_with_exact_tests) return EDSMCause::DepthTest;
    if (facts.border_chains > 1) return EDSMCause::TwoEdges;
    if (facts.border_ends) return EDSMCause::Corner;
    if (facts.border_edges == 0) return EDSMCause::Meeting;
    if (facts.holds_another) return EDSMCause::OtherEdge;
    return facts.holds_border ? EDSMCause::Rounding : EDSMCause::NotStored;
}

bool reconstruct_lit(const std::array<bool, 4>& tested, const std::array<KeptEdge, 4>& kept, glm::dvec2 at) {
    constexpr double tolerance = 1.0 / 64, missing = 0.5;
    if (std::all_of(tested.begin(), tested.end(), [&](bool test) { return test == tested[0]; })) return tested[0];
    double forced = 0, by_line = 0, line_weight = 0;
    for (int k = 0; k < 4; ++k) {
        const KeptEdge& edge = kept[std::size_t(k)];
        const glm::dvec2 corner(k & 1, k >> 1);
        const glm::dvec2 near = 1.0 - glm::abs(at - corner);
        const double weight = near.x * near.y;
        forced += weight * (tested[std::size_t(k)] ? 1 : -1) * (edge.relevant ? std::abs(edge.distance) : missing);
        bool agrees = edge.relevant;
        for (int j = 0; j < 4; ++j) {
            const double distance = edge.distance + glm::dot(edge.normal, glm::dvec2(j & 1, j >> 1) - corner);
            agrees = agrees && (tested[std::size_t(j)] ? distance : -distance) > -tolerance;
        }
        if (!agrees || weight <= line_weight) continue;
        line_weight = weight;
        by_line = edge.distance + glm::dot(edge.normal, at - corner);
    }
    return (line_weight > 0 ? by_line : forced) > 0;
}

}  // namespace shadow_layers::testing
