// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/buffer.h"

#include <algorithm>

namespace shadow_layers::gl {
namespace {

GLuint create_buffer(const Device& device) {
    GLuint id = 0;
    device.gl().CreateBuffers(1, &id);
    return id;
}

}  // namespace

Buffer::Buffer(const Device& device, std::size_t bytes, std::string_view label)
    : Buffer(device, nullptr, bytes, label) {}

Buffer::Buffer(const Device& device, const void* data, std::size_t bytes, std::string_view label)
    : Tracked(device, create_buffer(device), GL_BUFFER, label) {
    const std::size_t size = std::max<std::size_t>(bytes, 4);
    gl().NamedBufferData(id(), GLsizeiptr(size), bytes ? data : nullptr, GL_DYNAMIC_DRAW);
    set_bytes(size);
    try {
        device.check("making buffer " + std::string(label) + ", " + std::to_string(size >> 20) + " MiB");
    } catch (...) {
        destroy();
        throw;
    }
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    Tracked::operator=(std::move(other));
    return *this;
}

Buffer::~Buffer() { destroy(); }

void Buffer::destroy() {
    if (!id()) return;
    const GladGLContext& functions = gl();
    const GLuint name = take();
    functions.DeleteBuffers(1, &name);
}

void Buffer::write(const void* data, std::size_t bytes, std::size_t offset) {
    gl().NamedBufferSubData(id(), GLintptr(offset), GLsizeiptr(bytes), data);
}

void Buffer::read(void* data, std::size_t bytes, std::size_t offset) const {
    gl().GetNamedBufferSubData(id(), GLintptr(offset), GLsizeiptr(bytes), data);
}

void Buffer::clear(std::uint32_t value) {
    gl().ClearNamedBufferData(id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void Buffer::orphan() { gl().NamedBufferData(id(), GLsizeiptr(byte_size()), nullptr, GL_DYNAMIC_DRAW); }

void Buffer::bind_base(GLenum target, GLuint index) const { gl().BindBufferBase(target, index, id()); }

void Buffer::bind(GLenum target) const { gl().BindBuffer(target, id()); }

}  // namespace shadow_layers::gl
