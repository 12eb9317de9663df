// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// vsm, esm, evsm and msm: borders against the filtered mask in closed form, planes that must not shade themselves, cube
// faces without seams, the order of their light bleeding, and values that are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shadow_layers/error.h"
#include "stages/depth_map.h"
#include "stages/moment_map.h"
#include "support/ray_oracle.h"
#include "support/technique_runner.h"

namespace shadow_layers::testing {
namespace {

const std::vector<std::string> kTechniques{"vsm", "esm", "evsm", "msm"};

ParameterValues with(ParameterValues values, std::initializer_list<std::pair<const char*, ParameterValue>> items) {
    for (const auto& [id, value] : items) values.set(id, value);
    return values;
}

/// `map_size`, and no bleed reduction where there is one.
ParameterValues plain(const std::string& technique, std::int64_t map_size) {
    ParameterValues values = parameters({{"map_size", map_size}});
    if (technique != "esm") values.set("bleed_reduction", 0.0);
    return values;
}

class Prefilter : public ::testing::TestWithParam<std::string> {
protected:
    TechniqueRunner runner_;
};

/// A half-plane caster over a ground plane under a sun from above: visibility depends on x alone.
SceneView half_plane_scene() {
    SceneView view;
    view.width = 256, view.height = 16;
    view.place(view.add("ground", make_plane(8)));
    view.place(view.add("half", make_plane(8)), placement({4.0131, 0, 1}), kInstanceShadow);
    view.camera = make_camera({0, 0, 10}, {0, 0, 0}, 256, 16, 12);
    view.scene->lights = {make_light(LightKind::Sun, {0, 0, 5}, {0, 0, 0})};
    return view;
}

TEST_P(Prefilter, AnEdgeOverAPlaneGivesTheFilteredMask) {
    const SceneView view = half_plane_scene();
    for (const BlurFilter filter : {BlurFilter::Box, BlurFilter::Gaussian})
        for (const int radius : {0, 1, 4}) {
            const auto run = runner_.render(
                view, GetParam(),
                with(plain(GetParam(), 64), {{"blur_radius", std::int64_t(radius)},
                                             {"filter", filter == BlurFilter::Box ? "box" : "gaussian"}}));
            const LightView& light = run.positions[0].views[0];
            const auto map = render_depth_map(runner_.engine(), *view.scene, run.positions[0]);
            const auto depths = map->texture->download<float>();
            const auto weights = compute_blur_weights(radius, filter);
            // Which texels the caster covers, blurred and interpolated as the map is.
            const auto blurred = [&](int x, int y) {
                double sum = 0;
                for (int v = -radius; v <= radius; ++v)
                    for (int u = -radius; u <= radius; ++u)
                        sum += weights[std::size_t(std::abs(u))] * weights[std::size_t(std::abs(v))] *
                               (depths[std::size_t((y + v) * light.size_texels + x + u)] < 0.5f);
                return sum;
            };
            int between = 0;
            for (int px = 0; px < view.width; ++px) {
                const std::size_t pixel = std::size_t(8 * view.width + px);
                const glm::dvec4 at = light.lc_from_ws *
                                      glm::dvec4(glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws, 1);
                const glm::dvec2 texel = (glm::dvec2(at) + 1.0) * 0.5 * double(light.size_texels) - 0.5;
                const int x = int(std::floor(texel.x)), y = int(std::floor(texel.y));
                const double fx = texel.x - x, fy = texel.y - y;
                const double lit = (blurred(x, y) * (1 - fx) + blurred(x + 1, y) * fx) * (1 - fy) +
                                   (blurred(x, y + 1) * (1 - fx) + blurred(x + 1, y + 1) * fx) * fy;
                between += lit > 0.05 && lit < 0.95;
                ASSERT_NEAR(run.visibility()[pixel], lit, 5e-3) << "radius " << radius << " at pixel " << px;
            }
            EXPECT_GT(between, 1 + 2 * radius);
        }
}

/// A tilted plane that fills the picture, and nothing else.
SceneView tilted_plane(LightKind kind, double tilt_deg) {
    SceneView view;
    view.width = 64, view.height = 36;
    view.place(view.add("plane", make_plane(30)), placement({0, 0, 0}, tilt_deg, {0.3, 1, 0}));
    view.camera = make_camera({0, -1, 6}, {0, 0, 0}, view.width, view.height);
    view.scene->lights = {make_light(kind, {0.6, 0.4, 6}, {0, 0, 0}, 70)};
    return view;
}

TEST_P(Prefilter, APlaneDoesNotShadeItselfHoweverItIsFiltered) {
    const ParameterValues base = plain(GetParam(), 128), fine = plain(GetParam(), 1024);
    const std::vector<ParameterValues> modes{
        with(base, {{"blur_radius", std::int64_t{0}}}),
        with(base, {{"blur_radius", std::int64_t{7}}, {"filter", "box"}}),
        with(base, {{"blur_radius", std::int64_t{32}}}),
        with(fine, {{"mipmaps", true}}),
        with(fine, {{"anisotropy", std::int64_t{8}}}),
        with(base, {{"bits", "16"}}),
    };
    for (const double tilt : {0.0, 75.0})
        for (const LightKind kind : {LightKind::Sun, LightKind::Point})
            for (std::size_t mode = 0; mode < modes.size(); ++mode) {
                const auto run = runner_.render(tilted_plane(kind, tilt), GetParam(), modes[mode]);
                const float least = *std::min_element(run.visibility().begin(), run.visibility().end());
                EXPECT_GE(least, 0.99f) << "tilt " << tilt << ", mode " << mode << ", light " << int(kind);
            }
}

TEST_P(Prefilter, NoSeamsAtCubeFacesAndMapRims) {
    // Point light in the middle of an empty room: nothing is in shadow, however far the blur reaches.
    SceneView view;
    view.width = 160, view.height = 90;
    const auto wall = view.add("wall", make_plane(4, 3));
    view.place(wall, placement({0, 0, -2}));
    view.place(wall, placement({0, 0, 2}, 180, {1, 0, 0}));
    view.place(wall, placement({-2, 0, 0}, 90, {0, 1, 0}));
    view.place(wall, placement({2, 0, 0}, -90, {0, 1, 0}));
    view.place(wall, placement({0, 2, 0}, 90, {1, 0, 0}));
    view.place(wall, placement({0, -2, 0}, -90, {1, 0, 0}));
    view.camera = make_camera({-1.7, -1.6, 1.2}, {1, 1.2, -0.4}, view.width, view.height, 100);
    view.scene->lights = {make_light(LightKind::Point, {0.11, 0.07, 0.13}, {1, 0.4, 0.2})};
    for (const int radius : {1, 6, 12}) {
        const auto run =
            runner_.render(view, GetParam(), with(plain(GetParam(), 64), {{"blur_radius", std::int64_t{radius}}}));
        ASSERT_GE(run.positions[0].views.size(), 4u);
        // Kernels darken a room's edges by their nature; the cube's seams lie across the flat walls.
        int dark_on_flat = 0, flat = 0;
        for (std::size_t pixel = 0; pixel < run.visibility().size(); ++pixel) {
            const glm::dvec3 size = glm::abs(glm::dvec3(run.frame->positions_rel[pixel]) + run.frame->origin_ws);
            const double second =
                std::max({std::min(size.x, size.y), std::min(size.y, size.z), std::min(size.x, size.z)});
            if (second > 2.0 - 2.5 * (radius + 2) * 2.2 / 64) continue;
            ++flat;
            dark_on_flat += run.visibility()[pixel] < 0.996f;
        }
        EXPECT_GT(flat, 2000);
        EXPECT_EQ(dark_on_flat, 0) << radius;
    }
}

TEST_P(Prefilter, AShadowIsTheSameOnBothSidesOfACubesSeam) {
    // A rod's shadow crosses from one face of the cube to the next on a flat floor. Along the seam (x = y of the
    // light's axes) what two frames of the same scene show must agree when the light's cube is turned a little.
    SceneView view;
    view.width = 200, view.height = 112;
    view.place(view.add("floor", make_plane(16)));
    view.place(view.add("rod", make_box({0.3f, 8, 0.1f})), placement({1.2, 0, 0.6}));
    view.camera = make_camera({2.2, -0.2, 5}, {2.2, 0, 0}, view.width, view.height, 50);
    const auto render_turned = [&](double turn_deg) {
        Light light = make_light(LightKind::Point, {0, 0, 1.7}, {0, 0, 0});
        light.world_from_light = light.world_from_light * glm::rotate(glm::dmat4(1), glm::radians(turn_deg), {0, 1, 0});
        view.scene->lights = {light};
        return runner_.render(view, GetParam(), plain(GetParam(), 1024)).visibility();
    };
    const auto seam_in_shadow = render_turned(0), seam_elsewhere = render_turned(17);
    double difference = 0, lit = 0;
    for (std::size_t k = 0; k < seam_in_shadow.size(); ++k) {
        difference += std::abs(seam_in_shadow[k] - seam_elsewhere[k]);
        lit += seam_in_shadow[k];
    }
    const double pixels = double(seam_in_shadow.size());
    EXPECT_GT(lit, 0.2 * pixels);
    EXPECT_LT(lit, 0.95 * pixels);
    EXPECT_LT(difference / pixels, 0.01);
}

INSTANTIATE_TEST_SUITE_P(All, Prefilter, ::testing::ValuesIn(kTechniques), [](const auto& item) { return item.param; });

/// A plate over a floor, both unseen but for their shadow, and a second plate higher up that covers half of the first.
/// The floor below is dark; the upper plate's edge crosses it in every footprint that holds both plates.
SceneView plates_scene() {
    SceneView view;
    view.width = 160, view.height = 90;
    view.place(view.add("floor", make_plane(12)));
    view.place(view.add("plate", make_plane(2)), placement({0, 0, 1}), kInstanceShadow);
    view.place(view.add("cover", make_plane(2)), placement({0.95, 0, 2.5}, 20), kInstanceShadow);
    view.camera = make_camera({0, -2, 6}, {0, 0, 0}, view.width, view.height);
    view.scene->lights = {make_light(LightKind::Spot, {0.2, 0.1, 6}, {0, 0, 0}, 70)};
    return view;
}

TEST(PrefilterBleeding, IsWorstForVarianceAndLessForWarpsAndMoments) {
    TechniqueRunner runner;
    const SceneView view = plates_scene();
    const RayOracle oracle(view.scene);
    std::vector<float> truth;
    std::map<std::string, double> bled;
    for (const std::string& technique : kTechniques) {
        const auto run =
            runner.render(view, technique, with(plain(technique, 128), {{"blur_radius", std::int64_t{3}}}));
        if (truth.empty()) truth = oracle.compute_visibility(*run.frame, view.scene->lights[0], run.positions[0]);
        // Pixels that are in full shadow with all round them: nothing there should be lit by any filter.
        double sum = 0;
        int dark = 0;
        for (int y = 5; y < view.height - 5; ++y)
            for (int x = 5; x < view.width - 5; ++x) {
                bool inside = true;
                for (int v = -5; v <= 5 && inside; ++v)
                    for (int u = -5; u <= 5 && inside; ++u)
                        inside = truth[std::size_t((y + v) * view.width + x + u)] < 0.5f;
                if (!inside) continue;
                ++dark;
                sum += run.visibility()[std::size_t(y * view.width + x)];
            }
        ASSERT_GT(dark, 1000);
        bled[technique] = sum / dark;
    }
    EXPECT_GT(bled["vsm"], 1e-3);
    EXPECT_LT(bled["evsm"], 0.5 * bled["vsm"]);
    EXPECT_LT(bled["msm"], 0.5 * bled["vsm"]);
}

std::string refusal(const std::string& technique, const ParameterValues& given) {
    try {
        resolve_parameters(find_technique_descriptor(technique), given);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

void expect_refused(const std::string& technique, const ParameterValues& given,
                    std::initializer_list<const char*> words) {
    const std::string text = refusal(technique, given);
    for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

TEST(PrefilterParameters, ExponentsThatOverflowTheirFormatAreRefused) {
    expect_refused("evsm", parameters({{"positive_exponent", 80.0}}), {"evsm", "positive_exponent", "80", "42"});
    expect_refused("evsm", parameters({{"negative_exponent", 20.0}, {"bits", "16"}}),
                   {"evsm", "negative_exponent", "20", "5.54", "bits = 16"});
    expect_refused("esm", parameters({{"exponent", 200.0}}), {"esm", "exponent", "200", "150"});
    expect_refused("esm", parameters({{"exponent", 80.0}, {"bits", "16"}}),
                   {"esm", "exponent", "80", "19", "bits = 16"});
    EXPECT_EQ(refusal("esm", parameters({{"exponent", 80.0}})), "");
    EXPECT_EQ(refusal("esm", parameters({{"exponent", 19.0}, {"bits", "16"}})), "");
    EXPECT_EQ(refusal("evsm", parameters({{"positive_exponent", 5.54}, {"bits", "16"}})), "");
    for (const std::string& technique : kTechniques)
        expect_refused(technique, parameters({{"blur_radius", std::int64_t{-1}}}),
                       {technique.c_str(), "blur_radius", "-1"});
}

TEST(PrefilterParameters, TruthsAreFilteredOverTheBlursVariance) {
    for (const std::string& technique : kTechniques) {
        const TechniqueDescriptor& descriptor = find_technique_descriptor(technique);
        const auto footprint = [&](int radius, const char* filter) {
            const TruthSpec truth =
                find_truth(descriptor, resolve_parameters(descriptor, parameters({{"blur_radius", std::int64_t{radius}},
                                                                                  {"filter", std::string(filter)}})));
            EXPECT_EQ(truth.kind, TruthKind::Filtered);
            return truth.footprint_texels;
        };
        EXPECT_NEAR(footprint(0, "box"), 1, 1e-9);
        EXPECT_NEAR(footprint(7, "box"), 15, 1e-9);
        EXPECT_NEAR(footprint(7, "gaussian"), std::sqrt(12 * compute_blur_variance(7, BlurFilter::Gaussian) + 1), 1e-9);
    }
}

}  // namespace
}  // namespace shadow_layers::testing
