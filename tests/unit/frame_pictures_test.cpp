// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/frame_pictures.h"

#include <gtest/gtest.h>

namespace shadow_layers {
namespace {

/// Three by two pixels with one of overscan round them; each holds its own number.
Frame make_frame() {
    Frame frame;
    frame.region = {0, 0, 3, 2};
    frame.overscan_px = 1;
    frame.width = 5, frame.height = 4;
    for (std::uint32_t pixel = 0; pixel < 20; ++pixel) {
        frame.ids.push_back({pixel, 100 + pixel});
        frame.positions_rel.emplace_back(pixel, 2 * pixel, -0.5f * float(pixel));
        frame.normals.emplace_back(0, 0, pixel);
        frame.coverage.push_back(1);
    }
    return frame;
}

FrameResult make_result(const Frame& frame, const std::vector<std::string>& aux) {
    ThreadPool threads(1);
    RenderRequest request;
    request.combined = false;
    request.samples = 1;
    request.aux = aux;
    FramePictures pictures(threads, request, frame.region);
    pictures.add_frame(frame, 0);
    FrameResult result;
    pictures.finish(result);
    return result;
}

TEST(FramePictures, HoldTheRegion) {
    const FrameResult result = make_result(make_frame(), {"ids", "position", "normal", "depth"});
    EXPECT_EQ(result.ids.data, (std::vector<std::int64_t>{6, 106, 7, 107, 8, 108, 11, 111, 12, 112, 13, 113}));
    EXPECT_EQ(result.aux.size(), 3u);
    EXPECT_EQ(result.aux.at("position").channels, 3);
    EXPECT_EQ(result.aux.at("position").data[3 * 4 + 1], 24.0f);
    EXPECT_EQ(result.aux.at("normal").data[3 * 4 + 2], 12.0f);
    EXPECT_EQ(result.aux.at("depth").data, (std::vector<float>{3, 3.5f, 4, 5.5f, 6, 6.5f}));  // along -Z
    const FrameResult none = make_result(make_frame(), {});
    EXPECT_TRUE(none.aux.empty() && none.ids.data.empty());
}

TEST(FramePictures, IdsAreExactUpToTheLast) {
    Frame frame = make_frame();
    // Of these a float holds the first alone.
    const std::uint32_t last = kNoId - 1;
    frame.ids[6] = {1u << 24, (1u << 24) + 1};
    frame.ids[7] = {(1u << 31) + 3, last};
    frame.ids[8] = {};
    const FrameResult result = make_result(frame, {"ids"});
    const std::vector<std::int64_t> row(result.ids.data.begin(), result.ids.data.begin() + 6);
    EXPECT_EQ(row, (std::vector<std::int64_t>{16777216, 16777217, 2147483651, 4294967294, -1, -1}));
}

}  // namespace
}  // namespace shadow_layers
