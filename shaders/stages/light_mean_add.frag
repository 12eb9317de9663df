// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The visibility of one light sample, times the light that the sample brings to the receiver; and that light alone.
#include "shared/light_weight.h"
#include "stages/resolve_inputs.glsl"

layout(binding = kDepthMapUnit) uniform sampler2D visibility_tx;
uniform int u_is_area;
uniform vec3 u_centre_rel;  // of an area light
layout(location = 0) out vec2 weighted;

// Where a sample brings no light at all (turned away, outside the cone) its answer counts only if all do the same.
const float kLeastWeight = 1e-20;

float find_weight(Receiver receiver) {
    if (receiver.fixed_visibility != kMapDecides) return kLeastWeight;
    float weight =
        find_light_weight(dot(receiver.normal, receiver.to_light), length(receiver.to_light), u_is_area != 0,
                          receiver.to_light_axes.z, length(u_centre_rel - receiver.position_rel));
    return max(weight, kLeastWeight);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float weight = find_weight(fetch_receiver(pixel));
    weighted = weight * vec2(texelFetch(visibility_tx, pixel, 0).x, 1.0);
}
