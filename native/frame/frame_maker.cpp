// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame_maker.h"

#include <algorithm>
#include <utility>

#include "base/hash.h"
#include "frame/camera_window.h"
#include "frame/receivers.h"
#include "frame/settle_ids.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

// Frames of one size that wait for use: the sample's and one of a technique's own.
constexpr std::size_t kFreeFrames = 2;
constexpr std::size_t kInstanceBlock = 8192;

/// One instance without padding, for the hash.
struct InstanceBytes {
    glm::dmat4 world_from_object;
    std::uint32_t mesh, flags, receiver_group, blocker_group;
};

/// Of everything that a frame shows: meshes and instances, not the lights.
ContentKey compute_geometry_key(ThreadPool& threads, const Scene& scene) {
    std::vector<InstanceBytes> instances(scene.instances.size());
    threads.parallel_for(instances.size(), kInstanceBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Instance& from = scene.instances[i];
            instances[i] = {from.world_from_object, from.mesh, from.flags, from.receiver_group, from.blocker_group};
        }
    });
    std::vector<ContentKey> meshes;
    for (const auto& mesh : scene.meshes) {
        meshes.push_back(mesh->positions_key);
        meshes.push_back(mesh->topology_key);
    }
    return KeyBuilder("geometry")
        .add_span(std::span<const ContentKey>(meshes))
        .add_span(std::span<const InstanceBytes>(instances))
        .key();
}

ContentKey compute_frame_key(const ContentKey& scene_key, const Frame& frame) {
    const CameraWindow& w = frame.camera.window;
    return KeyBuilder("frame")
        .add(scene_key)
        .add(frame.camera.perspective)
        .add(glm::dvec4(w.left, w.right, w.bottom, w.top))
        .add(glm::dvec2(frame.camera.clip_start, frame.camera.clip_end))
        .add(frame.camera.world_from_camera)
        .add(frame.width)
        .add(frame.height)
        .key();
}

std::size_t frame_bytes(const Frame& frame) {
    const std::size_t host = 2 * sizeof(glm::vec3) + sizeof(PixelIds) + 1, gl = 2 * sizeof(glm::vec4);
    return frame.pixel_count() * (host + gl);
}

}  // namespace

std::optional<FramePool::Buffers> FramePool::take(int width, int height) {
    const auto fits = [&](const Buffers& b) { return b.width == width && b.height == height; };
    const auto found = std::find_if(free_.begin(), free_.end(), fits);
    if (found == free_.end()) return std::nullopt;
    std::optional<Buffers> buffers = std::move(*found);
    free_.erase(found);
    return buffers;
}

void FramePool::give(Buffers buffers) {
    free_.push_front(std::move(buffers));
    if (free_.size() > kFreeFrames) free_.pop_back();
}

void FramePool::clear() {
    free_.clear();
    scratch_ = {};
}

std::size_t FramePool::host_bytes() const {
    std::size_t bytes = (scratch_.position_texels.capacity() + scratch_.normal_texels.capacity()) * sizeof(glm::vec4);
    for (const Buffers& b : free_)
        bytes += (b.positions_rel.capacity() + b.normals.capacity()) * sizeof(glm::vec3) +
                 b.ids.capacity() * sizeof(PixelIds) + b.coverage.capacity();
    return bytes;
}

FrameMaker::FrameMaker(Engine& engine, std::shared_ptr<FramePool> pool, FrameView view, std::size_t budget_bytes)
    : engine_(engine), pool_(std::move(pool)), view_(std::move(view)), budget_bytes_(budget_bytes) {
    const Scene& scene = *view_.scene;
    scene_key_ = compute_geometry_key(engine.threads(), scene);
    instance_bounds_ws_.resize(scene.instances.size());
    engine.threads().parallel_for(scene.instances.size(), kInstanceBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            instance_bounds_ws_[i] = compute_instance_bounds(scene, scene.instances[i]);
    });
}

