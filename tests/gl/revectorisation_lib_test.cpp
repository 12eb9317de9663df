// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/lib/revectorisation_lib.glsl and its smooth sibling on random maps, against the case lists and the unified
// rules on the CPU, and against straight edges, whose borders are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "support/glsl_lib_runner.h"
#include "support/revectorisation_reference.h"

namespace shadow_layers::testing {
namespace {

struct Sample {
    glm::ivec2 texel;
    glm::dvec2 place;
    int map = 0, limit = 16;
};

/// What the library says of a sample.
struct Answers {
    double smsr, reduced, half_level, by_cases, by_walls;
};

constexpr const char* kTests = R"(
int map_start;
bool is_texel_lit(ivec2 texel) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(MAP_SIZE - 1));
    int index = inside.y * MAP_SIZE + inside.x;
    return inputs[map_start + index / 4][index % 4] > 0.5;
}
)";
constexpr const char* kBody = R"(
ivec2 texel = ivec2(inputs[2 * i].xy);
vec2 place = inputs[2 * i].zw;
map_start = 2 * u_count + int(inputs[2 * i + 1].x) * (MAP_SIZE * MAP_SIZE / 4);
int limit = int(inputs[2 * i + 1].y);
uint code = look_at(texel, kAllSides, kAsTested), healed = look_at(texel, kAllSides, kHealed);
outputs[2 * i] = vec4(smsr_visibility(code, texel, place, limit), reduced_visibility(code, texel, place, limit),
                      half_level_visibility(code, texel, place, limit), 0.0);
outputs[2 * i + 1] = vec4(rsmss_visibility(healed, texel, place, limit, kChannelsPaper),
                          rsmss_visibility(healed, texel, place, limit, kChannelsDisjoint), 0.0, 0.0);
)";

class RevectorisationLib : public ::testing::Test {
protected:
    /// Maps are square, of one size that is a multiple of two.
    std::vector<Answers> run(const std::vector<AnswerMap>& maps, const std::vector<Sample>& samples) {
        std::vector<glm::vec4> items;
        for (const Sample& sample : samples) {
            items.emplace_back(sample.texel.x, sample.texel.y, float(sample.place.x), float(sample.place.y));
            items.emplace_back(float(sample.map), float(sample.limit), 0, 0);
        }
        for (const AnswerMap& map : maps)
            for (std::size_t k = 0; k < map.lit.size(); k += 4)
                items.emplace_back(map.lit[k], map.lit[k + 1], map.lit[k + 2], map.lit[k + 3]);
        const std::string size = "const int MAP_SIZE = " + std::to_string(maps.front().width) + ";\n";
        const auto out =
            runner_.run("lib/revectorisation_smooth_lib.glsl", kBody, items, int(samples.size()), 2, size + kTests);
        std::vector<Answers> answers;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const glm::vec4 hard = out[2 * k], smooth = out[2 * k + 1];
            answers.push_back({hard.x, hard.y, hard.z, smooth.x, smooth.y});
        }
        return answers;
    }
    GlslLibRunner runner_;
};

/// Maps from noise of several grains, so that runs of all kinds and one-texel details occur.
AnswerMap random_map(int seed, int size) {
    std::mt19937 random{unsigned(seed)};
    std::uniform_real_distribution<double> unit(0, 1);
    AnswerMap map(size, size);
    const int grain = 1 << (seed % 5);
    if (seed % 5 < 4) {
        std::vector<double> coarse(std::size_t((size / grain + 3) * (size / grain + 3)));
        for (double& value : coarse) value = unit(random);
        const auto at = [&](int x, int y) { return coarse[std::size_t(y * (size / grain + 3) + x)]; };
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double u = double(x) / grain, v = double(y) / grain;
                const int i = int(u), j = int(v);
                const double low = at(i, j) + (at(i + 1, j) - at(i, j)) * (u - i);
                const double high = at(i, j + 1) + (at(i + 1, j + 1) - at(i, j + 1)) * (u - i);
                map.set(x, y, low + (high - low) * (v - j) + 0.06 * (unit(random) - 0.5) > 0.5);
            }
        return map;
    }
    for (int k = 0; k < 14; ++k) {  // strips, some of them thinner than a texel
        const double turn = 6.3 * unit(random), offset = size * unit(random), width = 0.4 + 2.2 * unit(random);
        const glm::dvec2 normal(std::cos(turn), std::sin(turn));
        const bool lit = k % 2 == 1;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                if (std::abs(glm::dot(normal, glm::dvec2(x, y) - size / 2.0) - offset / 2 + size / 4.0) < width)
                    map.set(x, y, lit);
    }
    return map;
}

