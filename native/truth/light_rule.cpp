// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/light_rule.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shadow_layers::truth {
namespace {

// Of directions: what a normal and a place relative to the camera lose in float, with some room.
constexpr double kFloatNormal = 4e-7, kFloatPlace = 3e-7;
constexpr double kAngleRounding = 1e-14;

double find_half_angle(const Light& light) {
    switch (light.kind) {
        case LightKind::Spot:
            return 0.5 * std::min(light.spot_angle, std::numbers::pi);
        case LightKind::Area:
            return 0.5 * std::numbers::pi;
        case LightKind::Sun:
        case LightKind::Point:
            break;
    }
    return 2 * std::numbers::pi;  // everything
}

/// How much that may turn a direction, times how much it was turned itself.
double find_spot_stretch(const Light& light) {
    if (light.kind != LightKind::Spot) return 1;
    const auto [least, most] = std::minmax({1.0, light.spot_scale.x, light.spot_scale.y});
    return most / least;
}

}  // namespace

glm::dvec3 undo_spot_scale(const Light& light, const glm::dvec3& direction) {
    glm::dvec3 undone = direction;
    if (light.kind != LightKind::Spot) return undone;
    for (int axis = 0; axis < 2; ++axis) {
        const glm::dvec3 along = glm::normalize(glm::dvec3(light.world_from_light[axis]));
        undone += (1 / light.spot_scale[axis] - 1) * glm::dot(along, direction) * along;
    }
    return undone;
}

LightRule::LightRule(const Scene& scene, const Light& light, const LightSample& sample)
    : scene_(scene),
      light_(light),
      sample_(sample),
      backward_(glm::normalize(glm::dvec3(light.world_from_light[2]))),
      half_angle_(find_half_angle(light)) {}

glm::dvec3 LightRule::find_to_light(const glm::dvec3& place_ws) const {
    return sample_.directional ? sample_.to_light_ws : sample_.position_ws - place_ws;
}

bool LightRule::is_linked(std::uint32_t instance) const {
    return light_.receiver_set >> scene_.instances[instance].receiver_group & 1u;
}

/// Between the light's direction and the way to the place, where the cone is round.
double LightRule::find_angle(const glm::dvec3& place_ws) const {
    const glm::dvec3 to_light = undo_spot_scale(light_, find_to_light(place_ws));
    return std::atan2(glm::length(glm::cross(backward_, to_light)), glm::dot(backward_, to_light));
}

/// By how much the direction to the light may turn, radians.
double LightRule::find_float_error(const Receiver& receiver) const {
    if (sample_.directional) return kAngleRounding;
    const double apart = glm::length(find_to_light(receiver.place_ws));
    return kAngleRounding + (kFloatPlace * receiver.camera_distance + receiver.slack) / apart;
}

Standings LightRule::find_standings(const Receiver& receiver) const {
    const glm::dvec3 to_light = find_to_light(receiver.place_ws);
    const double turn = find_float_error(receiver), angle = find_angle(receiver.place_ws) - half_angle_;
    const double elevation = glm::dot(receiver.normal, to_light), apart = glm::length(to_light);
    const bool is_linked_to = is_linked(receiver.ids.instance), in_cone = angle <= 0;
    const double cone_turn = turn * find_spot_stretch(light_);
    // Written so that a light in the receiver itself is uncertain: its angles are not numbers.
    const bool may_be_inside = !(angle > cone_turn), may_be_outside = !(angle < -cone_turn);
    const double grazing = (kFloatNormal + turn) * apart;
    Standings found;
    found.may_be_apart = !is_linked_to || may_be_outside;
    found.may_be_turned_away = is_linked_to && may_be_inside && !(elevation > grazing);
    found.may_be_facing = is_linked_to && may_be_inside && !(elevation < -grazing);
    found.decided = !in_cone || !is_linked_to ? Standing::Apart
                    : elevation > 0           ? Standing::Facing
                                              : Standing::TurnedAway;
    return found;
}

/// Of an area light, without the receiver's cosine.
double LightRule::compute_falloff(const glm::dvec3& to_light) const {
    if (light_.kind != LightKind::Area) return 1;
    return glm::dot(backward_, glm::normalize(to_light)) / glm::dot(to_light, to_light);
}

double LightRule::compute_weight(const Receiver& receiver) const {
    const glm::dvec3 to_light = find_to_light(receiver.place_ws);
    return glm::dot(receiver.normal, glm::normalize(to_light)) * compute_falloff(to_light);
}

double LightRule::find_weight_error(const Receiver& receiver) const {
    const glm::dvec3 to_light = find_to_light(receiver.place_ws);
    const double turn = find_float_error(receiver);
    const double falloff = light_.kind == LightKind::Area ? 1 / glm::dot(to_light, to_light) : 1;
    return (kFloatNormal + 4 * turn) * falloff;
}

}  // namespace shadow_layers::truth
