// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What every technique must hold, over all that are registered and every kind of light they serve.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gl/shared_session.h"
#include "lights/facing.h"
#include "shadow_layers/session.h"
#include "support/ray_oracle.h"
#include "support/technique_scenes.h"
#include "support/tolerances.h"

namespace shadow_layers::testing {
namespace {

struct Case {
    std::string technique;
    LightKind kind;
    bool is_wide = false;  ///< a light of a size that shows; otherwise suns, spots and points have none
};

std::string kind_name(LightKind kind) {
    switch (kind) {
        case LightKind::Sun:
            return "sun";
        case LightKind::Spot:
            return "spot";
        case LightKind::Point:
            return "point";
        case LightKind::Area:
            return "area";
    }
    return "?";
}

std::ostream& operator<<(std::ostream& stream, const Case& item) {
    return stream << item.technique << " with a " << (item.is_wide ? "wide " : "") << kind_name(item.kind);
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const TechniqueDescriptor& technique : technique_descriptors())
        for (const LightKind kind : technique.lights) {
            cases.push_back({technique.id, kind});
            if (technique.light_size == LightSize::Followed) cases.push_back({technique.id, kind, true});
        }
    return cases;
}

ParameterValues small_maps(const TechniqueDescriptor& technique, std::int64_t map_size = 128) {
    ParameterValues values;
    for (const ParameterSpec& spec : technique.parameters)
        if (spec.id == "map_size") values.set("map_size", map_size);
    return values;
}

RenderRequest make_request(const SceneView& view) {
    RenderRequest request;
    request.scene = view.scene;
    request.camera = view.camera;
    request.width = view.width;
    request.height = view.height;
    request.combined = false;
    return request;
}

std::vector<Layer> render(Session& session, const RenderRequest& request) {
    std::vector<Layer> layers;
    session.render(request, [&](Layer&& layer) { layers.push_back(std::move(layer)); });
    return layers;
}

/// A plane that fills the picture, seen from above.
SceneView plane_view(int width = 48, int height = 32) {
    SceneView view;
    view.width = width, view.height = height;
    view.place(view.add("plane", make_plane(40, 2)));
    view.camera = make_camera({0.5, -2, 6}, {0, 0, 0}, width, height);
    return view;
}

class Contract : public ::testing::TestWithParam<Case> {
protected:
    const TechniqueDescriptor& technique() const { return find_technique_descriptor(GetParam().technique); }
    LightKind kind() const { return GetParam().kind; }
    Light light_above() const { return widen(make_light(kind(), {0.7, 0.4, 5}, {0.1, 0.2, 0}, 140)); }
    Light widen(Light light) const {
        if (GetParam().is_wide) light.radius = 0.4, light.sun_angle = 0.15, light.area_size = {0.9, 0.6};
        return light;
    }