/// Places on a grid that no line between run ends of up to 16 texels meets, so that no comparison hangs on rounding.
void sample_every_texel(std::vector<Sample>& samples, int map, int size, int per_texel, int limit) {
    std::mt19937 random{unsigned(map)};
    std::uniform_int_distribution<int> cell(0, 63);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            for (int k = 0; k < per_texel; ++k)
                samples.push_back({{x, y}, {(cell(random) + 0.3107) / 64, (cell(random) + 0.5711) / 64}, map, limit});
}

struct Count {
    int evaluations = 0, differences = 0;
    void add(double one, double other) {
        ++evaluations;
        differences += !(std::abs(one - other) < 1e-4);
    }
};

TEST_F(RevectorisationLib, EqualsTheCaseListsAndTheUnifiedRules) {
    constexpr int kSize = 40, kMaps = 20;
    std::vector<AnswerMap> maps, healed;
    std::vector<Sample> samples;
    for (int seed = 0; seed < kMaps; ++seed) {
        maps.push_back(random_map(seed, kSize));
        healed.push_back(maps.back().healed());
        sample_every_texel(samples, seed, kSize, 2, seed % 3 == 0 ? 5 : 16);
    }
    const auto answers = run(maps, samples);
    std::map<std::string, Count> counts;
    std::map<int, int> smsr_seen, rsmss_seen;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const auto& [texel, place, number, limit] = samples[k];
        const AnswerMap &map = maps[std::size_t(number)], &whole = healed[std::size_t(number)];
        const auto smsr = smsr_by_cases(map, texel, place, limit);
        ++smsr_seen[smsr.case_number];
        counts["smsr, cases"].add(answers[k].smsr, smsr.visibility);
        counts["smsr, rule"].add(answers[k].smsr, smsr_by_rule(map, texel, place, limit));
        counts["reduced"].add(answers[k].reduced, reduced_by_rule(map, texel, place, limit));
        counts["half level"].add(answers[k].half_level, half_level_by_rule(map, texel, place, limit));
        const auto rsmss = rsmss_by_cases(whole, texel, place, limit);
        ++rsmss_seen[rsmss.case_number];
        const bool channel = find_sides(whole, texel).is_channel();
        counts[channel ? "channels, cases" : "rsmss, cases"].add(answers[k].by_cases, rsmss.visibility);
        counts[channel ? "channels, walls" : "rsmss, rule"].add(answers[k].by_walls,
                                                                rsmss_by_rule(whole, texel, place, limit));
    }
    ASSERT_EQ(counts.size(), 8u);
    for (const auto& [name, count] : counts) {
        EXPECT_EQ(count.differences, 0) << name << ", of " << count.evaluations;
        EXPECT_GT(count.evaluations, 3000) << name;
    }
    for (int number = 1; number <= 12; ++number) EXPECT_GT(smsr_seen[number], 10) << "case " << number;
    // 2 and 3, texels without a neighbour like them, are healed away but in chequers.
    for (int number = 4; number <= 31; ++number) EXPECT_GT(rsmss_seen[number], 0) << "case " << number;
}

TEST_F(RevectorisationLib, TexelsOnTheirOwnVanishInSmoothBordersAndNeverLightHardOnes) {
    AnswerMap map(16, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) map.set(x, y, y >= 8);  // shadow below
    map.set(4, 12, false), map.set(11, 3, true);             // a dark texel in the light, and a lit one in the dark
    std::vector<Sample> samples;
    sample_every_texel(samples, 0, 16, 4, 16);
    const auto answers = run({map}, samples);
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const glm::ivec2 texel = samples[k].texel;
        for (const double smooth : {answers[k].by_cases, answers[k].by_walls})
            EXPECT_EQ(smooth, texel.y >= 8 ? 1 : 0) << texel.x << " " << texel.y;
        // As tested: the dark texel stays, and dims its neighbours as a run closed on neither side does: not at all.
        // The lit one is closed all round.
        EXPECT_EQ(answers[k].smsr, texel.y < 8 || texel == glm::ivec2(4, 12) ? 0 : 1) << texel.x << " " << texel.y;
    }
}

