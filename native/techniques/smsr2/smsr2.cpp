// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Two-pass shadow map silhouette revectorisation: the original of smsr, with the discontinuities in a picture.
//   1. a picture of discontinuities: for each pixel, the depth tests of its texel against those of its neighbours
//   2. where there are any, the walk along the run, from texel to texel: each step looks up the pixel that sees the
//      receiver's plane there, and reads its discontinuities
// Based on: [Bondarev14] V. Bondarev, Shadow map silhouette revectorization, I3D 2014, as [Macedo16] 3 describes it.
// Differences: a pixel's record says which texel it is of, so a step that meets another surface notices it; texels that
// no pixel shows are tested like smsr's; the modes are those of smsr.
// Fails: as smsr; where surfaces of different height share a texel, each pixel answers for its own.
#include "techniques/smsr2/smsr2.h"

#include <glm/gtc/matrix_transform.hpp>

#include "frame/camera_window.h"
#include "stages/depth_map.h"
#include "techniques/common_parameters.h"
#include "techniques/revectorisation_parameters.h"
#include "techniques/smsr2/discontinuity_map.h"

namespace shadow_layers {
namespace {

/// Window space of the frame from "_rel", up to depth, which is of no use here.
glm::mat4 make_pixel_from_rel(const Frame& frame) {
    const glm::dmat4 camera_from_rel = glm::translate(camera_from_world(frame.camera), frame.origin_ws);
    const glm::dmat4 clip_from_rel = clip_from_camera(frame.camera, 1.0, 2.0) * camera_from_rel;
    const glm::dvec3 half(0.5 * frame.width, 0.5 * frame.height, 1.0);
    return glm::mat4(glm::translate(glm::dmat4(1.0), {half.x, half.y, 0.0}) * glm::scale(glm::dmat4(1.0), half) *
                     clip_from_rel);
}

class SMSR2 final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        settings_ = revectorise_settings(parameters, hard_border_is_exiting(parameters));
        const std::string folder = "techniques/smsr2/", vertex = "frame/fullscreen.vert";
        gl::Defines walker = settings_.defines();
        walker["VISIBILITY_OF"] = hard_border_function(parameters);
        discontinuities_ = &engine.program(vertex, folder + "smsr2_discontinuities.frag", settings_.defines());
        decider_ = &engine.program(vertex, folder + "smsr2_decide.frag", {{"EXITING", settings_.exiting ? "1" : "0"}});
        walker_ = &engine.program(vertex, folder + "smsr2.frag", walker);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const LightSample& sample = task.sample;
        const auto map = render_depth_map(engine, *task.frame.scene, sample);
        const gl::Texture& records =
            record_pass_.run(engine, {.frame = task.frame,
                                      .light = task.light,
                                      .sample = sample,
                                      .program = *discontinuities_,
                                      .format = GL_R32UI,
                                      .work_per_pixel = kReadsPerRecord,
                                      .bind_inputs = [&] { map->texture->bind(kDepthMapUnit); }});
        engine.count("discontinuity_bytes", std::int64_t(records.byte_size()));
        outputs.set("visibility", resolve_.run(engine, {.frame = task.frame,
                                                        .light = task.light,
                                                        .sample = sample,
                                                        .program = *decider_,
                                                        .second_program = walker_,
                                                        .second_work_per_pixel = kReadsPerStep * settings_.walk_limit,
                                                        .bind_inputs =
                                                            [&] {
                                                                map->texture->bind(kDepthMapUnit);
                                                                records.bind(kDiscontinuityUnit);
                                                            },
                                                        .bind_second_inputs =
                                                            [&] {
                                                                walker_->set("u_walk_limit", settings_.walk_limit);
                                                                walker_->set("u_pixel_from_rel",
                                                                             make_pixel_from_rel(task.frame));
                                                            }}));
    }

private:
    static constexpr double kReadsPerRecord = 5;
    static constexpr double kReadsPerStep = 1.5;  // as smsr, and the record
    RevectoriseSettings settings_;
    const gl::Program* discontinuities_ = nullptr;
    const gl::Program* decider_ = nullptr;
    const gl::Program* walker_ = nullptr;
    ResolvePass record_pass_, resolve_;
};

}  // namespace

TechniqueDescriptor describe_smsr2() {
    return {
        .id = "smsr2",
        .label = "Two-Pass SMSR",
        .summary = "The two-pass original of SMSR: a picture of discontinuities first, then the walks over it",
        .reference = "Bondarev14",
        .limits = "As SMSR; where surfaces of different height share a texel, each pixel answers for its own",
        .parameters = revectorisation_parameters({hard_border_parameter()}),
        .needs = revectorisation_needs,
    };
}

std::unique_ptr<Technique> make_smsr2() { return std::make_unique<SMSR2>(); }

}  // namespace shadow_layers
