// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "frame/clay.h"
#include "frame/frame.h"
#include "shadow_layers/request.h"

namespace shadow_layers {

/// The pictures of a result that belong to no layer: coverage, the clay picture and the auxiliary ones. Built up over
/// the picture's samples.
class FramePictures {
public:
    FramePictures(ThreadPool& threads, const RenderRequest& request, const PixelRect& region);

    /// The auxiliary pictures are those of the first sample.
    void add_frame(const Frame& frame, std::size_t sample);
    bool has_clay() const { return clay_.has_value(); }
    /// `visibility`: of the region's size, the light's in this sample.
    void add_light(const Frame& frame, const Light& light, const std::vector<float>& visibility);
    /// Moves all into the result.
    void finish(FrameResult& result);

private:
    void add_aux(const Frame& frame);

    ThreadPool& threads_;
    const RenderRequest& request_;
    PixelRect region_;
    Image coverage_;
    std::optional<ClayPicture> clay_;
    std::map<std::string, Image> aux_;
    IdImage ids_;
};

}  // namespace shadow_layers
