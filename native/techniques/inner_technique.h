// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "techniques/technique.h"

namespace shadow_layers {

/// A registered technique that works inside another one, found by its id: a source of hard visibility that the outer
/// technique goes on with. Only its first output, the visibility, is used.
class InnerTechnique {
public:
    InnerTechnique();
    ~InnerTechnique();
    InnerTechnique(InnerTechnique&&) noexcept;
    InnerTechnique& operator=(InnerTechnique&&) noexcept;

    /// `given` differs from the technique's defaults. Idempotent, also when the id changes. InputError if there is no
    /// such technique or a value is not allowed.
    void prepare(Engine& engine, const std::string& id, const ParameterValues& given);

    /// Renders `task`'s light sample with the prepared technique and its own parameters. R32F of the frame's size,
    /// overscan included; valid until the next call.
    const gl::Texture& render(Engine& engine, const LightTask& task);

    /// The same into `outputs`, from wherever the technique has it.
    void render(Engine& engine, const LightTask& task, LayerOutputs& outputs);

private:
    struct Made;
    std::vector<std::unique_ptr<Made>> made_;  // one per id that was asked for
    Made* current_ = nullptr;
};

/// What `id` needs with these values, defaults filled in; for the outer technique's own `needs`.
TechniqueNeeds find_inner_needs(const std::string& id, const ParameterValues& given);

}  // namespace shadow_layers
