// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The moment map stage against brute force on the CPU: random depths, several layers, all encodings, rims and mipmaps.
#include "stages/moment_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "gl/gl_fixture.h"

namespace shadow_layers::test {
namespace {

constexpr int kLayers = 3;

/// Views of three ranges of depth, the last one parallel, over random depths with some empty texels.
struct RandomMap {
    LightSample position;
    DepthMap depths;
    std::vector<float> depth_rz;  ///< layer, row, column
    int size = 0;

    RandomMap(Engine& engine, int size_texels, unsigned seed) : size(size_texels) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> unit(0, 1);
        auto texture = std::make_shared<gl::Texture>(
            engine.device(), gl::TextureDesc{GL_DEPTH_COMPONENT32F, size, size, kLayers}, "random depths");
        texture->set_compare(GL_GEQUAL);
        depth_rz.resize(std::size_t(kLayers * size * size));
        for (float& depth : depth_rz) depth = unit(random) < 0.2f ? 0 : unit(random);
        for (int layer = 0; layer < kLayers; ++layer) {
            texture->upload(&depth_rz[std::size_t(layer * size * size)], 0, layer);
            LightView view;
            view.perspective = layer < 2;
            view.size_texels = size;
            view.near_ls = 1, view.far_ls = layer == 0 ? 4 : 300;
            position.views.push_back(view);
        }
        depths.texture = texture;
        depths.key = {seed, std::uint64_t(size)};
    }

    double depth(int layer, int x, int y) const {
        const int last = size - 1;
        const double rz =
            depth_rz[std::size_t((layer * size + std::clamp(y, 0, last)) * size + std::clamp(x, 0, last))];
        if (rz <= 0) return 1;
        const LightView& view = position.views[std::size_t(layer)];
        const double relative_range = view.perspective ? view.far_ls / view.near_ls - 1 : 0;
        return 1.8 * (1 - rz) / (1 + relative_range * rz) - 1;
    }

    /// Mean of `encode(depth)` under the whole two-dimensional kernel.
    template <class Encode>
    double blurred(int layer, int x, int y, const MomentMapOptions& options, const Encode& encode) const {
        double sum = 0, total = 0;
        for (int v = -options.radius; v <= options.radius; ++v)
            for (int u = -options.radius; u <= options.radius; ++u) {
                const double deviation = 0.5 * (options.radius + 0.5);
                const double weight =
                    options.filter == BlurFilter::Box ? 1 : std::exp(-0.5 * (u * u + v * v) / (deviation * deviation));
                sum += weight * encode(depth(layer, x + u, y + v));
                total += weight;
            }
        return sum / total;
    }
};

class MomentMapTest : public EngineTest {};

TEST_F(MomentMapTest, BlursEqualBruteForceEverywhereAndKeepLayersApart) {
    const RandomMap map(engine(), 21, 3);
    for (const BlurFilter filter : {BlurFilter::Box, BlurFilter::Gaussian})
        for (const int radius : {0, 1, 4, 32}) {
            MomentMapOptions options;
            options.encode = "encode_moments";
            options.radius = radius, options.filter = filter;
            const auto made = render_moment_map(engine(), map.position, map.depths, options);
            const auto texels = made->texture->download<glm::vec4>();
            ASSERT_EQ(texels.size(), map.depth_rz.size());
            for (int layer = 0; layer < kLayers; ++layer)
                for (int y = 0; y<map.size; y += radius> 4 ? 5 : 1)
                    for (int x = 0; x<map.size; x += radius> 4 ? 5 : 1)
                        for (int power = 1; power <= 4; ++power)
                            ASSERT_NEAR(texels[std::size_t((layer * map.size + y) * map.size + x)][power - 1],
                                        map.blurred(layer, x, y, options, [&](double z) { return std::pow(z, power); }),
                                        2e-6)
                                << "radius " << radius << ", layer " << layer << " at " << x << ", " << y;
        }
}

TEST_F(MomentMapTest, EveryEncodingIsAveragedAsItIsStored) {
    const RandomMap map(engine(), 17, 4);
    MomentMapOptions options;
    options.radius = 2;
    const auto texel = [&](const auto& values, int layer, int x, int y, int channels, int c) {
        return double(values[std::size_t(((layer * map.size + y) * map.size + x) * channels + c)]);
    };
    const auto check = [&](const char* encode, GLenum format, glm::dvec2 exponents, int c, double relative,
                           double absolute, const std::function<double(double)>& reference) {
        options.encode = encode, options.format = format, options.exponents = exponents;
        const auto made = render_moment_map(engine(), map.position, map.depths, options);
        const int channels = gl::format_info(format).channel_count;
        std::vector<double> values;
        if (format == GL_RG16 || format == GL_RGBA16)
            for (const auto v : made->texture->download<std::uint16_t>()) values.push_back(v / 65535.0);
        else
            for (const auto v : made->texture->download<float>()) values.push_back(v);
        for (int layer = 0; layer < kLayers; ++layer)
            for (int y = 0; y < map.size; y += 2)
                for (int x = 0; x < map.size; x += 2) {
                    const double truth = map.blurred(layer, x, y, options, reference);
                    ASSERT_NEAR(texel(values, layer, x, y, channels, c), truth, absolute + relative * std::abs(truth))
                        << encode << " component " << c;
                }
    };
    check("encode_variance", GL_RG32F, {}, 1, 0, 1e-6, [](double z) { return z * z; });
    check("encode_variance_fixed", GL_RG16, {}, 1, 0, 1e-5, [](double z) { return 1 - z * z; });
    check("encode_exponential", GL_R32F, {80, 0}, 0, 1e-4, 0, [](double z) { return std::exp(80 * z); });
    check("encode_exponential_variance", GL_RGBA32F, {40, 20}, 1, 1e-4, 0, [](double z) { return std::exp(80 * z); });
    check("encode_exponential_variance", GL_RGBA32F, {40, 20}, 2, 1e-4, 0, [](double z) { return -std::exp(-20 * z); });
    check("encode_moments_fixed", GL_RGBA16, {}, 3, 0, 1e-5, [](double z) { return 0.5 * (z * z + z * z * z * z); });
}

TEST_F(MomentMapTest, MipmapsAreTheMeansOfTheAreasTheyCover) {
    const RandomMap map(engine(), 45, 5);  // 45, 22, 11, 5: odd sides on the way
    MomentMapOptions options;
    options.encode = "encode_variance", options.format = GL_RG32F;
    options.widest_texels = 8;
    const auto made = render_moment_map(engine(), map.position, map.depths, options);
    ASSERT_EQ(made->texture->levels(), 4);
    auto finer = made->texture->download<glm::vec2>(0);
    for (int level = 1; level < 4; ++level) {
        const int side = 45 >> level, finer_side = 45 >> (level - 1);
        const auto texels = made->texture->download<glm::vec2>(level);
        ASSERT_EQ(texels.size(), std::size_t(kLayers * side * side));
        const double scale = double(finer_side) / side;
        const auto covered = [&](int at, int texel) {
            return std::max(0.0, std::min(at + 1.0, (texel + 1) * scale) - std::max(double(at), texel * scale));
        };
        for (int layer = 0; layer < kLayers; ++layer) {
            double mean = 0, finer_mean = 0;
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) {
                    double sum = 0;
                    for (int v = 0; v < finer_side; ++v)
                        for (int u = 0; u < finer_side; ++u)
                            sum += covered(u, x) * covered(v, y) *
                                   finer[std::size_t((layer * finer_side + v) * finer_side + u)].x;
                    const double texel = texels[std::size_t((layer * side + y) * side + x)].x;
                    ASSERT_NEAR(texel, sum / (scale * scale), 5e-6) << "level " << level << " at " << x << ", " << y;
                    mean += texel / (side * side);
                }
            for (int k = 0; k < finer_side * finer_side; ++k)
                finer_mean += finer[std::size_t(layer * finer_side * finer_side + k)].x / (finer_side * finer_side);
            EXPECT_NEAR(mean, finer_mean, 1e-5) << "no texel counts twice";
        }
        finer = texels;
    }
}

