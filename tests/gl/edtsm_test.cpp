// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Penumbrae of edtsm along a straight edge, where everything is known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

constexpr double kEdge = 0.0131;  // where the caster's edge passes the origin, off any raster

/// A half-plane at height 1 over the ground; its edge runs through the origin, turned by `turn_deg` from the y axis.
struct EdgeScene {
    SceneView view;
    glm::dvec2 into_shadow{1, 0};

    /// On the ground, for a light far above: how far a place is in the shadow; negative where it is lit.
    double depth_in_shadow(const glm::dvec3& place) const { return glm::dot(glm::dvec2(place), into_shadow) - kEdge; }
};

EdgeScene make_edge_scene(double turn_deg, double tilt_deg, double distance, bool perspective = true) {
    EdgeScene edge;
    SceneView& view = edge.view;
    view.width = 240, view.height = 135;
    view.place(view.add("ground", make_plane(80)));
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(turn_deg), glm::dvec3(0, 0, 1));
    view.place(view.add("half", make_plane(40)), turn * placement({20 + kEdge, 0, 1}), kInstanceShadow);
    const double tilt = glm::radians(tilt_deg);
    view.camera = make_camera(distance * glm::dvec3(0, -std::sin(tilt), std::cos(tilt)), {0, 0, 0}, 240, 135, 20);
    if (!perspective) {
        const double half = std::tan(glm::radians(10.0)) * distance;
        view.camera.perspective = false;
        view.camera.window = {-half, half, -half * 135 / 240, half * 135 / 240};
    }
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    edge.into_shadow = {std::cos(glm::radians(turn_deg)), std::sin(glm::radians(turn_deg))};
    return edge;
}

ParameterValues fixed_penumbra(double width, double filter = 0) {
    return parameters({{"map_size", std::int64_t{1024}},
                       {"source", std::string("edsm")},
                       {"penumbra_from", std::string("fixed")},
                       {"penumbra", width},
                       {"filter", filter}});
}

struct RampError {
    double rms = 0, worst = 0, shift = 0;
    int count = 0;
};

/// Against the expected visibility of a place, over the region's pixels where that is between 0 and 1 or nearly so.
RampError measure(const TechniqueRun& run, const std::function<double(const glm::dvec3&)>& expected, int row_step = 1) {
    const Frame& frame = *run.frame;
    RampError error;
    for (int y = frame.overscan_px; y < frame.height - frame.overscan_px; y += row_step)
        for (int x = frame.overscan_px; x < frame.width - frame.overscan_px; ++x) {
            const std::size_t pixel = std::size_t(y * frame.width + x);
            const glm::dvec3 place = glm::dvec3(frame.positions_rel[pixel]) + frame.origin_ws;
            const double want = expected(place);
            if (want < -0.1 || want > 1.1) continue;
            const double wrong = run.visibility()[pixel] - std::clamp(want, 0.0, 1.0);
            error.rms += wrong * wrong;
            error.shift += wrong;
            error.worst = std::max(error.worst, std::abs(wrong));
            ++error.count;
        }
    error.rms = std::sqrt(error.rms / std::max(error.count, 1));
    error.shift /= std::max(error.count, 1);
    return error;
}

/// Pixels that `length` at the origin takes in the picture, along the row.
double pixels_of(const TechniqueRun& run, double length) {
    const std::size_t middle = std::size_t(run.frame->height / 2 * run.frame->width + run.frame->width / 2);
    return length / glm::length(run.frame->positions_rel[middle + 1] - run.frame->positions_rel[middle]);
}

class EDTSMTest : public ::testing::Test {
protected:
    static TechniqueRunner& runner() {
        static TechniqueRunner shared;
        return shared;
    }
};

