// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "frame/frame.h"
#include "shadow_layers/request.h"

namespace shadow_layers {

/// The combined picture: a neutral clay under the lights that have a layer, in linear light, in Blender's photometric
/// units, with each light's shadows. Not a preview of the materials; it shows what the layers do together.
/// Pixels are those of the frame's region, without overscan; the sum over lights and samples is built up in place.
class ClayPicture {
public:
    ClayPicture(int width, int height);

    /// Alpha (the coverage) and a little light from everywhere, so that shadows are not black.
    void add_surface(ThreadPool& threads, const Frame& frame, float weight);
    /// One light with its visibility (region size).
    void add_light(ThreadPool& threads, const Frame& frame, const Light& light, std::span<const float> visibility,
                   float weight);

    Image take() { return std::move(image_); }

private:
    Image image_;
};

/// Radiance that a white Lambertian surface sends back to the camera, for 1 W or 1 W/m2 of a white light: cosine,
/// distance and cone in one. `position_rel` and `normal` as in Frame, `origin_ws` likewise.
class LightShading {
public:
    LightShading(const Light& light, const glm::dvec3& origin_ws);
    float get_radiance(const glm::vec3& position_rel, const glm::vec3& normal) const;

private:
    float shape(const glm::vec3& to_light) const;
    LightKind kind_;
    glm::vec3 position_rel_, axis_;  ///< axis: where the light looks
    glm::mat3 local_from_ws_;        ///< of directions, into the space where a spot's cone is round
    float scale_, cone_cos_, blend_, least_distance_squared_;
};

}  // namespace shadow_layers
