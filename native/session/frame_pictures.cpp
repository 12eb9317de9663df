// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/frame_pictures.h"

namespace shadow_layers {
namespace {

std::size_t region_pixels(const PixelRect& region) { return std::size_t(region.width) * std::size_t(region.height); }

/// Calls body(region pixel, frame pixel) for the region's pixels.
template <class Body>
void for_each_pixel(const Frame& frame, const Body& body) {
    const auto overscan = std::size_t(frame.overscan_px);
    for (std::size_t y = 0, pixel = 0; y < std::size_t(frame.region.height); ++y) {
        std::size_t from = (y + overscan) * std::size_t(frame.width) + overscan;
        for (std::size_t x = 0; x < std::size_t(frame.region.width); ++x) body(pixel++, from++);
    }
}

IdImage make_ids(const Frame& frame) {
    IdImage image{frame.region.width, frame.region.height, {}};
    image.data.resize(2 * region_pixels(frame.region), -1);
    for_each_pixel(frame, [&](std::size_t pixel, std::size_t from) {
        const PixelIds& ids = frame.ids[from];
        if (ids.instance == kNoId) return;
        image.data[2 * pixel] = ids.instance;
        image.data[2 * pixel + 1] = ids.triangle;
    });
    return image;
}

/// Pixel `pixel` of the frame into `out`.
void write_aux(const Frame& frame, const std::string& name, const glm::vec3& forward, std::size_t pixel, float* out) {
    const glm::vec3& value = name == "normal" ? frame.normals[pixel] : frame.positions_rel[pixel];
    if (name == "depth")
        out[0] = glm::dot(frame.positions_rel[pixel], forward);
    else
        out[0] = value.x, out[1] = value.y, out[2] = value.z;
}

}  // namespace

FramePictures::FramePictures(ThreadPool& threads, const RenderRequest& request, const PixelRect& region)
    : threads_(threads),
      request_(request),
      region_(region),
      coverage_{region.width, region.height, 1, std::vector<float>(region_pixels(region), 0.0f)} {
    if (request.combined) clay_.emplace(region.width, region.height);
}

void FramePictures::add_frame(const Frame& frame, std::size_t sample) {
    for_each_pixel(frame,
                   [&](std::size_t pixel, std::size_t from) { coverage_.data[pixel] += float(frame.coverage[from]); });
    if (clay_) clay_->add_surface(threads_, frame, 1.0f / float(request_.samples));
    if (sample == 0) add_aux(frame);
}

void FramePictures::add_aux(const Frame& frame) {
    const glm::vec3 forward(-glm::dvec3(frame.camera.world_from_camera[2]));
    for (const std::string& name : request_.aux) {
        if (name == "ids") {
            ids_ = make_ids(frame);
            continue;
        }
        const int channels = name == "depth" ? 1 : 3;
        Image image{region_.width, region_.height, channels, {}};
        image.data.resize(region_pixels(region_) * std::size_t(channels));
        for_each_pixel(frame, [&](std::size_t pixel, std::size_t from) {
            write_aux(frame, name, forward, from, image.data.data() + pixel * std::size_t(channels));
        });
        aux_[name] = std::move(image);
    }
}

void FramePictures::add_light(const Frame& frame, const Light& light, const std::vector<float>& visibility) {
    clay_->add_light(threads_, frame, light, visibility, 1.0f / float(request_.samples));
}

void FramePictures::finish(FrameResult& result) {
    for (float& value : coverage_.data) value /= float(request_.samples);
    result.coverage = std::move(coverage_);
    result.aux = std::move(aux_);
    result.ids = std::move(ids_);
    if (clay_) result.combined = clay_->take();
}

}  // namespace shadow_layers
