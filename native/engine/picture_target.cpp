// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/picture_target.h"

#include "engine/engine.h"

namespace shadow_layers {

bool PictureTarget::fits(int width, int height, const std::vector<GLenum>& formats) const {
    if (textures_.size() != formats.size()) return false;
    for (std::size_t k = 0; k < formats.size(); ++k) {
        const gl::Texture& texture = *textures_[k];
        if (texture.format() != formats[k] || texture.width() != width || texture.height() != height) return false;
    }
    return true;
}

std::size_t PictureTarget::byte_size() const {
    std::size_t bytes = 0;
    for (const auto& texture : textures_) bytes += texture->byte_size();
    return bytes;
}

void PictureTarget::fit(Engine& engine, int width, int height, const std::vector<GLenum>& formats, const char* label) {
    if (fits(width, height, formats)) return;
    // First gives back what is held.
    framebuffer_ = gl::Framebuffer();
    textures_.clear();
    framebuffer_ = gl::Framebuffer(engine.device(), label);
    int colors = 0;
    for (const GLenum format : formats) {
        textures_.push_back(
            std::make_shared<gl::Texture>(engine.device(), gl::TextureDesc{format, width, height}, label));
        if (format == GL_DEPTH_COMPONENT32F)
            framebuffer_.attach_depth(textures_.back());
        else
            framebuffer_.attach_color(colors++, textures_.back());
    }
}

}  // namespace shadow_layers
