// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What the render loop owes to techniques and expects of them, shown with techniques that only these tests know.
#include <cmath>
#include <limits>

#include "gl_fixture.h"
#include "session/render_run.h"

namespace shadow_layers {
namespace {

/// What the technique under test does; set by each test.
struct Behaviour {
    TechniqueNeeds needs;
    int channels = 1;  ///< of the second output, "extra"
    CasterMeshes meshes = CasterMeshes::Any;
    std::function<void(Engine&, const LightTask&, LayerOutputs&)> render;
};
Behaviour behaviour;

Image make_image(const Frame& frame, int channels, float value) {
    Image image{frame.width, frame.height, channels, {}};
    image.data.assign(frame.pixel_count() * std::size_t(channels), value);
    return image;
}

class ScriptedTechnique final : public Technique {
public:
    void prepare(Engine&, const ParameterValues&) override {}
    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        behaviour.render(engine, task, outputs);
    }
};

TechniqueDescriptor describe_scripted() {
    TechniqueDescriptor d;
    d.id = "scripted";
    d.label = "Scripted";
    d.outputs = {{"visibility", "", 1, ""}, {"extra", "Extra", behaviour.channels, ""}};
    d.lights = {LightKind::Point};
    d.meshes = behaviour.meshes;
    d.needs = [](const ParameterValues&) { return behaviour.needs; };
    return d;
}

class SessionTechniqueTest : public test::EngineTest {
protected:
    void SetUp() override {
        EngineTest::SetUp();
        behaviour = {};
        behaviour.needs.map_size = 0;
    }
    void TearDown() override {
        pool_.reset();
        EngineTest::TearDown();
    }
    FrameResult run(const RenderRequest& request, TechniqueDescriptor (*describe)() = describe_scripted) {
        TechniqueSet techniques({{describe, [] { return std::unique_ptr<Technique>(new ScriptedTechnique); }}});
        layers_.clear();
        RenderOutlet outlet;
        outlet.deliver = [&](Layer&& layer) { layers_.push_back(std::move(layer)); };
        return run_render(engine(), pool_, techniques, request, outlet);
    }
    RenderRequest make_request() {
        RenderRequest request = test::make_request(test::make_ball_scene(), 24, 16);
        request.jobs = {{0, "scripted", {}}};
        return request;
    }
    template <class ErrorType>
    std::string message_of(const RenderRequest& request) {
        try {
            run(request);
        } catch (const ErrorType& error) {
            return error.what();
        }
        return "nothing was thrown";
    }
    std::vector<Layer> layers_;
    std::shared_ptr<FramePool> pool_ = std::make_shared<FramePool>();
};

TEST_F(SessionTechniqueTest, OverscanIsCroppedFromImagesAndTextures) {
    behaviour.needs.overscan_px = 5;
    behaviour.channels = 3;
    behaviour.render = [](Engine& engine, const LightTask& task, LayerOutputs& outputs) {
        EXPECT_EQ(task.frame.width, 24 + 10);
        Image image = make_image(task.frame, 1, 0);
        std::vector<float> texels(task.frame.pixel_count() * 3);
        for (int y = 0; y < task.frame.height; ++y)
            for (int x = 0; x < task.frame.width; ++x) {
                const auto pixel = std::size_t(y * task.frame.width + x);
                image.data[pixel] = float(x - 5) / 64;
                texels[3 * pixel] = float(x - 5), texels[3 * pixel + 1] = float(y - 5);
            }
        outputs.set("visibility", image);
        gl::Texture texture(engine.device(), {GL_RGB32F, task.frame.width, task.frame.height}, "extra");
        texture.upload(texels.data());
        outputs.set("extra", texture);
    };
    run(make_request());
    const Image& visibility = layers_.at(0).channels.at("visibility");
    const Image& extra = layers_[0].channels.at("extra");
    ASSERT_EQ(visibility.width, 24);
    ASSERT_EQ(extra.data.size(), 24u * 16 * 3);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 24; ++x) {
            const auto pixel = std::size_t(y * 24 + x);
            EXPECT_EQ(visibility.data[pixel], float(x) / 64);
            EXPECT_EQ(extra.data[3 * pixel], float(x));
            EXPECT_EQ(extra.data[3 * pixel + 1], float(y));
        }
}

