// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The exact distance transform, by both of its methods, against a search over all sites. Ties are decided, so that the
// pictures must be equal bit for bit, not in distance only.
#include "stages/distance_transform.h"

#include <random>

#include "gl/gl_fixture.h"
#include "shadow_layers/error.h"

namespace shadow_layers::test {
namespace {

using Method = DistanceTransform::Method;

struct Mask {
    int width, height;
    std::vector<std::uint8_t> pixels;

    Mask(int mask_width, int mask_height)
        : width(mask_width), height(mask_height), pixels(std::size_t(width) * std::size_t(height), 0) {}
    std::uint8_t& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

/// 64 bits, so that nothing here can overflow as the code under test might.
std::int64_t square_of(std::int64_t x, std::int64_t y, std::uint32_t site) {
    const std::int64_t dx = x - std::int64_t(site & 0xFFFF), dy = y - std::int64_t(site >> 16);
    return dx * dx + dy * dy;
}

std::vector<std::uint32_t> list_sites(const Mask& mask) {
    std::vector<std::uint32_t> sites;
    for (std::size_t k = 0; k < mask.pixels.size(); ++k)
        if (mask.pixels[k])
            sites.push_back(std::uint32_t(k / std::size_t(mask.width)) << 16 |
                            std::uint32_t(k % std::size_t(mask.width)));
    return sites;
}

/// By definition: the first site in packed order at the least distance.
std::uint32_t search_nearest(const std::vector<std::uint32_t>& sites, int x, int y, std::int64_t bound) {
    std::uint32_t best = kNoSite;
    std::int64_t least = bound > 100000 ? std::numeric_limits<std::int64_t>::max() : bound * bound + 1;
    for (const std::uint32_t site : sites)
        if (const std::int64_t square = square_of(x, y, site); square < least) {
            least = square;
            best = site;
        }
    return best;
}

std::vector<std::uint32_t> search_all(const Mask& mask, int bound_px) {
    const std::vector<std::uint32_t> sites = list_sites(mask);
    std::vector<std::uint32_t> nearest;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) nearest.push_back(search_nearest(sites, x, y, bound_px));
    return nearest;
}

std::vector<std::uint32_t> find_on_cpu(const Mask& mask, int bound_px, ThreadPool& threads) {
    std::vector<std::uint32_t> nearest(mask.pixels.size());
    find_nearest_sites(mask.pixels, mask.width, mask.height, {bound_px}, threads, nearest);
    return nearest;
}

constexpr int kUnbounded = DistanceTransformOptions{}.bound_px;

/// Sides, density and bound from small to large, with lines and blocks among them, where ties abound.
Mask make_random_mask(std::mt19937& random, int most_width, int most_height) {
    const auto pick = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
    Mask mask(pick(1, most_width), pick(1, most_height));
    switch (pick(0, 3)) {
        case 0:
            for (int k = pick(0, 5); k > 0; --k) mask.at(pick(0, mask.width - 1), pick(0, mask.height - 1)) = 1;
            break;
        case 1: {
            const int percent = pick(0, 100);
            for (std::uint8_t& pixel : mask.pixels) pixel = pick(0, 99) < percent ? std::uint8_t(pick(1, 255)) : 0;
            break;
        }
        case 2: {
            const int step = pick(1, 7), from = pick(0, 6);
            for (int y = 0; y < mask.height; ++y)
                for (int x = 0; x < mask.width; ++x) mask.at(x, y) = (x + 2 * y + from) % step == 0;
            break;
        }
        default: {
            const double radius = 1 + 0.5 * std::min(mask.width, mask.height) * pick(20, 100) / 100.0;
            for (int y = 0; y < mask.height; ++y)
                for (int x = 0; x < mask.width; ++x)
                    mask.at(x, y) =
                        std::abs(std::hypot(x - 0.5 * mask.width, y - 0.5 * mask.height) - radius) < 0.7 ? 1 : 0;
        }
    }
    return mask;
}

int pick_bound(std::mt19937& random) {
    const int kind = std::uniform_int_distribution(0, 2)(random);
    return kind == 0 ? kUnbounded : std::uniform_int_distribution(0, kind == 1 ? 6 : 60)(random);
}

std::string describe(const Mask& mask, int bound_px) {
    return std::to_string(mask.width) + "x" + std::to_string(mask.height) + ", " +
           std::to_string(list_sites(mask).size()) + " sites, bound " + std::to_string(bound_px);
}

TEST(NearestSites, EqualASearchOverThousandsOfRandomMasks) {
    ThreadPool threads(1);
    std::mt19937 random(1);
    for (int k = 0; k < 6000; ++k) {
        const Mask mask = make_random_mask(random, 24, 24);
        const int bound_px = pick_bound(random);
        ASSERT_EQ(find_on_cpu(mask, bound_px, threads), search_all(mask, bound_px)) << describe(mask, bound_px);
    }
}

TEST(NearestSites, EqualASearchOnLinesAndOnLongSides) {
    ThreadPool threads(1);
    std::mt19937 random(2);
    for (const auto& [width, height] :
         {std::pair{1, 1}, {1, 700}, {700, 1}, {1, 2100}, {2100, 1}, {1031, 9}, {9, 1031}})
        for (int k = 0; k < 6; ++k) {
            Mask mask(width, height);
            for (int site = 0; site < 3 * k; ++site) mask.pixels[random() % mask.pixels.size()] = 1;
            const int bound_px = pick_bound(random);
            ASSERT_EQ(find_on_cpu(mask, bound_px, threads), search_all(mask, bound_px)) << describe(mask, bound_px);
        }
}

TEST(NearestSites, ReachTheCornersOfTheLargestSides) {
    ThreadPool threads(1);
    for (const auto& [width, height] : {std::pair{kLargestTransformSide, 3}, {3, kLargestTransformSide}}) {
        Mask mask(width, height);
        mask.at(0, 0) = mask.at(width - 1, height - 1) = 1;
        const auto nearest = find_on_cpu(mask, kUnbounded, threads);
        const std::vector<std::uint32_t> sites = list_sites(mask);
        for (int y = 0; y < height; y += std::max(1, height / 97))
            for (int x = 0; x < width; x += std::max(1, width / 97))
                ASSERT_EQ(nearest[std::size_t(y) * std::size_t(width) + std::size_t(x)],
                          search_nearest(sites, x, y, kUnbounded));
    }
}

TEST(NearestSites, AreTheSameForAnyNumberOfThreads) {
    std::mt19937 random(3);
    const Mask mask = make_random_mask(random, 900, 700);
    ThreadPool one(1), three(3);
    for (const int bound_px : {kUnbounded, 9}) {
        const auto nearest = find_on_cpu(mask, bound_px, one);
        EXPECT_EQ(nearest, find_on_cpu(mask, bound_px, three));
        EXPECT_EQ(nearest, find_on_cpu(mask, bound_px, three));
    }
}

TEST(NearestSites, RefuseSizesAndBoundsThatCannotBe) {
    ThreadPool threads(1);
    std::vector<std::uint8_t> mask(6);
    std::vector<std::uint32_t> nearest(6);
    EXPECT_THROW(find_nearest_sites(mask, 2, 4, {}, threads, nearest), InputError);
    EXPECT_THROW(find_nearest_sites(mask, 0, 6, {}, threads, nearest), InputError);
    EXPECT_THROW(find_nearest_sites(mask, 2, 3, {-1}, threads, nearest), InputError);
    EXPECT_THROW(check_transform(kLargestTransformSide + 1, 1, {}), InputError);
    EXPECT_NO_THROW(find_nearest_sites(mask, 2, 3, {0}, threads, nearest));
}

class DistanceTransformTest : public EngineTest {
protected:
    void TearDown() override {
        transform_ = DistanceTransform();  // GL objects must not outlive their engine
        EngineTest::TearDown();
    }
    gl::Texture upload(const Mask& mask, GLenum format = GL_R8UI) {
        gl::Texture mask_tx(engine().device(), {format, mask.width, mask.height}, "mask");
        mask_tx.upload(mask.pixels.data());
        return mask_tx;
    }
    std::vector<std::uint32_t> run(Method method, const Mask& mask, int bound_px) {
        return transform_.run_by(engine(), method, upload(mask), {bound_px}).download<std::uint32_t>();
    }
    DistanceTransform transform_;
};

TEST_F(DistanceTransformTest, ByComputeShadersEqualsASearchOnRandomMasks) {
    std::mt19937 random(4);
    for (int k = 0; k < 150; ++k) {
        const Mask mask = make_random_mask(random, 40, 40);
        const int bound_px = pick_bound(random);
        ASSERT_EQ(run(Method::GL, mask, bound_px), search_all(mask, bound_px)) << describe(mask, bound_px);
    }
}

// Sides over 64 are cut into bands: margins between bands of rows, merged lists between bands of columns.
TEST_F(DistanceTransformTest, ByComputeShadersEqualsTheOtherMethodOverBands) {
    std::mt19937 random(5);
    for (int k = 0; k < 60; ++k) {
        const Mask mask = make_random_mask(random, 500, 300);
        const int bound_px = pick_bound(random);
        ASSERT_EQ(run(Method::GL, mask, bound_px), find_on_cpu(mask, bound_px, engine().threads()))
            << describe(mask, bound_px);
    }
}

TEST_F(DistanceTransformTest, ByComputeShadersTakesLinesLongSidesEmptyAndFullMasks) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 1300}, {1300, 1}, {2050, 70}, {70, 2050}})
        for (const int sites : {0, 1, 7, width * height}) {
            Mask mask(width, height);
            for (int k = 0; k < sites; ++k)
                mask.pixels[sites == width * height ? std::size_t(k) : std::size_t(k) * 7919 % mask.pixels.size()] = 1;
            for (const int bound_px : {kUnbounded, 20})
                ASSERT_EQ(run(Method::GL, mask, bound_px), find_on_cpu(mask, bound_px, engine().threads()))
                    << describe(mask, bound_px);
        }
}

