// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Extended shadow maps: in shadow if behind the depth map's nearest texel, or behind that texel's edge and inside of
// the shifted border, which bilinear interpolation of the edge values makes straight.
// Based on: [Bujnak04] 3.2. Differences: docs/techniques/extsm.md.
#include "techniques/extsm/extsm_inputs.glsl"

// A receiver within a quad is at most so many texels from the edge, as far as it lies inside the caster's outline: a
// face that ends at the edge must not take it for something before it.
const float kInsideRadius = kTexelDiagonal + kShiftTexels;
// A texel with a smaller value lies so far outside that the border can't pass through it, even on a quad of least
// width; without this bound, texels beyond the quad's outer end, which count as inside, would leave dots of shadow
// there.
const float kFarOutside = 1.0 - kNoEdgeValue;

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 corner = floor(point.texel - 0.5);
    vec2 at = point.texel - 0.5 - corner;
    vec2 centre = floor(point.texel) + 0.5;
    float reference = max(point.depth_rz + point.rounding, 0.0);
    float lit = texture(depth_map_tx, vec4(centre * light.map.y, layer, reference));

    EdgeFootprint edges = fetch_footprint(corner, layer);
    float value = dot(bilinear_weights(at), mix(vec4(kNoEdgeValue), edges.values, edges.held));
    int nearest = (at.x >= 0.5 ? 1 : 0) + (at.y >= 0.5 ? 2 : 0);
    float before = point.depth_rz + point.rounding + kInsideRadius * length(point.gradient);
    bool behind_edge =
        edges.held[nearest] && edges.depths_rz[nearest] > before && edges.values[nearest] >= kFarOutside;
    bool shadowed = lit < 0.5 || (behind_edge && value > 1.0 - kShiftedCoordinate);
    visibility = combine_visibility(receiver, layer, float(!shadowed));
}
