// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frame/frame.h"
#include "lights/light_views.h"
#include "shadow_layers/request.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {

class Engine;  // engine/engine.h: GL, programs, caches, thread pool, timers, cancel token

/// What a technique fills: each declared channel once, from a GL texture or from the CPU, at the frame's size
/// (overscan included; the session crops it).
class LayerOutputs {
public:
    virtual ~LayerOutputs() = default;
    virtual void set(const std::string& channel, const gl::Texture& texture) = 0;  ///< R32F, RGB32F or RGBA32F
    virtual void set(const std::string& channel, Image image) = 0;
};

/// One sample of a light in one frame, ready for a technique. A technique sees all views of the sample at once, so that
/// camera-space stages run after they are merged. The session goes through the light's samples and averages the
/// answers.
struct LightTask {
    const Frame& frame;
    FrameSource& frames;
    const Light& light;
    const LightSample& sample;
    const ParameterValues& parameters;
    int picture_sample = 0;  ///< which of the picture's samples this is; one may take another pattern than the next
};

/// Composed of shared stages (stages/); never derives from, or branches on, another technique. Lives on the worker
/// thread. Makes no context, reads no file but its shaders, does not time itself (stages do).
class Technique {
public:
    virtual ~Technique() = default;

    /// Compiles programs, checks limits. Idempotent; called before each render with the parameters in force.
    virtual void prepare(Engine& engine, const ParameterValues& parameters) = 0;

    /// Fills every output channel that the descriptor declares. `visibility` is in [0, 1]: 1 = lit; 0 on faces turned
    /// away; 1 in the background, outside the cone, and for receivers that the light is not linked to.
    virtual void render(Engine& engine, const LightTask& task, LayerOutputs& outputs) = 0;
};

/// A row of the registry: the descriptor and the maker.
struct TechniqueEntry {
    TechniqueDescriptor (*describe)();
    std::unique_ptr<Technique> (*make)();
};

/// The entry's descriptor with the options that the session adds (techniques/light_samples_option.h).
TechniqueDescriptor make_descriptor(const TechniqueEntry& entry);

/// All techniques; techniques/registry.cpp, one line each.
const std::vector<TechniqueEntry>& technique_entries();

}  // namespace shadow_layers
