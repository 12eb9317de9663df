// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Every bad input ends in a clear error of the right kind or in a right picture, never in a crash; and the session
// works on afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "gl/shared_session.h"
#include "shadow_layers/error.h"
#include "shadow_layers/session.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN(), kInfF = std::numeric_limits<float>::infinity();
constexpr int kWidth = 64, kHeight = 40;

RenderRequest request_of(const SceneView& view) {
    RenderRequest request;
    request.scene = view.scene;
    request.camera = view.camera;
    request.width = view.width, request.height = view.height;
    request.combined = true;
    return request;
}

struct Picture {
    FrameResult frame;
    std::vector<Layer> layers;
    std::vector<float> visibility(std::size_t i = 0) const { return layers.at(i).channels.at("visibility").data; }
};

/// Renders all lights by all techniques that serve them, on small maps; checks that every number is sound.
Picture render_all(const RenderRequest& plain) {
    RenderRequest request = plain;
    for (std::uint32_t light = 0; light < request.scene->lights.size(); ++light)
        for (const TechniqueDescriptor& technique : technique_descriptors()) {
            const LightKind kind = request.scene->lights[light].kind;
            if (std::find(technique.lights.begin(), technique.lights.end(), kind) == technique.lights.end()) continue;
            ParameterValues values;
            for (const ParameterSpec& spec : technique.parameters)
                if (spec.id == "map_size") values.set("map_size", std::int64_t{64});
            request.jobs.push_back({light, technique.id, values});
        }
    Picture picture;
    picture.frame =
        shared_session().render(request, [&](Layer&& layer) { picture.layers.push_back(std::move(layer)); });
    EXPECT_EQ(picture.layers.size(), request.jobs.size());
    for (const Layer& layer : picture.layers)
        for (const auto& [id, image] : layer.channels)
            for (const float value : image.data)
                if (!std::isfinite(value) || (id == "visibility" && !(value >= 0 && value <= 1))) {
                    ADD_FAILURE() << request.jobs[layer.job].technique << ", " << id << ": " << value;
                    return picture;
                }
    for (const float value : picture.frame.combined.data)
        if (!std::isfinite(value)) {
            ADD_FAILURE() << "combined: " << value;
            break;
        }
    return picture;
}

SceneView plain_view(LightKind kind = LightKind::Spot) {
    SceneView view = box_scene(kWidth, kHeight);
    view.scene->lights = {make_light(kind, {2, -1, 4}, {0, 0, 0.5}, 100)};
    return view;
}

constexpr LightKind kAllKinds[] = {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};

/// The two pictures show the same within a few pixels.
void expect_same(const Picture& a, const Picture& b) {
    ASSERT_EQ(a.layers.size(), b.layers.size());
    for (std::size_t i = 0; i < a.layers.size(); ++i) {
        const auto p = a.visibility(i), q = b.visibility(i);
        int differing = 0;
        for (std::size_t k = 0; k < p.size(); ++k) differing += std::abs(p[k] - q[k]) > 0.5f;
        EXPECT_LE(differing, 2) << "layer " << i;
    }
}

/// The text of the error of type E that rendering ends in; the session must work afterwards.
template <class E>
std::string error_of(const RenderRequest& request) {
    std::string text;
    try {
        shared_session().render(request, [](Layer&&) {});
        ADD_FAILURE() << "no error";
    } catch (const E& error) {
        text = error.what();
    } catch (const std::exception& error) {
        ADD_FAILURE() << "another kind of error: " << error.what();
    }
    EXPECT_NO_THROW(shared_session().render(request_of(plain_view()), [](Layer&&) {}));
    return text;
}

void expect_names(const std::string& text, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << "\"" << word << "\" in: " << text;
}

// --- geometry that is dropped or harmless
// -----------------------------------------------------------------------------

