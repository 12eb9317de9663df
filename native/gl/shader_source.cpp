// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/shader_source.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "shadow_layers/error.h"

namespace shadow_layers::gl {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReinstall = "; reinstall the extension, or give the folder \"shaders\" of this version";

GLenum stage_kind(const std::string& file) {
    const std::string extension = fs::path(file).extension().string();
    if (extension == ".vert") return GL_VERTEX_SHADER;
    if (extension == ".geom") return GL_GEOMETRY_SHADER;
    if (extension == ".frag") return GL_FRAGMENT_SHADER;
    if (extension == ".comp") return GL_COMPUTE_SHADER;
    throw ShaderError("shader file \"" + file + "\": the extension must be .vert, .geom, .frag or .comp");
}

/// Pastes includes into one text. Files are numbered in order of first use, and #line refers to the numbers.
class Expansion {
public:
    explicit Expansion(const fs::path& folder) : folder_(folder) {}

    void paste(const fs::path& file, const std::string& included_from) {
        const std::string name = file.generic_string();
        if (std::find(once_.begin(), once_.end(), name) != once_.end()) return;
        if (std::find(open_.begin(), open_.end(), name) != open_.end())
            throw ShaderError(included_from + ": \"" + name + "\" includes itself in a circle");
        std::ifstream stream(folder_ / file, std::ios::binary);
        if (!stream) {
            const std::string where = included_from.empty() ? "" : included_from + ": ";
            throw ShaderError(where + "shader file \"" + name + "\" is missing in " + folder_.string() + kReinstall);
        }
        open_.push_back(name);
        const std::size_t number = file_number(name);
        text_ << "#line 1 " << number << "\n";
        std::string line;
        for (int line_number = 1; std::getline(stream, line); ++line_number)
            paste_line(file, line, line_number, number);
        open_.pop_back();
    }

    std::string text() const { return text_.str(); }
    std::vector<std::string> files() const { return files_; }

private:
    void paste_line(const fs::path& file, const std::string& line, int line_number, std::size_t number) {
        static const std::regex include_rule(R"(^\s*#\s*include\s*"([^"]+)\".*$)");
        static const std::regex once_rule(R"(^\s*#\s*pragma\s+once\s*$)");
        std::smatch match;
        // A look at the first sign is much cheaper than two regular expressions on every line.
        const std::size_t first = line.find_first_not_of(" \t");
        if (first == std::string::npos || line[first] != '#') {
            text_ << line << "\n";
        } else if (std::regex_match(line, match, include_rule)) {
            const std::string where = file.generic_string() + ":" + std::to_string(line_number);
            paste(find_include(file, match[1].str()), where);
            text_ << "#line " << line_number + 1 << " " << number << "\n";
        } else if (std::regex_match(line, once_rule)) {
            once_.push_back(file.generic_string());
            text_ << "\n";
        } else {
            text_ << line << "\n";
        }
    }

    fs::path find_include(const fs::path& from, const std::string& name) const {
        const fs::path beside = (from.parent_path() / name).lexically_normal();
        return fs::exists(folder_ / beside) ? beside : fs::path(name).lexically_normal();
    }

    std::size_t file_number(const std::string& name) {
        const auto found = std::find(files_.begin(), files_.end(), name);
        if (found != files_.end()) return std::size_t(found - files_.begin());
        files_.push_back(name);
        return files_.size() - 1;
    }

    const fs::path& folder_;
    std::ostringstream text_;
    std::vector<std::string> files_, open_, once_;
};

}  // namespace

ShaderSource::ShaderSource(fs::path folder) : folder_(std::move(folder)) {
    std::error_code ignored;
    if (folder_.empty()) throw ShaderError(std::string("no shader folder was given") + kReinstall);
    if (!fs::is_directory(folder_, ignored))
        throw ShaderError("the shader folder \"" + folder_.string() + "\" does not exist" + kReinstall);
    if (!fs::exists(folder_ / "shared" / "conventions.h", ignored))
        throw ShaderError("the folder \"" + folder_.string() + "\" holds no shaders (shared/conventions.h is missing)" +
                          kReinstall);
}

Program::Stage ShaderSource::load(const std::string& file, const Defines& defines) const {
    Program::Stage stage;
    stage.kind = stage_kind(file);
    Expansion expansion(folder_);
    expansion.paste(file, "");
    std::string head = "#version 450 core\n";
    for (const auto& [name, value] : defines) head += "#define " + name + " " + value + "\n";
    stage.source = head + expansion.text();
    stage.files = expansion.files();
    return stage;
}

std::string name_files_in_log(std::string_view log, const std::vector<std::string>& files) {
    // "0:12(3): error" (Mesa), "0(12) : error" (NVIDIA), "ERROR: 0:12: ..." (others).
    static const std::regex place(R"(^((?:ERROR: |WARNING: )?)(\d+)(?::(\d+)|\((\d+)\)))");
    std::istringstream lines{std::string(log)};
    std::string named, line;
    while (std::getline(lines, line)) {
        std::smatch match;
        if (std::regex_search(line, match, place) && std::stoul(match[2].str()) < files.size()) {
            const std::string number = match[3].matched ? match[3].str() : match[4].str();
            named += match[1].str() + files[std::stoul(match[2].str())] + ":" + number + match.suffix().str();
        } else {
            named += line;
        }
        named += "\n";
    }
    return named;
}

}  // namespace shadow_layers::gl
