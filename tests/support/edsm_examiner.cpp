// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/edsm_examiner.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/packing.hpp>
#include <optional>
#include <stdexcept>

#include "edge_map.h"
#include "lights/facing.h"
#include "support/edsm_segments.h"
#include "techniques/edsm/edge_distance_map.h"
#include "techniques/edsm/edsm.h"
#include "visibility/occlusion_rule.h"

namespace shadow_layers::testing {
namespace {

// A half float keeps a distance to 1/500 texel (shaders/shared/edge_map.h), and a normal to as much of its length.
constexpr double kStoredDistance = 0.01, kStoredNormal = 0.01;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// A receiver as a map sees it.
struct Footprint {
    std::size_t view = 0;
    glm::dvec2 place{0.0}, corner{0.0};  ///< texels; of the first of the four texels
    double depth = 0, rounding = 0;
    glm::dvec2 slope{0.0};  ///< of the receiver's plane, depth_rz per texel

    double depth_at(glm::dvec2 texel) const { return std::max(depth + glm::dot(slope, texel - place), 0.0); }
    glm::dvec2 centre(int k) const { return corner + 0.5 + glm::dvec2(k & 1, k >> 1); }
    glm::dvec2 at() const { return place - 0.5 - corner; }
};

/// Is it the line that a texel with this centre keeps?
bool is_line_of(const KeptEdge& kept, glm::dvec2 centre, const EdgeSegment& segment) {
    const glm::dvec2 along = segment.direction();
    const double distance = std::abs(cross(along, centre - glm::dvec2(segment.start)));
    return std::abs(glm::dot(kept.normal, along)) < kStoredNormal &&
           std::abs(distance - std::abs(kept.distance)) < kStoredDistance;
}

/// Bound of the float error of a receiver's depth, as shaders/lib/projection_lib.glsl has it.
double find_rounding(const glm::dmat4& lc_from_rel, const glm::dvec3& receiver_rel, const glm::dvec4& lc) {
    const glm::dvec4 weight(glm::abs(receiver_rel), 1.0);
    double row_z = 0, row_w = 0;
    for (int column = 0; column < 4; ++column) {
        row_z += std::abs(lc_from_rel[column].z) * weight[column];
        row_w += std::abs(lc_from_rel[column].w) * weight[column];
    }
    return (row_z + std::abs(lc.z / lc.w) * row_w) / (2097152.0 * std::abs(lc.w));
}

}  // namespace

struct EDSMExaminer::Impl {
    const TechniqueRun& run;
    const Light& light;
    const LightSample& position;
    const truth::RayOracle& oracle;
    const OcclusionRule rule;
    int size = 0;
    std::vector<float> depths;                       ///< as in the map, layer by layer
    std::vector<std::uint16_t> edges;                ///< likewise, four half floats a texel
    std::vector<std::vector<EdgeSegment>> segments;  ///< by view

    Impl(const TechniqueRun& run_, const Light& light_, const truth::RayOracle& oracle_)
        : run(run_), light(light_), position(run_.positions.at(0)), oracle(oracle_), rule(*run_.frame, position) {}

    /// Of a cube the face that the receiver lies behind, else the only view. None: no caster is before the receiver.
    std::optional<std::size_t> choose_view(const glm::dvec3& receiver_ws) const {
        if (position.choice.kind.x == kOneView) return 0;
        const glm::dvec3 way = glm::transpose(position.axes_ws) * (receiver_ws - position.position_ws);
        const glm::dvec3 length = glm::abs(way);
        const int axis = length.x >= length.y && length.x >= length.z ? 0 : length.y >= length.z ? 1 : 2;
        const int face = 2 * axis + (way[axis] >= 0 ? 0 : 1);
        const auto& views = position.views;
        const auto found = std::find_if(views.begin(), views.end(), [&](const LightView& v) { return v.face == face; });
        return found == views.end() ? std::nullopt : std::optional(std::size_t(found - views.begin()));
    }