TEST(BadGeometry, TrianglesThatUseUnusableVerticesAreLeftOut) {
    for (const LightKind kind : kAllKinds) {
        const SceneView clean = plain_view(kind);
        SceneView spoilt = clean;
        spoilt.scene = std::make_shared<Scene>(*clean.scene);
        MeshData data = make_box({1, 0.8f, 1.2f});
        const auto first = std::uint32_t(data.positions.size());
        for (const glm::vec3 p :
             {glm::vec3(kNanF, 0, 0), glm::vec3(0, kInfF, 0), glm::vec3(0, 0, -kInfF), glm::vec3(kNanF)}) {
            data.positions.push_back(p);
            data.triangles.push_back({0, 1, std::uint32_t(data.positions.size() - 1)});
        }
        data.triangles.push_back({first, first + 1, first + 2});
        spoilt.scene->meshes[1] = to_mesh("spoilt", data);
        const Picture picture = render_all(request_of(spoilt));
        expect_same(picture, render_all(request_of(clean)));
        bool named = false;
        for (const std::string& warning : picture.frame.warnings)
            named = named || warning.find("spoilt") != std::string::npos;
        EXPECT_TRUE(named) << "no warning names the mesh";
    }
}

TEST(BadGeometry, AMeshOfUnusableVerticesAloneIsEmpty) {
    for (const LightKind kind : kAllKinds) {
        SceneView view = plain_view(kind);
        view.place(view.add("all nan", {std::vector<glm::vec3>(3, glm::vec3(kNanF)), {{0, 1, 2}}}));
        expect_same(render_all(request_of(view)), render_all(request_of(plain_view(kind))));
    }
}

TEST(BadGeometry, HugeVerticesDoNotHurtTheRest) {
    for (const float size : {1e20f, 3e38f}) {
        SceneView view = plain_view();
        view.place(view.add("huge", {{{size, 0, 5}, {size, size, 5}, {-size, size, 5}}, {{0, 1, 2}}}), glm::dmat4(1),
                   kInstanceShadow);
        expect_same(render_all(request_of(view)), render_all(request_of(plain_view())));
    }
}

TEST(BadGeometry, FacesWithoutAreaShowNothing) {
    for (const LightKind kind : kAllKinds) {
        SceneView view = plain_view(kind);
        // A point, a line, a line of three different corners, the same corner thrice.
        view.place(view.add("no area", {{{0.4f, 0.3f, 2}, {0.9f, 0.3f, 2}, {1.4f, 0.3f, 2}},
                                        {{0, 0, 0}, {0, 1, 1}, {0, 1, 2}, {2, 1, 0}, {1, 1, 1}}}));
        expect_same(render_all(request_of(view)), render_all(request_of(plain_view(kind))));
    }
}

TEST(BadGeometry, EmptyMeshesAndScenes) {
    SceneView view = plain_view();
    view.place(view.add("empty", {}));
    view.place(view.add("loose", {{{1, 2, 3}}, {}}));
    expect_same(render_all(request_of(view)), render_all(request_of(plain_view())));

    SceneView empty;
    empty.width = kWidth, empty.height = kHeight;
    empty.camera = view.camera;
    const Picture nothing = render_all(request_of(empty));
    EXPECT_TRUE(nothing.layers.empty());
    for (const float value : nothing.frame.coverage.data) ASSERT_EQ(value, 0);
    for (const LightKind kind : kAllKinds) {
        empty.scene->lights = {make_light(kind, {1, 1, 5}, {0, 0, 0})};
        const Picture lit = render_all(request_of(empty));
        for (std::size_t i = 0; i < lit.layers.size(); ++i)
            for (const float value : lit.visibility(i)) ASSERT_EQ(value, 1);
    }
}

