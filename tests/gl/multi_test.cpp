// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// multi against what it must become: closed forms of the penumbra behind a straight edge, Cycles's model of an area
// light in numbers, and its own hard technique where the light has no size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "shadow_layers/error.h"
#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

const LightKind kKinds[] = {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};
const char* const kPatterns[] = {"spiral", "sequence", "grid", "random"};

ParameterValues settings(int positions, const char* pattern = "spiral", int map_size = 1024) {
    return parameters({{"positions", std::int64_t{positions}},
                       {"pattern", std::string(pattern)},
                       {"map_size", std::int64_t{map_size}}});
}

/// A floor, and a caster over all x < 0 at height `edge`; seen from above, along the x axis.
SceneView edge_scene(const Light& light, double edge, double half_width) {
    SceneView view;
    view.width = 240, view.height = 3;
    view.place(view.add("floor", make_plane(60)));
    view.place(view.add("caster", make_plane(60)), placement({-30, 0, edge}), kInstanceShadow);
    view.camera = make_camera({0, 0, 20}, {0, 0, 0}, 240, 3, glm::degrees(2 * std::atan(half_width / 20)));
    view.scene->lights = {light};
    return view;
}

Light light_at(LightKind kind, double height) { return make_light(kind, {0, 0, height}, {0, 0, 0}, 60); }

struct Errors {
    double mean = 0, most = 0;
};

/// Of the visibility against `truth`, a function of x on the floor.
Errors compare(const TechniqueRun& run, const std::function<double(double)>& truth) {
    Errors errors;
    for (std::size_t pixel = 0; pixel < run.frame->pixel_count(); ++pixel) {
        const double x = run.frame->positions_rel[pixel].x + run.frame->origin_ws.x;
        const double error = std::abs(run.visibility()[pixel] - truth(x));
        errors.mean += error / double(run.frame->pixel_count());
        errors.most = std::max(errors.most, error);
    }
    return errors;
}

/// Parts of a square and of a disc, of half width 1, that lie beyond `x`.
double square_beyond(double x) { return std::clamp(0.5 - 0.5 * x, 0.0, 1.0); }
double disc_beyond(double x) {
    const double u = std::clamp(x, -1.0, 1.0);
    return (std::acos(u) - u * std::sqrt(1 - u * u)) / std::numbers::pi;
}

class MultiTest : public ::testing::Test {
protected:
    TechniqueRunner runner_;
};

constexpr double kHeight = 8, kEdge = 2, kRadius = 0.4;

/// A light of half width kRadius over a caster at kEdge.
Light small_light(LightKind kind, bool round) {
    Light light = light_at(kind, kHeight);
    light.radius = kRadius;
    light.area_size = {2 * kRadius, 0.5};
    light.area_round = round;
    light.sun_angle = 2 * std::atan(kRadius / (kHeight - kEdge));
    return light;
}

/// The ray from x through the caster's edge at x = 0 meets the light's plane at -x (kHeight - kEdge) / kEdge; seen from
/// the edge, a sun is as wide as the others.
double light_beyond(double (*beyond)(double), double x) { return beyond(-x * (kHeight - kEdge) / kEdge / kRadius); }

TEST_F(MultiTest, ThePenumbraOfAStraightEdgeIsTheClosedForm) {
    struct Case {
        LightKind kind;
        bool round;
        double (*beyond)(double);
    };
    for (const Case& item : {Case{LightKind::Area, false, square_beyond}, Case{LightKind::Area, true, disc_beyond},
                             Case{LightKind::Point, false, disc_beyond}, Case{LightKind::Spot, false, disc_beyond},
                             Case{LightKind::Sun, false, disc_beyond}}) {
        const SceneView view = edge_scene(small_light(item.kind, item.round), kEdge, 0.25);
        const Errors errors = compare(runner_.render(view, "multi", settings(64, "spiral", 512)),
                                      [&](double x) { return light_beyond(item.beyond, x); });
        EXPECT_LT(errors.mean, 0.008) << int(item.kind);
        EXPECT_LT(errors.most, 4.0 / 64) << int(item.kind);  // a few of the 64 steps
    }
}

// Even patterns beat independent points; a grid seen along its rows is a staircase.
TEST_F(MultiTest, MorePositionsAndEvenOnesComeNearer) {
    const SceneView view = edge_scene(small_light(LightKind::Area, false), kEdge, 0.25);
    const auto error_of = [&](int positions, const char* pattern) {
        return compare(runner_.render(view, "multi", settings(positions, pattern, 512)),
                       [](double x) { return light_beyond(square_beyond, x); })
            .mean;
    };
    double before = error_of(4, "spiral");
    for (const int positions : {16, 64}) {
        const double now = error_of(positions, "spiral");
        EXPECT_LT(now, 0.5 * before) << positions;
        before = now;
    }
    for (const char* pattern : {"sequence", "grid", "random"}) {
        EXPECT_LT(error_of(64, pattern), 0.06) << pattern;
        EXPECT_GT(error_of(64, pattern), before) << pattern;
    }
}

