// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "frame/frame.h"
#include "lights/light_views.h"

namespace shadow_layers {
class ThreadPool;
}

namespace shadow_layers::truth {

/// Shadow rays from the receivers of a picture to samples of a light, as a ray tracer has them: float, relative to the
/// camera, each leaving its receiver by a part of the scene's size.
class RayList {
public:
    /// Lists the receivers that face at least one sample, in blocks of pixels, so that neighbouring rays lie close
    /// together. `reach`: the scene's size. All must outlive the list.
    RayList(const Frame& frame, const Light& light, std::span<const LightSample> samples, double reach,
            ThreadPool& threads);

    std::size_t receiver_count() const { return receivers_.size(); }
    /// Add to `lit`, per pixel, the samples that are faced and seen; return the number of rays.
    std::size_t trace_packets(RTCScene scene, ThreadPool& threads, std::vector<std::uint16_t>& lit) const;
    std::size_t trace_stream(RTCScene scene, ThreadPool& threads, std::vector<std::uint16_t>& lit) const;

private:
    struct Receiver {
        glm::vec3 place, normal;  ///< relative to the camera
        std::uint32_t pixel;
    };
    struct Target {
        bool directional;
        glm::vec3 place;  ///< relative to the camera; of a sun the direction to it
    };

    void list_band(const Frame& frame, int top, std::vector<Receiver>& band) const;
    bool is_linked(const Frame& frame, std::size_t pixel) const;
    bool is_in_cone(const glm::vec3& to_light) const;
    bool faces(const Receiver& receiver, const Target& target, glm::vec3& to_light) const;
    /// A ray is a receiver and a sample: rays of one receiver follow each other.
    std::optional<RTCRay> make_ray(std::size_t index) const;
    template <class Trace>
    std::size_t trace_batches(ThreadPool& threads, const Trace& trace) const;

    const Light& light_;
    std::vector<Target> targets_;
    std::vector<Receiver> receivers_;
    glm::vec3 backward_;  ///< unit, against the light's direction
    float cone_cos_;      ///< of half the cone's angle; area: 0; else -1
    float leave_;
};

}  // namespace shadow_layers::truth
