// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace shadow_layers::io {

/// Writes a file that appears under its name only when it is whole: written beside it under another name, then renamed.
/// FileError naming the file and the reason (no such folder, read-only, disk full); nothing is left behind then.
void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_whole_file(const std::filesystem::path& path, std::string_view text);

/// Makes the folder and checks that files can be written in it. FileError.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace shadow_layers::io
