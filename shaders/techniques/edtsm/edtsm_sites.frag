// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Sites of the hard shadow's border: pixels with a neighbour on the same surface that the map answers differently.
// Writes the mask, and for each site the point of the border that it stands for and the gap to the blocker.
// Defines: see penumbra_inputs.glsl.
// Based on: [Macedo17] 3.3. Differences: a site's neighbours are four, not eight, and the border is put between them:
// where the pixels round the site are those of a straight border, on that line; else in the middle of site and neighbour.
// So the ramp neither has a step of a pixel there nor repeats the steps of the pixels along the border.
#include "techniques/edtsm/penumbra_inputs.glsl"

layout(binding = kHardVisibilityUnit) uniform sampler2D visibility_tx;
#if FROM_LIGHT
layout(binding = kDepthMapUnit) uniform sampler2DArray depth_map_tx;
#endif
layout(std430, binding = kBorderStatsSlot) buffer StatsBlock {
    BorderStats stats;
};
layout(location = 0) out uint site;
layout(location = 1) out vec4 border;  // xyz: the point relative to the camera, or its place in the pixel; w: gap

struct Border {
    int count;  // neighbours across the border
    vec3 point_rel;
    vec2 offset_px;  // from the site's centre
    Receiver shadowed;
};

bool is_lit(ivec2 pixel) {
    return texelFetch(visibility_tx, clamp(pixel, ivec2(0), textureSize(visibility_tx, 0) - 1), 0).x >= 0.5;
}

ivec2 neighbour(int k) { return k < 2 ? ivec2(2 * k - 1, 0) : ivec2(0, 2 * k - 5); }

Border find_border(ivec2 pixel, bool lit) {
    Receiver receiver = fetch_receiver(pixel);
    float side = compute_footprint(camera, receiver.position_rel, receiver.normal).side;
    Border found = Border(0, vec3(0.0), vec2(0.0), receiver);
    for (int k = 0; k < 4; ++k) {
        // A line of one pixel has a border on both sides; their middle would be on none.
        bool is_opposite = (k & 1) == 1 && found.count > 0 && dot(found.offset_px, vec2(neighbour(k))) < 0.0;
        if (is_lit(pixel + neighbour(k)) == lit || is_opposite) continue;
        Receiver other = fetch_receiver(pixel + neighbour(k));
        if (receiver.fixed_visibility != kMapDecides || other.fixed_visibility != kMapDecides) continue;
        if (!is_one_surface(receiver.position_rel, receiver.normal, other.position_rel, other.normal, side)) continue;
        found.count += 1;
        found.point_rel += 0.5 * (receiver.position_rel + other.position_rel);
        found.offset_px += 0.5 * vec2(neighbour(k));
        if (lit) found.shadowed = other;
    }
    float share = 1.0 / float(max(found.count, 1));
    found.point_rel *= share;
    found.offset_px *= share;
    return found;
}

// Half the side of the square of pixels that a straight border is fitted to.
const int kFitRadius = 2;
// Pixels this near to the fitted line may be on either side of it.
const float kFitSlack_px = 0.75;

bool is_fit_pixel(Receiver receiver, ivec2 pixel, float side) {
    Receiver other = fetch_receiver(pixel);
    return other.fixed_visibility == kMapDecides &&
           is_one_surface(receiver.position_rel, receiver.normal, other.position_rel, other.normal, side);
}

// The line through the square round the pixel that leaves as much of it lit as there is: lit where dot(xy, p) > z, in
// pixels from the centre. A square of side W across which a line runs from side to side has the lit part
// 1/2 - z / (W max(|x|, |y|)).
vec3 fit_line(ivec2 pixel) {
    vec2 towards_lit = vec2(0.0);
    float lit_count = 0.0;
    for (int y = -kFitRadius; y <= kFitRadius; ++y)
        for (int x = -kFitRadius; x <= kFitRadius; ++x) {
            float lit = is_lit(pixel + ivec2(x, y)) ? 1.0 : 0.0;
            lit_count += lit;
            towards_lit += lit * vec2(x, y);
        }
    float width = float(2 * kFitRadius + 1);
    vec2 normal = towards_lit / max(length(towards_lit), 1e-6);
    float part = lit_count / (width * width);
    return vec3(normal, (0.5 - part) * width * max(abs(normal.x), abs(normal.y)));
}

