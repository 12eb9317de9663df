// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow silhouette maps: four depth tests; where they disagree, the test of the corner whose part of the cell the
// receiver lies in. Based on: [Sen03].
#include "stages/resolve_inputs.glsl"
#include "techniques/sssm/silhouette_map_lib.glsl"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(binding = kEdgeMapUnit) uniform sampler2DArray silhouette_map_tx;
layout(location = 0) out float visibility;

float test_texel(MapPoint point, int layer, vec2 centre) {
    return texture(depth_map_tx, vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
}

vec2 fetch_point(ivec2 cell, ivec2 step, int layer) {
    ivec2 inside = clamp(cell + step, ivec2(0), ivec2(int(light.map.x) - 1));
    return texelFetch(silhouette_map_tx, ivec3(inside, max(layer, 0)), 0).xy + vec2(step);
}

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 corner = floor(point.texel - 0.5);
    vec4 lit;
    for (int k = 0; k < 4; ++k) lit[k] = test_texel(point, layer, corner + 0.5 + vec2(k & 1, k >> 1));
    float from_map = lit.x;
    bool mixed = receiver.fixed_visibility == kMapDecides && !(lit.x == lit.y && lit.x == lit.z && lit.x == lit.w);
    // A software rasteriser masks branches but leaves a loop without trips.
    for (int k = mixed ? 0 : 1; k < 1; ++k) {
        ivec2 cell = ivec2(corner);
        vec2 own = fetch_point(cell, ivec2(0), layer);
        int quadrant = find_quadrant(point.texel - 0.5 - corner, own, fetch_point(cell, ivec2(-1, 0), layer),
                                     fetch_point(cell, ivec2(1, 0), layer), fetch_point(cell, ivec2(0, -1), layer),
                                     fetch_point(cell, ivec2(0, 1), layer));
        from_map = lit[quadrant];
    }
    visibility = combine_visibility(receiver, layer, from_map);
}
