// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Independent truth: which pixel sees what, and what lies between it and a light. Embree finds the boxes that
// a ray passes; every triangle is then decided here in double, with a bound of the error. Restated from the definitions
// of facing and occlusion: no formula is shared with the techniques that are judged by it.

#include <memory>
#include <optional>
#include <vector>

#include "frame/frame.h"
#include "lights/light_views.h"
#include "shadow_layers/camera.h"
#include "shadow_layers/scene.h"
#include "truth/light_rule.h"
#include "truth/sight_line.h"

namespace shadow_layers {
class ThreadPool;
}

namespace shadow_layers::truth {

/// A line of sight: of a pixel's centre, or of another place in the picture. Start, and direction of view depth 1.
struct PixelRay {
    glm::dvec3 origin_ws, direction;
};

/// A triangle that a ray meets.
struct RayHit {
    PixelIds ids;
    double distance = 0;  ///< along the unscaled direction
};

/// What of its own surface casts no shadow on a receiver.
enum class OwnSurface : std::uint8_t { Neighbours, WholePlane };

/// What lies between a receiver and a light. `certain`: rounding can't change it (sight_line.h).
struct Sight {
    bool blocked = false, certain = true;
};

/// Of one receiver or pixel, 0 to 1; `least` and `most` are what rounding may make of it (a tie): elsewhere all are
/// equal.
struct Visibility {
    float decided = 1, least = 1, most = 1;
};

class RayOracle {
public:
    /// Holds all instances; positions are taken relative to the middle of the scene's bounds.
    explicit RayOracle(std::shared_ptr<const Scene> scene);
    ~RayOracle();
    RayOracle(const RayOracle&) = delete;
    RayOracle& operator=(const RayOracle&) = delete;

    /// First triangle from origin + near * direction to origin + far * direction among instances with any of `flags`.
    std::optional<RayHit> find_first(const glm::dvec3& origin_ws, const glm::dvec3& direction, double near, double far,
                                     std::uint32_t flags) const;

    /// Is anything that casts for `light` strictly between the receiver and the light? Left out: the receiver's own
    /// triangle and triangles in its plane that share an edge with it (by position); or all that lie in its plane, for
    /// a receiver somewhere on that.
    Sight look(const Receiver& receiver, const Light& light, const LightSample& sample,
               OwnSurface own = OwnSurface::Neighbours) const;
    /// The same of any place by a triangle, as decided.
    bool is_occluded(const glm::dvec3& receiver_ws, const PixelIds& receiver, const Light& light,
                     const LightSample& sample, OwnSurface own = OwnSurface::Neighbours) const;

    /// The hard shadow at a receiver: 1 = lit, 0 = in shadow or turned away.
    Visibility find_visibility(const Receiver& receiver, const LightRule& rule, const Light& light,
                               const LightSample& sample) const;

    /// Where the ray meets the plane of the triangle, along its direction; nothing if it runs along the plane.
    std::optional<double> meet_plane(const PixelRay& ray, const PixelIds& ids) const;

    /// The place of the triangle's plane at a distance along the ray.
    Receiver make_receiver(const PixelRay& ray, const RayHit& hit) const;

    /// What the centre of a pixel sees of the triangle in frame.ids: where its ray meets the plane, between the
    /// view depths of the corners (and 5 % of their range beyond). Nothing for background and holdouts.
    std::optional<Receiver> find_receiver(const Frame& frame, std::size_t pixel) const;

    /// The exact hard shadow: per pixel of the frame 1 = lit, 0 = in shadow or turned away, ties as decided. Receivers
    /// are taken anew in double from the pixel's ray and the plane of the triangle in frame.ids.
    std::vector<float> compute_visibility(const Frame& frame, const Light& light, const LightSample& sample,
                                          ThreadPool* threads = nullptr) const;
    /// The same with what ties may be.
    std::vector<Visibility> compute_visibility_ranges(const Frame& frame, const Light& light, const LightSample& sample,
                                                      ThreadPool* threads = nullptr) const;

    /// A frame without GL: ids, positions, normals and coverage as frame.h says; no textures, no key.
    Frame make_frame(const Camera& camera, int width, int height, ThreadPool* threads = nullptr) const;

    /// Corners of a triangle in the world, relative to get_origin().
    std::array<glm::dvec3, 3> get_corners(const PixelIds& ids) const;
    glm::dvec3 get_origin() const;
    const std::shared_ptr<const Scene>& get_scene() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The ray of a place in the picture (pixel centres at +0.5), by the camera's definition alone.
PixelRay compute_pixel_ray(const Camera& camera, double x_px, double y_px, int width, int height);
PixelRay compute_centre_ray(const Frame& frame, std::size_t pixel);

}  // namespace shadow_layers::truth
