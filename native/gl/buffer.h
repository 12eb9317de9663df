// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gl/device.h"

namespace shadow_layers::gl {

/// A buffer of fixed size, for any use.
class Buffer : public Tracked {
public:
    Buffer() = default;
    /// Not initialised. A size of 0 is made 4, because GL has no empty buffers.
    Buffer(const Device& device, std::size_t bytes, std::string_view label);
    /// Filled with `data`.
    template <class T>
    Buffer(const Device& device, std::span<const T> data, std::string_view label)
        : Buffer(device, data.data(), data.size_bytes(), label) {}
    Buffer(const Device& device, const void* data, std::size_t bytes, std::string_view label);
    Buffer(Buffer&&) noexcept = default;
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer();

    void write(const void* data, std::size_t bytes, std::size_t offset = 0);
    void read(void* data, std::size_t bytes, std::size_t offset = 0) const;
    template <class T>
    std::vector<T> download(std::size_t count, std::size_t offset = 0) const {
        std::vector<T> data(count);
        read(data.data(), count * sizeof(T), offset);
        return data;
    }
    void clear(std::uint32_t value = 0);  ///< every 32-bit word
    /// Drops the content, so that writing does not wait for draws that still read it.
    void orphan();

    /// GL_SHADER_STORAGE_BUFFER, GL_UNIFORM_BUFFER, GL_ATOMIC_COUNTER_BUFFER.
    void bind_base(GLenum target, GLuint index) const;
    void bind(GLenum target) const;  ///< GL_DRAW_INDIRECT_BUFFER, ...

private:
    void destroy();
};

}  // namespace shadow_layers::gl
