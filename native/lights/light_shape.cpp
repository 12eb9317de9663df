// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/light_shape.h"

#include <cmath>
#include <numbers>

namespace shadow_layers {

namespace {

/// Point i of the additive sequence of the plastic number, in [0, 1)^2: even at any count.
glm::dvec2 get_even_point(int i) {
    constexpr double kPlastic = 1.32471795724474602596;
    const glm::dvec2 point = (i + 1.0) * glm::dvec2(1 / kPlastic, 1 / (kPlastic * kPlastic)) + 0.5;
    return glm::fract(point);
}

glm::dvec2 map_to_disc(const glm::dvec2& square) {
    const double radius = std::sqrt(square.x), angle = 2 * std::numbers::pi * square.y;
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

glm::dvec3 map_to_sphere(const glm::dvec2& square) {
    const double z = 2 * square.x - 1, angle = 2 * std::numbers::pi * square.y;
    const double radius = std::sqrt(std::max(0.0, 1 - z * z));
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

LightPosition make_centre(const Light& light) {
    LightPosition centre;
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
    }
    if (light.kind == LightKind::Area) {
        centre.cone_cos = 0;
        centre.cone_sin = 1;
    }
    return centre;
}

void move_to_sample(const Light& light, const glm::dvec2& square, LightPosition& position) {
    const glm::dmat3 axes = compute_light_axes(light.world_from_light);
    switch (light.kind) {
        case LightKind::Sun: {
            const glm::dvec2 disc = std::tan(0.5 * std::min(light.sun_angle, 3.0)) * map_to_disc(square);
            position.to_light_ws = glm::normalize(axes[2] + disc.x * axes[0] + disc.y * axes[1]);
            glm::dmat4 turned(axes);
            turned[2] = glm::dvec4(position.to_light_ws, 0);
            position.axes_ws = compute_light_axes(turned);
            break;
        }
        case LightKind::Spot:
        case LightKind::Point:
            position.position_ws += light.radius * (axes * map_to_sphere(square));
            break;
        case LightKind::Area: {
            const glm::dvec2 place = light.area_round ? 0.5 * map_to_disc(square) : square - 0.5;
            position.position_ws += place.x * light.area_size.x * axes[0] + place.y * light.area_size.y * axes[1];
            break;
        }
    }
}

}  // namespace

glm::dmat3 compute_light_axes(const glm::dmat4& matrix) {
    const glm::dvec3 z = glm::normalize(glm::dvec3(matrix[2]));
    const glm::dvec3 x_skewed(matrix[0]);
    const glm::dvec3 x = glm::normalize(x_skewed - glm::dot(x_skewed, z) * z);
    return {x, glm::cross(z, x), z};
}

std::vector<LightPosition> sample_light_shape(const Light& light, int position_count) {
    std::vector<LightPosition> positions(std::size_t(std::max(1, position_count)), make_centre(light));
    if (positions.size() > 1)
        for (std::size_t i = 0; i < positions.size(); ++i) move_to_sample(light, get_even_point(int(i)), positions[i]);
    return positions;
}

}  // namespace shadow_layers