    RenderRequest request_for(const SceneView& view, std::size_t light_count = 1) const {
        RenderRequest request = make_request(view);
        for (std::size_t k = 0; k < light_count; ++k)
            request.jobs.push_back({std::uint32_t(k), technique().id, small_maps(technique())});
        return request;
    }
    std::vector<float> visibility_of(const SceneView& view) const {
        return render(shared_session(), request_for(view)).at(0).channels.at("visibility").data;
    }
    void expect_all(const SceneView& view, float value) const {
        const std::vector<float> visibility = visibility_of(view);
        ASSERT_EQ(visibility.size(), std::size_t(view.width * view.height));
        const auto wrong =
            std::count_if(visibility.begin(), visibility.end(), [&](float v) { return std::abs(v - value) > 1e-6f; });
        EXPECT_EQ(wrong, 0) << "of " << visibility.size() << " pixels are not " << value;
    }
    void check_layer(const Layer& layer, int width, int height) const {
        ASSERT_EQ(layer.channels.size(), technique().outputs.size());
        for (const OutputSpec& output : technique().outputs) {
            const Image& image = layer.channels.at(output.id);
            ASSERT_EQ(image.width, width);
            ASSERT_EQ(image.height, height);
            ASSERT_EQ(image.channels, output.channels);
            ASSERT_EQ(image.data.size(), std::size_t(width * height * output.channels));
            for (const float value : image.data) ASSERT_TRUE(std::isfinite(value)) << output.id;
            if (output.id != "visibility") continue;
            for (const float value : image.data) ASSERT_TRUE(value >= 0 && value <= 1) << value;
        }
    }
};

TEST_P(Contract, ValuesAreFiniteAndInRange) {
    SceneView view = random_scene(3, 96, 54);
    view.scene->lights = {light_above()};
    const auto layers = render(shared_session(), request_for(view));
    ASSERT_EQ(layers.size(), 1u);
    check_layer(layers[0], 96, 54);
    const auto& values = layers[0].channels.at("visibility").data;
    EXPECT_GT(*std::max_element(values.begin(), values.end()), 0.9f);
    EXPECT_LT(*std::min_element(values.begin(), values.end()), 0.1f);
}

TEST_P(Contract, TellsTheMemoryThatItHolds) {
    SceneView view = random_scene(3, 96, 54);
    view.scene->lights = {light_above()};
    std::int64_t bytes = 0;
    const auto layers = render(shared_session(), request_for(view));
    for (const auto& [name, count] : layers.at(0).stats.counters)
        if (name.ends_with("_bytes")) bytes += count;
    EXPECT_GT(bytes, 0);
}

TEST_P(Contract, TellsHowManySamplesOfTheLightItTook) {
    const int wanted = technique().needs(resolve_parameters(technique(), {})).light_samples;
    if (wanted == 1) GTEST_SKIP() << "takes one";
    SceneView view = random_scene(3, 96, 54);
    view.scene->lights = {light_above()};
    const bool has_size = GetParam().is_wide || kind() == LightKind::Area;
    EXPECT_EQ(render(shared_session(), request_for(view)).at(0).stats.counters.at("light_samples"),
              has_size ? wanted : 1);
}

TEST_P(Contract, TwoRendersAreBitIdentical) {
    SceneView view = random_scene(5, 96, 54);
    view.scene->lights = {light_above()};
    const auto first = render(shared_session(), request_for(view));
    const auto cached = render(shared_session(), request_for(view));
    Session fresh(make_session_options());
    const auto anew = render(fresh, request_for(view));
    for (const OutputSpec& output : technique().outputs) {
        EXPECT_EQ(first[0].channels.at(output.id).data, cached[0].channels.at(output.id).data) << output.id;
        EXPECT_EQ(first[0].channels.at(output.id).data, anew[0].channels.at(output.id).data) << output.id;
    }
    EXPECT_EQ(first[0].stats.counters.contains("map_bytes"), cached[0].stats.counters.contains("map_bytes"));
}

TEST_P(Contract, WithoutCastersAllIsLit) {
    SceneView view = plane_view();
    view.scene->instances[0].flags = kInstanceCamera;
    view.place(view.add("box", make_box({1, 1, 1})), placement({0, 0, 2}), 0);
    view.scene->lights = {light_above()};
    expect_all(view, 1);
}

TEST_P(Contract, APlaneAloneCastsNothingOnItself) {
    SceneView view = plane_view();
    view.scene->lights = {light_above()};
    expect_all(view, 1);
}

TEST_P(Contract, UnderAFullCoverAllIsShadowed) {
    SceneView view = plane_view();
    view.place(view.add("cover", make_plane(400)), placement({0, 0, 3}), kInstanceShadow);
    view.scene->lights = {light_above()};
    expect_all(view, 0);
}

TEST_P(Contract, BackgroundIsLit) {
    SceneView view = plane_view();
    view.camera = make_camera({0, 0, 3}, {0, -5, 8}, view.width, view.height, 30);
    view.scene->lights = {light_above()};
    expect_all(view, 1);
}

TEST_P(Contract, FacesTurnedAwayAreShadowed) {
    SceneView view = plane_view();
    // A sun from below; the others below the plane, looking up, wide enough for the whole picture.
    view.scene->lights = {widen(make_light(kind(), {0.7, 0.4, -5}, {0.1, 0.2, 0}, 179))};
    expect_all(view, 0);
}

TEST_P(Contract, OutsideTheConeIsLit) {
    if (kind() != LightKind::Spot && kind() != LightKind::Area) GTEST_SKIP() << "no cone";
    SceneView view = plane_view();
    view.place(view.add("cover", make_plane(400)), placement({0, 0, 3}), kInstanceShadow);
    view.scene->lights = {widen(make_light(kind(), {0.7, 0.4, 5}, {0.8, 0.5, 50}, 60))};
    expect_all(view, 1);
}

TEST_P(Contract, UnlinkedReceiversAreLit) {
    SceneView view = plane_view();
    view.place(view.add("cover", make_plane(400)), placement({0, 0, 3}), kInstanceShadow);
    view.scene->lights = {light_above()};
    view.scene->instances[0].receiver_group = 35;
    view.scene->lights[0].receiver_set = ~(std::uint64_t{1} << 35);
    expect_all(view, 1);
    view.scene->lights[0].receiver_set = std::uint64_t{1} << 35;
    expect_all(view, 0);
}

TEST_P(Contract, UnlinkedCastersCastNothing) {
    SceneView view = plane_view();
    view.place(view.add("cover", make_plane(400)), placement({0, 0, 3}), kInstanceShadow);
    view.scene->instances[1].blocker_group = 40;
    view.scene->lights = {light_above()};
    view.scene->lights[0].blocker_set = ~(std::uint64_t{1} << 40);
    expect_all(view, 1);
}

TEST_P(Contract, ALightWithoutShadowsLightsWhatFacesIt) {
    SceneView view = plane_view();
    view.place(view.add("cover", make_plane(400)), placement({0, 0, 3}), kInstanceShadow);
    view.scene->lights = {light_above()};
    view.scene->lights[0].casts_shadow = false;
    expect_all(view, 1);
}

TEST_P(Contract, TheSizeOfALightIsFollowedOrIgnoredAsDeclared) {
    if (GetParam().is_wide) GTEST_SKIP() << "sets the size itself";
    const auto visibility_with_size = [&](double size) {
        SceneView view = random_scene(3, 96, 54);
        Light light = light_above();
        light.radius = light.sun_angle = size, light.area_size = glm::dvec2(size);
        view.scene->lights = {light};
        return visibility_of(view);
    };
    const bool is_same = visibility_with_size(1e-6) == visibility_with_size(0.8);
    EXPECT_EQ(is_same, technique().light_size == LightSize::Ignored);
}

TEST_P(Contract, OrderOfLightsDoesNotMatter) {
    SceneView view = random_scene(8, 80, 45);
    const std::vector<Light> lights = {light_above(), widen(make_light(kind(), {-2, 1, 4}, {0, 0, 0}, 90)),
                                       make_light(LightKind::Point, {1, -2, 3}, {0, 0, 0})};
    view.scene->lights = lights;
    const auto forward = render(shared_session(), request_for(view, 2));
    SceneView turned = view;
    turned.scene = std::make_shared<Scene>(*view.scene);
    turned.scene->lights = {lights[2], lights[1], lights[0]};
    RenderRequest request = make_request(turned);
    request.jobs = {{2, technique().id, small_maps(technique())}, {1, technique().id, small_maps(technique())}};
    const auto backward = render(shared_session(), request);
    for (std::size_t k = 0; k < 2; ++k)
        EXPECT_EQ(forward[k].channels.at("visibility").data, backward[k].channels.at("visibility").data) << k;
}

TEST_P(Contract, OddSizesWork) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 17}, {33, 7}, {127, 61}}) {
        SceneView view = random_scene(4, width, height);
        view.scene->lights = {light_above()};
        const auto layers = render(shared_session(), request_for(view));
        check_layer(layers.at(0), width, height);
    }
}

