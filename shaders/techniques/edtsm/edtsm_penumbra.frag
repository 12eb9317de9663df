// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Penumbra intensity of the pixels that have a site in reach: distance to the border, normalised.
// Writes visibility, half the mean filter's size in the metric's units, the depth that the filter goes by, and whether
// the pixel may be a tap of others.
// Defines: see penumbra_inputs.glsl.
// Based on: [Macedo17] 3.3, Eq. 1. Differences: among the sites round the nearest one on the screen the one that is
// nearest on the surface (or across the light's rays) is looked for; a light's own size gives its own profile instead
// of the straight ramp; the next borders on the same line count too.
#include "techniques/edtsm/penumbra_inputs.glsl"
#include "techniques/edtsm/light_cut_lib.glsl"
#include "lib/nearest_site_lib.glsl"

layout(binding = kHardVisibilityUnit) uniform sampler2D visibility_tx;
layout(binding = kBorderUnit) uniform sampler2D border_tx;
layout(binding = kNearestUnit) uniform usampler2D nearest_tx;
layout(location = 0) out vec4 soft;

struct Site {
    bool found;
    ivec2 pixel;
    vec3 offset;     // from the border's point to the receiver, scene units
    float distance;  // in the metric's units
    float gap;
};

uint find_nearest(vec2 pixel) {
    return texelFetch(nearest_tx, clamp(ivec2(round(pixel)), ivec2(0), textureSize(nearest_tx, 0) - 1), 0).x;
}

// What counts of a way on the surface. From the light, how far two places are apart across its rays: a surface that it
// grazes has a longer penumbra along them, and another border point answers for it.
vec3 across(vec3 offset, Receiver receiver) {
#if FROM_LIGHT
    vec3 ahead = normalize(receiver.to_light);
    return offset - ahead * dot(ahead, offset);
#else
    return offset;
#endif
}

// Keeps a site if it is on the receiver's surface and nearer than the best so far.
void try_site(ivec2 site, ivec2 pixel, Receiver receiver, float side, inout Site best) {
    vec4 border = texelFetch(border_tx, site, 0);
    vec3 site_rel = texelFetch(position_tx, site, 0).xyz;
    vec3 site_normal = texelFetch(normal_tx, site, 0).xyz;
#if SCREEN_METRIC
    vec3 offset = receiver.position_rel - site_rel;
    float distance = length(vec2(pixel - site) - border.xy);
#else
    vec3 offset = receiver.position_rel - border.xyz;
    float distance = length(across(offset, receiver));
#endif
    bool is_better = (!best.found || distance < best.distance) &&
                     is_one_surface(receiver.position_rel, receiver.normal, site_rel, site_normal, side);
    if (is_better) best = Site(true, site, offset, distance, border.w);
}

// The border's foot point is nearest on the screen, where the border crosses the way to it at a right angle. On the
// surface the right angle is elsewhere: go along the border's tangent to where it would be, and take the site there.
// Where the border bends, the way between the last two sites is the tangent.
void follow_border(ivec2 pixel, Receiver receiver, Footprint footprint, inout Site best) {
    const int steps = 2;
    ivec2 last = best.pixel;
    vec2 away = vec2(pixel - last);
    vec2 tangent = vec2(-away.y, away.x);
    int count = away == vec2(0.0) ? 0 : steps;
    for (int k = 0; k < count; ++k) {
        vec3 along = across(footprint.dx * tangent.x + footprint.dy * tangent.y, receiver);
        vec3 apart = across(footprint.dx * away.x + footprint.dy * away.y, receiver);
        float share = dot(apart, along) / max(dot(along, along), 1e-30);
        uint next = find_nearest(vec2(last) + share * tangent);
        if (!is_site(next) || unpack_site(next) == last) break;
        tangent = vec2(unpack_site(next) - last);
        last = unpack_site(next);
        away = vec2(pixel - last);
        try_site(last, pixel, receiver, footprint.side, best);
    }
}

Site find_site(ivec2 pixel, Receiver receiver, Footprint footprint) {
    Site best = Site(false, pixel, vec3(0.0), 0.0, 0.0);
    ivec2 first = unpack_site(texelFetch(nearest_tx, pixel, 0).x);
    try_site(first, pixel, receiver, footprint.side, best);
    // A border on another surface hides the own one: look on the other side of the pixel.
    for (int k = 1; k <= (best.found ? 0 : 2); ++k) {
        uint next = find_nearest(vec2(pixel) + float(k) * vec2(pixel - first));
        if (is_site(next)) try_site(unpack_site(next), pixel, receiver, footprint.side, best);
    }
#if !SCREEN_METRIC
    if (best.found) follow_border(pixel, receiver, footprint, best);
#endif
    return best;
}

// Part of the light that is not behind the blocker's edge, half of it at least: the edge is taken as straight, at `gap`
// before the border's point, and across the light's rays.
float compute_light_fraction(Receiver receiver, Site site) {
    vec3 border_to_light = receiver.to_light + light.place_rel.w * site.offset;
    vec3 to_blocker = normalize(border_to_light) * site.gap - site.offset;
    vec3 tangent = cross(receiver.to_light, site.offset);
    float scale = max(length(to_blocker) * length(tangent), 1e-30);
    vec3 plane = cross(to_blocker, tangent) / scale;
    int shape = int(penumbra.light_u.w);
    vec3 half_u = penumbra.light_u.xyz, half_v = penumbra.light_v.xyz;
    if (penumbra.light_v.w < 0.5) {
        // A ball or the sun looks like a disc from everywhere.
        vec3 ahead = normalize(receiver.to_light);
        float radius = half_light_size(length(receiver.to_light));
        half_u = orthogonal_to(ahead) * radius;
        half_v = cross(ahead, half_u);
    }
    return fraction_beside_plane(shape, plane, receiver.to_light, half_u, half_v);
}

