// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/engine.h"
#include "frame/frame.h"
#include "scene/bounds.h"

namespace shadow_layers {

/// Which instance and triangle each pixel sees, by the GL's rasteriser: ids in RG32UI, reversed depth in float.
class VisibilityBuffer {
public:
    VisibilityBuffer(Engine& engine, int width, int height);

    /// Draws the instances that the camera sees or sees as holes, and reads the ids into `ids` (width x height).
    /// `instance_bounds_ws`: world bounds of every instance of the scene.
    void draw(Engine& engine, const Scene& scene, const Camera& camera, const std::vector<Bounds>& instance_bounds_ws,
              std::vector<PixelIds>& ids);

    int width() const { return ids_tx_->width(); }
    int height() const { return ids_tx_->height(); }

private:
    std::shared_ptr<gl::Texture> ids_tx_, depth_tx_;
    gl::Framebuffer framebuffer_;
};

}  // namespace shadow_layers
