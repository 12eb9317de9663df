// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/fsasm/facet_draw.h"

#include <algorithm>
#include <atomic>

#include "visibility/caster_clusters.h"
#include "visibility/caster_forms.h"

namespace shadow_layers {
namespace {

using facet_kernel::CasterTriangle;

// Triangles are set up and drawn in chunks, so that memory stays bounded.
constexpr std::size_t kClustersAtOnce = 1 << 9;
constexpr int kBandRows = 16;
// Clip units; places are in double, so this is far more than they are off.
constexpr double kMargin = 1e-9;

class PairDraw {
public:
    PairDraw(Engine& engine, const Frame& frame, const LightView& view, PixelTexelPairs& pairs,
             const facet_kernel::Samples& samples, const FacetContacts& contacts, std::span<SilhouetteFacet> facets)
        : engine_(engine),
          pairs_(pairs),
          samples_(samples),
          contacts_(contacts),
          facets_(facets),
          scene_(*frame.scene),
          casters_(*frame.scene, view) {}

    void draw() {
        const CasterGrid grid{pairs_.side, kMargin, pairs_.texels.data()};
        const auto clusters = list_clusters(engine_, scene_, casters_, grid);
        for (std::size_t first = 0; first < clusters.size(); first += kClustersAtOnce) {
            engine_.check_cancelled();
            const std::size_t count = std::min(kClustersAtOnce, clusters.size() - first);
            triangles_ = set_up_clusters(engine_.threads(), casters_, std::span(clusters).subspan(first, count), grid);
            draw_bands();
        }
        engine_.count("triangle_texel_pairs", std::int64_t(texel_pairs_));
        engine_.count("visibility_evaluations", std::int64_t(evaluations_));
        engine_.count("contacts", std::int64_t(contact_count_));
    }

private:
    /// What one thread keeps while it draws.
    struct Band {
        const PairDraw& draw;
        NearCaster caster;  ///< the last one that came near a facet
    };

    void draw_bands() {
        const std::size_t bands = std::size_t((pairs_.side + kBandRows - 1) / kBandRows);
        std::vector<std::vector<std::uint32_t>> orders(bands);
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            const tile_kernel::TileExtent& extent = triangles_[i].extent;
            for (int band = extent.row_begin / kBandRows; band * kBandRows < extent.row_end; ++band)
                orders[std::size_t(band)].push_back(std::uint32_t(i));
        }
        engine_.threads().parallel_for(bands, 1, [&](std::size_t band, std::size_t) {
            draw_band(orders[band], int(band) * kBandRows, std::min(int(band + 1) * kBandRows, pairs_.side));
        });
    }

    void draw_band(const std::vector<std::uint32_t>& order, int row_begin, int row_end) {
        const facet_kernel::PairTexels texels{pairs_.side, 1.0 / pairs_.side, pairs_.texels.data(), pairs_.pairs.data(),
                                              pairs_.facets.data()};
        Band state{*this, {}};
        facet_kernel::Answers answers{&PairDraw::settle, &state, 0, 0, 0};
        build_.draw_triangles(triangles_.data(), order.data(), order.size(), row_begin, row_end, texels, samples_,
                              answers);
        texel_pairs_ += answers.texel_pairs;
        evaluations_ += answers.evaluations;
        contact_count_ += answers.contacts;
    }

    static void settle(void* context, const CasterTriangle& caster, const facet_kernel::LightFacet& facet,
                       const facet_kernel::Conditions& conditions,
                       const std::uint32_t (&occluded)[facet_kernel::kWords], facet_kernel::FacetPair& pair) {
        Band& band = *static_cast<Band*>(context);
        const PairDraw& self = band.draw;
        // Pairs come triangle by triangle.
        if (band.caster.ids.instance != caster.instance || band.caster.ids.triangle != caster.triangle)
            band.caster = self.contacts_.describe({caster.instance, caster.triangle});
        self.contacts_.settle(self.facets_[facet.facet], band.caster, facet, conditions, occluded, pair);
    }

    Engine& engine_;
    PixelTexelPairs& pairs_;
    const facet_kernel::Samples& samples_;
    const FacetContacts& contacts_;
    std::span<SilhouetteFacet> facets_;
    const Scene& scene_;
    const CasterRow casters_;
    std::vector<CasterTriangle> triangles_;
    const facet_kernel::Build& build_ = facet_kernel::choose_build();
    std::atomic<std::uint64_t> texel_pairs_{0}, evaluations_{0}, contact_count_{0};
};

}  // namespace

void draw_casters_over_pairs(Engine& engine, const Frame& frame, const LightView& view, PixelTexelPairs& pairs,
                             const facet_kernel::Samples& samples, const FacetContacts& contacts,
                             std::span<SilhouetteFacet> facets) {
    PairDraw(engine, frame, view, pairs, samples, contacts, facets).draw();
    for (const facet_kernel::FacetPair& pair : pairs.pairs) {
        SilhouetteFacet& facet = facets[pairs.facets[pair.light_facet].facet];
        for (std::size_t word = 0; word < kMaskWords; ++word) {
            facet.occluded.words[word] |= pair.occluded[word];
            facet.cut.words[word] |= pair.cut[word];
        }
    }
}

}  // namespace shadow_layers