TEST(BadGeometry, SingularMatricesFlattenOrHide) {
    for (const LightKind kind : kAllKinds) {
        SceneView hidden = plain_view(kind);
        glm::dmat4 matrix = hidden.scene->instances[1].world_from_object;
        for (int axis = 0; axis < 3; ++axis) matrix[axis] = glm::dvec4(0);
        hidden.place(1, matrix);  // shrunk to a point
        matrix[0] = {2, 0, 0, 0};
        hidden.place(1, matrix);  // and to a line
        expect_same(render_all(request_of(hidden)), render_all(request_of(plain_view(kind))));

        // Flattened to a square above the floor it still casts: compare with a real square.
        SceneView flat = plain_view(kind), square = plain_view(kind);
        glm::dmat4 flatten = placement({1.2, 0.8, 1.5});
        flatten[2] = glm::dvec4(0);
        flat.place(flat.add("flat", make_box({1, 1, 1})), flatten, kInstanceShadow);
        square.place(square.add("square", make_plane(1)), placement({1.2, 0.8, 1.5}), kInstanceShadow);
        expect_same(render_all(request_of(flat)), render_all(request_of(square)));
    }
}

// --- lights and cameras in odd places
// ---------------------------------------------------------------------------------

TEST(BadPlaces, LightInsideGeometryShadesEverythingOutside) {
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Area}) {
        SceneView view = box_scene(kWidth, kHeight);
        const glm::dvec3 inside(view.scene->instances[1].world_from_object[3]);
        view.scene->lights = {make_light(kind, inside, inside - glm::dvec3(0, 0, 1), 170)};
        const Picture picture = render_all(request_of(view));
        RenderRequest ids = request_of(view);
        ids.aux = {"ids", "normal", "position"};
        const FrameResult frame = shared_session().render(ids, [](Layer&&) {});
        for (std::size_t i = 0; i < picture.layers.size(); ++i) {
            const auto visibility = picture.visibility(i);
            int lit = 0, floor = 0;
            for (std::size_t pixel = 0; pixel < visibility.size(); ++pixel) {
                if (frame.ids.data[2 * pixel] != 0) continue;
                // Well inside the cone, which is a little narrower than half of space.
                const glm::vec3 rel(frame.aux.at("position").data[3 * pixel],
                                    frame.aux.at("position").data[3 * pixel + 1],
                                    frame.aux.at("position").data[3 * pixel + 2]);
                const glm::dvec3 way = frame.camera_position + glm::dvec3(rel) - inside;
                if (glm::length(glm::dvec2(way)) > 4 * -way.z) continue;
                ++floor;
                lit += visibility[pixel] > 0.5f;
            }
            EXPECT_GT(floor, 300);
            EXPECT_EQ(lit, 0) << picture.layers[i].job;
        }
    }
}

TEST(BadPlaces, LightsAtTouchingAndFarPlaces) {
    const SceneView plain = plain_view();
    const glm::dvec3 eye(plain.camera.world_from_camera[3]);
    for (const LightKind kind : kAllKinds)
        for (const glm::dvec3 place : {eye, glm::dvec3(0, 0, 0), glm::dvec3(1, 1, 1e-7), glm::dvec3(0.6, -0.05, 1.1),
                                       glm::dvec3(1e12, 0, 1e12), glm::dvec3(0, 0, -5), glm::dvec3(0, 0, 1e-30)}) {
            SceneView view = box_scene(kWidth, kHeight);
            view.scene->lights = {make_light(kind, place, place + glm::dvec3(0.1, 0.2, -1), 120)};
            render_all(request_of(view));
        }
}

