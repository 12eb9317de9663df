// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Mean filter along rows or columns, of each pixel's own radius; it takes no value over an edge in depth.
// Defines: AXIS (0: rows, 1: columns, which writes the visibility alone), SCREEN_METRIC (1: sizes are in pixels).
// Based on: [Macedo17] 3.4, Eq. 2 and 3. Differences: a size in the scene is measured on the surface, which may be seen
// at a slant, along each axis; the window ends within pixels, so that it follows the distance without steps; what lies
// on another surface is decided by the centre's plane and the pixel's size, and counts as the centre.
#include "techniques/edtsm/pixel_footprint_lib.glsl"
#include "techniques/edtsm/penumbra_params.h"
#include "shared/light_params.h"

layout(std140, binding = kPixelCameraSlot) uniform CameraBlock {
    PixelCamera camera;
};
layout(binding = kPositionUnit) uniform sampler2D position_tx;
layout(binding = kNormalUnit) uniform sampler2D normal_tx;
layout(binding = kSoftUnit) uniform sampler2D soft_tx;
#if AXIS
layout(location = 0) out float filtered;
#else
layout(location = 0) out vec4 filtered;
#endif

const float kLargestRadiusPx = 256.0;
const float kBend = 0.25;   // how far a curved surface may leave the centre's plane, per pixel of distance

// Half the window in pixels, and the depth that is linear over a plane in the picture (1 / depth with perspective, else
// depth): its step per pixel along the axis, and what one pixel side along the view axis makes of it.
struct Window {
    float radius_px, depth_step, depth_side;
};

Window make_window(ivec2 pixel, vec4 centre) {
    Footprint footprint =
        compute_footprint(camera, texelFetch(position_tx, pixel, 0).xyz, texelFetch(normal_tx, pixel, 0).xyz);
    float scale = camera.forward.w > 0.5 ? -centre.z * centre.z : 1.0;
#if SCREEN_METRIC
    float radius_px = centre.y;
#else
    float radius_px = centre.y / max(length(AXIS == 0 ? footprint.dx : footprint.dy), 1e-30);
#endif
    return Window(min(radius_px, kLargestRadiusPx), scale * footprint.depth_step[AXIS], abs(scale) * footprint.side);
}

float average(ivec2 pixel, vec4 centre) {
    Window window = make_window(pixel, centre);
    ivec2 last = textureSize(soft_tx, 0) - 1;
    float sum = centre.x;
    int count = int(ceil(window.radius_px - 0.5));
    for (int k = 1; k <= count; ++k) {
        float weight = min(window.radius_px + 0.5 - float(k), 1.0);
        for (int direction = -1; direction <= 1; direction += 2) {
            ivec2 at = pixel;
            at[AXIS] += k * direction;
            vec4 tap = texelFetch(soft_tx, clamp(at, ivec2(0), last), 0);
            float off_plane = abs(tap.z - centre.z - window.depth_step * float(k * direction));
            bool is_same = tap.w > 0.5 && off_plane <= window.depth_side * (1.0 + kBend * float(k));
            sum += weight * (is_same ? tap.x : centre.x);
        }
    }
    // A window within the pixel has no taps and weighs 1.
    return sum / max(2.0 * window.radius_px, 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 centre = texelFetch(soft_tx, pixel, 0);
    for (int once = centre.y > 0.0 ? 0 : 1; once < 1; ++once) centre.x = average(pixel, centre);
#if AXIS
    filtered = centre.x;
#else
    filtered = centre;
#endif
}