// Are the pixels of the square those of the line, on one surface? Corners, lines and rims of things are not.
bool is_line(ivec2 pixel, vec3 line, Receiver receiver, float side) {
    bool fits = abs(line.z) <= 1.0 && line.xy != vec2(0.0);
    for (int y = -kFitRadius; y <= kFitRadius && fits; ++y)
        for (int x = -kFitRadius; x <= kFitRadius && fits; ++x) {
            float beyond = dot(line.xy, vec2(x, y)) - line.z;
            bool may_be = abs(beyond) <= kFitSlack_px || (beyond > 0.0) == is_lit(pixel + ivec2(x, y));
            fits = may_be && is_fit_pixel(receiver, pixel + ivec2(x, y), side);
        }
    return fits;
}

// Moves the border's point onto the straight border that the pixels round the site are of, if they are.
void straighten(ivec2 pixel, inout Border found) {
    Receiver receiver = fetch_receiver(pixel);
    Footprint footprint = compute_footprint(camera, receiver.position_rel, receiver.normal);
    vec3 line = fit_line(pixel);
    if (!is_line(pixel, line, receiver, footprint.side)) return;
    found.offset_px = line.xy * line.z;
    found.point_rel = receiver.position_rel + footprint.dx * found.offset_px.x + footprint.dy * found.offset_px.y;
}

#if FROM_LIGHT
// From the receiver to a blocker at `depth_rz` along the light's ray, in scene units; formed from the difference of the
// two depths, which a far light leaves few digits to.
float measure_gap(Receiver receiver, int layer, float receiver_rz, float blocker_rz) {
    vec3 view = penumbra.map_depths[layer].xyz;
    float range = view.y - view.x;
    if (view.z < 0.5) return range * (blocker_rz - receiver_rz);
    // depth = near far / (near + rz range); gap / distance = (receiver depth - blocker depth) / receiver depth.
    return length(receiver.to_light) * range * (blocker_rz - receiver_rz) / max(view.x + blocker_rz * range, 1e-30);
}

// Mean gap over the blockers in a square of texels.
float average_gap(Receiver receiver, int layer, MapPoint point, int radius) {
    float sum = 0.0, count = 0.0;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            vec2 centre = floor(point.texel) + vec2(x, y) + 0.5;
            float depth_rz = texelFetch(depth_map_tx, ivec3(centre, layer), 0).x;
            if (depth_rz <= reference_depth(point, centre - point.texel)) continue;
            sum += measure_gap(receiver, layer, point.depth_rz, depth_rz);
            count += 1.0;
        }
    return count > 0.0 ? max(sum / count, 0.0) : -1.0;
}

// A border that was moved within its texel may have its blocker in the next one.
float find_gap(Receiver receiver) {
    int layer = choose_layer(receiver);
    if (layer < 0) return 0.0;
    MapPoint point = locate_in_map(receiver, layer);
    float gap = average_gap(receiver, layer, point, 1);
    for (int once = gap < 0.0 ? 0 : 1; once < 1; ++once) gap = average_gap(receiver, layer, point, 2);
    return max(gap, 0.0);
}
#endif

// Tells how far the penumbra of this site reaches on the screen.
void count_site(Receiver receiver, float gap) {
    Footprint footprint = compute_footprint(camera, receiver.position_rel, receiver.normal);
    float width = penumbra_width(gap, length(receiver.to_light));
    float radius = (0.5 + penumbra.width.z) * width * slant_of(receiver);
    // Nearer to the camera the same length is more pixels.
    float nearest = camera.forward.w > 0.5 ? max(1.0 - radius / max(footprint.depth_vs, 1e-30), 0.25) : 1.0;
    float radius_px = radius / (footprint.side * nearest), width_px = width / footprint.side;
#if SCREEN_METRIC && !FROM_LIGHT
    width_px = penumbra.width.y;
#endif
#if SCREEN_METRIC
    radius_px = (0.5 + penumbra.width.z) * width_px;
#endif
    atomicAdd(stats.site_count, 1u);
    atomicMax(stats.largest_radius_bits, floatBitsToUint(min(radius_px, 1e9)));
    atomicMax(stats.largest_penumbra_bits, floatBitsToUint(min(width_px, 1e9)));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    bool lit = is_lit(pixel), differs = false;
    for (int k = 0; k < 4; ++k) differs = differs || is_lit(pixel + neighbour(k)) != lit;
    // Loops without trips, not branches, are what a software rasteriser skips.
    int count = 0;
    for (int once = differs ? 0 : 1; once < 1; ++once) {
        Border found = find_border(pixel, lit);
        count = found.count;
        if (count == 0) continue;
        straighten(pixel, found);
        float gap = 0.0;
#if FROM_LIGHT
        gap = find_gap(found.shadowed);
#endif
        border = vec4(SCREEN_METRIC == 1 ? vec3(found.offset_px, 0.0) : found.point_rel, gap);
        count_site(found.shadowed, gap);
    }
    if (count == 0) discard;
    site = 1u;
}