/// Around the camera, around receivers, touching surfaces, edge-on to the floor: every size that a light may have.
TEST(BadPlaces, LightsOfOddSizes) {
    const glm::dvec3 eye(plain_view().camera.world_from_camera[3]);
    const glm::dvec2 kSizes[] = {{0, 0}, {1e-9, 1e-9}, {1.5, 0}, {1.5, 1e-9}, {3, 2}, {60, 40}, {1e12, 1e12}};
    for (const LightKind kind : kAllKinds)
        for (const glm::dvec2& size : kSizes)
            for (const auto& [place, ahead] : {std::pair{glm::dvec3(2, -1, 4), glm::dvec3(-0.5, 0.3, -1)},
                                               {eye, glm::dvec3(0.1, 0.2, -1)},
                                               {glm::dvec3(1.2, 0.4, 0.1), glm::dvec3(0.1, 0.2, -1)},
                                               {glm::dvec3(1.8, -1.4, 0.5 * size.x), glm::dvec3(1, 0, 0)}}) {
                SCOPED_TRACE("kind " + std::to_string(int(kind)) + ", size " + std::to_string(size.x));
                SceneView view = box_scene(kWidth, kHeight);
                Light light = make_light(kind, place, place + ahead, 120);
                light.radius = 0.5 * size.x, light.area_size = size;
                light.sun_angle = std::min(size.x, std::numbers::pi);
                view.scene->lights = {light};
                render_all(request_of(view));
                if (::testing::Test::HasFailure()) return;
            }
}

TEST(BadPlaces, CameraInsideGeometryAndAtTheClipPlanes) {
    for (const LightKind kind : kAllKinds) {
        SceneView view = plain_view(kind);
        const glm::dvec3 inside(view.scene->instances[1].world_from_object[3]);
        view.camera.world_from_camera = look_at(inside, {3, 3, 0});
        // The light outside reaches nothing of what is seen in there.
        const Picture picture = render_all(request_of(view));
        for (std::size_t i = 0; i < picture.layers.size(); ++i) {
            const auto visibility = picture.visibility(i);
            int lit = 0;
            for (std::size_t pixel = 0; pixel < visibility.size(); ++pixel)
                lit += visibility[pixel] * picture.frame.coverage.data[pixel] > 0.5f;
            // Of maps of 64 texels a texel is wide where two walls meet, and a filter is several texels wide.
            const TechniqueDescriptor& technique = technique_descriptors().at(picture.layers[i].job);
            const bool is_hard = find_truth(technique, resolve_parameters(technique, {})).kind == TruthKind::Hard;
            EXPECT_LE(lit, (is_hard ? 0.005 : 0.02) * double(visibility.size())) << technique.id;
        }
        view.camera.world_from_camera = look_at({0, -3, 0}, {0, 0, 0});  // in the plane of the floor
        render_all(request_of(view));
        view = plain_view(kind);
        view.camera.clip_start = 5, view.camera.clip_end = 5.001;  // cuts through everything
        render_all(request_of(view));
        view.camera.clip_start = 1e-12, view.camera.clip_end = 1e12;
        expect_same(render_all(request_of(view)), render_all(request_of(plain_view(kind))));
    }
}

TEST(BadPlaces, FiveHundredLights) {
    SceneView view = box_scene(32, 20);
    RenderRequest request = request_of(view);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> value(-4, 4);
    view.scene->lights.clear();
    for (std::uint32_t i = 0; i < 500; ++i) {
        view.scene->lights.push_back(
            make_light(kAllKinds[i % 4], {value(random), value(random), 5 + value(random)}, {0, 0, 0}, 90));
        ParameterValues values;
        values.set("map_size", std::int64_t{32});
        request.jobs.push_back({i, technique_descriptors()[i % 3].id, values});
    }
    std::size_t count = 0;
    const FrameResult frame = shared_session().render(request, [&](Layer&& layer) { EXPECT_EQ(layer.job, count++); });
    EXPECT_EQ(count, 500u);
    for (const float value_of : frame.combined.data) ASSERT_TRUE(std::isfinite(value_of));
}

// --- errors
// -----------------------------------------------------------------------------------------------------------