TEST_P(Contract, TheSmallestAndOddMapsWork) {
    for (const std::int64_t size : {1, 2, 3, 37}) {
        SceneView view = random_scene(6, 64, 36);
        view.scene->lights = {light_above()};
        RenderRequest request = make_request(view);
        request.jobs = {{0, technique().id, small_maps(technique(), size)}};
        check_layer(render(shared_session(), request).at(0), 64, 36);
    }
}

TEST_P(Contract, ARegionEqualsThatPartOfThePicture) {
    SceneView view = random_scene(2, 160, 90);
    view.scene->lights = {light_above()};
    RenderRequest request = make_request(view);
    request.jobs = {{0, technique().id, small_maps(technique(), 512)}};
    const auto whole = render(shared_session(), request).at(0).channels.at("visibility");
    request.region = {37, 21, 90, 50};
    const auto part = render(shared_session(), request).at(0).channels.at("visibility");
    ASSERT_EQ(part.width, 90);
    ASSERT_EQ(part.height, 50);
    double difference = 0;
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x)
            difference += std::abs(part.data[std::size_t(y * part.width + x)] -
                                   whole.data[std::size_t((y + 21) * whole.width + x + 37)]);
    EXPECT_LE(difference / (part.width * part.height), read_tolerances(technique().id)["region"]);
}

