// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <sstream>
#include <vector>

#include "context/context.h"
#include "context/shared_library.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

// The few names of EGL/egl.h and its extensions that are used; the header is not needed to build.
using Display = void*;
using Device = void*;
using Handle = void*;
constexpr unsigned kPlatformDevice = 0x313F, kPlatformSurfaceless = 0x31DD, kOpenGLAPI = 0x30A2;
constexpr int kExtensions = 0x3055, kNone = 0x3038, kRenderableType = 0x3040, kOpenGLBit = 0x8, kSurfaceType = 0x3033,
              kMajorVersion = 0x3098, kMinorVersion = 0x30FB, kProfileMask = 0x30FD, kCoreProfileBit = 0x1;

struct EGLFunctions {
    explicit EGLFunctions(const SharedLibrary& library) {
        get_proc_address = library.function<decltype(get_proc_address)>("eglGetProcAddress");
        query_string = library.function<decltype(query_string)>("eglQueryString");
        initialize = library.function<decltype(initialize)>("eglInitialize");
        bind_api = library.function<decltype(bind_api)>("eglBindAPI");
        choose_config = library.function<decltype(choose_config)>("eglChooseConfig");
        create_context = library.function<decltype(create_context)>("eglCreateContext");
        destroy_context = library.function<decltype(destroy_context)>("eglDestroyContext");
        make_current = library.function<decltype(make_current)>("eglMakeCurrent");
        release_thread = library.function<decltype(release_thread)>("eglReleaseThread");
        get_error = library.function<decltype(get_error)>("eglGetError");
        get_platform_display = extension<decltype(get_platform_display)>("eglGetPlatformDisplayEXT");
        query_devices = extension<decltype(query_devices)>("eglQueryDevicesEXT");
        query_device_string = extension<decltype(query_device_string)>("eglQueryDeviceStringEXT");
    }
    template <class Function>
    Function extension(const char* name) const {
        return reinterpret_cast<Function>(get_proc_address(name));
    }

    Context::Function (*get_proc_address)(const char*);
    const char* (*query_string)(Display, int);
    unsigned (*initialize)(Display, int*, int*);
    unsigned (*bind_api)(unsigned);
    unsigned (*choose_config)(Display, const int*, Handle*, int, int*);
    Handle (*create_context)(Display, Handle, Handle, const int*);
    unsigned (*destroy_context)(Display, Handle);
    unsigned (*make_current)(Display, Handle, Handle, Handle);
    unsigned (*release_thread)();
    int (*get_error)();
    Display (*get_platform_display)(unsigned, void*, const int*);
    unsigned (*query_devices)(int, Device*, int*);
    const char* (*query_device_string)(Device, int);
};

bool has_word(const char* words, const char* word) {
    if (!words) return false;
    std::istringstream stream{std::string(words)};
    const std::istream_iterator<std::string> first(stream), last;
    return std::find(first, last, word) != last;
}

/// A display to try. Displays belong to the process and may be shared with Blender: they are never terminated.
struct Candidate {
    Display display;
    std::string description;
};

class EGLContext final : public Context {
public:
    EGLContext(const SharedLibrary& library, const Candidate& candidate)
        : egl_(library), display_(candidate.display), description_(candidate.description) {
        int major = 0, minor = 0;
        if (!display_ || !egl_.initialize(display_, &major, &minor)) fail("eglInitialize");
        if (!egl_.bind_api(kOpenGLAPI)) fail("eglBindAPI(OpenGL)");
        Handle config = nullptr;
        int count = 0;
        // Surface type 0: no window or buffer is ever drawn on, only framebuffer objects.
        const int wanted[] = {kRenderableType, kOpenGLBit, kSurfaceType, 0, kNone};
        if (!has_word(egl_.query_string(display_, kExtensions), "EGL_KHR_no_config_context"))
            if (!egl_.choose_config(display_, wanted, &config, 1, &count) || count == 0) fail("eglChooseConfig");
        const int version[] = {kMajorVersion, 4, kMinorVersion, 5, kProfileMask, kCoreProfileBit, kNone};
        handle_ = egl_.create_context(display_, config, nullptr, version);
        if (!handle_) fail("eglCreateContext for OpenGL 4.5 core");
        if (!egl_.make_current(display_, nullptr, nullptr, handle_)) {
            egl_.destroy_context(display_, handle_);
            fail("eglMakeCurrent without a surface");
        }
        software_ = is_software();
    }
    ~EGLContext() override {
        egl_.make_current(display_, nullptr, nullptr, nullptr);
        egl_.destroy_context(display_, handle_);
        egl_.release_thread();
    }
    void make_current() override {
        if (!egl_.make_current(display_, nullptr, nullptr, handle_)) fail("eglMakeCurrent without a surface");
    }
    Function load(const char* name) override { return egl_.get_proc_address(name); }
    const std::string& description() const override { return description_; }
    bool software() const override { return software_; }

private:
    [[noreturn]] void fail(const char* what) const {
        char code[16];
        std::snprintf(code, sizeof code, "0x%04x", unsigned(egl_.get_error()));
        throw ContextError(description_ + ": " + what + " failed (EGL error " + code + ")");
    }
    bool is_software() {
        const auto get_string = reinterpret_cast<const unsigned char* (*)(unsigned)>(load("glGetString"));
        const auto* text = get_string ? reinterpret_cast<const char*>(get_string(0x1F01 /* GL_RENDERER */)) : nullptr;
        const std::string renderer = text ? text : "";
        return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos ||
               renderer.find("swrast") != std::string::npos;
    }

    EGLFunctions egl_;
    Display display_;
    Handle handle_ = nullptr;
    std::string description_;
    bool software_ = false;
};

std::vector<Candidate> list_candidates(const EGLFunctions& egl) {
    std::vector<Candidate> candidates;
    const char* client = egl.query_string(nullptr, kExtensions);
    if (!egl.get_platform_display) throw ContextError("eglGetPlatformDisplayEXT is missing: libEGL is too old");
    if (egl.query_devices && has_word(client, "EGL_EXT_platform_device")) {
        Device devices[32];
        int count = 0;
        if (!egl.query_devices(32, devices, &count)) count = 0;
        for (int i = 0; i < count; ++i)
            candidates.push_back({egl.get_platform_display(kPlatformDevice, devices[i], nullptr),
                                  "egl (device " + std::to_string(i) + ")"});
    }
    if (has_word(client, "EGL_MESA_platform_surfaceless"))
        candidates.push_back({egl.get_platform_display(kPlatformSurfaceless, nullptr, nullptr), "egl (surfaceless)"});
    if (candidates.empty()) throw ContextError("libEGL has neither device nor surfaceless displays");
    return candidates;
}

}  // namespace

std::unique_ptr<Context> make_egl_context(EGLChoice choice) {
    const SharedLibrary library({"libEGL.so.1"});
    const EGLFunctions egl(library);
    std::string reasons;
    std::unique_ptr<Context> software;
    for (const Candidate& candidate : list_candidates(egl)) {
        try {
            auto context = std::make_unique<EGLContext>(library, candidate);
            if (!context->software() && choice != EGLChoice::Software) return context;
            reasons += (reasons.empty() ? "" : "; ") + candidate.description + ": " +
                       (context->software() ? "a software renderer" : "a GPU");
            if (context->software() && choice != EGLChoice::Hardware && !software) software = std::move(context);
        } catch (const ContextError& error) {
            reasons += (reasons.empty() ? "" : "; ") + std::string(error.what());
        }
    }
    if (!software) throw ContextError(reasons);
    software->make_current();  // a later candidate may have taken its place
    return software;
}

}  // namespace shadow_layers
