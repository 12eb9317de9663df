// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Euclidean distance transform shadow mapping: the hard shadow's border, as the picture shows it, becomes a ramp by the
// distance to it.
//   1. hard visibility from another technique, whose borders are finer than the map's texels (InnerTechnique)
//   2. sites: pixels along the border, with the point of the border that they stand for
//   3. nearest site of each pixel, by an exact distance transform, no farther than the widest penumbra reaches
//   4. penumbra: 1/2 +- distance / width, or what a light of its size leaves; then a mean filter against skeletons
// Based on: [Macedo17] M. C. F. Macedo, A. L. Apolinario, Euclidean distance transform shadow mapping, Graphics
// Interface 2017.
// Differences: the border lies between pixels, so the ramp has no step there; one surface is recognised by planes and
// pixel footprints and not by a threshold of depth; the site that is nearest on the surface is looked for, which the
// one that is nearest on the screen is not where the surface is seen at a slant; the next borders on the same line
// count too, so that thin casters and narrow gaps have their part; the width may come from the light's size, and the
// ramp is then the light's own profile; the filter's size goes with the penumbra's width. Fails: more than three
// borders in one penumbra, and crossing ones; borders that the camera does not see (behind things, off the picture)
// soften nothing.
#include "techniques/edtsm/edtsm.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/picture_target.h"
#include "light_params.h"
#include "shadow_layers/error.h"
#include "stages/depth_map.h"
#include "stages/distance_transform.h"
#include "techniques/common_parameters.h"
#include "techniques/edtsm/border_sites.h"
#include "techniques/inner_technique.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

constexpr double kLeastPenumbra = 1e-6, kLargestPenumbra = 1e6;
constexpr int kGapRadiusTexels = 2;      // how far edtsm_sites.frag looks for a border's blocker
constexpr int kMostFilterReachPx = 512;  // twice kLargestRadiusPx of edtsm_filter.frag
// Work per pixel, in the plain reads that bands are measured by.
constexpr double kWorkPerPenumbra = 150, kWorkPerTap = 4;

struct Source {
    std::string technique;
    ParameterValues parameters;
};

Source make_source(const ParameterValues& values) {
    const std::string& id = values.get_enum("source");
    Source source{id == "edsm" ? "edsm" : "smsr", {}};
    source.parameters.set("map_size", values.get_int("map_size"));
    if (source.technique == "edsm") return source;
    source.parameters.set("walk_limit", values.get_int("walk_limit"));
    source.parameters.set("mode", std::string(id == "half" ? "half" : "paper"));
    return source;
}

PenumbraSettings make_settings(const ParameterValues& values) {
    return {.from_light = values.get_enum("penumbra_from") == "light",
            .screen_metric = values.get_enum("metric") == "screen",
            .width = values.get_float("penumbra"),
            .width_px = values.get_float("penumbra_px"),
            .filter = values.get_float("filter")};
}

class EDTSM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        const Source source = make_source(parameters);
        source_.prepare(engine, source.technique, source.parameters);
        settings_ = make_settings(parameters);
        penumbra_program_ =
            &engine.program(PictureTiles::kVertexShader, "techniques/edtsm/edtsm_penumbra.frag", settings_.defines());
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const gl::Texture& hard_tx = source_.render(engine, task);
        if (settings_.from_light && !has_size(task.light)) {
            outputs.set("visibility", hard_tx);
            return;
        }
        std::shared_ptr<const DepthMap> map;
        if (settings_.from_light) map = render_depth_map(engine, *task.frame.scene, task.sample);
        blocks_.bind(engine, task, settings_);
        const auto sites = sites_.find(engine, task.frame, settings_, hard_tx, map ? map->texture.get() : nullptr);
        engine.count("border_sites", sites.site_count);
        engine.count("picture_bytes", std::int64_t(sites_.byte_size()));
        if (sites.site_count == 0) {
            outputs.set("visibility", hard_tx);
            return;
        }
        warn_of_width(engine, task, sites);
        outputs.set("visibility", soften(engine, task, hard_tx, sites));
    }

