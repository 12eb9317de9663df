// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The causes of edsm's wrong pixels, decided from made-up facts; what decides them from scenes is in gl/.
#include "support/edsm_causes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <string>

#include "support/edsm_segments.h"

namespace shadow_layers::testing {
namespace {

constexpr std::array<bool, 4> kDark{}, kLit{true, true, true, true}, kMixed{true, false, true, false};

/// Lit in truth, tested rightly along one border edge that a texel holds.
FootprintFacts straight_border() {
    FootprintFacts facts;
    facts.lit = true;
    facts.tested = facts.exact = kMixed;
    facts.border_edges = facts.border_chains = 1;
    facts.holds_border = true;
    return facts;
}

TEST(EDSMCauseDecision, WhereExactTestsAgreeTheyTellTooLittle) {
    FootprintFacts facts = straight_border();
    facts.exact = kDark;
    EXPECT_EQ(decide_cause(facts), EDSMCause::BelowTexel);
    facts.border_edges = facts.border_chains = 0;
    EXPECT_EQ(decide_cause(facts), EDSMCause::NoSilhouette);
    facts.lit = false;
    facts.exact = kLit;
    EXPECT_EQ(decide_cause(facts), EDSMCause::NoSilhouette);
    facts.border_edges = facts.border_chains = 3;
    facts.border_ends = true;
    EXPECT_EQ(decide_cause(facts), EDSMCause::BelowTexel);
}

TEST(EDSMCauseDecision, AWrongTestIsTheCauseOnlyIfTheRightOneHelps) {
    FootprintFacts facts = straight_border();
    facts.tested = kLit;
    facts.right_with_exact_tests = true;
    EXPECT_EQ(decide_cause(facts), EDSMCause::DepthTest);
    facts.right_with_exact_tests = false;
    EXPECT_EQ(decide_cause(facts), EDSMCause::Rounding);
    facts.tested = kMixed;
    facts.right_with_exact_tests = true;  // as the float's answer differs from the double's
    EXPECT_EQ(decide_cause(facts), EDSMCause::Rounding);
    // Exact tests that agree and are right.
    facts.exact = kLit;
    EXPECT_EQ(decide_cause(facts), EDSMCause::DepthTest);
}

TEST(EDSMCauseDecision, SeveralEdges) {
    FootprintFacts facts = straight_border();
    facts.border_edges = facts.border_chains = 2;
    EXPECT_EQ(decide_cause(facts), EDSMCause::TwoEdges);
    facts.border_ends = true;
    EXPECT_EQ(decide_cause(facts), EDSMCause::TwoEdges);
    facts.border_chains = 1;  // they meet
    EXPECT_EQ(decide_cause(facts), EDSMCause::Corner);
    facts.border_edges = 1;  // one that ends where the border goes on as another thing
    EXPECT_EQ(decide_cause(facts), EDSMCause::Corner);
}

TEST(EDSMCauseDecision, OneEdgeOrNone) {
    FootprintFacts facts = straight_border();
    EXPECT_EQ(decide_cause(facts), EDSMCause::Rounding);
    facts.holds_another = true;
    EXPECT_EQ(decide_cause(facts), EDSMCause::OtherEdge);
    facts.holds_border = false;
    EXPECT_EQ(decide_cause(facts), EDSMCause::OtherEdge);
    facts.holds_another = false;
    EXPECT_EQ(decide_cause(facts), EDSMCause::NotStored);
    facts.border_edges = facts.border_chains = 0;
    EXPECT_EQ(decide_cause(facts), EDSMCause::Meeting);
    facts.holds_another = true;
    EXPECT_EQ(decide_cause(facts), EDSMCause::Meeting);
}

TEST(EDSMCauseDecision, EveryCauseHasItsName) {
    std::set<std::string> names;
    for (int k = 0; k < kEDSMCauseCount; ++k) names.insert(get_name(EDSMCause(k)));
    EXPECT_EQ(names.size(), std::size_t(kEDSMCauseCount));
    EXPECT_EQ(std::string(get_name(EDSMCause::BelowTexel)), "below a texel");
    EXPECT_EQ(std::string(get_name(EDSMCause::Rounding)), "rounding");
}

TEST(EDSMReconstruction, AStraightBorderIsFoundFromAnyTexel) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    int asked = 0;
    for (int k = 0; k < 2000; ++k) {
        const double angle = 6.283185307 * unit(random), c = 1.5 * unit(random) - 0.5;
        const glm::dvec2 normal(std::cos(angle), std::sin(angle)), at(unit(random), unit(random));
        std::array<bool, 4> tested{};
        std::array<KeptEdge, 4> kept;
        const int holder = int(4 * unit(random)) % 4;
        for (int j = 0; j < 4; ++j) {
            const double distance = glm::dot(normal, glm::dvec2(j & 1, j >> 1)) - c;
            tested[std::size_t(j)] = distance > 0;
            kept[std::size_t(j)] = {normal, distance, j == holder};
        }
        if (tested == kDark || tested == kLit) continue;
        ++asked;
        EXPECT_EQ(reconstruct_lit(tested, kept, at), glm::dot(normal, at) > c) << k;
    }
    EXPECT_GT(asked, 500);
}

TEST(EDSMReconstruction, WithoutABelievedLineTheTestsDecide) {
    std::array<KeptEdge, 4> kept{};
    const glm::dvec2 left(0.4, 0.2), right(0.6, 0.2);
    EXPECT_TRUE(reconstruct_lit(kLit, kept, left));
    EXPECT_FALSE(reconstruct_lit(kDark, kept, left));
    EXPECT_TRUE(reconstruct_lit(kMixed, kept, left));
    EXPECT_FALSE(reconstruct_lit(kMixed, kept, right));
    // A line at x = 0.3 with its lit side where the tests are dark gives distances alone: 0.3 and 0.7, in all texels.
    for (int k = 0; k < 4; ++k) kept[std::size_t(k)] = {{1, 0}, double(k & 1) - 0.3, true};
    EXPECT_FALSE(reconstruct_lit(kMixed, kept, left));
    EXPECT_TRUE(reconstruct_lit(kMixed, kept, {0.2, 0.2}));
    // One that a test contradicts: the corner between the four centres is not on it.
    EXPECT_TRUE(reconstruct_lit({true, true, true, false}, kept, {0.2, 0.2}));
}

EdgeSegment segment(glm::dvec2 start, glm::dvec2 end, bool starts = true, bool ends = true) {
    return {glm::dvec3(start, 0.5), glm::dvec3(end, 0.5), starts, ends};
}

TEST(EDSMSegments, ChainsAreOfWhatMeets) {
    EXPECT_EQ(count_chains({}), 0);
    EXPECT_EQ(count_chains({segment({0, 0}, {1, 0})}), 1);
    EXPECT_EQ(count_chains({segment({0, 0}, {1, 0}), segment({0, 0.2}, {1, 0.2})}), 2);
    EXPECT_EQ(count_chains({segment({0, 0}, {0.5, 0}), segment({0.5, 0}, {1, 1})}), 1);
    // They touch where the square cut them: no vertex of theirs.
    EXPECT_EQ(count_chains({segment({0, 0}, {0.5, 0}, true, false), segment({0.5, 0}, {1, 1})}), 2);
    // One on the other, and two that cross.
    EXPECT_EQ(count_chains({segment({0, 0}, {1, 0}), segment({0.2, 0}, {0.7, 0})}), 1);
    EXPECT_EQ(count_chains({segment({0, 0}, {1, 1}), segment({0, 1}, {1, 0})}), 2);
    // Pieces that only the last one joins, whatever their order.
    EXPECT_EQ(count_chains({segment({0, 0}, {0.2, 0}), segment({0.6, 0}, {1, 0}), segment({0.2, 0}, {0.4, 0.5}),
                            segment({0, 0.9}, {1, 0.9}), segment({0.4, 0.5}, {0.6, 0})}),
              2);
}

TEST(EDSMSegments, CutsKeepWhatIsInsideAndForgetTheEnds) {
    EdgeSegment through = segment({-1, 0.5}, {3, 0.5});
    through.end.z = 0.9;
    ASSERT_TRUE(cut_at_square(through, {0, 0}, 1));
    EXPECT_NEAR(through.start.x, 0, 1e-12);
    EXPECT_NEAR(through.end.x, 1, 1e-12);
    EXPECT_NEAR(through.start.z, 0.6, 1e-12);
    EXPECT_NEAR(through.end.z, 0.7, 1e-12);
    EXPECT_FALSE(through.starts || through.ends);
    EdgeSegment inside = segment({0.2, 0.2}, {0.8, 5});
    ASSERT_TRUE(cut_at_square(inside, {0, 0}, 1));
    EXPECT_TRUE(inside.starts);
    EXPECT_FALSE(inside.ends);
    EdgeSegment beside = segment({-1, 0.5}, {0.5, 2});
    EXPECT_FALSE(cut_at_square(beside, {0, 0}, 1));
}

}  // namespace
}  // namespace shadow_layers::testing
