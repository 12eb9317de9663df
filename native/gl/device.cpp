// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The loader's functions are compiled here, once.
#define GLAD_GL_IMPLEMENTATION
#include "gl/device.h"

#include <algorithm>
#include <utility>

#include "shadow_layers/error.h"

namespace shadow_layers::gl {
namespace {

void GLAD_API_PTR on_debug_message(GLenum source, GLenum type, GLuint, GLenum severity, GLsizei, const GLchar* message,
                                   const void* user) {
    // The compiler's messages come with ShaderError, at the right file and line.
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
    if (type != GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
    auto& text = *static_cast<std::string*>(const_cast<void*>(user));
    if (text.size() < 2000) text += std::string(text.empty() ? "" : "; ") + message;
}

std::string read_string(const GladGLContext& gl, GLenum name) {
    const auto* text = reinterpret_cast<const char*>(gl.GetString(name));
    return text ? text : "unknown";
}

int read_int(const GladGLContext& gl, GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
}

const char* error_name(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        case GL_STACK_UNDERFLOW:
            return "GL_STACK_UNDERFLOW";
        case GL_STACK_OVERFLOW:
            return "GL_STACK_OVERFLOW";
        default:
            return "an unknown error";
    }
}

}  // namespace

Device::Device(LoadFunction load, void* user, bool debug) {
    const int loaded = gladLoadGLContextUserPtr(&gl_, load, user);
    if (!loaded || !gl_.VERSION_4_5) {
        const std::string found = gl_.GetString ? read_string(gl_, GL_VERSION) : "no GL functions";
        throw ContextError("OpenGL 4.5 core is needed, but the driver gives " + found +
                           "; update the GPU driver or Mesa (libosmesa6)");
    }
    version_ = read_string(gl_, GL_VERSION);
    renderer_ = read_string(gl_, GL_RENDERER);
    vendor_ = read_string(gl_, GL_VENDOR);
    limits_.max_texture_size = read_int(gl_, GL_MAX_TEXTURE_SIZE);
    GLint viewport[2] = {0, 0};
    gl_.GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    limits_.max_viewport_size = std::min(viewport[0], viewport[1]);
    limits_.max_color_attachments = read_int(gl_, GL_MAX_COLOR_ATTACHMENTS);
    limits_.max_ssbo_bytes = std::size_t(read_int(gl_, GL_MAX_SHADER_STORAGE_BLOCK_SIZE));
    if (debug && gl_.DebugMessageCallback) {
        gl_.Enable(GL_DEBUG_OUTPUT);
        gl_.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        gl_.DebugMessageCallback(on_debug_message, &debug_text_);
    }
    // Depth in [0, 1], so that reversed depth in float keeps its precision far away (conventions.h).
    gl_.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    // Filtering over a face's or an array's rim must not depend on a driver's default.
    gl_.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    check("setting up the context");
}

bool Device::has_extension(std::string_view name) const {
    const int count = read_int(gl_, GL_NUM_EXTENSIONS);
    for (int i = 0; i < count; ++i)
        if (name == reinterpret_cast<const char*>(gl_.GetStringi(GL_EXTENSIONS, GLuint(i)))) return true;
    return false;
}

bool Device::software() const {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
        if (renderer_.find(name) != std::string::npos) return true;
    return false;
}

void Device::check(std::string_view where) const {
    std::string errors;
    for (int i = 0; i < 16; ++i) {
        const GLenum error = gl_.GetError();
        if (error == GL_NO_ERROR) break;
        if (errors.find(error_name(error)) == std::string::npos)
            errors += std::string(errors.empty() ? "" : ", ") + error_name(error);
    }
    const std::string details = std::exchange(debug_text_, {});
    if (errors.empty() && details.empty()) return;
    std::string text = "the GL driver (" + renderer_ + ") reported " + (errors.empty() ? "an error" : errors) +
                       " after \"" + std::string(where) + "\"";
    if (errors.find("OUT_OF_MEMORY") != std::string::npos) text += "; use a smaller picture or smaller maps";
    if (!details.empty()) text += ": " + details;
    throw DriverError(text);
}

Tracked::Tracked(const Device& device, GLuint id, GLenum label_kind, std::string_view label)
    : device_(&device), id_(id) {
    ++device.live_objects_;
    if (label_kind != 0 && device.gl().ObjectLabel)
        device.gl().ObjectLabel(label_kind, id, GLsizei(label.size()), label.data());
}

Tracked::Tracked(Tracked&& other) noexcept
    : device_(other.device_), id_(std::exchange(other.id_, 0)), bytes_(std::exchange(other.bytes_, 0)) {}

Tracked& Tracked::operator=(Tracked&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

Tracked::~Tracked() { take(); }

void Tracked::set_bytes(std::size_t bytes) {
    device_->live_bytes_ += bytes - bytes_;
    bytes_ = bytes;
}

GLuint Tracked::take() {
    if (!id_) return 0;
    set_bytes(0);
    --device_->live_objects_;
    return std::exchange(id_, 0);
}

}  // namespace shadow_layers::gl
