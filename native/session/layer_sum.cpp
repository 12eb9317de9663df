// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/layer_sum.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "gl/texture.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kBlock = 1 << 15;

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

LayerSum::LayerSum(ThreadPool& threads, const TechniqueDescriptor& descriptor, int sample_count)
    : threads_(threads), descriptor_(descriptor), sample_count_(sample_count) {}

std::size_t LayerSum::bytes_needed(const TechniqueDescriptor& descriptor, const PixelRect& region) {
    std::size_t channels = 0;
    for (const OutputSpec& output : descriptor.outputs) channels += std::size_t(output.channels);
    return channels * std::size_t(region.width) * std::size_t(region.height) * sizeof(float);
}

void LayerSum::begin_sample(const Frame& frame) {
    frame_ = &frame;
    for (auto& [channel, image] : sample_) image.width = 0;  // not set yet; keeps the memory
}

const OutputSpec& LayerSum::find_output(const std::string& channel) const {
    for (const OutputSpec& output : descriptor_.outputs)
        if (output.id == channel) return output;
    throw Error("technique \"" + descriptor_.id + "\" sets the channel \"" + channel + "\", which it does not declare");
}

Image& LayerSum::start_channel(const OutputSpec& output) {
    Image& image = sample_[output.id];
    image.width = frame_->region.width;
    image.height = frame_->region.height;
    image.channels = output.channels;
    image.data.resize(std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels));
    return image;
}

void LayerSum::set(const std::string& channel, const gl::Texture& texture) {
    const OutputSpec& output = find_output(channel);
    const gl::FormatInfo info = gl::format_info(texture.format());
    if (info.type != GL_FLOAT || info.channel_count != output.channels || texture.width() != frame_->width ||
        texture.height() != frame_->height)
        throw Error("technique \"" + descriptor_.id + "\", channel \"" + channel + "\": a texture of " +
                    size_text(texture.width(), texture.height()) + " and " + std::to_string(info.channel_count) +
                    " channels for a frame of " + size_text(frame_->width, frame_->height) + " and " +
                    std::to_string(output.channels));
    Image& image = start_channel(output);
    texture.read(frame_->overscan_px, frame_->overscan_px, image.width, image.height, image.data.data(),
                 image.data.size() * sizeof(float));
}

void LayerSum::set(const std::string& channel, Image image) {
    const OutputSpec& output = find_output(channel);
    const auto channels = std::size_t(output.channels);
    if (image.width != frame_->width || image.height != frame_->height || image.channels != output.channels ||
        image.data.size() != frame_->pixel_count() * channels)
        throw Error("technique \"" + descriptor_.id + "\", channel \"" + channel + "\": an image of " +
                    size_text(image.width, image.height) + " for a frame of " +
                    size_text(frame_->width, frame_->height));
    if (frame_->overscan_px == 0) {
        sample_[channel] = std::move(image);
        return;
    }
    Image& cropped = start_channel(output);
    const auto overscan = std::size_t(frame_->overscan_px), row = std::size_t(cropped.width) * channels;
    for (std::size_t y = 0; y < std::size_t(cropped.height); ++y) {
        const std::size_t from = ((y + overscan) * std::size_t(frame_->width) + overscan) * channels;
        std::copy_n(image.data.begin() + std::ptrdiff_t(from), row, cropped.data.begin() + std::ptrdiff_t(y * row));
    }
}

void LayerSum::check_values(const std::string& channel, Image& image) const {
    const bool is_visibility = channel == "visibility";
    std::atomic<std::size_t> bad_count{0};
    threads_.parallel_for(image.data.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        float* values = image.data.data();
        std::size_t bad = 0;
        for (std::size_t i = begin; i < end; ++i) {
            bad += !(std::abs(values[i]) <= std::numeric_limits<float>::max());
            // Rounding may leave [0, 1] by a hair; layers are multiplied into pictures and must not.
            if (is_visibility) values[i] = values[i] > 0 ? (values[i] < 1 ? values[i] : 1.0f) : 0.0f;
        }
        bad_count += bad;
    });
    if (bad_count > 0)
        throw DriverError("technique \"" + descriptor_.id + "\", channel \"" + channel +
                          "\": " + std::to_string(bad_count) + " of " + std::to_string(image.data.size()) +
                          " values are not finite numbers; report this with the scene's snapshot and the GL renderer");
}

void LayerSum::end_sample() {
    for (const OutputSpec& output : descriptor_.outputs) {
        const auto found = sample_.find(output.id);
        if (found == sample_.end() || found->second.width == 0)
            throw Error("technique \"" + descriptor_.id + "\" does not set its channel \"" + output.id + "\"");
        check_values(output.id, found->second);
        if (sample_count_ == 1) continue;
        Image& sum = sum_[output.id];
        if (samples_done_ == 0) {
            sum = found->second;
            continue;
        }
        threads_.parallel_for(sum.data.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) sum.data[i] += found->second.data[i];
        });
    }
    ++samples_done_;
}

std::map<std::string, Image> LayerSum::take() {
    if (sample_count_ == 1) return std::move(sample_);
    // Divided, not scaled: n ones must make exactly one.
    for (auto& [channel, image] : sum_)
        for (float& value : image.data) value /= float(sample_count_);
    return std::move(sum_);
}

}  // namespace shadow_layers