TEST(BadRequests, ScenesAndCamerasThatCannotBeRendered) {
    struct Case {
        std::function<void(SceneView&)> spoil;
        std::initializer_list<const char*> words;
    };
    const auto spot = [](double angle) { return [angle](SceneView& v) { v.scene->lights[0].spot_angle = angle; }; };
    const Case cases[] = {
        {[](SceneView& v) { v.scene->instances[1].world_from_object[3][0] = kNan; }, {"instance 1", "box", "nan"}},
        {[](SceneView& v) { v.scene->instances[1].world_from_object[1][1] = kInf; }, {"instance 1", "box", "inf"}},
        {[](SceneView& v) { v.scene->instances[1].world_from_object *= 1e40; }, {"instance 1", "box"}},
        {[](SceneView& v) { v.scene->instances[1].world_from_object[3][2] = 1e300; }, {"instance 1", "1e+300"}},
        {[](SceneView& v) { v.scene->instances[0].mesh = 77; }, {"instance 0", "77"}},
        {[](SceneView& v) { v.scene->instances[0].receiver_group = 64; }, {"instance 0", "receiver_group"}},
        {[](SceneView& v) { v.scene->meshes[0] = nullptr; }, {"mesh 0"}},
        {[](SceneView& v) { v.scene->lights[0].world_from_light[3][1] = kNan; }, {"light 0", "nan"}},
        {[](SceneView& v) { v.scene->lights[0].world_from_light[2] *= 4; }, {"light 0", "z axis", "length 4"}},
        {[](SceneView& v) { v.scene->lights[0].energy = kInf; }, {"light 0", "energy"}},
        {spot(0), {"light 0", "spot_angle is 0"}},
        {spot(kNan), {"light 0", "spot_angle is nan"}},
        {spot(-0.5), {"light 0", "spot_angle is -0.5"}},
        {spot(6.3), {"light 0", "spot_angle is 6.3"}},
        {[](SceneView& v) { v.camera.clip_end = v.camera.clip_start; }, {"camera", "clip_end"}},
        {[](SceneView& v) { v.camera.window.left = v.camera.window.right; }, {"camera", "window"}},
        {[](SceneView& v) { v.camera.world_from_camera[3][1] = kInf; }, {"camera", "inf"}},
    };
    for (const Case& c : cases) {
        SceneView view = plain_view();
        c.spoil(view);
        RenderRequest request = request_of(view);
        request.jobs.push_back({0, technique_descriptors()[0].id, {}});
        expect_names(error_of<InputError>(request), c.words);
    }
}

TEST(BadRequests, SpotAnglesAtTheirEnds) {
    for (const double angle : {1e-12, 1e-6, std::numbers::pi}) {
        SceneView view = plain_view();
        view.scene->lights[0].spot_angle = angle;
        render_all(request_of(view));
    }
}

TEST(BadRequests, SizesRegionsAndCounts) {
    struct Case {
        std::function<void(RenderRequest&)> spoil;
        std::initializer_list<const char*> words;
    };
    const Case cases[] = {
        {[](RenderRequest& r) { r.width = 0; }, {"0x40"}},
        {[](RenderRequest& r) { r.height = -3; }, {"64x-3"}},
        {[](RenderRequest& r) { r.width = r.height = 1 << 30; }, {"1073741824", "limit"}},
        {[](RenderRequest& r) { r.width = r.height = std::numeric_limits<int>::max(); }, {"2147483647", "limit"}},
        {[](RenderRequest& r) {
             r.region = {60, 0, 10, 10};
         },
         {"region", "60"}},
        {[](RenderRequest& r) {
             r.region = {-1, 0, 10, 10};
         },
         {"region", "-1"}},
        {[](RenderRequest& r) {
             r.region = {0, 0, std::numeric_limits<int>::max(), 10};
         },
         {"region"}},
        {[](RenderRequest& r) { r.samples = 0; }, {"samples is 0"}},
        {[](RenderRequest& r) { r.samples = 65; }, {"samples is 65"}},
        {[](RenderRequest& r) { r.filter.width_px = kNan; }, {"filter"}},
        {[](RenderRequest& r) { r.filter.width_px = 0; }, {"filter"}},
        {[](RenderRequest& r) { r.aux = {"velocity"}; }, {"velocity", "position"}},
        {[](RenderRequest& r) { r.scene = nullptr; }, {"scene"}},
        {[](RenderRequest& r) {
             r.jobs.push_back({5, "sm", {}});
         },
         {"light 5", "1 lights"}},
        {[](RenderRequest& r) {
             r.jobs.push_back({0, "raytracing", {}});
         },
         {"raytracing", "sm", "edsm"}},
        {[](RenderRequest& r) {
             r.jobs.push_back({0, "", {}});
         },
         {"sm"}},
    };
    for (const Case& c : cases) {
        RenderRequest request = request_of(plain_view());
        c.spoil(request);
        expect_names(error_of<InputError>(request), c.words);
    }
}