TEST_P(Contract, OverscanMakesARegionExactWhereMapsHaveNoSay) {
    // Nothing casts, so that visibility comes from which way faces are turned: no view's fit can differ.
    SceneView view = random_scene(2, 160, 90);
    for (Instance& instance : view.scene->instances) instance.flags = kInstanceCamera;
    view.scene->lights = {light_above()};
    RenderRequest request = request_for(view);
    const auto whole = render(shared_session(), request).at(0).channels;
    request.region = {37, 21, 90, 50};
    const auto part = render(shared_session(), request).at(0).channels;
    for (const OutputSpec& output : technique().outputs) {
        const auto& from = whole.at(output.id).data;
        const auto& to = part.at(output.id).data;
        int different = 0;
        for (int y = 0; y < 50; ++y)
            for (int i = 0; i < 90 * output.channels; ++i)
                different += std::abs(to[std::size_t(y * 90 * output.channels + i)] -
                                      from[std::size_t(((y + 21) * 160 + 37) * output.channels + i)]) > 1e-5f;
        EXPECT_EQ(different, 0) << output.id;
    }
}

TEST_P(Contract, TheBoxIsNearTheTruth) {
    if (GetParam().is_wide) GTEST_SKIP() << "the truth is that of a point";
    SceneView view = box_scene(640, 360);
    view.scene->lights = {make_light(kind(), {1.2, 2.6, 4.6}, {0, 0, 0.4}, 60)};
    view.scene->lights[0].area_size = glm::dvec2(1e-6);  // the truth is that of a point
    RenderRequest request = make_request(view);
    request.jobs = {{0, technique().id, small_maps(technique(), 512)}};
    const auto visibility = render(shared_session(), request).at(0).channels.at("visibility").data;
    const RayOracle oracle(view.scene);
    const Frame frame = oracle.make_frame(view.camera, view.width, view.height);
    const auto positions = make_light_samples(frame, view.scene->lights[0], {512, 2, 1});
    const auto truth = oracle.compute_visibility(frame, view.scene->lights[0], positions.at(0));
    const FacingRule facing(frame, view.scene->lights[0], positions[0]);
    double facing_count = 0, wrong_count = 0;
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
        if (facing.classify(pixel) != Facing::Undecided) continue;
        ++facing_count;
        wrong_count += (visibility[pixel] >= 0.5f) != (truth[pixel] >= 0.5f);
    }
    EXPECT_GT(facing_count, 50000);
    EXPECT_LE(wrong_count / facing_count, read_tolerances(technique().id)["box"]);
}

TEST_P(Contract, SamplesStayInRangeAndSmoothBorders) {
    SceneView view = random_scene(9, 64, 36);
    view.scene->lights = {light_above()};
    RenderRequest request = request_for(view);
    request.samples = 4;
    check_layer(render(shared_session(), request).at(0), 64, 36);
}

