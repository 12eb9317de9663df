// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/moment_map.h"

#include <algorithm>
#include <cmath>

#include "base/hash.h"
#include "engine/banded_draw.h"
#include "gl/sampler.h"
#include "light_params.h"
#include "moment_limits.h"

namespace shadow_layers {
namespace {

// Of the four floats of a tap and what is made of them, against the plain read that bands are measured by.
constexpr double kWorkPerTap = 6;

/// Float format with as many channels: averages lose nothing on their way to a map of 16 bits.
GLenum wide_format(GLenum format) {
    switch (gl::format_info(format).channel_count) {
        case 1:
            return GL_R32F;
        case 2:
            return GL_RG32F;
        default:
            return GL_RGBA32F;
    }
}

bool is_float(GLenum format) { return format != GL_RG16 && format != GL_RGBA16; }

int count_levels(int widest_texels) {
    int levels = 1;
    while ((1 << (levels - 1)) < widest_texels) ++levels;
    return levels;
}

/// An array of floats, element by element.
void set_floats(const gl::Program& program, const std::string& name, const std::vector<float>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
        std::string element = name;
        element.append("[").append(std::to_string(k)).append("]");
        program.set(element.c_str(), values[k]);
    }
}

void set_blur(const gl::Program& program, const MomentMapOptions& options) {
    program.set("u_radius", options.radius);
    const std::vector<double> weights = compute_blur_weights(options.radius, options.filter);
    set_floats(program, "u_weights", {weights.begin(), weights.end()});
}

class MomentMapMaker {
public:
    MomentMapMaker(Engine& engine, const DepthMap& depth_map, const MomentMapOptions& options)
        : engine_(engine), depth_tx_(*depth_map.texture), options_(options) {}