private:
    /// A width that was asked for may be a slip. It is no error: a camera that comes near makes any width large.
    void warn_of_width(Engine& engine, const LightTask& task, const BorderSites::Result& sites) const {
        if (settings_.from_light) return;
        const Frame& frame = task.frame;
        // Of the full picture: a region of it has the same penumbrae.
        const int picture_px = std::max({frame.width, frame.height, frame.picture_width, frame.picture_height});
        if (sites.penumbra_px <= picture_px) return;
        const bool screen = settings_.screen_metric;
        std::ostringstream text;
        text << "edtsm: a penumbra of " << (screen ? settings_.width_px : settings_.width)
             << (screen ? " px" : " scene units")
             << " is wider than the picture, so that borders outside of it are missed; "
             << "give \"" << (screen ? "penumbra_px" : "penumbra") << "\" a smaller value if that was not meant";
        engine.warn(text.str());
    }

    const gl::Texture& soften(Engine& engine, const LightTask& task, const gl::Texture& hard_tx,
                              const BorderSites::Result& sites) {
        const Frame& frame = task.frame;
        const double picture_px = std::hypot(frame.width, frame.height);
        const int bound_px = int(std::ceil(std::min(picture_px, sites.radius_px))) + 1;
        const PictureTiles tiles = sites.tiles.grown(bound_px);
        engine.count("radius_px", bound_px);
        engine.count("penumbra_tiles", std::int64_t(tiles.count()));
        const gl::Texture& nearest_tx = transform_.run(engine, sites.mask_tx, {.bound_px = bound_px});
        soft_.fit(engine, frame.width, frame.height, {GL_RGBA32F}, "penumbra");
        rows_.fit(engine, frame.width, frame.height, {GL_RGBA32F}, "filtered rows");
        whole_.fit(engine, frame.width, frame.height, {GL_R32F}, "filtered penumbra");
        // The transform and the source have bound what they like.
        blocks_.bind(engine, task, settings_);
        frame.position_tx->bind(kPositionUnit);
        frame.normal_tx->bind(kNormalUnit);
        draw_penumbra(engine, hard_tx, sites.border_tx, nearest_tx, tiles);
        filter(engine, hard_tx, tiles, bound_px);
        engine.count("picture_bytes", std::int64_t(transform_.byte_size() + soft_.byte_size() + rows_.byte_size()));
        return whole_.texture();
    }

    void draw_penumbra(Engine& engine, const gl::Texture& hard_tx, const gl::Texture& border_tx,
                       const gl::Texture& nearest_tx, const PictureTiles& tiles) {
        const auto timer = engine.time_stage("penumbra");
        // Off the tiles there is no tap for the filter.
        soft_.framebuffer().clear_color(0, 0);
        penumbra_program_->use();
        hard_tx.bind(kHardVisibilityUnit);
        border_tx.bind(kBorderUnit);
        nearest_tx.bind(kNearestUnit);
        soft_.framebuffer().bind();
        tiles.draw(engine, *penumbra_program_, kWorkPerPenumbra);
    }

    /// Rows, then columns; off the tiles the hard visibility stays.
    void filter(Engine& engine, const gl::Texture& hard_tx, const PictureTiles& tiles, int radius_px) {
        const auto timer = engine.time_stage("mean_filter");
        const double work = kWorkPerTap * std::min(radius_px, kMostFilterReachPx);  // the window is a part of that
        gl::Defines defines = {{"AXIS", "0"}, {"SCREEN_METRIC", settings_.screen_metric ? "1" : "0"}};
        const auto draw = [&](const gl::Texture& from, PictureTarget& to) {
            const gl::Program& program =
                engine.program(PictureTiles::kVertexShader, "techniques/edtsm/edtsm_filter.frag", defines);
            program.use();
            from.bind(kSoftUnit);
            to.framebuffer().bind();
            tiles.draw(engine, program, work);
        };
        if (settings_.filter > 0) {
            rows_.framebuffer().clear_color(0, 0);
            draw(soft_.texture(), rows_);
        }
        engine.gl().CopyImageSubData(hard_tx.id(), hard_tx.target(), 0, 0, 0, 0, whole_.texture().id(),
                                     whole_.texture().target(), 0, 0, 0, 0, hard_tx.width(), hard_tx.height(), 1);
        defines["AXIS"] = std::string("1");  // not a literal: gcc 12 warns of it falsely
        draw(settings_.filter > 0 ? rows_.texture() : soft_.texture(), whole_);
    }

    PenumbraSettings settings_;
    InnerTechnique source_;
    PenumbraBlocks blocks_;
    BorderSites sites_;
    DistanceTransform transform_;
    PictureTarget soft_, rows_, whole_;
    const gl::Program* penumbra_program_ = nullptr;
};

