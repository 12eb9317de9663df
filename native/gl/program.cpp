// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/program.h"

#include <algorithm>
#include <cctype>
#include <glm/gtc/type_ptr.hpp>
#include <string_view>

#include "gl/shader_source.h"
#include "shadow_layers/error.h"

namespace shadow_layers::gl {
namespace {

GLuint create_program(const Device& device) { return device.gl().CreateProgram(); }

/// A compiled shader, deleted with the scope; a program keeps what it links.
class Shader {
public:
    Shader(const GladGLContext& gl, const Program::Stage& stage, std::string_view label)
        : gl_(gl), id_(gl.CreateShader(stage.kind)) {
        const char* text = stage.source.c_str();
        gl_.ShaderSource(id_, 1, &text, nullptr);
        gl_.CompileShader(id_);
        GLint compiled = GL_FALSE;
        gl_.GetShaderiv(id_, GL_COMPILE_STATUS, &compiled);
        if (compiled) return;
        GLint length = 0;
        gl_.GetShaderiv(id_, GL_INFO_LOG_LENGTH, &length);
        std::string log(std::size_t(std::max(1, length)), '\0');
        gl_.GetShaderInfoLog(id_, length, nullptr, log.data());
        log.resize(log.find('\0') == std::string::npos ? log.size() : log.find('\0'));
        gl_.DeleteShader(id_);
        throw ShaderError("shader \"" + std::string(label) + "\" does not compile:\n" +
                          name_files_in_log(log, stage.files));
    }
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
    ~Shader() { gl_.DeleteShader(id_); }
    GLuint id() const { return id_; }

private:
    const GladGLContext& gl_;
    GLuint id_;
};

/// Takes out "//" and "/* */" comments.
std::string strip_comments(const std::string& source) {
    std::string code;
    for (std::size_t at = 0; at < source.size();) {
        if (source.compare(at, 2, "//") == 0) {
            at = std::min(source.find('\n', at), source.size());
        } else if (source.compare(at, 2, "/*") == 0) {
            const std::size_t end = source.find("*/", at + 2);
            at = end == std::string::npos ? source.size() : end + 2;
            code += ' ';
        } else {
            code += source[at++];
        }
    }
    return code;
}

/// The names that a GLSL text declares as "uniform type name" or "uniform type name[size]", one a declaration.
void add_uniform_names(const std::string& source, std::set<std::string>& names) {
    const std::string code = strip_comments(source);
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    constexpr std::string_view kKeyword = "uniform";
    for (std::size_t at = code.find(kKeyword); at != std::string::npos; at = code.find(kKeyword, at + 1)) {
        std::size_t end = at + kKeyword.size();
        if ((at > 0 && is_word(code[at - 1])) || (end < code.size() && is_word(code[end]))) continue;
        std::string word;  // the last one before what ends the declaration
        for (; end < code.size() && std::string_view(";[={").find(code[end]) == std::string_view::npos; ++end) {
            if (!is_word(code[end])) continue;
            if (!is_word(code[end - 1])) word.clear();
            word += code[end];
        }
        if (!word.empty()) names.insert(word);
    }
}

}  // namespace

Program::Program(const Device& device, const std::vector<Stage>& stages, std::string_view label)
    : Tracked(device, create_program(device), GL_PROGRAM, label), label_(label) {
    try {
        for (const Stage& stage : stages) add_uniform_names(stage.source, declared_);
        link(stages, label);
    } catch (...) {
        destroy();
        throw;
    }
}

void Program::link(const std::vector<Stage>& stages, std::string_view label) {
    for (const Stage& stage : stages) {
        const Shader shader(gl(), stage, stage.files.empty() ? label : std::string_view(stage.files.front()));
        gl().AttachShader(id(), shader.id());
    }
    gl().LinkProgram(id());
    GLint linked = GL_FALSE;
    gl().GetProgramiv(id(), GL_LINK_STATUS, &linked);
    if (linked) return;
    std::string log(4096, '\0');
    GLsizei length = 0;
    gl().GetProgramInfoLog(id(), GLsizei(log.size()), &length, log.data());
    log.resize(std::size_t(length));
    throw ShaderError("program \"" + std::string(label) + "\" does not link:\n" + log);
}

Program& Program::operator=(Program&& other) noexcept {
    Tracked::operator=(std::move(other));
    std::swap(label_, other.label_);
    std::swap(declared_, other.declared_);
    std::swap(locations_, other.locations_);
    return *this;
}

Program::~Program() { destroy(); }

void Program::destroy() {
    if (!id()) return;
    const GladGLContext& functions = gl();
    functions.DeleteProgram(take());
}

void Program::use() const { gl().UseProgram(id()); }

int Program::location(const char* name) const {
    const auto found = locations_.find(name);
    if (found != locations_.end()) return found->second;
    const std::string_view whole = name;  // of an array's element: the array's
    if (!declared_.contains(std::string(whole.substr(0, whole.find('[')))))
        throw ShaderError("program \"" + label_ + "\" has no uniform \"" + name +
                          "\"; give the folder \"shaders\" of this version");
    return locations_[name] = gl().GetUniformLocation(id(), name);
}

void Program::set(const char* name, int value) const { gl().ProgramUniform1i(id(), location(name), value); }
void Program::set(const char* name, unsigned value) const { gl().ProgramUniform1ui(id(), location(name), value); }
void Program::set(const char* name, float value) const { gl().ProgramUniform1f(id(), location(name), value); }
void Program::set(const char* name, const glm::vec2& value) const {
    gl().ProgramUniform2fv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::vec3& value) const {
    gl().ProgramUniform3fv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::vec4& value) const {
    gl().ProgramUniform4fv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::ivec2& value) const {
    gl().ProgramUniform2iv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::ivec4& value) const {
    gl().ProgramUniform4iv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::mat3& value) const {
    gl().ProgramUniformMatrix3fv(id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::mat4& value) const {
    gl().ProgramUniformMatrix4fv(id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
}

}  // namespace shadow_layers::gl
