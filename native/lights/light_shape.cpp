// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/light_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/sample_pattern.h"

namespace shadow_layers {

namespace {

LightSample make_centre(const Light& light) {
    LightSample centre;
    const glm::dmat3 axes = compute_light_axes(light.world_from_light);
    centre.position_ws = glm::dvec3(light.world_from_light[3]);
    centre.to_light_ws = axes[2];
    // A point light's rotation shows nowhere, so its map does not turn with it.
    centre.axes_ws = light.kind == LightKind::Point ? glm::dmat3(1.0) : axes;
    centre.directional = light.kind == LightKind::Sun;
    if (light.kind == LightKind::Spot) {
        const double half_angle = 0.5 * std::min(light.spot_angle, std::numbers::pi);
        centre.cone_cos = std::cos(half_angle);
        centre.cone_sin = std::sin(half_angle);
        centre.cone_scale = light.spot_scale;
    }
    if (light.kind == LightKind::Area) {
        centre.cone_cos = 0;
        centre.cone_sin = 1;
    }
    return centre;
}

bool has_size(const Light& light) {
    switch (light.kind) {
        case LightKind::Sun:
            return light.sun_angle > 0;
        case LightKind::Area:
            return light.area_size.x > 0 || light.area_size.y > 0;
        case LightKind::Spot:
        case LightKind::Point:
            break;
    }
    return light.radius > 0;
}

/// Even in solid angle about `axis`: the cosine is even between that of half the sun's angle and 1.
glm::dvec3 turn_to_sample(const glm::dmat3& axes, double sun_angle, const glm::dvec2& disc) {
    const double half_angle = 0.5 * std::clamp(sun_angle, 0.0, std::numbers::pi), sine = std::sin(0.5 * half_angle);
    const double share = glm::dot(disc, disc), fall = share * 2 * sine * sine;  // 1 - cosine, also where it is tiny
    if (!(fall > 0)) return axes[2];
    const glm::dvec2 across = disc * std::sqrt(fall * (2 - fall) / share);
    return glm::normalize((1 - fall) * axes[2] + across.x * axes[0] + across.y * axes[1]);
}

void move_to_sample(const Light& light, const SamplePattern& pattern, int i, LightSample& sample) {
    const glm::dmat3 axes = compute_light_axes(light.world_from_light);
    switch (light.kind) {
        case LightKind::Sun: {
            sample.to_light_ws = turn_to_sample(axes, light.sun_angle, pattern.get_in_disc(i));
            glm::dmat4 turned(axes);
            turned[2] = glm::dvec4(sample.to_light_ws, 0);
            sample.axes_ws = compute_light_axes(turned);
            break;
        }
        case LightKind::Spot:
        case LightKind::Point:
            sample.position_ws += light.radius * (axes * pattern.get_in_ball(i));
            break;
        case LightKind::Area: {
            const glm::dvec2 place = light.area_round ? 0.5 * pattern.get_in_disc(i) : pattern.get_in_square(i) - 0.5;
            sample.position_ws += place.x * light.area_size.x * axes[0] + place.y * light.area_size.y * axes[1];
            break;
        }
    }
}

}  // namespace

double find_widest_spot_angle(const Light& light) {
    const double scale = std::max({1.0, light.spot_scale.x, light.spot_scale.y});
    return scale > 1 ? 2 * std::atan(scale * std::tan(0.5 * std::min(light.spot_angle, std::numbers::pi)))
                     : light.spot_angle;
}

glm::dmat3 compute_light_axes(const glm::dmat4& matrix) {
    const glm::dvec3 z = glm::normalize(glm::dvec3(matrix[2]));
    const glm::dvec3 x_skewed(matrix[0]);
    const glm::dvec3 x = glm::normalize(x_skewed - glm::dot(x_skewed, z) * z);
    return {x, glm::cross(z, x), z};
}

std::vector<LightSample> sample_light_shape(const Light& light, int count, LightPattern pattern,
                                            const PatternShift& shift) {
    std::vector<LightSample> samples(has_size(light) ? std::size_t(std::max(1, count)) : 1, make_centre(light));
    if (samples.size() == 1) return samples;
    const SamplePattern points(pattern, count, shift);
    for (std::size_t i = 0; i < samples.size(); ++i) move_to_sample(light, points, int(i), samples[i]);
    return samples;
}

}  // namespace shadow_layers
