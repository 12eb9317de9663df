// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "gl/device.h"

namespace shadow_layers::gl {

/// Immutable storage. Filter is nearest and wrap is clamp to edge until set otherwise; an integer format can't be
/// filtered.
struct TextureDesc {
    GLenum format = GL_R32F;  ///< sized internal format; see bytes_per_texel
    int width = 1, height = 1;
    int layers = 0;  ///< 0: GL_TEXTURE_2D, else GL_TEXTURE_2D_ARRAY
    int levels = 1;
};

class Texture : public Tracked {
public:
    Texture() = default;
    /// Throws DriverError naming the label, size and limit if it's too large or memory is short.
    Texture(const Device& device, const TextureDesc& desc, std::string_view label);
    Texture(Texture&&) noexcept = default;
    Texture& operator=(Texture&& other) noexcept;
    ~Texture();

    GLenum target() const { return desc_.layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D; }
    GLenum format() const { return desc_.format; }
    int width() const { return desc_.width; }
    int height() const { return desc_.height; }
    int layers() const { return desc_.layers; }
    int levels() const { return desc_.levels; }

    /// GL_NEAREST, GL_LINEAR, or a mipmap filter (minification).
    void set_filter(GLenum filter);
    /// GL_CLAMP_TO_EDGE, or GL_CLAMP_TO_BORDER with a border value in all channels.
    void set_wrap(GLenum wrap, float border_value = 0);
    /// Depth comparison for shadow samplers: GL_GEQUAL (reversed depth), ...; 0 turns it off.
    void set_compare(GLenum function);

    void bind(GLuint unit) const;  ///< for sampling
    /// As a storage image; access is GL_READ_ONLY, GL_WRITE_ONLY or GL_READ_WRITE. Array textures bind all layers.
    void bind_image(GLuint unit, GLenum access, int level = 0) const;

    /// Whole level, tightly packed, in the format's own channels and type (float for R32F, uint32 for RG32UI, ...).
    void upload(const void* data, int level = 0, int layer = 0);
    template <class T>
    std::vector<T> download(int level = 0) const {
        std::vector<T> data(level_bytes(level) / sizeof(T));
        read(0, 0, level_width(level), level_height(level), data.data(), data.size() * sizeof(T), level);
        return data;
    }
    /// A rectangle of all layers, tightly packed, into `data`.
    void read(int x, int y, int width, int height, void* data, std::size_t data_bytes, int level = 0) const;

    void clear(const void* texel, int level = 0);  ///< texel in the format's own channels and type

private:
    void destroy();
    int level_width(int level) const { return std::max(1, desc_.width >> level); }
    int level_height(int level) const { return std::max(1, desc_.height >> level); }
    std::size_t level_bytes(int level) const;
    TextureDesc desc_;
};

/// Client-side layout of a sized internal format. Throws DriverError for a format that this folder does not list.
struct FormatInfo {
    GLenum channels = GL_RED, type = GL_FLOAT;
    int channel_count = 1, bytes_per_texel = 4;
};
FormatInfo format_info(GLenum format);

}  // namespace shadow_layers::gl