float find_width(Receiver receiver, float gap, float side) {
#if SCREEN_METRIC
    return FROM_LIGHT == 1 ? penumbra_width(gap, length(receiver.to_light)) / side : penumbra.width.y;
#else
    return penumbra_width(gap, length(receiver.to_light));
#endif
}

// Part of the light on the receiver's side of a border.
float find_share(Receiver receiver, Site site, float side) {
    if (!site.found) return 1.0;
#if FROM_LIGHT && !SCREEN_METRIC
    return compute_light_fraction(receiver, site);
#else
    // [Macedo17] Eq. 1
    return 0.5 + min(site.distance / max(find_width(receiver, site.gap, side), 1e-30), 0.5);
#endif
}

// From the receiver to the border's point, in pixels: the way on the surface, in terms of the steps to the next pixels.
vec2 find_way_px(ivec2 pixel, Footprint footprint, Site site) {
#if SCREEN_METRIC
    return vec2(site.pixel - pixel) + texelFetch(border_tx, site.pixel, 0).xy;
#else
    float xx = dot(footprint.dx, footprint.dx), yy = dot(footprint.dy, footprint.dy);
    float xy = dot(footprint.dx, footprint.dy);
    vec2 along = -vec2(dot(footprint.dx, site.offset), dot(footprint.dy, site.offset));
    return vec2(yy * along.x - xy * along.y, xx * along.y - xy * along.x) / max(xx * yy - xy * xy, 1e-30);
#endif
}

// The next border on the line through the receiver and the nearest border's point: beyond that point (`direction` 1),
// or behind the receiver (-1). Both states between the receiver and `reach` are looked at in a few places.
Site find_next_border(ivec2 pixel, Receiver receiver, Footprint footprint, Site nearest, float radius, float direction,
                      bool sought) {
    Site next = Site(false, pixel, vec3(0.0), 0.0, 0.0);
    vec2 per_unit = direction * find_way_px(pixel, footprint, nearest) / max(nearest.distance, 1e-30);
    ivec2 last = textureSize(visibility_tx, 0) - 1;
    float share = 0.125;
    ivec2 at = pixel;
    bool is_other = false;
    for (int k = nearest.distance < radius ? 0 : 4; k < 4 && !is_other; ++k, share *= 2.0) {
        vec2 place = vec2(pixel) + per_unit * mix(nearest.distance, radius, share);
        at = clamp(ivec2(round(place)), ivec2(0), last);
        is_other = (texelFetch(visibility_tx, at, 0).x >= 0.5) == sought;
    }
    for (int once = is_other ? 0 : 1; once < 1; ++once) {
        uint site = texelFetch(nearest_tx, at, 0).x;
        if (!is_site(site)) continue;
        try_site(unpack_site(site), pixel, receiver, footprint.side, next);
        // Not the nearest border again, and on the right side.
        next.found =
            next.found && next.distance > nearest.distance && direction * dot(next.offset, nearest.offset) > 0.0;
    }
    return next;
}

// What is left of the light: the parts beyond the nearest border, the next one beyond it and the one behind the
// receiver are taken as parallel strips.
float soften(ivec2 pixel, Receiver receiver, Footprint footprint, Site site, float radius, bool lit) {
    Site beyond = find_next_border(pixel, receiver, footprint, site, radius, 1.0, lit);
    Site behind = find_next_border(pixel, receiver, footprint, site, radius, -1.0, !lit);
    float side = footprint.side;
    float strip = find_share(receiver, beyond, side) - find_share(receiver, site, side);
    float other = clamp(max(strip, 0.0) + 1.0 - find_share(receiver, behind, side), 0.0, 1.0);
    return lit ? 1.0 - other : other;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float hard = texelFetch(visibility_tx, pixel, 0).x;
    soft = vec4(hard, 0.0, 0.0, 0.0);
    // A loop without trips, not a branch, is what a software rasteriser skips.
    for (int once = is_site(texelFetch(nearest_tx, pixel, 0).x) ? 0 : 1; once < 1; ++once) {
        Receiver receiver = fetch_receiver(pixel);
        if (receiver.fixed_visibility != kMapDecides) continue;
        Footprint footprint = compute_footprint(camera, receiver.position_rel, receiver.normal);
        float depth = camera.forward.w > 0.5 ? 1.0 / max(footprint.depth_vs, 1e-30) : footprint.depth_vs;
        soft.zw = vec2(depth, 1.0);
#if !FROM_LIGHT
        // All sites are at least as far on the screen as the nearest; no slant brings them nearer on the surface, and
        // the nearer side of a penumbra is little larger on the screen.
        float unit = SCREEN_METRIC == 1 ? 1.0 : 0.75 * footprint.side;
        float fixed_width = SCREEN_METRIC == 1 ? penumbra.width.y : penumbra.width.x;
        float apart_px = length(vec2(pixel - unpack_site(texelFetch(nearest_tx, pixel, 0).x)));
        if ((apart_px - 1.0) * unit > (0.5 + 0.5 * penumbra.width.z) * fixed_width) continue;
#endif
        Site site = find_site(pixel, receiver, footprint);
        if (!site.found) continue;
        float width = find_width(receiver, site.gap, footprint.side);
        float radius = 0.5 * width;
        soft.x = soften(pixel, receiver, footprint, site, radius, hard >= 0.5);
        // Beyond ramp and filter nothing changes any more.
        bool is_near = site.distance <= radius + 0.5 * penumbra.width.z * width;
        soft.y = is_near ? 0.5 * penumbra.width.z * width : 0.0;
    }
}
