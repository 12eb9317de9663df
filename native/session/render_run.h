// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/engine.h"
#include "frame/frame_maker.h"
#include "session/technique_set.h"

namespace shadow_layers {

/// What a render hands out while it runs; called on the worker thread.
struct RenderOutlet {
    std::function<void(Layer&&)> deliver;
    std::function<void(double fraction, const std::string& text)> progress;
};

/// Works one request on the worker thread; see Session::render.
FrameResult run_render(Engine& engine, const std::shared_ptr<FramePool>& pool, TechniqueSet& techniques,
                       const RenderRequest& request, const RenderOutlet& outlet);

}  // namespace shadow_layers
