// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Revectorisation on the CPU, in double, over a whole map of answers: the case lists of [Macedo16]'s supplement one by
// one, and the unified rules that should say the same. Slow and plain; shares nothing with the shaders.

#include <glm/glm.hpp>
#include <set>
#include <vector>

namespace shadow_layers::testing {

/// The tests of all texels: 1 = lit. Beyond the rim the nearest texel counts.
struct AnswerMap {
    int width = 0, height = 0;
    std::vector<std::uint8_t> lit;
    AnswerMap() = default;
    AnswerMap(int w, int h) : width(w), height(h), lit(std::size_t(w * h), 1) {}
    bool at(int x, int y) const;
    void set(int x, int y, bool value) { lit[std::size_t(y * width + x)] = value; }
    AnswerMap transposed() const;
    /// Texels that all four neighbours contradict are turned, all at once.
    AnswerMap healed() const;
};

struct RevectorisedSample {
    double visibility = 1;
    int case_number = 0;  ///< of the supplement; 0: none applies
};

/// v_SMSR by its twelve cases. `place`: within the texel, 0..1.
RevectorisedSample smsr_by_cases(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);
/// v_RSMSS by its thirty-one cases, of a map that is healed already.
RevectorisedSample rsmss_by_cases(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);

/// One rule per run. For rsmss, channels by their walls' disjoint coverage.
double smsr_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);
double rsmss_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);

/// The reduced form: ways to the ends along x and y, 0 where there is none.
glm::dvec2 reduced_distances(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);
double reduced_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);
double half_level_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit);

/// Sides of a texel whose neighbour disagrees: left -x, right +x, top -y, bottom +y.
struct TexelSides {
    bool left = false, right = false, top = false, bottom = false;
    int count() const { return left + right + top + bottom; }
    bool is_channel() const { return (left && right) || (top && bottom); }
};
TexelSides find_sides(const AnswerMap& map, glm::ivec2 texel);

}  // namespace shadow_layers::testing