TEST_F(EDTSMTest, TheRampIsAsWideAsAskedFromAnyView) {
    for (const double turn : {0.0, 18.4, 45.0, 70.0})
        for (const double tilt : {0.0, 55.0})
            for (const double distance : {6.0, 18.0})
                for (const bool perspective : {true, false}) {
                    const EdgeScene edge = make_edge_scene(turn, tilt, distance, perspective);
                    const double width = 0.5;
                    const auto run = runner().render(edge.view, "edtsm", fixed_penumbra(width));
                    const RampError error = measure(
                        run, [&](const glm::dvec3& place) { return 0.5 - edge.depth_in_shadow(place) / width; });
                    SCOPED_TRACE(::testing::Message() << "turn " << turn << " tilt " << tilt << " from " << distance
                                                      << (perspective ? "" : " orthographic"));
                    // The border's place in its pixel is fitted to the steps along it, within a quarter of a pixel of a
                    // ramp `across` wide. Along the picture's own axis there are no steps to tell it.
                    const double pixels = turn == 0 ? 0.55 : 0.25;
                    const double across = pixels_of(run, width) * std::cos(glm::radians(tilt));
                    EXPECT_GT(error.count, 800);
                    EXPECT_LT(error.rms, pixels / across);
                    EXPECT_LT(std::abs(error.shift), pixels / across);
                }
}

TEST_F(EDTSMTest, TheScreenMetricCountsPixels) {
    for (const double distance : {6.0, 18.0}) {
        const EdgeScene edge = make_edge_scene(0, 0, distance);
        ParameterValues values = fixed_penumbra(1);
        values.set("metric", std::string("screen"));
        values.set("penumbra_px", 40.0);
        const auto run = runner().render(edge.view, "edtsm", values);
        const double per_unit = pixels_of(run, 1);
        const RampError error =
            measure(run, [&](const glm::dvec3& place) { return 0.5 - edge.depth_in_shadow(place) * per_unit / 40; });
        EXPECT_GT(error.count, 3000);
        EXPECT_LT(error.rms, 0.55 / 40) << distance;
    }
}

/// A camera that comes near makes a penumbra wider than the picture: the ramp goes on as it was, and a warning says so.
TEST_F(EDTSMTest, APenumbraMayGrowOverThePicture) {
    const double width = 2;
    runner().engine().take_warnings();
    for (const double distance : {18.0, 6.0, 4.0, 3.0}) {
        const EdgeScene edge = make_edge_scene(0, 0, distance);
        const auto run = runner().render(edge.view, "edtsm", fixed_penumbra(width));
        const RampError error =
            measure(run, [&](const glm::dvec3& place) { return 0.5 - edge.depth_in_shadow(place) / width; });
        EXPECT_GT(error.count, 5000);
        EXPECT_LT(error.rms, 0.55 / pixels_of(run, width)) << distance;
        const auto warnings = runner().engine().take_warnings();
        const bool is_wider = pixels_of(run, width) > 240 + 2 * 16;
        EXPECT_EQ(is_wider, distance < 5);
        ASSERT_EQ(warnings.size(), is_wider ? 1u : 0u) << distance;
        if (!is_wider) continue;
        for (const char* part : {"edtsm", "\"penumbra\"", "2 scene units"})
            EXPECT_NE(warnings[0].find(part), std::string::npos) << warnings[0];
    }
}

TEST_F(EDTSMTest, APenumbraInPixelsMayBeWiderThanThePicture) {
    const EdgeScene edge = make_edge_scene(0, 0, 6);
    ParameterValues values = fixed_penumbra(1);
    values.set("metric", std::string("screen"));
    values.set("penumbra_px", 4096.0);
    runner().engine().take_warnings();
    const auto run = runner().render(edge.view, "edtsm", values);
    const double per_unit = pixels_of(run, 1);
    const RampError error =
        measure(run, [&](const glm::dvec3& place) { return 0.5 - edge.depth_in_shadow(place) * per_unit / 4096; });
    EXPECT_EQ(error.count, 240 * 135);
    EXPECT_LT(error.worst, 1.0 / 4096);
    const auto warnings = runner().engine().take_warnings();
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("\"penumbra_px\""), std::string::npos) << warnings[0];
}