/// Straight borders at random offsets: what a way of cutting adds to the shadow, and what it gets wrong, per texel of
/// border.
struct EdgeErrors {
    double shift = 0, wrong = 0;
};

TEST_F(RevectorisationLib, StraightEdgesHaveTheKnownBias) {
    constexpr int kSize = 64, kOffsets = 8, kLimit = 64;
    const std::vector<double> angles = {3, 7, 18.4, 26.6, 38, 44};
    std::mt19937 random{5};
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<AnswerMap> maps;
    std::vector<Sample> samples;
    std::vector<glm::dvec3> lines;  // normal into the light, offset
    for (const double angle : angles)
        for (int k = 0; k < kOffsets; ++k) {
            const double turn = glm::radians(angle);
            const glm::dvec2 normal(-std::sin(turn), std::cos(turn));
            // Evenly over a texel: steps of equal length lie to one side, by where they begin.
            const double offset = glm::dot(normal, glm::dvec2(kSize / 2.0)) + (k + 0.5) / kOffsets * normal.y;
            AnswerMap map(kSize, kSize);
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x) map.set(x, y, glm::dot(normal, glm::dvec2(x + 0.5, y + 0.5)) > offset);
            maps.push_back(map);
            lines.emplace_back(normal, offset);
            for (int y = 0; y < kSize; ++y)
                for (int x = 18; x < kSize - 18; ++x)  // runs near the rim lack their ends
                    for (int n = 0; n < 6; ++n)
                        samples.push_back({{x, y}, {unit(random), unit(random)}, int(maps.size()) - 1, kLimit});
        }
    const auto answers = run(maps, samples);
    for (std::size_t a = 0; a < angles.size(); ++a) {
        EdgeErrors plain, smsr, smooth, half;
        // Of border within the columns sampled, six samples to the texel.
        const double border = 6.0 * kOffsets * (kSize - 36) / std::cos(glm::radians(angles[a]));
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (samples[k].map / kOffsets != int(a)) continue;
            const glm::dvec3 line = lines[std::size_t(samples[k].map)];
            const glm::ivec2 texel = samples[k].texel;
            const double truth = glm::dot(glm::dvec2(line), glm::dvec2(texel) + samples[k].place) > line.z ? 1 : 0;
            const auto add = [&](EdgeErrors& errors, double visibility) {
                errors.shift += (truth - visibility) / border;
                errors.wrong += std::abs(truth - (visibility >= 0.5 ? 1 : 0)) / border;
            };
            add(plain, maps[std::size_t(samples[k].map)].at(texel.x, texel.y) ? 1 : 0);
            add(smsr, answers[k].smsr);
            add(smooth, answers[k].by_cases);
            add(half, answers[k].half_level);
        }
        SCOPED_TRACE(angles[a]);
        EXPECT_NEAR(plain.shift, 0, 0.03);
        EXPECT_NEAR(plain.wrong, 0.24, 0.03);
        EXPECT_NEAR(smooth.shift, 0, 0.03);
        EXPECT_NEAR(half.shift, 0, 0.03);
        // Half a texel across the run, which is less across a slanted border; only shadow is added.
        EXPECT_NEAR(smsr.shift, 0.5 * std::cos(glm::radians(angles[a])), 0.06);
        EXPECT_NEAR(smsr.wrong, smsr.shift, 0.01);
        // Steps of many texels are lines again; those of one texel have little to go by.
        EXPECT_LT(smooth.wrong, angles[a] < 10 ? 0.06 : angles[a] < 40 ? 0.14 : 0.19);
        EXPECT_LT(half.wrong, angles[a] < 10 ? 0.06 : angles[a] < 40 ? 0.14 : 0.19);
    }
}

}  // namespace
}  // namespace shadow_layers::testing
