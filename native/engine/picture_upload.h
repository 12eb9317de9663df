// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "gl/texture.h"
#include "shadow_layers/request.h"

namespace shadow_layers {

class Engine;

/// Brings pictures of one channel from the CPU to the GL, each in the place of the last.
class PictureUpload {
public:
    /// R32F of the image's size; valid until the next call.
    const gl::Texture& put(Engine& engine, const Image& image);

private:
    std::optional<gl::Texture> texture_;
};

}  // namespace shadow_layers
