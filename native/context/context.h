// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

namespace shadow_layers {

/// An OpenGL 4.5 core context without a window, current on the thread that made it until it dies. One interface for all
/// back ends; their libraries are opened at run time (dlopen, local symbols), so that the module that Blender loads
/// links no GL and does not meet Blender's own.
class Context {
public:
    using Function = void (*)();

    virtual ~Context() = default;
    /// Makes it current on the calling thread. Blender's threads never call this: a private thread owns the context.
    virtual void make_current() = 0;
    /// A GL function by name, or null.
    virtual Function load(const char* name) = 0;
    /// "osmesa", "egl (device 0)", "egl (surfaceless)".
    virtual const std::string& description() const = 0;
    virtual bool software() const = 0;  ///< llvmpipe and its like
};

/// `backend`: "auto" (EGL on a GPU if there is one, then OSMesa, then EGL software), "osmesa" or "egl".
/// `threads` > 0 sets the software rasteriser's threads, unless LP_NUM_THREADS is in the environment already. Mesa
/// reads it once per process, so the first context made decides for all. Throws ContextError that lists each back end
/// tried, why it failed and what to install; InputError for another name.
std::unique_ptr<Context> make_context(const std::string& backend, int threads);

// --- the back ends; each throws ContextError with the reason alone ---
std::unique_ptr<Context> make_osmesa_context();
enum class EGLChoice { Hardware, Software, Any };
std::unique_ptr<Context> make_egl_context(EGLChoice choice);

}  // namespace shadow_layers
