// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Feeds numbers through a GLSL library: a compute program whose invocation i reads items [i * in_count, ...) of
// `inputs` and writes items [i * out_count, ...) of `outputs`. The body sees `const int i` and the arrays `inputs[]`
// and `outputs[]`; so do `functions`, which stand before it.

#include <fstream>
#include <glm/glm.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "context/context.h"
#include "gl/buffer.h"
#include "gl/device.h"
#include "gl/program.h"

namespace shadow_layers::testing {

/// A library's text, with the libraries that it includes (paths from the shader folder).
inline std::string read_library(const std::string& file) {
    std::ifstream stream(std::string(SHADOW_LAYERS_SHADER_DIR) + "/" + file);
    if (!stream) throw std::runtime_error("cannot read " + file);
    const std::string include = "#include \"";
    std::string text, line;
    while (std::getline(stream, line)) {
        if (line.rfind(include, 0) == 0)
            text += read_library(line.substr(include.size(), line.rfind('"') - include.size()));
        else if (line.rfind("#pragma once", 0) != 0)
            text += line + "\n";
    }
    return text;
}

class GlslLibRunner {
public:
    GlslLibRunner() : context_(make_context("osmesa", 2)) {
        context_->make_current();
        device_ = std::make_unique<gl::Device>(
            [](void* user, const char* name) { return static_cast<Context*>(user)->load(name); }, context_.get(),
            false);
    }

    std::vector<glm::vec4> run(const std::string& library, const std::string& body,
                               const std::vector<glm::vec4>& inputs, int invocations, int out_count,
                               const std::string& functions = {}) {
        const std::string source =
            "#version 450 core\n" + read_library(library) +
            "layout(local_size_x = 64) in;\n"
            "layout(std430, binding = 0) readonly buffer In { vec4 inputs[]; };\n"
            "layout(std430, binding = 1) buffer Out { vec4 outputs[]; };\n"
            "layout(location = 0) uniform int u_count;\n" +
            functions + "\nvoid main() {\n    int i = int(gl_GlobalInvocationID.x);\n    if (i >= u_count) return;\n" +
            body + "\n}\n";
        const gl::Program program(*device_, {{GL_COMPUTE_SHADER, source, {library}}}, "library test");
        const gl::Buffer in_buf(*device_, std::span<const glm::vec4>(inputs), "inputs");
        const gl::Buffer out_buf(*device_, std::size_t(invocations) * std::size_t(out_count) * sizeof(glm::vec4),
                                 "outputs");
        program.use();
        program.set("u_count", invocations);
        in_buf.bind_base(GL_SHADER_STORAGE_BUFFER, 0);
        out_buf.bind_base(GL_SHADER_STORAGE_BUFFER, 1);
        device_->gl().DispatchCompute(GLuint(invocations + 63) / 64, 1, 1);
        device_->gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        device_->check("library test");
        return out_buf.download<glm::vec4>(std::size_t(invocations) * std::size_t(out_count));
    }

private:
    std::unique_ptr<Context> context_;
    std::unique_ptr<gl::Device> device_;
};

}  // namespace shadow_layers::testing
