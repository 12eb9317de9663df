// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/device.h"

namespace shadow_layers::gl {

/// Reads plain values, nearest and clamped to the edge, from a texture whose own settings say otherwise: the depths of
/// a map that shadow samplers compare. Serves one texture unit while it lives.
class ValueSampler : public Tracked {
public:
    ValueSampler(const Device& device, GLuint unit, std::string_view label);
    ~ValueSampler();
    ValueSampler(const ValueSampler&) = delete;
    ValueSampler& operator=(const ValueSampler&) = delete;

private:
    GLuint unit_;
};

}  // namespace shadow_layers::gl