TEST_F(EDTSMTest, TheRampIsSmoothAndHasNoStepInTheMiddle) {
    for (const double filter : {0.0, 0.25}) {
        const EdgeScene edge = make_edge_scene(0, 0, 8);
        const auto run = runner().render(edge.view, "edtsm", fixed_penumbra(0.9, filter));
        const Frame& frame = *run.frame;
        const std::size_t row = std::size_t(frame.height / 2 * frame.width);
        const double slope = 1 / pixels_of(run, 0.9);
        std::set<float> levels;
        int inside = 0;
        for (int x = frame.overscan_px; x + 1 < frame.width - frame.overscan_px; ++x) {
            const float here = run.visibility()[row + std::size_t(x)],
                        next = run.visibility()[row + std::size_t(x) + 1];
            EXPECT_GE(here, next) << x;  // the shadow lies to the right
            EXPECT_LT(here - next, 1.2 * slope) << x;
            if (here <= 0 || here >= 1) continue;
            ++inside;
            levels.insert(here);
            if (here > 0.1f && here < 0.9f) {
                EXPECT_GT(here - next, 0.8 * slope) << x;
            }
        }
        EXPECT_GT(inside, 50);
        EXPECT_EQ(int(levels.size()), inside) << "each pixel of the ramp has a level of its own";
    }
}

TEST_F(EDTSMTest, ThinGapsAndThinCastersHaveTheirPart) {
    // A gap between two half-planes, or a bar: both borders lie within the penumbra.
    constexpr double kThin = 0.15, kWidth = 0.5;
    for (const bool gap : {true, false}) {
        SceneView view = make_edge_scene(0, 0, 5).view;
        view.scene->instances.pop_back();
        if (gap) {
            const auto half = view.add("half", make_plane(40));
            view.place(half, placement({20 + 0.5 * kThin + kEdge, 0, 1}), kInstanceShadow);
            view.place(half, placement({-20 - 0.5 * kThin + kEdge, 0, 1}), kInstanceShadow);
        } else {
            view.place(view.add("bar", make_box({float(kThin), 40, 0.01f})), placement({kEdge, 0, 1}), kInstanceShadow);
        }
        const auto run = runner().render(view, "edtsm", fixed_penumbra(kWidth));
        const RampError error = measure(run, [&](const glm::dvec3& place) {
            const double low = std::max(place.x - kEdge - 0.5 * kWidth, -0.5 * kThin);
            const double high = std::min(place.x - kEdge + 0.5 * kWidth, 0.5 * kThin);
            const double part = std::max(high - low, 0.0) / kWidth;
            return gap ? part : 1 - part;
        });
        EXPECT_LT(error.rms, 0.02) << gap;
        EXPECT_LT(error.worst, 0.1) << gap;
    }
}

TEST_F(EDTSMTest, TheWorldMetricDoesNotDependOnTheView) {
    // The same places of the ground from two cameras.
    const auto sample = [&](double tilt, double distance, const char* metric) {
        const EdgeScene edge = make_edge_scene(30, tilt, distance);
        ParameterValues values = fixed_penumbra(0.4, 0.25);
        values.set("metric", std::string(metric));
        const auto run = runner().render(edge.view, "edtsm", values);
        // Mean visibility by depth in the shadow, in 16 slices over the penumbra.
        std::vector<double> sum(16), count(16);
        for (std::size_t pixel = 0; pixel < run.frame->pixel_count(); ++pixel) {
            const glm::dvec3 place = glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws;
            const double at = (edge.depth_in_shadow(place) / 0.4 + 0.5) * 16;
            if (at < 0 || at >= 16) continue;
            sum[std::size_t(at)] += run.visibility()[pixel];
            count[std::size_t(at)] += 1;
        }
        for (std::size_t k = 0; k < 16; ++k) sum[k] /= std::max(count[k], 1.0);
        return sum;
    };
    const auto far_apart = [](const std::vector<double>& a, const std::vector<double>& b) {
        double most = 0;
        for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
        return most;
    };
    EXPECT_LT(far_apart(sample(0, 6, "world"), sample(50, 11, "world")), 0.04);
    EXPECT_GT(far_apart(sample(0, 6, "screen"), sample(50, 11, "screen")), 0.1);
}

