// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "techniques/technique.h"

namespace shadow_layers {

/// Techniques by name, made when first asked for. With its pictures, which are of the frame's size, one outlives its
/// last use by as many renders as what the caches hold (kKeptRenders).
class TechniqueSet {
public:
    explicit TechniqueSet(std::vector<TechniqueEntry> entries);
    const std::vector<TechniqueDescriptor>& descriptors() const { return descriptors_; }
    Technique& get(const std::string& id);
    /// Lets go of what the last renders did not ask for.
    void begin_render();

private:
    struct Made {
        std::unique_ptr<Technique> technique;
        std::uint64_t last_render = 0;
    };
    std::vector<TechniqueEntry> entries_;
    std::vector<TechniqueDescriptor> descriptors_;
    std::map<std::string, Made> made_;
    std::uint64_t render_ = 0;
};

}  // namespace shadow_layers
