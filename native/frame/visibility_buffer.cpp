// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/visibility_buffer.h"

#include <algorithm>
#include <limits>

#include "engine/scene_draw.h"
#include "frame/camera_window.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kInstanceBlock = 8192;

/// Half-spaces of the camera's pyramid or box in camera space: inside is dot(normal, p) + offset >= 0.
struct Halfspace {
    glm::dvec3 normal;
    double offset;
};

std::array<Halfspace, 6> list_halfspaces(const Camera& camera) {
    const CameraWindow& w = camera.window;
    const Halfspace near{{0, 0, -1}, -camera.clip_start}, far{{0, 0, 1}, camera.clip_end};
    if (camera.perspective)
        return {near, far, {{1, 0, w.left}, 0}, {{-1, 0, -w.right}, 0}, {{0, 1, w.bottom}, 0}, {{0, -1, -w.top}, 0}};
    return {near, far, {{1, 0, 0}, -w.left}, {{-1, 0, 0}, w.right}, {{0, 1, 0}, -w.bottom}, {{0, -1, 0}, w.top}};
}

/// The instances whose bounds reach into the view, and the view depths that they span.
struct CullResult {
    std::vector<std::uint32_t> instances;
    double near_vs = std::numeric_limits<double>::infinity(), far_vs = 0;
};

CullResult cull_range(const Scene& scene, const Camera& camera, const std::vector<Bounds>& bounds_ws, std::size_t begin,
                      std::size_t end) {
    const std::array<Halfspace, 6> halfspaces = list_halfspaces(camera);
    const glm::dmat4 view = camera_from_world(camera);
    const glm::dmat3 axes(view);
    const glm::dmat3 extent_axes(glm::abs(axes[0]), glm::abs(axes[1]), glm::abs(axes[2]));
    CullResult result;
    for (std::size_t i = begin; i < end; ++i) {
        if (!(scene.instances[i].flags & (kInstanceCamera | kInstanceHoldout)) || bounds_ws[i].is_empty()) continue;
        const glm::dvec3 centre(view * glm::dvec4(0.5 * (bounds_ws[i].min + bounds_ws[i].max), 1.0));
        const glm::dvec3 half_extent = extent_axes * (0.5 * (bounds_ws[i].max - bounds_ws[i].min));
        const auto is_outside = [&](const Halfspace& h) {
            return glm::dot(h.normal, centre) + glm::dot(glm::abs(h.normal), half_extent) + h.offset < 0;
        };
        if (std::any_of(halfspaces.begin(), halfspaces.end(), is_outside)) continue;
        result.instances.push_back(std::uint32_t(i));
        result.near_vs = std::min(result.near_vs, -centre.z - half_extent.z);
        result.far_vs = std::max(result.far_vs, -centre.z + half_extent.z);
    }
    return result;
}

CullResult cull(Engine& engine, const Scene& scene, const Camera& camera, const std::vector<Bounds>& bounds_ws) {
    const std::size_t count = scene.instances.size();
    std::vector<CullResult> blocks((count + kInstanceBlock - 1) / kInstanceBlock);
    engine.threads().parallel_for(count, kInstanceBlock, [&](std::size_t begin, std::size_t end) {
        blocks[begin / kInstanceBlock] = cull_range(scene, camera, bounds_ws, begin, end);
    });
    CullResult result;
    for (const CullResult& block : blocks) {
        result.instances.insert(result.instances.end(), block.instances.begin(), block.instances.end());
        result.near_vs = std::min(result.near_vs, block.near_vs);
        result.far_vs = std::max(result.far_vs, block.far_vs);
    }
    return result;
}

/// The camera's clip planes, drawn together round what is there: a float depth buffer keeps its steps small then, also
/// where the clip range is far larger than the scene. Never wider than the camera's own.
glm::dmat4 make_clip_matrix(const Camera& camera, const CullResult& seen) {
    const double margin = 1e-3 * (seen.far_vs - seen.near_vs) + 1e-6 * seen.far_vs;
    const double near_vs = std::max(camera.clip_start, seen.near_vs - margin);
    const double far_vs = std::min(camera.clip_end, seen.far_vs + margin);
    return clip_from_camera(camera, near_vs, far_vs) * camera_from_world(camera);
}

}  // namespace

VisibilityBuffer::VisibilityBuffer(Engine& engine, int width, int height)
    : ids_tx_(std::make_shared<gl::Texture>(engine.device(), gl::TextureDesc{GL_RG32UI, width, height}, "pixel ids")),
      depth_tx_(std::make_shared<gl::Texture>(engine.device(), gl::TextureDesc{GL_DEPTH_COMPONENT32F, width, height},
                                              "frame depth")),
      framebuffer_(engine.device(), "visibility buffer") {
    framebuffer_.attach_color(0, ids_tx_);
    framebuffer_.attach_depth(depth_tx_);
}

void VisibilityBuffer::draw(Engine& engine, const Scene& scene, const Camera& camera,
                            const std::vector<Bounds>& instance_bounds_ws, std::vector<PixelIds>& ids) {
    const CullResult seen = cull(engine, scene, camera, instance_bounds_ws);
    {
        const auto timer = engine.time_stage("frame_ids");
        framebuffer_.bind();
        framebuffer_.clear_color_uint(0, kNoId, kNoId, kNoId, kNoId);
        framebuffer_.clear_depth();
        if (!seen.instances.empty()) {
            const gl::Program& program = engine.program("frame/visibility.vert", "frame/visibility.frag");
            draw_scene(engine, program, DrawState::nearest(),
                       {scene, seen.instances, make_clip_matrix(camera, seen), true});
        }
    }
    const auto timer = engine.time_stage("frame_readback");
    ids.resize(std::size_t(width()) * std::size_t(height()));
    static_assert(sizeof(PixelIds) == 2 * sizeof(std::uint32_t));
    ids_tx_->read(0, 0, width(), height(), ids.data(), ids.size() * sizeof(PixelIds));
}

}  // namespace shadow_layers
