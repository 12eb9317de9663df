// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Which method of the distance transform is faster with the renderer in use, and what does a bound save? Border lines
// of rings; medians of 9 rounds in which all columns take turns, as ratios to the CPU method without a bound, on all
// threads.
//
//     distance_transform_bench [PLATFORM]      osmesa (default) or egl
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "base/clock.h"
#include "context/context.h"
#include "stages/distance_transform.h"

using namespace shadow_layers;

namespace {

constexpr int kRounds = 9, kBoundPx = 16;

std::vector<std::uint8_t> make_rings(int width, int height) {
    std::vector<std::uint8_t> mask(std::size_t(width) * std::size_t(height), 0);
    const double spacing = 0.125 * std::min(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double from_ring = std::fmod(std::hypot(x - 0.4 * width, y - 0.6 * height), spacing);
            mask[std::size_t(y) * std::size_t(width) + std::size_t(x)] = from_ring < 1 ? 1 : 0;
        }
    return mask;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

struct Column {
    const char* name;
    std::function<void()> work;
    std::vector<double> times_ms = {};
};

void measure_size(Engine& engine, int width, int height) {
    const std::vector<std::uint8_t> mask = make_rings(width, height);
    std::vector<std::uint32_t> nearest(mask.size());
    gl::Texture mask_tx(engine.device(), {GL_R8UI, width, height}, "mask");
    mask_tx.upload(mask.data());
    DistanceTransform transform;
    ThreadPool one(1);
    using Method = DistanceTransform::Method;
    const auto run = [&](Method method, const DistanceTransformOptions& options) {
        transform.run_by(engine, method, mask_tx, options);
        engine.finish();
    };
    Column columns[] = {
        {"cpu", [&] { run(Method::CPU, {}); }},
        {"cpu, bound", [&] { run(Method::CPU, {kBoundPx}); }},
        {"compute", [&] { run(Method::GL, {}); }},
        {"compute, bound", [&] { run(Method::GL, {kBoundPx}); }},
        {"1 thread, no GL", [&] { find_nearest_sites(mask, width, height, {}, one, nearest); }},
        {"threads, no GL", [&] { find_nearest_sites(mask, width, height, {}, engine.threads(), nearest); }},
    };
    for (int round = 0; round <= kRounds; ++round)
        for (Column& column : columns) {
            const WallClock clock;
            column.work();
            if (round > 0) column.times_ms.push_back(clock.elapsed_ms());  // the first one compiles and allocates
        }
    const double unit_ms = median(columns[0].times_ms);
    std::printf("| %d x %d |", width, height);
    for (const Column& column : columns) {
        const auto [least, most] = std::minmax_element(column.times_ms.begin(), column.times_ms.end());
        std::printf(" %.2f (%.2f-%.2f) |", median(column.times_ms) / unit_ms, *least / unit_ms, *most / unit_ms);
    }
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
    const auto context = make_context(argc > 1 ? argv[1] : "osmesa", 0);
    EngineOptions options;
    options.shader_dir = SHADOW_LAYERS_SHADER_DIR;
    Engine engine(*context, options);
    DistanceTransform transform;
    const bool cpu = transform.fastest_method(engine) == DistanceTransform::Method::CPU;
    std::printf("%s, %d threads; the transform's own choice: %s; bound: %d px; median (least-most) ratios\n",
                engine.device().renderer().c_str(), engine.threads().thread_count(), cpu ? "cpu" : "compute", kBoundPx);
    std::printf(
        "| picture | cpu | cpu, bound | compute | compute, bound | 1 thread, no GL | threads, no GL |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n");
    for (const auto& [width, height] : {std::pair{512, 512}, {1280, 720}, {1920, 1080}, {4096, 4096}})
        measure_size(engine, width, height);
    return 0;
}