std::shared_ptr<Frame> FrameMaker::make_empty(const glm::dvec2& offset_px) {
    const int width = view_.region.width + 2 * view_.overscan_px;
    const int height = view_.region.height + 2 * view_.overscan_px;
    const auto give_back = [pool = pool_](Frame* frame) {
        pool->give({frame->width, frame->height, std::move(frame->positions_rel), std::move(frame->normals),
                    std::move(frame->ids), std::move(frame->coverage), std::move(frame->position_tx),
                    std::move(frame->normal_tx)});
        delete frame;
    };
    std::shared_ptr<Frame> frame(new Frame, give_back);
    if (auto buffers = pool_->take(width, height)) {
        frame->positions_rel = std::move(buffers->positions_rel);
        frame->normals = std::move(buffers->normals);
        frame->ids = std::move(buffers->ids);
        frame->coverage = std::move(buffers->coverage);
        frame->position_tx = std::move(buffers->position_tx);
        frame->normal_tx = std::move(buffers->normal_tx);
    }
    frame->width = width;
    frame->height = height;
    frame->overscan_px = view_.overscan_px;
    frame->region = view_.region;
    frame->picture_width = view_.width;
    frame->picture_height = view_.height;
    frame->camera = crop_camera(view_.camera, view_.width, view_.height, view_.region, view_.overscan_px, offset_px);
    frame->origin_ws = glm::dvec3(view_.camera.world_from_camera[3]);
    frame->scene = view_.scene;
    frame->key = compute_frame_key(scene_key_, *frame);
    const gl::TextureDesc desc{GL_RGBA32F, width, height};
    if (!frame->position_tx)
        frame->position_tx = std::make_shared<gl::Texture>(engine_.device(), desc, "receiver positions");
    if (!frame->normal_tx) frame->normal_tx = std::make_shared<gl::Texture>(engine_.device(), desc, "receiver normals");
    return frame;
}

std::shared_ptr<const Frame> FrameMaker::make(const glm::dvec2& offset_px) {
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.offset_px == offset_px; });
    if (found != kept_.end()) {
        kept_.splice(kept_.begin(), kept_, found);
        return found->frame;
    }
    std::shared_ptr<Frame> frame = make_empty(offset_px);
    FramePool::Scratch& scratch = pool_->scratch();
    if (!scratch.visibility || scratch.visibility->width() != frame->width ||
        scratch.visibility->height() != frame->height)
        scratch.visibility.emplace(engine_, frame->width, frame->height);
    scratch.visibility->draw(engine_, *view_.scene, frame->camera, instance_bounds_ws_, frame->ids);
    const auto timer = engine_.time_stage("frame_resolve");
    settle_ids(engine_, *frame);
    scratch.position_texels.resize(frame->pixel_count());
    scratch.normal_texels.resize(frame->pixel_count());
    resolve_receivers(engine_.threads(), *frame, {scratch.position_texels, scratch.normal_texels});
    frame->position_tx->upload(scratch.position_texels.data());
    frame->normal_tx->upload(scratch.normal_texels.data());
    keep(offset_px, frame);
    return frame;
}

void FrameMaker::keep(const glm::dvec2& offset_px, const std::shared_ptr<const Frame>& frame) {
    kept_.push_front({offset_px, frame});
    // The newest stays whatever its size.
    while (kept_.size() > 1 && kept_.size() * frame_bytes(*frame) > budget_bytes_) kept_.pop_back();
}

std::shared_ptr<const Frame> SampleFrames::at_offset(double dx_px, double dy_px) {
    if (!(std::abs(dx_px) <= 0.5 && std::abs(dy_px) <= 0.5))
        throw Error("a frame was asked for at (" + std::to_string(dx_px) + ", " + std::to_string(dy_px) +
                    ") pixels; a technique may ask for -0.5 to 0.5");
    return maker_.make(offset_px_ + glm::dvec2(dx_px, dy_px));
}

}  // namespace shadow_layers
