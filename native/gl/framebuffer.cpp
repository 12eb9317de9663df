// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/framebuffer.h"

#include <algorithm>
#include <utility>

#include "shadow_layers/error.h"

namespace shadow_layers::gl {
namespace {

GLuint create_framebuffer(const Device& device) {
    GLuint id = 0;
    device.gl().CreateFramebuffers(1, &id);
    return id;
}

}  // namespace

Framebuffer::Framebuffer(const Device& device, std::string_view label)
    : Tracked(device, create_framebuffer(device), GL_FRAMEBUFFER, label) {
    gl().NamedFramebufferDrawBuffer(id(), GL_NONE);
    gl().NamedFramebufferReadBuffer(id(), GL_NONE);
}

Framebuffer& Framebuffer::operator=(Framebuffer&& other) noexcept {
    Tracked::operator=(std::move(other));
    std::swap(colors_, other.colors_);
    std::swap(depth_, other.depth_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
    std::swap(checked_, other.checked_);
    return *this;
}

Framebuffer::~Framebuffer() {
    if (!id()) return;
    const GladGLContext& functions = gl();
    const GLuint name = take();
    functions.DeleteFramebuffers(1, &name);
}

void Framebuffer::attach(GLenum point, std::shared_ptr<const Texture> texture, int layer, int level) {
    if (layer < 0)
        gl().NamedFramebufferTexture(id(), point, texture->id(), level);
    else
        gl().NamedFramebufferTextureLayer(id(), point, texture->id(), level, layer);
    width_ = std::max(1, texture->width() >> level);
    height_ = std::max(1, texture->height() >> level);
    checked_ = false;
}

void Framebuffer::attach_color(int index, std::shared_ptr<const Texture> texture, int layer, int level) {
    attach(GL_COLOR_ATTACHMENT0 + GLenum(index), texture, layer, level);
    if (int(colors_.size()) <= index) colors_.resize(std::size_t(index) + 1);
    colors_[std::size_t(index)] = std::move(texture);
    std::vector<GLenum> points;
    for (std::size_t i = 0; i < colors_.size(); ++i) points.push_back(GL_COLOR_ATTACHMENT0 + GLenum(i));
    gl().NamedFramebufferDrawBuffers(id(), GLsizei(points.size()), points.data());
    gl().NamedFramebufferReadBuffer(id(), GL_COLOR_ATTACHMENT0);
}

void Framebuffer::attach_depth(std::shared_ptr<const Texture> texture, int layer) {
    attach(GL_DEPTH_ATTACHMENT, texture, layer, 0);
    depth_ = std::move(texture);
}

void Framebuffer::bind() const {
    if (!checked_) {
        const GLenum status = gl().CheckNamedFramebufferStatus(id(), GL_DRAW_FRAMEBUFFER);
        if (status != GL_FRAMEBUFFER_COMPLETE)
            throw DriverError("a framebuffer of " + std::to_string(width_) + "x" + std::to_string(height_) +
                              " is refused by the driver (status " + std::to_string(status) + ")");
        checked_ = true;
    }
    gl().BindFramebuffer(GL_FRAMEBUFFER, id());
    gl().Viewport(0, 0, width_, height_);
}

void Framebuffer::clear_color(int index, float r, float g, float b, float a) {
    const float value[4] = {r, g, b, a};
    gl().Disable(GL_SCISSOR_TEST);
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl().ClearNamedFramebufferfv(id(), GL_COLOR, index, value);
}

void Framebuffer::clear_color_uint(int index, std::uint32_t r, std::uint32_t g, std::uint32_t b, std::uint32_t a) {
    const GLuint value[4] = {r, g, b, a};
    gl().Disable(GL_SCISSOR_TEST);
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl().ClearNamedFramebufferuiv(id(), GL_COLOR, index, value);
}

void Framebuffer::clear_depth(float depth) {
    gl().Disable(GL_SCISSOR_TEST);
    gl().DepthMask(GL_TRUE);
    gl().ClearNamedFramebufferfv(id(), GL_DEPTH, 0, &depth);
}

}  // namespace shadow_layers::gl