    std::optional<Footprint> locate(std::size_t pixel) const {
        const Frame& frame = *run.frame;
        const glm::dvec3 receiver_rel = rule.find_receiver(pixel), receiver_ws = receiver_rel + frame.origin_ws;
        const auto view = choose_view(receiver_ws);
        if (!view) return std::nullopt;
        Footprint print;
        print.view = *view;
        const glm::dmat4& lc_from_ws = position.views[print.view].lc_from_ws;
        const glm::dvec4 lc = lc_from_ws * glm::dvec4(receiver_ws, 1.0);
        const double half = 0.5 * size;
        print.place = (glm::dvec2(lc) / lc.w + 1.0) * half;
        print.depth = lc.z / lc.w;
        print.corner = glm::floor(print.place - 0.5);
        // The plane's coefficients go by the inverse's transpose; in clip space depth is linear over it.
        const auto corners = oracle.get_corners(frame.ids[pixel]);
        const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
        const glm::dvec4 plane_ws(normal, -glm::dot(normal, receiver_ws));
        const glm::dvec4 plane = glm::transpose(glm::inverse(lc_from_ws)) * plane_ws;
        print.slope = glm::clamp(-glm::dvec2(plane) / (plane.z * half), -1.0, 1.0);
        print.rounding = find_rounding(glm::translate(lc_from_ws, frame.origin_ws), receiver_rel, lc);
        return print;
    }

    std::size_t index(const Footprint& print, glm::dvec2 texel) const {
        const glm::ivec2 inside = glm::clamp(glm::ivec2(glm::floor(texel)), glm::ivec2(0), glm::ivec2(size - 1));
        return (print.view * std::size_t(size) + std::size_t(inside.y)) * std::size_t(size) + std::size_t(inside.x);
    }

    /// The map's test of the k-th centre, by the rule of projection_lib.glsl.
    bool test(const Footprint& print, int k) const {
        const glm::dvec2 centre = print.centre(k);
        const double reference = std::max(print.depth_at(centre), print.depth) + print.rounding;
        return float(std::max(reference, 0.0)) >= depths[index(print, centre)];
    }

    /// Does light reach the receiver's plane at a place of the map?
    bool is_plane_lit(const Footprint& print, std::size_t pixel, glm::dvec2 texel) const {
        const glm::dvec2 ndc = texel / (0.5 * size) - 1.0;
        const glm::dvec4 ws =
            glm::inverse(position.views[print.view].lc_from_ws) * glm::dvec4(ndc, print.depth_at(texel), 1.0);
        return !oracle.is_occluded(glm::dvec3(ws) / ws.w, run.frame->ids[pixel], light, position,
                                   truth::OwnSurface::WholePlane);
    }

    KeptEdge read_edge(const Footprint& print, int k) const {
        const std::uint16_t* stored = &edges[4 * index(print, print.centre(k))];
        const auto value = [&](int component) { return double(glm::unpackHalf1x16(stored[component])); };
        const double scale = compute_edge_depth_scale(position.views[print.view]);
        const double receiver_depth = std::min(print.depth * scale, double(kGreatestEdgeDepth));
        return {{value(0), value(1)}, value(2), value(3) * (1.0 + double(kEdgeDepthRounding)) >= receiver_depth};
    }

    /// Is the plane lit just outside of the edge and dark just inside, somewhere on it?
    bool is_border(const Footprint& print, std::size_t pixel, const EdgeSegment& segment) const {
        const glm::dvec2 along = segment.direction(), outside = kBesideEdge * glm::dvec2(along.y, -along.x);
        for (const double f : {0.5, 0.15, 0.85}) {
            const glm::dvec3 at = glm::mix(segment.start, segment.end, f);
            const glm::dvec2 place(at);
            if (at.z > print.depth_at(place) && is_plane_lit(print, pixel, place + outside) &&
                !is_plane_lit(print, pixel, place - outside))
                return true;
        }
        return false;
    }

