// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// One depth test per receiver, against the view that it belongs to.
#include "stages/resolve_inputs.glsl"

layout(binding = kDepthMapUnit) uniform sampler2DArrayShadow depth_map_tx;
layout(location = 0) out float visibility;

void main() {
    Receiver receiver = fetch_receiver(ivec2(gl_FragCoord.xy));
    int layer = choose_layer(receiver);
    MapPoint point = locate_in_map(receiver, layer);
    vec2 centre = floor(point.texel) + 0.5;
    float lit = texture(depth_map_tx, vec4(centre * light.map.y, layer, reference_depth(point, centre - point.texel)));
    visibility = combine_visibility(receiver, layer, lit);
}
