// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/clay.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shadow_layers {
namespace {

const glm::vec3 kClay(0.80f, 0.78f, 0.75f);
// Light from everywhere: a cool sky above (+Z, as in Blender), a warm floor below.
const glm::vec3 kSky(0.060f, 0.066f, 0.076f), kFloor(0.030f, 0.028f, 0.026f);
// A surface that touches a light without size would be infinitely bright.
constexpr float kLargestRadiance = 1e4f;
constexpr std::size_t kRowsPerBlock = 16;

template <class Body>
void for_each_pixel(ThreadPool& threads, const Frame& frame, const Body& body) {
    const auto width = std::size_t(frame.region.width), overscan = std::size_t(frame.overscan_px);
    threads.parallel_for(std::size_t(frame.region.height), kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            const std::size_t frame_row = (y + overscan) * std::size_t(frame.width) + overscan;
            for (std::size_t x = 0; x < width; ++x)
                if (frame.coverage[frame_row + x]) body(y * width + x, frame_row + x);
        }
    });
}

}  // namespace

LightShading::LightShading(const Light& light, const glm::dvec3& origin_ws)
    : kind_(light.kind),
      position_rel_(glm::dvec3(light.world_from_light[3]) - origin_ws),
      axis_(-glm::dvec3(light.world_from_light[2])) {
    constexpr double kPi = std::numbers::pi;
    const bool is_ball = kind_ == LightKind::Point || kind_ == LightKind::Spot;
    // Lambert's surface returns E / pi. E of a sun is its strength; of a ball of W watts W / (4 pi r^2), a spot being a
    // ball behind a mask; of a flat lamp, seen under the cosine of its own angle, W / (pi r^2).
    scale_ = float(kind_ == LightKind::Sun ? 1 / kPi : is_ball ? 1 / (4 * kPi * kPi) : 1 / (kPi * kPi));
    cone_cos_ = float(std::cos(0.5 * light.spot_angle));
    blend_ = float((1.0 - std::cos(0.5 * light.spot_angle)) * light.spot_blend);
    const glm::dmat3 axes(light.world_from_light);
    local_from_ws_ = glm::transpose(glm::dmat3(axes[0] / light.spot_scale.x, axes[1] / light.spot_scale.y, axes[2]));
    const double size = is_ball ? light.radius : 0.25 * (light.area_size.x + light.area_size.y);
    least_distance_squared_ = std::max(float(size * size), 1e-30f);
}

float LightShading::shape(const glm::vec3& to_light) const {
    if (kind_ == LightKind::Area) return std::max(0.0f, -glm::dot(axis_, to_light));
    if (kind_ != LightKind::Spot) return 1;
    const float inside = glm::normalize(local_from_ws_ * to_light).z - cone_cos_;
    if (blend_ <= 0) return inside >= 0 ? 1.0f : 0.0f;
    const float t = std::clamp(inside / blend_, 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

float LightShading::get_radiance(const glm::vec3& position_rel, const glm::vec3& normal) const {
    if (kind_ == LightKind::Sun) return scale_ * std::max(0.0f, -glm::dot(normal, axis_));
    const glm::vec3 to_light = position_rel_ - position_rel;
    const float distance_squared = glm::dot(to_light, to_light);
    if (!(distance_squared > 0)) return 0;
    const float inverse_distance = 1.0f / std::sqrt(distance_squared);
    const float cosine = glm::dot(normal, to_light) * inverse_distance;
    if (cosine <= 0) return 0;
    const float cone = shape(to_light * inverse_distance);
    return scale_ * cosine * cone / std::max(distance_squared, least_distance_squared_);
}

ClayPicture::ClayPicture(int width, int height) : image_{width, height, 4, {}} {
    image_.data.assign(std::size_t(width) * std::size_t(height) * 4, 0.0f);
}

void ClayPicture::add_surface(ThreadPool& threads, const Frame& frame, float weight) {
    for_each_pixel(threads, frame, [&](std::size_t pixel, std::size_t frame_pixel) {
        const float up = 0.5f + 0.5f * frame.normals[frame_pixel].z;
        const glm::vec3 light = kClay * (kFloor + up * (kSky - kFloor)) * weight;
        float* out = image_.data.data() + 4 * pixel;
        for (int c = 0; c < 3; ++c) out[c] += light[c];
        out[3] += weight;
    });
}

void ClayPicture::add_light(ThreadPool& threads, const Frame& frame, const Light& light,
                            std::span<const float> visibility, float weight) {
    const LightShading shading(light, frame.origin_ws);
    const glm::vec3 color = kClay * light.color * float(light.energy);
    for_each_pixel(threads, frame, [&](std::size_t pixel, std::size_t frame_pixel) {
        if (visibility[pixel] <= 0) return;
        const std::uint8_t group = frame.scene->instances[frame.ids[frame_pixel].instance].receiver_group;
        if (!(light.receiver_set >> group & 1)) return;
        const float radiance = shading.get_radiance(frame.positions_rel[frame_pixel], frame.normals[frame_pixel]);
        float* out = image_.data.data() + 4 * pixel;
        for (int c = 0; c < 3; ++c)
            out[c] += weight * std::clamp(visibility[pixel] * radiance * color[c], -kLargestRadiance, kLargestRadiance);
    });
}

}  // namespace shadow_layers