TEST_F(EDTSMTest, TheMeanFilterKeepsDepthEdges) {
    // A lit card that casts nothing floats before the lit half of the penumbra.
    EdgeScene edge = make_edge_scene(0, 0, 8);
    const auto without = runner().render(edge.view, "edtsm", fixed_penumbra(0.8, 0.5));
    edge.view.place(edge.view.add("card", make_plane(0.5)), placement({-0.48, 0, 1.5}), kInstanceCamera);
    const auto run = runner().render(edge.view, "edtsm", fixed_penumbra(0.8, 0.5));
    int card = 0, ground = 0;
    for (std::size_t pixel = 0; pixel < run.frame->pixel_count(); ++pixel) {
        if (run.frame->ids[pixel].instance == 2) {
            ++card;
            ASSERT_EQ(run.visibility()[pixel], 1.0f);
        } else {
            ++ground;
            ASSERT_NEAR(run.visibility()[pixel], without.visibility()[pixel], 0.06);
        }
    }
    EXPECT_GT(card, 800);
    EXPECT_GT(ground, 10000);
}

/// Part of a light that a place on the ground sees past the half-plane z = 1, x > kEdge: by many points on the light.
double count_light(const Light& light, const glm::dvec3& place) {
    constexpr int kSide = 24;
    double seen = 0, all = 0;
    const glm::dmat4& axes = light.world_from_light;
    const glm::dvec3 centre(axes[3]);
    const bool square = light.kind == LightKind::Area && !light.area_round;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const glm::dvec2 at = 2.0 * glm::dvec2(i + 0.5, j + 0.5) / double(kSide) - 1.0;
            if (!square && glm::length(at) > 1) continue;
            glm::dvec3 way;
            if (light.kind == LightKind::Sun) {
                const double radius = std::tan(0.5 * light.sun_angle);
                way = glm::dvec3(axes[2]) + radius * (at.x * glm::dvec3(axes[0]) + at.y * glm::dvec3(axes[1]));
            } else if (light.kind == LightKind::Area) {
                way = centre - place + 0.5 * light.area_size.x * at.x * glm::dvec3(axes[0]) +
                      0.5 * light.area_size.y * at.y * glm::dvec3(axes[1]);
            } else {
                const glm::dvec3 ahead = glm::normalize(centre - place);
                const glm::dvec3 u = glm::normalize(glm::cross(ahead, glm::dvec3(0.3, 1, 0.2)));
                way = centre - place + light.radius * (at.x * u + at.y * glm::cross(ahead, u));
            }
            all += 1;
            seen += place.x + way.x / way.z * (1 - place.z) <= kEdge;
        }
    return seen / all;
}

TEST_F(EDTSMTest, ThePenumbraOfALightHasItsClosedForm) {
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area})
        for (const bool round : {false, true}) {
            if (round && kind != LightKind::Area) continue;
            EdgeScene edge = make_edge_scene(0, 40, 2.5);
            Light light = make_light(kind, {0.5, -0.6, 3.5}, {0, 0.2, 0}, 90);
            light.radius = 0.3;
            light.sun_angle = 0.25;
            light.area_size = {0.9, 0.5};
            light.area_round = round;
            edge.view.scene->lights = {light};
            for (const char* source : {"edsm", "half"}) {
                ParameterValues values =
                    parameters({{"map_size", std::int64_t{1024}}, {"source", std::string(source)}, {"filter", 0.0}});
                const auto run = runner().render(edge.view, "edtsm", values);
                double low = 1, high = 0;
                const RampError error = measure(
                    run,
                    [&](const glm::dvec3& place) {
                        const double want = count_light(light, place);
                        low = std::min(low, want), high = std::max(high, want);
                        return want > 0.001 && want < 0.999 ? want : -1.0;
                    },
                    8);
                SCOPED_TRACE(::testing::Message() << "light " << int(kind) << " round " << round << " by " << source);
                EXPECT_EQ(low, 0);
                EXPECT_EQ(high, 1);
                EXPECT_GT(error.count, 500);
                // Half a pixel of a ramp that is some thirty wide.
                EXPECT_LT(error.rms, 0.02);
                EXPECT_LT(error.worst, 0.09);
            }
        }
}

}  // namespace
}  // namespace shadow_layers::testing