TEST_F(SessionTechniqueTest, SamplesAreAveraged) {
    RenderRequest request = make_request();
    request.samples = 10;
    int sample = 0;
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        outputs.set("visibility", make_image(task.frame, 1, sample < 3 ? 1.0f : 0.0f));
        outputs.set("extra", make_image(task.frame, 1, 1.0f));
        ++sample;
    };
    run(request);
    EXPECT_EQ(sample, 10);
    for (float value : layers_.at(0).channels.at("visibility").data) EXPECT_FLOAT_EQ(value, 0.3f);
    for (float value : layers_[0].channels.at("extra").data) EXPECT_EQ(value, 1.0f);
}

/// The ball scene's floor under a bulb of radius 0.5.
std::shared_ptr<Scene> make_bulb_scene() {
    auto scene = test::make_ball_scene();
    scene->instances.resize(1);
    scene->lights[0].radius = 0.5;
    return scene;
}

ParameterValues sample_count(int count) {
    ParameterValues values;
    values.set("light_samples", std::int64_t{count});
    return values;
}

// One sample after the other, and their mean weighs them by the cosine at the receiver, worked out here from the places
// that the technique was given; channels other than the visibility have the plain mean.
TEST_F(SessionTechniqueTest, LightSamplesAreAveragedByTheLightThatTheyBring) {
    RenderRequest request = make_request();
    request.scene = make_bulb_scene();
    request.jobs[0].parameters = sample_count(4);
    std::vector<glm::dvec3> places;
    std::vector<glm::dvec3> receivers;
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        const auto index = float(places.size());
        places.push_back(task.sample.position_ws - task.frame.origin_ws);
        receivers.assign(task.frame.positions_rel.begin(), task.frame.positions_rel.end());
        outputs.set("visibility", make_image(task.frame, 1, index / 4));
        outputs.set("extra", make_image(task.frame, 1, 3 * index));
    };
    run(request);
    ASSERT_EQ(places.size(), 4u);
    const std::vector<float>& visibility = layers_.at(0).channels.at("visibility").data;
    for (std::size_t pixel = 0; pixel < visibility.size(); ++pixel) {
        double sum = 0, weights = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec3 to_light = places[i] - receivers[pixel];
            const double weight = to_light.z / glm::length(to_light);
            sum += weight * double(i) / 4, weights += weight;
        }
        if (receivers[pixel] == glm::dvec3(0.0)) continue;
        ASSERT_NEAR(visibility[pixel], sum / weights, 1e-6);
    }
    EXPECT_EQ(layers_[0].channels.at("extra").data[5], 4.5f);
    EXPECT_EQ(layers_[0].stats.counters.at("light_samples"), 4);
}

TEST_F(SessionTechniqueTest, ALightWithoutSizeHasOneSample) {
    RenderRequest request = make_request();
    request.jobs[0].parameters = sample_count(7);
    int calls = 0;
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        ++calls;
        for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, 0.25f));
    };
    run(request);
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(layers_.at(0).channels.at("visibility").data[5], 0.25f);
}

/// Its needs: all samples at once.
TechniqueDescriptor describe_sampler() {
    TechniqueDescriptor d = describe_scripted();
    d.truth = [](const ParameterValues&) { return TruthSpec{TruthKind::Soft}; };
    return d;
}

TEST_F(SessionTechniqueTest, WhoSamplesTheLightItselfIsCalledOnceWithItsCentre) {
    behaviour.needs.samples_itself = true;
    behaviour.needs.light_samples = 16;
    RenderRequest request = make_request();
    auto scene = make_bulb_scene();
    request.scene = scene;
    request.samples = 3;
    std::vector<int> picture_samples;
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        picture_samples.push_back(task.picture_sample);
        EXPECT_EQ(task.sample.position_ws, glm::dvec3(task.light.world_from_light[3]));
        for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, 0.5f));
    };
    run(request, describe_sampler);
    EXPECT_EQ(picture_samples, (std::vector{0, 1, 2}));
    EXPECT_EQ(layers_.at(0).channels.at("visibility").data[5], 0.5f);

    // Below the floor but for the upper part of the ball: lit by that part.
    scene->lights[0].casts_shadow = false;
    scene->lights[0].world_from_light = glm::translate(glm::dmat4(1.0), glm::dvec3(2, -1, -0.05));
    run(request, describe_sampler);
    EXPECT_EQ(picture_samples.size(), 3u);
    for (const float value : layers_.at(0).channels.at("visibility").data) EXPECT_EQ(value, 1.0f);
}

TEST_F(SessionTechniqueTest, VisibilityIsHeldInRangeAndOtherChannelsAreNot) {
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        outputs.set("visibility", make_image(task.frame, 1, 1.00001f));
        outputs.set("extra", make_image(task.frame, 1, -7.0f));
    };
    run(make_request());
    EXPECT_EQ(layers_.at(0).channels.at("visibility").data[5], 1.0f);
    EXPECT_EQ(layers_[0].channels.at("extra").data[5], -7.0f);
}

