// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/buffer.h"

namespace shadow_layers::gl {

/// Vertex layout. Refers to buffers by name and does not keep them alive: keep both in one owner.
class VertexArray : public Tracked {
public:
    VertexArray() = default;
    VertexArray(const Device& device, std::string_view label);
    VertexArray(VertexArray&&) noexcept = default;
    VertexArray& operator=(VertexArray&& other) noexcept;
    ~VertexArray();

    /// Floats. `divisor` 0: per vertex, 1: per instance. `binding` names the buffer slot.
    void set_float(GLuint location, GLuint binding, int components, std::size_t offset);
    /// Unsigned 32-bit integers.
    void set_uint(GLuint location, GLuint binding, int components, std::size_t offset);
    void set_buffer(GLuint binding, const Buffer& buffer, std::size_t stride, std::size_t offset = 0, int divisor = 0);
    void set_index_buffer(const Buffer& buffer);
    void bind() const;
};

}  // namespace shadow_layers::gl
