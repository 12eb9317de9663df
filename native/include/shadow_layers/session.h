// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "shadow_layers/error.h"
#include "shadow_layers/request.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

struct SessionOptions {
    std::string backend =
        "auto";              ///< "auto" (EGL on a GPU if there is one, then OSMesa, then EGL software), "osmesa", "egl"
    int threads = 0;         ///< CPU stages and software rasteriser; 0 = all cores
    std::string shader_dir;  ///< folder that holds shared/, lib/, ...; must exist
    std::size_t gpu_cache_bytes = std::size_t{1} << 30;     ///< meshes and stage results kept between frames
    std::size_t host_cache_bytes = std::size_t{512} << 20;  ///< what is derived from meshes, kept between frames
    bool debug = false;                                     ///< GL debug output; an error ends the render
};

struct SessionInfo {
    std::string backend, gl_version, gl_renderer, gl_vendor;
    int threads = 0;
    int max_texture_size = 0;
    bool software = false;
};

/// Owns a private worker thread, which owns the GL context for life. All members may be called from any thread;
/// renders are worked one at a time. Destroying or closing it ends the thread; both are safe during a render
/// (which is cancelled).
class Session {
public:
    explicit Session(SessionOptions options);  ///< makes the context; throws ContextError, ShaderError
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const SessionInfo& info() const;

    /// Renders one frame. Blocks. Lights are worked one at a time; each layer goes to `sink` when it is whole.
    /// Throws InputError, ShaderError, DriverError, Cancelled; after a throw the session can be used again.
    FrameResult render(const RenderRequest& request, const LayerSink& sink, const ProgressSink& progress = {});

    /// Ends the running render within 300 ms, from any thread. Without one it does nothing.
    void cancel();

    /// Bytes held after the last render, for the no-growth tests: mesh data and frames on the host.
    std::size_t host_bytes() const;
    /// The same for all that lies on the GL.
    std::size_t gpu_bytes() const;

    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Product version and source revision ("0.1.0", "abcdef0" or "unknown").
const char* version();
const char* revision();

}  // namespace shadow_layers