    std::shared_ptr<gl::Texture> make(const std::vector<float>& relative_ranges) {
        const int size = depth_tx_.width(), layers = depth_tx_.layers();
        const int levels = std::min(count_levels(options_.widest_texels), count_levels(size));
        auto texture = std::make_shared<gl::Texture>(
            engine_.device(), gl::TextureDesc{options_.format, size, size, layers, levels}, "moment map");
        std::shared_ptr<gl::Texture> rows_tx;
        if (options_.radius > 0)
            rows_tx = std::make_shared<gl::Texture>(
                engine_.device(), gl::TextureDesc{wide_format(options_.format), size, size}, "moments, rows averaged");
        for (int layer = 0; layer < layers; ++layer) {
            gl::Framebuffer map_fb(engine_.device(), "moment map layer");
            map_fb.attach_color(0, texture, layer);
            if (options_.radius == 0) {
                encode(layer, relative_ranges[std::size_t(layer)], map_fb);
                continue;
            }
            gl::Framebuffer rows_fb(engine_.device(), "moments, rows averaged");
            rows_fb.attach_color(0, rows_tx);
            encode(layer, relative_ranges[std::size_t(layer)], rows_fb);
            blur_columns(*rows_tx, map_fb);
        }
        make_levels(texture);
        texture->set_filter(levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
        return texture;
    }

private:
    void encode(int layer, float relative_range, const gl::Framebuffer& target) {
        const auto timer = engine_.time_stage("moment_map");
        const gl::Program& program =
            engine_.program("frame/fullscreen.vert", "stages/moment_map.frag", {{"ENCODE", options_.encode}});
        program.use();
        program.set("u_layer", layer);
        program.set("u_relative_range", relative_range);
        program.set("u_exponents", glm::vec2(options_.exponents));
        set_blur(program, options_);
        depth_tx_.bind(kDepthMapUnit);
        const gl::ValueSampler depths(engine_.device(), kDepthMapUnit, "depths as values");
        target.bind();
        draw_fullscreen_in_bands(engine_, target.width(), target.height(), kWorkPerTap * (2 * options_.radius + 1));
    }

    void blur_columns(const gl::Texture& rows_tx, const gl::Framebuffer& target) {
        const auto timer = engine_.time_stage("moment_blur");
        const gl::Program& program = engine_.program("frame/fullscreen.vert", "stages/moment_blur.frag");
        program.use();
        set_blur(program, options_);
        rows_tx.bind(0);
        target.bind();
        draw_fullscreen_in_bands(engine_, target.width(), target.height(), kWorkPerTap * (2 * options_.radius + 1));
    }

    void make_levels(const std::shared_ptr<gl::Texture>& texture) {
        if (texture->levels() < 2) return;
        const auto timer = engine_.time_stage("moment_levels");
        const gl::Program& program = engine_.program("frame/fullscreen.vert", "stages/moment_level.frag");
        for (int level = 1; level < texture->levels(); ++level) {
            engine_.gl().TextureBarrier();  // the level before this one was drawn into the same texture
            for (int layer = 0; layer < texture->layers(); ++layer) {
                gl::Framebuffer target(engine_.device(), "moment map level");
                target.attach_color(0, texture, layer, level);
                program.use();
                program.set("u_layer", layer);
                program.set("u_from_level", level - 1);
                program.set("u_size", glm::ivec2(target.width(), target.height()));
                texture->bind(0);
                target.bind();
                draw_fullscreen_in_bands(engine_, target.width(), target.height(), kWorkPerTap * 9);
            }
        }
    }

    Engine& engine_;
    const gl::Texture& depth_tx_;
    const MomentMapOptions& options_;
};

std::vector<float> find_relative_ranges(const LightSample& sample) {
    std::vector<float> relative_ranges;
    for (const LightView& view : sample.views)
        relative_ranges.push_back(view.perspective ? float(view.far_ls / view.near_ls - 1) : 0.0f);
    if (relative_ranges.empty()) relative_ranges.push_back(0.0f);
    return relative_ranges;
}

}  // namespace

std::vector<double> compute_blur_weights(int radius, BlurFilter filter) {
    std::vector<double> weights;
    const double deviation = 0.5 * (radius + 0.5);
    double sum = 0;
    for (int k = 0; k <= radius; ++k) {
        weights.push_back(filter == BlurFilter::Box ? 1 : std::exp(-0.5 * k * k / (deviation * deviation)));
        sum += k == 0 ? weights.back() : 2 * weights.back();
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

double compute_blur_variance(int radius, BlurFilter filter) {
    const std::vector<double> weights = compute_blur_weights(radius, filter);
    double variance = 0;
    for (int k = 1; k <= radius; ++k) variance += 2 * weights[std::size_t(k)] * k * k;
    return variance;
}

void MomentMap::bind(const gl::Program& program) const {
    texture->bind(kMomentMapUnit);
    set_floats(program, "u_relative_ranges", relative_ranges);
    program.set("u_kernel", glm::vec3(float(compute_blur_variance(options.radius, options.filter)),
                                      float(options.radius), float(1 << (texture->levels() - 1))));
    const int bits =
        8 * gl::format_info(options.format).bytes_per_texel / gl::format_info(options.format).channel_count;
    const double unit = bits == 32 ? std::exp2(-24) : is_float(options.format) ? std::exp2(-11) : std::exp2(-17);
    program.set("u_unit_roundoff", float(unit));
}

int find_margin_texels(const MomentMapOptions& options) {
    const int levels = options.widest_texels > 1 ? 2 * options.widest_texels + 1 : 0;
    return options.radius + levels;
}

std::shared_ptr<const MomentMap> render_moment_map(Engine& engine, const LightSample& sample, const DepthMap& depth_map,
                                                   const MomentMapOptions& options) {
    const ContentKey key = KeyBuilder("moment_map")
                               .add(depth_map.key)
                               .add(options.encode)
                               .add(options.format)
                               .add(options.exponents)
                               .add(options.radius)
                               .add(options.filter)
                               .add(options.widest_texels)
                               .key();
    auto map = engine.stages().get<MomentMap>(key, [&] {
        auto made = std::make_shared<MomentMap>();
        made->relative_ranges = find_relative_ranges(sample);
        made->options = options;
        made->texture = MomentMapMaker(engine, depth_map, options).make(made->relative_ranges);
        made->key = key;
        return made;
    });
    engine.count("map_bytes", std::int64_t(map->byte_size()));
    return map;
}

}  // namespace shadow_layers
