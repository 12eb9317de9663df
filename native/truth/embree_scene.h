// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "shadow_layers/scene.h"

namespace shadow_layers::truth {

/// Embree's scene of one light's casters, in float relative to the camera, as ray tracers have it.
class EmbreeScene {
public:
    /// Brings the vertices into place. `instanced`: a tree for each mesh and one over its instances; else one of all
    /// triangles. The device must outlive it.
    EmbreeScene(RTCDevice device, const Scene& scene, const Light& light, const glm::dvec3& origin_ws,
                RTCBuildQuality quality, bool instanced);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// Makes the trees.
    void build();
    RTCScene get() const { return scenes_.back(); }

private:
    /// Triangles in the float space of a tree.
    struct Triangles {
        std::vector<glm::vec3> positions;
        std::vector<glm::uvec3> indices;
    };
    struct Place {
        std::uint32_t part;
        glm::mat4 matrix;
    };
    static void append(const Mesh& mesh, const glm::dmat4& matrix, Triangles& to);
    RTCScene make_scene() const;
    void attach_triangles(RTCScene scene, const Triangles& triangles) const;
    void attach_instance(RTCScene scene, RTCScene part, const glm::mat4& matrix) const;

    RTCDevice device_;
    RTCBuildQuality quality_;
    std::vector<Triangles> parts_;
    std::vector<Place> places_;
    std::vector<RTCScene> scenes_;  ///< of the parts; at the end the one that is asked
};

}  // namespace shadow_layers::truth
