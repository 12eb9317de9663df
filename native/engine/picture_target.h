// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "gl/framebuffer.h"
#include "gl/texture.h"

namespace shadow_layers {

class Engine;

/// Textures of a picture's size that passes draw into, with the framebuffer that holds them. Kept by a technique or
/// stage between frames and made anew only where size or formats change.
class PictureTarget {
public:
    /// One texture per format, the colours first, in the order of their attachments; GL_DEPTH_COMPONENT32F is the
    /// depth. What the textures held is lost if they are made anew.
    void fit(Engine& engine, int width, int height, const std::vector<GLenum>& formats, const char* label);

    gl::Framebuffer& framebuffer() { return framebuffer_; }
    const gl::Texture& texture(std::size_t index = 0) const { return *textures_[index]; }
    std::size_t byte_size() const;

private:
    bool fits(int width, int height, const std::vector<GLenum>& formats) const;
    std::vector<std::shared_ptr<gl::Texture>> textures_;
    gl::Framebuffer framebuffer_;
};

}  // namespace shadow_layers
