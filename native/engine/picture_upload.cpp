// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/picture_upload.h"

#include "engine/engine.h"

namespace shadow_layers {

const gl::Texture& PictureUpload::put(Engine& engine, const Image& image) {
    if (!texture_ || texture_->width() != image.width || texture_->height() != image.height)
        texture_.emplace(engine.device(), gl::TextureDesc{GL_R32F, image.width, image.height}, "picture from the CPU");
    texture_->upload(image.data.data());
    return *texture_;
}

}  // namespace shadow_layers
