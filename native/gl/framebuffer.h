// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "gl/texture.h"

namespace shadow_layers::gl {

/// Keeps its attachments alive. The viewport is the attachments' size.
class Framebuffer : public Tracked {
public:
    Framebuffer() = default;
    Framebuffer(const Device& device, std::string_view label);
    Framebuffer(Framebuffer&&) noexcept = default;
    Framebuffer& operator=(Framebuffer&& other) noexcept;
    ~Framebuffer();

    /// `layer` < 0: the whole texture (layered for arrays). Color attachments must be set as 0, 1, 2, ...
    void attach_color(int index, std::shared_ptr<const Texture> texture, int layer = -1, int level = 0);
    void attach_depth(std::shared_ptr<const Texture> texture, int layer = -1);

    /// Binds for drawing, all color attachments on, with viewport over the whole. DriverError if incomplete.
    void bind() const;

    void clear_color(int index, float r, float g = 0, float b = 0, float a = 0);
    void clear_color_uint(int index, std::uint32_t r, std::uint32_t g = 0, std::uint32_t b = 0, std::uint32_t a = 0);
    void clear_depth(float depth = 0.0f);  ///< reversed depth: 0 = far

    int width() const { return width_; }
    int height() const { return height_; }

private:
    void attach(GLenum point, std::shared_ptr<const Texture> texture, int layer, int level);
    std::vector<std::shared_ptr<const Texture>> colors_;
    std::shared_ptr<const Texture> depth_;
    int width_ = 0, height_ = 0;
    mutable bool checked_ = false;
};

}  // namespace shadow_layers::gl
