// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Second pass, second program: the walks, over the records of the pixels that see the texels on the way.
// Defines: those of revectorise_inputs.glsl; VISIBILITY_OF: a function of revectorisation_lib.glsl.
// Based on: [Bondarev14], as [Macedo16] 3 describes it.
#define REVECTORISATION_OWN_LOOK
#include "stages/revectorise_inputs.glsl"
#include "techniques/smsr2/smsr2_record.glsl"

layout(binding = kDiscontinuityUnit) uniform usampler2D discontinuity_tx;
layout(location = 1) uniform mat4 u_pixel_from_rel;  // w > 0: before the camera
layout(location = 0) out float visibility;

mat4 rel_from_lc;  // of this fragment's layer

// The pixel that sees the point of the receiver's plane which lies in `texel` as the fragment lies in its own.
ivec2 find_pixel(ivec2 texel) {
    vec2 offset = vec2(texel - fragment.texel);
    vec2 ndc = (fragment.point.texel + offset) * (2.0 * light.map.y) - 1.0;
    float depth_rz = fragment.point.depth_rz + dot(fragment.point.gradient, offset);
    vec4 rel = rel_from_lc * vec4(ndc, depth_rz, 1.0);
    vec4 pixel = u_pixel_from_rel * vec4(rel.xyz / rel.w, 1.0);
    return pixel.w > 0.0 ? ivec2(clamp(floor(pixel.xy / pixel.w), vec2(-1.0), vec2(65536.0))) : ivec2(-1);
}

// A texel that no pixel shows is tested from here, as smsr does.
uint look_at(ivec2 texel, uint sides, bool healed) {
    ivec2 pixel = find_pixel(texel);
    ivec2 size = textureSize(discontinuity_tx, 0);
    bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, size));
    uint record = texelFetch(discontinuity_tx, clamp(pixel, ivec2(0), size - 1), 0).x;
    if (inside && (record & ~kCodeBits) == place_bits(texel, fragment.layer)) return record & (kLitTexel | sides);
    return test_sides(texel, sides, healed);
}

void main() {
    fetch_fragment(ivec2(gl_FragCoord.xy));
    rel_from_lc = inverse(light.lc_from_rel[max(fragment.layer, 0)]);
    uint code = texelFetch(discontinuity_tx, ivec2(gl_FragCoord.xy), 0).x & kCodeBits;
    float walked = VISIBILITY_OF(code, fragment.texel, fragment.place, u_walk_limit);
    visibility = combine_visibility(fragment.receiver, fragment.layer, walked);
}
