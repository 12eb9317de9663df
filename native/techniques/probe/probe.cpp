// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// A test-only technique that uses every feature of the interface at once, as later techniques will one by one:
//   - several views (cube faces) are merged before a camera-space stage works on the picture;
//   - that stage reads past the region's rim, so it asks for overscan;
//   - a CPU stage works beside the GL ones, on the thread pool;
//   - many samples per pixel, from frames at sub-pixel offsets;
//   - several output channels, from the GL and from the CPU.
// docs/adding-a-technique.md walks through this file. Based on: nothing; it is not meant to look good.
#include "techniques/probe/probe.h"

#include <algorithm>

#include "engine/picture_target.h"
#include "stages/depth_map.h"
#include "stages/resolve.h"
#include "techniques/common_parameters.h"

namespace shadow_layers {
namespace {

/// An R32F picture that results are summed up in.
class SumPicture {
public:
    void clear(Engine& engine, int width, int height) {
        sum_.fit(engine, width, height, {GL_R32F}, "probe sum");
        sum_.framebuffer().clear_color(0, 0);
    }
    void add(Engine& engine, const gl::Texture& picture, float weight) {
        const gl::Program& program = engine.program("frame/fullscreen.vert", "techniques/probe/probe_scale.frag");
        program.use();
        program.set("u_weight", weight);
        picture.bind(0);
        sum_.framebuffer().bind();
        DrawState state;
        state.blend = true;
        engine.draw_fullscreen(state);
    }
    const gl::Texture& texture() const { return sum_.texture(); }

private:
    PictureTarget sum_;
};

class Probe final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues&) override {
        resolve_program_ = &engine.program("frame/fullscreen.vert", "techniques/probe/probe.frag");
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        merge_views(engine, task, task.frame, merged_);
        outputs.set("merged", merged_.texture());
        outputs.set("contrast", compute_contrast(engine, merged_.texture()));
        outputs.set("visibility", blur(engine, merged_.texture(), int(task.parameters.get_int("blur"))));
        outputs.set("supersampled", supersample(engine, task));
        outputs.set("normal", copy_normals(engine, task.frame));
    }

private:
    /// All views of the light's sample.
    void merge_views(Engine& engine, const LightTask& task, const Frame& frame, SumPicture& sum) {
        sum.clear(engine, frame.width, frame.height);
        const auto map = render_depth_map(engine, *frame.scene, task.sample);
        const gl::Texture& one = resolve_.run(engine, {.frame = frame,
                                                       .light = task.light,
                                                       .sample = task.sample,
                                                       .program = *resolve_program_,
                                                       .bind_inputs = [&] { map->texture->bind(kDepthMapUnit); }});
        const auto timer = engine.time_stage("probe_merge");
        sum.add(engine, one, 1.0f);
    }

    /// Mean of the frame at the middles of a 2 x 2 grid in each pixel.
    const gl::Texture& supersample(Engine& engine, const LightTask& task) {
        std::vector<std::shared_ptr<const Frame>> frames;
        for (int k = 0; k < 4; ++k) frames.push_back(task.frames.at_offset(k & 1 ? 0.25 : -0.25, k & 2 ? 0.25 : -0.25));
        supersampled_.clear(engine, task.frame.width, task.frame.height);
        for (const auto& frame : frames) {
            merge_views(engine, task, *frame, one_sample_);
            supersampled_.add(engine, one_sample_.texture(), 1.0f / float(frames.size()));
        }
        return supersampled_.texture();
    }

    /// The camera-space stage: a box filter over the picture's pixels.
    const gl::Texture& blur(Engine& engine, const gl::Texture& picture, int radius) {
        const auto timer = engine.time_stage("probe_blur");
        blurred_.fit(engine, picture.width(), picture.height(), {GL_R32F}, "probe blur");
        const gl::Program& program = engine.program("frame/fullscreen.vert", "techniques/probe/probe_blur.frag");
        program.use();
        program.set("u_radius", radius);
        picture.bind(0);
        blurred_.framebuffer().bind();
        engine.draw_fullscreen();
        return blurred_.texture();
    }

    /// The CPU stage: largest minus smallest value among a pixel and its eight neighbours.
    Image compute_contrast(Engine& engine, const gl::Texture& picture) {
        const auto timer = engine.time_stage("probe_contrast");
        const std::vector<float> values = picture.download<float>();
        const int width = picture.width(), height = picture.height();
        Image image{width, height, 1, std::vector<float>(values.size())};
        engine.threads().parallel_for(std::size_t(height), 16, [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < width; ++x) {
                    float least = 1, most = 0;
                    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
                        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
                            least = std::min(least, values[std::size_t(v) * std::size_t(width) + std::size_t(u)]);
                            most = std::max(most, values[std::size_t(v) * std::size_t(width) + std::size_t(u)]);
                        }
                    image.data[std::size_t(y) * std::size_t(width) + std::size_t(x)] = most - least;
                }
        });
        return image;
    }

    static Image copy_normals(Engine& engine, const Frame& frame) {
        const auto timer = engine.time_stage("probe_normal");
        Image image{frame.width, frame.height, 3, std::vector<float>(3 * frame.pixel_count())};
        for (std::size_t k = 0; k < frame.pixel_count(); ++k)
            for (int c = 0; c < 3; ++c) image.data[3 * k + std::size_t(c)] = frame.normals[k][c];
        return image;
    }

    const gl::Program* resolve_program_ = nullptr;
    ResolvePass resolve_;
    SumPicture merged_, one_sample_, supersampled_;
    PictureTarget blurred_;
};

ParameterSpec int_parameter(std::string id, std::string label, std::string unit, std::string help, int least, int most,
                            std::int64_t start) {
    ParameterSpec spec;
    spec.id = std::move(id);
    spec.label = std::move(label);
    spec.type = ParameterType::Int;
    spec.unit = std::move(unit);
    spec.help = std::move(help);
    spec.min = least;
    spec.max = most;
    spec.default_value = start;
    return spec;
}

}  // namespace

TechniqueDescriptor describe_probe() {
    return {
        .id = "probe",
        .label = "Probe",
        .summary = "Uses every feature of the technique interface; for tests only",
        .reference = "Williams78",
        .limits = "It is not meant to look good",
        .parameters = {map_size_parameter(),
                       int_parameter("blur", "Blur", "px", "Radius of the box filter over the picture", 0, 16, 2)},
        .outputs = {describe_visibility(),
                    {"merged", "Merged", 1, "All views merged, before the filter"},
                    {"contrast", "Contrast", 1, "Range of the merged picture over a pixel and its neighbours"},
                    {"supersampled", "Supersampled", 1, "Mean of four frames at sub-pixel offsets"},
                    {"normal", "Normal", 3, "The receiver's normal, world axes"}},
        .test_only = true,
        .needs =
            [](const ParameterValues& values) {
                TechniqueNeeds needs = map_needs(values);
                needs.overscan_px = std::max(1, int(values.get_int("blur")));  // the contrast looks one pixel far
                return needs;
            },
    };
}

std::unique_ptr<Technique> make_probe() { return std::make_unique<Probe>(); }

}  // namespace shadow_layers
