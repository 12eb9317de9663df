// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/vertex_array.h"

namespace shadow_layers::gl {
namespace {

GLuint create_vertex_array(const Device& device) {
    GLuint id = 0;
    device.gl().CreateVertexArrays(1, &id);
    return id;
}

}  // namespace

VertexArray::VertexArray(const Device& device, std::string_view label)
    : Tracked(device, create_vertex_array(device), GL_VERTEX_ARRAY, label) {}

VertexArray& VertexArray::operator=(VertexArray&& other) noexcept {
    Tracked::operator=(std::move(other));
    return *this;
}

VertexArray::~VertexArray() {
    if (!id()) return;
    const GladGLContext& functions = gl();
    const GLuint name = take();
    functions.DeleteVertexArrays(1, &name);
}

void VertexArray::set_float(GLuint location, GLuint binding, int components, std::size_t offset) {
    gl().EnableVertexArrayAttrib(id(), location);
    gl().VertexArrayAttribFormat(id(), location, components, GL_FLOAT, GL_FALSE, GLuint(offset));
    gl().VertexArrayAttribBinding(id(), location, binding);
}

void VertexArray::set_uint(GLuint location, GLuint binding, int components, std::size_t offset) {
    gl().EnableVertexArrayAttrib(id(), location);
    gl().VertexArrayAttribIFormat(id(), location, components, GL_UNSIGNED_INT, GLuint(offset));
    gl().VertexArrayAttribBinding(id(), location, binding);
}

void VertexArray::set_buffer(GLuint binding, const Buffer& buffer, std::size_t stride, std::size_t offset,
                             int divisor) {
    gl().VertexArrayVertexBuffer(id(), binding, buffer.id(), GLintptr(offset), GLsizei(stride));
    gl().VertexArrayBindingDivisor(id(), binding, GLuint(divisor));
}

void VertexArray::set_index_buffer(const Buffer& buffer) { gl().VertexArrayElementBuffer(id(), buffer.id()); }

void VertexArray::bind() const { gl().BindVertexArray(id()); }

}  // namespace shadow_layers::gl
