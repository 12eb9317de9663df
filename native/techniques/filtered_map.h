// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/program.h"
#include "stages/moment_map.h"
#include "techniques/technique.h"

namespace shadow_layers {

/// What a texel of a filtered map holds.
struct TexelEncoding {
    const char* encode;             ///< function of shaders/lib/moment_lib.glsl
    GLenum format;                  ///< of the map
    bool fixed_point = false;       ///< the shader gets FIXED_POINT = 1 and decodes
    glm::dvec2 exponents = {0, 0};  ///< of the encodings that take some
};

/// What sets one technique on filtered maps apart from the others. A depth map is encoded, blurred and, if asked for,
/// averaged down to mipmaps (stages/moment_map.h); then the shader, which includes "stages/moment_inputs.glsl", bounds
/// by the averages how much of a receiver's footprint is lit.
struct FilteredMapKind {
    const char* shader;
    TexelEncoding (*get_encoding)(const ParameterValues&);
    void (*set_uniforms)(const gl::Program&, const ParameterValues&);
    gl::Defines (*get_defines)(const ParameterValues&) = nullptr;  ///< beside those that all have
};

/// The one technique behind vsm, esm, evsm and msm.
std::unique_ptr<Technique> make_filtered_map(const FilteredMapKind& kind);

/// Completes a descriptor that has what is the technique's own: the shared parameters go before its own, needs and
/// truth follow from them.
TechniqueDescriptor describe_filtered_map(TechniqueDescriptor own);

}  // namespace shadow_layers
