// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// One position's visibility, times the light that the position brings to the receiver; and that light alone.
#include "stages/resolve_inputs.glsl"

layout(binding = kDepthMapUnit) uniform sampler2D visibility_tx;
uniform int u_is_area;
uniform vec3 u_centre_rel;  // of an area light
layout(location = 0) out vec2 weighted;

// Where a position brings no light at all (turned away, outside the cone) its answer counts only if all do the same.
const float kLeastWeight = 1e-20;

// In units of a light of the same power at the shape's centre that shines straight on the receiver: near 1 at any scale
// of the scene.
float find_weight(Receiver receiver) {
    if (receiver.fixed_visibility != kMapDecides) return kLeastWeight;
    float apart = length(receiver.to_light);
    float weight = dot(receiver.normal, receiver.to_light) / max(apart, 1e-30);
    if (u_is_area != 0) {
        // An area light is brighter face on, and near parts of it more than far ones.
        float nearness = min(length(u_centre_rel - receiver.position_rel) / max(apart, 1e-30), 1e4);
        weight *= receiver.to_light_axes.z / max(apart, 1e-30) * nearness * nearness;
    }
    return max(weight, kLeastWeight);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float weight = find_weight(fetch_receiver(pixel));
    weighted = weight * vec2(texelFetch(visibility_tx, pixel, 0).x, 1.0);
}
