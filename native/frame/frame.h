// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "shadow_layers/camera.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

namespace gl {
class Texture;
}

inline constexpr std::uint32_t kNoId = 0xffffffffu;

/// What one pixel sees.
struct PixelIds {
    std::uint32_t instance = kNoId;  ///< index into Scene::instances; kNoId = background
    std::uint32_t triangle = kNoId;  ///< index into that mesh's triangles
};

/// What the camera sees, made once per sample and shared by all lights and techniques.
///
/// Space "_rel": world axes, origin at `origin_ws` (the camera's position), scene units. Every position here is taken
/// in double from the pixel's ray and the plane of the triangle, then rounded to float; nothing is snapped to the
/// raster. Pixel arrays are row-major, row 0 at the bottom, of size width x height, which include the overscan.
struct Frame {
    int width = 0, height = 0;
    int overscan_px = 0;  ///< on each side; the region proper starts at (overscan_px, overscan_px)
    PixelRect region;     ///< in the full picture, without overscan
    int picture_width = 0, picture_height = 0;  ///< of the full picture, without overscan
    Camera camera;                              ///< window of exactly this frame: region + overscan, jittered
    glm::dvec3 origin_ws{0.0};
    std::shared_ptr<const Scene> scene;

    std::vector<glm::vec3> positions_rel;  ///< receiver's position; (0,0,0) in the background
    std::vector<glm::vec3> normals;        ///< unit geometric normal, turned towards the camera; 0 in the background
    std::vector<PixelIds> ids;             ///< holdouts keep their ids; see `coverage`
    std::vector<std::uint8_t> coverage;    ///< 1 = a receiver, 0 = background or holdout

    std::shared_ptr<gl::Texture> position_tx;  ///< RGBA32F: positions_rel, coverage
    std::shared_ptr<gl::Texture> normal_tx;    ///< RGBA32F: normals, receiver group (as a float)
    ContentKey key;                            ///< of scene, camera and size

    std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }

    /// The ray through window-space point (x, y) of this frame (pixel centres at +0.5), relative to origin_ws.
    struct Ray {
        glm::dvec3 origin_rel{0.0}, direction{0.0};
    };
    Ray ray_at(double x_px, double y_px) const;

    /// Corners of a triangle in double, relative to origin_ws.
    std::array<glm::dvec3, 3> get_corners_rel(const PixelIds& triangle_ids) const;
};

/// Corners of a triangle in double, relative to `origin_ws`.
std::array<glm::dvec3, 3> find_corners_rel(const Scene& scene, const glm::dvec3& origin_ws, const PixelIds& triangle);

/// Frames of the same view at other sub-pixel places, for techniques that take many samples per pixel.
class FrameSource {
public:
    virtual ~FrameSource() = default;
    virtual const Frame& centre() const = 0;
    /// Frame moved by (dx, dy) pixels, each in [-0.5, 0.5]; cached while memory allows.
    virtual std::shared_ptr<const Frame> at_offset(double dx_px, double dy_px) = 0;
};

}  // namespace shadow_layers
