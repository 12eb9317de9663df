// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Why edsm is wrong where it is: what decides the cause of a wrong pixel, without a scene. edsm_examiner.h finds the
// facts.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace shadow_layers::testing {

/// In the order in which they are asked for; the first that holds is the pixel's.
///
/// The footprint is the square between the four texel centres round a receiver. The receiver's plane is lit or dark at
/// a centre by what rays meet between it and the light: an exact depth test. A border edge is a silhouette edge that
/// crosses the footprint with the receiver's plane lit just outside of it and dark just inside.
enum class EDSMCause : std::uint8_t {
    BelowTexel,    ///< exact tests agree and are wrong together; a border edge crosses between the centres
    NoSilhouette,  ///< the same without a border edge: surfaces that cut each other, or turn away from the light
    DepthTest,     ///< one of the map's tests is wrong; with the exact ones the same edges give the right answer
    TwoEdges,      ///< border edges that don't meet in the footprint: a texel keeps one
    Corner,        ///< border edges with an end in the footprint
    Meeting,       ///< no border edge, though exact tests disagree: surfaces, also the receiver's own, cut its plane
    OtherEdge,     ///< one border edge; a texel holds another one, which is no border here
    NotStored,     ///< one border edge; no texel holds an edge that lies before the receiver
    Rounding,      ///< one border edge, and every edge that the texels hold is that one
};
inline constexpr int kEDSMCauseCount = 9;
const char* get_name(EDSMCause cause);

/// What decides the cause of a wrong pixel.
struct FootprintFacts {
    bool lit = false;                                  ///< the truth
    std::array<bool, 4> tested{}, exact{};             ///< lit by the map's tests, and by rays
    bool right_with_exact_tests = false;               ///< edsm's answer with `exact` in place of `tested`
    int border_edges = 0, border_chains = 0;           ///< chains: of border edges that meet in the footprint
    bool border_ends = false;                          ///< a border edge has an end in the footprint
    bool holds_another = false, holds_border = false;  ///< what the texels' edges are
};
EDSMCause decide_cause(const FootprintFacts& facts);

/// What a texel of the edge distance map says, as shaders/lib/edge_reconstruction_lib.glsl reads it.
struct KeptEdge {
    glm::dvec2 normal{0.0};  ///< unit, towards the lit side
    double distance = 0;     ///< of the texel's centre, signed, texels
    bool relevant = false;   ///< lies before the receiver
};

/// edsm's answer from tests and edges of the centres (0,0) (1,0) (0,1) (1,1) for a receiver at `at` between them:
/// shaders/techniques/edsm/edsm.frag in double.
bool reconstruct_lit(const std::array<bool, 4>& tested, const std::array<KeptEdge, 4>& kept, glm::dvec2 at);

}  // namespace shadow_layers::testing