TEST_F(DistanceTransformTest, AgreesOnSixteenMillionPixels) {
    Mask mask(4096, 4096);
    std::mt19937 random(6);
    for (int k = 0; k < 3000; ++k) mask.pixels[random() % mask.pixels.size()] = 1;
    const auto nearest = run(Method::CPU, mask, kUnbounded);
    EXPECT_EQ(nearest, run(Method::GL, mask, kUnbounded));
    const std::vector<std::uint32_t> sites = list_sites(mask);
    for (int k = 0; k < 2000; ++k) {
        const auto pixel = random() % nearest.size();
        ASSERT_EQ(nearest[pixel], search_nearest(sites, int(pixel % 4096), int(pixel / 4096), kUnbounded));
    }
}

TEST_F(DistanceTransformTest, ReadsNormalisedMasksToo) {
    std::mt19937 random(7);
    const Mask mask = make_random_mask(random, 90, 90);
    for (const Method method : {Method::CPU, Method::GL})
        EXPECT_EQ(transform_.run_by(engine(), method, upload(mask, GL_R8)).download<std::uint32_t>(),
                  search_all(mask, kUnbounded));
    const gl::Texture wrong(engine().device(), {GL_R32F, 4, 4}, "mask");
    EXPECT_THROW(transform_.run(engine(), wrong), InputError);
}

TEST_F(DistanceTransformTest, TakesAMethodThatItMeasuredOnce) {
    const Method method = transform_.fastest_method(engine());
    EXPECT_EQ(transform_.fastest_method(engine()), method);
    Mask mask(31, 17);
    mask.at(30, 16) = 1;
    EXPECT_EQ(transform_.run(engine(), upload(mask)).download<std::uint32_t>(), search_all(mask, kUnbounded));
}

}  // namespace
}  // namespace shadow_layers::test