TEST(BadRequests, ParametersOfEveryTechnique) {
    for (const TechniqueDescriptor& technique : technique_descriptors()) {
        const auto error_with = [&](const std::string& id, ParameterValue value) {
            RenderRequest request = request_of(plain_view());
            ParameterValues values;
            values.set(id, std::move(value));
            request.jobs.push_back({0, technique.id, values});
            return error_of<InputError>(request);
        };
        expect_names(error_with("no_such_thing", 1.0), {technique.id.c_str(), "no_such_thing"});
        for (const ParameterSpec& spec : technique.parameters) {
            const char* id = spec.id.c_str();
            expect_names(error_with(spec.id, std::string("no such item")), {technique.id.c_str(), id});
            if (spec.type == ParameterType::Int) {
                expect_names(error_with(spec.id, std::int64_t(spec.max) + 1), {technique.id.c_str(), id});
                expect_names(error_with(spec.id, std::numeric_limits<std::int64_t>::min()), {technique.id.c_str(), id});
                if (spec.step > 1)
                    expect_names(error_with(spec.id, std::int64_t(spec.min) + 1), {technique.id.c_str(), id});
            }
            if (spec.type == ParameterType::Float) {
                expect_names(error_with(spec.id, kNan), {technique.id.c_str(), id});
                expect_names(error_with(spec.id, kInf), {technique.id.c_str(), id});
            }
        }
    }
}

TEST(BadRequests, MapsBeyondTheDriversLimit) {
    const int limit = shared_session().info().max_texture_size;
    int tried = 0;
    for (const TechniqueDescriptor& technique : technique_descriptors())
        for (const ParameterSpec& spec : technique.parameters) {
            if (spec.id != "map_size") continue;
            ParameterValues values;
            values.set("map_size", std::int64_t(spec.max));
            const TechniqueNeeds needs = technique.needs(resolve_parameters(technique, values));
            if (needs.map_size + 2 * needs.map_border_texels <= limit) continue;
            RenderRequest request = request_of(plain_view());
            request.jobs.push_back({0, technique.id, values});
            expect_names(error_of<InputError>(request),
                         {technique.id.c_str(), "map_size", "limit", std::to_string(limit).c_str()});
            ++tried;
        }
    EXPECT_GT(tried, 0) << "no technique offers a map beyond " << limit << " texels: give this test another";
}

TEST(BadSessions, MissingShaderFolder) {
    for (const char* folder : {"", "/nowhere/shaders", "/dev/null"}) {
        SessionOptions options = make_session_options();
        options.shader_dir = folder;
        try {
            Session session(options);
            FAIL() << "no error for \"" << folder << "\"";
        } catch (const ShaderError& error) {
            expect_names(error.what(), {"shader", folder});
        }
    }
    SessionOptions options = make_session_options();
    options.shader_dir = "/tmp";  // exists, but holds no shaders
    try {
        Session session(options);
        session.render(request_of(plain_view()), [](Layer&&) {});
        FAIL() << "no error";
    } catch (const ShaderError& error) {
        expect_names(error.what(), {"/tmp"});
    }
}

