// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Sub-pixel shadow maps: pixels near a silhouette become facets, squares on the plane that the pixel sees, and every
// caster near them gives a mask of the pixel's samples that it shadows. The layer is the part of the pixel that is lit.
// Based on: M. Pan, R. Wang, W. Chen, K. Zhou, H. Bao, Fast, Sub-pixel Antialiased Shadow Maps, Pacific Graphics 2009.
// Differences: half-planes are linear forms over the pixel and masks are computed from them (the paper's table is a
// mode); pairs are made for all texels of a silhouette pixel; a triangle-texel pair is worked when it is found; pixels
// without a silhouette are exact, or depth-tested as in the paper; casters in the facet's plane are left out. It runs
// on the CPU with SIMD (docs/techniques/fsasm.md tells why). Fails: surfaces that bend within a pixel, for the facet is
// flat.
#include "techniques/fsasm/fsasm.h"

#include <algorithm>

#include "stages/depth_map.h"
#include "techniques/common_parameters.h"
#include "techniques/fsasm/facet_draw.h"
#include "techniques/inner_technique.h"
#include "techniques/parameter_builder.h"

namespace shadow_layers {
namespace {

// Finer maps would only make more pairs; the texels of one view take a quarter of a gigabyte then.
constexpr std::int64_t kMostTexels = 4096;
// Pairs that facets may make before they are drawn over: a bound of memory, at most half a gigabyte.
constexpr std::size_t kPairsAtOnce = 1 << 23;

std::int64_t get_map_size(const ParameterValues& values) { return std::min(values.get_int("map_size"), kMostTexels); }

ParameterValues interior_values(const ParameterValues& values) {
    ParameterValues given;
    given.set("map_size", get_map_size(values));
    return given;
}

std::string get_interior_id(const ParameterValues& values) {
    return values.get_enum("interior") == "exact" ? "exact" : "sm";
}

SamplePlaces find_places(const ParameterValues& values) {
    const auto placement = values.get_enum("pattern") == "grid" ? SamplePlacement::Grid : SamplePlacement::Lattice;
    return make_sample_places(placement, std::stoi(values.get_enum("samples")));
}

Validity find_validity(const ParameterValues& values) {
    const std::string& id = values.get_enum("validity");
    return id == "off" ? Validity::Off : id == "line" ? Validity::Line : Validity::Seen;
}

void look_up(const void* table, double at, double by_x, double by_y, std::uint32_t (&mask)[kMaskWords]) {
    const SampleMask& found = static_cast<const HalfPlaneTable*>(table)->find(at, by_x, by_y);
    for (std::size_t word = 0; word < kMaskWords; ++word) mask[word] &= found.words[word];
}

/// The lit part of a facet's samples ([Pan09] 3.4). `otherwise`: if no sample is valid.
float compute_visibility(const SilhouetteFacet& facet, const SamplePlaces& places, float otherwise) {
    SampleMask valid = find_in_front(facet.rel, places) & (facet.outside | facet.in_view);
    if (facet.is_turned_away) valid = find_in_front(facet.rel, places);
    valid.remove(facet.cut);
    if (valid.is_empty()) return otherwise;
    SampleMask dark = facet.is_turned_away ? valid : facet.occluded & valid;
    dark.remove(facet.outside);
    return 1.0f - float(dark.count()) / float(valid.count());
}

class FSASM final : public Technique {
public:
    void prepare(Engine& engine, const ParameterValues& parameters) override {
        interior_.prepare(engine, get_interior_id(parameters), interior_values(parameters));
        places_ = find_places(parameters);
        table_.reset();
        if (parameters.get_enum("masks") == "table") table_ = std::make_unique<HalfPlaneTable>(places_);
    }

    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) override {
        const Frame& frame = task.frame;
        const LightSample& sample = task.sample;
        Image image{frame.width, frame.height, 1, interior_.render(engine, task).download<float>()};
        const std::vector<SilhouetteMask> masks = make_masks(engine, *frame.scene, sample);
        std::vector<SilhouetteFacet> facets;
        {
            const auto timer = engine.time_stage("facets");
            facets = find_silhouette_facets(frame, task.light, sample, masks, image.data, places_, engine.threads());
        }
        const OcclusionRule rule(frame, sample);
        std::size_t pair_bytes = 0;
        for (std::size_t begin = 0, end = 0; begin < facets.size(); begin = end) {
            std::size_t texels = 0;
            while (end < facets.size() && (end == begin || texels + facets[end].texels <= kPairsAtOnce))
                texels += facets[end++].texels;
            pair_bytes = std::max(pair_bytes, work(engine, task, rule, std::span(facets).subspan(begin, end - begin)));
        }
        engine.count("list_bytes", std::int64_t(pair_bytes + facets.size() * sizeof(SilhouetteFacet)));
        finish(engine, facets, image);
        outputs.set("visibility", std::move(image));
    }

private:
    std::vector<SilhouetteMask> make_masks(Engine& engine, const Scene& scene, const LightSample& sample) {
        if (sample.views.empty()) return {};
        const auto depth_map = render_depth_map(engine, scene, sample);
        MapEdgeOptions options;
        options.half_width_texels = 1;
        options.silhouettes.skip_concave = true;  // no border of a shadow
        const MapEdges found = find_map_edges(engine, scene, sample, options);
        const auto timer = engine.time_stage("silhouette_mask");
        const std::vector<float> depths = depth_map->texture->download<float>();
        std::vector<SilhouetteMask> masks;
        for (std::size_t view = 0; view < sample.views.size(); ++view) {
            engine.check_cancelled();
            const int side = sample.views[view].size_texels;
            const std::size_t texels = std::size_t(side) * std::size_t(side);
            masks.emplace_back(side, mark_silhouette_texels(found.by_view[view], side,
                                                            std::span(depths).subspan(view * texels, texels)));
            engine.count("silhouette_texels", masks.back().count());
            engine.count("map_bytes", std::int64_t(masks.back().byte_size()));
        }
        engine.count("silhouette_edges", found.silhouette_edges);
        return masks;
    }