std::vector<ParameterSpec> edtsm_parameters() {
    return {
        map_size_parameter(),
        enum_parameter("source", "Border Source", "half")
            .item("half", "Half Level", "Revectorised shadow map, border through the middles of its steps: unbiased")
            .item("smsr", "SMSR", "Revectorised shadow map as in the paper: borders half a texel too dark")
            .item("edsm", "EDSM", "Borders rebuilt from the silhouette edges of the geometry: exact, but slower")
            .help("Hard shadow whose border the penumbra is laid round"),
        int_parameter("walk_limit", "Walk Limit", 16)
            .range(1, 64)
            .unit("texels")
            .help("Longest walk along a step of the border, with the sources Half Level and SMSR"),
        enum_parameter("penumbra_from", "Penumbra From", "light")
            .item("light", "Light", "Width from the light's size and the distance of blocker and receiver")
            .item("fixed", "Fixed", "One width for all borders, as in the paper")
            .help("What makes a penumbra wide"),
        enum_parameter("metric", "Metric", "world")
            .item("world", "World", "Distances along the surface, in scene units: the same from any viewpoint")
            .item("screen", "Screen", "Distances in the picture, in pixels")
            .help("How the distance to the border is measured"),
        float_parameter("penumbra", "Penumbra", 0.1)
            .range(kLeastPenumbra, kLargestPenumbra)
            .unit("scene units")
            .help("Width of the penumbra with fixed width and the world metric"),
        float_parameter("penumbra_px", "Screen Penumbra", 24)
            .range(1, 4096)
            .unit("px")
            .help("Width of the penumbra with fixed width and the screen metric"),
        float_parameter("filter", "Mean Filter", 0.25)
            .range(0, 1)
            .help("Size of the mean filter as a part of the penumbra's width; 0 leaves it out"),
        int_parameter("overscan", "Overscan", 16)
            .range(0, 512)
            .unit("px")
            .help("How far beyond the picture's rim borders are looked for")};
}

}  // namespace

TechniqueDescriptor describe_edtsm() {
    return {
        .id = "edtsm",
        .label = "EDTSM",
        .summary = "Penumbrae by the exact distance to a rebuilt hard border, free of banding",
        .reference = "Macedo17",
        .limits = "Knows few borders at a time, and only those that the camera sees",
        .parameters = edtsm_parameters(),
        .light_size = LightSize::Followed,
        .needs =
            [](const ParameterValues& values) {
                const Source source = make_source(values);
                TechniqueNeeds needs = find_inner_needs(source.technique, source.parameters);
                needs.map_border_texels = std::max(needs.map_border_texels, kFootprintBorderTexels + kGapRadiusTexels);
                needs.overscan_px += int(values.get_int("overscan"));
                return needs;
            },
        .truth = [](const ParameterValues& values) -> TruthSpec {
            if (values.get_enum("penumbra_from") == "light") return {.kind = TruthKind::Soft};
            // A width in pixels is another one in the scene at each pixel: what holds everywhere is the hard border
            // inside.
            if (values.get_enum("metric") == "screen") return {};
            return {.kind = TruthKind::Filtered, .footprint_world = values.get_float("penumbra")};
        },
    };
}

std::unique_ptr<Technique> make_edtsm() { return std::make_unique<EDTSM>(); }

}  // namespace shadow_layers
