// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What moment maps store, and the bounds that their averages give on the part of a footprint that a receiver can see
// from the light. Depths here are linear, -1 at the near plane and 1 at the far plane.
// Based on: [Donnelly06], [Annen08], [Lauritzen08], [Peters15], [Peters17].
// Differences: depths round zero everywhere; the bound of four moments takes back what its bias lends (block_bound).

// --- what a texel stores: vec4 f(depth, exponents), any linear filter may follow ---

vec4 encode_variance(float depth, vec2 exponents) { return vec4(depth, depth * depth, 0.0, 0.0); }

// In [0, 1], the whole of it used.
vec4 encode_variance_fixed(float depth, vec2 exponents) {
    return vec4(0.5 * depth + 0.5, 1.0 - depth * depth, 0.0, 0.0);
}
vec2 decode_variance_fixed(vec2 stored) { return vec2(2.0 * stored.x - 1.0, 1.0 - stored.y); }

// [Annen08] Eq. 3
vec4 encode_exponential(float depth, vec2 exponents) { return vec4(exp(exponents.x * depth), 0.0, 0.0, 0.0); }

// [Lauritzen08] 4.2: two warps that keep the order of depths, each with its square.
vec2 warp_depth(float depth, vec2 exponents) {
    return vec2(exp(exponents.x * depth), -exp(-exponents.y * depth));
}
vec4 encode_exponential_variance(float depth, vec2 exponents) {
    vec2 warped = warp_depth(depth, exponents);
    return vec4(warped, warped * warped).xzyw;
}

vec4 encode_moments(float depth, vec2 exponents) {
    float square = depth * depth;
    return vec4(depth, square, square * depth, square * square);
}

// [Peters17]: an affine map of the moments that fills [0, 1]^4. It takes odd and even moments apart: the powers are
// nearly the same function otherwise, and 16 bits could not tell them.
vec4 pack_moments(vec4 b) {
    return vec4(1.5 * b.x - 2.0 * b.z + 0.5, 4.0 * (b.y - b.w), 0.8660254038 * b.x - 0.3849001795 * b.z + 0.5,
                0.5 * (b.y + b.w));
}
vec4 unpack_moments(vec4 p) {
    vec2 odd = p.xz - 0.5;
    return vec4(-odd.x / 3.0 + 1.7320508076 * odd.y, 0.125 * p.y + p.w, -0.75 * odd.x + 1.2990381057 * odd.y,
                -0.125 * p.y + p.w);
}
vec4 encode_moments_fixed(float depth, vec2 exponents) { return pack_moments(encode_moments(depth, exponents)); }

// --- bounds ---

// [Donnelly06] Eq. 5, Chebyshev's inequality with one tail: the most of a distribution that lies at `depth` or farther.
// For two surfaces with the receiver on the farther one it is the true part.
float chebyshev_bound(float mean, float mean_square, float depth, float least_variance) {
    float variance = max(mean_square - mean * mean, least_variance);
    float before = depth - mean;
    return before <= 0.0 ? 1.0 : variance / (variance + before * before);
}

// [Lauritzen08] 3.2 calls it light bleeding reduction: the lowest `amount` of the bound becomes full shadow.
float reduce_bleeding(float lit, float amount) { return clamp((lit - amount) / (1.0 - amount), 0.0, 1.0); }

// Roots of the quadratic whose zeros, with `depth`, are the places of the three masses that have the moments b and
// one mass at `depth`. [Peters15] Alg. 3, steps 2 and 3: H c = (1, depth, depth^2) by Cholesky's decomposition.
vec2 find_mass_places(vec4 b, float depth) {
    float variance = max(b.y - b.x * b.x, 1e-10);
    float l32_d22 = b.z - b.x * b.y;
    float d33_d22 = max((b.w - b.y * b.y) * variance - l32_d22 * l32_d22, 1e-30);
    float l32 = l32_d22 / variance;
    float y2 = depth - b.x;
    float y3 = depth * depth - b.y - l32 * y2;
    // c3 = y3 / D33 and so on, all times D33 = d33_d22 / variance: the zeros stay.
    float c3 = y3;
    float c2 = y2 * (d33_d22 / (variance * variance)) - l32 * c3;
    float c1 = d33_d22 / variance - b.x * c2 - b.y * c3;
    // Where c3 vanishes one place goes to infinity. The larger root of the numerator first: no cancellation.
    float root = sqrt(max(c2 * c2 - 4.0 * c3 * c1, 0.0));
    float q = -0.5 * (c2 + (c2 < 0.0 ? -root : root));
    float safe_c3 = abs(c3) > 1e-30 ? c3 : (c3 < 0.0 ? -1e-30 : 1e-30);
    float safe_q = abs(q) > 1e-30 ? q : (q < 0.0 ? -1e-30 : 1e-30);
    vec2 places = vec2(q / safe_c3, c1 / safe_q);
    return places.x < places.y ? places : places.yx;
}

// [Peters15] Alg. 3: the least part of a distribution with the moments b that lies before `depth` (Hamburger). Exact
// for two surfaces. `bias` mixes in the moments of a spread distribution, so that rounding can't leave what no distribution
// has; at most `bias` of the mass comes from there, and is taken off again.
float block_bound(vec4 moments, float depth, float bias) {
    vec4 b = mix(moments, vec4(0.0, 0.375, 0.0, 0.375), bias);
    vec2 z = find_mass_places(b, depth);
    float lo = depth - z.x, hi = depth - z.y, apart = z.y - z.x;
    float at_first = (depth * z.y - b.x * (depth + z.y) + b.y) / max(apart * lo, 1e-30);
    float at_depth = (z.x * z.y - b.x * (z.x + z.y) + b.y) / max(lo * hi, 1e-30);
    float before = depth <= z.x ? 0.0 : depth <= z.y ? at_first : 1.0 - at_depth;
    return clamp((before - bias) / (1.0 - bias), 0.0, 1.0);
}