    /// Returns the bytes of a view's pairs at their most.
    std::size_t work(Engine& engine, const LightTask& task, const OcclusionRule& rule,
                     std::span<SilhouetteFacet> facets) {
        std::size_t pair_bytes = 0;
        const facet_kernel::Samples samples{places_.count, places_.x.data(), places_.y.data(), table_.get(), look_up};
        const FacetContacts contacts(task.frame, rule, samples, find_validity(task.parameters));
        for (const LightView& view : task.sample.views) {
            engine.check_cancelled();
            PixelTexelPairs pairs;
            {
                const auto timer = engine.time_stage("pixel_texel_pairs");
                pairs = make_pairs(facets, 0, task.frame, view, places_, engine.threads());
                engine.count("pixel_texel_pairs", std::int64_t(pairs.pairs.size()));
                pair_bytes = std::max(pair_bytes, pairs.byte_size());
            }
            const auto timer = engine.time_stage("visibility_masks");
            draw_casters_over_pairs(engine, task.frame, view, pairs, samples, contacts, facets);
        }
        return pair_bytes;
    }

    void finish(Engine& engine, const std::vector<SilhouetteFacet>& facets, Image& image) const {
        std::int64_t valid = 0;
        for (const SilhouetteFacet& facet : facets) {
            float& value = image.data[facet.pixel];
            value = compute_visibility(facet, places_, value);
            SampleMask kept = places_.all();
            valid += kept.remove(facet.cut).count();
        }
        engine.count("silhouette_pixels", std::int64_t(facets.size()));
        engine.count("valid_samples", valid);
    }

    InnerTechnique interior_;
    SamplePlaces places_;
    std::unique_ptr<HalfPlaneTable> table_;
};

std::vector<ParameterSpec> list_parameters() {
    ParameterBuilder samples = enum_parameter("samples", "Samples", "32");
    samples.help("Samples of a pixel, one bit each in its masks");
    for (const char* count : {"8", "32", "64", "128"})
        samples.item(count, count, std::string(count) + " samples per pixel");
    return {
        map_size_parameter(),
        samples,
        enum_parameter("pattern", "Pattern", "lattice")
            .help("Where the samples lie; one is always at the pixel's centre")
            .item("lattice", "Lattice", "Each in a row and a column of its own: fine steps along borders of any angle")
            .item("grid", "Grid", "Rows and columns, as in the paper: coarse steps along level and upright borders"),
        enum_parameter("validity", "Validity Mask", "seen")
            .help("Which samples are left out because the pixel sees another surface there")
            .item("seen", "Seen", "Those that a surface near the pixel's plane hides from the camera")
            .item("line", "Line", "The paper's: those beyond the line where a surface meets the pixel's plane")
            .item("off", "Off", "None"),
        enum_parameter("masks", "Masks", "computed")
            .help("How the samples on one side of a line are found")
            .item("computed", "Computed", "Every sample is held against the line")
            .item("table", "Table", "The paper's table of lines, their angle and place rounded"),
        enum_parameter("interior", "Interior", "exact")
            .help("What decides pixels that no silhouette crosses")
            .item("exact", "Exact", "The triangles between pixel and light, as in technique exact")
            .item("depth_test", "Depth Test", "The depth map, as in technique sm and in the paper")};
}

}  // namespace

TechniqueDescriptor describe_fsasm() {
    return {
        .id = "fsasm",
        .label = "Sub-Pixel",
        .summary = "Sub-pixel shadow maps: near silhouettes masks of samples tell which part of a pixel is lit",
        .reference = "Pan09",
        .limits = "A pixel is taken as flat: where surfaces bend within it, samples are lost or shadows are a bit off",
        .parameters = list_parameters(),
        .needs =
            [](const ParameterValues& values) {
                ParameterValues given = values;
                given.set("map_size", get_map_size(values));
                TechniqueNeeds needs = map_needs(given);
                needs.overscan_px = 1;  // facets reach past the pixels whose centres the views are fitted to
                return needs;
            },
        .truth = [](const ParameterValues&) { return TruthSpec{TruthKind::Pixel}; },
    };
}

std::unique_ptr<Technique> make_fsasm() { return std::make_unique<FSASM>(); }

}  // namespace shadow_layers