TEST_F(MomentMapTest, AConstantDepthStaysAsItIs) {
    RandomMap map(engine(), 40, 6);
    std::fill(map.depth_rz.begin(), map.depth_rz.end(), 0.37f);
    auto texture = std::make_shared<gl::Texture>(engine().device(),
                                                 gl::TextureDesc{GL_DEPTH_COMPONENT32F, 40, 40, kLayers}, "flat");
    for (int layer = 0; layer < kLayers; ++layer) texture->upload(map.depth_rz.data(), 0, layer);
    map.depths.texture = texture;
    MomentMapOptions options;
    options.encode = "encode_moments";
    options.radius = 5, options.filter = BlurFilter::Gaussian, options.widest_texels = 16;
    const auto made = render_moment_map(engine(), map.position, map.depths, options);
    for (int level = 0; level < made->texture->levels(); ++level) {
        const auto texels = made->texture->download<glm::vec4>(level);
        for (std::size_t k = 0; k < texels.size(); ++k) {
            const double z = map.depth(int(k / (texels.size() / kLayers)), 0, 0);
            for (int power = 1; power <= 4; ++power)
                ASSERT_NEAR(texels[k][power - 1], std::pow(z, power), 5e-7) << level;
        }
    }
}

TEST_F(MomentMapTest, AreKeptByWhatTheyAreMadeOf) {
    const RandomMap map(engine(), 12, 7);
    MomentMapOptions options;
    options.encode = "encode_moments";
    const auto first = render_moment_map(engine(), map.position, map.depths, options);
    EXPECT_EQ(first, render_moment_map(engine(), map.position, map.depths, options));
    for (const auto& change : std::vector<std::function<void(MomentMapOptions&)>>{
             [](auto& o) { o.radius = 1; }, [](auto& o) { o.format = GL_RGBA16F; },
             [](auto& o) { o.encode = "encode_moments_fixed"; }, [](auto& o) { o.widest_texels = 2; },
             [](auto& o) { o.exponents.y = 1; }}) {
        MomentMapOptions other = options;
        change(other);
        EXPECT_NE(first, render_moment_map(engine(), map.position, map.depths, other));
    }
}

TEST(BlurWeights, AddUpAndHaveTheVarianceThatTruthsAreMadeFor) {
    for (int radius = 0; radius <= 32; ++radius) {
        EXPECT_NEAR(compute_blur_variance(radius, BlurFilter::Box), radius * (radius + 1) / 3.0, 1e-12);
        const auto weights = compute_blur_weights(radius, BlurFilter::Gaussian);
        double sum = weights[0];
        for (int k = 1; k <= radius; ++k) sum += 2 * weights[std::size_t(k)];
        EXPECT_NEAR(sum, 1, 1e-12);
    }
    // Cut at two standard deviations, a Gaussian keeps 0.774 of its variance; sums differ a little from the integral.
    const double deviation = 0.5 * 32.5;
    EXPECT_NEAR(compute_blur_variance(32, BlurFilter::Gaussian) / (deviation * deviation), 0.774, 0.01);
}

}  // namespace
}  // namespace shadow_layers::test
