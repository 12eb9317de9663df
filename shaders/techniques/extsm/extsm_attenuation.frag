// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility times a function of the squared distance to the light, one dot product per receiver as in [Bujnak04] 3.2.
// Defines: ATTENUATION (1: linear in the distance, 2: in its square).
#include "stages/resolve_inputs.glsl"

layout(binding = kDepthMapUnit) uniform sampler2D visibility_tx;
layout(location = 0) uniform float u_range;  // scene units
layout(location = 0) out float intensity;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Receiver receiver = fetch_receiver(pixel);
    vec3 scaled = receiver.to_light / u_range;
    float x = light.place_rel.w * min(dot(scaled, scaled), 1.0);  // a sun is equally far from all
    float factor = ATTENUATION == 1 ? 1.0 - sqrt(x) : 1.0 - x;
    bool is_surface = texelFetch(position_tx, pixel, 0).w > 0.5;
    intensity = texelFetch(visibility_tx, pixel, 0).x * (is_surface ? factor : 1.0);
}