    /// The parts of border edges in the footprint.
    std::vector<EdgeSegment> find_borders(const Footprint& print, std::size_t pixel) const {
        std::vector<EdgeSegment> borders;
        for (EdgeSegment segment : segments[print.view])
            if (cut_at_square(segment, print.corner + 0.5, 1.0) &&
                glm::distance(glm::dvec2(segment.start), glm::dvec2(segment.end)) >= kSamePlace &&
                is_border(print, pixel, segment))
                borders.push_back(segment);
        return borders;
    }
};

EDSMExaminer::EDSMExaminer(TechniqueRunner& runner, const TechniqueRun& run, const ParameterValues& parameters,
                           const Light& light, const truth::RayOracle& oracle)
    : impl_(std::make_unique<Impl>(run, light, oracle)) {
    Engine& engine = runner.engine();
    const Scene& scene = *run.frame->scene;
    const ParameterValues values = resolve_parameters(find_technique_descriptor("edsm"), parameters);
    if (values.get_enum("reading") != "improved" || values.get_float("softness") > 0)
        throw std::invalid_argument("only hard shadows by the improved reading are examined");
    const auto depth_map = render_depth_map(engine, scene, impl_->position);
    const auto edge_map =
        render_edge_distance_map(engine, scene, impl_->position, *depth_map, edsm_edge_options(values));
    impl_->size = depth_map->texture->width();
    impl_->depths = depth_map->texture->download<float>();
    impl_->edges = edge_map->texture->download<std::uint16_t>();
    for (const LightView& view : impl_->position.views)
        impl_->segments.push_back(find_edge_segments(scene, impl_->position, view, engine.threads()));
}

EDSMExaminer::~EDSMExaminer() = default;

bool EDSMExaminer::replay(std::size_t pixel) const {
    const std::optional<Footprint> print = impl_->locate(pixel);
    if (!print) return true;
    std::array<bool, 4> tested{};
    std::array<KeptEdge, 4> kept;
    for (int k = 0; k < 4; ++k)
        tested[std::size_t(k)] = impl_->test(*print, k), kept[std::size_t(k)] = impl_->read_edge(*print, k);
    return reconstruct_lit(tested, kept, print->at());
}

FootprintFacts EDSMExaminer::find_facts(std::size_t pixel, bool lit) const {
    const Footprint print = impl_->locate(pixel).value();
    const std::vector<EdgeSegment> borders = impl_->find_borders(print, pixel);
    FootprintFacts facts;
    facts.lit = lit;
    std::array<KeptEdge, 4> kept;
    for (int k = 0; k < 4; ++k) {
        const std::size_t at = std::size_t(k);
        facts.tested[at] = impl_->test(print, k);
        facts.exact[at] = impl_->is_plane_lit(print, pixel, print.centre(k));
        kept[at] = impl_->read_edge(print, k);
        if (!kept[at].relevant) continue;
        const bool is_border = std::any_of(borders.begin(), borders.end(), [&](const EdgeSegment& border) {
            return is_line_of(kept[at], print.centre(k), border);
        });
        (is_border ? facts.holds_border : facts.holds_another) = true;
    }
    facts.right_with_exact_tests = reconstruct_lit(facts.exact, kept, print.at()) == lit;
    facts.border_edges = int(borders.size());
    facts.border_chains = count_chains(borders);
    facts.border_ends =
        std::any_of(borders.begin(), borders.end(), [](const EdgeSegment& s) { return s.starts || s.ends; });
    return facts;
}

EDSMCauses& EDSMCauses::operator+=(const EDSMCauses& other) {
    compared += other.compared, wrong += other.wrong, not_replayed += other.not_replayed;
    for (std::size_t k = 0; k < by_cause.size(); ++k) by_cause[k] += other.by_cause[k];
    return *this;
}

EDSMCauses count_edsm_causes(TechniqueRunner& runner, const SceneView& view, const truth::RayOracle& oracle,
                             const ParameterValues& parameters, std::size_t light) {
    const TechniqueRun run = runner.render(view, "edsm", parameters, light);
    const Light& source = view.scene->lights[light];
    const LightSample& position = run.positions.at(0);
    EDSMCauses causes;
    if (position.views.empty() || !source.casts_shadow) return causes;
    const auto truth = oracle.compute_visibility(*run.frame, source, position, &runner.engine().threads());
    const EDSMExaminer examiner(runner, run, parameters, source, oracle);
    const FacingRule facing(*run.frame, source, position);
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
        if (facing.classify(pixel) != Facing::Undecided) continue;
        ++causes.compared;
        const bool lit = truth[pixel] >= 0.5f;
        if (lit == (run.visibility()[pixel] >= 0.5f)) continue;
        ++causes.wrong;
        causes.not_replayed += examiner.replay(pixel) == lit;
        ++causes.by_cause[std::size_t(decide_cause(examiner.find_facts(pixel, lit)))];
    }
    return causes;
}

}  // namespace shadow_layers::testing