TEST_F(SessionTechniqueTest, ValuesThatAreNotNumbersAreNamed) {
    for (float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
        for (const char* channel : {"visibility", "extra"}) {
            behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
                for (const char* name : {"visibility", "extra"}) {
                    Image image = make_image(task.frame, 1, 1);
                    if (name == std::string(channel)) image.data[77] = bad;
                    outputs.set(name, image);
                }
            };
            const std::string text = message_of<DriverError>(make_request());
            EXPECT_NE(text.find("scripted"), std::string::npos) << text;
            EXPECT_NE(text.find(channel), std::string::npos) << text;
        }
}

TEST_F(SessionTechniqueTest, WrongOutputsAreNamed) {
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        outputs.set("visibility", make_image(task.frame, 1, 1));
    };
    EXPECT_NE(message_of<Error>(make_request()).find("extra"), std::string::npos);
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        outputs.set("undeclared", make_image(task.frame, 1, 1));
    };
    EXPECT_NE(message_of<Error>(make_request()).find("undeclared"), std::string::npos);
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        outputs.set("visibility", make_image(task.frame, 3, 1));
    };
    EXPECT_NE(message_of<Error>(make_request()).find("24x16"), std::string::npos);
}

TEST_F(SessionTechniqueTest, OpenCastersOfATechniqueForClosedOnesAreNamed) {
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, 1));
    };
    auto scene = std::make_shared<Scene>(*test::make_ball_scene());
    const std::vector<glm::vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    scene->meshes[1] = test::to_mesh("tetrahedron", {corners, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}});
    RenderRequest request = make_request();
    request.scene = scene;  // the floor is open
    request.samples = 3;
    EXPECT_EQ(run(request).warnings, std::vector<std::string>());
    behaviour.meshes = CasterMeshes::Closed;
    const std::vector<std::string> warnings = run(request).warnings;
    ASSERT_EQ(warnings.size(), 1u);
    for (const char* part : {"\"scripted\"", "\"floor\"", "closed"})
        EXPECT_NE(warnings[0].find(part), std::string::npos) << warnings[0];
    auto other = std::make_shared<Scene>(*scene);
    other->instances[0].flags = kInstanceCamera;  // seen, but casts nothing
    request.scene = other;
    EXPECT_EQ(run(request).warnings, std::vector<std::string>());
}

TEST_F(SessionTechniqueTest, GLErrorsEndTheRenderAndNameTheStage) {
    behaviour.render = [&](Engine& engine, const LightTask&, LayerOutputs&) {
        const auto timer = engine.time_stage("broken stage");
        engine.gl().BindTextureUnit(0, 123456);
    };
    EXPECT_NE(message_of<DriverError>(make_request()).find("broken stage"), std::string::npos);
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, 1));
    };
    EXPECT_NO_THROW(run(make_request()));
}

TEST_F(SessionTechniqueTest, TechniquesGetFramesBetweenThePixels) {
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        EXPECT_EQ(&task.frames.centre(), &task.frame);
        const auto moved = task.frames.at_offset(0.5, 0.5);
        const auto ray = task.frame.ray_at(10, 10), same = moved->ray_at(9.5, 9.5);
        EXPECT_LE(glm::length(ray.direction - same.direction), 1e-12);
        outputs.set("visibility", make_image(task.frame, 1, 1));
        outputs.set("extra", make_image(*moved, 1, 1));
    };
    run(make_request());
}

TEST_F(SessionTechniqueTest, NoGLObjectIsLeftBehind) {
    behaviour.render = [&](Engine& engine, const LightTask& task, LayerOutputs& outputs) {
        const auto timer = engine.time_stage("stage");
        for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, 1));
        task.frames.at_offset(0.25, 0.25);
    };
    RenderRequest request = make_request();
    request.samples = 3;
    std::size_t objects = 0;
    for (int i = 0; i < 20; ++i) {
        run(request);
        if (i == 3) objects = engine().device().live_objects();
    }
    EXPECT_EQ(engine().device().live_objects(), objects);
}

