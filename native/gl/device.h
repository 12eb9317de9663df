// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The loader's header: a table of functions per context, no global state.
#include <glad/gl.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace shadow_layers::gl {

struct Limits {
    int max_texture_size = 0;
    int max_viewport_size = 0;
    int max_color_attachments = 0;
    std::size_t max_ssbo_bytes = 0;
};

/// The GL of one context: functions, limits, and a count of what is alive. Lives on the thread that owns the context;
/// every object of this folder refers to it and must die before it.
class Device {
public:
    using LoadFunction = void (*(*)(void* user, const char* name))();

    /// Loads the functions of the current context. `debug` turns on synchronous debug output.
    /// Throws ContextError if the context is older than GL 4.5.
    Device(LoadFunction load, void* user, bool debug);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const GladGLContext& gl() const { return gl_; }
    const Limits& limits() const { return limits_; }
    const std::string& version() const { return version_; }
    const std::string& renderer() const { return renderer_; }
    const std::string& vendor() const { return vendor_; }
    bool software() const;                            ///< llvmpipe, softpipe, swrast
    bool has_extension(std::string_view name) const;  ///< "GL_ARB_..."

    /// DriverError naming `where` if GL reported an error since the last call.
    void check(std::string_view where) const;

    /// Objects of this folder alive, and the bytes they asked for.
    std::size_t live_objects() const { return live_objects_; }
    std::size_t live_bytes() const { return live_bytes_; }

private:
    friend class Tracked;
    GladGLContext gl_{};
    Limits limits_;
    std::string version_, renderer_, vendor_;
    mutable std::string debug_text_;
    mutable std::size_t live_objects_ = 0, live_bytes_ = 0;
};

/// Base of the owners: device, name and bytes. Move-only.
class Tracked {
public:
    GLuint id() const { return id_; }
    const Device& device() const { return *device_; }
    const GladGLContext& gl() const { return device_->gl(); }
    std::size_t byte_size() const { return bytes_; }
    explicit operator bool() const { return id_ != 0; }

protected:
    Tracked() = default;
    Tracked(const Device& device, GLuint id, GLenum label_kind, std::string_view label);
    Tracked(Tracked&& other) noexcept;
    Tracked& operator=(Tracked&& other) noexcept;
    ~Tracked();
    void set_bytes(std::size_t bytes);
    /// Forgets the name and returns it, for the owner's deletion.
    GLuint take();

private:
    const Device* device_ = nullptr;
    GLuint id_ = 0;
    std::size_t bytes_ = 0;
};

}  // namespace shadow_layers::gl