TEST_P(Contract, EveryParameterWorksOverItsRange) {
    SceneView view = random_scene(7, 40, 24);
    view.scene->lights = {light_above()};
    for (const ParameterSpec& spec : technique().parameters) {
        std::vector<ParameterValue> values;
        if (spec.type == ParameterType::Bool)
            values = {false, true};
        else if (spec.type == ParameterType::Enum)
            for (const EnumItem& item : spec.items) values.emplace_back(item.id);
        else if (spec.type == ParameterType::Float)
            values = {spec.min, 0.5 * (spec.min + spec.max), spec.max};
        else if (spec.id == "light_samples" && spec.shared)
            values = {std::int64_t{2}, std::int64_t{5}};  // 256 hard shadows take long: `multi` alone has them
        else if (spec.id != "map_size")
            values = {std::int64_t(spec.min), std::int64_t(spec.max)};
        for (const ParameterValue& value : values) {
            RenderRequest request = make_request(view);
            ParameterValues given = small_maps(technique(), 64);
            given.set(spec.id, value);
            request.jobs = {{0, technique().id, given}};
            SCOPED_TRACE(spec.id);
            check_layer(render(shared_session(), request).at(0), 40, 24);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllTechniques, Contract, ::testing::ValuesIn(all_cases()), [](const auto& item) {
    return item.param.technique + "_" + kind_name(item.param.kind) + (item.param.is_wide ? "_wide" : "");
});

// Soft shadows as an option of every technique for hard ones, and `multi` as that option with a name.
TEST_P(Contract, LightSamplesAreMultiWithThisTechnique) {
    const bool offers = std::any_of(technique().parameters.begin(), technique().parameters.end(),
                                    [](const ParameterSpec& spec) { return spec.id == "light_pattern"; });
    EXPECT_EQ(offers, find_truth(technique(), resolve_parameters(technique(), {})).kind == TruthKind::Hard);
    if (!offers || technique().test_only) GTEST_SKIP() << "no option, or not offered to multi";
    SceneView view = random_scene(6, 64, 36);
    view.scene->lights = {light_above()};
    Light& light = view.scene->lights[0];
    light.radius = 0.3, light.sun_angle = 0.1, light.area_size = {0.7, 0.5};
    RenderRequest request = request_for(view);
    request.jobs[0].parameters.set("light_samples", std::int64_t{5});
    request.jobs[0].parameters.set("light_pattern", std::string("grid"));
    ParameterValues named = small_maps(find_technique_descriptor("multi"));
    named.set("positions", std::int64_t{5});
    named.set("pattern", std::string("grid"));
    named.set("technique", technique().id);
    request.jobs.push_back({0, "multi", named});
    request.jobs.push_back({0, technique().id, small_maps(technique())});
    const auto layers = render(shared_session(), request);
    const auto& soft = layers.at(0).channels.at("visibility").data;
    EXPECT_EQ(soft, layers.at(1).channels.at("visibility").data);
    EXPECT_NE(soft, layers.at(2).channels.at("visibility").data);
    EXPECT_EQ(find_truth(technique(), layers[0].parameters).kind, TruthKind::Soft);
    EXPECT_EQ(find_truth(technique(), layers[2].parameters).kind, TruthKind::Hard);
}

/// A technique with maps of 64 texels, beside every other one: before and after it.
class Company : public ::testing::TestWithParam<std::string> {};

TEST_P(Company, ALayerIsTheSameAloneAndBesideAnyOther) {
    const TechniqueDescriptor& technique = find_technique_descriptor(GetParam());
    SceneView view = random_scene(8, 48, 27);
    view.scene->lights = {make_light(LightKind::Spot, {0.7, 0.4, 5}, {0.1, 0.2, 0}, 70),
                          make_light(LightKind::Area, {1.2, -0.6, 4}, {0.1, 0.2, 0})};
    RenderRequest request = make_request(view);
    const LayerJob here{0, technique.id, small_maps(technique, 64)}, there{1, technique.id, small_maps(technique, 64)};
    request.jobs = {here, there};
    const auto alone = render(shared_session(), request);
    for (const TechniqueDescriptor& other : technique_descriptors()) {
        const ParameterValues maps = small_maps(other, 64);
        request.jobs = {{0, other.id, maps}, here, {1, other.id, maps}, there, {1, other.id, maps}};
        const auto layers = render(shared_session(), request);
        for (const OutputSpec& output : technique.outputs)
            for (const std::size_t light : {0u, 1u})
                EXPECT_EQ(layers.at(2 * light + 1).channels.at(output.id).data,
                          alone.at(light).channels.at(output.id).data)
                    << output.id << " beside " << other.id << ", light " << light;
        for (const std::size_t light : {0u, 1u}) {
            ASSERT_EQ(layers[2 * light + 1].views.size(), alone[light].views.size()) << other.id;
            for (std::size_t i = 0; i < alone[light].views.size(); ++i)
                EXPECT_EQ(layers[2 * light + 1].views[i].corner, alone[light].views[i].corner) << other.id;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllTechniques, Company, ::testing::ValuesIn([] {
                             std::vector<std::string> ids;
                             for (const TechniqueDescriptor& t : technique_descriptors()) ids.push_back(t.id);
                             return ids;
                         }()),
                         [](const auto& item) { return item.param; });

// What belongs to no layer, too.
TEST(FrameOfManyJobs, ThePicturesOfTheFrameAreThoseOfTheSmallestOverscan) {
    SceneView view = random_scene(8, 48, 27);
    view.scene->lights = {make_light(LightKind::Spot, {0.7, 0.4, 5}, {0.1, 0.2, 0}, 70)};
    RenderRequest request = make_request(view);
    request.combined = true;
    request.aux = {"position", "normal", "ids", "depth"};
    request.jobs = {{0, "sm", {}}};
    const auto ignore = [](Layer&&) {};
    const FrameResult alone = shared_session().render(request, ignore);
    request.jobs.push_back({0, "edtsm", {}});
    const FrameResult both = shared_session().render(request, ignore);
    EXPECT_EQ(both.coverage.data, alone.coverage.data);
    EXPECT_EQ(both.combined.data, alone.combined.data);
    EXPECT_EQ(both.ids.data, alone.ids.data);
    for (const char* name : {"position", "normal", "depth"})
        EXPECT_EQ(both.aux.at(name).data, alone.aux.at(name).data) << name;
}

TEST(Descriptors, AreComplete) {
    for (const TechniqueDescriptor& technique : technique_descriptors()) {
        SCOPED_TRACE(technique.id);
        EXPECT_FALSE(technique.label.empty());
        EXPECT_FALSE(technique.summary.empty());
        EXPECT_FALSE(technique.limits.empty());
        EXPECT_FALSE(technique.lights.empty());
        EXPECT_TRUE(technique.needs);
        ASSERT_FALSE(technique.outputs.empty());
        EXPECT_EQ(technique.outputs[0].id, "visibility");
        EXPECT_EQ(technique.outputs[0].channels, 1);
        for (const ParameterSpec& spec : technique.parameters) {
            SCOPED_TRACE(spec.id);
            EXPECT_FALSE(spec.label.empty());
            EXPECT_FALSE(spec.help.empty());
            EXPECT_TRUE(spec.type != ParameterType::Enum || spec.items.size() >= 2);
        }
        const ParameterValues defaults = resolve_parameters(technique, {});
        EXPECT_EQ(defaults.all().size(), technique.parameters.size());
        EXPECT_NO_THROW(read_tolerances(technique.id));
        EXPECT_FALSE(technique.alpha_cutouts) << "scenes hold no alpha";
        const bool is_soft = find_truth(technique, defaults).kind == TruthKind::Soft;
        EXPECT_TRUE(!is_soft || technique.light_size == LightSize::Followed) << "compared with the light's real size";
    }
}

TEST(Descriptors, RestrictionsFollowFromTheCapabilities) {
    TechniqueDescriptor technique;
    technique.light_size = LightSize::Followed, technique.alpha_cutouts = true;
    EXPECT_TRUE(list_restrictions(technique).empty());
    const auto expect_one_with = [&](const char* word) {
        const std::vector<std::string> restrictions = list_restrictions(technique);
        ASSERT_EQ(restrictions.size(), 1u);
        EXPECT_NE(restrictions[0].find(word), std::string::npos) << restrictions[0];
    };
    technique.meshes = CasterMeshes::Closed;
    expect_one_with("closed");
    technique.meshes = CasterMeshes::MeshEdges;
    expect_one_with("cut each other");
    technique.meshes = CasterMeshes::Any, technique.alpha_cutouts = false;
    expect_one_with("alpha");
    technique.alpha_cutouts = true, technique.light_size = LightSize::Ignored;
    expect_one_with("size");
    technique.light_size = LightSize::Followed, technique.lights = {LightKind::Sun, LightKind::Area};
    expect_one_with("SUN, AREA");
}

TEST(Descriptors, ReferencesStandInTheBibliography) {
    std::ifstream file(std::string(SHADOW_LAYERS_SHADER_DIR) + "/../docs/references.bib");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    for (const TechniqueDescriptor& technique : technique_descriptors()) {
        const std::string key = technique.reference.substr(0, technique.reference.find_first_of(" ,"));
        EXPECT_NE(text.find("{" + key + ","), std::string::npos) << technique.id << ": " << key;
    }
}

}  // namespace
}  // namespace shadow_layers::testing
