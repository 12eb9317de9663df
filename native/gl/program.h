// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "gl/device.h"

namespace shadow_layers::gl {

/// Compile-time constants of a program: `#define name value`. Ordered, so that equal sets compare equal.
using Defines = std::map<std::string, std::string>;

/// A linked program. Setting a uniform that the compiler removed has no effect; one that none of the sources declares,
/// whatever their defines, is a ShaderError that names program and uniform.
class Program : public Tracked {
public:
    struct Stage {
        GLenum kind;                     ///< GL_VERTEX_SHADER, ...
        std::string source;              ///< whole, includes expanded
        std::vector<std::string> files;  ///< by GLSL source string number, for messages
    };

    Program() = default;
    /// ShaderError with file:line lines if it does not compile or link.
    Program(const Device& device, const std::vector<Stage>& stages, std::string_view label);
    Program(Program&&) noexcept = default;
    Program& operator=(Program&& other) noexcept;
    ~Program();

    void use() const;
    void set(const char* name, int value) const;  ///< also sampler and image units
    void set(const char* name, unsigned value) const;
    void set(const char* name, float value) const;
    void set(const char* name, const glm::vec2& value) const;
    void set(const char* name, const glm::vec3& value) const;
    void set(const char* name, const glm::vec4& value) const;
    void set(const char* name, const glm::ivec2& value) const;
    void set(const char* name, const glm::ivec4& value) const;
    void set(const char* name, const glm::mat3& value) const;
    void set(const char* name, const glm::mat4& value) const;
    int location(const char* name) const;  ///< -1 if the compiler removed it

private:
    void link(const std::vector<Stage>& stages, std::string_view label);
    void destroy();
    std::string label_;
    std::set<std::string> declared_;  ///< uniforms, also those that a define leaves out
    mutable std::unordered_map<std::string, int> locations_;
};

}  // namespace shadow_layers::gl
