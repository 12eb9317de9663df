// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/texture.h"

#include <utility>

#include "shadow_layers/error.h"

namespace shadow_layers::gl {

FormatInfo format_info(GLenum format) {
    switch (format) {
        case GL_R8:
            return {GL_RED, GL_UNSIGNED_BYTE, 1, 1};
        case GL_RG8:
            return {GL_RG, GL_UNSIGNED_BYTE, 2, 2};
        case GL_RGBA8:
            return {GL_RGBA, GL_UNSIGNED_BYTE, 4, 4};
        case GL_R16F:
            return {GL_RED, GL_HALF_FLOAT, 1, 2};
        case GL_RG16F:
            return {GL_RG, GL_HALF_FLOAT, 2, 4};
        case GL_RGBA16F:
            return {GL_RGBA, GL_HALF_FLOAT, 4, 8};
        case GL_R16:
            return {GL_RED, GL_UNSIGNED_SHORT, 1, 2};
        case GL_RG16:
            return {GL_RG, GL_UNSIGNED_SHORT, 2, 4};
        case GL_RGBA16:
            return {GL_RGBA, GL_UNSIGNED_SHORT, 4, 8};
        case GL_R32F:
            return {GL_RED, GL_FLOAT, 1, 4};
        case GL_RG32F:
            return {GL_RG, GL_FLOAT, 2, 8};
        case GL_RGB32F:
            return {GL_RGB, GL_FLOAT, 3, 12};
        case GL_RGBA32F:
            return {GL_RGBA, GL_FLOAT, 4, 16};
        case GL_R8UI:
            return {GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1, 1};
        case GL_R16UI:
            return {GL_RED_INTEGER, GL_UNSIGNED_SHORT, 1, 2};
        case GL_RG16UI:
            return {GL_RG_INTEGER, GL_UNSIGNED_SHORT, 2, 4};
        case GL_R32I:
            return {GL_RED_INTEGER, GL_INT, 1, 4};
        case GL_RG32I:
            return {GL_RG_INTEGER, GL_INT, 2, 8};
        case GL_R32UI:
            return {GL_RED_INTEGER, GL_UNSIGNED_INT, 1, 4};
        case GL_RG32UI:
            return {GL_RG_INTEGER, GL_UNSIGNED_INT, 2, 8};
        case GL_RGBA32UI:
            return {GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4, 16};
        case GL_DEPTH_COMPONENT32F:
            return {GL_DEPTH_COMPONENT, GL_FLOAT, 1, 4};
        case GL_DEPTH_COMPONENT16:
            return {GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, 1, 2};
        default:
            break;
    }
    throw DriverError("texture format " + std::to_string(format) + " is not listed in gl/texture.cpp");
}

namespace {

GLuint create_texture(const Device& device, const TextureDesc& desc, std::string_view label) {
    const int limit = device.limits().max_texture_size;
    if (desc.width < 1 || desc.height < 1 || desc.width > limit || desc.height > limit)
        throw DriverError("texture \"" + std::string(label) + "\" of " + std::to_string(desc.width) + "x" +
                          std::to_string(desc.height) + " texels: the driver allows 1 to " + std::to_string(limit));
    GLuint id = 0;
    device.gl().CreateTextures(desc.layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &id);
    return id;
}

}  // namespace

Texture::Texture(const Device& device, const TextureDesc& desc, std::string_view label)
    : Tracked(device, create_texture(device, desc, label), GL_TEXTURE, label), desc_(desc) {
    if (desc.layers > 0)
        gl().TextureStorage3D(id(), desc.levels, desc.format, desc.width, desc.height, desc.layers);
    else
        gl().TextureStorage2D(id(), desc.levels, desc.format, desc.width, desc.height);
    std::size_t bytes = 0;
    for (int level = 0; level < desc.levels; ++level) bytes += level_bytes(level);
    set_bytes(bytes);
    set_filter(GL_NEAREST);
    set_wrap(GL_CLAMP_TO_EDGE);
    try {
        device.check("making texture " + std::string(label) + ", " + std::to_string(bytes >> 20) + " MiB");
    } catch (...) {
        destroy();
        throw;
    }
}

Texture& Texture::operator=(Texture&& other) noexcept {
    Tracked::operator=(std::move(other));
    std::swap(desc_, other.desc_);
    return *this;
}

Texture::~Texture() { destroy(); }

void Texture::destroy() {
    if (!id()) return;
    const GladGLContext& functions = gl();
    const GLuint name = take();
    functions.DeleteTextures(1, &name);
}

void Texture::set_filter(GLenum filter) {
    const bool linear = filter != GL_NEAREST && filter != GL_NEAREST_MIPMAP_NEAREST;
    gl().TextureParameteri(id(), GL_TEXTURE_MIN_FILTER, GLint(filter));
    gl().TextureParameteri(id(), GL_TEXTURE_MAG_FILTER, linear ? GL_LINEAR : GL_NEAREST);
}

void Texture::set_wrap(GLenum wrap, float border_value) {
    gl().TextureParameteri(id(), GL_TEXTURE_WRAP_S, GLint(wrap));
    gl().TextureParameteri(id(), GL_TEXTURE_WRAP_T, GLint(wrap));
    const float border[4] = {border_value, border_value, border_value, border_value};
    gl().TextureParameterfv(id(), GL_TEXTURE_BORDER_COLOR, border);
}

void Texture::set_compare(GLenum function) {
    gl().TextureParameteri(id(), GL_TEXTURE_COMPARE_MODE, function ? GL_COMPARE_REF_TO_TEXTURE : GL_NONE);
    if (function) gl().TextureParameteri(id(), GL_TEXTURE_COMPARE_FUNC, GLint(function));
}

void Texture::bind(GLuint unit) const { gl().BindTextureUnit(unit, id()); }

void Texture::bind_image(GLuint unit, GLenum access, int level) const {
    gl().BindImageTexture(unit, id(), level, desc_.layers > 0, 0, access, desc_.format);
}

void Texture::upload(const void* data, int level, int layer) {
    const FormatInfo info = format_info(desc_.format);
    if (desc_.layers > 0)
        gl().TextureSubImage3D(id(), level, 0, 0, layer, level_width(level), level_height(level), 1, info.channels,
                               info.type, data);
    else
        gl().TextureSubImage2D(id(), level, 0, 0, level_width(level), level_height(level), info.channels, info.type,
                               data);
}

void Texture::read(int x, int y, int width, int height, void* data, std::size_t data_bytes, int level) const {
    const FormatInfo info = format_info(desc_.format);
    gl().GetTextureSubImage(id(), level, x, y, 0, width, height, std::max(1, desc_.layers), info.channels, info.type,
                            GLsizei(data_bytes), data);
}

void Texture::clear(const void* texel, int level) {
    const FormatInfo info = format_info(desc_.format);
    gl().ClearTexImage(id(), level, info.channels, info.type, texel);
}

std::size_t Texture::level_bytes(int level) const {
    return std::size_t(level_width(level)) * std::size_t(level_height(level)) * std::size_t(std::max(1, desc_.layers)) *
           std::size_t(format_info(desc_.format).bytes_per_texel);
}

}  // namespace shadow_layers::gl