TEST(BadSessions, UnknownBackend) {
    SessionOptions options = make_session_options();
    options.backend = "vulkan";
    try {
        Session session(options);
        FAIL() << "no error";
    } catch (const Error& error) {
        expect_names(error.what(), {"vulkan", "osmesa"});
    }
}

// --- fuzz
// -------------------------------------------------------------------------------------------------------------

/// Coordinates that break things: zeros, repeats, tiny, huge, NaN.
float odd_number(std::mt19937& random) {
    static constexpr float kOdd[] = {0,    -0.0f,  1,     -1,    1e-38f, -1e-30f, 1e-7f,
                                     1e7f, -1e12f, 1e20f, 3e38f, kNanF,  kInfF,   -kInfF};
    std::uniform_real_distribution<float> value(-2, 2);
    return random() % 3 == 0 ? kOdd[random() % std::size(kOdd)] : std::round(value(random) * 4) / 4;
}

glm::dmat4 odd_matrix(std::mt19937& random) {
    static constexpr double kScales[] = {0, 1e-9, 1, 1, -1, 2, 1e6};
    std::uniform_real_distribution<double> value(-2, 2);
    glm::dmat4 matrix = placement({value(random), value(random), value(random)}, 90 * value(random));
    for (int axis = 0; axis < 3; ++axis) matrix[axis] *= kScales[random() % std::size(kScales)];
    if (random() % 5 == 0) matrix[0] += matrix[1];  // sheared
    if (random() % 7 == 0) matrix[3][random() % 3] = 1e9;
    return matrix;
}

SceneView odd_scene(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-3, 3);
    SceneView view;
    view.width = 1 + int(random() % 24), view.height = 1 + int(random() % 24);
    for (unsigned m = 0; m < 1 + random() % 3; ++m) {
        MeshData data;
        const unsigned vertex_count = 1 + random() % 12;
        for (unsigned v = 0; v < vertex_count; ++v)
            data.positions.push_back({odd_number(random), odd_number(random), odd_number(random)});
        for (unsigned t = 0; t < random() % 20; ++t)
            data.triangles.push_back({random() % vertex_count, random() % vertex_count, random() % vertex_count});
        const std::uint32_t mesh = view.add("odd " + std::to_string(m), data);
        for (unsigned i = 0; i < random() % 4; ++i) {
            view.place(mesh, odd_matrix(random), random() % 8);
            view.scene->instances.back().receiver_group = std::uint8_t(random() % 64);
            view.scene->instances.back().blocker_group = std::uint8_t(random() % 64);
        }
    }
    if (random() % 2) view.place(view.add("plane", make_plane(6)));
    view.camera = make_camera({value(random), value(random), value(random)}, {0, 0, 0.1}, view.width, view.height,
                              random() % 4 ? 60 : 175);
    view.camera.perspective = random() % 4 != 0;
    for (unsigned l = 0; l < random() % 4; ++l) {
        Light light = make_light(kAllKinds[random() % 4], {value(random), value(random), value(random)}, {0, 0.1, 0},
                                 std::uniform_real_distribution<double>(0.001, 180)(random));
        if (random() % 4 == 0) light.world_from_light[3] = view.camera.world_from_camera[3];
        if (random() % 4 == 0) light.world_from_light[0] *= -1;
        light.casts_shadow = random() % 5 != 0;
        light.blocker_set = random() % 3 ? kAllGroups : random();
        view.scene->lights.push_back(light);
    }
    return view;
}

TEST(Fuzz, DegenerateScenesEndInPicturesOrInputErrors) {
    int pictures = 0, errors = 0;
    for (unsigned seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const SceneView view = odd_scene(seed);
        try {
            render_all(request_of(view));
            ++pictures;
        } catch (const InputError&) {
            ++errors;
        }
        if (::testing::Test::HasFailure()) return;
    }
    EXPECT_GT(pictures, 100) << errors << " errors";
}

}  // namespace
}  // namespace shadow_layers::testing
