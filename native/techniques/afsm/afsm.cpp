// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Alias-free shadow maps: the map's texels hold lists of the receivers seen there, the casters are drawn over them with
// full coverage, and every fragment tests its texel's receivers against its triangle, each at its own place.
// Based on: T. Aila, S. Laine, Alias-free shadow maps, EGSR 2004; C. Wyman, R. Hoetzlein, A. Lefohn, Frustum-traced
// raster shadows, I3D 2015 (lists of receivers by texel, a node per pixel). `samples` above 1 is the supersampled
// baseline that sub-pixel methods are compared with. Differences: a rectangle of texels stands for a conservatively
// drawn triangle, edge functions without division by w need no clipping, and pairs nearer than the bound of float's
// error are settled in double (visibility/occlusion_rule.h), so there is no bias. Fails: nothing known, but for time:
// lists are long where many receivers share a texel, and long thin casters have large rectangles.
#include "techniques/afsm/afsm.h"

#include "lights/sample_pattern.h"
#include "techniques/afsm/receiver_lists.h"
#include "techniques/common_parameters.h"
#include "techniques/parameter_builder.h"
#include "visibility/occlusion_rule.h"
#include "visibility/receiver_tiles.h"

namespace shadow_layers {
namespace {

class AFSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues&) override {
        engine.program({"techniques/afsm/insert.comp"});
        engine.program("frame/fullscreen.vert", "techniques/afsm/farthest.frag");
        engine.program("techniques/afsm/casters.vert", "techniques/afsm/casters.frag");
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const int samples = int(task.parameters.get_int("samples"));
        std::vector<std::uint32_t> lit(task.frame.pixel_count());
        for (int k = 0; k < samples; ++k) {
            engine.check_cancelled();
            const std::vector<std::uint8_t> visible =
                samples == 1 ? compute_visibility(engine, task.frame, task.light, task.sample)
                             : compute_at_offset(engine, task, get_afsm_offset(k, samples));
            for (std::size_t pixel = 0; pixel < lit.size(); ++pixel) lit[pixel] += visible[pixel];
        }
        lists_.count_bytes(engine);
        engine.count("list_bytes", std::int64_t(sorter_.byte_size()));
        Image image{task.frame.width, task.frame.height, 1, std::vector<float>(lit.size())};
        for (std::size_t pixel = 0; pixel < lit.size(); ++pixel) image.data[pixel] = float(lit[pixel]) / float(samples);
        outputs.set("visibility", std::move(image));
    }

private:
    /// The moved frame sees receivers that the task's views may not hold: it gets views of its own where that is so.
    std::vector<std::uint8_t> compute_at_offset(Engine& engine, const LightTask& task, glm::dvec2 offset) {
        const auto frame = task.frames.at_offset(offset.x, offset.y);
        const TechniqueNeeds needs = map_needs(task.parameters);
        const LightSample sample =
            fit_light_views(*frame, task.light, task.sample, {needs.map_size, needs.map_border_texels}, &task.sample,
                            &engine.threads());
        return compute_visibility(engine, *frame, task.light, sample);
    }

    std::vector<std::uint8_t> compute_visibility(Engine& engine, const Frame& frame, const Light& light,
                                                 const LightSample& sample) {
        {
            const auto timer = engine.time_stage("receiver_tiles");
            sorter_.sort(frame, light, sample, kMostTiles, engine.threads());
        }
        const OcclusionRule rule(frame, sample);
        for (std::size_t view = 0; view < sample.views.size(); ++view)
            lists_.draw(engine, {frame, sample.views[view], rule, sorter_.views()[view]}, sorter_.visible());
        return sorter_.visible();
    }

    // The order in which receivers come to the GL: neighbours lie near each other in memory.
    static constexpr int kMostTiles = 1024;
    ReceiverSorter sorter_;
    ReceiverLists lists_;
};

}  // namespace

glm::dvec2 get_afsm_offset(int index, int count) {
    if (count == 1) return glm::dvec2(0.0);
    return SamplePattern(LightPattern::Sequence, count).get_in_square(index) - 0.5;
}

TechniqueDescriptor describe_afsm() {
    return {
        .id = "afsm",
        .label = "Alias-Free",
        .summary =
            "Alias-free shadow maps: texels list the receivers, each is tested exactly against the casters drawn there",
        .reference = "Aila04",
        .limits = "Many receivers in a texel, and long thin casters, cost time",
        .parameters = {map_size_parameter(),
                       int_parameter("samples", "Samples", 1)
                           .range(1, 64)
                           .unit("per pixel")
                           .help("Places in the pixel that are tested and averaged; 1 is its centre")},
        .needs =
            [](const ParameterValues& values) {
                TechniqueNeeds needs = map_needs(values);
                needs.sees_moved_frames = values.get_int("samples") > 1;
                return needs;
            },
        .truth =
            [](const ParameterValues& values) {
                return TruthSpec{values.get_int("samples") > 1 ? TruthKind::Pixel : TruthKind::Hard};
            },
    };
}

std::unique_ptr<Technique> make_afsm() { return std::make_unique<AFSM>(); }

}  // namespace shadow_layers
