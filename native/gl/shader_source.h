// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gl/program.h"

namespace shadow_layers::gl {

/// Reads shader files of one folder. `#include "x"` is looked for beside the including file, then from the folder's
/// root; a file with `#pragma once` is pasted once per stage. `#version 450 core` and the defines are put in front, so
/// no file holds a #version line. `#line` directives keep messages at the right file and line.
class ShaderSource {
public:
    /// ShaderError naming the folder and the remedy if it does not exist or holds no shaders.
    explicit ShaderSource(std::filesystem::path folder);

    /// `file` is relative to the folder; its extension (.vert .frag .geom .comp) tells the stage. ShaderError names
    /// file:line of an include that is missing or goes round in a circle.
    Program::Stage load(const std::string& file, const Defines& defines) const;

    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
};

/// A compiler's log with "file:line" in place of "source:line" numbers (Mesa "0:12(3)", NVIDIA "0(12)").
std::string name_files_in_log(std::string_view log, const std::vector<std::string>& files);

}  // namespace shadow_layers::gl