/// What a rectangle of `size` at `height` brings to (x, 0, 0) from beyond `border`: cosines at both ends over the
/// squared distance, by the midpoint rule.
double light_of_rectangle(const glm::dvec2& size, double height, double x, double border) {
    constexpr int kCells = 200;
    double sum = 0;
    for (int i = 0; i < kCells; ++i)
        for (int k = 0; k < kCells; ++k) {
            const double u = ((i + 0.5) / kCells - 0.5) * size.x, v = ((k + 0.5) / kCells - 0.5) * size.y;
            const double square = (u - x) * (u - x) + v * v + height * height;
            if (u > border) sum += 1 / (square * square);
        }
    return sum;
}

// A light that is wide and near brings most of its light from right above: a plain mean would be off by a tenth.
TEST_F(MultiTest, PositionsWeighAsMuchAsTheLightTheyBring) {
    constexpr double kNear = 2, kLow = 0.5;
    Light light = light_at(LightKind::Area, kNear);
    light.area_size = {4, 3};
    const SceneView view = edge_scene(light, kLow, 0.9);
    const auto run = runner_.render(view, "multi", settings(256, "spiral", 256));
    const auto border_at = [](double x) { return -x * (kNear - kLow) / kLow; };
    const auto truth = [&](double x) {
        return light_of_rectangle(light.area_size, kNear, x, border_at(x)) /
               light_of_rectangle(light.area_size, kNear, x, -10);
    };
    const Errors errors = compare(run, truth);
    EXPECT_LT(errors.mean, 0.004);
    EXPECT_LT(errors.most, 0.015);
    EXPECT_GT(compare(run, [&](double x) { return square_beyond(border_at(x) / 2); }).most, 0.1);
}

TEST_F(MultiTest, OnePositionAndLightsWithoutSizeGiveTheHardShadowExactly) {
    for (const LightKind kind : kKinds) {
        SceneView view = random_scene(4, 160, 90);
        Light light = make_light(kind, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 70);
        light.radius = 0.5;
        light.sun_angle = 0.1;
        view.scene->lights = {light};
        for (const char* technique : {"sm", "edsm"}) {
            ParameterValues given = settings(1, "spiral", 256);
            given.set("technique", std::string(technique));
            const auto hard = runner_.render(view, technique, parameters({{"map_size", std::int64_t{256}}}));
            EXPECT_EQ(runner_.render(view, "multi", given).visibility(), hard.visibility()) << technique;
        }
        view.scene->lights[0].radius = view.scene->lights[0].sun_angle = 0;
        view.scene->lights[0].area_size = glm::dvec2(0);
        const auto run = runner_.render(view, "multi", settings(9, "grid", 256));
        EXPECT_EQ(run.visibility(),
                  runner_.render(view, "sm", parameters({{"map_size", std::int64_t{256}}})).visibility());
        EXPECT_EQ(run.stats.counters.at("light_samples"), 1);
    }
}

// A wall that half of a wide sun shines on is lit by that half, and nothing is between them.
TEST_F(MultiTest, ALightThatIsHalfBelowTheHorizonIsNoShadow) {
    SceneView view;
    view.width = 48, view.height = 27;
    view.place(view.add("floor", make_plane(60)));
    view.camera = make_camera({0.5, -2, 6}, {0, 0, 0}, 48, 27);
    view.scene->lights = {make_light(LightKind::Sun, {-5, 0, 0.2}, {0, 0, 0})};
    view.scene->lights[0].sun_angle = 0.6;
    const auto run = runner_.render(view, "multi", settings(32, "spiral", 128));
    for (const float value : run.visibility()) ASSERT_EQ(value, 1.0f);
}

TEST_F(MultiTest, OffersTheTechniquesForHardShadowsAndNoOthers) {
    const TechniqueDescriptor& multi = find_technique_descriptor("multi");
    const auto offers = [&](const std::string& id) {
        const auto& items = multi.parameters.back().items;
        return std::any_of(items.begin(), items.end(), [&](const EnumItem& item) { return item.id == id; });
    };
    EXPECT_EQ(multi.parameters.back().id, "technique");
    for (const TechniqueDescriptor& other : technique_descriptors())
        EXPECT_EQ(offers(other.id),
                  !other.test_only && find_truth(other, resolve_parameters(other, {})).kind == TruthKind::Hard)
            << other.id;
    EXPECT_TRUE(offers("sm"));
    EXPECT_FALSE(offers("pcf"));
    EXPECT_EQ(find_truth(multi, resolve_parameters(multi, {})).kind, TruthKind::Soft);
    for (const std::int64_t positions : {std::int64_t{0}, std::int64_t{257}})
        EXPECT_THROW(resolve_parameters(multi, parameters({{"positions", positions}})), InputError);
}

TEST_F(MultiTest, ACancelIsHeardBetweenSamples) {
    const SceneView view = edge_scene(small_light(LightKind::Area, false), kEdge, 0.25);
    runner_.engine().cancel_token().request();
    EXPECT_THROW(runner_.render(view, "multi", settings(2)), Cancelled);
    runner_.engine().cancel_token().reset();
}

}  // namespace
}  // namespace shadow_layers::testing