TEST_F(SessionTechniqueTest, WhatACancelBreaksEndsAsCancelled) {
    const std::function<void(Engine&, const LightTask&, LayerOutputs&)> ends[] = {
        [](Engine&, const LightTask& task, LayerOutputs& outputs) {
            const float nothing = std::numeric_limits<float>::quiet_NaN();
            for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, nothing));
        },
        [](Engine&, const LightTask&, LayerOutputs&) { throw std::bad_alloc(); },
        [](Engine&, const LightTask&, LayerOutputs&) { throw DriverError("lost"); },
        [](Engine& engine, const LightTask& task, LayerOutputs& outputs) {
            const auto timer = engine.time_stage("left an error");
            engine.gl().Enable(0xffff);
            for (const char* name : {"visibility", "extra"}) outputs.set(name, make_image(task.frame, 1, 1));
        }};
    for (const bool cancels : {true, false})
        for (const auto& end : ends) {
            behaviour.render = [&](Engine& engine, const LightTask& task, LayerOutputs& outputs) {
                end(engine, task, outputs);
            };
            if (cancels)
                behaviour.render = [&](Engine& engine, const LightTask& task, LayerOutputs& outputs) {
                    if (&end == &ends[3]) {  // a stage can't begin once a cancel is asked for
                        end(engine, task, outputs);
                        engine.cancel_token().request();
                    } else {
                        engine.cancel_token().request();
                        end(engine, task, outputs);
                    }
                };
            try {
                run(make_request());
                ADD_FAILURE() << "nothing was thrown";
            } catch (const Cancelled&) {
                EXPECT_TRUE(cancels);
            } catch (const std::exception& error) {
                EXPECT_FALSE(cancels) << error.what();
            }
            engine().cancel_token().reset();
            engine().drop_errors();
        }
}

TEST_F(SessionTechniqueTest, LightsOfOtherKindsAreRefused) {
    RenderRequest request = make_request();
    auto scene = test::make_ball_scene();
    scene->lights[0].kind = LightKind::Sun;
    request.scene = scene;
    const std::string text = message_of<InputError>(request);
    EXPECT_NE(text.find("SUN"), std::string::npos) << text;
    EXPECT_NE(text.find("lamp"), std::string::npos) << text;
}

/// More sums than fit the memory set aside: worked in passes, delivered in order, the same pictures.
TEST_F(SessionTechniqueTest, ManyLayersOfManySamplesAreWorkedInPasses) {
    behaviour.channels = 4;
    RenderRequest request = make_request();
    request.width = 1024, request.height = 1024;
    request.samples = 2;
    request.combined = false;
    request.jobs.assign(30, {0, "scripted", {}});  // 20 MiB each, 256 MiB allowed
    int calls = 0;
    behaviour.render = [&](Engine&, const LightTask& task, LayerOutputs& outputs) {
        outputs.set("visibility", make_image(task.frame, 1, 1));
        outputs.set("extra", make_image(task.frame, 4, float(calls++)));
    };
    run(request);
    ASSERT_EQ(layers_.size(), 30u);
    EXPECT_EQ(calls, 60);
    for (std::uint32_t i = 0; i < 30; ++i) EXPECT_EQ(layers_[i].job, i);
    // Job 0 was called first and then after the 12 or so others of its pass.
    EXPECT_LT(layers_[0].channels.at("extra").data[0], 10.0f);
}

/// Counts those that live.
class CountedTechnique final : public Technique {
public:
    CountedTechnique() { ++count; }
    ~CountedTechnique() override { --count; }
    void prepare(Engine&, const ParameterValues&) override {}
    void render(Engine&, const LightTask&, LayerOutputs&) override {}
    static inline int count = 0;
};

/// Techniques hold pictures of the frame's size; those of a choice that was changed long ago must not stay.
TEST(TechniqueSetTest, LetsGoOfWhatTheLastRendersDidNotUse) {
    const auto describe_other = [] {
        TechniqueDescriptor d = describe_scripted();
        d.id = "other";
        return d;
    };
    const auto make = [] { return std::unique_ptr<Technique>(new CountedTechnique); };
    TechniqueSet techniques({{describe_scripted, make}, {describe_other, make}});
    techniques.begin_render();
    const Technique* const used = &techniques.get("scripted");
    techniques.get("other");
    EXPECT_EQ(CountedTechnique::count, 2);
    for (std::uint64_t render = 0; render < kKeptRenders; ++render) {
        techniques.begin_render();
        EXPECT_EQ(&techniques.get("scripted"), used) << "one in use was made anew";
        EXPECT_EQ(CountedTechnique::count, 2) << "after " << render + 1 << " renders without it";
    }
    techniques.begin_render();
    EXPECT_EQ(&techniques.get("scripted"), used);
    EXPECT_EQ(CountedTechnique::count, 1);
}

}  // namespace
}  // namespace shadow_layers
