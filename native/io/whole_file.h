// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace shadow_layers::io {

/// A file of its own beside `path`, with its extension, that takes its name only with finish(); removed if that never
/// comes. Everything throws FileError naming the final file and the reason.
class TemporaryFile {
public:
    explicit TemporaryFile(std::filesystem::path path);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::filesystem::path& name() const { return name_; }  ///< for writers that open it themselves
    void write(std::span<const std::byte> bytes);
    void finish();

private:
    std::filesystem::path path_, name_;
    int descriptor_ = -1;
    bool renamed_ = false;
};

/// Writes a file that appears under its name only when it is whole: written beside it under another name, then renamed.
/// FileError naming the file and the reason (no such folder, read-only, disk full); nothing is left behind then.
void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_whole_file(const std::filesystem::path& path, std::string_view text);

/// Makes the folder and checks that files can be written in it. FileError.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace shadow_layers::io
